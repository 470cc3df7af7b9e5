"""Materials: what each shader node is in pbrt, by a table."""
import functools
import math
from dataclasses import dataclass, field

from . import spectra, volumes
from .nodes import BLACK, WHITE, Constant, Graph, Picture, constant, each, is_constant, mix, parameter, product
from .pbrt import directive
from .pictures import Places


@dataclass
class Surface:
    material: tuple = None  # type, parameters; None: nothing that reflects
    emission: list = field(default_factory=list)  # of (colour, strength)
    alpha: object = WHITE  # share of the light that the surface stops
    places: Places = None

    @property
    def is_clear(self):
        return self.material is None and not self.emission and is_constant(self.alpha) and self.alpha.number() == 0


@dataclass
class Exported:
    """What stands before the shapes of a material, and what their mesh must have."""

    lines: list
    emits: bool
    alpha: dict
    places: Places


RADIAL = ("radial", "Z")  # Cycles' tangent, unless a node gives one
MATT_BLACK = ("diffuse", {"rgb reflectance": [0.0, 0.0, 0.0]})
DEFAULT = ("diffuse", {"rgb reflectance": [0.8, 0.8, 0.8]})


class Reader:
    """One material. Shaders are read from its output backwards."""

    def __init__(self, document, graph, settings):
        self.document, self.graph, self.settings = document, graph, settings
        self.value, self.number = graph.of, graph.number

    def shader(self, socket):
        return self.graph.follow(socket, self.surface, lambda _: Surface())

    def surface(self, node, _):
        read = SHADERS.get(node.type)
        if read is None:
            self.graph.lost(f"shader {node.bl_label} is replaced by a matt grey")
            return Surface(DEFAULT)
        return read(self, node)

    def set(self, name, kind, value):
        return parameter(self.document, name, kind, limited(value, "colour" if kind == "spectrum" else name, self.graph.lost))

    def share(self, node, *names):
        """A value between 0 and 1; None if the node has no such input."""
        value = self.value(node, *names)
        return value and limited(value, names[0].lower(), self.graph.lost)

    # What is added to a material of any type.
    def stretched(self, node, along, across, turns):
        """Parameters of a roughness (alpha) along the tangent and across it, turned by an input in turns."""
        self.graph.places.direction = self.graph.follow(node.inputs["Tangent"], self.tangent, lambda _: RADIAL)
        low, high = min(along, across), max(along, across)
        return {"float roughness": math.sqrt(low), "float anisotropy": math.sqrt(min(1.0, (high - low) / max(1e-6, 1 - low))),
                "float anisotropyrotation": 360.0 * self.number(node, turns) + (0.0 if along == high else 90.0)}

    def tangent(self, node, _):
        if node.type != "TANGENT":
            self.graph.lost(f"the tangent of {node.bl_label} is radial")
            return RADIAL
        return ("uv", node.uv_map) if node.direction_type == "UV_MAP" else ("radial", node.axis)

    def relief(self, node, *names):
        """Parameters of a bump or normal map."""
        socket = self.graph.input(node, *(names or ("Normal",)))
        if socket is None or not socket.is_linked:
            return {}
        return self.graph.follow(socket, self.relief_of, lambda _: {})

    def relief_of(self, node, _):
        if node.type == "BUMP":
            height = self.graph.of(node, "Height")
            depth = self.number(node, "Distance") * self.number(node, "Strength") * (-1 if node.invert else 1)
            if is_constant(height):
                return {}
            if self.graph.input(node, "Normal").is_linked:
                self.graph.lost("of two reliefs, only the last one remains")
            return self.set("displacement", "float", product(height, constant(depth)))
        if node.type == "NORMAL_MAP":
            value = self.graph.of(node, "Color")
            if node.space != "TANGENT" or not isinstance(value, Picture) or value.is_moved:
                self.graph.lost("a normal map that is not a tangent-space picture of the first UV map is left out")
                return {}
            if abs(self.number(node, "Strength") - 1) > 1e-3:
                self.graph.lost("the strength of the normal map is 1")
            return {"string normalmap": value.parameters["string filename"]}
        self.graph.lost(f"relief by {node.bl_label} is left out")
        return {}


