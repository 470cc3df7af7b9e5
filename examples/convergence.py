"""Prints how a pixel converges: its mean Y and its standard error after 2, 4, 8, ... samples.

Usage: convergence.py FILE U V SIZE      the pixel's centre on the film, and its side, 0..1; FILE holds XYZ records.
"""
import sys

import numpy as np

import latent

if len(sys.argv) != 5:
    sys.exit(__doc__)
path, (u, v, size) = sys.argv[1], map(float, sys.argv[2:5])
half = size / 2
pixel = latent.open(path).read(
    ["sample", "y", "share"], classes="camera",
    region=(max(u - half, 0), max(v - half, 0), min(u + half, 1), min(v + half, 1)))

order = np.argsort(pixel["sample"], kind="stable")  # the order in which they were rendered
y, share = pixel["y"][order].astype(float), pixel["share"][order].astype(float)
print("# records      mean Y   standard error")
n = 2
while n <= len(y):
    mean = y[:n].sum() / share[:n].sum()
    # Of a ratio of sums: the spread of y - mean * share about 0.
    error = np.sqrt(((y[:n] - mean * share[:n]) ** 2).sum()) / share[:n].sum()
    print(f"{n:9d} {mean:11.6g} {error:16.6g}")
    n *= 2
