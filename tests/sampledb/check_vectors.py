#!/usr/bin/env python3
"""The test vectors of docs/format.md hold in the reader in Python.

    check_vectors.py docs/format.md

Ends with 1 at the first that does not."""
import struct
import sys

from native import hash64, hash128
from reader.derived import Pixels, halton, rounded, rounding_random, rounding_seed, wavelength
from reader.planes import (decode_plane, from_cross, from_delta2, from_lattice, from_packed, from_packed_delta2, from_planes, from_sparse,
                           stored_rows)
from reader.rules import check
from reader.run import page_end, smallest_square, z_prefix
from reader.selection import select


def vectors(page):
    """(name, {key: tokens}) or (name, [row of tokens]) of every vector: fenced blocks ```vector NAME, cases apart by blank lines."""
    with open(page) as file:
        blocks = file.read().split("\n```vector ")[1:]
    for block in blocks:
        name, text = block.split("\n```", 1)[0].split("\n", 1)
        for case in text.split("\n\n"):
            lines = case.replace("\n ", " ").split("\n")
            if " =" in lines[0]:
                yield name, {key.strip(): value.split() for key, value in (line.split(" =") for line in lines)}
            else:
                yield name, [line.split() for line in lines[1:]]  # behind the names of the rows' fields


def hex_numbers(tokens):
    return [int(token, 16) for token in tokens]


