#!/usr/bin/env python3
"""A second reader of sample files, written from docs/format.md alone and slow on purpose: whatever it cannot read, the page does
not say. It reads every file given, decodes every column of every page and checks every rule of the page, those for writers, too.

    read_latent.py [--records] FILE...      "FILE: RUNS runs, CAMERA camera records, LIGHT light records, COVERAGE";
                                            with --records the records instead: a JSON object a line, values as their bits
    read_latent.py --salvage FILE...        "FILE: RUNS intact runs, COVERAGE", then what is damaged; rules for writers do not count
    read_latent.py --vectors docs/format.md checks the test vectors of the page

Ends with 1 at the first contradiction."""
import contextlib
import json
import math
import struct
import sys

from native import hash64, hash128, zstd_decompress, zstd_frame_size

M32, M64 = 2**32 - 1, 2**64 - 1
WIDTHS = {1: 1, 2: 2, 3: 4, 4: 8, 5: 4, 6: 8}  # of an extra column's values, by its type


def check(condition, what):
    if not condition:
        raise ValueError(what)


class Rules:
    """Rules that only writers must keep are checked, too, except inside `with Rules.for_readers()`."""

    checked = True

    @classmethod
    @contextlib.contextmanager
    def for_readers(cls):
        cls.checked = False
        try:
            yield
        finally:
            cls.checked = True


def rule(condition, what):
    check(condition or not Rules.checked, what)


def fields(layout, data, at):
    return struct.unpack_from("<" + layout, data, at)


def depth_of(value):
    return 1 + max(map(depth_of, value.values() if isinstance(value, dict) else value), default=0) if isinstance(value, (dict, list)) else 0


def is_provenance(text, most):
    """Nothing, or a JSON object nested at most `most` deep."""
    try:
        return not text or (isinstance(value := json.loads(bytes(text)), dict) and depth_of(value) <= most)
    except (ValueError, RecursionError):
        return False


# ---- header


