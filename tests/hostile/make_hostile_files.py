#!/usr/bin/env python3
"""Makes files that try to make a reader take much memory or time, or fail: every length, count and code of docs/format.md at its
ceiling, beyond it, at the largest value that its bytes hold. Every hash is right, so that nothing but the field itself is wrong.

    make_hostile_files.py --list [--small]       their names; --small: a share of them, few large
    make_hostile_files.py [--job FILE] FOLDER NAME...   makes FOLDER/NAME.latent
                                                 attempts: FOLDER/NAME.latent.part.0, of the job of --job FILE
"""
import argparse
import pathlib

import field_cases  # noqa: F401 (these four fill CASES and ATTEMPTS)
import footer_cases  # noqa: F401
import many_cases  # noqa: F401
from attempt_cases import ATTEMPTS, make_attempt
from cases import CASES


def small_share():
    """Some of each group, and none that is large."""
    names = [name for name, (_, large) in CASES.items() if not large]
    return names[:: max(1, len(names) // 60)]


def write(path, pieces):
    with open(path, "wb") as file:
        for piece in pieces:
            if isinstance(piece, int):
                file.seek(piece, 1)  # a hole
            else:
                file.write(piece)
        file.truncate()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--small", action="store_true")
    parser.add_argument("--job", type=pathlib.Path)
    parser.add_argument("folder", nargs="?")
    parser.add_argument("names", nargs="*")
    options = parser.parse_args()
    if options.list:
        print("\n".join([*(small_share() if options.small else CASES), *ATTEMPTS]))
        return
    for name in options.names:
        if name in ATTEMPTS:
            write(pathlib.Path(options.folder) / f"{name}.latent.part.0", make_attempt(name, options.job.read_bytes()))
            continue
        write(pathlib.Path(options.folder) / f"{name}.latent", CASES[name][0]())


if __name__ == "__main__":
    main()
