#!/usr/bin/env python3
"""Runs every tool on files made to mislead it (make_hostile_files.py) and measures what each run takes.

    run_hostile_files.py BIN [--small] [--memory MIB] [--seconds S] [--only TEXT] [--folder FOLDER]

A run is wrong if a signal ended it; if its status is none of 0, 1, 3 and 4 (develop: 2, where --size is impossible on the film; a
resumed part: 0 alone); if it printed more than 400 KiB of errors; if it failed and left an output behind; or if it took more than
--memory (peak of resident memory, MiB) or --seconds (CPU). Ends with 1 if any is.
Prints the runs that took most.
"""
import argparse
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
MAKER = [sys.executable, "-B", str(HERE / "make_hostile_files.py")]
MOST_ERRORS = 400 << 10


def commands(tools, file, out):
    """(name, command, output) of each run."""
    inspect, merge, develop = (str(tools / f"latent-{verb}") for verb in ("inspect", "merge", "develop"))
    memory = ["--memory", "64M"]
    joined, picture = out / "out.latent", out / "out.exr"
    for level in (["--quick"], [], ["--deep"], ["--strict"], ["--deep", "--json"]):
        yield " ".join(["verify", *level]), [inspect, "verify", *level, file], None
    yield "info", [inspect, "info", *memory, file], None
    yield "info --json", [inspect, "info", "--json", *memory, file], None
    yield "cat", [inspect, "cat", *memory, file], None
    yield "cat --format json", [inspect, "cat", "--format", "json", "--limit", "1000000", *memory, file], None
    yield "recover", [inspect, "recover", file, "-o", joined], joined
    for level in ("quick", "stored", "full"):
        yield f"merge --verify {level}", [merge, "--verify", level, *memory, file, "-o", joined], joined
    yield "merge --compact", [merge, "--compact", "--json", *memory, file, "-o", joined], joined
    yield "merge twice", [merge, "--skip-duplicates", *memory, file, out / "again.latent", "-o", joined], joined
    yield "develop", [develop, *memory, "--size", "64", file, "-o", picture], picture
    yield "develop --json", [develop, *memory, "--size", "64", "--json", "--samples", "10:2000", file, "-o", picture], picture


GEN = ["--records", "8192", "--run-samples", "1024", "--run-bytes", "16M"]


def attempt_commands(tools, file, out):
    """A writer that goes on where a hostile attempt ends."""
    yield "resume", [tools / "latent-inspect", "gen", "-o", file, *GEN], None
    yield "verify what was resumed", [tools / "latent-inspect", "verify", file], None


class Outcome:
    """One run. This process stays small: a child's peak is at least what its parent held when it started."""

    def __init__(self, command, scratch):
        begin = time.monotonic()
        with open(os.devnull, "wb") as out, open(scratch, "wb") as err:
            child = subprocess.Popen([str(word) for word in command], stdout=out, stderr=err)
            try:
                _, status, usage = wait_for(child, 120)
            except TimeoutError:
                child.kill()
                _, status, usage = os.wait4(child.pid, 0)
        child.returncode = self.status = os.waitstatus_to_exitcode(status)
        self.wall = time.monotonic() - begin
        self.cpu = usage.ru_utime + usage.ru_stime
        self.mib = usage.ru_maxrss / 1024
        self.errors = os.path.getsize(scratch)


def wait_for(child, seconds):
    end = time.monotonic() + seconds
    pause = 0.0005
    while time.monotonic() < end:
        pid, status, usage = os.wait4(child.pid, os.WNOHANG)
        if pid:
            return pid, status, usage
        time.sleep(pause)
        pause = min(0.05, pause * 1.5)
    raise TimeoutError


def faults(command, outcome, output, options):
    fine = (0,) if "resume" in command else (0, 1, 2, 3) if command.startswith("develop") else (0, 1, 3, 4)
    if outcome.status not in fine:
        yield f"status {outcome.status}"
    if outcome.errors > MOST_ERRORS:
        yield f"{outcome.errors} bytes of errors"
    if output is not None and outcome.status == 1 and output.exists():
        yield "an output in spite of status 1"
    if outcome.mib > options.memory:
        yield f"{outcome.mib:.0f} MiB"
    if options.seconds and outcome.cpu > options.seconds:
        yield f"{outcome.cpu:.1f} s of CPU"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tools", type=pathlib.Path)
    parser.add_argument("--small", action="store_true", help="a share of the files")
    parser.add_argument("--memory", type=float, default=164)
    parser.add_argument("--seconds", type=float)
    parser.add_argument("--only", help="only files with this in their names")
    parser.add_argument("--folder", help="where the temporary folder is made")
    options = parser.parse_args()
    listed = subprocess.run(MAKER + ["--list"] + ["--small"] * options.small, check=True, capture_output=True, text=True).stdout
    names = [name for name in listed.split() if not options.only or options.only in name]
    runs, wrong, done = [], 0, 0
    with tempfile.TemporaryDirectory(prefix="latent-hostile-", dir=options.folder) as folder:
        folder = pathlib.Path(folder)
        job = folder / "job.latent"
        subprocess.run([options.tools / "latent-inspect", "gen", "-o", job, *GEN], check=True, stdout=subprocess.DEVNULL)
        for i in range(0, len(names), 20):
            group = names[i : i + 20]
            subprocess.run(MAKER + ["--job", job, folder, *group], check=True)
            for name in group:
                file = folder / f"{name}.latent"
                resumes = name.startswith("resume-")
                if not resumes:
                    os.link(file, folder / "again.latent")
                for command, words, output in (attempt_commands if resumes else commands)(options.tools, file, folder):
                    outcome = Outcome(words, folder / "errors")
                    for fault in faults(command, outcome, output, options):
                        print(f"{name}: {command}: {fault}", flush=True)
                        wrong += 1
                    runs.append((name, command, outcome))
                    if output is not None:
                        output.unlink(missing_ok=True)
                known = {f"{other}.latent{end}" for other in group for end in ("", ".part.0")}
                for path in sorted({path.name for path in folder.iterdir()} - known - {"again.latent", "errors", "job.latent"}):
                    print(f"{name}: {path} is left behind", flush=True)
                    (folder / path).unlink()
                    wrong += 1
                for path in (file, folder / f"{name}.latent.part.0", folder / "again.latent"):
                    path.unlink(missing_ok=True)
                done += 1
    print(f"{done} files, {len(runs)} runs, {wrong} wrong")
    for what, key in (("MiB at most", lambda run: run[2].mib), ("s of CPU", lambda run: run[2].cpu)):
        for name, command, outcome in sorted(runs, key=key, reverse=True)[:12]:
            print(f"{key((name, command, outcome)):8.1f} {what}: {command} {name} (status {outcome.status})")
    own = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"{own:8.1f} MiB: this script, the least that can be measured")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
