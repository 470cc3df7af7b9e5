"""The logs that the script `run` writes: which steps failed, and why."""
import os
import re
import typing

from latent_farm import files
from latent_farm.errors import Failure as Fault

TAIL = 1 << 16  # bytes of a log that are read
BEGIN = re.compile(r"\w+(?: \d+)? on (.*), \d{4}-\d\d-\d\dT[\d:]{8}Z(?:, restart \d+)?")
END = re.compile(r"\w+(?: \d+)?: failed with status (\d+)(?:: (.*))?")
INTERRUPTED = re.compile(r"\w+(?: \d+)?: interrupted; .*")


class Failed(typing.NamedTuple):
    """The last attempt at a step, if it failed and no other has begun since."""

    step: str
    task: int | None
    host: str
    status: int
    reason: str  # the last line before its end
    log: str  # name of the file in the folder


def log_name(step, task):
    return f"{step}.log" if task is None else f"{step}-{task:05}.log"


def read_tail(path):
    try:
        with files.opened(path) as file:
            file.seek(max(0, os.fstat(file.fileno()).st_size - TAIL))
            text = file.read(TAIL).decode(errors="surrogateescape")
    except (OSError, Fault):  # a log that cannot be read says nothing
        return []
    return [line for line in map(str.strip, re.split(r"[\r\n]", text)) if line]


def failure(folder, step, task):
    """Failed, or None."""
    lines = read_tail(folder.logs / log_name(step, task))
    end = END.fullmatch(lines[-1]) if lines else None
    if not end:
        return None
    begin, host = 0, "an unknown machine"
    for at, line in enumerate(lines):
        if found := BEGIN.fullmatch(line):
            begin, host = at + 1, found[1]
    said = lines[begin:-1]
    return Failed(step, task, host, int(end[1]), end[2] or (said[-1] if said else f"status {end[1]}"), f"logs/{log_name(step, task)}")


def ended(folder, step, task):
    """When its last attempt failed or was interrupted, by the clock of the file system; 0 if it goes on, as far as the log says."""
    path = folder.logs / log_name(step, task)
    lines = read_tail(path)
    try:
        return path.stat().st_mtime if lines and (END.fullmatch(lines[-1]) or INTERRUPTED.fullmatch(lines[-1])) else 0
    except OSError:
        return 0


def failures(folder, stages):
    """Of all that is still to be done."""
    there = set(os.listdir(folder.logs)) if folder.logs.is_dir() else set()
    steps = [(stage.script, task) for stage in stages for task in (stage.tasks or [None])]
    return [failed for step, task in steps if log_name(step, task) in there and (failed := failure(folder, step, task))]
