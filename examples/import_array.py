"""Writes a sample dump of another renderer, arrays of film points and radiance, to a .latent file.

Usage: import_array.py DUMP.npz NAME.latent

DUMP.npz holds `xy` (n, 2), the samples' positions in pixels from the upper left corner, `rgb` (n, 3), their radiance in linear sRGB,
and `size`, the width and height of the picture in pixels. numpy.savez writes such a file from arrays of any origin: for dumps of shape
(height, width, samples, 3), add the centres of pixels, or the offsets in them that the renderer drew.
"""
import hashlib
import sys

import numpy as np

import latent

XYZ_FROM_SRGB = np.array([[0.4123908, 0.3575843, 0.1804808], [0.2126390, 0.7151687, 0.0721923], [0.0193308, 0.1191948, 0.9505322]])

if len(sys.argv) != 3:
    sys.exit(__doc__)
dump, name = sys.argv[1:]
with open(dump, "rb") as file:
    job_id = hashlib.file_digest(file, "md5").hexdigest()  # of everything that shapes a record: here, that is the dump
arrays = np.load(dump)
width, height = (int(side) for side in arrays["size"])
xy, xyz = arrays["xy"].reshape(-1, 2), arrays["rgb"].reshape(-1, 3) @ XYZ_FROM_SRGB.T
n = len(xy)
u, v = xy[:, 0] / width, xy[:, 1] / height
on_film = (u >= 0) & (u < 1) & (v >= 0) & (v < 1)  # renderers may sample the border of their filter, too
if not on_film.all():
    print(f"{name}: {n - on_film.sum()} of {n} samples are not on the film, and left out", file=sys.stderr)

# What has no number of its own may have any. Runs are small where files are: each is read as a whole.
with latent.Writer(name, job_id=job_id, samples=(0, n), aspect=(width, height)) as part:
    x, y, z = xyz[on_film].T
    part.write(sample=np.arange(n)[on_film], u=u[on_film], v=v[on_film], x=x, y=y, z=z)
