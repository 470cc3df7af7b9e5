"""Latent's programs: where they are, and what they say. Needs no Blender."""
import functools
import json
import os
import re
import shutil
import signal
import subprocess
import threading

INTERRUPTED = 75  # exit status: all finished work is saved


class Failure(Exception):
    """One line for the user."""


def find(name, folder=""):
    """The path of a program: in `folder`, which the preferences name, or on the PATH."""
    inside = os.path.join(folder, name) if folder else ""
    found = inside if inside and os.access(inside, os.X_OK) else shutil.which(name)
    if not found:
        place = f"neither in {folder} nor on the PATH" if folder else "not on the PATH"
        raise Failure(f"{name} is {place}: install Latent, or give its folder in the preferences of this add-on")
    return found


def share_done(line):
    """From a line of progress such as "2026-01-01 12:00:00 committed 10 of 160 samples (6.3 %), ...": 0 to 1, or None."""
    found = re.search(r"committed (\d+) of (\d+) samples", line)
    return int(found[1]) / max(1, int(found[2])) if found else None


def last_words(text):
    """What a program said when it failed."""
    lines = [line for line in text.splitlines() if line.strip() and share_done(line) is None]
    remedy = ["If this file is damaged, delete it; F12 makes new samples"] if any(".latent: " in line for line in lines) else []
    return "\n".join([*lines[-12:], *remedy]) or "it gave no reason"


def version(path):
    return subprocess.run([path, "--version"], capture_output=True, text=True, stdin=subprocess.DEVNULL).stdout.strip()


@functools.lru_cache
def listed(path, kind, option):
    """What a program lists, such as films: a name and a line about it, of those that are for --KIND."""
    said, found, wanted = subprocess.run([path, option], capture_output=True, text=True, stdin=subprocess.DEVNULL).stdout, [], False
    for line in said.splitlines():
        if not line.startswith(" "):
            wanted = f"(--{kind})" in line
        elif wanted and line[2] != " ":
            name, _, what = line.strip().partition(" ")
            found.append((name, what.strip()))
    return found


def run(command, progress=lambda share: None, stop=lambda: False):
    """Runs a program with --json: its report and its warnings (lines of standard error). None instead of the report if `stop` ended it.
    `stop` is asked five times a second."""
    lines, out = [], []

    def read_errors():
        for line in child.stderr:
            lines.append(line.rstrip("\n"))
            done = share_done(line)
            if done is not None:
                progress(done)

    stopped = False
    with subprocess.Popen([str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, stdin=subprocess.DEVNULL, text=True) as child:
        readers = [threading.Thread(target=read_errors), threading.Thread(target=lambda: out.append(child.stdout.read()))]
        for reader in readers:
            reader.start()
        while child.poll() is None:
            if stop() and not stopped:
                stopped = True
                child.send_signal(signal.SIGTERM)
            try:
                child.wait(0.2)
            except subprocess.TimeoutExpired:
                pass
        for reader in readers:
            reader.join()
    if stopped and child.returncode in (INTERRUPTED, -signal.SIGTERM):
        return None, lines
    if child.returncode not in (0, 3):
        raise Failure(last_words("\n".join(lines)))
    return json.loads(out[0]) if out[0].strip() else {}, [line for line in lines if share_done(line) is None]
