"""How a render is cut into tasks. docs/farm.md, "How large is a task?"."""
import math

SHORTEST, LONGEST = 10 * 60, 60 * 60  # seconds of a task, where the render is long enough to choose
TASKS_PER_MACHINE = 4  # so that fast machines can take more than slow ones
MOST_PER_ARRAY = 1000  # Slurm's default allows 1001
LEAST_RUN = 1024  # samples; the shortest run that a file may have
ROUNDING = 1.1  # the longest task, at most, by the mean of all


def count_tasks(seconds, machines):
    """How many tasks a render of so many seconds on one machine should have."""
    each = min(max(seconds / (TASKS_PER_MACHINE * machines), SHORTEST), LONGEST)
    return max(math.ceil(seconds / each), machines)


def cut(samples, tasks, run_samples, may_shorten):
    """(samples per task, samples per run): tasks of whole runs, all but the last equal, as near to `tasks` as whole runs allow.

    If a few long runs would leave machines idle, runs get shorter, unless they may not.
    """
    mean = samples / tasks
    while may_shorten and run_samples > LEAST_RUN and math.ceil(mean / run_samples) * run_samples > ROUNDING * mean:
        run_samples //= 2
    return math.ceil(mean / run_samples) * run_samples, run_samples


def arrays_of(tasks, most=MOST_PER_ARRAY):
    """Task numbers, ascending, as [(offset, [numbers less offset])]: one job array each, with indices below `most`."""
    arrays = {}
    for task in tasks:
        offset = task // most * most
        arrays.setdefault(offset, []).append(task - offset)
    return sorted(arrays.items())
