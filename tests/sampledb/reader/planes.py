"""Planes and transforms: bytes to values, which are unsigned integers, the bits of floats."""
from native import zstd_decompress, zstd_frame_size

from .derived import reverse
from .rules import M32, M64, check, fields, rule


def numbers(data, bits, count):
    """`count` packed numbers; the bits behind them are zero."""
    packed = int.from_bytes(data, "little")
    rule(packed >> count * bits == 0, "padding bits")
    return [packed >> i * bits & ((1 << bits) - 1) for i in range(count)]


def decode_plane(codec, data, size):
    if codec == 0:
        check(len(data) == size, "raw plane")
        return bytes(data)
    if codec == 2:
        check(len(data) == 1, "constant plane")
        return bytes(data) * size
    if codec == 3:
        bits, values = data[0], data[1 : 1 + (1 << data[0])]
        check(1 <= bits <= 7 and len(data) == 1 + (1 << bits) + (size + 7) // 8 * bits, "dictionary plane")
        indices = numbers(data[1 + (1 << bits) :], bits, size)
        used = set(indices)
        rule(not any(value for i, value in enumerate(values) if i not in used), "unused bytes of a dictionary")
        return bytes(values[i] for i in indices)
    check(bytes(data[:4]) == b"\x28\xb5\x2f\xfd" and zstd_frame_size(data) == len(data), "zstd frame")
    plane = zstd_decompress(data, size)
    check(plane is not None, "zstd plane")
    return plane


def unzigzag(value):
    return (value >> 1) ^ (M32 if value & 1 else 0)


def from_planes(planes):
    return [sum(byte << 8 * p for p, byte in enumerate(value)) for value in zip(*planes)]


def from_packed(plane, bits, base, count):
    return [base + number & M64 for number in numbers(plane, bits, count)]


def from_lattice(plane, bits, s, base, count):
    low = base % 2**s
    return [base - low + reverse((reverse(low, s) + number) % 2**s, s) for number in numbers(plane, bits, count)]


def unzigzag_steps(value, step):
    return unzigzag(value) << step & M32


def from_cross(planes, ys, step=0):
    return [y + unzigzag_steps(value, step) & M32 for value, y in zip(from_planes(planes), ys)]


def from_delta2(planes, counts, step=0):
    values, first = from_planes(planes), 0
    for n in counts:
        if n > 0:
            values[first] = values[first] << step & M32
        for i in range(first + 1, first + n):
            before = 2 * values[i - 1] - values[i - 2] if i > first + 1 else values[i - 1]
            values[i] = before + unzigzag_steps(values[i], step) & M32
        first += n
    return values


def packed_blocks(counts, k):
    """(numbers, which base) of every block of packed delta2."""
    cut = lambda n: [min(128, n - at) for at in range(0, n, 128)]
    rest = sum(n for n in counts if n != k)
    return [(n, i) for n in cut(counts.count(k)) for i in range(k)] + [(n, k) for n in cut(rest)]


def fields_size(n, width):
    return 16 * (((n + 3) // 4 * width + 31) // 32)


def from_fields(data, n, width):
    words = fields("%dI" % (len(data) // 4), data, 0)
    lanes = [sum(word << 32 * i for i, word in enumerate(words[lane::4])) for lane in range(4)]
    rule(all(lanes[i] >> (n + 3 - i) // 4 * width == 0 for i in range(4)), "bits that no field uses")
    return [lanes[j % 4] >> j // 4 * width & (1 << width) - 1 for j in range(n)]


def from_packed_delta2(plane, counts, k, step):
    """plane(i, size) decodes plane i to so many bytes."""
    blocks = packed_blocks(counts, k)
    bases = fields("%dI" % (k + 1), plane(0, 4 * k + 4), 0)
    widths, exceptions = plane(1, len(blocks)), plane(2, len(blocks))
    check(all(width <= 24 for width in widths), "width of fields")
    check(all(e <= n for e, (n, _) in zip(exceptions, blocks)), "number of exceptions")
    sizes = [fields_size(n, width) for (n, _), width in zip(blocks, widths)]
    data = plane(3, sum(sizes))
    positions, low, high = (plane(i, sum(exceptions)) for i in (4, 5, 6))
    numbers, field, exception = [], 0, 0
    for (n, base), width, count, size in zip(blocks, widths, exceptions, sizes):
        block = [bases[base] - (1 << width) // 2 + f for f in from_fields(data[field : field + size], n, width)]
        end = exception + count
        rule(all(a < b for a, b in zip(positions[exception:end], positions[exception + 1 : end])), "order of exceptions")
        for position, extra in zip(positions[exception:end], zip(low[exception:end], high[exception:end])):
            check(position < n, "an exception outside its block")
            extra = int.from_bytes(bytes(extra), "little", signed=True)
            rule(extra != 0, "an exception that adds nothing")
            block[position] += extra << width
        numbers.append(block)
        field, exception = field + size, end
    whole, rest = [], []
    while len(numbers) >= k and len(whole) < counts.count(k):
        whole += zip(*numbers[:k])  # of each record
        del numbers[:k]
    rest = [number for block in numbers for number in block]
    values, whole = [], iter(whole)
    for n in counts:
        if n == k:
            differences = next(whole)
        else:
            differences, rest = rest[:n], rest[n:]
        value = slope = 0
        for i, number in enumerate(differences):
            slope = slope + number if i > 0 else 0
            value = value + slope if i > 0 else number
            values.append(value << step & M32)
    return values


def stored_rows(bitmap, records):
    check(int.from_bytes(bitmap, "little") >> records == 0, "a bitmap with more rows than the page")
    rows = [i for i, bit in enumerate(numbers(bitmap, 1, records)) if bit]
    check(rows, "a bitmap that names no row")
    return rows


def from_sparse(rows, values, records):
    column = dict(zip(rows, values))
    return [column.get(i, 0) for i in range(records)]
