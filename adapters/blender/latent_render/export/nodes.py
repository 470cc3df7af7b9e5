"""Values of Blender's shader nodes. Nodes are told apart by a table."""
import math
import operator

import numpy as np

from ..develop import RGB_FROM_XYZ
from .pictures import picture
from .report import Unknown
from .values import BLACK, WHITE, Constant, Texture, clamped, constant, each, is_constant, mix, product, rest


def all_nodes(tree):
    """Those of its groups, too."""
    for node in tree.nodes:
        yield node
        if getattr(node, "node_tree", None):
            yield from all_nodes(node.node_tree)


# Inputs that had other names in earlier versions.
RENAMED = {"Factor": "Fac", "A": "Color1", "B": "Color2", "Specular IOR Level": "Specular", "Transmission Weight": "Transmission", "Coat Weight": "Clearcoat",
           "Coat Roughness": "Clearcoat Roughness", "Coat Normal": "Clearcoat Normal", "Subsurface Weight": "Subsurface", "Emission Color": "Emission"}


class Graph:
    """The nodes of one material, world or lamp. `places` says where pictures lie on the surface, if there is one; `lost(what)` takes what is
    left out."""

    def __init__(self, tree, lost, places=None, files=None, material=None):
        self.tree, self.lost, self.places, self.files, self.material = tree, lost, places, files, material
        self.groups = []  # around the node that is being read

    # ----- links

    def output(self, kind):
        """The node that Cycles takes for the end."""
        nodes = [node for node in self.tree.nodes if node.type == kind and getattr(node, "target", "ALL") in ("ALL", "CYCLES")]
        return next((node for node in nodes if node.is_active_output), nodes[0] if nodes else None)

    def source(self, socket):
        """The node and the output that feed an input, through reroutes, groups and muted nodes; None if nothing does."""
        while links := [link for link in socket.links if not link.is_muted]:
            node, output = links[0].from_node, links[0].from_socket
            if node.type == "REROUTE":
                socket = node.inputs[0]
            elif node.mute:
                passed = [inner.from_socket for inner in node.internal_links if inner.to_socket == output]
                if not passed:
                    break
                socket = passed[0]
            elif node.type == "GROUP" and node.node_tree:
                ends = [end for end in node.node_tree.nodes if end.type == "GROUP_OUTPUT" and end.is_active_output]
                if not ends:  # zero
                    socket = None
                    break
                self.groups = [*self.groups, node]
                socket = next(inner for inner in ends[0].inputs if inner.identifier == output.identifier)
            elif node.type == "GROUP_INPUT" and self.groups:
                socket = next(outer for outer in self.groups[-1].inputs if outer.identifier == output.identifier)
                self.groups = self.groups[:-1]
            else:
                return node, output
        self.unlinked = socket
        return None

    def follow(self, socket, read, otherwise):
        """`read(node, output)` of what feeds `socket`, or `otherwise(socket)` of the input that has no link in the end."""
        around = self.groups
        found = self.source(socket)
        try:
            return read(*found) if found else otherwise(self.unlinked)
        finally:
            self.groups = around

    def input(self, node, name):
        """An input by its name in this version of Blender, or in an earlier one; None if the node has none."""
        names = (name, RENAMED.get(name))
        return next((socket for name in names for socket in node.inputs if name in (socket.name, socket.identifier) and socket.enabled), None)

    # ----- values

    def value(self, socket):
        """A Constant, or a Texture. What Latent cannot say is its default, and listed. Where a number is wanted, a colour is its luminance."""
        value = self.follow(socket, self.evaluate, default)
        return constant(value.number()) if socket.type == "VALUE" and is_constant(value) else value

    def evaluate(self, node, output):
        try:
            if node.type not in VALUES:
                raise Unknown(f"node {node.bl_label}")
            if self.places is None and node.type in ON_SURFACES:
                raise Unknown("a texture that lies on no surface")
            return VALUES[node.type](self, node, output)
        except Unknown as unknown:
            baked = self.files and self.files.baked(self, node, output)
            if baked:
                return baked
            self.lost(f"{unknown} is replaced by a constant")
            return next((default(socket) for socket in node.inputs if socket.type == "RGBA" and socket.enabled and not socket.is_linked), constant(0.5))

    def of(self, node, name):
        socket = self.input(node, name)
        return self.value(socket) if socket is not None else None

    def constant(self, node, name):
        """Where Latent takes no texture."""
        value = self.of(node, name) or BLACK
        if is_constant(value):
            return value
        self.lost(f"{node.bl_label}: the texture of {name} is replaced by its default")
        return default(self.input(node, name))

    def number(self, node, name):
        return self.constant(node, name).number()

    def result(self, value, clamps):
        if clamps and not is_constant(value) and not value.is_picture:
            self.lost("a mixture of textures is not clamped")
        return clamped(value) if clamps else value

    def mix_rgb(self, node, _):
        kind = getattr(node, "data_type", "RGBA")
        blend, clamps = (node.blend_type, getattr(node, "use_clamp", False) or getattr(node, "clamp_result", False)) if kind == "RGBA" else ("MIX", False)
        if kind not in ("RGBA", "FLOAT") or blend not in BLENDS:
            raise Unknown(f"Mix ({kind.lower()}, {blend.lower()})")
        share, first, second = (self.of(node, name) for name in ("Factor", "A", "B"))
        return self.result(BLENDS[blend](first, second, clamped(share)), clamps)

    def math_node(self, node, _):
        first, second = (self.value(socket) for socket in list(node.inputs)[:2])
        if node.operation == "MULTIPLY":
            return self.result(product(first, second), node.use_clamp)
        if node.operation == "SUBTRACT" and first == WHITE and not is_constant(second):
            return rest(second)
        if node.operation not in MATHS:
            raise Unknown(f"Math ({node.operation.lower()})")
        return self.result(each(MATHS[node.operation], first, second), node.use_clamp)

    def ramp(self, node, output):
        """Between two stops, a mixture. Of a constant, any ramp."""
        shown = lambda color: constant(color[3]) if output.name == "Alpha" else Constant(tuple(color[:3]))  # noqa: E731
        amount, stops = self.of(node, "Factor"), node.color_ramp.elements
        if is_constant(amount):
            return shown(node.color_ramp.evaluate(amount.number()))
        if len(stops) > 1 and ([round(stop.position, 6) for stop in stops] != [0, 1] or node.color_ramp.interpolation != "LINEAR"):
            raise Unknown("Color Ramp with more than two stops, at 0 and 1, of a picture")
        return mix(shown(stops[0].color), shown(stops[-1].color), amount)

    def invert(self, node, _):
        color = self.of(node, "Color")
        if is_constant(color):
            opposite = each(lambda c: 1 - c, color)
        elif color.is_picture and not color.parameters.get("bool invert"):
            opposite = Texture("imagemap", {**color.parameters, "bool invert": True}, of_color=color.of_color)
        else:
            raise Unknown("Invert of a mixture")
        return mix(color, opposite, self.of(node, "Factor"))

    def checker(self, node, output):
        """A square of colour 2 lies at the origin of the plane. Latent has no cubes here."""
        first, second, scale = (self.value(socket) for socket in list(node.inputs)[1:4])
        if output.name != "Color":
            first, second = WHITE, BLACK
        if not is_constant(scale):
            raise Unknown("Checker with a picture as its scale")
        mapping = self.places.relative(self, node.inputs["Vector"], scale.number())
        if self.places.source[0] != "uv":
            raise Unknown("Checker of space (give it a UV map)")
        return Texture("checkerboard", mapping, {"tex1": second, "tex2": first})

    def vertex_color(self, node, output):
        name = node.layer_name if node.type == "VERTEX_COLOR" else node.attribute_name
        if node.type == "ATTRIBUTE" and (node.attribute_type != "GEOMETRY" or output.name not in ("Color", "Fac", "Factor")):
            raise Unknown(f"Attribute {name}")
        if self.places.color not in (None, name):
            raise Unknown(f"colour attribute {name} beside {self.places.color}")
        self.places.color = name
        return Texture("latent:vertexcolor", {"string channel": "alpha"} if output.name == "Alpha" else {})

    def fresnel(self, node, output):
        self.lost(f"{node.bl_label} is the value seen from the front")
        ior = self.number(node, "IOR") if node.type == "FRESNEL" else 1 / (1 - min(self.number(node, "Blend"), 0.999))
        return constant(0.0 if output.name == "Facing" else ((ior - 1) / (ior + 1)) ** 2)

    def light_path(self, _, output):
        self.lost(f"Light Path, {output.name}, is 0, also for the camera")
        return BLACK

    def grey(self, node, output):
        """pbrt makes numbers of the colours of a texture by itself."""
        value = self.of(node, "Color")
        if is_constant(value):
            return constant(value.number())
        if any(link.to_socket.type == "RGBA" for link in output.links):
            raise Unknown("RGB to BW of a picture")
        return value


