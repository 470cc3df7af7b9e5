"""Pictures of latent-develop: tiles of 256 x 256 pixels of float32, not compressed (docs/developing.md, "EXR"). Needs no Blender."""
import struct

import numpy as np


def read(path):
    """Channels by name, each (height, width), the first row on top."""
    with open(path, "rb") as file:
        data = file.read()
    attributes, at = {}, 8
    while data[at]:
        name, _, _ = data[at : at + 256].split(b"\0", 2)
        at += len(name) + 1
        kind = data[at : data.index(b"\0", at)]
        at += len(kind) + 1
        (size,) = struct.unpack_from("<i", data, at)
        attributes[name.decode()] = data[at + 4 : at + 4 + size]
        at += 4 + size
    if attributes.get("compression") != b"\0" or "tiles" not in attributes:
        raise ValueError(f"{path}: is not as latent-develop writes pictures")
    names, where = [], 0
    channels = attributes["channels"]
    while channels[where]:
        end = channels.index(b"\0", where)
        names.append(channels[where:end].decode())
        where = end + 17
    x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    side_x, side_y = struct.unpack_from("<II", attributes["tiles"])
    count = -(-width // side_x) * -(-height // side_y)
    planes = np.empty((len(names), height, width), np.float32)
    for offset in struct.unpack_from(f"<{count}Q", data, at + 1):
        column, row, _, _, size = struct.unpack_from("<5i", data, offset)
        left, top = column * side_x, row * side_y
        wide, high = min(side_x, width - left), min(side_y, height - top)
        tile = np.frombuffer(data, "<f4", len(names) * wide * high, offset + 20).reshape(high, len(names), wide)
        planes[:, top : top + high, left : left + wide] = tile.transpose(1, 0, 2)
    return dict(zip(names, planes))