# ----- shaders


def limited(value, what, lost):
    if not is_constant(value) or 0 <= min(value.rgb) and max(value.rgb) <= 1:
        return value
    article = "an" if what[0] in "aeiou" else "a"
    lost(f"{article} {what} above 1 is 1" if max(value.rgb) > 1 else f"{article} {what} below 0 is 0")
    return each(lambda c: min(1.0, max(0.0, c)), value)


def facets(reader, node, rough, prefix=""):
    """Parameters of their distribution."""
    kind = getattr(node, "distribution", "GGX") if not is_constant(rough) or rough.number() > 0 else "GGX"
    if kind in ("BECKMANN", "ASHIKHMIN_SHIRLEY"):
        reader.graph.lost(f"the facets of {node.bl_label} have the distribution GGX")
    return {f"bool {prefix}multiscatter": True} if kind == "MULTI_GGX" else {}


def diffuse(reader, node):
    if reader.number(node, "Roughness") > 0:
        reader.graph.lost("the roughness of a Diffuse BSDF is 0")
    return Surface(("diffuse", {**reader.set("reflectance", "spectrum", reader.value(node, "Color")), **reader.relief(node)}))


def roughness(reader, node):
    return reader.value(node, "Roughness") if getattr(node, "distribution", "") != "SHARP" else BLACK


def glossy(reader, node):
    """Cycles' Glossy BSDF is a mirror of its colour at every angle, which a surface of a very high index comes close to. Only for a metal
    of the panel, it is a metal."""
    rough, color = roughness(reader, node), reader.value(node, "Color", "Base Color")
    if color is None:  # a Metallic BSDF by n and k
        color = each(lambda n, k: ((n - 1) ** 2 + k**2) / ((n + 1) ** 2 + k**2), *(reader.graph.constant(node, name) for name in ("IOR", "Extinction")))
    if node.type == "BSDF_METALLIC":
        reader.graph.lost("a Metallic BSDF has its colour at every angle")
    metal = spectra.metal(reader.settings)
    anisotropy = reader.number(node, "Anisotropy") if "Anisotropy" in node.inputs else 0.0
    look = reader.set("roughness", "float", rough)
    if anisotropy and is_constant(rough):
        squeeze = 1 - min(0.99, abs(anisotropy))
        along, across = (rough.number() ** 2 * share for share in ((squeeze, 1 / squeeze) if anisotropy > 0 else (1 / squeeze, squeeze)))
        look = reader.stretched(node, along, across, "Rotation")
    if metal and is_constant(rough):
        if anisotropy:
            reader.graph.lost("the roughness of a measured metal has no direction")
        return Surface(measured_metal(reader, node, metal, rough))
    most = min(1.0, max(color.rgb)) if is_constant(color) else 1.0
    if is_constant(color) and most > 0:
        color = each(lambda c: c / most, color)
    return Surface(("latent:principled", {"rgb color": [0.0, 0.0, 0.0], "float eta": 1000.0, "float specular": most,
                                          **reader.set("specularcolor", "spectrum", color), **look, **facets(reader, node, rough), **reader.relief(node)}))


def measured_metal(reader, node, metal, rough):
    alpha = limited(rough, "roughness", reader.graph.lost).number() ** 2
    return "conductor", {**metal, "float roughness": alpha, "bool remaproughness": False, **facets(reader, node, rough, "latent:"), **reader.relief(node)}


def glass(reader, node):
    rough = BLACK if getattr(node, "distribution", "") == "SHARP" else reader.graph.constant(node, "Roughness")
    color = reader.value(node, "Color")
    return Surface(("latent:principled", {"float transmission": 1.0, "bool tintedreflection": node.type == "BSDF_GLASS", **reader.set("roughness", "float", rough), **reader.set("color", "spectrum", color), **facets(reader, node, rough),
                                          **spectra.index(reader.settings, reader.number(node, "IOR")), **reader.relief(node)}))


def refraction(reader, node):
    reader.graph.lost("a Refraction BSDF is glass, which reflects, too")
    return glass(reader, node)


