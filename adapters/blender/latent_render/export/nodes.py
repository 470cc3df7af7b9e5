"""Values of Blender's shader nodes: constants as far as possible, otherwise textures of pbrt. Nodes are told apart by a table."""
import math
import operator
from dataclasses import dataclass

import numpy as np

from ..develop import RGB_FROM_XYZ
from .pictures import Constant, Picture, picture
from .report import Unknown


@dataclass
class Pattern:
    """Another texture of pbrt. `inputs`: parameters that are values themselves."""

    kind: str
    parameters: dict
    inputs: dict


WHITE, BLACK = Constant((1.0, 1.0, 1.0)), Constant((0.0, 0.0, 0.0))


def constant(number):
    return Constant((float(number),) * 3)


def is_constant(*values):
    return all(isinstance(value, Constant) for value in values)


def parameter(document, name, kind, value):
    """A parameter of a material: `kind` is float or spectrum."""
    if is_constant(value):
        return {f"rgb {name}": [max(0.0, c) for c in value.rgb]} if kind == "spectrum" else {f"float {name}": value.number()}
    return {f"texture {name}": define(document, kind, value)}


def define(document, kind, value):
    """The name of the texture that is `value`."""
    if isinstance(value, Picture):
        return document.texture(kind, "imagemap", value.parameters)
    inputs = {}
    for name, inner in value.inputs.items():
        inputs |= parameter(document, name, "float" if name in ("amount", "scale") else kind, inner)
    return document.texture(kind, value.kind, {**value.parameters, **inputs})


def all_nodes(tree):
    """Those of its groups, too."""
    for node in tree.nodes:
        yield node
        if getattr(node, "node_tree", None):
            yield from all_nodes(node.node_tree)


class NoSurface:
    """In place of `places`, of a lamp, a world or a volume."""

    def __getattr__(self, name):
        raise Unknown("a texture that lies on no surface")


class Graph:
    """The nodes of one material, world or lamp. `places` says where pictures lie on the surface; `lost(what)` takes what is left out."""

    def __init__(self, tree, lost, places=None, files=None, material=None):
        self.tree, self.lost, self.places, self.files, self.material = tree, lost, places or NoSurface(), files, material
        self.groups = []  # around the node that is being read

    # ----- links

    def output(self, kind):
        """The node that Cycles takes for the end."""
        nodes = [node for node in self.tree.nodes if node.type == kind and getattr(node, "target", "ALL") in ("ALL", "CYCLES")]
        return next((node for node in nodes if node.is_active_output), nodes[0] if nodes else None)

    def source(self, socket):
        """The node and the output that feed an input, through reroutes, groups and muted nodes; None if nothing does."""
        while links := [link for link in socket.links if not link.is_muted]:
            link = links[0]
            node, output = link.from_node, link.from_socket
            if node.type == "REROUTE":
                socket = node.inputs[0]
            elif node.mute:
                passed = [inner for inner in node.internal_links if inner.to_socket == output]
                if not passed:
                    break
                socket = passed[0].from_socket
            elif node.type == "GROUP" and node.node_tree:
                ends = [end for end in node.node_tree.nodes if end.type == "GROUP_OUTPUT" and end.is_active_output]
                if not ends:  # zero
                    self.unlinked = None
                    return None
                self.groups = [*self.groups, node]
                socket = next(inner for inner in ends[0].inputs if inner.identifier == output.identifier)
            elif node.type == "GROUP_INPUT" and self.groups:
                group = self.groups[-1]
                self.groups = self.groups[:-1]
                socket = next(outer for outer in group.inputs if outer.identifier == output.identifier)
            else:
                return node, output
        self.unlinked = socket
        return None

    def follow(self, socket, read, otherwise):
        """`read(node, output)` of what feeds `socket`, or `otherwise(socket)` of the input that has no link in the end."""
        around = self.groups
        found = self.source(socket)
        try:
            return read(*found) if found else otherwise(self.unlinked if socket.is_linked else socket)
        finally:
            self.groups = around

    def input(self, node, *names):
        """The first input that the node has of these names, which differ between versions of Blender."""
        return next((socket for name in names for socket in node.inputs if name in (socket.name, socket.identifier) and socket.enabled), None)

    # ----- values

    def value(self, socket):
        """A Constant, or a texture. What Latent cannot say is its default, and listed."""
        return self.follow(socket, self.evaluate, default)

    def evaluate(self, node, output):
        read = VALUES.get(node.type)
        try:
            if not read:
                raise Unknown(f"node {node.bl_label}")
            return read(self, node, output)
        except Unknown as unknown:
            baked = self.files and self.files.baked(self, node, output)
            if baked:
                return baked
            self.lost(f"{unknown} is replaced by a constant")
            inputs = [socket for socket in node.inputs if socket.type in ("RGBA", "VALUE") and socket.enabled and not socket.is_linked]
            colors = [default(socket) for socket in inputs if socket.type == "RGBA"]
            return colors[0] if colors else constant(0.5)

    def of(self, node, *names):
        socket = self.input(node, *names)
        return self.value(socket) if socket is not None else None

    def constant(self, node, *names):
        """Where Latent takes no texture."""
        value = self.of(node, *names)
        if value is None:
            return BLACK
        if not is_constant(value):
            self.lost(f"{node.bl_label}: the texture of {names[0]} is replaced by its default")
            value = default(self.input(node, *names))
        return value

    def number(self, node, *names):
        return self.constant(node, *names).number()


