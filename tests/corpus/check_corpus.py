#!/usr/bin/env python3
"""Makes the corpus, and checks that latent-inspect and the reader in Python make of every file what expected.json says.

    check_corpus.py LATENT_INSPECT [FOLDER]     FOLDER: a corpus that make_corpus.py made; otherwise it is made for a moment

The reader in Python (tests/sampledb/read_latent.py): what it accepts, strictly and without the rules for writers; the runs that it
saves. latent-inspect: verify at every level; the runs that recover saves; the records of cat, which are those of the reader in
Python, bit for bit. Prints what differs; exit status 1 if anything does.
"""
import ast
import json
import pathlib
import struct
import subprocess
import sys
import tempfile

from corpus import CARELESS, DAMAGED, LEVELS, REFUSED, UNFINISHED, VALID
from make_corpus import make
from read_latent import read_file
from reader.derived import wavelength
from reader.header import read_header
from reader.rules import UNREADABLE, Rules
from reader.run import read_run
from reader.salvage import salvage
from reader.selection import select

DIFFERENCES = []


def same(name, what, actual, expected):
    if actual != expected:
        DIFFERENCES.append(f"{name}: {what}: {actual!r} instead of {expected!r}"[:400])


def described(intact):
    return [{"samples": [list(pair) for pair in ranges], "camera_records": camera, "light_records": light, "content_hash": content}
            for ranges, camera, light, content in intact]


# ---- the reader in Python


def saved(path):
    with Rules.for_readers():
        return salvage(path)


def refuses(path):
    """Why it does, or None."""
    try:
        read_file(path)
    except UNREADABLE as error:
        return str(error) or repr(error)
    return None


def check_python(path, entry):
    outcome = entry["outcome"]
    if outcome != UNFINISHED:
        same(path.name, "read strictly, Python refuses it", refuses(path) is not None, outcome != VALID)
    try:
        intact, damage = saved(path)
    except UNREADABLE as error:
        same(path.name, f"Python saves nothing ({error})", True, outcome == REFUSED)
        return
    same(path.name, "Python reads it", True, outcome != REFUSED)
    same(path.name, f"Python finds damage ({damage})", damage != [], outcome in (DAMAGED, REFUSED))
    same(path.name, "runs that Python saves", described(intact), entry["runs"])


# ---- latent-inspect


def verified(inspect, folder, names, *options):
    """Name -> its report."""
    out = subprocess.run([inspect, "verify", "--json", *options, *names], cwd=folder, capture_output=True, text=True)
    return {report["file"]: report for report in json.loads(out.stdout)}


def check_verify(inspect, folder, files):
    for level, options in {"quick": ["--quick"], "stored": [], "full": ["--deep"], "strict": ["--strict"]}.items():
        reports = verified(inspect, folder, files, *options)
        for name, entry in files.items():
            report, outcome = reports[name], entry["outcome"]
            sound = report.get("sound", False)
            if entry.get("found_at") == "stored" and level == "quick":
                continue  # the page that is looked at may be the damaged one
            reached = level == "strict" or LEVELS.index(level) >= LEVELS.index(entry.get("found_at", "full"))
            expected = {VALID: True, UNFINISHED: True, CARELESS: level != "strict", DAMAGED: not reached, REFUSED: False}[outcome]
            if level == "strict":
                sound = sound and report["violation_count"] == 0
            found = [report.get(key) for key in ("damage", "violations", "error")]
            same(name, f"verify, level {level}, finds it sound ({found})", sound, expected)


def check_recover(inspect, folder, name, entry, out):
    done = subprocess.run([inspect, "recover", folder / name, "-o", out], capture_output=True, text=True)
    statuses = {VALID: (0,), CARELESS: (0,), UNFINISHED: (0,), DAMAGED: (3,), REFUSED: (1,)}[entry["outcome"]]
    if entry["outcome"] == DAMAGED and not entry["runs"]:
        statuses = (1,)
    elif entry["outcome"] == DAMAGED and entry["found_at"] == "headers":
        statuses = (0, 3)  # it may be that no run is lost
    same(name, f"recover ends with one of {statuses}: {done.stderr}", done.returncode in statuses, True)
    same(name, "recover makes a file", out.exists(), done.returncode != 1)
    if out.exists():
        intact, damage = saved(out)
        same(name, "runs that recover saves", (described(intact), damage), (entry["runs"], []))
        out.unlink()


