"""Materials: what each shader node is in pbrt, by a table."""
import functools
import math
from dataclasses import dataclass, field

import numpy as np

from . import spectra, volumes
from .nodes import Graph
from .pbrt import directive
from .places import Places
from .values import BLACK, WHITE, Constant, clamped, constant, each, is_constant, mix, parameter, product, rest


@dataclass
class Surface:
    material: tuple = None  # type, parameters; None: nothing that reflects
    emission: list = field(default_factory=list)  # of (colour, strength)
    alpha: object = WHITE  # share of the light that the surface stops

    @property
    def is_clear(self):
        return self.material is None and not self.emission and self.alpha == BLACK


@dataclass
class Exported:
    """What stands before the shapes of a material, and what their mesh must have."""

    lines: list
    emits: bool
    alpha: dict
    places: Places


RADIAL = ("radial", "Z")  # Cycles' tangent, unless a node gives one
COLORS = ("reflectance", "transmittance", "color", "specularcolor", "sheen")
MATT_BLACK = ("diffuse", {"rgb reflectance": [0.0, 0.0, 0.0]})
# Inputs of a Principled BSDF, the only value that Latent has (None: unlinked), the input that must not be 0, too, and what is said of others.
LACKING = (
    ("Subsurface Weight", BLACK, "Subsurface Weight", "the subsurface scattering of a Principled BSDF is matt"),
    ("Diffuse Roughness", BLACK, "Diffuse Roughness", "its diffuse roughness is 0"),
    ("Sheen", BLACK, "Sheen", "sheen is left out (Blender 4.0 has one that Latent knows)"),
    ("Transmission Roughness", BLACK, "Transmission Weight", "what passes through is as rough as what is reflected"),
    ("Coat Tint", WHITE, "Coat Weight", "the tint of the coat is white"),
    ("Coat IOR", constant(1.5), "Coat Weight", "the index of the coat is 1.5"),
    ("Coat Normal", None, "Coat Weight", "the coat has the normals of the shape"),
)
MEAN_GLOSS = 0.09  # the mean reflectance of a smooth surface of index 1.5 under light from everywhere


