"""How the steps of a plan are run: by Slurm, by GNU parallel over ssh, or by a plain shell. One command for a task serves all."""
import shlex
import subprocess
import sys

from latent_farm import ranges
from latent_farm.errors import FAILED, Failure, STOPPED


def hosts_in(path):
    """The machines of a --sshloginfile: its lines, without comments."""
    try:
        with open(path, encoding="utf-8") as file:
            lines = [line.split("#")[0].strip() for line in file]
    except OSError as error:
        raise Failure(f"{path}: cannot be read: {error.strerror}") from None
    return [line for line in lines if line]


def numbers_of(tasks):
    """A shell command that prints the numbers of the tasks."""
    parts = [f"seq {first} {end - 1}" for first, end in ranges.union((task, task + 1) for task in tasks)]
    return "; ".join(parts)


def shell_line(folder, tasks, steps):
    """Task after task, then the steps; ends where one of them fails."""
    task = shlex.quote(str(folder.path / "task"))
    return _line(folder, tasks, f"(for k in $({numbers_of(tasks)}); do {task} $k || exit; done)", steps)


def parallel_line(folder, tasks, steps, hosts):
    where = f"--sshloginfile {shlex.quote(hosts)} " if hosts else ""
    task = shlex.quote(shlex.quote(str(folder.path / "task")))  # it passes through two shells
    log = shlex.quote(str(folder.logs / "parallel.log"))
    return _line(folder, tasks, f"({numbers_of(tasks)}) | parallel --will-cite --jobs 1 {where}--retries 3 --joblog {log} {task}", steps)


def _line(folder, tasks, render, steps):
    return " && ".join([*([render] if tasks else []), *(shlex.quote(str(folder.path / name)) for name in steps)])


def run(lines):
    """Runs the lines of parallel or of a shell, in the foreground. What they report goes to standard error."""
    for line in lines:
        process = subprocess.Popen(["/bin/sh", "-c", line], stdout=sys.stderr)
        status = None
        while status is None:
            try:
                status = process.wait()
            except KeyboardInterrupt:  # the tasks have received it too, and save their work
                pass
        if status != 0:
            return STOPPED if status in (STOPPED, 130) else FAILED
    return 0
