"""Reads the pictures that latent-develop writes: tiled, float32, uncompressed, one level."""
import struct

import numpy as np


def read(path):
    """Channel name -> (height, width)."""
    data = path.read_bytes()
    assert data[:4] == b"\x76\x2f\x31\x01"
    attributes, at = {}, 8
    while data[at]:
        name, kind, rest = data[at:].split(b"\0", 2)
        at += len(name) + len(kind) + 2
        (size,) = struct.unpack_from("<i", data, at)
        attributes[name.decode()] = data[at + 4 : at + 4 + size]
        at += 4 + size
    names, rest = [], attributes["channels"]
    while rest[0]:
        name, rest = rest.split(b"\0", 1)
        assert struct.unpack_from("<i", rest) == (2,)  # float32
        names.append(name.decode())
        rest = rest[16:]
    assert attributes["compression"] == b"\0"
    x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"])
    side_x, side_y, mode = struct.unpack("<IIB", attributes["tiles"])
    assert mode & 15 == 0
    width, height = x1 - x0 + 1, y1 - y0 + 1
    tiles = -(-width // side_x) * -(-height // side_y)
    picture = {name: np.full((height, width), np.nan, np.float32) for name in names}
    for offset in struct.unpack_from(f"<{tiles}Q", data, at + 1):
        x, y, _, _, size = struct.unpack_from("<5i", data, offset)
        columns, rows = min(side_x, width - x * side_x), min(side_y, height - y * side_y)
        assert size == 4 * columns * rows * len(names)
        tile = np.frombuffer(data, "<f4", size // 4, offset + 20).reshape(rows, len(names), columns)
        for i, name in enumerate(names):
            picture[name][y * side_y :, x * side_x :][:rows, :columns] = tile[:, i]
    return picture
