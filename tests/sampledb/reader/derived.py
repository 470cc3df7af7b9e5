"""What is computed: the positions of a sampler, wavelengths, and the rounding of values."""
import math
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


class Pixels:
    """The sampler pixels."""

    def __init__(self, size, shifts):
        (self.w, self.h), self.shifts = size, shifts
        self.step = (3242174889 * self.h + 2**31) // 2**32 * self.w + (2447445414 * self.w + 2**31) // 2**32
        while math.gcd(self.step, self.w * self.h) != 1:
            self.step += 1
        self.first = (self.shifts[1] << 32 | self.shifts[0]) % (self.w * self.h)
        self.back = pow(self.step, -1, self.w * self.h)

    def place(self, n):
        """Column and row of the pixel, and the pass."""
        p, r = divmod(n, self.w * self.h)
        y, x = divmod((r * self.step + self.first) % (self.w * self.h), self.w)
        return x, y, p

    def sample(self, x, y, p):
        return p * self.w * self.h + (y * self.w + x - self.first) * self.back % (self.w * self.h) & M64

    def point(self, x, y, p):
        s = (self.shifts[1] << 32 | self.shifts[0]) + (y << 32 | x) * 0x9E3779B97F4A7C15 & M64
        s = (s ^ s >> 30) * 0xBF58476D1CE4E5B9 & M64
        s = (s ^ s >> 27) * 0x94D049BB133111EB & M64
        s ^= s >> 31
        z = sum((sum(p >> i & 1 for i in range(32) if i & j == j) & 1) << j for j in range(32))
        a, b = reverse(p & M32, 32) ^ s & M32, reverse(z, 32) ^ s >> 32
        return ((x << 32) + max(a, self.w - 1)) // self.w, ((y << 32) + max(b, self.h - 1)) // self.h

    def unpacked(self, numbers, base, square):
        """Places for the numbers of a plane of transform 12."""
        level, x, y = square
        ends = [(at * size >> level, -(-(at + 1) * size >> level)) for at, size in ((x, self.w), (y, self.h))]
        (x0, x1), (y0, y1) = ends
        return [(x0 + g % (x1 - x0), y0 + g // (x1 - x0) % (y1 - y0), base + g // ((x1 - x0) * (y1 - y0)) & M64) for g in numbers]


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