def default(socket):
    value = getattr(socket, "default_value", 0.0)
    if isinstance(value, (int, float)):
        return constant(value)
    return BLACK if isinstance(value, str) else Constant(tuple(map(float, value))[:3])


def power(a, b):
    """0 where it is no number."""
    try:
        return math.pow(a, b)
    except (ValueError, OverflowError):
        return 0.0


BLENDS = {
    "MIX": mix,
    "MULTIPLY": lambda a, b, t: product(a, mix(WHITE, b, t)),
    **{name: lambda a, b, t, blend=blend: each(lambda x, y, w: x + (blend(x, y) - x) * w, a, b, t) for name, blend in (
        ("ADD", operator.add), ("SUBTRACT", operator.sub), ("SCREEN", lambda x, y: 1 - (1 - y) * (1 - x)), ("DARKEN", min), ("LIGHTEN", max),
        ("DIFFERENCE", lambda x, y: abs(x - y)), ("DIVIDE", lambda x, y: x / y if y else x))},
}

MATHS = {
    "ADD": operator.add, "SUBTRACT": operator.sub, "MINIMUM": min, "MAXIMUM": max, "LESS_THAN": operator.lt, "GREATER_THAN": operator.gt,
    "DIVIDE": lambda a, b: a / b if b else 0.0, "MODULO": lambda a, b: math.fmod(a, b) if b else 0.0, "POWER": power,
    "LOGARITHM": lambda a, b: math.log(a, b) if a > 0 and b > 0 and b != 1 else 0.0, "SQRT": lambda a, _: math.sqrt(max(0.0, a)),
    "ABSOLUTE": lambda a, _: abs(a), "SINE": lambda a, _: math.sin(a), "COSINE": lambda a, _: math.cos(a),
    "FLOOR": lambda a, _: math.floor(a), "FRACT": lambda a, _: a - math.floor(a),
}


