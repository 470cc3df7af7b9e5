"""The plan of a render, DIR/plan.json: which samples each task renders, with what settings, and what was predicted."""
import contextlib
import dataclasses
import json
import math
import os
import pathlib
import re
import typing

from latent_farm.errors import Failure, Misuse

VERSION = 1
MOST_RUNS = 1 << 20  # of a file
TILE = 256  # pixels: the sides of a picture's tiles; strips are whole rows of tiles


class Stage(typing.NamedTuple):
    """A step of a plan, of which nothing begins before all of the one before is done."""

    name: str  # render, merge, develop or join
    tasks: list | None = None  # numbers, for a script that takes one; else it is run once


@dataclasses.dataclass
class Plan:
    """Task k renders samples k * task_samples up to the next task's, or to `samples`."""

    scene: str
    spp: float
    options: list  # of latent-render, beyond those that follow from the plan
    samples: int
    task_samples: int
    run_samples: int
    job: str
    rate: float  # samples per second of one task, as predicted
    bytes_per_sample: float
    memory: int  # bytes that a task takes
    machines: int  # that work at once, as far as is known; for predictions only
    cpus: int  # of a task; 0: all that the machine has
    develop: list  # options of latent-develop
    develop_since: float = 0  # when these were chosen; an older picture is another
    strips: int = 1  # of the picture, one for each job of latent-develop, as far as it has rows of tiles
    compact: bool = False  # the merged file has few large runs
    until: str = "develop"  # the last step: render, merge or develop
    checkpoint: float = 60  # seconds
    version: int = VERSION

    def __post_init__(self):
        """Fails if a file held something else."""
        for field in dataclasses.fields(self):
            if not isinstance(getattr(self, field.name), (int, float) if field.type is float else field.type):
                raise TypeError
        if min(self.samples, self.task_samples, self.run_samples, self.rate, self.strips) <= 0:
            raise ValueError

    @property
    def tasks(self):
        return math.ceil(self.samples / self.task_samples)

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
        steps = ["render", "merge", "develop"]
        return steps[steps.index(self.until) + 1:]

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


def size_of(develop):
    """Width and height that --size WxH of latent-develop asks for; none if it asks for less."""
    found = re.search(r"--size[ =](\d+)x(\d+)(?: |$)", " ".join(develop))
    return (int(found[1]), int(found[2])) if found else None


def check_runs(plan):
    """That each part fits into a file, and the merged file too."""
    most = MOST_RUNS * plan.run_samples
    if plan.task_samples > most:
        raise Misuse(f"{plan.tasks} task{'' if plan.tasks == 1 else 's'} of {plan.task_samples} samples: a file holds at most 2^20 runs, "
                     f"here of {plan.run_samples} samples; use --tasks {math.ceil(plan.samples / most)} or more")
    if plan.samples > most and plan.until != "render" and not plan.compact:
        raise Misuse(f"{plan.samples} samples in runs of {plan.run_samples} do not fit into one merged file, which holds at most 2^20 runs; "
                     "use --until render, and develop the parts")


def check_strips(plan):
    if plan.strips == 1:
        return
    if not size_of(plan.develop):
        raise Misuse('--strips: needs the size of the picture, such as --develop="--size 30000x20000"')
    for option in ("--mipmap", "--crop", "--budget", "--fraction"):
        if any(word.split("=")[0] == option for word in plan.develop):
            raise Misuse(f"--strips: does not go with {option} of latent-develop")


def strip_name(task):
    return f"strip-{task:05}.exr"


def part_name(task):
    return f"part-{task:05}.latent"


class Folder:
    """The folder of a plan, and what lies in it."""

    def __init__(self, path):
        self.path = pathlib.Path(os.path.abspath(path))
        self.plan_file = self.path / "plan.json"
        self.parts = self.path / "parts"
        self.logs = self.path / "logs"
        self.merged = self.path / "samples.latent"
        self.picture = self.path / "picture.exr"
        self.strips = self.path / "strips"
        self.jobs = self.path / "jobs.json"

    def script(self, stage):
        return self.path / ("task" if stage == "render" else stage)

    def has_plan(self):
        return self.plan_file.exists()

    def read_plan(self):
        try:
            data = json.loads(self.plan_file.read_text())
            if data.get("version") != VERSION:
                raise Failure(f"{self.plan_file}: made by another version of latent-farm")
            return Plan(**data)
        except FileNotFoundError:
            raise Failure(f"{self.path}: holds no plan; make one with latent-farm plan") from None
        except OSError as error:
            raise Failure(f"{self.plan_file}: cannot be read: {error.strerror}") from None
        except (ValueError, TypeError, AttributeError):
            raise Failure(f"{self.plan_file}: damaged, or not a plan of latent-farm") from None

    def write_plan(self, plan):
        self.write(self.plan_file, json.dumps(dataclasses.asdict(plan), indent=2) + "\n")

    def make(self):
        try:
            self.parts.mkdir(parents=True, exist_ok=True)
            self.logs.mkdir(exist_ok=True)
        except OSError as error:
            raise Failure(f"{error.filename}: cannot create the folder: {error.strerror}") from None

    @contextlib.contextmanager
    def made(self):
        """The folder as a plan needs it; if that comes to nothing, it is gone again, unless it was there."""
        was_there = self.path.exists()
        self.make()
        try:
            yield
        except BaseException:
            for folder in [self.parts, self.logs] if was_there else [self.parts, self.logs, self.path]:
                with contextlib.suppress(OSError):  # not empty
                    folder.rmdir()
            raise

    def write(self, path, text, mode=0o644):
        """A file appears under its name when it is complete."""
        temporary = path.with_name(f".{path.name}.{os.getpid()}")
        try:
            temporary.write_text(text)
            temporary.chmod(mode)
            temporary.replace(path)
        except OSError as error:
            temporary.unlink(missing_ok=True)
            raise Failure(f"{path}: cannot be written: {error.strerror}") from None


TAKEN = {"-o", "--output", "--spp", "--samples", "--shard", "--threads", "--dry-run", "--json", "--force", "--quiet", "-q", "--checkpoint",
         "--max-time", "--more-than"}


def check_render_options(options):
    for option in options:
        if option.split("=")[0] in TAKEN:
            raise Misuse(f"{option.split('=')[0]}: is set by latent-farm; see latent-farm plan --help")
