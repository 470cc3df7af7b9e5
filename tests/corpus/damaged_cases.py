"""Damaged files: bits that flipped, files that were cut, and fields that contradict the format although every hash is right."""
import struct

from corpus import (DAMAGED, REFUSED, Prefer, case, column, file_of, flipped, job_of, offsets, planes, records_of, run_of, two_runs,
                    writer)
from forged import BLOCK, HEADER, File, first_form_of, footer_of, seal_header
from rule_cases import field, first_page

LATER = "Versions and extensions"


def index_of(data, where):
    """Where the index of the run at `where` begins."""
    return where + HEADER + struct.unpack_from("<Q", data, where + 104)[0]


def changed(change, keep=(0, 1), **fields):
    """A file of two runs whose bytes are changed: change(data, offsets of the runs and of the footer)."""
    def make():
        job, runs = two_runs(**fields)
        data = change(bytearray(file_of(job, runs)), offsets(job, runs))
        return bytes(data), [runs[i] for i in keep]
    return make


def at(place, bit=0):
    """Flips one bit; `place`: from the offsets of the runs to an offset in the file."""
    return lambda data, where: flipped(data, place(where) % len(data), bit)


# ---- one bit


for name, place in {"magic": 3, "copy-size": 12, "features": 20, "front-hash": 56, "body": 70, "zeros": 2000}.items():
    case(f"flip-first-header-{name}", DAMAGED, "Header", f"a bit in the first copy of the header: {name}", "headers")(
        changed(at(lambda where, place=place: place)))
    case(f"flip-second-header-{name}", DAMAGED, "Header", f"a bit in the second copy of the header: {name}", "headers")(
        changed(at(lambda where, place=place: BLOCK + place)))
    case(f"flip-both-headers-{name}", REFUSED, "Header", f"a bit in both copies of the header: {name}")(
        changed(lambda data, where, place=place: flipped(flipped(data, place), BLOCK + place), keep=()))

RUN_PLACES = {"magic": 0, "major": 8, "minor": 10, "intervals": 12, "job": 24, "first": 40, "pages": 64, "pages-size": 104,
              "content-hash": 120, "zero": 200, "hash": 248}
for name, place in RUN_PLACES.items():
    case(f"flip-run-header-{name}", DAMAGED, "Run", f"a bit in the header of the first run: {name}", "headers")(
        changed(at(lambda where, place=place: where[0] + place), keep=(1,)))
case("flip-page-table", DAMAGED, "Page", "a bit in the table of the only page of the first run", "quick")(
    changed(at(lambda where: where[0] + HEADER + 5), keep=(1,), light_paths=0))
case("flip-page-planes", DAMAGED, "Page", "a bit in the planes of a page of the last run", "stored")(
    changed(lambda data, where: flipped(data, index_of(data, where[1]) - 1), keep=(0,)))
for name, back in {"interval": 0, "entry": 16 + 12, "page-hash": 16 + 24, "stored-hash": 16 + 40}.items():
    case(f"flip-index-{name}", DAMAGED, "Run", f"a bit in the index of the first run: {name}", "quick")(
        changed(lambda data, where, back=back: flipped(data, index_of(data, where[0]) + back), keep=(1,)))
case("flip-padding", DAMAGED, "Run", "a bit in the zeros at the end of the first run", "quick")(
    changed(at(lambda where: where[1] - 1), keep=(1,)))
for name, place in {"magic": 2, "offset": 8, "count": 16, "entries-hash": 32, "hash": 60, "entry": 64 + 40, "tail": 64 + 256 + 20,
    "last-byte": 64 + 256 + 63}.items():
    case(f"flip-footer-{name}", DAMAGED, "Footer", f"a bit in the footer: {name}", "headers")(
        changed(at(lambda where, place=place: where[2] + place)))

# ---- parts that are missing, doubled or from elsewhere


def cut(place, keep):
    return changed(lambda data, where: data[: place(where)], keep)


