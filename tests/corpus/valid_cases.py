"""Valid files: every feature of the format at least once."""
import random
import struct

from corpus import (UNFINISHED, VALID, Plain, Prefer, Record, case, column_offsets, file_of, job_of, offsets, records_of, run_of,
    two_runs,
                    writer)
from forged import File, first_form_of, footer_of, seal_header
from write_latent import Smallest, Varied

KINDS = ("xyz", "spectral", "explicit")


def whole(make_job_and_runs, **more):
    """A file whose runs are all intact."""
    def make():
        job, runs = make_job_and_runs()
        return file_of(job, runs, **more), runs
    return make


@case("smallest", VALID, "A file, byte by byte", "the file that the page shows byte by byte")
def smallest():
    job, runs = writer.smallest()
    runs = [run_of(job, intervals, records, Smallest()) for intervals, records in runs]
    return file_of(job, runs), runs


# ---- encodings: the same records, stored in many ways


for kind in KINDS:
    for name, (choice, way) in {"plain": (Plain, "simplest"), "compact": (Smallest, "shortest")}.items():
        case(f"{kind}-{name}", VALID, "Page", f"{kind} records, each column stored in the {way} way")(
            whole(lambda kind=kind, choice=choice: two_runs(kind, choice())))
    for seed in range(1, 5):
        case(f"{kind}-varied-{seed}", VALID, "Page", f"{kind} records, each column stored in any way that the page allows")(
            whole(lambda kind=kind, seed=seed: two_runs(kind, Varied(seed))))
    for bits in (1, 9, 15, 22):
        case(f"{kind}-precision-{bits}", VALID, "Rounding", f"values rounded to {bits} bits of mantissa, header version 1.1")(
            whole(lambda kind=kind, bits=bits: two_runs(kind, Varied(bits), precision=bits)))
    for codec, name in enumerate(["raw", "zstd", "constant", "dictionary"]):
        case(f"{kind}-codec-{name}", VALID, "Codecs", f"planes stored by codec {codec} wherever it can be used")(
            whole(lambda kind=kind, codec=codec: two_runs(kind, Prefer(codec=codec))))

TRANSFORMS = {0: ("planes", "xyz", 23), 1: ("packed", "xyz", 23), 2: ("lattice", "xyz", 23), 3: ("sampler", "xyz", 23),
              4: ("cross", "xyz", 23), 5: ("delta2", "explicit", 23), 6: ("sparse", "xyz", 23), 7: ("sparse-cross", "xyz", 23),
              8: ("stepped-cross", "xyz", 9), 9: ("stepped-delta2", "explicit", 9), 10: ("stepped-sparse-cross", "xyz", 9),
              11: ("packed-delta2", "spectral", 9), 12: ("pixels", "xyz", 23)}


class PreferSparse(Prefer):
    """Sparse y, which the sparse transforms of x and z need."""

    def one_of(self, ways):
        return next((way for way in ways if way[0] == 6), super().one_of(ways))


def zeros_together(job, seed):
    """Records whose x and z are 0 wherever y is."""
    records = records_of(job, [(0, 60)], seed)
    for record in records:
        if record.xyz and record.xyz[1] == 0:
            record.xyz = (0, 0, 0)
    return records


def with_transform(number, kind, precision):
    def make():
        job = job_of(kind, precision=precision, **({"pixels": (12, 8)} if number == 12 else {}))
        choice = (PreferSparse if number in (7, 10) else Prefer)(transform=number)
        records = zeros_together(job, number) if kind == "xyz" else records_of(job, [(0, 60)], number)
        run = run_of(job, [(0, 60)], records, choice)
        used = {page[at + 1] for page in run.pages for at in column_offsets(page)}
        assert number in used, (number, used)
        return file_of(job, [run]), [run]
    return make


for number, (name, kind, precision) in TRANSFORMS.items():
    case(f"transform-{name}", VALID, "Transforms", f"transform {number} wherever it can be used")(
        with_transform(number, kind, precision))


# ---- records


def one_run(kind, change=lambda job, records: records, samples=60, **fields):
    """`change` may return other records, or change those that it is given."""
    def make():
        job = job_of(kind, **fields)
        records = records_of(job, [(0, samples)])
        records = change(job, records) or records
        run = run_of(job, [(0, samples)], records)
        return file_of(job, [run]), [run]
    return make


SPECIAL = [0x00000000, 0x80000000, 0x00000001, 0x807FFFFF, 0x7F7FFFFF, 0xFF7FFFFF, 0x7F800000, 0xFF800000, 0x7FC12345, 0xFF800001]


