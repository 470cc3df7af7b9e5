"""As many of everything as there may be, names and cuts."""
import struct

from forged import (BLOCK, HEADER, File, Run, base, empty_run, first_form_of, footer_of, footer_of_entries, hash64, hash128, job_id,
                    writer)
from cases import KINDS, case
from field_cases import columns_of
from write_latent import Job, Plain, Record, Smallest, encode_header

# ---- many of everything; each takes how many


def many_runs(count, make_run, footer=True, listed=None):
    job, _ = base("xyz", [])
    front = encode_header(job)
    runs = [make_run(job, i) for i in range(count)]
    at = len(front) + sum(map(len, runs))
    tail = footer_of(at, [run[:HEADER] for run in runs] if listed is None else listed) if footer else []
    return [front, *runs, *tail]


def quick_empty_run(job, first, end):
    """As empty_run, one interval, faster."""
    index = struct.pack("<QQ", first, end) + bytes(BLOCK - HEADER - 16)
    header = b"\x8dLTDBR\r\n" + struct.pack("<HHIQQQQQQQQQQQQQQQ", 1, 0, 1, 0, *job.id, first, end, end - first, 0, 0, 0, 0, 0, 0,
                                            hash64(index), *hash128(b""))
    header += bytes(248 - len(header))
    return header + struct.pack("<Q", hash64(header)) + index


def damaged(run, at):
    return run[:at] + bytes([run[at] ^ 1]) + run[at + 1 :]


def later(run):
    header = bytearray(run[:HEADER])
    struct.pack_into("<Q", header, 16, 1 << 40)
    struct.pack_into("<Q", header, 248, hash64(header[:248]))
    return bytes(header) + run[HEADER:]


RUNS = {
    "sound": lambda job, i: quick_empty_run(job, 1024 * i, 1024 * i + 1024),
    "index-damaged": lambda job, i: damaged(quick_empty_run(job, 1024 * i, 1024 * i + 1024), 4000),
    "of-later-version": lambda job, i: later(quick_empty_run(job, 1024 * i, 1024 * i + 1024)),
    "every-other-header-damaged": lambda job, i: damaged(quick_empty_run(job, 1024 * i, 1024 * i + 1024), 30 if i % 2 else 2000),
    "nested": lambda job, i: quick_empty_run(job, i, 2**40 - i),
    "staggered": lambda job, i: quick_empty_run(job, 700 * i, 700 * i + 1024),
    "all-equal": lambda job, i: quick_empty_run(job, 0, 1024),
    "at-the-end-of-numbers": lambda job, i: quick_empty_run(job, 2**64 - 2 - i, 2**64 - 1),
}
for name, make_run in RUNS.items():
    for count in (500, 20000):
        case(f"runs-{count}-{name}", large=count > 500)(lambda count=count, make_run=make_run: many_runs(count, make_run))
case("runs-200000-sound", large=True)(lambda: many_runs(200000, RUNS["sound"]))
case("runs-20000-footer-lists-none", large=True)(lambda: many_runs(20000, RUNS["sound"], listed=[]))
case("runs-20000-without-footer", large=True)(lambda: many_runs(20000, RUNS["sound"], footer=False))


def listed_only(count, distinct):
    """A footer of runs that are not there; the file has holes in their place."""
    def make():
        job, _ = base("xyz", [])
        front = encode_header(job)
        if distinct:
            entries = b"".join(quick_empty_run(job, 1024 * i, 1024 * i + 1024)[8:136] for i in range(count))
        else:
            entries = quick_empty_run(job, 0, 1024)[8:136] * count
        return [front, count * BLOCK, *footer_of_entries(len(front) + count * BLOCK, count, entries)]
    return make


case("listed-1000", large=False)(listed_only(1000, True))
case("listed-150000", large=True)(listed_only(150000, True))
case("listed-equal-150000", large=True)(listed_only(150000, False))
case("listed-1048576", large=True)(listed_only(2**20, False))


def first_form_of_most():
    """A footer of the first form, 2^30 bytes long, most of them provenance in a hole of the file."""
    job, runs = base("xyz")
    file = File(job, [run.sealed() for run in runs])
    front = file.pieces(footer=False)
    at = sum(map(len, front))
    body = first_form_of(at, [(len(front[0]), runs[0].header)], bytes(2**30 - 24 - 264 - 64))
    return [*front, body]


case("first-form-of-2^30-bytes", large=True)(first_form_of_most)


def gaps(count, each, step, offset):
    """Runs of `each` intervals; run i begins at i `offset`, its intervals `step` apart."""
    def make():
        job, _ = base("xyz", [])
        runs = [empty_run(job, [(j * step + i * offset, j * step + i * offset + 1) for j in range(each)]) for i in range(count)]
        return File(job, runs).pieces()
    return make


case("gaps-16-interleaved-of-1000")(gaps(16, 1000, 40, 2))
case("gaps-300-overlapping-of-100")(gaps(300, 100, 2, 2))
case("gaps-16-interleaved-of-65536", large=True)(gaps(16, 65536, 40, 2))
case("gaps-4-overlapping-of-65536", large=True)(gaps(4, 65536, 2, 2))
case("gaps-3000-overlapping-of-200", large=True)(gaps(3000, 200, 2, 2))
case("gaps-20-interleaved-of-65536", large=True)(gaps(20, 65536, 64, 3))


