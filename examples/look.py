"""Develops a picture with a tone curve of its own, and prints its noise and the spectrum of one pixel.

Usage: look.py FILE.latent PICTURE.ppm [U V]      U, V: the pixel's centre on the film, 0..1; this needs spectral records
"""
import sys

import numpy as np

import latent

if len(sys.argv) not in (3, 5):
    sys.exit(__doc__)
path, picture = sys.argv[1:3]
layers = latent.develop_layers(path, layers=["variance"])
xyz = np.stack([layers[name] for name in "RGB"], -1)

# How noisy is it?
y, error = layers["G"], np.sqrt(layers["variance.G"])
print(f"{xyz.shape[1]} x {xyz.shape[0]} pixels, mean Y {y.mean():.4g}, median standard error {np.median(error[y > 0] / y[y > 0]):.1%}")

# The middle of a print: 18 % grey for the mean of the logarithm, a shoulder for what is brighter, and sRGB's primaries and curve.
exposure = 0.18 / np.exp(np.log(np.maximum(y, 1e-6 * y.max())).mean())
rgb = np.maximum(exposure * xyz, 0) @ np.array([[3.24097, -0.96924, 0.05563], [-1.53738, 1.87597, -0.20398], [-0.49861, 0.04156, 1.05697]])
rgb = np.maximum(rgb, 0)
rgb = rgb * (1 + rgb / 16) / (1 + rgb)  # 4 becomes white
code = np.where(rgb < 0.0031308, 12.92 * rgb, 1.055 * np.maximum(rgb, 0.0031308) ** (1 / 2.4) - 0.055)
with open(picture, "wb") as file:
    file.write(b"P6 %d %d 255\n" % (rgb.shape[1], rgb.shape[0]))
    file.write((np.clip(code, 0, 1) * 255 + 0.5).astype(np.uint8).tobytes())

# The spectrum of the pixel at (U, V): radiance per nm in bins of 10 nm.
if len(sys.argv) > 3:
    u, v = float(sys.argv[3]), float(sys.argv[4])
    height, width = y.shape
    column, row = min(int(u * width), width - 1), min(int(v * height), height - 1)
    bins = latent.develop(path, size=(width, height), crop=(column, row, column + 1, row + 1), spectral_bins=47)[0, 0]
    for i, radiance in enumerate(bins):
        print(f"{365 + 10 * i} nm {radiance:10.4g}")
