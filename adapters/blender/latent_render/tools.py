"""Latent's programs: where they are, and what they say. Needs no Blender."""
import functools
import json
import os
import re
import shutil
import signal
import subprocess

INTERRUPTED = 75  # exit status: all finished work is saved


class Failure(Exception):
    """One line for the user."""


def find(name, folder=""):
    """The path of a program: in `folder`, which the preferences name, or on the PATH."""
    found = folder and shutil.which(os.path.join(folder, name)) or shutil.which(name)
    if not found:
        place = f"neither in {folder} nor on the PATH" if folder else "not on the PATH"
        raise Failure(f"{name} is {place}: install Latent, or give its folder in the preferences of this add-on")
    return found


def share_done(text):
    """By the last line of progress such as "2026-01-01 12:00:00 committed 10 of 160 samples (6.3 %), ...": 0 to 1, or None."""
    found = re.findall(r"committed (\d+) of (\d+) samples", text)
    return int(found[-1][0]) / int(found[-1][1]) if found else None


def said(path, option):
    return subprocess.run([path, option], capture_output=True, text=True, stdin=subprocess.DEVNULL).stdout.strip()


@functools.lru_cache
def listed(path, kind, option):
    """What a program lists, such as films: a name and a line about it, of those that are for --KIND."""
    sections = re.findall(rf"\(--{kind}\).*\n((?: .*\n?)*)", said(path, option))
    return re.findall(r"^  (\S+) +(.*)", "".join(sections), re.M)


def run(command, progress=lambda share: None, stop=lambda: False):
    """Runs a program with --json: its report and its warnings (lines of standard error). None instead of the report if `stop` ended it.
    `stop` is asked five times a second."""
    stopped, errors = False, None
    with subprocess.Popen([str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, stdin=subprocess.DEVNULL, text=True) as child:
        while errors is None:
            try:
                out, errors = child.communicate(timeout=0.2)
            except subprocess.TimeoutExpired as waiting:
                share = share_done((waiting.stderr or b"").decode(errors="replace"))
                if share is not None:
                    progress(share)
                if not stopped and stop():
                    stopped = True
                    child.terminate()
    lines = [line for line in errors.splitlines() if line.strip() and share_done(line) is None]
    if stopped and child.returncode in (INTERRUPTED, -signal.SIGTERM):
        return None, lines
    if child.returncode not in (0, 3):
        remedy = ["If this file is damaged, delete it; F12 makes new samples"] if any(".latent: " in line for line in lines) else []
        raise Failure("\n".join([*lines[-12:], *remedy]) or "it gave no reason")
    return json.loads(out) if out.strip() else {}, lines
