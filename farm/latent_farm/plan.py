"""The plan of a render: which samples each task renders, with what settings, how the steps are run, and what was predicted."""
import dataclasses
import math
import os
import re
import typing

from latent_farm import noise
from latent_farm.errors import Misuse
from latent_farm.schema import BOOLEAN, HEX, TEXT, TEXTS, member, one_of, real, whole
from latent_farm.units import MOST_SECONDS

VERSION = 1
MOST_RUNS = 1 << 20  # of a file
MOST_TASKS = 1 << 20
MOST_SAMPLES = 1 << 62
FPS = 0.001, 1000  # frames per second
TILE = 256  # pixels: the sides of a picture's tiles; strips are whole rows of tiles
ENGINES = ("slurm", "parallel", "shell")
STEPS = ("render", "merge", "develop", "print")


class Stage(typing.NamedTuple):
    """A step of a plan, of which nothing begins before all of the one before is done."""

    name: str  # render, noise, merge, develop, join or print; film or done, when all frames are finished
    tasks: list | None = None  # numbers, for a script that takes one; else it is run once

    @property
    def script(self):
        return "task" if self.name == "render" else self.name


@dataclasses.dataclass
class Plan:
    """Task k renders samples k * task_samples up to the next task's, or to `samples`."""

    scene: str = member(TEXT)
    spp: float = member(real(0, 1e15))
    options: list = member(TEXTS)  # of latent-render, beyond those that follow from the plan
    samples: int = member(whole(1, MOST_SAMPLES))
    task_samples: int = member(whole(1, MOST_SAMPLES))
    run_samples: int = member(whole(1, MOST_SAMPLES))
    job: str = member(HEX)
    rate: float = member(real(1e-9, 1e15))  # samples per second of one task, as predicted
    bytes_per_sample: float = member(real(0, 1e6))
    memory: int = member(whole(1, 1 << 62))  # bytes that a task takes
    machines: int = member(whole(1, MOST_TASKS), default=1)  # that work at once, as far as is known; for predictions only
    cpus: int = member(whole(0, MOST_TASKS), default=0)  # of a task; 0: all that the machine has
    develop: list = member(TEXTS, default_factory=list)  # options of latent-develop
    develop_since: float = member(real(0, 1e12), default=0)  # when these were chosen; an older picture is another
    strips: int = member(whole(1, MOST_TASKS), default=1)  # of the picture, one for each job of latent-develop
    compact: bool = member(BOOLEAN, default=False)  # the merged file has few large runs
    print: list = member(TEXTS, default_factory=list)  # options of latent-convert
    print_since: float = member(real(0, 1e12), default=0)  # when these were chosen
    fps: float = member(real(*FPS), default=24)  # of the film of all frames
    on_done: str = member(TEXT, default="")  # a command of the shell, for when all is done
    until: str = member(one_of(*STEPS), default="develop")  # the last step
    until_noise: str = member(noise.TARGET, default="")  # a target, until which the plan grows; empty: none
    max_spp: float = member(real(0, 1e15), default=0)  # up to which it may grow; 0: any
    checkpoint: float = member(real(0, MOST_SECONDS), default=60)  # seconds
    engine: str = member(one_of(*ENGINES), default="shell")
    hosts: str = member(TEXT, default="")  # the file that lists the machines of parallel; empty: this machine
    time: float = member(real(0, MOST_SECONDS), default=0)  # seconds that Slurm gives a task; 0: as predicted, with room
    throttle: int = member(whole(0, MOST_TASKS), default=0)  # tasks of an array of Slurm that run at once; 0: all
    sbatch: list = member(TEXTS, default_factory=list)  # options of sbatch
    version: int = member(whole(VERSION, VERSION), default=VERSION)

    def check(self):
        """That the members fit together. Errors: Misuse, whose text names the option that mends it."""
        if self.tasks > MOST_TASKS:
            raise Misuse(f"{self.tasks} tasks: a plan has at most {MOST_TASKS}; use fewer --tasks")
        most = MOST_RUNS * self.run_samples
        if self.task_samples > most:
            raise Misuse(f"{self.tasks} task{'' if self.tasks == 1 else 's'} of {self.task_samples} samples: a file holds at most 2^20 runs, "
                         f"here of {self.run_samples} samples; use --tasks {math.ceil(self.samples / most)} or more")
        if self.samples > most and self.until != "render" and not self.compact:
            raise Misuse(f"{self.samples} samples in runs of {self.run_samples} do not fit into one merged file, which holds at most 2^20 "
                         "runs; use --until render, and develop the parts")
        if given("--frames", self.develop):
            raise Misuse("--frames of latent-develop makes several pictures, but the develop step makes one; use --until merge, and develop "
                         "samples.latent")
        for option, column in SEEN_BY_THE_LENS.items():
            if given(option, self.develop) and column not in aovs(self.options):
                raise Misuse(f'--develop: {option} needs samples that were rendered with --aov {column}; add, at the end of the line: -- --aov {column}')
        if self.max_spp and not self.target:
            raise Misuse("--max-spp: needs --until-noise")
        if self.strips == 1:
            return
        if not size_of(self.develop):
            raise Misuse('--strips: needs the size of the picture, such as --develop="--size 30000x20000"')
        for option in ("--mipmap", "--crop", "--budget", "--fraction"):
            if given(option, self.develop):
                raise Misuse(f"--strips: does not go with {option} of latent-develop")

    @property
    def target(self):
        """None if the plan has as many samples as it is to have."""
        return noise.target_of(self.until_noise)

    @property
    def tasks(self):
        return -(-self.samples // self.task_samples)

    @property
    def name(self):
        """The scene's, as a word."""
        return re.sub(r"[^\w.-]", "_", os.path.splitext(os.path.basename(self.scene))[0])[:60]

    @property
    def seconds(self):
        """Of rendering, on one machine."""
        return self.samples / self.rate

    @property
    def task_seconds(self):
        return min(self.samples, self.task_samples) / self.rate

    @property
    def bytes(self):
        """Of all parts; the merged file is as large again."""
        return round(self.samples * self.bytes_per_sample)

    @property
    def render_options(self):
        """`options`, and the length of a run, which may be one of them."""
        words = iter(self.options)
        others = []
        for word in words:
            if word == "--run-samples":
                next(words, None)
            elif not word.startswith("--run-samples="):
                others.append(word)
        return [*others, "--run-samples", str(self.run_samples)]

    @property
    def steps_left_out(self):
        """Of those that make a picture."""
        return list(STEPS[STEPS.index(self.until) + 1:STEPS.index("print")])

    @property
    def prints_by_auto_exposure(self):
        return not any(word.split("=")[0] in ("--sensitivity", "--paper", "--tone") or word.startswith("-s") for word in self.print)

    @property
    def strip_rows(self):
        """Rows of pixels of each strip but the last."""
        _, height = size_of(self.develop)
        return math.ceil(height / self.strips / TILE) * TILE

    @property
    def strip_tasks(self):
        """The numbers of the strips; None if the picture is developed as a whole."""
        return list(range(math.ceil(size_of(self.develop)[1] / self.strip_rows))) if self.strips > 1 else None

    def range_of(self, task):
        return task * self.task_samples, min((task + 1) * self.task_samples, self.samples)

    def tasks_of(self, ranges):
        """The numbers of the tasks that render any of these samples, ascending."""
        end, found = 0, []
        for first, last in ranges:
            begin = max(end, first // self.task_samples)
            end = max(end, -(-last // self.task_samples))
            found.extend(range(begin, end))
        return found


def given(option, words):
    return any(word.split("=")[0] == option for word in words)


SEEN_BY_THE_LENS = {"--aperture": "lens", "--focus": "lens", "--shutter": "time"}  # options of latent-develop, and what they need


def aovs(options):
    """What --aov of latent-render asks for."""
    found = re.findall(r"--aov[ =]([\w.,-]+)", " ".join(options), re.ASCII)
    return ",".join(found).split(",")


def size_of(develop):
    """Width and height that --size WxH of latent-develop asks for; none if it asks for less."""
    found = re.search(r"--size[ =]([1-9]\d{0,8})x([1-9]\d{0,8})(?: |$)", " ".join(develop), re.ASCII)
    return (int(found[1]), int(found[2])) if found else None


def strip_name(task):
    return f"strip-{task:05}.exr"


def part_name(task):
    return f"part-{task:05}.latent"


OWN = "write it before the --"
INSIDE = "latent-farm gives every task its own; --tasks says how many there are"
ALWAYS = "tasks of a farm do without it"
TAKEN = {"--spp": OWN, "--checkpoint": OWN, "--until-noise": OWN, "--max-spp": OWN, "--samples": INSIDE, "--shard": INSIDE,
         "--threads": "use --cpus, before the --",
         "-o": "parts are written into the folder that --out names", "--output": "parts are written into the folder that --out names",
         **dict.fromkeys(("--dry-run", "--json", "--force", "--quiet", "-q", "--max-time", "--more-than"), ALWAYS)}


FILES = ("--add", "--sky")  # of latent-render, by whose names tasks find them from any folder


def with_absolute_names(options):
    found = []
    for option in options:
        name, equals, value = option.partition("=")
        if found and found[-1] in FILES:
            option = os.path.abspath(option)
        elif equals and name in FILES:
            option = f"{name}={os.path.abspath(value)}"
        found.append(option)
    return found


def check_render_options(options):
    for option in options:
        name = option.split("=")[0]
        if name in TAKEN:
            raise Misuse(f"{name} of latent-render: {TAKEN[name]}")