def default(socket):
    value = getattr(socket, "default_value", 0.0)
    if hasattr(value, "__len__") and not isinstance(value, str):
        return Constant(tuple(float(c) for c in list(value)[:3]))
    return constant(value if isinstance(value, (int, float)) else 0.0)


# ----- arithmetic


def each(function, *values):
    return Constant(tuple(float(function(*components)) for components in zip(*(value.rgb for value in values))))


def mix(first, second, amount):
    if is_constant(first, second, amount):
        return each(lambda a, b, t: a + (b - a) * t, first, second, amount)
    if is_constant(amount) and amount.number() in (0.0, 1.0):
        return second if amount.number() else first
    if first == second:
        return first
    return Pattern("mix", {}, {"tex1": first, "tex2": second, "amount": amount})


def product(first, second):
    if is_constant(first, second):
        return each(lambda a, b: a * b, first, second)
    if is_constant(first):
        first, second = second, first
    if is_constant(second) and len(set(second.rgb)) > 1:
        if not isinstance(first, Picture) or first.of_color:  # pbrt scales by numbers alone
            raise Unknown("a colour times a picture")
        return mix(BLACK, second, first)
    return Pattern("scale", {}, {"tex": first, "scale": second})


BLENDS = {
    "MIX": mix,
    "MULTIPLY": lambda a, b, t: product(a, mix(WHITE, b, t)),
    **{name: lambda a, b, t, blend=blend: arithmetic(lambda x, y, w: x + (blend(x, y) - x) * w, a, b, t) for name, blend in (
        ("ADD", operator.add), ("SUBTRACT", operator.sub), ("SCREEN", lambda x, y: 1 - (1 - y) * (1 - x)), ("DARKEN", min), ("LIGHTEN", max),
        ("DIFFERENCE", lambda x, y: abs(x - y)), ("DIVIDE", lambda x, y: x / y if y else x))},
}

