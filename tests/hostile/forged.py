"""Files whose fields can be overwritten, and whose hashes then say that all is well. docs/format.md."""
import pathlib
import random
import struct
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "sampledb"))
import write_latent as writer
from native import hash64, hash128
from write_latent import BLOCK, Job, Plain, encode_header, job_id

FRONT, HEADER, ENTRY = 64, 256, 48
WIDTH = {"B": 1, "H": 2, "I": 4, "Q": 8}

# ---- files whose fields can be overwritten


class Run:
    """The bytes of a run, in parts; `sealed` puts them together so that every hash is right."""

    def __init__(self, data):
        (intervals,) = struct.unpack_from("<I", data, 12)
        (pages, pages_size) = struct.unpack_from("<Q", data, 64) + struct.unpack_from("<Q", data, 104)
        index = HEADER + pages_size
        self.header = bytearray(data[:HEADER])
        self.intervals = bytearray(data[index : index + 16 * intervals])
        self.entries = bytearray(data[index + 16 * intervals : index + 16 * intervals + ENTRY * pages])
        self.pages, at = [], HEADER
        for i in range(pages):
            (size,) = struct.unpack_from("<I", self.entries, ENTRY * i + 32)
            self.pages.append(bytearray(data[at : at + size]))
            at += size

    def rehash_pages(self, sizes=True):
        for i, page in enumerate(self.pages):
            if sizes:
                struct.pack_into("<I", self.entries, ENTRY * i + 32, len(page))
            struct.pack_into("<Q", self.entries, ENTRY * i + 40, hash64(page))

    def add_up(self):
        """The header's counts are what the index says."""
        entries = [struct.unpack_from("<BBHIIIIIQIIQ", self.entries, at) for at in range(0, len(self.entries), ENTRY)]
        struct.pack_into("<I", self.header, 12, len(self.intervals) // 16)
        counts = [len(entries), sum(e[5] for e in entries if e[1] == 0), sum(e[5] for e in entries if e[1] != 0),
                  sum(e[6] for e in entries), sum(e[7] for e in entries), sum(e[9] for e in entries)]
        struct.pack_into("<QQQQQQ", self.header, 64, *counts)

    def rehash_index(self):
        body = bytes(self.intervals + self.entries)
        length = HEADER + sum(map(len, self.pages)) + len(body)
        self.tail = body + bytes(-length % BLOCK)
        struct.pack_into("<Q", self.header, 112, hash64(self.tail))
        content = b"".join(bytes(self.entries[at : at + 32]) for at in range(0, len(self.entries), ENTRY))
        struct.pack_into("<QQ", self.header, 120, *hash128(content))

    def rehash_header(self):
        struct.pack_into("<Q", self.header, 248, hash64(self.header[:248]))

    def data(self):
        return bytes(self.header) + b"".join(map(bytes, self.pages)) + self.tail

    def sealed(self, pages=True, sums=False):
        if pages:
            self.rehash_pages()
        if sums:
            self.add_up()
        self.rehash_index()
        self.rehash_header()
        return self


def seal_header(header):
    """Both copies from the first, whose fields were overwritten."""
    half = bytearray(header[: len(header) // 2])
    struct.pack_into("<Q", half, 32, hash64(half[FRONT:]))
    struct.pack_into("<Q", half, 56, hash64(half[:56]))
    return bytes(half + half)


def footer_of(offset, runs, provenance=b"", fields=()):
    """`runs`: the header of each. `fields`: (offset, value) of the head, put in before it is hashed."""
    entries = b"".join(bytes(header[8:136]) for header in runs)
    return footer_of_entries(offset, len(runs), entries, provenance, fields)


def footer_of_entries(offset, count, entries, provenance=b"", fields=()):
    head = bytearray(b"\x8dLTDBI\r\n" + struct.pack("<QQQQQ8x", offset, count, len(provenance), hash64(entries), hash64(provenance)))
    for at, value in fields:
        struct.pack_into("<Q", head, at, value)
    head += struct.pack("<Q", hash64(head))
    return [bytes(head), entries, provenance, bytes(head)]


def first_form_of(offset, runs, provenance=b"", counts=None, fields=()):
    """`runs`: (offset, header) of each. `fields`: (offset, value) of the trailer."""
    count, length = counts or (len(runs), len(provenance))
    body = b"\x8dLTDBE\r\n" + struct.pack("<QQ", count, length)
    body += b"".join(struct.pack("<Q", at) + bytes(header) for at, header in runs) + provenance
    trailer = bytearray(struct.pack("<QQQ24x", offset, len(body) + FRONT, hash64(body)))
    for at, value in fields:
        struct.pack_into("<Q", trailer, at, value)
    return body + bytes(trailer) + struct.pack("<Q", hash64(trailer)) + b"\x8dLTDBE\r\n"


class File:
    """Header, runs, and a footer that lists them."""

    def __init__(self, job, runs, provenance=b""):
        self.header = bytearray(encode_header(job, provenance))
        self.runs = runs

    def pieces(self, footer=True, **more):
        out, at = [bytes(self.header)], len(self.header)
        for run in self.runs:
            out.append(run.data())
            at += len(out[-1])
        return out + (footer_of(at, [run.header for run in self.runs], **more) if footer else [])


# ---- jobs and runs to begin with


def base(kind, intervals=((0, 300),), seed=1, choice=None):
    r = random.Random(seed)
    if kind == "xyz":
        job = Job(job_id("hostile xyz"), writer.XYZ, halton=True, light_paths=1, run_samples=2**10,
                  extra=[("group", "u8"), ("time", "f64")])
    elif kind == "spectral":
        job = Job(job_id("hostile spectral"), writer.SPECTRAL, k=28, knots=[(0, 360 << 20), (2**48, 830 << 20)], light_paths=1,
                  run_samples=2**10)
    else:
        job = Job(job_id("hostile explicit"), writer.SPECTRAL, k=1024, run_samples=2**10)

    def fill(record):
        if kind == "xyz":
            record.xyz = tuple(writer.noise(r) if r.random() < 0.5 else 0 for _ in range(3))
            return
        n = r.choice([0, 1, job.k if kind == "spectral" else 5])
        record.xi = r.getrandbits(32) if kind == "spectral" else 0
        record.index = r.randrange(job.k) if kind == "spectral" and n == 1 else 65535
        record.power = [writer.noise(r) for _ in range(n)]
        record.lambdas = [] if kind == "spectral" else sorted(writer.float_bits(r.uniform(360, 830)) for _ in range(n))

    runs = [Run(writer.encode_run(job, [span], writer.make_records(job, [span], r, fill), choice or Plain())).sealed() for span in intervals]
    return job, runs


def empty_run(job, intervals, fields=()):
    """A run without records."""
    run = Run(writer.encode_run(job, intervals, [], Plain()))
    for at, layout, value in fields:
        struct.pack_into("<" + layout, run.header, at, value)
    run.rehash_index()
    run.rehash_header()
    return run