def check_vectors(page):
    plane = lambda case, key: bytes(hex_numbers(case[key]))
    planes = lambda case, first=0: [plane(case, "plane %d" % p) for p in range(first, 8) if "plane %d" % p in case]
    ints = lambda tokens: [int(token) for token in tokens]
    pattern = lambda size: bytes(i % 251 for i in range(size))
    hash128_of = lambda text: (int(text[16:], 16), int(text[:16], 16))
    hash128_hex = lambda data: "%016x%016x" % hash128(data)[::-1]
    checked = {}

    def expect(name, actual, expected):
        check(actual == expected, "vector %s: %s instead of %s" % (name, actual, expected))
        checked[name] = checked.get(name, 0) + 1

    for name, case in vectors(page):
        if name == "hash":
            for size, short, long in case:
                expect(name, ["%016x" % hash64(pattern(int(size))), hash128_hex(pattern(int(size)))], [short, long])
        elif name == "z-prefix":
            for u, v, z in case:
                expect(name, "%08x" % z_prefix(int(u, 16), int(v, 16)), z)
        elif name == "page-cut":
            prefixes, ends = hex_numbers(case["prefixes"]), []
            while (ends or [0])[-1] < len(prefixes):
                ends.append(page_end(prefixes, (ends or [0])[-1], int(case["M"][0])))
            expect(name, ends, ints(case["ends"]))
        elif name == "square":
            expect(name, list(smallest_square(hex_numbers(case["u"]), hex_numbers(case["v"]))), ints(case["level x y"]))
        elif name == "planes":
            expect(name, from_planes(planes(case)), hex_numbers(case["values"]))
        elif name == "packed":
            values = hex_numbers(case["values"])
            expect(name, from_packed(plane(case, "plane 0"), int(case["bits"][0]), int(case["base"][0], 16), len(values)), values)
        elif name == "lattice":
            values, (bits,), (s,) = hex_numbers(case["values"]), ints(case["bits"]), ints(case["s"])
            expect(name, from_lattice(plane(case, "plane 0"), bits, s, int(case["base"][0], 16), len(values)), values)
        elif name in ("cross", "stepped-cross"):
            step = int(case.get("bits", ["0"])[0])
            expect(name, from_cross(planes(case), hex_numbers(case["y"]), step), hex_numbers(case["x"]))
        elif name in ("delta2", "stepped-delta2"):
            step = int(case.get("bits", ["0"])[0])
            expect(name, from_delta2(planes(case), ints(case["pairs"]), step), hex_numbers(case["values"]))
        elif name == "packed-delta2":
            stored, (k,), (step,) = planes(case), ints(case["k"]), ints(case["bits"])
            sized = lambda i, size: stored[i] if len(stored[i]) == size else check(False, "size of plane %d" % i)
            expect(name, from_packed_delta2(sized, ints(case["pairs"]), k, step), hex_numbers(case["values"]))
        elif name == "sparse":
            ys, xs = hex_numbers(case["y"]), hex_numbers(case["x"])
            rows = stored_rows(plane(case, "bitmap"), len(ys))
            of = lambda column: [plane(case, "%s plane %d" % (column, p)) for p in range(4)]
            expect(name, from_sparse(rows, from_planes(of("y")), len(ys)), ys)
            expect(name, from_sparse(rows, from_cross(of("x"), [ys[i] for i in rows]), len(ys)), xs)
        elif name == "codec":
            expected = plane(case, "plane") if "plane" in case else pattern(int(case["pattern"][0]))
            expect(name, decode_plane(int(case["codec"][0]), plane(case, "stored"), len(expected)), expected)
        elif name == "halton23":
            for n, r2, r3 in case:
                expect(name, "%08x %08x" % halton(int(n), (0, 0)), r2 + " " + r3)
        elif name == "pixel-steps":
            for w, h, step, back in case:
                pixels = Pixels((int(w), int(h)), (0, 0))
                expect(name, [pixels.step, pixels.back], [int(step), int(back)])
        elif name == "pixels":
            for w, h, n, u, v in case:
                pixels = Pixels((int(w), int(h)), (0x12345678, 0x9ABCDEF0))
                expect(name, "%08x %08x" % pixels.point(*pixels.place(int(n))), u + " " + v)
        elif name == "pixels-transform":
            values, (bits,) = hex_numbers(case["values"]), ints(case["bits"])
            pixels = Pixels(ints(case["W H"]), hex_numbers(case["shifts"]))
            numbers = from_packed(plane(case, "plane 0"), bits, 0, len(values))
            places = pixels.unpacked(numbers, int(case["base"][0], 16), ints(case["level x y"]))
            expect(name, [pixels.sample(*place) for place in places], values)
        elif name in ("halton23-points", "pixels-points"):
            shifts = hex_numbers(case["shifts"])
            pixels = Pixels(ints(case["W H"]), shifts) if "W H" in case else None
            point = (lambda n: pixels.point(*pixels.place(n))) if pixels else (lambda n: halton(n, shifts))
            samples = [n for first, step, count in zip(ints(case["first"]), hex_numbers(case["step"]), ints(case["count"]))
                       for n in ((first + i * step) % 2**64 for i in range(count))]
            points = b"".join(struct.pack("<II", *point(n)) for n in samples)
            expect(name, hash128_hex(points), case["hash128"][0])
        elif name == "wavelengths":
            knots = list(zip(hex_numbers(case["cumulative"]), hex_numbers(case["wavelength"])))
            (k,) = ints(case["k"])
            batch = [wavelength(knots, k, int(case["xi"][0], 16), i) for i in range(k)]
            expect(name, batch, hex_numbers(case["lambda"]))
        elif name == "wavelength-batches":
            knots, (k,), (count,) = list(zip(hex_numbers(case["cumulative"]), hex_numbers(case["wavelength"]))), ints(case["k"]), ints(case["count"])
            offsets = [i * int(case["step"][0], 16) % 2**32 for i in range(count)]
            batches = b"".join(struct.pack("<I", wavelength(knots, k, xi, i)) for xi in offsets for i in range(k))
            expect(name, hash128_hex(batches), case["hash128"][0])
        elif name == "rounding":
            seed = rounding_seed(hash128_of(case["job id"][0]), int(case["n"][0]), int(case["u"][0], 16), int(case["v"][0], 16))
            expect(name, ["%016x" % seed], case["h"])
            randoms = [rounding_random(seed, i) for i in range(len(case["value"]))]
            expect(name, randoms, hex_numbers(case["r"]))
            for precision in ints([key[2:] for key in case if key.startswith("p ")]):
                values = [rounded(value, precision, random) for value, random in zip(hex_numbers(case["value"]), randoms)]
                expect(name, values, hex_numbers(case["p %d" % precision]))
        elif name == "selection":
            runs = []
            for token in case["runs"]:
                (coverage, rank) = token.split("#")
                runs.append((tuple(tuple(ints(i.split(".."))) for i in coverage.split(",")), int(rank)))
            expect(name, select(runs), ints(case["chosen"]))
        else:
            raise ValueError("vector %s is not known" % name)
    print(", ".join("%s %d" % item for item in checked.items()))


if __name__ == "__main__":
    try:
        check_vectors(sys.argv[1])
    except (ValueError, struct.error, KeyError, IndexError) as error:
        sys.exit("%s: %s" % (" ".join(sys.argv[1:]), error))