def transparent(reader, node):
    color = limited(reader.graph.constant(node, "Color"), "colour", reader.graph.lost)
    if len(set(color.rgb)) > 1:
        reader.graph.lost("the colour of a Transparent BSDF is grey")
    return Surface(None, alpha=constant(1 - color.number()))


def subsurface(reader, node):
    """A solid that light wanders through. Cycles' has no surface of its own."""
    color, radius, scale = (reader.graph.constant(node, name) for name in ("Color", "Radius", "Scale"))
    reader.graph.lost("subsurface scattering lies below a surface of index 1.01")
    return Surface(("subsurface", {**reader.set("reflectance", "spectrum", color), "rgb mfp": [max(1e-6, r * scale.number()) for r in radius.rgb], "float eta": 1.01}))


def hair(reader, node):
    """Absorption as Cycles': by colour, by melanin or directly."""
    shape = {**reader.set("beta_m", "float", reader.graph.constant(node, "Roughness")), **reader.set("beta_n", "float", reader.graph.constant(node, "Radial Roughness")),
             "float alpha": math.degrees(reader.number(node, "Offset")), "float eta": reader.number(node, "IOR")}
    way = getattr(node, "parametrization", "COLOR")
    if way == "ABSORPTION":
        pigment = parameter(reader.document, "sigma_a", "spectrum", reader.value(node, "Absorption Coefficient"))
    elif way == "MELANIN":
        melanin, red = min(1.0, max(0.0, reader.number(node, "Melanin"))), min(1.0, max(0.0, reader.number(node, "Melanin Redness")))
        amount = -math.log(max(1 - melanin, 1e-4))
        pigment = {"float eumelanin": amount * (1 - red), "float pheomelanin": amount * red}
    else:
        pigment = reader.set("reflectance", "spectrum", reader.value(node, "Color"))
    return Surface(("hair", {**pigment, **shape}))


