#!/usr/bin/env python3
"""Prints every byte of a small sample file beside what docs/format.md says it is. The page's own example was made by

    write_latent.py smallest FILE && annotate_latent.py FILE"""
import struct
import sys

FORMATS = {"u8": "B", "u16": "H", "u32": "I", "u64": "Q", "f32": "f", "f64": "d"}
COLUMNS = ["", "sample", "u", "v", "share", "x", "y", "z", "pairs", "xi", "index", "power", "lambda"]
TRANSFORMS = ["planes", "packed", "lattice", "sampler", "cross", "delta2", "sparse", "sparse cross",
              "stepped cross", "stepped delta2", "stepped sparse cross", "packed delta2", "pixels"]
CODECS = ["raw", "zstd", "constant", "dictionary"]


class Walk:
    def __init__(self, data):
        self.data, self.at = data, 0

    def show(self, size, meaning):
        """The next bytes, eight to a line."""
        for i in range(0, size, 8):
            part = self.data[self.at + i : self.at + min(i + 8, size)]
            print(("%06x  %-23s  %s" % (self.at + i, part.hex(" "), meaning if i == 0 else "")).rstrip())
        self.at += size

    def field(self, kind, name, text=lambda value: "%d" % value):
        (value,) = struct.unpack_from("<" + FORMATS[kind], self.data, self.at)
        self.show(struct.calcsize(FORMATS[kind]), "%s %s" % (name, text(value)))
        return value

    def hash(self, name):
        self.show(8, name)

    def zeros_up_to(self, end, name="zero"):
        assert not any(self.data[self.at : end])
        if end > self.at:
            print("%06x  ... %s up to %06x" % (self.at, name, end))
        self.at = end


def hexadecimal(value):
    return "%x" % value


def header(w):
    begin = w.at
    w.show(8, "header: .LTDBF CR LF")
    w.field("u16", "major"), w.field("u16", "minor")
    copy_size = w.field("u32", "copy_size")
    w.field("u64", "features")
    w.field("u64", "body_size")
    w.hash("hash64 of bytes 64 .. copy_size-1")
    w.show(16, "reserved")
    w.hash("hash64 of bytes 0 .. 55")
    w.field("u64", "job id, low half", hexadecimal), w.field("u64", "job id, high half", hexadecimal)
    w.field("u32", "film aspect, width"), w.field("u32", "film aspect, height")
    w.field("u8", "record kind", lambda kind: {1: "1: spectral", 2: "2: XYZ"}[kind])
    w.field("u8", "position sampler")
    w.field("u16", "k")
    w.field("u32", "light paths per sample")
    w.field("f64", "light unit", lambda value: "%g cd/m^2" % value)
    w.field("u64", "R"), w.field("u32", "S")
    w.field("u32", "shift of u"), w.field("u32", "shift of v")
    knots, extra = w.field("u32", "knots"), w.field("u32", "extra columns")
    provenance = w.field("u32", "bytes of provenance")
    for i in range(knots):
        w.field("u64", "knot %d: cumulative" % i), w.field("u32", "wavelength")
    for i in range(extra):
        w.field("u8", "extra column %d: type" % i)
        w.show(w.field("u8", "length of its name"), "name")
    w.show(provenance, "provenance")
    w.zeros_up_to(begin + copy_size)
    assert w.data[begin : w.at] == w.data[w.at : w.at + copy_size]
    print("%06x  ... the same again up to %06x" % (w.at, w.at + copy_size))
    w.at += copy_size


def page(w, number):
    columns = w.field("u32", "page %d: columns" % number)
    planes = []
    for _ in range(columns):
        column = w.field("u8", "column", lambda c: "%d: %s" % (c, COLUMNS[c] if c < 64 else "extra %d" % (c - 64)))
        w.field("u8", "transform", lambda t: "%d: %s" % (t, TRANSFORMS[t]))
        w.field("u8", "bits")
        count = w.field("u8", "planes")
        w.field("u32", "s")
        w.field("u64", "base", hexadecimal)
        w.hash("hash64 of the decoded column")
        for p in range(count):
            word = w.field("u32", "plane %d:" % p, lambda word: "%d bytes, codec %d: %s" % (word % 2**30, word >> 30, CODECS[word >> 30]))
            planes.append((word % 2**30, "column %d, plane %d" % (column, p)))
    for size, name in planes:
        w.show(size, name)


def run(w):
    begin = w.at
    w.show(8, "run: .LTDBR CR LF")
    w.field("u16", "major"), w.field("u16", "minor")
    intervals = w.field("u32", "intervals")
    w.field("u64", "features")
    w.field("u64", "job id, low half", hexadecimal), w.field("u64", "job id, high half", hexadecimal)
    w.field("u64", "first sample"), w.field("u64", "end of the coverage")
    w.field("u64", "samples covered")
    pages = w.field("u64", "pages")
    w.field("u64", "camera records"), w.field("u64", "light records")
    w.field("u64", "pairs"), w.field("u64", "decoded bytes")
    pages_size = w.field("u64", "pages_size")
    w.hash("index_hash: hash64 of index and padding")
    w.hash("content hash, low half"), w.hash("content hash, high half")
    w.zeros_up_to(begin + 248)
    w.hash("hash64 of bytes 0 .. 247")
    for number in range(pages):
        page(w, number)
    assert w.at == begin + 256 + pages_size
    for _ in range(intervals):
        w.field("u64", "index: interval, first"), w.field("u64", "end")
    for number in range(pages):
        w.field("u8", "entry of page %d: level of its square" % number)
        w.field("u8", "class", lambda c: "%d: %s" % (c, ["camera", "light"][c]))
        w.show(2, "zero")
        w.field("u32", "x"), w.field("u32", "y")
        w.field("u32", "records"), w.field("u32", "pairs"), w.field("u32", "decoded bytes")
        w.hash("content hash of the page")
        w.field("u32", "stored bytes")
        w.show(4, "zero")
        w.hash("hash64 of the stored bytes")
    w.zeros_up_to((w.at + 4095) // 4096 * 4096)


def footer(w):
    begin = w.at
    w.show(8, "footer: .LTDBI CR LF")
    w.field("u64", "offset of the footer", hexadecimal)
    runs, provenance = w.field("u64", "runs"), w.field("u64", "bytes of provenance")
    w.hash("hash64 of the entries of the runs"), w.hash("hash64 of the provenance")
    w.show(8, "zero")
    w.hash("hash64 of bytes 0 .. 55")
    for i in range(runs):
        print("%06x  ... entry of run %d: bytes 8 .. 135 of its header, up to %06x" % (w.at, i, w.at + 128))
        w.at += 128
    w.show(provenance, "provenance")
    assert w.data[begin : begin + 64] == w.data[w.at :]
    print("%06x  ... bytes 0 .. 63 of the footer again, up to %06x" % (w.at, w.at + 64))
    w.at += 64


def main(path):
    with open(path, "rb") as file:
        w = Walk(file.read())
    print("offset  bytes                    meaning")
    header(w)
    while w.data[w.at : w.at + 8] == b"\x8dLTDBR\r\n":
        run(w)
    if w.at < len(w.data):
        footer(w)


if __name__ == "__main__":
    main(sys.argv[1])