class Reader(Graph):
    """The nodes of one material. Shaders are read from its output backwards."""

    def __init__(self, document, material, report, files):
        super().__init__(material.node_tree, report.of(f"material {material.name}"), Places(), files, material)
        self.document, self.settings = document, material.latent

    def shader(self, socket):
        return self.follow(socket, lambda node, _: SHADERS.get(node.type, Reader.other)(self, node), lambda _: Surface())

    def limited(self, value, what):
        """A value between 0 and 1."""
        within = clamped(value)
        if within != value:
            article = "an" if what[0] in "aeiou" else "a"
            self.lost(f"{article} {what} above 1 is 1" if max(value.rgb) > 1 else f"{article} {what} below 0 is 0")
        return within

    def share(self, node, name):
        """A value between 0 and 1; None if the node has no such input."""
        value = self.of(node, name)
        return value and self.limited(value, name.lower())

    def made(self, of, typed=(), **values):
        """A surface of a material: `typed` parameters, and those that are values between 0 and 1."""
        parameters = dict(typed)
        for name, value in values.items():
            kind = "spectrum" if name in COLORS else "float"
            parameters |= parameter(self.document, name, kind, self.limited(value, "colour" if name in COLORS else name))
        return Surface((of, parameters))

    def mixture(self, first, second, amount):
        """A part that reflects nothing is black."""
        names = [self.document.material(*(part.material or MATT_BLACK)) for part in (first, second)]
        return self.made("mix", {"string materials": names}, amount=amount)

    # What is added to a material of any type: parameters.
    def stretched(self, node, along, across, turns):
        """Of a roughness (alpha) along the tangent and across it, turned by an input in turns."""
        self.places.direction = self.follow(node.inputs["Tangent"], self.tangent, lambda _: RADIAL)
        low, high = min(along, across), max(along, across)
        return {"float roughness": math.sqrt(low), "float anisotropy": math.sqrt(min(1.0, (high - low) / max(1e-6, 1 - low))),
                "float anisotropyrotation": 360.0 * self.number(node, turns) + (0.0 if along == high else 90.0)}

    def tangent(self, node, _):
        if node.type != "TANGENT":
            self.lost(f"the tangent of {node.bl_label} is radial")
            return RADIAL
        return ("uv", node.uv_map) if node.direction_type == "UV_MAP" else ("radial", node.axis)

    def facets(self, node, rough, prefix=""):
        kind = getattr(node, "distribution", "GGX") if not is_constant(rough) or rough.number() > 0 else "GGX"
        if kind in ("BECKMANN", "ASHIKHMIN_SHIRLEY"):
            self.lost(f"the facets of {node.bl_label} have the distribution GGX")
        return {f"bool {prefix}multiscatter": True} if kind == "MULTI_GGX" else {}

    def relief(self, node):
        return self.follow(node.inputs["Normal"], self.relief_of, lambda _: {})

    def relief_of(self, node, _):
        if node.type == "BUMP":
            height = self.of(node, "Height")
            depth = self.number(node, "Distance") * self.number(node, "Strength") * (-1 if node.invert else 1)
            if is_constant(height):
                return {}
            if self.input(node, "Normal").is_linked:
                self.lost("of two reliefs, only the last one remains")
            return parameter(self.document, "displacement", "float", product(height, constant(depth)))
        if node.type == "NORMAL_MAP":
            value = self.of(node, "Color")
            if node.space != "TANGENT" or is_constant(value) or not value.is_picture or value.is_moved:
                self.lost("a normal map that is not a tangent-space picture of the first UV map is left out")
                return {}
            if abs(self.number(node, "Strength") - 1) > 1e-3:
                self.lost("the strength of the normal map is 1")
            return {"string normalmap": value.parameters["string filename"]}
        self.lost(f"relief by {node.bl_label} is left out")
        return {}

    def measured_metal(self, node, rough):
        """By the panel, if it names one."""
        name = self.settings.metal
        if name == "NONE" or not is_constant(rough):
            return None
        alpha, metal = self.limited(rough, "roughness").number() ** 2, {"spectrum eta": f"metal-{name}-eta", "spectrum k": f"metal-{name}-k"}
        return Surface(("conductor", {**metal, "float roughness": alpha, "bool remaproughness": False, **self.facets(node, rough, "latent:"), **self.relief(node)}))

    def other(self, node):
        color = self.of(node, "Color")
        self.lost(f"shader {node.bl_label} is a matt one of its colour" if color else f"shader {node.bl_label} is replaced by a matt grey")
        return self.made("diffuse", reflectance=color or constant(0.8))

    def diffuse(self, node):
        if self.number(node, "Roughness") > 0:
            self.lost("the roughness of a Diffuse BSDF is 0")
        return self.made("diffuse", self.relief(node), reflectance=self.of(node, "Color"))

    def roughness(self, node):
        return self.of(node, "Roughness") if getattr(node, "distribution", "") != "SHARP" else BLACK

    def glossy(self, node):
        """Cycles' Glossy BSDF is a mirror of its colour at every angle, which a surface of a very high index comes close to. Only for a metal
        of the panel, it is a metal."""
        rough, color = self.roughness(node), self.of(node, "Color") or self.of(node, "Base Color")
        if color is None:  # a Metallic BSDF by n and k
            color = each(lambda n, k: ((n - 1) ** 2 + k**2) / ((n + 1) ** 2 + k**2), *(self.constant(node, name) for name in ("IOR", "Extinction")))
        if node.type == "BSDF_METALLIC":
            self.lost("a Metallic BSDF has its colour at every angle")
        anisotropy = self.number(node, "Anisotropy") if is_constant(rough) else 0.0
        metal = self.measured_metal(node, rough)
        if metal:
            if anisotropy:
                self.lost("the roughness of a measured metal has no direction")
            return metal
        most = min(1.0, max(color.rgb)) if is_constant(color) else 1.0
        if is_constant(color) and most > 0:
            color = each(lambda c: c / most, color)
        look = {"rgb color": [0.0, 0.0, 0.0], "float eta": 1000.0, "float specular": most, **self.facets(node, rough), **self.relief(node)}
        if not anisotropy:
            return self.made("latent:principled", look, roughness=rough, specularcolor=color)
        alpha, squeeze = self.limited(rough, "roughness").number() ** 2, 1 - min(0.99, abs(anisotropy))
        along, across = (alpha * squeeze, alpha / squeeze) if anisotropy > 0 else (alpha / squeeze, alpha * squeeze)
        return self.made("latent:principled", {**look, **self.stretched(node, along, across, "Rotation")}, specularcolor=color)

    def glass(self, node):
        rough = BLACK if getattr(node, "distribution", "") == "SHARP" else self.constant(node, "Roughness")
        if node.type == "BSDF_REFRACTION":
            self.lost("a Refraction BSDF is glass, which reflects, too")
        look = {"float transmission": 1.0, "bool tintedreflection": node.type == "BSDF_GLASS", **spectra.index(self.settings, self.number(node, "IOR"))}
        return self.made("latent:principled", {**look, **self.facets(node, rough), **self.relief(node)}, roughness=rough, color=self.of(node, "Color"))

    def transparent(self, node):
        color = self.limited(self.constant(node, "Color"), "colour")
        if len(set(color.rgb)) > 1:
            self.lost("the colour of a Transparent BSDF is grey")
        return Surface(alpha=constant(1 - color.number()))

    def subsurface(self, node):
        """A solid that light wanders through. Cycles' has no surface of its own."""
        color, radius, scale = (self.constant(node, name) for name in ("Color", "Radius", "Scale"))
        self.lost("subsurface scattering lies below a surface of index 1.01")
        return self.made("subsurface", {"rgb mfp": [max(1e-6, r * scale.number()) for r in radius.rgb], "float eta": 1.01}, reflectance=color)

    def hair(self, node):
        """Absorption as Cycles': by colour, by melanin or directly."""
        way = getattr(node, "parametrization", "COLOR")
        shape, color = {"float alpha": math.degrees(self.number(node, "Offset")), "float eta": self.number(node, "IOR")}, {}
        if way == "ABSORPTION":
            shape |= parameter(self.document, "sigma_a", "spectrum", self.of(node, "Absorption Coefficient"))
        elif way == "MELANIN":
            melanin, red = (clamped(self.constant(node, name)).number() for name in ("Melanin", "Melanin Redness"))
            amount = -math.log(max(1 - melanin, 1e-4))
            shape |= {"float eumelanin": amount * (1 - red), "float pheomelanin": amount * red}
        else:
            color = {"reflectance": self.of(node, "Color")}
        return self.made("hair", shape, beta_m=self.constant(node, "Roughness"), beta_n=self.constant(node, "Radial Roughness"), **color)

    def principled(self, node):
        """Inputs have other names since Blender 4.0. What light passes is a material of its own, mixed with the rest."""
        is_new, number, share = "Coat Weight" in node.inputs, functools.partial(self.number, node), functools.partial(self.share, node)
        base = self.limited(self.of(node, "Base Color"), "colour")
        metallic, transmission, coat = (share(name) for name in ("Metallic", "Transmission Weight", "Coat Weight"))
        below = base if is_new else mix(base, self.of(node, "Subsurface Color"), constant(number("Subsurface")))
        for name, usual, owner, what in LACKING:
            socket = self.input(node, name)
            if socket and self.of(node, owner) != BLACK and (socket.is_linked or usual and not np.allclose(self.of(node, name).rgb, usual.rgb, 0, 1e-3)):
                self.lost(what)
        if transmission != BLACK and not (is_constant(metallic) and (is_constant(transmission) or metallic in (WHITE, BLACK))):
            self.lost("transmission beside a texture of metallic, or the reverse, is left out")
            transmission = BLACK
        ior, level, rough = number("IOR"), number("Specular IOR Level"), share("Roughness")
        root = math.sqrt(max(0.0, min(0.99, ((ior - 1) / (ior + 1)) ** 2 * 2 * level if is_new else 0.08 * level)))
        values = {"roughness": rough, "coat": coat, "coatroughness": share("Coat Roughness")}
        typed = {**self.facets(node, self.of(node, "Roughness")), **self.relief(node)}
        tint, neutral = self.of(node, "Specular Tint"), WHITE if is_new else BLACK
        if tint != neutral and not is_constant(tint, WHITE if is_new else base):
            self.lost("the tint of its gloss is white where it or the colour is a texture")
        elif tint != neutral:
            luminance = max(base.number(), 1e-6) if not is_new else 1
            values["specularcolor"] = tint if is_new else mix(WHITE, each(lambda c: min(1.0, c / luminance), base), tint)
        anisotropy = number("Anisotropic")
        if anisotropy > 0 and is_constant(rough):
            alpha, aspect = values.pop("roughness").number() ** 2, math.sqrt(1 - 0.9 * min(1.0, anisotropy))
            typed |= self.stretched(node, alpha / aspect, alpha * aspect, "Anisotropic Rotation")
        has_sheen = is_new and number("Sheen Weight") > 0
        if has_sheen:
            values["sheen"] = product(self.of(node, "Sheen Tint"), constant(number("Sheen Weight")))
            typed["float sheenroughness"] = min(1.0, max(0.07, number("Sheen Roughness")))
        if number("Thin Film Thickness") > 0:
            typed |= {"float film": 1.0, "float filmthickness": number("Thin Film Thickness"), "float filmeta": number("Thin Film IOR")}

        def part(color, eta, more=(), **others):
            return self.made("latent:principled", {**typed, **spectra.index(self.settings, eta), **dict(more)}, **{**values, "color": color, **others})

        def opaque(color, metallic):
            return part(color, (1 + root) / (1 - root), {"float specular": 0.0} if level == 0 else {}, metallic=metallic)

        metal = metallic.number() if is_constant(metallic) else 0
        bright = self.raised(below, coat, metallic, self.of(node, "Specular IOR Level"), is_new)
        if metal < 1 and ior < 1 and is_new and transmission != WHITE:
            self.lost("gloss of an index below 1 is that of its inverse")
        if metal == 1 or transmission == BLACK:
            surface = metal == 1 and self.measured_metal(node, self.of(node, "Roughness")) or opaque(bright, metallic)
        else:
            clear = product(transmission, constant(1 - metal))
            if metal == 0:
                solid = opaque(bright, BLACK)
            elif is_new:  # all of the metal is in the rest
                solid = opaque(bright, constant(metal / (1 - clear.number())))
            else:  # transmission takes as much of the metal and the gloss, and more of what is matt
                matt = product(bright, constant((1 - transmission.number()) / (1 - clear.number())))
                solid = self.mixture(opaque(matt, BLACK), opaque(bright, WHITE), metallic)
            if not is_constant(rough):
                values["roughness"] = self.constant(node, "Roughness")
            if coat != BLACK or has_sheen:
                self.lost("coat and sheen are left out where light passes")
            if is_new and is_constant(below):  # light passes two surfaces
                below = each(math.sqrt, below)
            elif is_new:
                self.lost("a texture of its colour tints glass twice")
            passing = part(below, ior, {"float transmission": 1.0})
            surface = passing if clear == WHITE else self.mixture(solid, passing, clear)
        strength, color = self.of(node, "Emission Strength"), self.of(node, "Emission Color")
        if strength != BLACK and (not is_constant(color) or max(color.rgb) != 0):
            surface.emission.append((color, strength))
        surface.alpha = share("Alpha")
        return surface

    @staticmethod
    def raised(base, coat, metallic, level, is_new):
        """A colour that is as bright in spite of what Latent's layers take from it on the way out, and Blender's do not: a coat; before 4.0, gloss."""
        if not is_constant(coat, metallic, level):
            return base
        loss = MEAN_GLOSS * (coat.number() if is_new else 0.25 * coat.number() + min(1.0, 2 * level.number()) * (1 - metallic.number()))
        if is_constant(base):
            return each(lambda c: min(1.0, c / (1 - loss)), base)
        return product(base, constant(1 / (1 - loss))) if loss else base

    def fresnel_pair(self, node):
        """Diffuse below gloss, mixed by Fresnel: how plastic was made before the Principled BSDF."""
        found, *shaders = (self.source(socket) for socket in list(node.inputs)[:3])
        if not found or found[0].type not in ("FRESNEL", "LAYER_WEIGHT") or found[1].name == "Facing":
            return None
        weight, (matt, gloss) = found[0], (shader and shader[0] for shader in shaders)
        if not (matt and gloss and matt.type == "BSDF_DIFFUSE" and gloss.type == "BSDF_GLOSSY"):
            return None
        eta = self.number(weight, "IOR") if weight.type == "FRESNEL" else 1 / max(1e-3, 1 - self.number(weight, "Blend"))
        return self.made("latent:principled", {"float eta": eta, **self.relief(gloss)}, color=self.of(matt, "Color"), roughness=self.roughness(gloss))

    def mixed(self, node):
        around = self.groups
        plastic = self.fresnel_pair(node)
        self.groups = around
        if plastic:
            return plastic
        amount, first, second = clamped(self.value(node.inputs[0])), self.shader(node.inputs[1]), self.shader(node.inputs[2])
        if amount in (BLACK, WHITE):
            return second if amount == WHITE else first
        if second.is_clear:
            return Surface(first.material, first.emission, product(first.alpha, rest(amount)))
        if first.is_clear:
            return Surface(second.material, second.emission, product(second.alpha, amount))
        material = self.mixture(first, second, amount).material if first.material or second.material else None
        emitted = [(color, product(strength, share)) for part, share in ((first, rest(amount)), (second, amount)) for color, strength in part.emission]
        return Surface(material, emitted, mix(first.alpha, second.alpha, amount))

    def added(self, node):
        first, second = (self.shader(socket) for socket in list(node.inputs)[:2])
        material = first.material or second.material
        if first.material and second.material:
            self.lost("Add Shader of two surfaces is their mixture, half of each")
            material = self.mixture(first, second, constant(0.5)).material
        return Surface(material, first.emission + second.emission, first.alpha if first.material or not second.material else second.alpha)

    def area_light(self, color, strength, name):
        """Of a surface that emits on both sides. Radiances are in W/(m^2 sr), as Cycles'."""
        if not is_constant(strength):
            self.lost("the texture of the strength of an emission is its mean, 1")
            strength = WHITE
        if not is_constant(color) and (not color.is_picture or color.is_moved):
            self.lost("the texture of an emission is white")
            color = WHITE
        scale = strength.number()
        if is_constant(color):
            if scale < 0 or min(color.rgb) < 0:
                self.lost("negative emission is left out")
            if scale <= 0 or max(color.rgb) <= 0:
                return None
            light = {"rgb L": [max(0.0, c) for c in color.rgb]}
        else:
            light = {"string filename": color.parameters["string filename"]}
        return directive("AreaLightSource", "diffuse", **light, **{"float scale": scale, "bool twosided": True, "string name": name})


