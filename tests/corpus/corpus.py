"""The corpus: small files by name, each with what a reader must make of it. docs/format.md, "Conformance corpus"."""
import pathlib
import random
import struct
import sys
from dataclasses import dataclass

sys.dont_write_bytecode = True
TESTS = pathlib.Path(__file__).resolve().parent.parent
sys.path[:0] = [str(TESTS / "sampledb"), str(TESTS / "hostile")]
import write_latent as writer
from forged import File, Run
from native import hash128
from write_latent import SPECTRAL, XYZ, Job, Plain, Record, Smallest, encode_run, job_id

# What a file is.
VALID = "valid"  # readers read everything, and no rule is broken
CARELESS = "careless"  # readers read everything; a rule for writers is broken, which verify --strict reports
UNFINISHED = "unfinished"  # an attempt: every whole run is read, and what follows is no damage
DAMAGED = "damaged"  # readers report damage, and read the runs that are listed
REFUSED = "refused"  # nothing can be read, or must not be

LEVELS = ["headers", "quick", "stored", "full"]  # of verification, cheapest first


@dataclass
class Case:
    name: str
    outcome: str
    section: str  # of docs/format.md
    about: str
    make: object  # returns (bytes, [Run, ...] that are intact)
    found: str = ""  # DAMAGED: the cheapest level that finds it


CASES = {}


def case(name, outcome, section, about, found=""):
    """Names a function that makes a file."""
    def add(make):
        file = name if ".latent" in name else name + ".latent"
        assert file not in CASES, file
        assert (outcome == DAMAGED) == (found in LEVELS), file
        CASES[file] = Case(file, outcome, section, about, make, found)
        return make
    return add


# ---- jobs and their records


DENSITY = [(0, 360 << 20), (2**47, 500 << 20), (2**48, 830 << 20)]


def job_of(kind, **fields):
    """"xyz", "spectral" (wavelengths of a density) or "explicit" (wavelengths as data)."""
    name = "corpus %s %s" % (kind, sorted(fields.items()))
    if fields.get("halton") is False:
        fields["shifts"] = (0, 0)
    if kind == "xyz":
        return Job(job_id(name), XYZ, **{"run_samples": 2**10, "light_paths": 1, "halton": True, "shifts": (1, 2**31 + 7)} | fields)
    if kind == "spectral":
        return Job(job_id(name), SPECTRAL, **{"k": 8, "knots": DENSITY, "run_samples": 2**10, "light_paths": 1,
            "halton": True} | fields)
    return Job(job_id(name), SPECTRAL, **{"k": 8, "run_samples": 2**10} | fields)


def filler(job, r):
    """Gives a record values of the job's kind, a third of them black."""
    def fill(record):
        black = not record.light and r.random() < 0.3
        if job.kind == XYZ:
            record.xyz = (0, 0, 0) if black else tuple(writer.a_value(r) for _ in range(3))
            return
        n = 0 if black else r.choice([1, job.k] if job.knots else range(1, job.k + 1))
        record.power = [writer.a_value(r) for _ in range(n)]
        if job.knots:
            record.xi = r.getrandbits(32)
            record.index = r.randrange(job.k) if n == 1 < job.k else 65535
        else:
            record.lambdas = sorted(writer.float_bits(r.uniform(360, 830)) for _ in range(n))
    return fill


def records_of(job, intervals, seed=1):
    r = random.Random(seed)
    records = writer.make_records(job, intervals, r, filler(job, r))
    for record in records:
        writer.round_values(job, record)
    return records


def run_of(job, intervals, records=None, choice=None, seed=1):
    if records is None:
        records = records_of(job, intervals, seed)
    return Run(encode_run(job, intervals, records, choice or Plain())).sealed()


def two_runs(kind="xyz", choice=None, samples=40, **fields):
    """What damage is done to: (job, [run, run])."""
    job = job_of(kind, **fields)
    spans = [(0, samples), (1024, 1024 + samples)]
    return job, [run_of(job, [span], choice=choice, seed=seed) for seed, span in enumerate(spans)]


def file_of(job, runs, footer=True, provenance=b"", **more):
    return b"".join(File(job, runs, provenance).pieces(footer=footer, **more))


def flipped(data, at, bit=0):
    out = bytearray(data)
    out[at] ^= 1 << bit
    return bytes(out)


def offsets(job, runs):
    """Where each of the runs begins in a file, and where the last one ends."""
    at = [len(File(job, []).header)]
    for run in runs:
        at.append(at[-1] + len(run.data()))
    return at


# ---- pages and how they are stored


class Prefer:
    """Takes a transform, or a codec, wherever it can be used; otherwise what takes fewest bytes."""

    def __init__(self, transform=None, codec=None):
        self.transform, self.codec = transform, codec

    def one_of(self, ways):
        return next((way for way in ways if way[0] == self.transform), Smallest().one_of(ways))

    def plane(self, plane):
        ways = writer.plane_codecs(plane)
        return next((way for way in ways if way[0] == self.codec), min(ways, key=lambda way: len(way[1])))


def column_offsets(page):
    """Where each column begins in the table of a page."""
    (count,) = struct.unpack_from("<I", page, 0)
    at = 4
    for _ in range(count):
        yield at
        at += 24 + 4 * page[at + 3]


def column(page, number):
    return next(at for at in column_offsets(page) if page[at] == number)


def planes(page, number):
    """(offset, size) of every stored plane of a column."""
    at = max(column_offsets(page))
    at += 24 + 4 * page[at + 3]
    for begin in column_offsets(page):
        for p in range(page[begin + 3]):
            (word,) = struct.unpack_from("<I", page, begin + 24 + 4 * p)
            if page[begin] == number:
                yield at, word % 2**30
            at += word % 2**30


# ---- what expected.json says of a file


def described(run):
    """A run that a reader must find intact."""
    (camera, light) = struct.unpack_from("<QQ", run.header, 72)
    (low, high) = struct.unpack_from("<QQ", run.header, 120)
    bounds = struct.unpack("<%dQ" % (len(run.intervals) // 8), run.intervals)
    return {"samples": [list(pair) for pair in zip(bounds[::2], bounds[1::2])], "camera_records": camera, "light_records": light,
            "content_hash": "%016x%016x" % (high, low)}


def made(case):
    """The bytes of the file, and its entry in expected.json."""
    data, runs = case.make()
    entry = {"outcome": case.outcome, "section": case.section, "about": case.about, "size": len(data),
             "hash128": "%016x%016x" % hash128(data)[::-1], "runs": [described(run) for run in runs]}
    if case.found:
        entry["found_at"] = case.found
    return data, entry