def blackbody_rgb(kelvin):
    """Linear Rec. 709 of luminance 1: Planck's law, seen through Gaussian fits of the CIE 1931 observer [WymanSloanShirley13]."""
    nm = np.arange(380.0, 781.0, 5.0)
    power = 1 / (nm**5 * np.expm1(1.4388e7 / (nm * max(kelvin, 200.0))))
    gauss = lambda mean, below, above: np.exp(-0.5 * ((nm - mean) / np.where(nm < mean, below, above)) ** 2)  # noqa: E731
    xyz = np.array([1.056 * gauss(599.8, 37.9, 31.0) + 0.362 * gauss(442.0, 16.0, 26.7) - 0.065 * gauss(501.1, 20.4, 26.2),
                    0.821 * gauss(568.8, 46.9, 40.5) + 0.286 * gauss(530.9, 16.3, 31.1), 1.217 * gauss(437.0, 11.8, 36.0) + 0.681 * gauss(459.0, 26.0, 13.8)]) @ power
    return tuple(np.maximum(0, RGB_FROM_XYZ @ (xyz / xyz[1])).tolist())


VALUES = {
    **dict.fromkeys(("RGB", "VALUE"), lambda graph, node, output: default(output)),
    **dict.fromkeys(("MIX", "MIX_RGB"), Graph.mix_rgb),
    "MATH": Graph.math_node,
    "VALTORGB": Graph.ramp,
    "INVERT": Graph.invert,
    "GAMMA": lambda graph, node, _: each(lambda c, g: power(max(0.0, c), g), graph.of(node, "Color"), graph.of(node, "Gamma")),
    "CLAMP": lambda graph, node, _: each(lambda v, a, b: min(max(v, a), b), *(graph.of(node, name) for name in ("Value", "Min", "Max"))),
    "RGBTOBW": Graph.grey,
    "BLACKBODY": lambda graph, node, _: Constant(blackbody_rgb(graph.number(node, "Temperature"))),
    "TEX_CHECKER": Graph.checker,
    "TEX_IMAGE": picture,
    **dict.fromkeys(("VERTEX_COLOR", "ATTRIBUTE"), Graph.vertex_color),
    **dict.fromkeys(("FRESNEL", "LAYER_WEIGHT"), Graph.fresnel),
    "LIGHT_PATH": Graph.light_path,
}
ON_SURFACES = ("TEX_CHECKER", "TEX_IMAGE", "VERTEX_COLOR", "ATTRIBUTE")
