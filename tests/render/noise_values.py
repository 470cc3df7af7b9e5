#!/usr/bin/python3
"""The numbers of noise_test.cpp: noise textures and pbrt-v4's cloud at a few points, in double precision.

  tests/render/noise_values.py PBRT    prints them; PBRT: a folder with the source of pbrt-v4

Written from [Perlin02] and the formulas of pbrt-v4 alone (src/pbrt/util/noise.cpp, textures.cpp, textures.h, media.h), apart from Latent's code.
The permutation is read from noise.cpp.
"""
import math
import pathlib
import re
import sys

TABLE = []
P = (0.296875, 0.609375, 0.203125), (-1.390625, 2.71875, -0.578125), (3.140625, -0.453125, 1.859375)  # exact as floats
CLOUD_P = (0.890625, 0.609375, 0.703125), (0.171875, 0.796875, 0.390625), (0.640625, 0.90625, 0.09375), (0.453125, 0.421875, 0.546875)


def noise(x, y=0.5, z=0.5):
    """The blend of the slopes of the eight corners of a cell."""
    cell = [math.floor(c) for c in (x, y, z)]
    at = [c - i for c, i in zip((x, y, z), cell)]
    ease = [6 * t**5 - 15 * t**4 + 10 * t**3 for t in at]
    total = 0
    for corner in range(8):
        bits = [corner >> axis & 1 for axis in range(3)]
        i, j, k = ((c + b) % 256 for c, b in zip(cell, bits))
        code = TABLE[(TABLE[(TABLE[i] + j) % 256] + k) % 256] % 16
        dx, dy, dz = (a - b for a, b in zip(at, bits))
        slopes = [dx + dy, dy - dx, dx - dy, -dx - dy, dx + dz, dz - dx, dx - dz, -dx - dz,
                  dy + dz, dz - dy, dy - dz, -dy - dz, dx + dy, dy - dx, dy - dz, -dy - dz]
        total += slopes[code] * math.prod(e if b else 1 - e for e, b in zip(ease, bits))
    return total


def scaled(p, by):
    return [c * by for c in p]


def visible(footprint, octaves):
    """(whole octaves that can be seen, share of the next)"""
    if footprint == 0:
        return octaves, 0
    n = min(max(-1 - math.log2(footprint), 0), octaves)
    t = min(max((n - math.floor(n) - 0.3) / 0.4, 0), 1)
    return math.floor(n), t * t * (3 - 2 * t)


def fbm(p, octaves, roughness, footprint=0.0):
    whole, share = visible(footprint, octaves)
    return sum((1 if i < whole else share) * roughness**i * noise(*scaled(p, 1.99**i)) for i in range(whole + 1))


def wrinkled(p, octaves, roughness, footprint=0.0):
    whole, share = visible(footprint, octaves)
    seen = [1] * whole + [share]
    total = sum(s * roughness**i * abs(noise(*scaled(p, 1.99**i))) for i, s in enumerate(seen))
    # The mean, 0.2, of what is left of the next octave and of all that are not seen whole: as in pbrt-v4, that one counts twice.
    return total + 0.2 * (1 - share) * roughness**whole + 0.2 * sum(roughness**i for i in range(whole, octaves))


def windy(p):
    return abs(fbm(scaled(p, 0.1), 3, 0.5)) * fbm(p, 6, 0.5)


def marble(p, octaves, roughness, scale, variation):
    p = scaled(p, scale)
    t = 0.5 + 0.5 * math.sin(p[1] + variation * fbm(p, octaves, roughness))
    common = (0.58, 0.58, 0.6)
    knots = [common, common, common, (0.5, 0.5, 0.5), (0.6, 0.59, 0.58), common, common, (0.2, 0.2, 0.33), common]
    first = min(int(6 * t), 5)
    u = 6 * t - first
    return [1.5 * sum(math.comb(3, i) * u**i * (1 - u) ** (3 - i) * knots[first + i][c] for i in range(4)) for c in range(3)]


def dot(s, t):
    """The centre of the dot of a cell, if it has one."""
    if noise(s + 0.5, t + 0.5) <= 0:
        return None
    return s + 0.15 * noise(s + 1.5, t + 2.8), t + 0.15 * noise(s + 4.5, t + 9.8)


def cloud(p, density, wispiness, frequency):
    q = scaled(p, frequency)
    for i in range(2 if wispiness > 0 else 0):
        at = scaled(q, 10 * 1.99**i)
        here = noise(*at)
        slope = [(noise(*(c + (0.01 if axis == k else 0) for k, c in enumerate(at))) - here) / 0.01 for axis in range(3)]
        q = [c + 0.05 * wispiness * 0.5**i * g for c, g in zip(q, slope)]
    total = sum(0.5 ** (i + 1) * noise(*scaled(q, 1.99**i)) for i in range(5))
    return min(min(max((1 - p[1]) * 4.5 * density * total, 0), 1) + 2 * max(0, 0.5 - p[1]), 1)


def row(*values):
    print("    {" + ", ".join(f"{v:.6g}" if isinstance(v, float) else str(v) for v in values) + "},")


def main():
    source = (pathlib.Path(sys.argv[1]) / "src/pbrt/util/noise.cpp").read_text()
    numbers = re.search(r"NoisePerm\[2 \* NoisePermSize\] = \{(.*?)\};", source, re.DOTALL).group(1)
    TABLE.extend(int(n) for n in re.findall(r"\b\d+\b", re.sub("//.*", "", numbers))[:256])
    assert sorted(TABLE) == list(range(256))
    for name, of in ("fbm", fbm), ("wrinkled", wrinkled):
        print(f"{name}: octaves, roughness, footprint, values")
        for octaves, roughness, footprint in (8, 0.5, 0.0), (3, 0.6, 0.0), (4, 0.9, 0.0), (6, 0.7, 0.09):
            row(octaves, roughness, footprint, *(of(p, octaves, roughness, footprint) for p in P))
    print("windy: values")
    row(*(windy(p) for p in P))
    print("marble: octaves, roughness, scale, variation, values")
    for parameters in (8, 0.5, 1.0, 0.2), (3, 0.7, 2.5, 1.3), (2, 0.4, 1.5, 3.0):
        row(*parameters, *(c for p in P for c in marble(p, *parameters)))
    print("dots: cell, centre")
    for cell in (-5, 2), (2, 5), (-3, 1), (-2, -5), (1, -8), (-5, -4):
        row(*cell, *dot(*cell))
    assert not any(dot(*cell) for cell in ((-6, 2), (-5, 0), (-3, 4)))
    print("cloud: density, wispiness, frequency, values")
    for parameters in (1.0, 1.0, 5.0), (2.0, 0.0, 3.0), (1.5, 0.5, 4.0), (1.0, 2.0, 2.5):
        row(*parameters, *(cloud(p, *parameters) for p in CLOUD_P))


if __name__ == "__main__":
    main()
