"""Pictures that pbrt-v4 has written."""
import struct
import zlib

import numpy as np

# From its sRGB.
XYZ_FROM_RGB = np.array([[0.4124577, 0.3575758, 0.1804372], [0.2126735, 0.7151516, 0.0721749], [0.0193340, 0.1191919, 0.9503026]])


def exr_rgb(path):
    """R, G, B of a picture as pbrt writes it (scanlines, float32): (height, width, 3)."""
    data = path.read_bytes()
    attributes, at = {}, 8
    while data[at]:
        name, _, rest = data[at:].split(b"\0", 2)
        at = len(data) - len(rest)
        (size,) = struct.unpack_from("<i", data, at)
        attributes[name.decode()] = data[at + 4 : at + 4 + size]
        at += 4 + size
    assert attributes["channels"].startswith(b"B\0\2"), "the picture is not float32"
    assert "chromaticities" not in attributes, "the picture is not sRGB"
    rows = {0: 1, 2: 1, 3: 16}[attributes["compression"][0]]  # none, ZIPS, ZIP
    x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    values = np.empty((height, 3, width), "<f4")
    for offset in struct.unpack_from(f"<{-(-height // rows)}Q", data, at + 1):
        y, size = struct.unpack_from("<ii", data, offset)
        block = data[offset + 8 : offset + 8 + size]
        expected = 12 * width * min(rows, height - y)
        if size < expected:
            steps = np.frombuffer(zlib.decompress(block), np.uint8).astype(np.int64)
            steps[1:] -= 128
            bytes_ = np.cumsum(steps).astype(np.uint8)
            block = np.stack([bytes_[: (expected + 1) // 2], bytes_[(expected + 1) // 2 :]], 1).tobytes()
        values[y : y + rows] = np.frombuffer(block, "<f4").reshape(-1, 3, width)
    return values[:, ::-1].transpose(0, 2, 1).astype(float)


def exr_xyz(path):
    return exr_rgb(path) @ XYZ_FROM_RGB.T