def principled(reader, node):
    """Inputs have other names since Blender 4.0. What light passes is a material of its own, mixed with the rest."""
    graph, is_new = reader.graph, "Coat Weight" in node.inputs
    number = functools.partial(reader.number, node)
    base, metallic, transmission = limited(reader.value(node, "Base Color"), "colour", graph.lost), reader.share(node, "Metallic"), reader.share(node, *TRANSMISSION)
    below = base if is_new else mix(base, reader.value(node, "Subsurface Color"), constant(number("Subsurface")))
    for name, value, owners, what in LACKING:
        socket = graph.input(node, name)
        if socket and reader.value(node, *(owners or (name,))) != BLACK and (socket.is_linked or value is not None and differs(reader.value(node, name), value)):
            graph.lost(what)
    if transmission != BLACK and not (is_constant(metallic) and (is_constant(transmission) or metallic.number() in (0, 1))):
        graph.lost("transmission beside a texture of metallic, or the reverse, is left out")
        transmission = BLACK
    look = {}
    for name, names in PRINCIPLED.items():
        value = reader.share(node, *names)
        if value is not None:
            look |= reader.set(name, "float", value)
    ior, level = number("IOR"), number("Specular IOR Level", "Specular")
    f0 = min(0.99, ((ior - 1) / (ior + 1)) ** 2 * 2 * level if is_new else 0.08 * level)
    root = math.sqrt(max(f0, 0.0))
    tint = reader.value(node, "Specular Tint")
    if not is_new and is_constant(tint, base):
        luminance = max(base.number(), 1e-6)
        tint = mix(WHITE, Constant(tuple(min(1.0, c / luminance) for c in base.rgb)), tint)
    if is_constant(tint) and tint.rgb != WHITE.rgb and (is_new or tint.number() > 0):
        look |= reader.set("specularcolor", "spectrum", tint)
    anisotropy = number("Anisotropic")
    if anisotropy > 0 and "float roughness" in look:
        alpha, aspect = look["float roughness"] ** 2, math.sqrt(1 - 0.9 * min(1.0, anisotropy))
        look |= reader.stretched(node, alpha / aspect, alpha * aspect, "Anisotropic Rotation")
    if is_new and number("Sheen Weight") > 0:
        look |= reader.set("sheen", "spectrum", product(reader.value(node, "Sheen Tint"), constant(number("Sheen Weight"))))
        look["float sheenroughness"] = min(1.0, max(0.07, number("Sheen Roughness")))
    if is_new and "Thin Film Thickness" in node.inputs and number("Thin Film Thickness") > 0:
        look |= {"float film": 1.0, "float filmthickness": number("Thin Film Thickness"), "float filmeta": number("Thin Film IOR")}
    look |= {**facets(reader, node, reader.value(node, "Roughness")), **reader.relief(node)}

    def part(color, eta, **more):
        return Surface(("latent:principled", {**look, **reader.set("color", "spectrum", color), **spectra.index(reader.settings, eta), **more}))

    def opaque(color, share):
        return part(color, (1 + root) / (1 - root), **reader.set("metallic", "float", share), **({"float specular": 0.0} if level == 0 else {}))

    measured, bright = spectra.metal(reader.settings), raised(below, second_loss(reader, node, metallic, is_new))
    metal = metallic.number() if is_constant(metallic) else 0
    if metal < 1 and ior < 1 and is_new and transmission != WHITE:
        graph.lost("gloss of an index below 1 is that of its inverse")
    if metal == 1 and measured and is_constant(reader.value(node, "Roughness")):
        surface = Surface(measured_metal(reader, node, measured, reader.value(node, "Roughness")))
    elif metal == 1 or transmission == BLACK:
        surface = opaque(bright, metallic)
    else:
        clear = product(transmission, constant(1 - metal))
        if metal == 0:
            rest = opaque(bright, BLACK)
        elif is_new:  # all of the metal is in the rest
            rest = opaque(bright, constant(metal / (1 - clear.number())))
        else:  # transmission takes as much of the metal and the gloss, and more of what is matt
            matt = product(bright, constant((1 - transmission.number()) / (1 - clear.number())))
            rest = Surface(mixture(reader, opaque(matt, BLACK), opaque(bright, WHITE), metallic))
        if look.pop("texture roughness", None):
            look |= reader.set("roughness", "float", graph.constant(node, "Roughness"))
        if reader.share(node, *COAT) != BLACK or is_new and number("Sheen Weight") > 0:
            graph.lost("coat and sheen are left out where light passes")
        passing = part(passed(reader, below) if is_new else below, ior, **{"float transmission": 1.0})
        surface = passing if clear == WHITE else Surface(mixture(reader, rest, passing, clear))
    strength, color = reader.value(node, "Emission Strength"), reader.value(node, "Emission Color", "Emission")
    if not (is_constant(strength) and strength.number() == 0) and not (is_constant(color) and max(color.rgb) == 0):
        surface.emission.append((color, strength))
    surface.alpha = reader.share(node, "Alpha")
    return surface


def passed(reader, color):
    """At each of two surfaces, since 4.0."""
    if is_constant(color):
        return each(math.sqrt, color)
    reader.graph.lost("a texture of its colour tints glass twice")
    return color


TRANSMISSION, COAT = ("Transmission Weight", "Transmission"), ("Coat Weight", "Clearcoat")
# Inputs of a Principled BSDF, the only value that Latent has (None: unlinked), the input that must not be 0, too, and what is said of others.
LACKING = (
    *((name, BLACK, (), "the subsurface scattering of a Principled BSDF is matt") for name in ("Subsurface Weight", "Subsurface")),
    ("Diffuse Roughness", BLACK, (), "its diffuse roughness is 0"),
    ("Sheen", BLACK, (), "sheen is left out (Blender 4.0 has one that Latent knows)"),
    ("Transmission Roughness", BLACK, TRANSMISSION, "what passes through is as rough as what is reflected"),
    ("Coat Tint", WHITE, COAT, "the tint of the coat is white"),
    ("Coat IOR", constant(1.5), COAT, "the index of the coat is 1.5"),
    *((name, None, COAT, "the coat has the normals of the shape") for name in ("Coat Normal", "Clearcoat Normal")),
)


def differs(value, expected):
    return not is_constant(value) or max(abs(c - e) for c, e in zip(value.rgb, expected.rgb)) > 1e-3


