#!/usr/bin/env python3
"""Makes the conformance corpus: small .latent files, and expected.json, which says what a reader must make of each of them.

    make_corpus.py FOLDER       the folder is created; it must not exist

Each entry of expected.json has an outcome:

    valid        everything can be read, and no rule of docs/format.md is broken
    careless     everything can be read; a rule that only writers must keep is broken
    unfinished   an attempt without a footer: its whole runs can be read, and what follows them is no damage
    damaged      a reader reports damage at the level `found_at`, or at a higher one, and reads the runs that are listed
    refused      the file is not read at all

`runs` lists the runs that can be read in full: their samples (first, end), numbers of records and content hashes.
"""
import json
import pathlib
import sys

import damaged_cases  # noqa: F401 (these three fill CASES)
import rule_cases  # noqa: F401
import valid_cases  # noqa: F401
from corpus import CASES, made


def make(folder):
    folder.mkdir(parents=True)
    expected = {}
    for case in CASES.values():
        data, expected[case.name] = made(case)
        (folder / case.name).write_bytes(data)
    (folder / "expected.json").write_text(json.dumps({"format": [1, 1], "files": expected}, indent=1) + "\n")
    return expected


if __name__ == "__main__":
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    files = make(pathlib.Path(sys.argv[1]))
    outcomes = [file["outcome"] for file in files.values()]
    print("%d files: %s" % (len(files), ", ".join("%d %s" % (outcomes.count(o), o) for o in dict.fromkeys(outcomes))))