MATHS = {
    "ADD": operator.add, "SUBTRACT": operator.sub, "MINIMUM": min, "MAXIMUM": max, "LESS_THAN": operator.lt, "GREATER_THAN": operator.gt,
    "DIVIDE": lambda a, b: a / b if b else 0.0, "MODULO": lambda a, b: math.fmod(a, b) if b else 0.0, "POWER": lambda a, b: a**b if a >= 0 else 0.0,
    "LOGARITHM": lambda a, b: math.log(a, b) if a > 0 and b > 0 and b != 1 else 0.0, "SQRT": lambda a, _: math.sqrt(max(0.0, a)),
    "ABSOLUTE": lambda a, _: abs(a), "SINE": lambda a, _: math.sin(a), "COSINE": lambda a, _: math.cos(a),
    "FLOOR": lambda a, _: math.floor(a), "FRACT": lambda a, _: a - math.floor(a),
}


def arithmetic(function, *values):
    if not is_constant(*values):
        raise Unknown("arithmetic with a picture")
    return each(function, *values)


def clamped(graph, value, use):
    if use and isinstance(value, Pattern):
        graph.lost("a mixture of textures is not clamped")
    return each(lambda c: min(1.0, max(0.0, c)), value) if use and is_constant(value) else value


# ----- nodes


def mix_rgb(graph, node, _):
    """Both that of 3.4, and the older one."""
    kind = getattr(node, "data_type", "RGBA")
    blend, clamp = (node.blend_type, getattr(node, "use_clamp", False) or getattr(node, "clamp_result", False)) if kind == "RGBA" else ("MIX", False)
    if kind not in ("RGBA", "FLOAT") or blend not in BLENDS:
        raise Unknown(f"Mix ({kind.lower()}, {blend.lower()})")
    share = graph.of(node, "Factor", "Fac")
    return clamped(graph, BLENDS[blend](graph.of(node, "A", "Color1"), graph.of(node, "B", "Color2"), clamped(graph, share, is_constant(share))), clamp)


def math_node(graph, node, _):
    first, second = (graph.value(socket) for socket in list(node.inputs)[:2])
    if node.operation == "MULTIPLY":
        return clamped(graph, product(first, second), node.use_clamp)
    if node.operation == "SUBTRACT" and is_constant(first) and first.number() == 1 and not is_constant(second):
        return mix(WHITE, BLACK, second)
    if node.operation not in MATHS:
        raise Unknown(f"Math ({node.operation.lower()})")
    return clamped(graph, arithmetic(MATHS[node.operation], first, second), node.use_clamp)


def ramp(graph, node, output):
    """Between two stops, a mixture. Of a constant, any ramp."""
    amount, stops = graph.of(node, "Fac", "Factor"), node.color_ramp.elements
    if is_constant(amount):
        color = node.color_ramp.evaluate(amount.number())
        return constant(color[3]) if output.name == "Alpha" else Constant(tuple(color[:3]))
    ends = [constant(stop.color[3]) if output.name == "Alpha" else Constant(tuple(stop.color[:3])) for stop in stops]
    if len(stops) == 1:
        return ends[0]
    low, high = stops[0].position, stops[1].position
    if len(stops) > 2 or node.color_ramp.interpolation != "LINEAR" or high - low < 1e-6 or low > 1e-6 or high < 1 - 1e-6:
        raise Unknown("Color Ramp with more than two stops, at 0 and 1, of a picture")
    return mix(ends[0], ends[1], amount)


def invert(graph, node, _):
    color = graph.of(node, "Color")
    if is_constant(color):
        opposite = each(lambda c: 1 - c, color)
    elif isinstance(color, Picture) and not color.parameters.get("bool invert"):
        opposite = Picture({**color.parameters, "bool invert": True}, color.of_color)
    else:
        raise Unknown("Invert of a mixture")
    return mix(color, opposite, graph.of(node, "Fac", "Factor"))


