"""Samples to pictures: latent-develop, and its picture in Blender's colours. Needs no Blender."""
import numpy as np

from . import exr, tools

# To linear Rec. 709 under D65, the space in which Blender works unless it is told otherwise.
RGB_FROM_XYZ = np.array([[3.2404542, -1.5371385, -0.4985314], [-0.9692660, 1.8760108, 0.0415560], [0.0556434, -0.2040259, 1.0572252]], np.float32)

# Layers of latent-develop, their channels, and the passes of Blender that show them.
PASSES = {
    "DEPTH": ("Depth", "Z", "VALUE", ["Z"]),
    "NORMAL": ("Normal", "XYZ", "VECTOR", ["N.X", "N.Y", "N.Z"]),
    "POSITION": ("Position", "XYZ", "VECTOR", ["P.X", "P.Y", "P.Z"]),
    "ALBEDO": ("Albedo", "RGB", "COLOR", ["albedo.R", "albedo.G", "albedo.B"]),
    "VARIANCE": ("Variance", "RGB", "COLOR", ["variance.R", "variance.G", "variance.B"]),
}


def rgb(channels):
    return np.tensordot(np.stack([channels["R"], channels["G"], channels["B"]], -1), RGB_FROM_XYZ.T, 1)


def develop(program, samples, picture, words=()):
    """Channels of the picture."""
    tools.run([program, samples, "-o", picture, "--force", "--json", "--quiet", *words])
    return exr.read(picture)


def without(groups, group):
    """Arguments that leave the light of one of the groups alone."""
    return [word for other in groups if other != group for word in ("--light", f"{other}=0")]


def of_pass(channels, names):
    return np.stack([channels[name] for name in names], -1)


def groups_of(program, samples):
    """Names of the light groups of a file. The export names every light, so there is none in "unnamed"."""
    report, _ = tools.run([program, "info", samples, "--json"])
    names = [group if isinstance(group, str) else group["name"] for group in report.get("light_groups", [])]
    return [name for name in names if name != "unnamed"]