def many_pages(count, records, stored, runs=1):
    """Runs of many pages, all with one entry; `stored`: bytes of each, zeros."""
    def make():
        job, sound = base("xyz", [(0, 2)])
        width = 8 + 4 * 6 + 1 + 8
        page = bytes(stored)
        entry = struct.pack("<BBHIIIIIQIIQ", 0, 0, 0, 0, 0, records, 0, records * width, 0, stored, 0, hash64(page))
        out = []
        for i in range(runs):
            run = Run(writer.encode_run(job, [(2**30 * i, 2**30 * i + 2**30)], [], Plain()))
            run.pages = [page * count]
            index = bytes(run.intervals) + entry * count
            run.tail = index + bytes(-(HEADER + stored * count + len(index)) % BLOCK)
            struct.pack_into("<QQQQQQQ", run.header, 64, count, records * count, 0, 0, records * width * count, stored * count, hash64(run.tail))
            struct.pack_into("<QQ", run.header, 120, *hash128(entry[:32] * count))
            run.rehash_header()
            out.append(run)
        return File(job, out).pieces()
    return make


case("pages-5000-of-nothing")(many_pages(5000, 6144, 0))
case("pages-2^20-of-nothing", large=True)(many_pages(2**20, 1, 0))
case("pages-2^20-of-nothing-twice", large=True)(many_pages(2**20, 6144, 0, runs=2))
case("pages-2^17-of-8-bytes", large=True)(many_pages(2**17, 6144, 8, runs=4))


def large_pages(job, count, record, camera=True):
    """A run of pages of as many records as there may be, all of one value; each page is small in the file."""
    def make():
        rows = writer.most_records(job)
        out, samples = [], rows
        records = [record(n) for n in range(samples)]
        one = writer.encode_run(job, [(0, samples)], records, Smallest())
        template = Run(one)
        for i in range(count):
            run = Run(one)
            run.intervals = bytearray(struct.pack("<QQ", i * 8192, i * 8192 + samples))
            struct.pack_into("<QQ", run.header, 40, i * 8192, i * 8192 + samples)
            del template
            template = run
            for page in run.pages:  # the samples' base, and the hash of the column, which only --deep compares
                (base_at,) = (columns_of(page)[0] + 8,)
                struct.pack_into("<Q", page, base_at, i * 8192)
            run.sealed()
            out.append(run)
        return File(job, out).pieces()
    return make


WIDE = Job(job_id("wide xyz"), writer.XYZ, run_samples=2**13, light_paths=1, extra=[(f"column {i} " + "x" * 54, "f64") for i in range(16)])
PAIRS = Job(job_id("wide pairs"), writer.SPECTRAL, k=14, run_samples=2**13, light_paths=1, extra=[(f"c{i}", "u64") for i in range(16)])
MANY = Job(job_id("many pairs"), writer.SPECTRAL, k=1024, run_samples=2**13, light_paths=1, extra=[(f"c{i}", "u64") for i in range(16)])
for count in (4, 200):
    case(f"wide-pages-{count}", large=count > 4)(large_pages(WIDE, count, lambda n: Record(n, 2**31, 2**31, xyz=(0, 0, 0), extra=(0,) * 16)))
    case(f"wide-pairs-{count}", large=count > 4)(large_pages(
        PAIRS, count, lambda n: Record(n, 2**31, 2**31, power=[0] * 14, lambdas=[0x44000000] * 14, extra=(0,) * 16)))
    case(f"many-pairs-{count}", large=count > 4)(large_pages(
        MANY, count, lambda n: Record(n, 2**31, 2**31, power=[0] * 1024, lambdas=[0x44000000] * 1024, extra=(0,) * 16)))


# ---- names, cuts, and holes


def names_case(names):
    def make():
        job = Job(job_id("names"), writer.XYZ, run_samples=2**10, extra=[(name, "u8") for name in names])
        records = [Record(n, n << 20, n << 21, xyz=(0x3F800000,) * 3, extra=(1,) * len(names)) for n in range(50)]
        return File(job, [Run(writer.encode_run(job, [(0, 50)], records, Plain())).sealed()]).pieces()
    return make


for name, names in {"like-columns": ["sample", "class", "u", "v", "share", "x", "y", "z", "extra.x"], "controls": ["\x1b[2J\x07", "\u009b31m", "a\nb"],
                    "quotes": ['"', '","', "\\", "{}", "[]"], "equal": ["a", "a"], "empty": [""], "long": ["x" * 64, "y" * 64]}.items():
    case(f"names-{name}")(names_case(names))


def cut(kind, part):
    def make():
        job, runs = base(kind, [(0, 300), (1024, 1100)])
        whole = b"".join(File(job, [run.sealed() for run in runs]).pieces())
        return [whole[: int(len(whole) * part)]]
    return make


for i in range(10):
    case(f"cut-{i}")(cut(KINDS[i % 3], i / 10))


@case("hole-of-2^30-bytes", large=True)
def hole():
    job, runs = base("xyz", [(0, 300), (1024, 1100)])
    pieces = File(job, [run.sealed() for run in runs]).pieces(footer=False)
    return [*pieces[:2], 2**30, pieces[2]]