SHADERS = {
    "BSDF_DIFFUSE": Reader.diffuse,
    "BSDF_TRANSLUCENT": lambda reader, node: reader.made("diffusetransmission", reflectance=BLACK, transmittance=reader.of(node, "Color")),
    **dict.fromkeys(("BSDF_GLOSSY", "BSDF_ANISOTROPIC", "BSDF_METALLIC"), Reader.glossy),
    **dict.fromkeys(("BSDF_GLASS", "BSDF_REFRACTION"), Reader.glass),
    "BSDF_TRANSPARENT": Reader.transparent,
    "BSDF_HAIR_PRINCIPLED": Reader.hair,
    "BSDF_PRINCIPLED": Reader.principled,
    "SUBSURFACE_SCATTERING": Reader.subsurface,
    "EMISSION": lambda reader, node: Surface(None, [(reader.of(node, "Color"), reader.of(node, "Strength"))]),
    "MIX_SHADER": Reader.mixed,
    "ADD_SHADER": Reader.added,
}


def export(document, material, report, files, light_name):
    """What an object of this material (None: the default) is written with."""
    if material is None or not (getattr(material, "use_nodes", True) and material.node_tree):
        color = clamped(Constant(tuple(material.diffuse_color)[:3]) if material else constant(0.8))
        matt = document.material("diffuse", parameter(document, "reflectance", "spectrum", color))
        return Exported([directive("NamedMaterial", matt)], False, {}, Places())
    reader = Reader(document, material, report, files)
    output = reader.output("OUTPUT_MATERIAL")
    surface = reader.shader(output.inputs["Surface"]) if output else Surface()
    reader.places.settle(reader.lost)
    if output and output.inputs["Displacement"].is_linked:
        reader.lost("displacement is left out; use a modifier, or a Bump node")
    inside = output and volumes.coefficients(output, reader)
    lines = [directive("MediumInterface", document.define("MakeNamedMedium", **{"string type": "homogeneous", **inside}), "")] if inside else []
    if surface.is_clear or inside and not output.inputs["Surface"].is_linked:
        lines.append('Material "interface"')
    else:
        kind, parameters = surface.material or MATT_BLACK
        lines.append(directive("NamedMaterial", document.material(kind, spectra.measured(reader.settings, kind, parameters))))
    lamps = [lamp for lamp in (reader.area_light(color, strength, light_name) for color, strength in surface.emission) if lamp]
    if len(lamps) > 1:
        reader.lost("of several emissions, only the first remains")
    alpha = {} if surface.alpha == WHITE or surface.is_clear else parameter(document, "alpha", "float", surface.alpha)
    return Exported(lines + lamps[:1], bool(lamps), alpha, reader.places)
