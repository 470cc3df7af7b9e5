#!/usr/bin/env python3
"""docs/latent.ksy decodes the files of the corpus that are sound, and finds in them what the reader in Python finds.

    check_kaitai.py [FOLDER]    FOLDER: a corpus that make_corpus.py made; otherwise it is made for a moment

Needs node, and the packages of tests/kaitai/package.json (scripts/npm-ci tests/kaitai)."""
import json
import pathlib
import struct
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "corpus"))
from corpus import CARELESS, VALID
from make_corpus import make
from reader.header import WIDTHS, read_header
from reader.rules import Rules
from reader.run import run_size

KSY = HERE.parent.parent / "docs" / "latent.ksy"


def same(name, what, actual, expected):
    if actual != expected:
        raise SystemExit(f"{name}: {what}: {actual!r} instead of {expected!r}"[:600])


def floats(numbers):
    """JavaScript's numbers have 53 bits."""
    return [list(map(float, pair)) for pair in numbers]


def check_job(name, found, job):
    same(name, "job id", found["job"], "%016x%016x" % tuple(reversed(job.id)))
    for field in ("kind", "sampler", "k", "light_paths", "precision"):
        same(name, field, found[field], getattr(job, field))
    same(name, "knots", floats(found["knots"]), floats(job.knots))
    extra = [(bytes.fromhex(text).decode("latin-1"), WIDTHS[kind]) for text, kind in found["extra"]]
    same(name, "extra columns", extra, job.extra)
    same(name, "copies of the header are equal", found["copies_are_equal"], True)


def check_run(name, found, data, at, expected):
    """Against the bytes of the file and expected.json. Returns where the run ends."""
    header = data[at : at + 256]
    (intervals,) = struct.unpack_from("<I", header, 12)
    (pages, pages_size) = struct.unpack_from("<Q", header, 64) + struct.unpack_from("<Q", header, 104)
    index = at + 256 + pages_size
    same(name, "intervals", floats(found["intervals"]), floats(expected["samples"]))
    for field in ("camera_records", "light_records", "content_hash"):
        same(name, field, found[field], expected[field])
    entries = [struct.unpack_from("<BBHIIIIIQIIQ", data, index + 16 * intervals + 48 * i) for i in range(pages)]
    same(name, "index", found["index"], [[e[0], e[1], e[3], e[4], e[5], e[6], e[7], e[9]] for e in entries])
    end = at + 256
    for number, (entry, columns) in enumerate(zip(entries, found["columns"])):
        planes = [plane for column in columns for plane in column[4]]
        stored = b"".join(bytes.fromhex(plane[2]) for plane in planes)
        same(name, f"size of page {number}", 4 + 24 * len(columns) + 4 * len(planes) + len(stored), entry[9])
        end += entry[9]
        same(name, f"planes of page {number}", stored, data[end - len(stored) : end])
        same(name, f"sizes of planes of page {number}", [plane[1] for plane in planes], [len(plane[2]) // 2 for plane in planes])
    same(name, "end of the pages", end, index)
    end = index + 16 * intervals + 48 * pages + found["padding"]
    same(name, "end of the run", end, at + run_size(header))
    return end


def check_file(path, found, expected):
    data = path.read_bytes()
    job, at, _ = read_header(data)
    check_job(path.name, found, job)
    same(path.name, "number of runs", len(found["runs"]), len(expected["runs"]))
    for run, of_run in zip(found["runs"], expected["runs"]):
        at = check_run(path.name, run, data, at, of_run)
    listed = [{field: run[field] for field in found["footer"]["entries"][i]} for i, run in enumerate(found["runs"])]
    same(path.name, "entries of the footer", found["footer"]["entries"], listed)
    same(path.name, "offset of the footer", found["footer"]["offset"], at)


def main(folder):
    files = json.loads((folder / "expected.json").read_text())["files"]
    sound = [name for name, entry in files.items() if entry["outcome"] in (VALID, CARELESS)]
    out = subprocess.run(["node", HERE / "decode.cjs", KSY, *sound], cwd=folder, check=True, capture_output=True, text=True).stdout
    found = json.loads(out)
    with Rules.for_readers():
        for name in sound:
            check_file(folder / name, found[name], files[name])
    print(f"{len(sound)} files decoded by latent.ksy")
    return 0 if len(sound) >= 100 else 1


if __name__ == "__main__":
    with tempfile.TemporaryDirectory(prefix="latent-kaitai-") as scratch:
        folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else scratch + "/corpus")
        if len(sys.argv) < 2:
            make(folder)
        sys.exit(main(folder))
