"""Careless files: they break rules that readers rely on but need not check. Every hash is right."""
import struct

from corpus import (CARELESS, Plain, Prefer, case, column, column_offsets, file_of, job_of, planes, records_of, run_of, two_runs,
                    writer)
from forged import File, seal_header
from valid_cases import one_run, with_header


def first_page(change, kind="xyz", choice=None, **fields):
    """A file whose first page is changed, with every hash of stored bytes put right."""
    def make():
        job, runs = two_runs(kind, choice() if choice else None, **fields)
        change(runs[0].pages[0])
        return file_of(job, [runs[0].sealed(sums=True), runs[1]]), runs
    return make


def field(number, at, layout, value):
    def change(page):
        struct.pack_into("<" + layout, page, column(page, number) + at, value)
    return change


RULE = "What only writers can get right"

case("reserved-header-bytes", CARELESS, RULE, "a reserved byte of the header is not zero")(
    with_header(lambda header: seal_header(header[:45] + b"\x01" + header[46:])))
case("reserved-base", CARELESS, RULE, "base of a column of planes is not zero")(first_page(field(2, 8, "Q", 7)))
case("reserved-s", CARELESS, RULE, "s of a column of planes is not zero")(first_page(field(2, 4, "I", 32)))
case("reserved-bits", CARELESS, RULE, "bits of a column of planes is not zero")(first_page(field(2, 2, "B", 64)))

class ConstantExtra(Plain):
    """A constant column wherever one is possible."""

    def one_of(self, ways):
        return next((way for way in ways if way[:3] == (1, 0, 0)), ways[0])


def constant_extra(change):
    def make():
        job = job_of("xyz", extra=[("constant", "u8")])
        records = records_of(job, [(0, 40)])
        for record in records:
            record.extra = (3,)
        run = run_of(job, [(0, 40)], records, ConstantExtra())
        change(run.pages[0])
        return file_of(job, [run.sealed()]), [run]
    return make


case("reserved-base-of-a-constant", CARELESS, RULE, "base of a constant column of u8 has more than one byte")(
    constant_extra(field(64, 8, "Q", 0x103)))


class Packed(Plain):
    """Sample numbers in as few bits as they need, so that the last byte has bits to spare."""

    def one_of(self, ways):
        return ways[1] if ways[0][:2] == (1, 64) else ways[0]


@case("padding-bits", CARELESS, RULE, "a padding bit after the packed sample numbers is set")
def padding_bits():
    job = job_of("xyz", light_paths=0)
    run = run_of(job, [(0, 37)], choice=Packed())
    page = run.pages[0]
    bits = page[column(page, 1) + 2]
    (records,) = struct.unpack_from("<I", run.entries, 12)
    assert bits * records % 8, "no padding bits"
    at, size = next(planes(page, 1))
    page[at + size - 1] |= 0x80
    return file_of(job, [run.sealed()]), [run]


def dictionary_byte(page):
    """A byte of a dictionary that no number refers to."""
    for number in (page[at] for at in column_offsets(page)):
        words = column(page, number) + 24
        for p, (at, size) in enumerate(planes(page, number)):
            (word,) = struct.unpack_from("<I", page, words + 4 * p)
            if word >> 30 == 3:
                bits = page[at]
                if page[at + 2**bits] == 0:
                    page[at + 2**bits] = 99
                    return
    raise AssertionError("no dictionary with an unused byte")


case("unused-dictionary-byte", CARELESS, RULE, "a byte of a dictionary that no number refers to is not zero")(
    first_page(dictionary_byte, choice=lambda: Prefer(codec=3)))

# ---- order, pages, squares, shares, precision, runs


def other_order(make_rows, kind="xyz", **fields):
    """A run whose records are put in another order before they are cut into pages."""
    def make():
        job = job_of(kind, **fields)
        records = records_of(job, [(0, 40)])
        kept, writer.in_order = writer.in_order, lambda records: make_rows(kept(records))
        try:
            run = run_of(job, [(0, 40)], records)
        finally:
            writer.in_order = kept
        return file_of(job, [run]), [run]
    return make


def exchanged(rows):
    camera = [row for row in rows if not row.light]
    return camera[1::-1] + camera[2:] + [row for row in rows if row.light]


case("records-not-in-order", CARELESS, RULE, "two records are exchanged")(other_order(exchanged, halton=False))


def other_cut(make_ends, **fields):
    def make():
        job = job_of("xyz", **fields)
        kept, writer.page_ends = writer.page_ends, make_ends
        try:
            run = run_of(job, [(0, 40)])
        finally:
            writer.page_ends = kept
        return file_of(job, [run]), [run]
    return make


case("page-cut-too-early", CARELESS, RULE, "the records of a run are in two pages, though one could hold them")(
    other_cut(lambda prefixes, most: [len(prefixes) // 2, len(prefixes)] if prefixes else []))
case("page-for-each-record", CARELESS, RULE, "every record has a page of its own")(
    other_cut(lambda prefixes, most: list(range(1, len(prefixes) + 1))))


@case("square-too-large", CARELESS, RULE, "the index names a larger square than the smallest that holds the records of a page")
def square_too_large():
    job = job_of("xyz", halton=False, light_paths=0)
    records = records_of(job, [(0, 40)])
    for record in records:
        record.u, record.v = record.u >> 4, record.v >> 4
    run = run_of(job, [(0, 40)], records)
    assert run.entries[0] >= 4
    struct.pack_into("<BBHII", run.entries, 0, 2, 0, 0, 0, 0)
    return file_of(job, [run.sealed(pages=False)]), [run]


def shares(value):
    def change(job, records):
        for record in records[:3]:
            record.share = writer.float_bits(value)
    return change


for name, value in {"too-small": 0.5, "too-large": 1.001, "zero": 0.0, "negative": -1.0}.items():
    case(f"share-{name}", CARELESS, RULE, f"samples whose shares add up to {value}")(one_run("xyz", shares(value)))


def beyond_precision(job, records):
    for record in records[:2]:
        record.xyz = (0x3F800001, 0x3F800001, 0x3F800001)
        record.power = [0x3F800001 for _ in record.power]


for kind in ("xyz", "spectral", "explicit"):
    case(f"beyond-the-precision-{kind}", CARELESS, RULE, "values with more bits of mantissa than the precision of the job")(
        one_run(kind, beyond_precision, precision=9))


@case("equal-coverage-other-records", CARELESS, RULE, "two runs of the same samples have different records")
def equal_coverage():
    job = job_of("xyz")
    runs = [run_of(job, [(0, 40)], seed=seed) for seed in (1, 2)]
    return file_of(job, runs), runs


@case("name-not-utf-8", CARELESS, "Header", "the name of an extra column is not UTF-8")
def not_utf_8():
    job, runs = two_runs(extra=[("aa", "u8")])
    file = File(job, runs)
    at = file.header.index(b"\x01\x02aa")
    file.header[at + 2 : at + 4] = b"\xff\xfe"
    file.header = seal_header(file.header)
    return b"".join(file.pieces()), runs


for name, text in {"not-json": b"made by hand", "array": b"[1, 2]", "nested-too-deep": b'{"a":' * 40 + b"{}" + b"}" * 40}.items():
    case(f"header-provenance-{name}", CARELESS, "Header", f"provenance of the header: {name.replace('-', ' ')}")(
        lambda text=text: (lambda job, runs: (file_of(job, runs, provenance=text), runs))(*two_runs()))