def special_floats(job, records):
    for i, record in enumerate(records):
        value = SPECIAL[i % len(SPECIAL)]
        if job.kind == writer.XYZ:
            record.xyz = (value, SPECIAL[i // 10 % 10], 0x3F800000)
        else:
            record.power = [value for _ in record.power]


def all_black(job, records):
    for record in records:
        record.xyz, record.power, record.lambdas, record.index = (0, 0, 0) if job.kind == writer.XYZ else (), [], [], 65535


def several_cameras(job, records):
    """k records of 1 / k, at places of their own: what a lens does to wavelengths."""
    r = random.Random(5)
    return [Record(n, r.getrandbits(32), r.getrandbits(32), share=0x3E800000, xyz=(0x3F800000, i << 23, 0x3F000000))
            for n in range(60) for i in range(4)]


def groups_of_lights(job, records):
    """One record for each group, at one position: the first has share 1, the others 0."""
    r = random.Random(6)
    out = []
    for n in range(60):
        u, v = r.getrandbits(32), r.getrandbits(32)
        for group in range(3):
            out.append(Record(n, u, v, share=0x3F800000 if group == 0 else 0, xyz=(0x3F800000 + group, 0x3F800000, 0),
                extra=(group,)))
    return out


def only_light(job, records):
    return [record for record in records if record.light][:40]


def one_place(job, records):
    """More records than a page may hold, at one position."""
    return [Record(n % 60, 2**31, 2**31, share=0, power=[0x3F800000], lambdas=[0x44000000]) if n >= 60 else
            Record(n, 2**31, 2**31, power=[0x3F800000], lambdas=[0x44000000]) for n in range(200)]


def borders(job, records):
    ends = [0, 1, 2**16 - 1, 2**16, 2**31 - 1, 2**31, 2**32 - 2**16 - 1, 2**32 - 1]
    places = [(u, v) for u in ends[:7] for v in ends]
    return [Record(n, u, v, xyz=(0x3F800000, 0x3F800000, 0x3F800000)) for n, (u, v) in enumerate(places)]


def even_density(knots):
    return [(i * 2**48 // (knots - 1), (360 << 20) + i * (470 << 20) // (knots - 1)) for i in range(knots)]


for kind in KINDS:
    case(f"{kind}-special-floats", VALID, "Records", "zeros of both signs, subnormal and largest numbers, infinities, NaNs")(
        one_run(kind, special_floats))
    case(f"{kind}-black", VALID, "Records", "black records only")(one_run(kind, all_black))
case("shares-of-a-quarter", VALID, "Records", "four camera records for a sample, with shares of 1/4")(
    one_run("xyz", several_cameras, halton=False))
case("shares-of-light-groups", VALID, "Records", "three camera records for a sample at one position, with shares of 1, 0, 0")(
    one_run("xyz", groups_of_lights, halton=False, extra=[("light_group", "u8")]))
case("light-records-only", VALID, "Records", "samples without camera records")(
    one_run("xyz", only_light, samples=600))
case("one-place", VALID, "Pages", "more than M records with one Z prefix: several pages share a node")(
    one_run("explicit", one_place, k=1024, halton=False))
case("corners-of-the-film", VALID, "Order", "positions at the ends of the film and of the squares' sides")(
    one_run("xyz", borders, halton=False))
for k in (1, 2, 1024):
    case(f"spectral-k-{k}", VALID, "Wavelengths", f"{k} wavelengths per sample, from a density")(
        whole(lambda k=k: two_runs("spectral", Varied(k), k=k)))
    case(f"explicit-k-{k}", VALID, "Page", f"up to {k} stored wavelengths for a record")(
        whole(lambda k=k: two_runs("explicit", Varied(k), k=min(k, 40)) if k < 1024 else two_runs("explicit", k=1024)))
for knots in (2, 4096):
    case(f"density-of-{knots}-knots", VALID, "Wavelengths", f"a density of {knots} knots")(
        whole(lambda knots=knots: two_runs("spectral", samples=6, knots=even_density(knots))))
case("many-pages", VALID, "Pages", "records that need several pages, at several levels")(
    one_run("explicit", samples=400, k=1024, light_paths=1))


def few_values(job, records):
    for record in records:
        record.extra = tuple((record.sample + i) // 100 for i in range(len(job.extra)))


case("wide-records", VALID, "Pages", "128 columns of 8 bytes, which leave 768 records to a page")(
    one_run("xyz", few_values, samples=1024, halton=False, extra=[("column %d" % i, "u64") for i in range(128)]))


# ---- header


def with_header(change, **fields):
    def make():
        job, runs = two_runs(**fields)
        file = File(job, runs)
        file.header = change(file.header)
        return b"".join(file.pieces()), runs
    return make


def with_copy_size(size):
    def change(header):
        half = bytearray(header[: len(header) // 2]) + bytes(size - len(header) // 2)
        struct.pack_into("<I", half, 12, size)
        return seal_header(half + half)
    return change


def later_minor(header):
    header = bytearray(header)
    struct.pack_into("<H", header, 10, 7)
    (body,) = struct.unpack_from("<Q", header, 24)
    struct.pack_into("<Q", header, 24, body + 14)
    known = bytes([23]) + bytes(8)  # the precision and no pixels, then what is not known yet
    header[64 + body : 64 + body + 14] = known + bytes([1, 2, 3, 4, 5])
    return seal_header(header)


for size in (8192, 2**20):
    case(f"header-of-{size}-bytes", VALID, "Header", f"copies of the header of {size} bytes each")(
        with_header(with_copy_size(size)))
case("header-of-a-later-minor-version", VALID, "Versions and extensions",
    "minor version 7, with fields behind those of this page")(with_header(later_minor))
JOBS = {"aspect-wide": {"aspect": (2**32 - 1, 2**32 - 2)}, "light-unit-683": {"light_unit": 683.0},
    "no-light-paths": {"light_paths": 0},
        "light-paths-2^32-1": {"light_paths": 2**32 - 1}, "run-bytes-least": {"run_bytes": 2**16},
        "run-bytes-most": {"run_bytes": 2**30},
        "run-samples-most": {"run_samples": 2**22}, "no-sampler": {"halton": False},
        "shifts-most": {"shifts": (2**32 - 1, 2**32 - 1)}, "pixels": {"pixels": (640, 360)}, "pixels-one": {"pixels": (1, 1)},
        "pixels-most": {"pixels": (2**20, 2**20), "precision": 9}}
for name, fields in JOBS.items():
    case(f"job-{name}", VALID, "Header", "a job with " + ", ".join(f"{key} {value}" for key, value in fields.items()))(
        whole(lambda fields=fields: two_runs("xyz", **fields)))

for name, text in {"object": b'{"program": "corpus", "host": "a"}', "empty-object": b"{}",
    "nested": b'{"a":' * 31 + b"{}" + b"}" * 31}.items():
    case(f"header-provenance-{name}", VALID, "Header", f"provenance: {name.replace('-', ' ')}")(
        lambda text=text: (lambda job, runs: (file_of(job, runs, provenance=text), runs))(*two_runs()))

REGISTERED = [("light_group", "u8"), ("camera", "u16"), ("time", "f32"), ("depth", "f32"), ("normal.x", "f32"), ("normal.y", "f32"),
              ("normal.z", "f32"), ("object", "u32")]
for name, extra in {"of-each-type": [("a", "u8"), ("b", "u16"), ("c", "u32"), ("d", "u64"), ("e", "f32"), ("f", "f64")],
                    "sixteen": [("column %d" % i, "u8") for i in range(16)],
                    "seventeen": [("column %d" % i, "u8") for i in range(17)],
                    "most": [("column %d" % i, ("u8", "u16", "u32", "u64", "f32", "f64")[i % 6]) for i in range(128)],
                    "registered": REGISTERED,
                    "lens-and-time": [("lens.x", "u8"), ("lens.y", "u8"), ("shutter", "u16")],
                    "names": [("x" * 64, "u8"), ("\N{GREEK SMALL LETTER LAMDA}", "u16"), ("studio:matte", "f32"),
                    ("sample", "u32")]}.items():
    for kind in ("xyz", "explicit"):
        case(f"extra-columns-{name}-{kind}", VALID, "Registry", "extra columns: " + ", ".join(name for name, _ in extra[:8]))(
            whole(lambda kind=kind, extra=extra: two_runs(kind, Varied(7), extra=extra)))


# ---- runs


def runs_of(*spans, kind="xyz", **fields):
    def make():
        job = job_of(kind, **fields)
        runs = [run_of(job, list(intervals), seed=seed) for seed, intervals in enumerate(spans)]
        return file_of(job, runs), runs
    return make


case("no-runs", VALID, "Footer", "a file without runs: the footer follows the header")(runs_of())
case("runs-out-of-order", VALID, "Run", "runs whose samples descend")(runs_of([(2048, 2088)], [(1024, 1064)], [(0, 40)]))
case("run-with-gaps", VALID, "Run", "a run whose coverage has gaps")(runs_of([(0, 10), (12, 30), (1000, 1024)]))
case("run-of-many-intervals", VALID, "Run", "a coverage of 300 intervals")(runs_of([(2 * i, 2 * i + 1) for i in range(300)]))
case("last-sample", VALID, "Records", "the largest sample number, 2^64 - 2")(
    runs_of([(2**64 - 1024, 2**64 - 984)], [(2**64 - 2, 2**64 - 1)]))
case("far-samples", VALID, "Transforms", "sample numbers around 2^32, 2^48 and 2^63")(
    runs_of(*[[(2**n - 20, 2**n + 20)] for n in (32, 48, 63)]))
case("superseded-run", VALID, "Selection", "a checkpoint that a later run covers")(
    lambda: (lambda job: (lambda runs: (file_of(job, runs), runs))(
        [run_of(job, spans, [r for r in records_of(job, [(0, 60)], 9) if any(a <= r.sample < b for a, b in spans)])
         for spans in ([(0, 20), (30, 40)], [(0, 60)])]))(job_of("xyz")))


@case("run-without-records", VALID, "Run", "a run of samples that made no records")
def run_without_records():
    job = job_of("spectral")
    runs = [run_of(job, [(0, 1024)], []), run_of(job, [(1024, 1030)])]
    return file_of(job, runs), runs


@case("repeated-run", VALID, "Selection", "the same run twice")
def repeated_run():
    job, runs = two_runs()
    return file_of(job, [*runs, runs[0]]), [*runs, runs[0]]


@case("run-of-a-later-minor-version", VALID, "Versions and extensions", "a run of minor version 9")
def later_run():
    job, runs = two_runs()
    struct.pack_into("<H", runs[1].header, 10, 9)
    runs[1].rehash_header()
    return file_of(job, runs), runs


# ---- footers, and files without


@case("footer-of-the-first-form", VALID, "Footer", "the footer of version 0.1")
def first_form():
    job, runs = two_runs()
    data, at = file_of(job, runs, footer=False), offsets(job, runs)
    return data + first_form_of(at[-1], list(zip(at, [run.header for run in runs])), b'{"parts": []}'), runs


PART = b'{"provenance": {"host": "a"}, "samples": [[0, 40]]}'
MERGED = {"merged": b'{"parts": [' + PART + b", " + PART + b"]}",
          "incomplete": b'{"incomplete": true, "parts": []}', "nested": b'{"a":' * 63 + b"{}" + b"}" * 63}
for name, text in MERGED.items():
    def merged(text=text):
        job, runs = two_runs()
        front = file_of(job, runs, footer=False)
        return front + b"".join(footer_of(len(front), [run.header for run in runs], text)), runs
    case(f"footer-provenance-{name}", VALID, "Footer", f"provenance of a footer: {name}")(merged)


@case("attempt.latent.part.0", UNFINISHED, "Reading", "an attempt without a footer")
def attempt():
    job, runs = two_runs()
    return file_of(job, runs, footer=False), runs


@case("attempt-of-a-header.latent.part.0", UNFINISHED, "Reading", "an attempt in which no run is committed yet")
def attempt_of_a_header():
    job, _ = two_runs()
    return file_of(job, [], footer=False), []


def torn(lost):
    def make():
        job, runs = two_runs()
        data = file_of(job, runs, footer=False)
        return data[: len(data) - lost(len(runs[1].data()))], runs[:1]
    return make


for name, lost in {"by-a-byte": lambda size: 1, "in-its-pages": lambda size: size - 300, "in-its-header": lambda size: size - 100,
                   "after-a-byte": lambda size: size - 1}.items():
    case(f"attempt-torn-{name}.latent.part.0", UNFINISHED, "Reading",
        f"an attempt whose last run is cut off {name.replace('-', ' ')}")(torn(lost))


@case("attempt-with-a-torn-footer.latent.part.0", UNFINISHED, "Reading", "an attempt whose footer is cut off")
def torn_footer():
    job, runs = two_runs()
    return file_of(job, runs)[:-40], runs


@case("attempt-complete.latent.part.0", VALID, "Reading", "an attempt that is complete but has not been published")
def complete_attempt():
    job, runs = two_runs()
    return file_of(job, runs), runs
