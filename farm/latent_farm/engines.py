"""How the steps of a plan are run: by Slurm, by GNU parallel over ssh, or by a plain shell. One command for a task serves all."""
import contextlib
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile

from latent_farm import files, ranges
from latent_farm.errors import DONE, FAILED, Failure, STOPPED


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
    hosts = [line for line in (line.split("#")[0].strip() for line in text.splitlines()) if line]
    if not hosts:
        raise Failure(f"{path}: lists no machine; write one per line")
    return hosts


def _command(folder, stage):
    return shlex.join([str(folder.path / "run"), stage.script])


def _each(stage, command):
    """A loop of the shell, where `command` finds the number of a task in $k."""
    numbers = "; ".join(f"seq {first} {end - 1}" for first, end in ranges.union((task, task + 1) for task in stage.tasks))
    return f"for k in $({numbers}); do {command}; done"


def _line(folder, stages, array):
    return " && ".join(_command(folder, stage) if stage.tasks is None else array(stage) for stage in stages)


def shell_line(folder, stages):
    """Task after task, stage after stage. Ends with a stage of which a task failed, or with a task that was interrupted."""
    return _line(folder, stages, lambda stage: f"(s=0; {_each(stage, _command(folder, stage) + ' $k || s=$?; [ $s != 75 ] || break')}; exit $s)")


def _parallel(folder, hosts):
    """When it ends, tasks have ten minutes to save what they have rendered."""
    return ["parallel", "--will-cite", "--jobs", "1", *(["--sshloginfile", hosts] if hosts else []), "--retries", "3",
            "--termseq", "TERM,600000,KILL,25", "--joblog", f"+{folder.logs / 'parallel.log'}"]


def parallel_line(folder, stages, hosts):
    """parallel reads whole commands: what it finds in a command of its own, such as {} or {= =}, it would replace."""
    def array(stage):
        command = shlex.join(["printf", r"%s %d\n", _command(folder, stage)])
        return f"({_each(stage, command + ' $k')}) | {shlex.join(_parallel(folder, hosts))}"
    return _line(folder, stages, array)


def lines_of(folder, plan, stages):
    """The commands that run stages of a plan here."""
    if not stages:
        return []
    return [parallel_line(folder, stages, plan.hosts) if plan.engine == "parallel" else shell_line(folder, stages)]


class Foreground:
    """Does here what lines_of says. A signal is passed on to what runs, which saves its work; nothing more is begun."""

    def __init__(self):
        self._process, self._stopped = None, False

    def run(self, chains):
        """Each of `chains` is a folder, its plan, and stages. Returns an exit status."""
        heeded = [number for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP) if signal.getsignal(number) != signal.SIG_IGN]
        before = {number: signal.signal(number, self._stop) for number in heeded}  # nohup has one ignored
        try:
            for folder, plan, stages in chains:
                for stage in stages:
                    status = self._stage(folder, plan, stage)
                    if self._stopped or status != DONE:
                        return STOPPED if self._stopped or status == STOPPED else FAILED
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)
        return DONE

    def _stop(self, *_):
        self._stopped = True
        self._end()

    def _end(self):
        """parallel ends its tasks at the second signal; the others end at the first."""
        for _ in range(2):
            if self._process:
                with contextlib.suppress(ProcessLookupError):
                    self._process.send_signal(signal.SIGTERM)

    def _stage(self, folder, plan, stage):
        run = [str(folder.path / "run"), stage.script]
        if stage.tasks is None:
            return self._wait(run)
        if plan.engine == "parallel":
            with tempfile.TemporaryFile() as commands:
                commands.write("".join(f"{shlex.join(run)} {task}\n" for task in stage.tasks).encode(errors="surrogateescape"))
                commands.seek(0)
                return self._wait(_parallel(folder, plan.hosts), commands)
        worst = DONE
        for task in stage.tasks:
            status = self._wait([*run, str(task)])
            worst = status if status != DONE else worst
            if self._stopped or status == STOPPED:
                break
        return worst

    def _wait(self, command, given=subprocess.DEVNULL):
        """In a session of its own, so that signals reach it only from here. What it reports goes to standard error."""
        if self._stopped:
            return STOPPED
        with subprocess.Popen(command, stdin=given, stdout=sys.stderr, start_new_session=True) as self._process:
            if self._stopped:  # meanwhile
                self._end()
            status = self._process.wait()
        self._process = None
        return status
