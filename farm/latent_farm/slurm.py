"""Slurm, as far as latent-farm needs it: what its nodes are, what is in its queue, and how a chain of jobs is submitted."""
import os
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


def ask(command, advice):
    """What a command of Slurm answers."""
    try:
        return tools.output_of(command)
    except Failure as error:
        raise Failure(f"Slurm: {command[0]}: {error}; {advice}") from None


class Chain:
    """The stages of a plan as jobs, or arrays of jobs. Those of a stage wait for those of the one before, and do not run at all if
    one of them has failed."""

    def __init__(self, folder, plan):
        self.folder, self.plan = folder, plan

    def lines(self, stages, after=(), name="J"):
        """What `submit` runs, for a shell, and what stands there for the jobs of the last stage. Variables begin with `name`."""
        lines = []

        def start(*words):
            lines.append(f"{name}{len(lines)}=$({' '.join(words)})")
            return f"${{{name}{len(lines) - 1}%;*}}"  # sbatch prints NUMBER or NUMBER;CLUSTER
        return lines, self._start(stages, after, start, shlex.quote)

    def submit(self, stages, after=(), known=()):
        """The numbers of the jobs, and those of the last stage. They are kept in the folder, after those that are `known`."""
        numbers = []

        def start(*words):
            numbers.append(ask(words, "to do without Slurm, use --engine parallel or --engine shell").strip().split(";")[0])
            self.folder.write_jobs([*known, *numbers])
            return numbers[-1]
        return numbers, self._start(stages, after, start, str)

    def _jobs(self, stage):
        """What follows sbatch's other options for each of its jobs."""
        script = str(self.folder.path / f"{stage.script}.sbatch")
        if stage.tasks is None:
            return [[script]]
        limit = f"%{self.plan.throttle}" if self.plan.throttle else ""
        return [[f"--array={ranges.array_list(indices)}{limit}", script, str(offset)]
                for offset, indices in sizing.arrays_of(stage.tasks)]

    def _start(self, stages, after, start, quote):
        """`start` takes the words of a command, and returns the number of the job, or what stands for it."""
        before = after
        for stage in stages:
            wait = [f"--dependency=afterok:{':'.join(before)}", "--kill-on-invalid-dep=yes"] if before else []
            own = [f"--chdir={self.folder.path}", f"--job-name={self.plan.name}-{stage.name}", *self.plan.sbatch]
            before = [start("sbatch", "--parsable", *map(quote, own), *wait, *map(quote, job)) for job in self._jobs(stage)]
        return before


def in_queue(folder):
    """Those of the jobs that were last submitted for this folder which are not over yet, as "203_[4-9] RUNNING"."""
    numbers = folder.read_jobs()
    if not numbers:
        return []
    queue = ask(["squeue", "-h", "-o", "%F %i %T"], f"if no job of this plan is queued, remove {folder.jobs}")
    waiting = [line.split() for line in queue.splitlines()]
    numbers = set(numbers) - {os.environ.get("SLURM_JOB_ID")}  # of the step that measures noise, which runs this
    return [f"{words[1]} {words[2]}" for words in waiting if words and words[0] in numbers]
