"""Spectra that the panel chooses: metals and glasses by name, dispersion, lamps, measured reflectances."""
import csv

from .values import Constant

METALS = ["Ag", "Al", "Au", "Cu", "CuZn", "MgO", "TiO2"]
GLASSES = ["BK7", "BAF10", "FK51A", "LASF9", "SF5", "SF10", "SF11"]
LAMPS = [("stdillum-A", "Incandescent (A)"), ("stdillum-D50", "Daylight D50"), ("stdillum-D65", "Daylight D65"),
         *((f"stdillum-F{i}", f"Fluorescent F{i}") for i in range(1, 13))]
D_NM, F_NM, C_NM = 587.6, 486.1, 656.3  # the lines of an Abbe number


def cauchy(ior, abbe):
    """n = a + b / lambda^2, by the index at 587.6 nm and the Abbe number (n_d - 1) / (n_F - n_C): wavelengths and indices in turn."""
    b = (ior - 1) / (abbe * (F_NM**-2 - C_NM**-2))
    a = ior - b * D_NM**-2
    return [number for nm in range(360, 831, 10) for number in (float(nm), a + b / nm**2)]


def index(settings, ior):
    if settings.glass != "NONE":
        return {"spectrum eta": f"glass-{settings.glass}"}
    if settings.abbe > 0:
        return {"spectrum eta": cauchy(ior, settings.abbe)}
    return {"float eta": min(1e3, max(1e-3, float(ior)))}


def table(path):
    """Wavelengths in nm and values of a CSV, in turn. Lines that are no numbers are headings."""
    pairs = []
    with open(path, newline="") as file:
        for row in csv.reader(file):
            try:
                pairs.append((float(row[0]), float(row[1])))
            except (ValueError, IndexError):
                continue
    pairs.sort()
    return [number for pair in pairs for number in pair]


def measured(settings, kind, parameters):
    """Those of a material whose colour is a measured one, if the panel names it."""
    import bpy

    name = {"diffuse": "reflectance", "latent:principled": "color", "conductor": "reflectance"}.get(kind)
    if not settings.reflectance or name is None:
        return parameters
    replaced = ("eta", "k") if kind == "conductor" else (name,)
    return {**{key: value for key, value in parameters.items() if key.split()[1] not in replaced}, f"spectrum {name}": table(bpy.path.abspath(settings.reflectance))}


def lamp(settings, key, color):
    """The spectrum of a lamp, and the factor to its scale: with a spectrum, the luminance of its colour counts."""
    if settings.spectrum == "COLOR":
        return {f"rgb {key}": [float(c) for c in color]}, 1.0
    kind, value = {"DAYLIGHT": ("latent:daylight", float(min(25000, max(4000, settings.kelvin)))), "BLACKBODY": ("blackbody", float(settings.kelvin)),
                   "SODIUM": ("spectrum", [588.0, 0.0, 589.0, 1.0, 589.6, 1.0, 590.6, 0.0])}.get(settings.spectrum, ("spectrum", settings.spectrum))
    return {f"{kind} {key}": value}, Constant(tuple(color)).number()