class Job:
    def __init__(self, body, minor):
        (*self.id, width, height, self.kind, self.sampler, self.k, self.light_paths) = fields("QQIIBBHI", body, 0)
        (unit, run_bytes, run_samples, *self.shifts, knots, extra, provenance) = fields("dQIIIIII", body, 32)
        check(width > 0 and height > 0 and math.gcd(width, height) == 1, "aspect")
        check(self.kind in (1, 2) and self.sampler in (0, 1), "kind or sampler")
        check((1 <= self.k <= 1024) if self.kind == 1 else self.k == 0, "k")
        check(0 < unit < float("inf") and 2**16 <= run_bytes <= 2**30, "light unit or R")
        check(run_samples in [2**i for i in range(10, 23)], "S")
        check(self.sampler or self.shifts == [0, 0], "shifts")
        check(knots == 0 or (self.kind == 1 and 2 <= knots <= 4096), "number of knots")
        check(extra <= 16 and provenance <= 2**19, "extra columns or provenance")
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
        check(at == len(body) or minor > 1, "the header's fields do not fill it")

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
        return 6144 if self.kind == 2 else min(max(86016 // self.k, 64), 6144)


def read_header(data):
    """Job, offset of the first run, and whether both copies are sound and equal."""
    for at in range(0, min(len(data), 2**20 + 1), 4096):
        if data[at : at + 8] != b"\x8dLTDBF\r\n":
            continue
        (major, minor, size, features, body_size, body_hash) = fields("HHIQQQ", data, at + 8)
        if hash64(data[at : at + 56]) != fields("Q", data, at + 56)[0] or (at != 0 and at != size):
            continue
        check(major == 1 and features in (0, 1), "another format")
        check(size % 4096 == 0 and 0 < size <= 2**20 and body_size <= size - 64, "size of the header")
        if hash64(data[at + 64 : at + size]) == body_hash:
            rule(not any(data[at + 40 : at + 56]), "reserved bytes of the header")
            check(not any(data[at + 64 + body_size : at + size]), "zeros of the header")
            job = Job(data[at + 64 : at + 64 + body_size], minor)
            check(features == (job.precision < 23), "features")
            return job, 2 * size, data[:size] == data[size : 2 * size]
    raise ValueError("no header")


# ---- samplers and wavelengths


def reverse(value, bits):
    return int(format(value, "0%db" % bits)[::-1], 2)


def halton(n, shifts):
    d, rest = 0, n
    for _ in range(40):
        d, rest = d * 3 + rest % 3, rest // 3
    return (reverse(n & M32, 32) + shifts[0]) & M32, ((d << 32) // 3**40 + shifts[1]) & M32


def wavelength(knots, k, xi, i):
    """Bits of wavelength i of the batch (xi, k)."""
    q = (i * 2**32 + xi) * 2**16 // k
    j = [cumulative <= q for cumulative, _ in knots].count(True) - 1
    slope = float(knots[j + 1][1] - knots[j][1]) / float(knots[j + 1][0] - knots[j][0])
    return fields("I", struct.pack("<f", (float(knots[j][1]) + slope * float(q - knots[j][0])) * 2.0**-20), 0)[0]


# ---- rounding


def rounding_seed(job_id, n, u, v):
    x = hash64(struct.pack("<QQ", *job_id)) + n * 0x9E3779B97F4A7C15 + (v << 32 | u) * 0xD1B54A32D192ED03 & M64
    x = (x ^ x >> 30) * 0xBF58476D1CE4E5B9 & M64
    x = (x ^ x >> 27) * 0x94D049BB133111EB & M64
    return x ^ x >> 31


def rounding_random(seed, i):
    x = (seed & M32) + i * 0x9E3779B9 & M32
    x = (x ^ x >> 16) * 0x7FEB352D & M32
    x = (x ^ x >> 15) * 0x846CA68B & M32
    return x ^ x >> 16 ^ seed >> 32


def rounded(bits, precision, random):
    step = 2 ** (23 - precision)
    return bits if bits % 2**31 > 0x7F800000 - step else bits + random % step & -step


def is_rounded(bits, precision):
    """Whether rounding leaves the value as it is, whatever the random number."""
    return rounded(bits, precision, M32) == bits


# ---- planes and transforms: bytes to values, which are unsigned integers, the bits of floats


def numbers(data, bits, count):
    """`count` packed numbers; the bits behind them are zero."""
    packed = int.from_bytes(data, "little")
    rule(packed >> count * bits == 0, "padding bits")
    return [packed >> i * bits & ((1 << bits) - 1) for i in range(count)]


def decode_plane(codec, data, size):
    if codec == 0:
        check(len(data) == size, "raw plane")
        return bytes(data)
    if codec == 2:
        check(len(data) == 1, "constant plane")
        return bytes(data) * size
    if codec == 3:
        bits, values = data[0], data[1 : 1 + (1 << data[0])]
        check(1 <= bits <= 7 and len(data) == 1 + (1 << bits) + (size + 7) // 8 * bits, "dictionary plane")
        indices = numbers(data[1 + (1 << bits) :], bits, size)
        used = set(indices)
        rule(not any(value for i, value in enumerate(values) if i not in used), "unused bytes of a dictionary")
        return bytes(values[i] for i in indices)
    check(bytes(data[:4]) == b"\x28\xb5\x2f\xfd" and zstd_frame_size(data) == len(data), "zstd frame")
    plane = zstd_decompress(data, size)
    check(plane is not None, "zstd plane")
    return plane


def unzigzag(value):
    return (value >> 1) ^ (M32 if value & 1 else 0)


def from_planes(planes):
    return [sum(byte << 8 * p for p, byte in enumerate(value)) for value in zip(*planes)]


def from_packed(plane, bits, base, count):
    return [base + number & M64 for number in numbers(plane, bits, count)]


def from_lattice(plane, bits, s, base, count):
    low = base % 2**s
    return [base - low + reverse((reverse(low, s) + number) % 2**s, s) for number in numbers(plane, bits, count)]


def unzigzag_steps(value, step):
    return unzigzag(value) << step & M32


def from_cross(planes, ys, step=0):
    return [y + unzigzag_steps(value, step) & M32 for value, y in zip(from_planes(planes), ys)]


def from_delta2(planes, counts, step=0):
    values, first = from_planes(planes), 0
    for n in counts:
        if n > 0:
            values[first] = values[first] << step & M32
        for i in range(first + 1, first + n):
            before = 2 * values[i - 1] - values[i - 2] if i > first + 1 else values[i - 1]
            values[i] = before + unzigzag_steps(values[i], step) & M32
        first += n
    return values


def packed_blocks(counts, k):
    """(numbers, which base) of every block of packed delta2."""
    cut = lambda n: [min(128, n - at) for at in range(0, n, 128)]
    rest = sum(n for n in counts if n != k)
    return [(n, i) for n in cut(counts.count(k)) for i in range(k)] + [(n, k) for n in cut(rest)]


def fields_size(n, width):
    return 16 * (((n + 3) // 4 * width + 31) // 32)


def from_fields(data, n, width):
    words = fields("%dI" % (len(data) // 4), data, 0)
    lanes = [sum(word << 32 * i for i, word in enumerate(words[lane::4])) for lane in range(4)]
    rule(all(lanes[i] >> (n + 3 - i) // 4 * width == 0 for i in range(4)), "bits that no field uses")
    return [lanes[j % 4] >> j // 4 * width & (1 << width) - 1 for j in range(n)]


def from_packed_delta2(plane, counts, k, step):
    """plane(i, size) decodes plane i to so many bytes."""
    blocks = packed_blocks(counts, k)
    bases = fields("%dI" % (k + 1), plane(0, 4 * k + 4), 0)
    widths, exceptions = plane(1, len(blocks)), plane(2, len(blocks))
    check(all(width <= 24 for width in widths), "width of fields")
    check(all(e <= n for e, (n, _) in zip(exceptions, blocks)), "number of exceptions")
    sizes = [fields_size(n, width) for (n, _), width in zip(blocks, widths)]
    data = plane(3, sum(sizes))
    positions, low, high = (plane(i, sum(exceptions)) for i in (4, 5, 6))
    numbers, field, exception = [], 0, 0
    for (n, base), width, count, size in zip(blocks, widths, exceptions, sizes):
        block = [bases[base] - (1 << width) // 2 + f for f in from_fields(data[field : field + size], n, width)]
        end = exception + count
        rule(all(a < b for a, b in zip(positions[exception:end], positions[exception + 1 : end])), "order of exceptions")
        for position, extra in zip(positions[exception:end], zip(low[exception:end], high[exception:end])):
            check(position < n, "an exception outside its block")
            extra = int.from_bytes(bytes(extra), "little", signed=True)
            rule(extra != 0, "an exception that adds nothing")
            block[position] += extra << width
        numbers.append(block)
        field, exception = field + size, end
    whole, rest = [], []
    while len(numbers) >= k and len(whole) < counts.count(k):
        whole += zip(*numbers[:k])  # of each record
        del numbers[:k]
    rest = [number for block in numbers for number in block]
    values, whole = [], iter(whole)
    for n in counts:
        if n == k:
            differences = next(whole)
        else:
            differences, rest = rest[:n], rest[n:]
        value = slope = 0
        for i, number in enumerate(differences):
            slope = slope + number if i > 0 else 0
            value = value + slope if i > 0 else number
            values.append(value << step & M32)
    return values


def stored_rows(bitmap, records):
    check(int.from_bytes(bitmap, "little") >> records == 0, "a bitmap with more rows than the page")
    rows = [i for i, bit in enumerate(numbers(bitmap, 1, records)) if bit]
    check(rows, "a bitmap that names no row")
    return rows


def from_sparse(rows, values, records):
    column = dict(zip(rows, values))
    return [column.get(i, 0) for i in range(records)]


# ---- page


def check_column(number, width, values, column_hash):
    decoded = b"".join(value.to_bytes(width, "little") for value in values)
    check(hash64(decoded) == column_hash, "column %d does not decode to its hash" % number)


def decode_page(job, data, camera, records, pair_count, content_hash):
    """Column number -> its values."""
    (count,) = fields("I", data, 0)
    expected = job.columns(camera)
    check(count == len(expected), "columns")
    table, at = [], 4
    for number, width in expected:
        (column, transform, bits, plane_count, s, base, column_hash) = fields("BBBBIQQ", data, at)
        check(column == number, "column %d instead of %d" % (column, number))
        check(transform <= 11 and bits <= 64 and plane_count <= 8 and s <= 32, "table of columns")
        stepped = transform in (8, 9, 10, 11)
        rule(transform in (1, 2) or base == 0, "base of the table")
        check(not stepped or 1 <= bits <= 22, "bits of a stepped transform")
        rule(bits == 23 - job.precision if stepped else transform in (1, 2) or bits == 0, "bits of the table")
        check(transform != 2 or s >= 1, "s of the table")
        rule(transform == 2 or s == 0, "s of the table")
        words = fields("%dI" % plane_count, data, at + 24)
        at += 24 + 4 * plane_count
        table.append((number, width, transform, bits, s, base, column_hash, words))
    check(hash64(b"".join(struct.pack("<Q", t[6]) for t in table)) == content_hash, "content hash of the page")

    stored = {}
    for number, _, _, _, _, _, _, words in table:
        stored[number] = []
        for word in words:
            stored[number].append((word >> 30, data[at : at + word % 2**30]))
            at += word % 2**30
    check(at == len(data), "planes do not fill the page")

    columns = {}
    order = sorted(table, key=lambda t: (t[0] != 1, t[0] != 6))  # samples before positions, y before x and z
    rows = None
    for number, width, transform, bits, s, base, column_hash, words in order:
        allowed = {1: (1, 2), 2: (0, 1, 3), 3: (0, 1, 3), 5: (0, 1, 4, 7, 8, 10), 6: (0, 1, 6), 7: (0, 1, 4, 7, 8, 10), 11: (0, 1, 5, 9, 11),
                   12: (0, 1, 5, 9, 11)}
        check(transform in allowed.get(number, (0, 1)), "transform %d of column %d" % (transform, number))
        check(number == 1 or transform != 1 or bits == 0, "packed column %d" % number)
        rule(transform != 1 or bits > 0 or base < 256**width, "constant column %d" % number)
        n = pair_count if number in (11, 12) else records
        planes = [decode_plane(*plane, (records + 7) // 8) for plane in stored[number][:1]] if transform == 6 else []
        if transform == 6:
            rows = stored_rows(planes[0], records)
        check(transform not in (7, 10) or rows, "a sparse column beside a y that is not")
        size = (n * bits + 7) // 8 if transform in (1, 2) else len(rows) if transform in (6, 7, 10) else n
        if transform == 11 and n > 0:
            check(len(words) == 7, "number of planes")
            values = from_packed_delta2(lambda i, size: decode_plane(*stored[number][i], size), columns[8], job.k, bits)
            check(len(values) == n, "numbers of pairs")
            check_column(number, width, values, column_hash)
            columns[number] = values
            continue
        planes = [decode_plane(*plane, size) for plane in stored[number][len(planes) :]]
        check(len(planes) == (bits > 0 if transform in (1, 2) else 0 if transform == 3 or n == 0 else width), "number of planes")
        if transform == 3:
            check(job.sampler == 1 and (table[1][2], table[2][2]) == (3, 3), "positions left out")
            rule(camera, "positions left out of a light page")
            values = [halton(sample, job.shifts)[number - 2] for sample in columns[1]]
        elif n == 0:
            check(transform == 0, "a column without values")
            values = []
        elif transform in (1, 2) and bits == 0:
            values = [base % 256**width] * n
        else:
            values = {
                0: lambda: from_planes(planes),
                1: lambda: from_packed(planes[0], bits, base, n),
                2: lambda: from_lattice(planes[0], bits, s, base, n),
                4: lambda: from_cross(planes, columns[6]),
                5: lambda: from_delta2(planes, columns[8]),
                6: lambda: from_sparse(rows, from_planes(planes), records),
                7: lambda: from_sparse(rows, from_cross(planes, [columns[6][i] for i in rows]), records),
                8: lambda: from_cross(planes, columns[6], bits),
                9: lambda: from_delta2(planes, columns[8], bits),
                10: lambda: from_sparse(rows, from_cross(planes, [columns[6][i] for i in rows], bits), records),
            }[transform]()
        check_column(number, width, values, column_hash)
        columns[number] = values
    if job.kind == 1:
        counts = columns[8]
        check(sum(counts) == pair_count and all(n <= job.k for n in counts), "numbers of pairs")
        if job.knots:
            check(all(n in (0, 1, job.k) for n in counts), "neither one pair nor the batch")
            alone = [n == 1 and job.k > 1 for n in counts]
            check(all(i < job.k if a else i == 65535 for i, a in zip(columns[10], alone)), "index")
    for number in (5, 6, 7, 11):
        rule(all(is_rounded(bits, job.precision) for bits in columns.get(number, [])), "values beyond the precision of the job")
    return columns


# ---- run


def z_prefix(u, v):
    spread = lambda x: sum((x >> i & 1) << 2 * i for i in range(16))
    return spread(v >> 16) << 1 | spread(u >> 16)


def page_end(prefixes, begin, most):
    """Where the page ends that begins at `begin`: it needs more bits than it shares with the record before, and with the one too many."""
    outside = ([prefixes[begin - 1]] if begin > 0 else []) + prefixes[begin + most : begin + most + 1]
    bits = max([33 - (prefixes[begin] ^ other).bit_length() for other in outside], default=0)
    inside = [z >> 32 - min(bits, 32) == prefixes[begin] >> 32 - min(bits, 32) for z in prefixes[begin : begin + most]]
    return begin + (inside + [False]).index(False)


def smallest_square(us, vs):
    different = 0
    for u, v in zip(us, vs):
        different |= u ^ us[0] | v ^ vs[0]
    level = min(16, 32 - different.bit_length())
    return level, us[0] >> 32 - level, vs[0] >> 32 - level


def run_size(header):
    """In every version of the format."""
    (intervals, pages, pages_size) = fields("I", header, 12) + fields("Q", header, 64) + fields("Q", header, 104)
    return (256 + pages_size + 16 * intervals + 48 * pages + 4095) // 4096 * 4096


def check_run_header(job, header):
    check(header[:8] == b"\x8dLTDBR\r\n" and hash64(header[:248]) == fields("Q", header, 248)[0], "run header")
    (major, _, intervals, features, low, high, first, end, samples, pages) = fields("HHIQQQQQQQ", header, 8)
    (light, pairs) = fields("QQ", header, 80)
    check(major == 1 and features == 0 and [low, high] == job.id, "run of another format or job")
    check(not any(header[136:248]), "zeros of the run header")
    check(1 <= intervals <= 2**16 and pages <= 2**20, "intervals or pages of a run")
    check(first < end < 2**64 and 0 < samples <= end - first and (samples == end - first) == (intervals == 1), "samples of a run")
    check(light == 0 or job.light_paths > 0, "light records in a job without light paths")
    check(pairs == 0 or job.kind == 1, "pairs in an XYZ job")


def read_run(job, data, at):
    header = data[at : at + 256]
    check_run_header(job, header)
    (intervals, first, end, samples, pages) = fields("I", header, 12) + fields("QQQQ", header, 40)
    (camera, light, pairs, decoded_size, pages_size, index_hash, *content) = fields("QQQQQQQQ", header, 72)
    index_at = at + 256 + pages_size
    index_size = 16 * intervals + 48 * pages
    size = run_size(header)
    check(at + size <= len(data), "the file ends inside a run")
    check(hash64(data[index_at : at + size]) == index_hash, "index hash")
    check(not any(data[index_at + index_size : at + size]), "padding of the run")
    ranges = [fields("QQ", data, index_at + 16 * i) for i in range(intervals)]
    check((ranges[0][0], ranges[-1][1]) == (first, end) and sum(e - f for f, e in ranges) == samples, "coverage")
    check(all(f < e for f, e in ranges) and all(a[1] < b[0] for a, b in zip(ranges, ranges[1:])), "intervals of the coverage")
    entries_at = index_at + 16 * intervals
    entries = [data[entries_at + 48 * i : entries_at + 48 * i + 48] for i in range(pages)]
    check(hash128(b"".join(e[:32] for e in entries)) == tuple(content), "content hash of the run")

    page_at, sizes, decoded_pages, last = at + 256, ([], []), [], (0, 0, 0)
    prefixes, shares, page_classes = ([], []), {}, 0
    for entry in entries:
        (level, kind, zero, x, y, records, page_pairs, decoded, page_hash, stored, zero2, stored_hash) = fields("BBHIIIIIQIIQ", entry, 0)
        check((zero, zero2) == (0, 0) and kind in (0, 1) and 1 <= records <= job.most_records(), "entry of a page")
        check(level <= 16 and x < 2**level and y < 2**level and page_pairs <= records * job.k, "entry of a page")
        check(decoded <= 2**21 and stored <= decoded + 2**16, "sizes of a page")
        check(page_classes <= kind, "a camera page behind a light page")
        page_classes = kind
        page = data[page_at : page_at + stored]
        page_at += stored
        check(hash64(page) == stored_hash, "page hash")
        columns = decode_page(job, page, kind == 0, records, page_pairs, page_hash)
        check(sum((page_pairs if c in (11, 12) else records) * w for c, w in job.columns(kind == 0)) == decoded, "decoded size")
        check(all((u >> 32 - level, v >> 32 - level) == (x, y) for u, v in zip(columns[2], columns[3])), "a record outside its square")
        rule((level, x, y) == smallest_square(columns[2], columns[3]), "not the smallest square of the page's records")
        for n, u, v in zip(columns[1], columns[2], columns[3]):
            check(any(f <= n < e for f, e in ranges), "a record outside the coverage")
            place = (kind, z_prefix(u, v), n)
            rule(last <= place, "order of records")
            last = place
            prefixes[kind].append(place[1])
        for n, share in zip(columns[1], columns.get(4, [])):
            shares[n] = shares.get(n, 0) + fields("f", struct.pack("<I", share), 0)[0]
        sizes[kind].append(records)
        decoded_pages.append((kind, columns, decoded, page_pairs))
    check((sum(sizes[0]), sum(sizes[1])) == (camera, light) and page_at == index_at, "the pages do not add up")
    check(sum(p[2] for p in decoded_pages) == decoded_size and sum(p[3] for p in decoded_pages) == pairs, "sums of the run header")
    for kind in (0, 1):
        begin = 0
        for records in sizes[kind]:
            rule(begin + records == page_end(prefixes[kind], begin, job.most_records()), "the page cut")
            begin += records
    rule(all(abs(share - 1) <= 2**-12 for share in shares.values()), "shares of a sample")
    return size, camera, light, ranges, decoded_pages


def read_footer(data, at, runs):
    """`runs`: (offset, header) of each."""
    if data[-8:] == b"\x8dLTDBE\r\n":  # the first form
        (offset, size, footer_hash) = fields("QQQ", data, len(data) - 64)
        check(hash64(data[-64:-16]) == fields("Q", data, len(data) - 16)[0] and not any(data[-40:-16]), "trailer")
        check(offset == at and size == len(data) - at and hash64(data[at:-64]) == footer_hash, "footer")
        (count, provenance) = fields("QQ", data, at + 8)
        check(data[at : at + 8] == data[-8:] and count == len(runs) and size == 88 + 264 * count + provenance, "sizes of the footer")
        listed = b"".join(struct.pack("<Q", offset) + header for offset, header in runs)
        check(data[at + 24 : at + 24 + 264 * count] == listed, "the footer lists other runs")
        rule(is_provenance(data[at + 24 + 264 * count : -64], 64), "provenance of the footer")
        return
    head = data[at : at + 64]
    (offset, count, provenance, entries_hash, provenance_hash, zero, head_hash) = fields("QQQQQQQ", head, 8)
    check(head[:8] == b"\x8dLTDBI\r\n" and hash64(head[:56]) == head_hash and zero == 0 and offset == at, "head of the footer")
    check(count <= 2**20 and provenance <= 2**24 and at + 128 + 128 * count + provenance == len(data), "sizes of the footer")
    check(data[-64:] == head, "the footer's two ends differ")
    entries, text = data[at + 64 : at + 64 + 128 * count], data[at + 64 + 128 * count : -64]
    check(hash64(entries) == entries_hash and hash64(text) == provenance_hash, "hashes of the footer")
    check(entries == b"".join(header[8:136] for _, header in runs), "the footer lists other runs")
    rule(is_provenance(text, 64), "provenance of the footer")


def read_file(path):
    """Job, camera and light records, coverage and (class, columns) of every page of every run."""
    with open(path, "rb") as file:
        data = file.read()
    job, at, header_is_sound = read_header(data)
    check(header_is_sound, "the header's copies differ")
    runs, camera, light, coverage, pages = [], 0, 0, [], []
    while data[at : at + 8] == b"\x8dLTDBR\r\n":
        size, c, l, ranges, decoded = read_run(job, data, at)
        runs.append((at, data[at : at + 256]))
        at, camera, light, coverage = at + size, camera + c, light + l, coverage + ranges
        pages += [(kind, columns) for kind, columns, _, _ in decoded]
    if at < len(data) or ".latent.part." not in str(path):
        read_footer(data, at, runs)
    contents = {}
    for run_at, header in runs:
        (intervals, pages_size) = fields("I", header, 12) + fields("Q", header, 104)
        coverage_of_run = data[run_at + 256 + pages_size : run_at + 256 + pages_size + 16 * intervals]
        rule(contents.setdefault(coverage_of_run, header[120:136]) == header[120:136], "runs of equal coverage and other records")
    return job, len(runs), camera, light, coverage, pages


def print_records(job, pages):
    for kind, columns in pages:
        first = 0
        for row, sample in enumerate(columns[1]):
            record = {"sample": sample, "class": "light" if kind else "camera", "u": columns[2][row], "v": columns[3][row],
                      "share": 0 if kind else columns[4][row]}
            if job.kind == 2:
                record |= {"x": columns[5][row], "y": columns[6][row], "z": columns[7][row]}
            else:
                n = columns[8][row]
                if not job.knots:
                    record["lambda_nm"] = columns[12][first : first + n]
                else:
                    indices = [columns[10][row]] if n == 1 and job.k > 1 else range(n)
                    record["lambda_nm"] = [wavelength(job.knots, job.k, columns[9][row], i) for i in indices]
                record["power"] = columns[11][first : first + n]
                first += n
            for i, (name, _) in enumerate(job.extra):
                record[name] = columns[64 + i][row]
            print(json.dumps(record))


# ---- what can be saved of a damaged file: "Reading"


UNREADABLE = (ValueError, struct.error, IndexError, OverflowError)  # what Python raises where bytes make no sense


def footer_from_end(data):
    """Offset that an intact end of a footer gives for its head, if a footer of its size fits there, or None."""
    end = data[-64:]
    if len(end) < 64:
        return None
    if end[:8] == b"\x8dLTDBI\r\n" and hash64(end[:56]) == fields("Q", end, 56)[0]:
        (offset, count, provenance) = fields("QQQ", end, 8)
        size = 128 + 128 * count + provenance
    elif end[56:] == b"\x8dLTDBE\r\n" and hash64(end[:48]) == fields("Q", end, 48)[0]:
        (offset, size) = fields("QQ", end, 0)
    else:
        return None
    return offset if offset + size == len(data) else None


def begins_footer(data, at):
    head = data[at : at + 64]
    if head[:8] == b"\x8dLTDBI\r\n" and len(head) == 64:
        return hash64(head[:56]) == fields("Q", head, 56)[0] and fields("Q", head, 8)[0] == at
    if head[:8] == b"\x8dLTDBE\r\n" and len(head) >= 24:
        (count, provenance) = fields("QQ", head, 8)
        return 88 + 264 * count + provenance <= 2**30
    return False


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


# ---- selection


def select(runs):
    """Numbers of the chosen runs, ascending. `runs`: (intervals, rank of its hashes) of each."""
    best = {}
    for i, (intervals, rank) in enumerate(runs):
        if intervals not in best or rank < runs[best[intervals]][1]:
            best[intervals] = i
    order = sorted(best, key=lambda intervals: (intervals[-1][1], intervals[0][0], intervals))
    samples = lambda intervals: sum(end - first for first, end in intervals)
    within = lambda a, b: all(any(f <= first and end <= e for f, e in b) for first, end in a)
    common = lambda a, b: any(first < e and f < end for first, end in a for f, e in b)
    chosen = []
    gapped = [c for c in order if len(c) > 1 and not any(within(c, other) for other in order if other != c)]
    for coverage in sorted(gapped, key=samples, reverse=True):
        if not any(common(coverage, other) for other in chosen):
            chosen.append(coverage)
    free = [c for c in order if len(c) == 1 and not any(common(c, other) for other in chosen)]
    sets = [[]]
    for j, coverage in enumerate(free):
        p = sum(other[0][1] <= coverage[0][0] for other in free[:j])
        worth = lambda those: (sum(map(samples, those)), -len(those))
        sets.append(max(sets[j], sets[p] + [coverage], key=worth))  # of equals the first
    return sorted(best[coverage] for coverage in chosen + sets[-1])


# ---- test vectors of the page


def vectors(page):
    """(name, {key: tokens}) or (name, [row of tokens]) of every vector: fenced blocks ```vector NAME, cases apart by blank lines."""
    with open(page) as file:
        blocks = file.read().split("\n```vector ")[1:]
    for block in blocks:
        name, text = block.split("\n```", 1)[0].split("\n", 1)
        for case in text.split("\n\n"):
            lines = case.replace("\n ", " ").split("\n")
            if " =" in lines[0]:
                yield name, {key.strip(): value.split() for key, value in (line.split(" =") for line in lines)}
            else:
                yield name, [line.split() for line in lines[1:]]  # behind the names of the rows' fields


def hex_numbers(tokens):
    return [int(token, 16) for token in tokens]


def check_vectors(page):
    plane = lambda case, key: bytes(hex_numbers(case[key]))
    planes = lambda case, first=0: [plane(case, "plane %d" % p) for p in range(first, 8) if "plane %d" % p in case]
    ints = lambda tokens: [int(token) for token in tokens]
    pattern = lambda size: bytes(i % 251 for i in range(size))
    hash128_of = lambda text: (int(text[16:], 16), int(text[:16], 16))
    hash128_hex = lambda data: "%016x%016x" % hash128(data)[::-1]
    checked = {}

    def expect(name, actual, expected):
        check(actual == expected, "vector %s: %s instead of %s" % (name, actual, expected))
        checked[name] = checked.get(name, 0) + 1

    for name, case in vectors(page):
        if name == "hash":
            for size, short, long in case:
                expect(name, ["%016x" % hash64(pattern(int(size))), hash128_hex(pattern(int(size)))], [short, long])
        elif name == "z-prefix":
            for u, v, z in case:
                expect(name, "%08x" % z_prefix(int(u, 16), int(v, 16)), z)
        elif name == "page-cut":
            prefixes, ends = hex_numbers(case["prefixes"]), []
            while (ends or [0])[-1] < len(prefixes):
                ends.append(page_end(prefixes, (ends or [0])[-1], int(case["M"][0])))
            expect(name, ends, ints(case["ends"]))
        elif name == "square":
            expect(name, list(smallest_square(hex_numbers(case["u"]), hex_numbers(case["v"]))), ints(case["level x y"]))
        elif name == "planes":
            expect(name, from_planes(planes(case)), hex_numbers(case["values"]))
        elif name == "packed":
            values = hex_numbers(case["values"])
            expect(name, from_packed(plane(case, "plane 0"), int(case["bits"][0]), int(case["base"][0], 16), len(values)), values)
        elif name == "lattice":
            values, (bits,), (s,) = hex_numbers(case["values"]), ints(case["bits"]), ints(case["s"])
            expect(name, from_lattice(plane(case, "plane 0"), bits, s, int(case["base"][0], 16), len(values)), values)
        elif name in ("cross", "stepped-cross"):
            step = int(case.get("bits", ["0"])[0])
            expect(name, from_cross(planes(case), hex_numbers(case["y"]), step), hex_numbers(case["x"]))
        elif name in ("delta2", "stepped-delta2"):
            step = int(case.get("bits", ["0"])[0])
            expect(name, from_delta2(planes(case), ints(case["pairs"]), step), hex_numbers(case["values"]))
        elif name == "packed-delta2":
            stored, (k,), (step,) = planes(case), ints(case["k"]), ints(case["bits"])
            sized = lambda i, size: stored[i] if len(stored[i]) == size else check(False, "size of plane %d" % i)
            expect(name, from_packed_delta2(sized, ints(case["pairs"]), k, step), hex_numbers(case["values"]))
        elif name == "sparse":
            ys, xs = hex_numbers(case["y"]), hex_numbers(case["x"])
            rows = stored_rows(plane(case, "bitmap"), len(ys))
            of = lambda column: [plane(case, "%s plane %d" % (column, p)) for p in range(4)]
            expect(name, from_sparse(rows, from_planes(of("y")), len(ys)), ys)
            expect(name, from_sparse(rows, from_cross(of("x"), [ys[i] for i in rows]), len(ys)), xs)
        elif name == "codec":
            expected = plane(case, "plane") if "plane" in case else pattern(int(case["pattern"][0]))
            expect(name, decode_plane(int(case["codec"][0]), plane(case, "stored"), len(expected)), expected)
        elif name == "halton23":
            for n, r2, r3 in case:
                expect(name, "%08x %08x" % halton(int(n), (0, 0)), r2 + " " + r3)
        elif name == "halton23-points":
            shifts = hex_numbers(case["shifts"])
            samples = [n for first, step, count in zip(ints(case["first"]), hex_numbers(case["step"]), ints(case["count"]))
                       for n in ((first + i * step) % 2**64 for i in range(count))]
            points = b"".join(struct.pack("<II", *halton(n, shifts)) for n in samples)
            expect(name, hash128_hex(points), case["hash128"][0])
        elif name == "wavelengths":
            knots = list(zip(hex_numbers(case["cumulative"]), hex_numbers(case["wavelength"])))
            (k,) = ints(case["k"])
            batch = [wavelength(knots, k, int(case["xi"][0], 16), i) for i in range(k)]
            expect(name, batch, hex_numbers(case["lambda"]))
        elif name == "wavelength-batches":
            knots, (k,), (count,) = list(zip(hex_numbers(case["cumulative"]), hex_numbers(case["wavelength"]))), ints(case["k"]), ints(case["count"])
            offsets = [i * int(case["step"][0], 16) % 2**32 for i in range(count)]
            batches = b"".join(struct.pack("<I", wavelength(knots, k, xi, i)) for xi in offsets for i in range(k))
            expect(name, hash128_hex(batches), case["hash128"][0])
        elif name == "rounding":
            seed = rounding_seed(hash128_of(case["job id"][0]), int(case["n"][0]), int(case["u"][0], 16), int(case["v"][0], 16))
            expect(name, ["%016x" % seed], case["h"])
            randoms = [rounding_random(seed, i) for i in range(len(case["value"]))]
            expect(name, randoms, hex_numbers(case["r"]))
            for precision in ints([key[2:] for key in case if key.startswith("p ")]):
                values = [rounded(value, precision, random) for value, random in zip(hex_numbers(case["value"]), randoms)]
                expect(name, values, hex_numbers(case["p %d" % precision]))
        elif name == "selection":
            runs = []
            for token in case["runs"]:
                (coverage, rank) = token.split("#")
                runs.append((tuple(tuple(ints(i.split(".."))) for i in coverage.split(",")), int(rank)))
            expect(name, select(runs), ints(case["chosen"]))
        else:
            raise ValueError("vector %s is not known" % name)
    print(", ".join("%s %d" % item for item in checked.items()))


def main(arguments):
    if arguments[:1] == ["--vectors"]:
        check_vectors(arguments[1])
        return
    if arguments[:1] == ["--salvage"]:
        for path in arguments[1:]:
            with Rules.for_readers():
                intact, damage = salvage(path)
            text = " ".join("%d..%d" % r for ranges, *_ in intact for r in ranges)
            print("\n  ".join(["%s: %d intact runs, %s" % (path, len(intact), text), *damage]))
        return
    with_records = arguments[:1] == ["--records"]
    for path in arguments[with_records:]:
        job, runs, camera, light, coverage, pages = read_file(path)
        if with_records:
            print_records(job, pages)
            continue
        text = " ".join("%d..%d" % r for r in coverage)
        print("%s: %d runs, %d camera records, %d light records, %s" % (path, runs, camera, light, text))


if __name__ == "__main__":
    try:
        main(sys.argv[1:])
    except (ValueError, struct.error, KeyError, IndexError) as error:
        sys.exit("%s: %s" % (" ".join(sys.argv[1:]), error))