# The mean reflectance of a smooth surface of index 1.5 under light from everywhere.
MEAN_GLOSS = 0.09


def second_loss(reader, node, metallic, is_new):
    """Light that Latent's layers take from what is below them on the way out, and Blender's do not: of a coat; before 4.0, of gloss, too."""
    coat, level = reader.share(node, *COAT), reader.value(node, "Specular IOR Level", "Specular")
    if not is_constant(metallic, coat, level):
        return 0.0
    if is_new:
        return MEAN_GLOSS * coat.number()
    return MEAN_GLOSS * (0.25 * coat.number() + min(1.0, 2 * level.number()) * (1 - metallic.number()))


def raised(base, loss):
    """A colour that is as bright after that loss."""
    if loss == 0:
        return base
    return each(lambda c: min(1.0, c / (1 - loss)), base) if is_constant(base) else product(base, constant(1 / (1 - loss)))


# Inputs of a Principled BSDF that mean the same in latent:principled.
PRINCIPLED = {"roughness": ("Roughness",), "coat": COAT, "coatroughness": ("Coat Roughness", "Clearcoat Roughness")}


def fresnel_pair(reader, node):
    """Diffuse below gloss, mixed by Fresnel: how plastic was made before the Principled BSDF."""
    found = reader.graph.source(node.inputs[0])
    kinds = [reader.graph.source(socket) for socket in node.inputs[1:3]]
    names = [kind[0].type if kind else "" for kind in kinds]
    if not (found and found[0].type in ("FRESNEL", "LAYER_WEIGHT") and found[1].name != "Facing" and names == ["BSDF_DIFFUSE", "BSDF_GLOSSY"]):
        return None
    weight, matt, gloss = found[0], kinds[0][0], kinds[1][0]
    eta = reader.number(weight, "IOR") if weight.type == "FRESNEL" else 1 / max(1e-3, 1 - reader.number(weight, "Blend"))
    return Surface(("latent:principled", {**reader.set("color", "spectrum", reader.value(matt, "Color")),
                                          **reader.set("roughness", "float", roughness(reader, gloss)), "float eta": eta, **reader.relief(gloss)}))


def mixed(reader, node):
    around = reader.graph.groups
    plastic = fresnel_pair(reader, node)
    reader.graph.groups = around
    if plastic:
        return plastic
    amount, first, second = reader.graph.value(node.inputs[0]), reader.shader(node.inputs[1]), reader.shader(node.inputs[2])
    if is_constant(amount):
        amount = constant(min(1.0, max(0.0, amount.number())))
        if amount.number() in (0.0, 1.0):
            return second if amount.number() else first
    rest = each(lambda c: 1 - c, amount) if is_constant(amount) else mix(WHITE, BLACK, amount)
    if second.is_clear:
        return Surface(first.material, first.emission, product(first.alpha, rest))
    if first.is_clear:
        return Surface(second.material, second.emission, product(second.alpha, amount))
    emitted = weighted(first.emission, rest) + weighted(second.emission, amount)
    alpha = mix(first.alpha, second.alpha, amount)
    if not first.material and not second.material:
        return Surface(None, emitted, alpha)
    return Surface(mixture(reader, first, second, amount), emitted, alpha)


def mixture(reader, first, second, amount):
    """A part that reflects nothing is black."""
    names = [reader.document.material(*(part.material or MATT_BLACK)) for part in (first, second)]
    return "mix", {"string materials": names, **reader.set("amount", "float", amount)}


def weighted(emission, amount):
    return [(color, product(strength, amount)) for color, strength in emission]


def added(reader, node):
    first, second = (reader.shader(socket) for socket in list(node.inputs)[:2])
    alpha = first.alpha if first.material or not second.material else second.alpha
    emitted = first.emission + second.emission
    if first.material and second.material:
        reader.graph.lost("Add Shader of two surfaces is their mixture, half of each")
        return Surface(mixture(reader, first, second, constant(0.5)), emitted, alpha)
    return Surface(first.material or second.material, emitted, alpha)


def matt(reader, node):
    reader.graph.lost(f"shader {node.bl_label} is a matt one of its colour")
    return Surface(("diffuse", reader.set("reflectance", "spectrum", reader.value(node, "Color"))))


