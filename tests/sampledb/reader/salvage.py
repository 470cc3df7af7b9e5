"""What can be saved of a damaged file: docs/format.md, "Reading"."""
from native import hash64

from .footer import begins_footer, footer_from_end, read_footer
from .header import read_header
from .rules import UNREADABLE, fields
from .run import check_run_header, read_run, run_size


def look_for_run(job, data, at):
    """"run", "other" (of a later version), "cut" (off by the end of the file) or None."""
    header = data[at : at + 256]
    if len(header) < 256 or header[:8] != b"\x8dLTDBR\r\n" or hash64(header[:248]) != fields("Q", header, 248)[0]:
        return None
    if list(fields("QQ", header, 24)) != job.id:
        return None
    if at + run_size(header) > len(data):
        return "cut"
    if fields("H", header, 8)[0] != 1 or fields("Q", header, 16)[0] != 0:
        return "other"
    try:
        check_run_header(job, header)
    except UNREADABLE:
        return None
    return "run"


def index_agrees(data, at):
    header = data[at : at + 256]
    (intervals, pages_size) = fields("I", header, 12) + fields("Q", header, 104)
    index = at + 256 + pages_size
    return fields("Q", data, index) + fields("Q", data, index + 16 * intervals - 8) == fields("QQ", header, 40)


def walk(job, data, begin):
    """(offsets of the runs, what is damaged, where the walk ended)."""
    runs, damage, at, from_end = [], [], begin, footer_from_end(data)
    end = from_end if from_end is not None and begin <= from_end <= len(data) else len(data)
    while at < end and not begins_footer(data, at):
        found = look_for_run(job, data, at)
        if found == "cut" and from_end is None:
            break
        if found in (None, "cut"):
            place = at + 4096
            while place < end and not begins_footer(data, place):
                found = look_for_run(job, data, place)
                if (found == "run" and index_agrees(data, place)) or found == "other" or (found == "cut" and from_end is None):
                    break
                place += 4096
            if place >= end and from_end is None:
                break  # it may be a write that was cut short
            damage.append("bytes %d to %d" % (at, min(place, end)))
            at = min(place, end)
            continue
        if found == "run":
            runs.append(at)
        else:
            damage.append("a run of a later version at byte %d" % at)
        at += run_size(data[at : at + 256])
    return runs, damage, at


def salvage(path):
    """(intervals, camera records, light records, content hash) of every run that is intact, and what is damaged."""
    with open(path, "rb") as file:
        data = file.read()
    job, begin, header_is_sound = read_header(data)
    offsets, damage, at = walk(job, data, begin)
    if not header_is_sound:
        damage.append("a copy of the header")
    try:
        read_footer(data, at, [(offset, data[offset : offset + 256]) for offset in offsets])
    except UNREADABLE as error:
        if ".latent.part." not in str(path) or footer_from_end(data) is not None:
            damage.append("the end of the file: %s" % error)
    intact = []
    for offset in offsets:
        try:
            _, camera, light, ranges, _ = read_run(job, data, offset)
        except UNREADABLE as error:
            damage.append("run at byte %d: %s" % (offset, error))
            continue
        intact.append((ranges, camera, light, "%016x%016x" % fields("QQ", data, offset + 120)[::-1]))
    return intact, damage
