#!/usr/bin/env python3
"""A second reader of sample files, written from docs/format.md alone and slow on purpose: whatever it cannot read, the page does
not say. Reads every file given, decodes every column of every page and compares it with its content hash.
Prints "FILE: RUNS runs, CAMERA camera records, LIGHT light records, COVERAGE"; ends with 1 at the first contradiction."""
import ctypes
import struct
import sys

zstd = ctypes.CDLL("libzstd.so.1")
zstd.ZSTD_decompress.restype = ctypes.c_size_t
zstd.ZSTD_decompress.argtypes = [ctypes.c_char_p, ctypes.c_size_t, ctypes.c_char_p, ctypes.c_size_t]
xxhash = ctypes.CDLL("libxxhash.so.0")
xxhash.XXH3_64bits.restype = ctypes.c_uint64
xxhash.XXH3_64bits.argtypes = [ctypes.c_char_p, ctypes.c_size_t]


class Hash128(ctypes.Structure):
    _fields_ = [("low", ctypes.c_uint64), ("high", ctypes.c_uint64)]


xxhash.XXH3_128bits.restype = Hash128
xxhash.XXH3_128bits.argtypes = [ctypes.c_char_p, ctypes.c_size_t]


def hash64(data):
    return xxhash.XXH3_64bits(bytes(data), len(data))


def hash128(data):
    h = xxhash.XXH3_128bits(bytes(data), len(data))
    return (h.low, h.high)


def check(condition, what):
    if not condition:
        raise ValueError(what)


def fields(layout, data, at):
    return struct.unpack_from("<" + layout, data, at)


M32, M64 = 2**32 - 1, 2**64 - 1
TYPES = {1: 1, 2: 2, 3: 4, 4: 8, 5: 4, 6: 8}


class Job:
    def __init__(self, body):
        self.id = fields("QQ", body, 0)
        (self.kind, self.sampler, self.k) = fields("BBH", body, 24)
        (self.shift_u, self.shift_v, knots, extra, provenance) = fields("IIIII", body, 52)
        at = 72
        self.knots = [fields("QI", body, at + 12 * i) for i in range(knots)]
        at += 12 * knots
        self.extra = []
        for _ in range(extra):
            (kind, length) = fields("BB", body, at)
            self.extra.append((bytes(body[at + 2 : at + 2 + length]).decode(), TYPES[kind]))
            at += 2 + length
        check(at + provenance == len(body), "the header's fields do not fill it")

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


def read_header(data):
    for at in range(0, min(len(data), 2**20 + 1), 4096):
        if data[at : at + 8] != b"\x8dLTDBF\r\n":
            continue
        (major, _, size, features, body_size, body_hash) = fields("HHIQQQ", data, at + 8)
        if hash64(data[at : at + 56]) != fields("Q", data, at + 56)[0] or (at != 0 and at != size):
            continue
        check(major == 1 and features == 0, "another format")
        if hash64(data[at + 64 : at + size]) == body_hash:
            return Job(data[at + 64 : at + 64 + body_size]), 2 * size
    raise ValueError("no header")