SHADERS = {
    "BSDF_DIFFUSE": diffuse,
    "BSDF_TRANSLUCENT": lambda reader, node: Surface(("diffusetransmission", {"rgb reflectance": [0.0, 0.0, 0.0],
                                                                              **reader.set("transmittance", "spectrum", reader.value(node, "Color"))})),
    **dict.fromkeys(("BSDF_GLOSSY", "BSDF_ANISOTROPIC", "BSDF_METALLIC"), glossy),
    "BSDF_GLASS": glass,
    "BSDF_REFRACTION": refraction,
    "BSDF_TRANSPARENT": transparent,
    "BSDF_HAIR_PRINCIPLED": hair,
    "BSDF_PRINCIPLED": principled,
    **dict.fromkeys(("BSDF_VELVET", "BSDF_SHEEN", "BSDF_TOON"), matt),
    "SUBSURFACE_SCATTERING": subsurface,
    "EMISSION": lambda reader, node: Surface(None, [(reader.value(node, "Color"), reader.value(node, "Strength"))]),
    "MIX_SHADER": mixed,
    "ADD_SHADER": added,
}


# ----- whole materials


def export(document, material, report, files, light_name):
    """What an object of this material (None: the default) is written with."""
    if material is None or not (getattr(material, "use_nodes", True) and material.node_tree):
        color = Constant(tuple(material.diffuse_color)[:3]) if material else constant(0.8)
        name = document.material("diffuse", {"rgb reflectance": list(limited(color, "colour", report.of(f"material {material and material.name}")).rgb)})
        return Exported([f'NamedMaterial "{name}"'], False, {}, Places())
    places = Places()
    graph = Graph(material.node_tree, report.of(f"material {material.name}"), places, files, material)
    reader = Reader(document, graph, material.latent)
    output = graph.output("OUTPUT_MATERIAL")
    surface = reader.shader(output.inputs["Surface"]) if output else Surface()
    places.settle(graph.lost)
    if output and output.inputs["Displacement"].is_linked:
        graph.lost("displacement is left out; use a modifier, or a Bump node")
    inside = volumes.coefficients(output, graph) if output else None
    lines = [f'MediumInterface "{document.medium("homogeneous", inside)}" ""'] if inside else []
    if surface.is_clear or inside and not output.inputs["Surface"].is_linked:
        lines.append('Material "interface"')
    else:
        kind, parameters = surface.material or MATT_BLACK
        parameters = {**parameters, **spectra.reflectance(material.latent, kind, parameters)}
        name = document.material(kind, parameters)
        lines.append(f'NamedMaterial "{name}"')
    lamps = [lamp for lamp in (area_light(graph, color, strength, light_name) for color, strength in surface.emission) if lamp]
    if len(lamps) > 1:
        graph.lost("of several emissions, only the first remains")
    lines += lamps[:1]
    alpha = {} if is_constant(surface.alpha) and surface.alpha.number() == 1 or surface.is_clear else parameter(document, "alpha", "float", surface.alpha)
    return Exported(lines, bool(lamps), alpha, places)


def area_light(graph, color, strength, name):
    """Of a surface that emits on both sides. Radiances are in W/(m^2 sr), as Cycles'."""
    if not is_constant(strength):
        graph.lost("the texture of the strength of an emission is its mean, 1")
        strength = WHITE
    if is_constant(color):
        if strength.number() < 0 or min(color.rgb) < 0:
            graph.lost("negative emission is left out")
        color = each(lambda c: max(0.0, c), color)
    scale = strength.number()
    common = {"bool twosided": True, "string name": name}
    if isinstance(color, Picture) and not color.is_moved:
        return directive("AreaLightSource", "diffuse", **{"string filename": color.parameters["string filename"], "float scale": scale, **common})
    if not is_constant(color):
        graph.lost("the texture of an emission is white")
        color = WHITE
    if scale <= 0 or max(color.rgb) <= 0:
        return None
    return directive("AreaLightSource", "diffuse", **{"rgb L": list(color.rgb), "float scale": scale, **common})
