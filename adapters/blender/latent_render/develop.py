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

def of_pass(channels, names):
    return np.stack([channels[name] for name in names], -1)


def rgb(channels, prefix=""):
    return np.tensordot(of_pass(channels, [prefix + name for name in "RGB"]), RGB_FROM_XYZ.T, 1)


def develop(program, samples, picture, words=(), stop=lambda: False):
    """Channels of the picture."""
    report, _ = tools.run([program, samples, "-o", picture, "--force", "--json", "--quiet", *words], stop=stop)
    if report is None:
        raise tools.Failure("stopped")
    return exr.read(picture)


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
