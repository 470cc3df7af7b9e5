"""The header and the job in it."""
import math

from native import hash64

from .rules import Rules, check, fields, is_provenance, rule

WIDTHS = {1: 1, 2: 2, 3: 4, 4: 8, 5: 4, 6: 8}  # of an extra column's values, by its type


class Job:
    def __init__(self, body, minor):
        (*self.id, width, height, self.kind, self.sampler, self.k, self.light_paths) = fields("QQIIBBHI", body, 0)
        (unit, run_bytes, run_samples, *self.shifts, knots, extra, provenance) = fields("dQIIIIII", body, 32)
        check(width > 0 and height > 0 and math.gcd(width, height) == 1, "aspect")
        check(self.kind in (1, 2) and self.sampler in (0, 1, 2), "kind or sampler")
        check((1 <= self.k <= 1024) if self.kind == 1 else self.k == 0, "k")
        check(0 < unit < float("inf") and 2**16 <= run_bytes <= 2**30, "light unit or R")
        check(run_samples in [2**i for i in range(10, 23)], "S")
        check(self.sampler or self.shifts == [0, 0], "shifts")
        check(knots == 0 or (self.kind == 1 and 2 <= knots <= 4096), "number of knots")
        check(extra <= 128 and provenance <= 2**19, "extra columns or provenance")
        at = 72
        self.knots = [fields("QI", body, at + 12 * i) for i in range(knots)]
        at += 12 * knots
        if knots:
            check(self.knots[0][0] == 0 and self.knots[-1][0] == 2**48 and self.knots[-1][1] <= 4000 << 20, "knots")
            check(all(a[0] < b[0] and a[1] < b[1] for a, b in zip(self.knots, self.knots[1:])), "order of knots")
        self.extra = []
        for _ in range(extra):
            (kind, length) = fields("BB", body, at)
            check(kind in WIDTHS and 1 <= length <= 64, "extra column")
            name = bytes(body[at + 2 : at + 2 + length])
            self.extra.append((name.decode("utf-8" if Rules.checked else "latin-1"), WIDTHS[kind]))
            at += 2 + length
        check(len({name for name, _ in self.extra}) == extra, "names of extra columns")
        rule(is_provenance(body[at : at + provenance], 32), "provenance of the header")
        at += provenance
        self.precision = 23
        if minor >= 1:
            (self.precision,) = fields("B", body, at)
            at += 1
        check(1 <= self.precision <= 23, "precision")
        self.pixels = (0, 0)
        if minor >= 2:
            self.pixels = fields("II", body, at)
            at += 8
        check(all(1 <= side <= 2**20 for side in self.pixels) if self.sampler == 2 else self.pixels == (0, 0), "pixels")
        check(at == len(body) or minor > 2, "the header's fields do not fill it")

    def columns(self, camera):
        """(number, width) of each column of a page, in order."""
        columns = [(1, 8), (2, 4), (3, 4)] + ([(4, 4)] if camera else [])
        if self.kind == 2:
            columns += [(5, 4), (6, 4), (7, 4)]
        elif self.knots:
            columns += [(8, 2), (9, 4), (10, 2), (11, 4)]
        else:
            columns += [(8, 2), (11, 4), (12, 4)]
        return columns + [(64 + i, width) for i, (_, width) in enumerate(self.extra)]

    def most_records(self):
        most = 6144 if self.kind == 2 else min(max(86016 // self.k, 64), 6144)
        return min(most, 786432 // max(1, sum(width for _, width in self.extra)))


def read_header(data):
    """Job, offset of the first run, and whether both copies are sound and equal."""
    for at in range(0, min(len(data), 2**20 + 1), 4096):
        if data[at : at + 8] != b"\x8dLTDBF\r\n":
            continue
        (major, minor, size, features, body_size, body_hash) = fields("HHIQQQ", data, at + 8)
        if hash64(data[at : at + 56]) != fields("Q", data, at + 56)[0] or (at != 0 and at != size):
            continue
        check(major == 1 and features < 16, "another format")
        check(size % 4096 == 0 and 0 < size <= 2**20 and body_size <= size - 64, "size of the header")
        if hash64(data[at + 64 : at + size]) == body_hash:
            rule(not any(data[at + 40 : at + 56]), "reserved bytes of the header")
            check(not any(data[at + 64 + body_size : at + size]), "zeros of the header")
            job = Job(data[at + 64 : at + 64 + body_size], minor)
            check(features & 13 == (job.precision < 23) + 4 * (len(job.extra) > 16) + 8 * (job.sampler == 2), "features")
            return job, 2 * size, data[:size] == data[size : 2 * size]
    raise ValueError("no header")