def halton(n, job):
    reversed2 = int(format(n & M32, "032b")[::-1], 2)
    d = 0
    for _ in range(40):
        d, n = d * 3 + n % 3, n // 3
    return (reversed2 + job.shift_u) & M32, ((d << 32) // 3**40 + job.shift_v) & M32


def reverse(value, bits):
    return int(format(value, "0%db" % bits)[::-1], 2) if bits else 0


def unzigzag(value):
    return (value >> 1) ^ (M32 if value & 1 else 0)


def decode_plane(word, data, size):
    codec = word >> 30
    if codec == 0:
        check(len(data) == size, "raw plane")
        return data
    if codec == 2:
        check(len(data) == 1, "constant plane")
        return bytes(data) * size
    if codec == 3:
        bits, values = data[0], data[1 : 1 + (1 << data[0])]
        check(1 <= bits <= 7 and len(data) == 1 + (1 << bits) + (size + 7) // 8 * bits, "dictionary plane")
        packed = int.from_bytes(data[1 + (1 << bits) :], "little")
        return bytes(values[packed >> (i * bits) & ((1 << bits) - 1)] for i in range(size))
    check(codec == 1, "codec")
    out = ctypes.create_string_buffer(size)
    check(zstd.ZSTD_decompress(out, size, bytes(data), len(data)) == size, "zstd plane")
    return out.raw


def decode_page(job, data, camera, records, pair_count, content_hash):
    """Column number -> list of unsigned integers, the bits of the values."""
    (count,) = fields("I", data, 0)
    expected = job.columns(camera)
    check(count == len(expected), "columns")
    table, at = [], 4
    for number, width in expected:
        (column, transform, bits, plane_count, s, base, column_hash) = fields("BBBBIQQ", data, at)
        check(column == number, "column %d instead of %d" % (column, number))
        words = fields("%dI" % plane_count, data, at + 24)
        at += 24 + 4 * plane_count
        table.append((number, width, transform, bits, s, base, column_hash, words))
    check(hash64(b"".join(struct.pack("<Q", t[6]) for t in table)) == content_hash, "content hash of the page")

    stored = {}
    for number, _, _, _, _, _, _, words in table:
        stored[number] = []
        for word in words:
            size = word & 0x3FFFFFFF
            stored[number].append((word, data[at : at + size]))
            at += size
    check(at == len(data), "planes do not fill the page")

    columns = {}
    order = sorted(table, key=lambda t: (t[0] != 1, t[0] != 6))  # samples before positions, y before x and z
    for number, width, transform, bits, s, base, column_hash, _ in order:
        n = pair_count if number in (11, 12) else records
        planes = stored[number]
        if transform == 6:
            bitmap = int.from_bytes(decode_plane(*planes[0], (records + 7) // 8), "little")
            bright = [i for i in range(8 * ((records + 7) // 8)) if bitmap >> i & 1]
            check(bright and bright[-1] < records, "bitmap of y")
            planes = planes[1:]
        if transform in (6, 7):
            n = len(bright)
        if transform in (1, 2):
            values = [0] * n
            if bits:
                packed = int.from_bytes(decode_plane(*planes[0], (n * bits + 7) // 8), "little")
                values = [packed >> (i * bits) & ((1 << bits) - 1) for i in range(n)]
            if transform == 1:
                values = [(base + v) & M64 for v in values]
            else:
                low = base & ((1 << s) - 1)
                values = [base - low + reverse((reverse(low, s) + v) % (1 << s), s) for v in values]
        elif transform == 3:
            values = [halton(v, job)[number - 2] for v in columns[1]]
        else:
            check(len(planes) == (width if n else 0), "planes of column %d" % number)
            parts = [decode_plane(word, part, n) for word, part in planes] if n else [b""] * width
            values = [sum(parts[p][i] << (8 * p) for p in range(width)) for i in range(n)]
            if transform in (6, 7):
                sparse, values = values, [0] * records
                for i, v in zip(bright, sparse):
                    values[i] = v if transform == 6 else (columns[6][i] + unzigzag(v)) & M32
            elif transform == 4:
                values = [(y + unzigzag(v)) & M32 for v, y in zip(values, columns[6])]
            elif transform == 5:
                first = 0
                for pairs in columns[8]:
                    for i in range(first + 1, first + pairs):
                        before = 2 * values[i - 1] - values[i - 2] if i > first + 1 else values[i - 1]
                        values[i] = (before + unzigzag(values[i])) & M32
                    first += pairs
            else:
                check(transform == 0, "transform")
        decoded = b"".join(v.to_bytes(width, "little") for v in values)
        check(hash64(decoded) == column_hash, "column %d does not decode to its hash" % number)
        columns[number] = values
    return columns


def spread(x):
    return sum((x >> i & 1) << (2 * i) for i in range(16))


def read_run(job, data, at):
    header = data[at : at + 256]
    check(header[:8] == b"\x8dLTDBR\r\n" and hash64(header[:248]) == fields("Q", header, 248)[0], "run header")
    (major, _, intervals, features, low, high, first, end, samples, pages) = fields("HHIQQQQQQQ", header, 8)
    (camera, light, pairs, decoded_size, pages_size, index_hash, *content) = fields("QQQQQQQQ", header, 72)
    check(major == 1 and features == 0 and (low, high) == job.id, "run of another format or job")
    index_at = at + 256 + pages_size
    index_size = 16 * intervals + 48 * pages
    size = (256 + pages_size + index_size + 4095) // 4096 * 4096
    check(hash64(data[index_at : at + size]) == index_hash, "index hash")
    ranges = [fields("QQ", data, index_at + 16 * i) for i in range(intervals)]
    check((ranges[0][0], ranges[-1][1]) == (first, end) and sum(e - f for f, e in ranges) == samples, "coverage")
    entries_at = index_at + 16 * intervals
    entries = [data[entries_at + 48 * i : entries_at + 48 * i + 48] for i in range(pages)]
    check(hash128(b"".join(e[:32] for e in entries)) == tuple(content), "content hash of the run")

    page_at, counted, last = at + 256, [0, 0], (0, 0, 0)
    for entry in entries:
        (level, kind, _, x, y, records, page_pairs, decoded, page_hash, stored, _, stored_hash) = fields("BBHIIIIIQIIQ", entry, 0)
        page = data[page_at : page_at + stored]
        page_at += stored
        check(hash64(page) == stored_hash, "page hash")
        columns = decode_page(job, page, kind == 0, records, page_pairs, page_hash)
        check(sum((page_pairs if c in (11, 12) else records) * w for c, w in job.columns(kind == 0)) == decoded, "decoded size")
        counted[kind] += records
        for n, u, v in zip(columns[1], columns[2], columns[3]):
            check(any(f <= n < e for f, e in ranges), "a record outside the coverage")
            check(u >> 32 - level == x and v >> 32 - level == y, "a record outside its node")
            place = (kind, spread(v >> 16) << 1 | spread(u >> 16), n)
            check(last <= place, "order of records")
            last = place
    check(counted == [camera, light] and page_at == index_at, "the pages do not add up")
    return size, camera, light, ranges


def read_file(path):
    with open(path, "rb") as file:
        data = file.read()
    job, at = read_header(data)
    runs, camera, light, coverage = [], 0, 0, []
    while data[at : at + 8] == b"\x8dLTDBR\r\n":
        size, c, l, ranges = read_run(job, data, at)
        runs.append((at, data[at : at + 256]))
        at, camera, light, coverage = at + size, camera + c, light + l, coverage + ranges
    if at < len(data):
        trailer = data[-64:]
        (offset, size, footer_hash) = fields("QQQ", trailer, 0)
        footer = data[at:-64]
        check(trailer[56:] == footer[:8] == b"\x8dLTDBE\r\n" and hash64(trailer[:48]) == fields("Q", trailer, 48)[0], "trailer")
        check(offset == at and size == len(data) - at and hash64(footer) == footer_hash, "footer")
        check(fields("Q", footer, 8)[0] == len(runs), "runs of the footer")
        listed = [(fields("Q", footer, 24 + 264 * i)[0], footer[32 + 264 * i : 288 + 264 * i]) for i in range(len(runs))]
        check(listed == runs, "the footer lists other runs")
    text = " ".join("%d..%d" % r for r in coverage)
    print("%s: %d runs, %d camera records, %d light records, %s" % (path, len(runs), camera, light, text))


for name in sys.argv[1:]:
    try:
        read_file(name)
    except (ValueError, struct.error, KeyError, IndexError) as error:
        sys.exit("%s: %s" % (name, error))
