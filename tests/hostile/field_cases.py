"""Every field of headers, runs, indexes and pages at its ceiling, beyond it, and at the most that its bytes hold."""
import random
import struct

from forged import BLOCK, FRONT, HEADER, File, base, seal_header, writer
from cases import CASES, KINDS, case, extremes, named
from native import zstd_compress

# ---- every field of the headers


FRONT_FIELDS = [("major", 8, "H", [2]), ("minor", 10, "H", []), ("copy-size", 12, "I", [2**20, 2**20 + BLOCK, BLOCK, BLOCK + 1]),
                ("features", 16, "Q", [1]), ("body-size", 24, "Q", [BLOCK - FRONT, BLOCK - FRONT + 1])]
BODY_FIELDS = [("aspect-width", 16, "I", [1]), ("aspect-height", 20, "I", [1]), ("kind", 24, "B", [3]), ("sampler", 25, "B", [1, 2]),
               ("k", 26, "H", [1, 1024, 1025]), ("light-paths", 28, "I", []), ("light-unit", 32, "Q", [1, 0x7FF0000000000000]),
               ("run-bytes", 40, "Q", [2**16, 2**30, 2**30 + 1]), ("run-samples", 48, "I", [2**10, 2**22, 2**23, 1500]),
               ("shift", 52, "I", []), ("knots", 60, "I", [1, 2, 4096, 4097]), ("columns", 64, "I", [1, 16, 17]),
               ("provenance", 68, "I", [1, 2**19, 2**19 + 1])]


def with_header_field(kind, at, layout, value):
    def make():
        job, runs = base(kind)
        file = File(job, runs)
        struct.pack_into("<" + layout, file.header, at, value)
        file.header = seal_header(file.header)
        return file.pieces()
    return make


for field, at, layout, ceilings in FRONT_FIELDS:
    for value in extremes(layout, ceilings):
        case(f"front-{field}-{named(value)}")(with_header_field("xyz", at, layout, value))
for field, at, layout, ceilings in BODY_FIELDS:
    for value in extremes(layout, ceilings):
        kind = KINDS[len(CASES) % 3]
        case(f"body-{field}-{named(value)}")(with_header_field(kind, FRONT + at, layout, value))

RUN_FIELDS = [("major", 8, "H", [2]), ("intervals", 12, "I", [2**16, 2**16 + 1]), ("features", 16, "Q", [1]), ("job", 24, "Q", []),
              ("first", 40, "Q", [299]), ("end", 48, "Q", [1, 2**64 - 2]), ("samples", 56, "Q", [299, 301]),
              ("pages", 64, "Q", [2, 2**20, 2**20 + 1, 2**48]), ("camera", 72, "Q", [6144 << 20]), ("light", 80, "Q", [6144 << 20]),
              ("pairs", 88, "Q", [86016 << 20]), ("decoded", 96, "Q", [2**41]), ("pages-size", 104, "Q", [2**41 + 2**36, 2**62]),
              ("zero", 136, "Q", [])]


def with_run_field(kind, at, layout, value):
    def make():
        job, runs = base(kind, [(0, 300), (1024, 1100)])
        runs[0].sealed()
        struct.pack_into("<" + layout, runs[0].header, at, value)
        runs[0].rehash_header()
        runs[1].sealed()
        return File(job, runs).pieces()
    return make


for field, at, layout, ceilings in RUN_FIELDS:
    for value in extremes(layout, ceilings):
        case(f"run-{field}-{named(value)}")(with_run_field(KINDS[len(CASES) % 3], at, layout, value))


# ---- every field of the index and of a page's table


ENTRY_FIELDS = [("level", 0, "B", [16, 17]), ("class", 1, "B", [1, 2]), ("zero", 2, "H", []), ("x", 4, "I", [1]), ("y", 8, "I", [1]),
                ("records", 12, "I", [6144, 6145]), ("pairs", 16, "I", [86016, 86017]), ("decoded", 20, "I", [2**21, 2**21 + 1]),
                ("stored", 32, "I", [2**16, 2**21 + 2**16]), ("zero2", 36, "I", [])]


def with_entry_field(kind, at, layout, value, sums):
    def make():
        job, runs = base(kind, [(0, 300), (1024, 1100)])
        runs[0].rehash_pages()
        struct.pack_into("<" + layout, runs[0].entries, at, value)
        runs[0].sealed(pages=False, sums=sums)
        runs[1].sealed()
        return File(job, runs).pieces()
    return make


for field, at, layout, ceilings in ENTRY_FIELDS:
    for value in extremes(layout, ceilings):
        for sums in (False, True):
            case(f"entry-{field}-{named(value)}{'-summed' * sums}")(with_entry_field(KINDS[len(CASES) % 3], at, layout, value, sums))


def interval_case(change):
    def make():
        job, runs = base("xyz")
        runs[0].intervals = bytearray(b"".join(struct.pack("<QQ", *pair) for pair in change))
        struct.pack_into("<QQQ", runs[0].header, 40, change[0][0], change[-1][1], sum(b - a for a, b in change) % 2**64)
        return File(job, [runs[0].sealed(sums=True)]).pieces()
    return make


