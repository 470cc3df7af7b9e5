"""Slurm, as far as latent-farm needs it: what its nodes are, what is in its queue, and how a chain of jobs is submitted."""
import json
import re
import shlex
import shutil
import subprocess

from latent_farm import ranges, sizing, tools
from latent_farm.errors import Failure


def is_here():
    return shutil.which("sbatch") is not None


def nodes():
    """[(nodes, processors of each)] of the default partition; empty if Slurm does not say."""
    try:
        answer = subprocess.run(["sinfo", "-h", "-o", "%P %D %c"], capture_output=True, text=True, timeout=30).stdout
    except (OSError, subprocess.TimeoutExpired):
        return []
    found = re.findall(r"^\S*\* (\d+) (\d+)", answer, re.M)
    return [(int(count), int(cpus)) for count, cpus in found]


class Chain:
    """The jobs of a plan: arrays of render tasks, then merge, then develop."""

    def __init__(self, folder, plan, options=(), throttle=0):
        self.folder, self.plan, self.options, self.throttle = folder, plan, list(options), throttle

    def render(self, tasks):
        """One command for each array."""
        limit = f"%{self.throttle}" if self.throttle else ""
        for offset, indices in sizing.arrays_of(tasks):
            yield ["sbatch", "--parsable", *self.options, f"--array={ranges.array_list(indices)}{limit}",
                   str(self.folder.path / "render.sbatch"), str(offset)]

    def step(self, name, after):
        """A job that runs once the others are done, and not at all if one of them has failed."""
        wait = [f"--dependency=afterok:{':'.join(after)}", "--kill-on-invalid-dep=yes"] if after else []
        return ["sbatch", "--parsable", *self.options, *wait, str(self.folder.path / f"{name}.sbatch")]

    def lines(self, tasks, steps):
        """What `submit` runs, for a shell."""
        names = []
        for command in self.render(tasks):
            names.append(f"R{len(names)}")
            yield f"{names[-1]}=$({shlex.join(command)})"
        after = [f"${name}" for name in names]
        for name in steps:
            line = shlex.join(self.step(name, ["AFTER"] if after else []))
            yield f"{name[0].upper()}=$({line.replace('AFTER', ':'.join(after))})"
            after = [f"${name[0].upper()}"]

    def submit(self, tasks, steps):
        """The numbers of the jobs, also kept in the folder."""
        numbers = []
        after = []
        for command in self.render(tasks):
            after.append(self._run(command, numbers))
        for name in steps:
            after = [self._run(self.step(name, after), numbers)]
        return numbers

    def _run(self, command, numbers):
        number = tools.output_of(command).strip().split(";")[0]
        numbers.append(number)
        self.folder.write(self.folder.jobs, json.dumps(numbers) + "\n")
        return number


def in_queue(folder):
    """Those of the jobs that were last submitted for this folder which are not over yet, as "203_[4-9] RUNNING"."""
    try:
        numbers = json.loads(folder.jobs.read_text())
    except FileNotFoundError:
        return []
    except (OSError, ValueError) as error:
        raise Failure(f"{folder.jobs}: cannot be read: {error}") from None
    queue = tools.output_of(["squeue", "-h", "-o", "%F %i %T"])
    waiting = [line.split() for line in queue.splitlines()]
    return [f"{words[1]} {words[2]}" for words in waiting if words and words[0] in numbers]
