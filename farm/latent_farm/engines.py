"""How the steps of a plan are run: by Slurm, by GNU parallel over ssh, or by a plain shell. One command for a task serves all."""
import shlex
import shutil
import subprocess
import sys

from latent_farm import files, ranges
from latent_farm.errors import FAILED, Failure, STOPPED


def check(engine):
    """Fails unless the program that an engine needs is here."""
    needed, name = {"slurm": ("sbatch", "Slurm"), "parallel": ("parallel", "GNU parallel")}.get(engine, (None, None))
    if needed and shutil.which(needed) is None:
        raise Failure(f"{needed}: not found; install {name}, or choose another --engine")


def hosts_in(path):
    """The machines of a --sshloginfile: its lines, without comments."""
    try:
        text = files.read(path).decode(errors="replace")
    except FileNotFoundError:
        raise Failure(f"{path}: no such file") from None
    return [line for line in (line.split("#")[0].strip() for line in text.splitlines()) if line]


def _command(folder, stage):
    return shlex.join([str(folder.path / "run"), stage.script])


def _each(stage, command):
    """A loop of the shell, where `command` finds the number of a task in $k."""
    numbers = "; ".join(f"seq {first} {end - 1}" for first, end in ranges.union((task, task + 1) for task in stage.tasks))
    return f"for k in $({numbers}); do {command}; done"


def _line(folder, stages, array):
    return " && ".join(_command(folder, stage) if stage.tasks is None else array(stage) for stage in stages)


def shell_line(folder, stages):
    """Task after task, stage after stage; ends where one of them fails."""
    return _line(folder, stages, lambda stage: f"({_each(stage, _command(folder, stage) + ' $k || exit')})")


def parallel_line(folder, stages, hosts):
    """parallel reads whole commands: what it finds in a command of its own, such as {} or {= =}, it would replace."""
    options = ["--will-cite", "--jobs", "1", *(["--sshloginfile", hosts] if hosts else []),
               "--retries", "3", "--joblog", f"+{folder.logs / 'parallel.log'}"]

    def array(stage):
        command = shlex.join(["printf", r"%s %d\n", _command(folder, stage)])
        return f"({_each(stage, command + ' $k')}) | {shlex.join(['parallel', *options])}"
    return _line(folder, stages, array)


def lines_of(folder, plan, stages):
    """The commands that run stages of a plan here."""
    if not stages:
        return []
    return [parallel_line(folder, stages, plan.hosts) if plan.engine == "parallel" else shell_line(folder, stages)]


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
