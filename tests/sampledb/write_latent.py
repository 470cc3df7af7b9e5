#!/usr/bin/env python3
"""A second writer of sample files, written from docs/format.md alone: an example for writers in other programs, and a test of the
page. Makes up the records of a small file and writes them.

    write_latent.py KIND FILE [--precision BITS] [--vary SEED] [--parts I,J,...] [--records LINES]

KIND is smallest (two records, in as few bytes as possible), xyz, spectral (wavelengths of a density) or explicit (wavelengths as
data). --precision rounds values. The simplest encoding of every column is used; with --vary, any that the page allows, chosen at random. --parts writes only these runs of the file. --records writes the
records as well, one JSON object a line, values as their bits, in the order of the file."""
import argparse
import functools
import json
import math
import random
import struct
from dataclasses import dataclass, field

from native import hash64, hash128, zstd_compress

BLOCK = 4096
M32, M64 = 2**32 - 1, 2**64 - 1
XYZ, SPECTRAL = 2, 1
WIDTH = {"u8": 1, "u16": 2, "u32": 4, "u64": 8, "f32": 4, "f64": 8}
TYPE = {"u8": 1, "u16": 2, "u32": 3, "u64": 4, "f32": 5, "f64": 6}


@dataclass
class Job:
    id: tuple
    kind: int
    aspect: tuple = (3, 2)
    k: int = 0
    knots: list = field(default_factory=list)  # (cumulative, wavelength)
    halton: bool = False
    pixels: tuple = ()  # width and height, instead of Halton's positions
    shifts: tuple = (0, 0)
    light_paths: int = 0
    light_unit: float = 1.0
    run_bytes: int = 2**28
    run_samples: int = 2**13
    precision: int = 23
    extra: list = field(default_factory=list)  # (name, type)


@dataclass
class Record:
    """Values are unsigned integers: the bits of floats."""

    sample: int
    u: int
    v: int
    light: bool = False
    share: int = 0x3F800000
    xyz: tuple = ()
    xi: int = 0
    index: int = 65535
    power: list = field(default_factory=list)
    lambdas: list = field(default_factory=list)
    extra: tuple = ()


def padded(data):
    return data + bytes(-len(data) % BLOCK)


# ---- header


def encode_header(job, provenance=b""):
    body = struct.pack("<QQIIBBHIdQIIIIII", *job.id, *job.aspect, job.kind, 2 if job.pixels else job.halton, job.k, job.light_paths, job.light_unit,
                       job.run_bytes, job.run_samples, *job.shifts, len(job.knots), len(job.extra), len(provenance))
    body += b"".join(struct.pack("<QI", *knot) for knot in job.knots)
    for name, kind in job.extra:
        body += bytes([TYPE[kind], len(name.encode())]) + name.encode()
    body += provenance
    minor = 2 if job.pixels else job.precision < 23
    if minor >= 1:
        body += bytes([job.precision])
    if minor >= 2:
        body += struct.pack("<II", *job.pixels)
    features = (job.precision < 23) | 2 | (4 if len(job.extra) > 16 else 0) | (8 if job.pixels else 0)
    rest = padded(bytes(64) + body)[64:]
    front = b"\x8dLTDBF\r\n" + struct.pack("<HHIQQQ16x", 1, minor, 64 + len(rest), features, len(body), hash64(rest))
    return 2 * (front + struct.pack("<Q", hash64(front)) + rest)


# ---- order of records, pages


def z_prefix(u, v):
    return sum((u >> 16 + i & 1) << 2 * i | (v >> 16 + i & 1) << 2 * i + 1 for i in range(16))


def page_ends(prefixes, most):
    """Where the pages end that ascending Z prefixes are cut into."""
    ends, begin = [], 0
    while begin < len(prefixes):
        for bits in range(33):
            node = prefixes[begin] >> 32 - bits
            if begin > 0 and prefixes[begin - 1] >> 32 - bits == node and bits < 32:
                continue  # the page before lies in this node, too
            end = begin
            while end < len(prefixes) and end - begin <= most and prefixes[end] >> 32 - bits == node:
                end += 1
            if end - begin <= most or bits == 32:
                break
        begin = min(end, begin + most)
        ends.append(begin)
    return ends