case("cut-empty", REFUSED, "Reading", "an empty file")(cut(lambda where: 0, ()))
case("cut-in-the-magic", REFUSED, "Reading", "the first five bytes")(cut(lambda where: 5, ()))
case("cut-in-the-first-header", REFUSED, "Reading", "cut off in the first copy of the header")(cut(lambda where: 100, ()))
case("cut-in-the-second-header", DAMAGED, "Reading", "cut off in the second copy of the header",
    "headers")(cut(lambda where: BLOCK + 100, ()))
case("cut-after-the-header", DAMAGED, "Reading", "nothing but the header, under a name that is not an attempt's",
    "headers")(cut(lambda where: where[0], ()))
case("cut-in-a-run-header", DAMAGED, "Reading", "cut off in the header of the second run",
    "headers")(cut(lambda where: where[1] + 100, (0,)))
case("cut-in-a-page", DAMAGED, "Reading", "cut off in a page of the second run", "headers")(cut(lambda where: where[1] + 700, (0,)))
case("cut-before-the-footer", DAMAGED, "Reading", "cut off between the last run and the footer",
    "headers")(cut(lambda where: where[2], (0, 1)))
case("cut-in-the-footer", DAMAGED, "Reading", "cut off in the footer", "headers")(cut(lambda where: where[2] + 100, (0, 1)))
case("cut-by-a-byte", DAMAGED, "Reading", "the last byte is missing", "headers")(cut(lambda where: -1, (0, 1)))
case("longer-by-a-byte", DAMAGED, "Reading", "a byte follows the footer", "headers")(changed(lambda data, where: data + b"\0"))
case("longer-by-a-block", DAMAGED, "Reading", "a block of zeros follows the footer",
    "headers")(changed(lambda data, where: data + bytes(BLOCK)))
case("first-run-zeroed", DAMAGED, "Reading", "zeros instead of the first run", "headers")(
    changed(lambda data, where: data[: where[0]] + bytes(where[1] - where[0]) + data[where[1] :], (1,)))
case("last-run-zeroed", DAMAGED, "Reading", "zeros instead of the last run", "headers")(
    changed(lambda data, where: data[: where[1]] + bytes(where[2] - where[1]) + data[where[2] :], (0,)))
case("first-run-missing", DAMAGED, "Reading", "the footer lists a run that is not there; what follows has moved up", "headers")(
    changed(lambda data, where: data[: where[0]] + data[where[1] :], (1,)))
case("hole-between-runs", DAMAGED, "Reading", "two blocks of zeros between the runs", "headers")(
    changed(lambda data, where: data[: where[1]] + bytes(2 * BLOCK) + data[where[1] :]))
case("byte-inserted", DAMAGED, "Reading", "a byte before the second run: it no longer begins a block", "headers")(
    changed(lambda data, where: data[: where[1]] + b"\0" + data[where[1] :], (0,)))
case("page-zeroed-after-power-cut", DAMAGED, "Reading", "zeros instead of the pages of the last run", "quick")(
    changed(lambda data, where: data[: where[1] + HEADER] + bytes(struct.unpack_from("<Q", data, where[1] + 104)[0]) +
            data[where[1] + HEADER + struct.unpack_from("<Q", data, where[1] + 104)[0] :], (0,)))


def of_another_job(place):
    def make():
        job, runs = two_runs()
        other = run_of(job_of("xyz", light_unit=2.0), [(2048, 2088)])
        placed = [*runs]
        placed.insert(place, other)
        return file_of(job, placed), runs
    return make


case("run-of-another-job", DAMAGED, "Reading", "a sound run of another job between two of this one", "headers")(of_another_job(1))
case("last-run-of-another-job", DAMAGED, "Reading", "a sound run of another job at the end", "headers")(of_another_job(2))


@case("run-replaced", DAMAGED, "Footer", "another run of the job, of the same length, where the first one was", "headers")
def run_replaced():
    job, runs = two_runs()
    other = run_of(job, [(4096, 4136)])
    data, where = file_of(job, runs), offsets(job, runs)
    assert len(other.data()) == where[1] - where[0]
    return data[: where[0]] + other.data() + data[where[1] :], [other, runs[1]]


