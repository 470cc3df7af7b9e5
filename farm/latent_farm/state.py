"""What has been rendered: read from the files in the folder of a plan, and from nothing else."""
import calendar
import dataclasses
import os
import re
import shutil
import time

from latent_farm import film as film_of
from latent_farm import logs, noise, ranges, tools
from latent_farm.plan import Stage, part_name, strip_name

BATCH = 100  # files of one call of latent-inspect
NAME = re.compile(r"part-(\d+)\.latent(\.part\..+)?", re.ASCII)


@dataclasses.dataclass
class PartFile:
    """NAME.latent, or an attempt at it."""

    name: str
    task: int
    attempt: bool
    held: list  # ranges of samples
    host: str
    begun: float  # seconds since 1970, by the clock of its machine
    changed: float  # when a run was last committed to it, by the clock of the file system
    bytes: int
    adopted: int  # samples that earlier attempts had rendered
    over: bool = False  # an attempt that failed or was interrupted, and says so in its log

    @property
    def rate(self):
        """Samples per second; None if there is no saying."""
        seconds, rendered = self.changed - self.begun, ranges.size(self.held) - self.adopted
        return rendered / seconds if rendered > 0 and seconds > 0.5 else None


@dataclasses.dataclass
class State:
    files: list
    left_out: list  # what is there and does not count, with the reason
    spare: list  # attempts at tasks whose part is finished: copies of a folder may have them
    merged: list  # ranges of samples of the merged file
    disk: int  # bytes used
    free: int

    def held_by(self, task):
        return ranges.union(r for file in self.files if file.task == task for r in file.held)

    def held(self):
        return ranges.union([*self.merged, *(r for file in self.files for r in file.held)])


def origin_of(info):
    """(host, when it began, samples that earlier attempts had rendered) of a file, as far as it says."""
    origin = info["origin"] if isinstance(info["origin"], dict) else {}
    host, date, before = (origin.get(key) for key in ("host", "date", "committed_before"))
    try:
        begun = calendar.timegm(time.strptime(date, "%Y-%m-%dT%H:%M:%SZ"))
    except (TypeError, ValueError, OverflowError):
        begun = float("inf")
    return host if isinstance(host, str) and host else "unknown", begun, before if type(before) is int else 0


def read_state(folder, plan):
    names = sorted(os.listdir(folder.parts)) if folder.parts.is_dir() else []
    paths = [folder.parts / name for name in names if not name.startswith(".")]
    if folder.merged.exists():
        paths.append(folder.merged)
    state = State([], [], [], [], 0, shutil.disk_usage(folder.path).free)
    ours = [path for path in paths if path == folder.merged or NAME.fullmatch(path.name)]
    state.left_out += [(str(path), "not the name of a part") for path in paths if path not in ours]
    for at in range(0, len(ours), BATCH):
        for path, info in zip(ours[at:at + BATCH], tools.info(ours[at:at + BATCH])):
            take(state, folder, plan, path, info)
    finished = {file.task for file in state.files if not file.attempt} - set(unfinished(plan, state))
    state.spare = [file for file in state.files if file.attempt and file.task in finished]
    state.files = [file for file in state.files if file not in state.spare]
    state.disk -= sum(file.bytes for file in state.spare)
    return state


def take(state, folder, plan, path, info):
    try:
        status = path.stat()
    except FileNotFoundError:
        return  # published or made superfluous since the folder was listed
    except OSError as error:
        state.left_out.append((str(path), error.strerror))
        return
    name = NAME.fullmatch(path.name)
    attempt = bool(name and name[2])
    if "error" in info:
        if not (attempt and status.st_size < 1 << 16):  # a file that has just been begun
            state.left_out.append((str(path), info["error"].removeprefix(f"{path}: ")))
        return
    if info["job"] != plan.job:
        state.left_out.append((str(path), f"belongs to job {info['job']}"))
        return
    state.disk += status.st_size
    held = [tuple(r) for r in info["samples"]]
    if path == folder.merged:
        state.merged = ranges.union(held)
        return
    state.left_out += [(str(path), reason) for reason in info["damage"]]
    host, begun, before = origin_of(info)
    task = int(name[1])
    over = attempt and logs.ended(folder, "task", task) >= status.st_mtime
    state.files.append(PartFile(path.name, task, attempt, held, host, begun, status.st_mtime, status.st_size, 0 if attempt else before, over))


def unfinished(plan, state):
    """The tasks that are still to be run: their part has no final name, or lacks samples, and is not in the merged file either."""
    published = {}
    for file in state.files:
        if not file.attempt:
            published.setdefault(file.task, []).extend(file.held)
    return [task for task in plan.tasks_of(ranges.missing((0, plan.samples), state.merged))
            if ranges.missing(plan.range_of(task), ranges.union(published.get(task, [])))]


def stages_left(folder, plan, state, tasks):
    """The stages that are still to be run, where `tasks` are not rendered yet."""
    render = [Stage("render", tasks)] if tasks else []
    if tasks or not noise.is_over(folder, plan):
        render += [Stage("noise")] * bool(plan.target)
    if plan.until == "render":
        return render
    merge = [*render, Stage("merge")] if render or ranges.missing((0, plan.samples), state.merged) else []
    if plan.until == "merge":
        return merge
    develop = [] if not merge and is_newer(folder.picture, folder.merged, plan.develop_since) else [Stage("develop")]
    if develop and plan.strips > 1:
        strips = [task for task in plan.strip_tasks if merge or not is_newer(folder.strips / strip_name(task), folder.merged, plan.develop_since)]
        develop = [*([Stage("develop", strips)] if strips else []), Stage("join")]
    if plan.until == "develop" or not merge + develop and is_newer(folder.print, folder.picture, plan.print_since):
        return merge + develop
    return [*merge, *develop, Stage("print")]


def is_newer(made, source, since=0):
    """Whether a file was made of what `source` is now, and after that time."""
    try:
        return made.is_file() and made.stat().st_mtime >= max(since, source.stat().st_mtime)
    except OSError:
        return False


def last_stages(folder, plan, works):
    """What is to be done when all frames are finished: `works` has the folder and the stages of each."""
    busy = any(stages for _, stages in works)
    film = []
    if plan.until == "print" and len(works) > 1 and film_of.is_possible():
        film = [] if not busy and all(is_newer(folder.film, frame.print) for frame, _ in works) else [Stage("film")]
    again = plan.on_done and logs.failure(folder, "done", None)
    return [*film, *([Stage("done")] if plan.on_done and (busy or film or again) else [])]