# ---- records, bit for bit


def runs_with_records(path):
    """(coverage, hashes, pages) of every run, by the reader in Python."""
    data = path.read_bytes()
    job, at, _ = read_header(data)
    runs = []
    while data[at : at + 8] == b"\x8dLTDBR\r\n":
        header = data[at : at + 256]
        size, _, _, ranges, pages = read_run(job, data, at)
        hashes = struct.unpack_from("<QQ", header, 120) + struct.unpack_from("<Q", header, 104) + struct.unpack_from("<Q", header,
            112)
        runs.append((tuple(ranges), hashes, [(kind, columns) for kind, columns, _, _ in pages]))
        at += size
    return job, runs


def rows_of(job, pages):
    """Each record as the bytes of its row in the array of cat."""
    word = lambda values, layout="I": struct.pack("<%d%s" % (len(values), layout), *values)
    for kind, columns in pages:
        first = 0
        for i, sample in enumerate(columns[1]):
            row = struct.pack("<QBddI", sample, kind, columns[2][i] / 2**32, columns[3][i] / 2**32, 0 if kind else columns[4][i])
            if job.kind == 2:
                row += word([columns[5][i], columns[6][i], columns[7][i]])
            else:
                n = columns[8][i]
                power = columns[11][first : first + n]
                if not job.knots:
                    wavelengths = columns[12][first : first + n]
                else:
                    indices = [columns[10][i]] if n == 1 < job.k else range(n)
                    wavelengths = [wavelength(job.knots, job.k, columns[9][i], j) for j in indices]
                first += n
                row += word(wavelengths + [0] * (job.k - n)) + word(power + [0] * (job.k - n))
            for number, (_, width) in enumerate(job.extra):
                row += columns[64 + number][i].to_bytes(width, "little")
            yield row


def check_cat(inspect, folder, name, out):
    with open(out, "wb") as file:
        done = subprocess.run([inspect, "cat", "--format", "npy", folder / name], stdout=file, stderr=subprocess.PIPE, text=True)
    array = out.read_bytes()
    if len(array) < 12:
        return same(name, "cat writes", array, "an array")
    (length,) = struct.unpack_from("<I", array, 8)
    header = ast.literal_eval(array[12 : 12 + length].decode())
    with Rules.for_readers():
        job, runs = runs_with_records(folder / name)
    disagree = len({ranges for ranges, _, _ in runs}) < len({(ranges, hashes[:2]) for ranges, hashes, _ in runs})
    same(name, f"cat ends with ({done.stderr})", done.returncode, 3 if disagree else 0)
    chosen = select([(ranges, hashes) for ranges, hashes, _ in runs])
    pages = [page for i in sorted(chosen, key=lambda i: runs[i][0][0]) for page in runs[i][2]]
    rows = list(rows_of(job, pages))
    same(name, "cat, shape", header["shape"], (len(rows),))
    same(name, "cat and Python have the same records, in the same order", array[12 + length :] == b"".join(rows), True)
    out.unlink()


def main(inspect, folder, scratch):
    files = json.loads((folder / "expected.json").read_text())["files"]
    same("corpus", "files", sorted(path.name for path in folder.iterdir()), sorted([*files, "expected.json"]))
    check_verify(inspect, folder, files)
    for name, entry in files.items():
        check_python(folder / name, entry)
        check_recover(inspect, folder, name, entry, scratch / "recovered.latent")
        if entry["outcome"] in (VALID, CARELESS):
            check_cat(inspect, folder, name, scratch / "cat.npy")
    print("\n".join([*DIFFERENCES, f"{len(files)} files, {len(DIFFERENCES)} differences"]))
    return 1 if DIFFERENCES or len(files) < 120 else 0


if __name__ == "__main__":
    with tempfile.TemporaryDirectory(prefix="latent-corpus-") as scratch:
        folder = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else pathlib.Path(scratch) / "corpus"
        if len(sys.argv) < 3:
            make(folder)
        sys.exit(main(pathlib.Path(sys.argv[1]).resolve(), folder, pathlib.Path(scratch)))