def smallest_square(us, vs):
    for level in range(16, 0, -1):
        if len({(u >> 32 - level, v >> 32 - level) for u, v in zip(us, vs)}) == 1:
            return level, us[0] >> 32 - level, vs[0] >> 32 - level
    return 0, 0, 0


def most_records(job):
    most = 6144 if job.kind == XYZ else max(64, min(6144, 86016 // job.k))
    return min(most, 786432 // max(1, sum(WIDTH[kind] for _, kind in job.extra)))


# ---- samplers and wavelengths


def reverse(value, bits):
    return int(format(value, "0%db" % bits)[::-1], 2)


def halton23(n, shifts):
    r2, d, rest = reverse(n & M32, 32), 0, n
    for _ in range(40):
        d, rest = 3 * d + rest % 3, rest // 3
    return (r2 + shifts[0]) & M32, ((d << 32) // 3**40 + shifts[1]) & M32


@functools.cache
def pixel_step(w, h):
    step = (3242174889 * h + 2**31 >> 32) * w + (2447445414 * w + 2**31 >> 32)
    return next(g for g in range(step, step + w * h) if math.gcd(g, w * h) == 1)


def pixel_place(job, n):
    w, h = job.pixels
    p, r = n // (w * h), n % (w * h)
    q = (r * pixel_step(w, h) + job.shifts[1] * 2**32 + job.shifts[0]) % (w * h)
    return q % w, q // w, p


def pixel_point(job, n):
    (w, h), (x, y, p) = job.pixels, pixel_place(job, n)
    key = job.shifts[1] * 2**32 + job.shifts[0] + (y * 2**32 + x) * 0x9E3779B97F4A7C15
    s = mixed(key & M64, 64, [(30, 0xBF58476D1CE4E5B9), (27, 0x94D049BB133111EB)])
    s ^= s >> 31
    bits = [p >> i & 1 for i in range(32)]
    a = sum(bit << 31 - i for i, bit in enumerate(bits))
    b = sum(sum(bits[i] for i in range(32) if i & j == j) % 2 << 31 - j for j in range(32))
    return (x * 2**32 + max(a ^ s % 2**32, w - 1)) // w, (y * 2**32 + max(b ^ s >> 32, h - 1)) // h


def position(job, n):
    return pixel_point(job, n) if job.pixels else halton23(n, job.shifts)


def float_bits(x):
    return struct.unpack("<I", struct.pack("<f", x))[0]


def wavelength(job, xi, i):
    q = ((i << 32) + xi << 16) // job.k
    j = max(j for j, knot in enumerate(job.knots) if knot[0] <= q)
    (below, at), (above, to) = job.knots[j], job.knots[j + 1]
    slope = float(to - at) / float(above - below)
    return float_bits((float(at) + slope * float(q - below)) * 2.0**-20)


# ---- rounding


def mixed(x, bits, steps):
    for shift, factor in steps:
        x = (x ^ x >> shift) * factor % 2**bits
    return x


def round_values(job, record):
    if job.precision == 23:
        return
    place = record.v << 32 | record.u
    h = mixed((hash64(struct.pack("<QQ", *job.id)) + record.sample * 0x9E3779B97F4A7C15 + place * 0xD1B54A32D192ED03) & M64, 64,
              [(30, 0xBF58476D1CE4E5B9), (27, 0x94D049BB133111EB)])
    h ^= h >> 31
    low_bits = (1 << 23 - job.precision) - 1

    def rounded(i, bits):
        r = mixed(h + i * 0x9E3779B9 & M32, 32, [(16, 0x7FEB352D), (15, 0x846CA68B)])
        r ^= r >> 16 ^ h >> 32
        stays = (bits & 0x7FFFFFFF) > 0x7F800000 - (low_bits + 1)
        return bits if stays else bits + (r & low_bits) & ~low_bits

    record.xyz = tuple(rounded(i, bits) for i, bits in enumerate(record.xyz))
    record.power = [rounded(i, bits) for i, bits in enumerate(record.power)]


# ---- columns of a page: encodings give (transform, bits, s, base, planes)


def zigzag(difference):
    difference &= M32
    return (difference << 1 & M32) ^ (M32 if difference >> 31 else 0)


def signed(difference):
    return (difference + 2**31 & M32) - 2**31


def step_of(job, values):
    """log2 of the step in which differences of rounded values can be counted; 0: they cannot."""
    bits = 23 - job.precision
    return 0 if any(value % 2**bits for value in values) else bits


def byte_planes(values, width):
    return [bytes(value >> 8 * p & 255 for value in values) for p in range(width)]


def packed(values, bits):
    return sum(value << i * bits for i, value in enumerate(values)).to_bytes((len(values) * bits + 7) // 8, "little")


def as_planes(values, width):
    return (0, 0, 0, 0, byte_planes(values, width) if values else [])


def as_constant(value):
    return (1, 0, 0, value, [])


def as_packed(values, bits, base):
    return (1, bits, 0, base, [packed([value - base & M64 for value in values], bits)])


def as_lattice(values, s, bits, base):
    high, low = base >> s, base % 2**s
    steps = [reverse(value % 2**s, s) - reverse(low, s) & 2**s - 1 for value in values]
    assert all(value >> s == high for value in values) and all(step < 2**bits for step in steps)
    return (2, bits, s, base, [packed(steps, bits)] if bits else [])


def as_pixels(job, values, square):
    level, *at = square
    starts = [x * size // 2**level for x, size in zip(at, job.pixels)]
    w, h = [-(-(x + 1) * size // 2**level) - start for x, size, start in zip(at, job.pixels, starts)]
    places = [pixel_place(job, value) for value in values]
    base = min(p for _, _, p in places)
    numbers = [((p - base) * h + y - starts[1]) * w + x - starts[0] for x, y, p in places]
    bits = max(numbers).bit_length()
    return (12, bits, 0, base, [packed(numbers, bits)] if bits else [])


AS_SAMPLER = (3, 0, 0, 0, [])


def by_steps(differences, bits):
    """Numbers that are stored for differences; bits = 0: by a plain transform."""
    assert all(d % 2**bits == 0 for d in differences)
    return [zigzag(signed(d) >> bits) for d in differences]


def as_cross(values, ys, bits=0):
    numbers = by_steps([value - y for value, y in zip(values, ys)], bits)
    return (8 if bits else 4, bits, 0, 0, byte_planes(numbers, 4))


def as_delta2(values, counts, bits=0):
    words, at = [], 0
    for n in counts:
        b = values[at : at + n]
        differences = [y - x for x, y in zip(b[:1], b[1:2])] + [z - 2 * y + x for x, y, z in zip(b, b[1:], b[2:])]
        words += [value >> bits for value in b[:1]] + by_steps(differences, bits)
        at += n
    return (9 if bits else 5, bits, 0, 0, byte_planes(words, 4))


def as_fields(numbers, width):
    """Numbers below 2^width, in four lanes."""
    words = ((len(numbers) + 3) // 4 * width + 31) // 32
    lanes = [sum(number << j * width for j, number in enumerate(numbers[lane::4])) for lane in range(4)]
    return b"".join(struct.pack("<I", lanes[lane] >> 32 * i & M32) for i in range(words) for lane in range(4))


def as_packed_delta2(values, counts, k, bits, exceptions):
    """About so many exceptions in each block."""
    whole, rest, at = [], [], 0
    for n in counts:
        b = values[at : at + n]
        differences = [y - x for x, y in zip(b[:1], b[1:2])] + [z - 2 * y + x for x, y, z in zip(b, b[1:], b[2:])]
        numbers = [value >> bits for value in b[:1]] + [signed(d) >> bits for d in differences]
        if n == k:
            whole.append(numbers)
        else:
            rest += numbers
        at += n
    blocks = [([numbers[i] for numbers in whole[at : at + 128]], i) for at in range(0, len(whole), 128) for i in range(k)]
    blocks += [(rest[at : at + 128], k) for at in range(0, len(rest), 128)]
    middle = lambda numbers: sorted(numbers)[len(numbers) // 2] if numbers else 0
    bases = [middle([numbers[i] for numbers in whole]) for i in range(k)] + [middle(rest)]
    planes = [b"".join(struct.pack("<I", base & M32) for base in bases)] + [b""] * 6
    for numbers, base in blocks:
        differences = [signed(number - bases[base]) for number in numbers]
        needed = sorted((d ^ d >> 63).bit_length() + (d != 0) for d in differences)
        width = min(24, max(0, needed[-1] - 15, needed[max(0, len(needed) - 1 - exceptions)]))
        shifted = [d + (1 << width) // 2 for d in differences]
        extra = [(i, number >> width) for i, number in enumerate(shifted) if number >> width]
        planes[1] += bytes([width])
        planes[2] += bytes([len(extra)])
        planes[3] += as_fields([number % (1 << width) for number in shifted], width)
        planes[4] += bytes(i for i, _ in extra)
        planes[5] += bytes(e & 255 for _, e in extra)
        planes[6] += bytes(e >> 8 & 255 for _, e in extra)
    return (11, bits, 0, 0, planes)


def as_sparse(ys, stored):
    return (6, 0, 0, 0, [packed(stored, 1)] + byte_planes([y for y, s in zip(ys, stored) if s], 4))


def as_sparse_cross(values, ys, stored, bits=0):
    numbers = by_steps([x - y for x, y, s in zip(values, ys, stored) if s], bits)
    return (10 if bits else 7, bits, 0, 0, byte_planes(numbers, 4))


def raw(plane):
    return (0, plane)


def plane_codecs(plane):
    """Every way to store a plane: (codec, stored bytes)."""
    ways = [raw(plane), (1, zstd_compress(plane))]
    values = sorted(set(plane))
    if len(values) == 1:
        ways.append((2, bytes(values)))
    if len(values) <= 128:
        bits = max(1, (len(values) - 1).bit_length())
        numbers = [values.index(byte) for byte in plane] + [0] * (-len(plane) % 8)
        ways.append((3, bytes([bits]) + bytes(values).ljust(2**bits, b"\0") + packed(numbers, bits)))
    return ways


class Plain:
    """Takes the first of all possibilities, which is the simplest."""

    def one_of(self, ways):
        return ways[0]

    def plane(self, plane):
        return raw(plane)


class Smallest:
    """Takes what takes fewest bytes."""

    def one_of(self, ways):
        return min(ways, key=lambda way: sum(4 + len(self.plane(plane)[1]) for plane in way[4]))

    def plane(self, plane):
        return min(plane_codecs(plane), key=lambda way: len(way[1]))


class Varied:
    """Takes any of them."""

    def __init__(self, seed):
        self.random = random.Random(seed)

    def one_of(self, ways):
        return self.random.choice(ways)

    def plane(self, plane):
        return self.random.choice(plane_codecs(plane))


def constant_if_possible(values):
    return [as_constant(values[0])] if values and len(set(values)) == 1 else []


def sample_encodings(samples):
    least, most = min(samples), max(samples)
    ways = [as_packed(samples, 64, 0), as_packed(samples, max(1, (most - least).bit_length()), least)]
    s = max(1, (least ^ most).bit_length())
    if s <= 32:
        first = min(samples, key=lambda n: reverse(n % 2**s, s))
        steps = [reverse(n % 2**s, s) - reverse(first % 2**s, s) for n in samples]
        ways.append(as_lattice(samples, s, max(steps).bit_length(), first))
    return ways + constant_if_possible(samples)


def encode_columns(job, light, rows, choice):
    """(number, width, values, encoding) of every column of a page, in order."""
    columns = []

    def add(number, width, values, ways=()):
        encoding = choice.one_of([as_planes(values, width), *ways, *constant_if_possible(values)])
        columns.append((number, width, values, encoding))

    samples = [r.sample for r in rows]
    positions = [(r.u, r.v) for r in rows]
    derived = (job.halton or job.pixels) and all(position(job, r.sample) == (r.u, r.v) for r in rows)
    by_pixels = [as_pixels(job, samples, smallest_square(*zip(*positions)))] if derived and job.pixels and not light else []
    columns.append((1, 8, samples, choice.one_of(sample_encodings(samples) + by_pixels)))
    if derived and choice.one_of([as_planes([r.u for r in rows], 4), AS_SAMPLER]) == AS_SAMPLER:
        columns += [(2 + i, 4, [p[i] for p in positions], AS_SAMPLER) for i in (0, 1)]
    else:
        add(2, 4, [u for u, _ in positions])
        add(3, 4, [v for _, v in positions])
    if not light:
        add(4, 4, [r.share for r in rows])
    if job.kind == XYZ:
        xs, ys, zs = ([r.xyz[i] for r in rows] for i in range(3))
        stored = [y != 0 for y in ys]
        stored[0] = True  # one at least, and it may be zero
        encoding = choice.one_of([as_planes(ys, 4), *constant_if_possible(ys), as_sparse(ys, stored)])
        for number, values in ((5, xs), (6, ys), (7, zs)):
            if number == 6:
                columns.append((6, 4, ys, encoding))
                continue
            fits = encoding[0] == 6 and all(s or value == 0 for s, value in zip(stored, values))
            steps = {0, step_of(job, values + ys)}
            add(number, 4, values, [as_cross(values, ys, bits) for bits in steps] +
                [as_sparse_cross(values, ys, stored, bits) for bits in steps if fits])
    else:
        counts = [len(r.power) for r in rows]
        add(8, 2, counts)
        if job.knots:
            add(9, 4, [r.xi for r in rows])
            add(10, 2, [r.index for r in rows])
        pairs = [(11, [p for r in rows for p in r.power])]
        if not job.knots:
            pairs.append((12, [l for r in rows for l in r.lambdas]))
        for number, values in pairs:
            bits = step_of(job, values) if values else 0
            add(number, 4, values, ([as_delta2(values, counts, b) for b in {0, bits}] if values else []) +
                ([as_packed_delta2(values, counts, job.k, bits, exceptions) for exceptions in (0, 3)] if bits else []))
    for i, (_, kind) in enumerate(job.extra):
        add(64 + i, WIDTH[kind], [r.extra[i] for r in rows])
    return columns


def encode_page(job, light, rows, choice):
    """The page's bytes, and its entry in the index."""
    table, payload, hashes, decoded_size = b"", b"", b"", 0
    columns = encode_columns(job, light, rows, choice)
    for number, width, values, (transform, bits, s, base, planes) in columns:
        decoded = b"".join(value.to_bytes(width, "little") for value in values)
        decoded_size += len(decoded)
        hashes += struct.pack("<Q", hash64(decoded))
        table += struct.pack("<BBBBIQ", number, transform, bits, len(planes), s, base) + hashes[-8:]
        for plane in planes:
            codec, stored = choice.plane(plane)
            table += struct.pack("<I", codec << 30 | len(stored))
            payload += stored
    page = struct.pack("<I", len(columns)) + table + payload
    node = smallest_square([r.u for r in rows], [r.v for r in rows])
    pairs = sum(len(r.power) for r in rows)
    return page, struct.pack("<BBHIIIIIQIIQ", node[0], light, 0, *node[1:], len(rows), pairs, decoded_size, hash64(hashes),
                             len(page), 0, hash64(page))


# ---- run, footer, file


def in_order(records):
    return sorted(records, key=lambda r: (r.light, z_prefix(r.u, r.v), r.sample))  # stable: as emitted within a sample


def encode_run(job, intervals, records, choice):
    pages, entries = b"", []
    for light in (False, True):
        rows = [r for r in in_order(records) if r.light == light]
        begin = 0
        for end in page_ends([z_prefix(r.u, r.v) for r in rows], most_records(job)):
            page, entry = encode_page(job, light, rows[begin:end], choice)
            pages += page
            entries.append(entry)
            begin = end
    index = b"".join(struct.pack("<QQ", *interval) for interval in intervals) + b"".join(entries)
    behind = padded(bytes(256) + pages + index)[256 + len(pages) :]
    decoded = sum(struct.unpack_from("<I", entry, 20)[0] for entry in entries)
    header = b"\x8dLTDBR\r\n" + struct.pack(
        "<HHIQQQQQQQQQQQQQQQ", 1, 0, len(intervals), 0, *job.id, intervals[0][0], intervals[-1][1],
        sum(end - first for first, end in intervals), len(entries), sum(not r.light for r in records),
        sum(r.light for r in records), sum(len(r.power) for r in records), decoded, len(pages), hash64(behind),
        *hash128(b"".join(entry[:32] for entry in entries)))
    header += bytes(248 - len(header))
    return header + struct.pack("<Q", hash64(header)) + pages + behind


def encode_footer(offset, runs):
    """`runs`: the header of each."""
    entries = b"".join(header[8:136] for header in runs)
    head = b"\x8dLTDBI\r\n" + struct.pack("<QQQQQ8x", offset, len(runs), 0, hash64(entries), hash64(b""))
    head += struct.pack("<Q", hash64(head))
    return head + entries + head


def encode_file(job, runs, choice, provenance=b""):
    """`runs`: (intervals, records) of each."""
    file = encode_header(job, provenance)
    listed = []
    for intervals, records in runs:
        run = encode_run(job, intervals, records, choice)
        listed.append(run[:256])
        file += run
    return file + encode_footer(len(file), listed)


# ---- made-up records


def job_id(text):
    """Here a name decides what the records are; a renderer hashes scene and settings."""
    return hash128(text.encode())


def smallest():
    job = Job(job_id("the smallest file"), XYZ, aspect=(1, 1), run_samples=2**10)
    records = [Record(0, 2**31, 2**30, xyz=(0x3F000000, 0x3F800000, 0x3E800000)),
               Record(1, 3 * 2**30, 2**30, xyz=(0x3F400000, 0x3FC00000, 0x3F000000))]
    return job, [([(0, 2)], records)]


def noise(r):
    return float_bits(r.choice([1, 1, 1, 0.1, 1e-3]) * r.expovariate(1))


def a_value(r):
    """Mostly radiance; sometimes what a reader may stumble over: -0, the smallest number, a negative one."""
    return r.choice([0x80000000, 1, 0xBF000000]) if r.random() < 0.01 else noise(r)


def extra_values(job, r):
    """Any bits for integers, numbers for floats, now and then an infinity or a NaN with a payload."""
    def value(kind):
        if kind[0] == "u":
            return r.getrandbits(8 * WIDTH[kind])
        if kind == "f32":
            return r.choice([0x7F800000, 0xFFC12345]) if r.random() < 0.01 else noise(r)
        return struct.unpack("<Q", struct.pack("<d", r.gauss(0, 1e9)))[0]
    return tuple(value(kind) for _, kind in job.extra)


def make_records(job, intervals, r, fill):
    """`fill`: a function that gives a record its values."""
    records = []
    for first, end in intervals:
        for n in range(first, end):
            if r.random() < 0.02:
                continue  # a sample may be without records
            u, v = position(job, n) if job.halton or job.pixels else (r.getrandbits(32), r.getrandbits(32))
            shares = [0.5, 0.5] if r.random() < 0.01 else [1.0]
            records += [Record(n, u, v, share=float_bits(share)) for share in shares]
            if job.light_paths and r.random() < 0.1:
                records.append(Record(n, r.getrandbits(32), r.getrandbits(32), light=True, share=0))
    for record in records:
        fill(record)
        record.extra = extra_values(job, r)
    return records


def xyz():
    r = random.Random(2)
    job = Job(job_id("xyz"), XYZ, halton=True, shifts=(0x12345678, 0x9ABCDEF0), light_paths=1,
              extra=[("group", "u8"), ("camera", "u16"), ("object", "u32"), ("path", "u64"), ("depth", "f32"), ("time", "f64")])

    def fill(record):
        black = not record.light and r.random() < 0.3
        record.xyz = (0, 0, 0) if black else tuple(a_value(r) for _ in range(3))
        if not record.light and r.random() < 0.0002:
            record.u ^= r.getrandbits(20)  # not where the sampler would put it
    runs = [[(0, 8192)], [(8192, 8292), (8300, 8400), (8500, 8501)], [(16384, 16400)]]
    return job, [(intervals, make_records(job, intervals, r, fill)) for intervals in runs] + [([(24576, 24580)], [])]


def spectral():
    r = random.Random(3)
    knots = [(i * 2**48 // 47, (360 + 10 * i) << 20) for i in range(48)]
    job = Job(job_id("spectral"), SPECTRAL, k=28, knots=knots, pixels=(90, 60), shifts=(0x12345678, 0x9ABCDEF0), light_paths=1, light_unit=683.0)

    def fill(record):
        record.xi = r.getrandbits(32)
        kind = r.random()
        n = 0 if kind < 0.3 and not record.light else 1 if kind < 0.8 else job.k
        if n == 1:
            record.index = r.randrange(job.k)
        record.power = [a_value(r) for _ in range(n)]
    runs = [[(0, 4000)], [(8192, 8193), (9000, 9064)]]
    return job, [(intervals, make_records(job, intervals, r, fill)) for intervals in runs]


def explicit():
    r = random.Random(4)
    job = Job(job_id("explicit"), SPECTRAL, aspect=(16, 9), k=1024, extra=[("light_group", "u8")])

    def fill(record):
        n = 0 if r.random() < 0.3 else r.choice([1, 2, 3, 4, 31])
        record.power = [a_value(r) for _ in range(n)]
        record.lambdas = sorted(float_bits(r.uniform(360, 830)) for _ in range(n))
    runs = [[(0, 700)], [(700, 800)]]
    return job, [(intervals, make_records(job, intervals, r, fill)) for intervals in runs]


def line_of(job, record):
    fields = {"sample": record.sample, "class": "light" if record.light else "camera", "u": record.u, "v": record.v,
              "share": record.share}
    if job.kind == XYZ:
        fields |= dict(zip("xyz", record.xyz))
    else:
        n = len(record.power)
        indices = [record.index] if n == 1 and job.k > 1 else range(n)
        fields["lambda_nm"] = [wavelength(job, record.xi, i) for i in indices] if job.knots else record.lambdas
        fields["power"] = record.power
    return json.dumps(fields | {name: bits for (name, _), bits in zip(job.extra, record.extra)}) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    kinds = {"smallest": smallest, "xyz": xyz, "spectral": spectral, "explicit": explicit}
    parser.add_argument("kind", choices=kinds)
    parser.add_argument("file")
    parser.add_argument("--precision", type=int, default=23)
    parser.add_argument("--vary", type=int)
    parser.add_argument("--parts")
    parser.add_argument("--records")
    options = parser.parse_args()
    job, runs = kinds[options.kind]()
    job.precision = options.precision
    for _, records in runs:
        for record in records:
            round_values(job, record)
    if options.parts:
        runs = [runs[int(i)] for i in options.parts.split(",")]
    choice = Plain() if options.vary is None else Varied(options.vary)
    if options.kind == "smallest":
        choice = Smallest()
    with open(options.file, "wb") as file:
        file.write(encode_file(job, runs, choice))
    if options.records:
        with open(options.records, "w") as file:
            for _, records in runs:
                file.writelines(line_of(job, record) for record in in_order(records))


if __name__ == "__main__":
    main()