@case("run-inside-a-page", DAMAGED, "Reading", "the header of a run begins a block inside a damaged run, as bytes of a page",
    "headers")
def run_inside():
    job = job_of("explicit", k=1024)
    runs = [run_of(job, [(0, 80)]), run_of(job, [(1024, 1064)])]
    where = offsets(job, runs)
    data = bytearray(file_of(job, runs))
    assert where[1] - where[0] > 3 * BLOCK
    data[where[0] : where[0] + 8] = bytes(8)
    data[where[0] + BLOCK : where[0] + BLOCK + HEADER] = runs[1].header
    return bytes(data), [runs[1]]


# ---- footers that contradict the runs


def with_footer(make_footer):
    def make():
        job, runs = two_runs()
        front = file_of(job, runs, footer=False)
        footer = make_footer(len(front), offsets(job, runs), [run.header for run in runs])
        return front + (b"".join(footer) if isinstance(footer, list) else footer), runs
    return make


def other_samples(header):
    header = bytearray(header)
    struct.pack_into("<QQ", header, 40, 5000, 5040)
    return header


FOOTERS = {
    "omits-a-run": ("the footer omits the last run", lambda end, where, runs: footer_of(end, runs[:1])),
    "lists-a-run-twice": ("the footer lists a run twice", lambda end, where, runs: footer_of(end, [*runs, runs[1]])),
    "lists-other-samples": ("the footer lists a run with other samples", lambda end, where,
    runs: footer_of(end, [other_samples(runs[0]), runs[1]])),
    "other-order": ("the footer lists the runs in another order", lambda end, where, runs: footer_of(end, runs[::-1])),
    "of-another-place": ("the footer gives another offset for itself", lambda end, where, runs: footer_of(end + BLOCK, runs)),
    "too-many-runs": ("the footer's count of runs is 2^40", lambda end, where, runs: footer_of(end, runs, fields=[(16, 2**40)])),
    "zero": ("a field that must be zero is not", lambda end, where, runs: footer_of(end, runs, fields=[(48, 1)])),
    "first-form-other-offset": ("a footer of the first form lists a run at another offset",
                                lambda end, where, runs: first_form_of(end, [(where[0], runs[0]), (where[1] + BLOCK, runs[1])])),
    "first-form-flipped": ("a bit in the entries of a footer of the first form",
                           lambda end, where, runs: flipped(first_form_of(end, list(zip(where, runs))), 100)),
}
for name, (about, make_footer) in FOOTERS.items():
    case(f"footer-{name}", DAMAGED, "Footer", about, "headers")(with_footer(make_footer))


@case("footer-cut-and-copied", DAMAGED, "Footer", "the footer of another file of the job stands at the end", "headers")
def copied_footer():
    job, runs = two_runs()
    other = file_of(job, [run_of(job, [(2048, 2088)])])
    begin = offsets(job, [run_of(job, [(2048, 2088)])])[-1]
    return file_of(job, runs, footer=False) + other[begin:], runs


# ---- fields that contradict the page, with every hash right


def header_field(place, layout, value, **fields):
    def make():
        job, runs = two_runs("spectral", **fields)
        file = File(job, runs)
        struct.pack_into("<" + layout, file.header, place, value)
        file.header = seal_header(file.header)
        return b"".join(file.pieces()), []
    return make


