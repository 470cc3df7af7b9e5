"""A page: the table of its columns, and their values."""
import struct

from native import hash64

from .derived import Pixels, halton, is_rounded
from .planes import (decode_plane, from_cross, from_delta2, from_lattice, from_packed, from_packed_delta2, from_planes, from_sparse,
                     stored_rows)
from .rules import check, fields, rule


def check_column(number, width, values, column_hash):
    decoded = b"".join(value.to_bytes(width, "little") for value in values)
    check(hash64(decoded) == column_hash, "column %d does not decode to its hash" % number)


def decode_page(job, data, square, camera, records, pair_count, content_hash):
    """Column number -> its values."""
    (count,) = fields("I", data, 0)
    expected = job.columns(camera)
    check(count == len(expected), "columns")
    table, at = [], 4
    for number, width in expected:
        (column, transform, bits, plane_count, s, base, column_hash) = fields("BBBBIQQ", data, at)
        check(column == number, "column %d instead of %d" % (column, number))
        check(transform <= 12 and bits <= 64 and plane_count <= 8 and s <= 32, "table of columns")
        stepped = transform in (8, 9, 10, 11)
        packed = transform in (1, 2, 12)
        rule(packed or base == 0, "base of the table")
        check(not stepped or 1 <= bits <= 22, "bits of a stepped transform")
        rule(bits == 23 - job.precision if stepped else packed or bits == 0, "bits of the table")
        check(transform != 2 or s >= 1, "s of the table")
        rule(transform == 2 or s == 0, "s of the table")
        words = fields("%dI" % plane_count, data, at + 24)
        at += 24 + 4 * plane_count
        table.append((number, width, transform, bits, s, base, column_hash, words))
    check(hash64(b"".join(struct.pack("<Q", t[6]) for t in table)) == content_hash, "content hash of the page")

    stored = {}
    for number, _, _, _, _, _, _, words in table:
        stored[number] = []
        for word in words:
            stored[number].append((word >> 30, data[at : at + word % 2**30]))
            at += word % 2**30
    check(at == len(data), "planes do not fill the page")

    columns = {}
    order = sorted(table, key=lambda t: (t[0] != 1, t[0] != 6))  # samples before positions, y before x and z
    rows = None
    pixels = Pixels(job.pixels, job.shifts) if job.sampler == 2 else None
    for number, width, transform, bits, s, base, column_hash, words in order:
        packed = transform in (1, 2, 12)
        allowed = {1: (1, 2, 12), 2: (0, 1, 3), 3: (0, 1, 3), 5: (0, 1, 4, 7, 8, 10), 6: (0, 1, 6), 7: (0, 1, 4, 7, 8, 10), 11: (0, 1, 5, 9, 11),
                   12: (0, 1, 5, 9, 11)}
        check(transform in allowed.get(number, (0, 1)), "transform %d of column %d" % (transform, number))
        check(number == 1 or transform != 1 or bits == 0, "packed column %d" % number)
        rule(transform != 1 or bits > 0 or base < 256**width, "constant column %d" % number)
        n = pair_count if number in (11, 12) else records
        planes = [decode_plane(*plane, (records + 7) // 8) for plane in stored[number][:1]] if transform == 6 else []
        if transform == 6:
            rows = stored_rows(planes[0], records)
        check(transform not in (7, 10) or rows, "a sparse column beside a y that is not")
        size = (n * bits + 7) // 8 if packed else len(rows) if transform in (6, 7, 10) else n
        if transform == 11 and n > 0:
            check(len(words) == 7, "number of planes")
            values = from_packed_delta2(lambda i, size: decode_plane(*stored[number][i], size), columns[8], job.k, bits)
            check(len(values) == n, "numbers of pairs")
            check_column(number, width, values, column_hash)
            columns[number] = values
            continue
        planes = [decode_plane(*plane, size) for plane in stored[number][len(planes) :]]
        check(len(planes) == (bits > 0 if packed else 0 if transform == 3 or n == 0 else width), "number of planes")
        if transform == 3:
            check(job.sampler in (1, 2) and (table[1][2], table[2][2]) == (3, 3), "positions left out")
            rule(camera, "positions left out of a light page")
            point = (lambda n: pixels.point(*pixels.place(n))) if pixels else (lambda n: halton(n, job.shifts))
            values = [point(sample)[number - 2] for sample in columns[1]]
        elif transform == 12:
            check(pixels, "samples by pixels in a job without them")
            numbers = from_packed(planes[0], bits, 0, n) if bits else [0] * n
            values = [pixels.sample(*place) for place in pixels.unpacked(numbers, base, square)]
        elif n == 0:
            check(transform == 0, "a column without values")
            values = []
        elif transform in (1, 2) and bits == 0:
            values = [base % 256**width] * n
        else:
            values = {
                0: lambda: from_planes(planes),
                1: lambda: from_packed(planes[0], bits, base, n),
                2: lambda: from_lattice(planes[0], bits, s, base, n),
                4: lambda: from_cross(planes, columns[6]),
                5: lambda: from_delta2(planes, columns[8]),
                6: lambda: from_sparse(rows, from_planes(planes), records),
                7: lambda: from_sparse(rows, from_cross(planes, [columns[6][i] for i in rows]), records),
                8: lambda: from_cross(planes, columns[6], bits),
                9: lambda: from_delta2(planes, columns[8], bits),
                10: lambda: from_sparse(rows, from_cross(planes, [columns[6][i] for i in rows], bits), records),
            }[transform]()
        check_column(number, width, values, column_hash)
        columns[number] = values
    if job.kind == 1:
        counts = columns[8]
        check(sum(counts) == pair_count and all(n <= job.k for n in counts), "numbers of pairs")
        if job.knots:
            check(all(n in (0, 1, job.k) for n in counts), "neither one pair nor the batch")
            alone = [n == 1 and job.k > 1 for n in counts]
            check(all(i < job.k if a else i == 65535 for i, a in zip(columns[10], alone)), "index")
    for number in (5, 6, 7, 11):
        rule(all(is_rounded(bits, job.precision) for bits in columns.get(number, [])), "values beyond the precision of the job")
    return columns