for name, change in {"backwards": [(300, 0)], "everything": [(0, 2**64 - 1)], "last": [(2**64 - 2, 2**64 - 1)], "huge-gaps": [(0, 1), (2**63, 2**63 + 300)],
                     "touching": [(0, 100), (100, 300)], "overlapping": [(0, 200), (100, 300)]}.items():
    case(f"interval-{name}")(interval_case(change))

COLUMN_FIELDS = [("number", 0, "B", [1, 12, 80]), ("transform", 1, "B", [1, 2, 3, 4, 5, 6, 7, 8, 64]), ("bits", 2, "B", [1, 64, 65]),
                 ("planes", 3, "B", [1, 8, 9]), ("s", 4, "I", [32, 33]), ("base", 8, "Q", [])]


def columns_of(page):
    """Where the columns of a page's table begin."""
    (count,) = struct.unpack_from("<I", page, 0)
    starts, at = [], 4
    for _ in range(count):
        starts.append(at)
        at += 24 + 4 * page[at + 3]
    return starts


def with_page_field(kind, column, at, layout, value):
    def make():
        job, runs = base(kind)
        page = runs[0].pages[0]
        struct.pack_into("<" + layout, page, columns_of(page)[column] + at if column is not None else at, value)
        return File(job, [runs[0].sealed()]).pieces()
    return make


for field, at, layout, ceilings in COLUMN_FIELDS:
    for i, value in enumerate(extremes(layout, ceilings)):
        case(f"column-{field}-{named(value)}")(with_page_field(KINDS[i % 3], i % 7, at, layout, value))
for kind in KINDS:
    for transform in range(1, 8):
        case(f"values-{kind}-transform-{transform}")(with_page_field(kind, -1 if kind != "xyz" else -3, 1, "B", transform))
    case(f"table-{kind}-columns")(with_page_field(kind, None, 0, "I", 2**32 - 1))
    for codec in range(4):
        for size in (0, 1, 2**30 - 1):
            case(f"plane-{kind}-{codec}-{named(size)}")(with_page_field(kind, 1, 24, "I", codec << 30 | size))


def with_plane(codec, stored):
    """The first plane of u becomes `stored`."""
    def make():
        job, runs = base("xyz")
        page = runs[0].pages[0]
        starts = columns_of(page)
        sizes = [struct.unpack_from("<I", page, start + 24 + 4 * p)[0] & 2**30 - 1 for start in starts for p in range(page[start + 3])]
        planes_before = page[starts[0] + 3]
        table_end = starts[-1] + 24 + 4 * page[starts[-1] + 3]
        at = table_end + sum(sizes[:planes_before])
        struct.pack_into("<I", page, starts[1] + 24, codec << 30 | len(stored))
        if page[starts[1] + 1] != 0:
            raise SystemExit("the first plane of u is not a plane of bytes")
        page[at : at + sizes[planes_before]] = stored
        return File(job, [runs[0].sealed(sums=True)]).pieces()
    return make


def zstd_frame(descriptor, rest):
    return b"\x28\xb5\x2f\xfd" + bytes([descriptor]) + rest


RLE = struct.pack("<I", (2**17 << 3) | 2)[:3] + b"\x00"  # 128 KiB of zeros in four bytes
for name, frame in {
        "bomb": zstd_compress(bytes(2**26)),
        "rle": zstd_frame(0, b"\x88" + RLE * 2**13),
        "content-size": zstd_frame(0xE0, b"\xff" * 8 + RLE),
        "window": zstd_frame(0, b"\xff" + RLE * 4),
        "two-frames": zstd_compress(bytes(100)) + zstd_compress(bytes(200)),
        "skippable": b"\x50\x2a\x4d\x18\xff\xff\xff\x7f",
        "dictionary": zstd_frame(0x03, b"\x88\x01\x02\x03\x04" + RLE)}.items():
    case(f"zstd-{name}")(with_plane(1, frame))
for bits in (0, 1, 7, 8, 64, 255):
    case(f"dictionary-{bits}")(with_plane(3, bytes([bits]) + bytes(600)))


# ---- the rest: any two fields of a sound file at an extreme


def any_fields(seed):
    def make():
        r = random.Random(seed)
        job, runs = base(r.choice(KINDS), [(0, 300), (1024, 1100)], seed=seed, choice=writer.Varied(seed))
        file = File(job, runs)
        for run in runs:
            run.rehash_pages()
        pages_too, sums = r.random() < 0.5, r.random() < 0.5
        if pages_too:
            page = r.choice(runs).pages[0]
            _, at, layout, ceilings = r.choice(COLUMN_FIELDS)
            struct.pack_into("<" + layout, page, r.choice(columns_of(page)) + at, r.choice(list(extremes(layout, ceilings))))
        _, at, layout, ceilings = r.choice(ENTRY_FIELDS)
        struct.pack_into("<" + layout, runs[0].entries, at, r.choice(list(extremes(layout, ceilings))))
        for run in runs:
            run.sealed(pages=pages_too, sums=sums)
        if r.random() < 0.5:
            _, at, layout, ceilings = r.choice(RUN_FIELDS)
            struct.pack_into("<" + layout, runs[1].header, at, r.choice(list(extremes(layout, ceilings))))
            runs[1].rehash_header()
        return file.pieces()
    return make


for seed in range(40):
    case(f"any-{seed}")(any_fields(seed))