for name, place, layout, value, about in [
        ("major", 8, "H", 2, "major version 2"), ("copy-size", 12, "I", BLOCK + 1, "copy_size is not a multiple of 4096"),
        ("feature-4", 16, "Q", 16, "an unknown feature bit"),
        ("feature-without-pixels", 16, "Q", 10, "the feature of the sampler pixels, and another sampler"),
        ("feature-without-columns", 16, "Q", 6, "the feature of many extra columns, and none"), ("feature-private", 16, "Q", 1 << 60, "a private feature bit"),
        ("body-size", 24, "Q", BLOCK - 63, "body_size exceeds the copy"), ("aspect", 64 + 16, "I", 0, "an aspect of 0 : 2"),
        ("aspect-not-lowest", 64 + 16, "I", 4, "an aspect of 4 : 2"), ("kind", 64 + 24, "B", 3, "record kind 3"),
        ("sampler", 64 + 25, "B", 3, "position sampler 3"), ("k", 64 + 26, "H", 1025, "1025 wavelengths"),
        ("light-unit", 64 + 32, "Q", 0x7FF0000000000000, "an infinite light unit"),
        ("run-bytes", 64 + 40, "Q", 2**30 + 1, "R above its bound"),
        ("run-samples", 64 + 48, "I", 1500, "S is not a power of two"), ("knots", 64 + 60, "I", 1, "a density of one knot"),
        ("knots-descend", 64 + 72 + 8 + 12, "I", 100 << 20, "wavelengths of the knots descend"),
        ("columns", 64 + 64, "I", 129, "129 extra columns"), ("provenance", 64 + 68, "I", 2**19 + 1, "too much provenance")]:
    later = name in ("major", "feature-4", "feature-private")
    case(f"header-{name}", REFUSED, LATER if later else "Header", about)(header_field(place, layout, value))


case("header-columns-without-feature", REFUSED, "Header", "17 extra columns without their feature bit")(
    header_field(16, "Q", 2, extra=[("column %d" % i, "u8") for i in range(17)]))


def run_field(place, layout, value, keep=(1,)):
    def make():
        job, runs = two_runs()
        listed = [run.header for run in runs]
        struct.pack_into("<" + layout, runs[0].header, place, value)
        runs[0].rehash_header()
        return file_of(job, runs), [runs[i] for i in keep]
    return make


for name, place, layout, value, about, found in [
        ("major", 8, "H", 2, "a run of major version 2", "headers"),
        ("feature", 16, "Q", 4, "a run with an unknown feature bit", "headers"),
        ("no-intervals", 12, "I", 0, "a run without intervals", "headers"),
        ("end", 48, "Q", 0, "the end of the coverage is its first sample", "headers"),
        ("samples", 56, "Q", 41, "more samples than the coverage has", "headers"),
        ("pages", 64, "Q", 2**20 + 1, "more pages than a run may have", "headers"),
        ("camera", 72, "Q", 7, "the count of camera records is not the sum over the index", "quick"),
        ("pairs", 88, "Q", 5, "pairs in an XYZ job", "headers"),
        ("decoded", 96, "Q", 1, "decoded bytes are not the sum over the index", "quick"),
        ("zero", 136, "Q", 1, "a field that must be zero is not", "headers"),
        ("content-hash", 120, "Q", 1, "the content hash is not that of the pages", "quick")]:
    case(f"run-{name}", DAMAGED, LATER if name in ("major", "feature") else "Run", about, found)(run_field(place, layout, value))


def entry_field(place, layout, value):
    def make():
        job, runs = two_runs()
        struct.pack_into("<" + layout, runs[0].entries, place, value)
        runs[0].sealed(pages=False, sums=True)
        return file_of(job, runs), [runs[1]]
    return make


for name, place, layout, value, about, found in [
        ("level", 0, "B", 17, "a square of level 17", "quick"), ("class", 1, "B", 2, "class 2", "quick"),
        ("zero", 2, "H", 1, "a field that must be zero is not", "quick"),
        ("x", 4, "I", 2**31, "a square outside the film", "quick"), ("records", 12, "I", 0, "a page without records", "quick"),
        ("records-beyond-m", 12, "I", 6145, "more than M records", "quick"), ("pairs", 16, "I", 1, "pairs in an XYZ job", "quick"),
        ("decoded", 20, "I", 8, "decoded bytes are not those of the columns", "quick"),
        ("page-hash", 24, "Q", 1, "the content hash is not that of the columns", "full")]:
    case(f"entry-{name}", DAMAGED, "Run", about, found)(entry_field(place, layout, value))

