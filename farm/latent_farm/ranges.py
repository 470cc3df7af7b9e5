"""Sets of sample numbers as ascending lists of (first, end), and sets of tasks as Slurm writes them."""


def union(ranges):
    """The ranges joined where they touch or overlap."""
    joined = []
    for first, end in sorted((first, end) for first, end in ranges if first < end):
        if joined and first <= joined[-1][1]:
            joined[-1] = (joined[-1][0], max(end, joined[-1][1]))
        else:
            joined.append((first, end))
    return joined


def missing(wanted, held):
    """What `held`, a union, lacks of the one range `wanted`."""
    at, end = wanted
    gaps = []
    for first, last in held:
        if last <= at or first >= end:
            continue
        if first > at:
            gaps.append((at, first))
        at = max(at, last)
    if at < end:
        gaps.append((at, end))
    return gaps


def size(ranges):
    return sum(end - first for first, end in ranges)


def text(ranges, most=8):
    """As the other tools write them: 0:4096, 8192:12288 and 3 more."""
    shown = ", ".join(f"{first}:{end}" for first, end in ranges[:most])
    return shown + (f" and {len(ranges) - most} more" if len(ranges) > most else "")


def tasks_text(listed):
    """What `array_list` returned, with a noun: task 3, tasks 0-3,7."""
    return f"task{'' if listed.isdigit() else 's'} {listed}"


def array_list(numbers):
    """As Slurm's --array takes them: 0-3,7."""
    joined = union((number, number + 1) for number in numbers)
    return ",".join(f"{first}" if end == first + 1 else f"{first}-{end - 1}" for first, end in joined)
