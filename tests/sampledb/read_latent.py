#!/usr/bin/env python3
"""A second reader of sample files, written from docs/format.md alone and slow on purpose: whatever it cannot read, the page does
not say. It reads every file given, decodes every column of every page and checks every rule of the page, those for writers, too.

    read_latent.py [--records] FILE...      "FILE: RUNS runs, CAMERA camera records, LIGHT light records, COVERAGE";
                                            with --records the records instead: a JSON object a line, values as their bits
    read_latent.py --salvage FILE...        "FILE: RUNS intact runs, COVERAGE", then what is damaged; rules for writers do not count

Ends with 1 at the first contradiction."""
import json
import struct
import sys

from reader.derived import wavelength
from reader.footer import read_footer
from reader.header import read_header
from reader.rules import Rules, check, fields, rule
from reader.run import read_run
from reader.salvage import salvage


def read_file(path):
    """Job, camera and light records, coverage and (class, columns) of every page of every run."""
    with open(path, "rb") as file:
        data = file.read()
    job, at, header_is_sound = read_header(data)
    check(header_is_sound, "the header's copies differ")
    runs, camera, light, coverage, pages = [], 0, 0, [], []
    while data[at : at + 8] == b"\x8dLTDBR\r\n":
        size, c, l, ranges, decoded = read_run(job, data, at)
        runs.append((at, data[at : at + 256]))
        at, camera, light, coverage = at + size, camera + c, light + l, coverage + ranges
        pages += [(kind, columns) for kind, columns, _, _ in decoded]
    if at < len(data) or ".latent.part." not in str(path):
        read_footer(data, at, runs)
    contents = {}
    for run_at, header in runs:
        (intervals, pages_size) = fields("I", header, 12) + fields("Q", header, 104)
        coverage_of_run = data[run_at + 256 + pages_size : run_at + 256 + pages_size + 16 * intervals]
        rule(contents.setdefault(coverage_of_run, header[120:136]) == header[120:136], "runs of equal coverage and other records")
    return job, len(runs), camera, light, coverage, pages


def print_records(job, pages):
    for kind, columns in pages:
        first = 0
        for row, sample in enumerate(columns[1]):
            record = {"sample": sample, "class": "light" if kind else "camera", "u": columns[2][row], "v": columns[3][row],
                      "share": 0 if kind else columns[4][row]}
            if job.kind == 2:
                record |= {"x": columns[5][row], "y": columns[6][row], "z": columns[7][row]}
            else:
                n = columns[8][row]
                if not job.knots:
                    record["lambda_nm"] = columns[12][first : first + n]
                else:
                    indices = [columns[10][row]] if n == 1 and job.k > 1 else range(n)
                    record["lambda_nm"] = [wavelength(job.knots, job.k, columns[9][row], i) for i in indices]
                record["power"] = columns[11][first : first + n]
                first += n
            for i, (name, _) in enumerate(job.extra):
                record[name] = columns[64 + i][row]
            print(json.dumps(record))


def main(arguments):
    if arguments[:1] == ["--salvage"]:
        for path in arguments[1:]:
            with Rules.for_readers():
                intact, damage = salvage(path)
            text = " ".join("%d..%d" % r for ranges, *_ in intact for r in ranges)
            print("\n  ".join(["%s: %d intact runs, %s" % (path, len(intact), text), *damage]))
        return
    with_records = arguments[:1] == ["--records"]
    for path in arguments[with_records:]:
        job, runs, camera, light, coverage, pages = read_file(path)
        if with_records:
            print_records(job, pages)
            continue
        text = " ".join("%d..%d" % r for r in coverage)
        print("%s: %d runs, %d camera records, %d light records, %s" % (path, runs, camera, light, text))


if __name__ == "__main__":
    try:
        main(sys.argv[1:])
    except (ValueError, struct.error, KeyError, IndexError) as error:
        sys.exit("%s: %s" % (" ".join(sys.argv[1:]), error))