for name, intervals, about in [
        ("overlap", [(0, 30), (20, 40)], "intervals overlap"), ("touch", [(0, 20), (20, 40)], "intervals touch"),
        ("descend", [(30, 40), (0, 30)], "intervals descend"), ("empty", [(0, 0), (1, 40)], "an empty interval")]:
    def make(intervals=intervals):
        job, runs = two_runs()
        runs[0].intervals = bytearray(b"".join(struct.pack("<QQ", *pair) for pair in intervals))
        samples = sum(end - first for first, end in intervals)
        struct.pack_into("<QQQ", runs[0].header, 40, intervals[0][0], intervals[-1][1], samples)
        return file_of(job, [runs[0].sealed(sums=True), runs[1]]), [runs[1]]
    case(f"intervals-{name}", DAMAGED, "Run", about, "headers" if name == "descend" else "quick")(make)


# ---- pages that do not decode


def broken_page(change, **fields):
    """The first run is lost, for its first page is damaged though its stored bytes have the right hash."""
    make = first_page(change, **fields)
    return lambda: (lambda data, runs: (data, runs[1:]))(*make())


for name, number, place, layout, value, about, section in [
        ("column-order", 3, 0, "B", 4, "a column is named twice", "Page"),
        ("transform-13", 7, 1, "B", 13, "transform 13, which does not exist yet", LATER),
        ("transform-pixels-without-them", 1, 1, "B", 12, "samples by pixels in a job without a sampler", "Transforms"),
        ("transform-named-codecs", 7, 1, "B", 64, "transform 64, planes with named codecs", LATER),
        ("transform-private", 7, 1, "B", 200, "a private transform", LATER),
        ("transform-of-another-column", 3, 1, "B", 2, "the lattice, for v", "Transforms"),
        ("bits-65", 1, 2, "B", 65, "65 bits per number", "Transforms"),
        ("planes-9", 3, 3, "B", 9, "nine planes", "Page"), ("planes-3", 5, 3, "B", 3, "three planes for a column of u32", "Page"),
        ("s-33", 3, 4, "I", 33, "s beyond its bound", "Page"),
        ("column-hash", 5, 16, "Q", 1, "the hash of a column is not that of its values", "Page"),
        ("plane-too-long", 5, 24, "I", 2**30 - 1, "a plane longer than the page", "Page"),
        ("codec", 5, 24, "I", 2 << 30 | 40, "a constant of 40 bytes", "Codecs")]:
    case(f"page-{name}", DAMAGED, section, about, "full")(broken_page(field(number, place, layout, value), halton=False))
case("page-columns", DAMAGED, "Page", "the number of columns is not that of the job", "full")(
    broken_page(lambda page: struct.pack_into("<I", page, 0, 6)))
case("page-column-count-huge", DAMAGED, "Page", "the number of columns is 2^32 - 1", "full")(
    broken_page(lambda page: struct.pack_into("<I", page, 0, 2**32 - 1)))


def other_plane(number, codec, stored, **fields):
    """The first plane of a column is replaced."""
    def change(page):
        begin, size = next(planes(page, number))
        struct.pack_into("<I", page, column(page, number) + 24, codec << 30 | len(stored))
        page[begin : begin + size] = stored
    return broken_page(change, **fields)


FRAME = writer.zstd_compress(bytes(range(40)))
for name, codec, stored, about in [
        ("zstd-of-zeros", 1, bytes(40), "a zstd plane that is no frame"),
        ("zstd-too-short", 1, writer.zstd_compress(bytes(39)), "a zstd frame that decodes to too few bytes"),
        ("zstd-too-long", 1, writer.zstd_compress(bytes(2**20)), "a zstd frame that decodes to a mebibyte"),
        ("zstd-two-frames", 1, writer.zstd_compress(bytes(20)) * 2, "two zstd frames"),
        ("zstd-skippable", 1, b"\x50\x2a\x4d\x18\x00\x00\x00\x00" + FRAME, "a skippable frame before the frame"),
        ("zstd-cut", 1, FRAME[:-3], "a zstd frame that is cut off"),
        ("dictionary-0-bits", 3, b"\x00" + bytes(60), "a dictionary of 0 bits"),
        ("dictionary-8-bits", 3, b"\x08" + bytes(300), "a dictionary of 8 bits"),
        ("dictionary-cut", 3, b"\x07" + bytes(20), "a dictionary that is cut off"),
        ("raw-short", 0, bytes(11), "a raw plane that is too short")]:
    case(f"plane-{name}", DAMAGED, "Codecs", about, "full")(other_plane(5, codec, stored, halton=False))


