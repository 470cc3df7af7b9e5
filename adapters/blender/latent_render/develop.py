"""Samples to pictures: latent-develop, and its pictures in Blender's colours. Needs no Blender."""
import struct

import numpy as np

from . import tools

# To linear Rec. 709 under D65, the space in which Blender works unless it is told otherwise.
RGB_FROM_XYZ = np.array([[3.2404542, -1.5371385, -0.4985314], [-0.9692660, 1.8760108, 0.0415560], [0.0556434, -0.2040259, 1.0572252]], np.float32)

# Layers of latent-develop: the passes of Blender that show them, and their channels.
PASSES = {
    "DEPTH": ("Depth", "Z", "VALUE", ["Z"]),
    "NORMAL": ("Normal", "XYZ", "VECTOR", ["N.X", "N.Y", "N.Z"]),
    "POSITION": ("Position", "XYZ", "VECTOR", ["P.X", "P.Y", "P.Z"]),
    "ALBEDO": ("Albedo", "RGB", "COLOR", ["albedo.R", "albedo.G", "albedo.B"]),
    "VARIANCE": ("Variance", "RGB", "COLOR", ["variance.R", "variance.G", "variance.B"]),
}


def read(path):
    """Channels by name, each (height, width), the first row on top, of a picture of latent-develop: tiles of float32, not compressed
    (docs/developing.md, "EXR")."""
    with open(path, "rb") as file:
        data = file.read()
    attributes, at = {}, 8
    while data[at]:
        name, _ = data[at : at + 256].split(b"\0", 1)
        at = data.index(b"\0", at + len(name) + 1) + 1
        (size,) = struct.unpack_from("<i", data, at)
        attributes[name] = data[at + 4 : at + 4 + size]
        at += 4 + size
    if attributes.get(b"compression") != b"\0" or b"tiles" not in attributes:
        raise ValueError(f"{path}: is not as latent-develop writes pictures")
    names, rest = [], attributes[b"channels"]
    while rest[0]:
        name, rest = rest.split(b"\0", 1)
        names.append(name.decode())
        rest = rest[16:]
    x0, y0, x1, y1 = struct.unpack("<4i", attributes[b"dataWindow"])
    planes = np.empty((len(names), y1 - y0 + 1, x1 - x0 + 1), np.float32)
    wide, high = struct.unpack_from("<II", attributes[b"tiles"])
    count = -(-planes.shape[1] // high) * -(-planes.shape[2] // wide)
    for offset in struct.unpack_from(f"<{count}Q", data, at + 1):
        column, row = struct.unpack_from("<2i", data, offset)
        tile = planes[:, row * high :, column * wide :][:, :high, :wide]
        tile[:] = np.frombuffer(data, "<f4", tile.size, offset + 20).reshape(tile.shape[1], len(names), -1).transpose(1, 0, 2)
    return dict(zip(names, planes))


def of_pass(channels, names):
    return np.stack([channels[name] for name in names], -1)


def rgb(channels, prefix=""):
    return np.tensordot(of_pass(channels, [prefix + name for name in "RGB"]), RGB_FROM_XYZ.T, 1)


def develop(program, samples, picture, words=(), stop=lambda: False):
    report, _ = tools.run([program, samples, "-o", picture, "--force", "--json", "--quiet", *words], stop=stop)
    if report is None:
        raise tools.Failure("stopped")
    return read(picture)


def lights(channels):
    """Names of the light groups of a picture with the layer lights. The export names every light, so there is none in "unnamed"."""
    return [name[6:-2] for name in channels if name.startswith("light.") and name.endswith(".R") and name != "light.unnamed.R"]


def mixed(channels, factors):
    """The picture with the light of some groups times a factor."""
    mix = {name: channels[name].copy() for name in "RGB"}
    for light, factor in factors.items():
        for name, plane in mix.items():
            if factor != 1 and f"light.{light}.{name}" in channels:
                plane += np.float32(factor - 1) * channels[f"light.{light}.{name}"]
    return mix
