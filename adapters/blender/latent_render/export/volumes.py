"""What fills a closed surface. Only constants: pbrt's homogeneous medium."""
from .nodes import is_constant


def medium(document, output, graph):
    socket = output.inputs["Volume"]
    if not socket.is_linked:
        return None
    return graph.follow(socket, lambda node, _: of_node(document, graph, node), lambda _: None)


def of_node(document, graph, node):
    if node.type not in MEDIA:
        graph.lost(f"volume {node.bl_label} is left out")
        return None
    scatter, absorb, emit, g = MEDIA[node.type](graph, node)
    parameters = {"rgb sigma_s": list(scatter), "rgb sigma_a": list(absorb), "float g": g}
    if emit and max(emit) > 0:
        # pbrt's media emit sigma_a Le; Blender's emit, whatever they absorb.
        if min(absorb) <= 0:
            graph.lost("emission of a volume that absorbs nothing is left out")
        else:
            parameters["rgb Le"] = [e / a for e, a in zip(emit, absorb)]
    return document.medium("homogeneous", parameters)


def color(graph, node, name):
    value = graph.of(node, name)
    if not is_constant(value):
        graph.lost(f"the texture of {name} of a volume is grey")
        return (0.5, 0.5, 0.5)
    return value.rgb


def absorption(graph, node):
    density = graph.number(node, "Density")
    return (0.0, 0.0, 0.0), [density * (1 - c) for c in color(graph, node, "Color")], None, 0.0


def scattering(graph, node):
    density = graph.number(node, "Density")
    return [density * c for c in color(graph, node, "Color")], (0.0, 0.0, 0.0), None, graph.number(node, "Anisotropy")


def principled(graph, node):
    """Cycles' coefficients: what is not scattered is absorbed, but for the square root of the absorption colour."""
    density = graph.number(node, "Density")
    tint, absorbed = color(graph, node, "Color"), color(graph, node, "Absorption Color")
    scatter = [density * c for c in tint]
    absorb = [density * max(0.0, 1 - c) * max(0.0, 1 - max(0.0, a) ** 0.5) for c, a in zip(tint, absorbed)]
    if graph.number(node, "Blackbody Intensity") > 0:
        graph.lost("the blackbody emission of a volume is left out")
    strength = graph.number(node, "Emission Strength")
    return scatter, absorb, [strength * c for c in color(graph, node, "Emission Color")], graph.number(node, "Anisotropy")


MEDIA = {"VOLUME_ABSORPTION": absorption, "VOLUME_SCATTER": scattering, "PRINCIPLED_VOLUME": principled}