class RawSparse(Prefer):
    """Sparse y, whose bitmap is stored as it is."""

    def plane(self, plane):
        return writer.raw(plane)


def other_bitmap(change):
    """The bitmap of a sparse y is replaced."""
    def make():
        job, runs = two_runs(choice=RawSparse(transform=6), samples=41)
        page = runs[0].pages[0]
        begin, size = next(planes(page, 6))
        page[begin : begin + size] = change(bytes(page[begin : begin + size]))
        return file_of(job, [runs[0].sealed(), runs[1]]), [runs[1]]
    return make


case("sparse-without-rows", DAMAGED, "Transforms", "a bitmap that names no row",
    "full")(other_bitmap(lambda bitmap: bytes(len(bitmap))))
case("sparse-beyond-the-page", DAMAGED, "Transforms", "a bitmap that names a row beyond the last", "full")(
    other_bitmap(lambda bitmap: bitmap[:-1] + bytes([bitmap[-1] | 0x80])))


# ---- records where they do not belong


@case("sample-outside-the-coverage", DAMAGED, "Run", "a record of a sample that the run does not cover", "full")
def outside_coverage():
    job = job_of("xyz")
    records = records_of(job, [(0, 40)])
    runs = [run_of(job, [(0, 30)], records), run_of(job, [(1024, 1064)])]
    return file_of(job, runs), [runs[1]]


@case("record-outside-its-square", DAMAGED, "Pages", "the index names a square that does not hold all records of the page", "full")
def outside_square():
    job, runs = two_runs()
    struct.pack_into("<BBHII", runs[0].entries, 0, 1, 0, 0, 1, 1)
    return file_of(job, [runs[0].sealed(pages=False), runs[1]]), [runs[1]]


@case("positions-not-of-the-sampler", DAMAGED, "Transforms", "positions are left out, though they are not those of the sampler",
    "full")
def other_positions():
    job = job_of("xyz")
    kept = writer.halton23
    writer.halton23 = lambda n, shifts: ((kept(n, shifts)[0] + 1) % 2**32, kept(n, shifts)[1])
    try:
        run = run_of(job, [(0, 40)], choice=Prefer(transform=3))
    finally:
        writer.halton23 = kept
    runs = [run, run_of(job, [(1024, 1064)])]
    return file_of(job, runs), [runs[1]]


@case("light-records-without-light-paths", DAMAGED, "Run", "light records in a job without light paths", "headers")
def no_light_paths():
    job, runs = two_runs()
    job.light_paths = 0
    return file_of(job, runs), []


for name, change, about in [
        ("two-pairs", lambda record: setattr(record, "power", record.power[:2]),
         "a record of a density that is neither empty, nor one wavelength, nor all"),
        ("index-beyond-k", lambda record: setattr(record, "index", 8), "a record keeps wavelength 8 of 8"),
        ("index-of-all", lambda record: setattr(record, "index", 3), "a record of all wavelengths names one")]:
    def make(change=change, name=name):
        job = job_of("spectral")
        records = records_of(job, [(0, 40)])
        wanted = 1 if name == "index-beyond-k" else job.k
        for record in records:
            if len(record.power) == wanted:
                change(record)
        runs = [run_of(job, [(0, 40)], records), run_of(job, [(1024, 1064)])]
        return file_of(job, runs), [runs[1]]
    case(f"pairs-{name}", DAMAGED, "Page", about, "full")(make)
