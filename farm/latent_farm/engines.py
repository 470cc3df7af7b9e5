"""How the steps of a plan are run: by Slurm, by GNU parallel over ssh, or by a plain shell. One command for a task serves all."""
import shlex
import shutil
import subprocess
import sys

from latent_farm import ranges
from latent_farm.errors import FAILED, Failure, STOPPED


def check(engine):
    """Fails unless the program that an engine needs is here."""
    needed, name = {"slurm": ("sbatch", "Slurm"), "parallel": ("parallel", "GNU parallel")}.get(engine, (None, None))
    if needed and shutil.which(needed) is None:
        raise Failure(f"{needed}: not found; install {name}, or choose another --engine")


def hosts_in(path):
    """The machines of a --sshloginfile: its lines, without comments."""
    try:
        with open(path, encoding="utf-8", errors="replace") as file:
            lines = [line.split("#")[0].strip() for line in file]
    except OSError as error:
        raise Failure(f"{path}: cannot be read: {error.strerror}") from None
    return [line for line in lines if line]


def numbers_of(tasks):
    """A shell command that prints the numbers of the tasks."""
    parts = [f"seq {first} {end - 1}" for first, end in ranges.union((task, task + 1) for task in tasks)]
    return "; ".join(parts)


def shell_line(folder, stages):
    """Task after task, stage after stage; ends where one of them fails."""
    def array(stage):
        return f"(for k in $({numbers_of(stage.tasks)}); do {shlex.quote(str(folder.script(stage.name)))} $k || exit; done)"
    return _line(folder, stages, array)


def parallel_line(folder, stages, hosts):
    where = f"--sshloginfile {shlex.quote(hosts)} " if hosts else ""
    log = shlex.quote(str(folder.logs / "parallel.log"))

    def array(stage):
        script = shlex.quote(shlex.quote(str(folder.script(stage.name))))  # it passes through two shells
        return f"({numbers_of(stage.tasks)}) | parallel --will-cite --jobs 1 {where}--retries 3 --joblog +{log} {script}"
    return _line(folder, stages, array)


def _line(folder, stages, array):
    return " && ".join(array(stage) if stage.tasks is not None else shlex.quote(str(folder.script(stage.name))) for stage in stages)


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
