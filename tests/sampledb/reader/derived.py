"""What is computed: the positions of a sampler, wavelengths, and the rounding of values."""
import struct

from native import hash64

from .rules import M32, M64, fields


def reverse(value, bits):
    return int(format(value, "0%db" % bits)[::-1], 2)


def halton(n, shifts):
    d, rest = 0, n
    for _ in range(40):
        d, rest = d * 3 + rest % 3, rest // 3
    return (reverse(n & M32, 32) + shifts[0]) & M32, ((d << 32) // 3**40 + shifts[1]) & M32


def wavelength(knots, k, xi, i):
    """Bits of wavelength i of the batch (xi, k)."""
    q = (i * 2**32 + xi) * 2**16 // k
    j = [cumulative <= q for cumulative, _ in knots].count(True) - 1
    slope = float(knots[j + 1][1] - knots[j][1]) / float(knots[j + 1][0] - knots[j][0])
    return fields("I", struct.pack("<f", (float(knots[j][1]) + slope * float(q - knots[j][0])) * 2.0**-20), 0)[0]


def rounding_seed(job_id, n, u, v):
    x = hash64(struct.pack("<QQ", *job_id)) + n * 0x9E3779B97F4A7C15 + (v << 32 | u) * 0xD1B54A32D192ED03 & M64
    x = (x ^ x >> 30) * 0xBF58476D1CE4E5B9 & M64
    x = (x ^ x >> 27) * 0x94D049BB133111EB & M64
    return x ^ x >> 31


def rounding_random(seed, i):
    x = (seed & M32) + i * 0x9E3779B9 & M32
    x = (x ^ x >> 16) * 0x7FEB352D & M32
    x = (x ^ x >> 15) * 0x846CA68B & M32
    return x ^ x >> 16 ^ seed >> 32


def rounded(bits, precision, random):
    step = 2 ** (23 - precision)
    return bits if bits % 2**31 > 0x7F800000 - step else bits + random % step & -step


def is_rounded(bits, precision):
    """Whether rounding leaves the value as it is, whatever the random number."""
    return rounded(bits, precision, M32) == bits
