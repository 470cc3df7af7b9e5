#!/usr/bin/python3
"""Makes a measured material (.bsdf, as in the RGL database [DupuyJakob18]) of a metal with GGX facets, which is known in closed form.

  bench/bsdf.py FILE [ALPHA_X [ALPHA_Y]]    anisotropic if the two differ
"""
import argparse
import pathlib
import struct
import sys

import numpy as np

LAMBDA_NM = np.array([360, 450, 550, 650, 830], "<f4")
ETA, K = 0.3, 3.0


def direction(x, y):
    """At a place of the unit square: x = sqrt(2 theta / pi), y = phi / (2 pi) + 1/2."""
    theta, phi = x**2 * np.pi / 2, (2 * y - 1) * np.pi
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], -1)


def square(n):
    return np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, n))


def warp(table):
    """Places that a density, bilinear between the values of a square table, is drawn at, from the points of that lattice."""
    n = len(table)
    x, y = square(n)
    cumulative = lambda f, axis: np.insert(np.cumsum((np.delete(f, -1, axis) + np.delete(f, 0, axis)) / 2, axis), 0, 0, axis)
    rows = cumulative(table, 1)                      # over each row, up to each point
    below = cumulative(rows[:, -1:], 0)[:, 0]        # over all rows up to one
    where = lambda a, b, q: np.where(a + np.sqrt(np.maximum(a**2 + 2 * q * (b - a), 0)) > 0,
                                     2 * q / np.maximum(a + np.sqrt(np.maximum(a**2 + 2 * q * (b - a), 0)), 1e-300), 0.5).clip(0, 1)
    up = y * below[-1]
    i = np.clip(np.searchsorted(below, up, "right") - 1, 0, n - 2)
    t = where(rows[i, -1], rows[i + 1, -1], up - below[i])[..., None]
    between = lambda f: (1 - t) * f[i] + t * f[i + 1]  # the row at that height
    row, sums = between(table), between(rows)
    along = x * sums[..., -1]
    j = np.clip((sums <= along[..., None]).sum(-1) - 1, 0, n - 2)[..., None]
    at = lambda f, k: np.take_along_axis(f, k, -1)[..., 0]
    s = where(at(row, j), at(row, j + 1), along - at(sums, j))
    return (j[..., 0] + s) / (n - 1), (i + t[..., 0]) / (n - 1)


def metal(alpha_x, alpha_y, side=32, thetas=8, phis=9):
    """The fields of the file. f cos = F D G2 / (4 cos): spectra are F G2 / G1, sigma is cos / G1."""
    stretched = lambda w: (alpha_x * w[..., 0])**2 + (alpha_y * w[..., 1])**2
    lost = lambda w: (np.sqrt(1 + stretched(w) / np.maximum(w[..., 2], 1e-9)**2) - 1) / 2  # Smith's Lambda
    density = lambda m: 1 / (np.pi * alpha_x * alpha_y * ((m[..., 0] / alpha_x)**2 + (m[..., 1] / alpha_y)**2 + m[..., 2]**2)**2)

    def fresnel(c):
        s2 = 1 - c**2
        t = ETA**2 - K**2 - s2
        q = np.sqrt(t**2 + 4 * ETA**2 * K**2)
        a = np.sqrt(np.maximum((q + t) / 2, 0))
        s = (q - 2 * a * c + c**2) / (q + 2 * a * c + c**2)
        return s * (1 + (c**2 * q - 2 * a * c * s2 + s2**2) / (c**2 * q + 2 * a * c * s2 + s2**2)) / 2

    theta = (np.linspace(0, 0.98, thetas) * np.pi / 2).astype("<f4")
    phi = (np.linspace(-1, 1, phis) * np.pi if alpha_x != alpha_y else np.zeros(1)).astype("<f4")
    x, y = square(side)
    m, w = direction(x, y), direction(np.minimum(x, 0.999), y)
    area = 2 * np.pi**2 * x * np.hypot(m[..., 0], m[..., 1])
    vndf, spectra = [], []
    for p in phi:
        for t in theta:
            wo = direction(np.sqrt(2 * t / np.pi), p / (2 * np.pi) + 0.5)
            seen = np.maximum(m @ wo, 0) * density(m) / (wo[2] * (1 + lost(wo))) * area
            facet = direction(*warp(seen))
            c = np.maximum(facet @ wo, 0)
            wi = 2 * c[..., None] * facet - wo
            vndf.append(seen)
            spectra.append(np.where(wi[..., 2] > 0, fresnel(c) * (1 + lost(wo)) / (1 + lost(wo) + lost(wi)), 0))
    of_each = (len(phi), len(theta))
    luminance = np.array(spectra).reshape(*of_each, side, side)
    colour = np.interp(LAMBDA_NM, [360, 830], [0.7, 1.0])[:, None, None]
    return {"description": np.frombuffer(b"GGX", "u1"), "jacobian": np.ones(1, "u1"), "phi_i": phi, "theta_i": theta,
            "wavelengths": LAMBDA_NM, "ndf": density(m), "sigma": w[..., 2] * (1 + lost(w)),
            "vndf": np.array(vndf).reshape(*of_each, side, side), "luminance": luminance, "spectra": luminance[:, :, None] * colour}


def write(path, fields):
    fields = {name: a if a.dtype == np.uint8 else a.astype("<f4") for name, a in fields.items()}
    offset = 18 + sum(13 + len(name) + 8 * a.ndim for name, a in fields.items())
    head = b"tensor_file\0" + bytes([1, 0]) + struct.pack("<I", len(fields))
    for name, a in fields.items():
        head += struct.pack("<H", len(name)) + name.encode() + struct.pack("<HBQ", a.ndim, 1 if a.dtype == np.uint8 else 10, offset)
        head += struct.pack(f"<{a.ndim}Q", *a.shape)
        offset += a.nbytes
    pathlib.Path(path).write_bytes(head + b"".join(a.tobytes() for a in fields.values()))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", metavar="FILE")
    parser.add_argument("alpha", metavar="ALPHA", type=float, nargs="*", default=[0.3])
    options = parser.parse_args()
    if len(options.alpha) > 2:
        sys.exit("bench/bsdf.py: one or two ALPHA")
    write(options.file, metal(options.alpha[0], options.alpha[-1]))