def blackbody_rgb(kelvin):
    """Linear Rec. 709 of luminance 1: Planck's law, seen through Gaussian fits of the CIE 1931 observer [WymanSloanShirley13]."""
    nm = np.arange(380.0, 781.0, 5.0)
    power = 1 / (nm**5 * np.expm1(1.4388e7 / (nm * max(kelvin, 200.0))))
    gauss = lambda mean, below, above: np.exp(-0.5 * ((nm - mean) / np.where(nm < mean, below, above)) ** 2)  # noqa: E731
    xyz = np.array([1.056 * gauss(599.8, 37.9, 31.0) + 0.362 * gauss(442.0, 16.0, 26.7) - 0.065 * gauss(501.1, 20.4, 26.2),
                    0.821 * gauss(568.8, 46.9, 40.5) + 0.286 * gauss(530.9, 16.3, 31.1), 1.217 * gauss(437.0, 11.8, 36.0) + 0.681 * gauss(459.0, 26.0, 13.8)]) @ power
    return tuple(np.maximum(0, RGB_FROM_XYZ @ (xyz / xyz[1])).tolist())


def checker(graph, node, output):
    """A square of colour 2 lies at the origin of the plane. Latent has no cubes here."""
    first, second, scale = (graph.value(socket) for socket in list(node.inputs)[1:4])
    if output.name != "Color":
        first, second = WHITE, BLACK
    if not is_constant(scale):
        raise Unknown("Checker with a picture as its scale")
    mapping = graph.places.relative(graph, node.inputs["Vector"], scale.number())
    if graph.places.source[0] != "uv":
        raise Unknown("Checker of space (give it a UV map)")
    return Pattern("checkerboard", mapping, {"tex1": second, "tex2": first})


def vertex_color(graph, node, output):
    graph.places.need_color(node.layer_name if node.type == "VERTEX_COLOR" else node.attribute_name)
    return Pattern("latent:vertexcolor", {"string channel": "alpha"} if output.name == "Alpha" else {}, {})


def attribute(graph, node, output):
    if node.attribute_type != "GEOMETRY" or output.name not in ("Color", "Fac", "Factor"):
        raise Unknown(f"Attribute {node.attribute_name}")
    return vertex_color(graph, node, output)


def fresnel(graph, node, output):
    """Of a Fresnel or a Layer Weight node."""
    graph.lost(f"{node.bl_label} is the value seen from the front")
    ior = graph.number(node, "IOR") if node.type == "FRESNEL" else 1 / (1 - min(graph.number(node, "Blend"), 0.999))
    return constant(0.0 if output.name == "Facing" else ((ior - 1) / (ior + 1)) ** 2)


def light_path(graph, node, output):
    """What light meets, not what the camera or any other kind of ray does."""
    graph.lost(f"Light Path, {output.name}, is 0, also for the camera")
    return BLACK


def grey(graph, node, output):
    """pbrt makes numbers of the colours of a texture by itself."""
    value = graph.of(node, "Color")
    if is_constant(value):
        return constant(value.number())
    if any(link.to_socket.type == "RGBA" for link in output.links):
        raise Unknown("RGB to BW of a picture")
    return value


VALUES = {
    **dict.fromkeys(("RGB", "VALUE"), lambda graph, node, output: default(output)),
    **dict.fromkeys(("MIX", "MIX_RGB"), mix_rgb),
    "MATH": math_node,
    "VALTORGB": ramp,
    "INVERT": invert,
    "GAMMA": lambda graph, node, _: arithmetic(lambda c, g: max(0.0, c) ** g, graph.of(node, "Color"), graph.of(node, "Gamma")),
    "CLAMP": lambda graph, node, _: arithmetic(lambda v, a, b: min(max(v, a), b), *(graph.of(node, name) for name in ("Value", "Min", "Max"))),
    "RGBTOBW": grey,
    "BLACKBODY": lambda graph, node, _: Constant(blackbody_rgb(graph.number(node, "Temperature"))),
    "TEX_CHECKER": checker,
    "TEX_IMAGE": picture,
    "VERTEX_COLOR": vertex_color,
    "ATTRIBUTE": attribute,
    **dict.fromkeys(("FRESNEL", "LAYER_WEIGHT"), fresnel),
    "LIGHT_PATH": light_path,
}
