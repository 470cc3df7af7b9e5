"""The world: a colour, a picture in longitude and latitude, or anything else, which Cycles bakes to such a picture. There always is one, if
only a black one: the renderer refuses a scene that has no light at all."""
import numpy as np

from .nodes import Graph, all_nodes
from .pbrt import directive, matrix
from .pictures import ENCODINGS
from .places import coordinates
from .report import Unknown

# Blender's longitude runs the other way round, and begins at the other side, than pbrt's.
FLIPPED = np.diag([-1.0, 1.0, 1.0, 1.0])


def export(world, files, portals, report, bake):
    """Directives: one light, or one for each portal. `bake(world)`: the path of a picture of it."""
    radiance, scale, place = light(world, files, report, bake) or ({"rgb L": [0.0, 0.0, 0.0]}, 1.0, np.eye(4))
    parameters = {**radiance, "float scale": float(scale), "string name": "World"}
    through = [{"point3 portal": [float(c) for corner in corners for c in corner]} for corners in portals]
    return ["AttributeBegin", matrix(place), *(directive("LightSource", "infinite", **parameters, **portal) for portal in through or [{}]), "AttributeEnd"]


def light(world, files, report, bake):
    """What the radiance is, its scale and its place; None: there is none."""
    if world is None:
        return None
    lost = report.of(f"world {world.name}")
    report.settings("world", world)
    if not world.node_tree or not getattr(world, "use_nodes", True):
        return {"rgb L": list(world.color)}, 1.0, np.eye(4)
    graph, nodes = Graph(world.node_tree, lost), list(all_nodes(world.node_tree))
    output = graph.output("OUTPUT_WORLD")
    if output and output.inputs["Volume"].is_linked:
        lost("the volume of a world is left out")
    found = output and graph.source(output.inputs["Surface"])
    if not found:
        return None
    if any(node.type == "LIGHT_PATH" and any(made.is_linked for made in node.outputs) for node in nodes):
        lost("all of its Light Path is 0: the camera, too, sees what lights the scene")
    try:
        return simple(found[0], graph, files)
    except Unknown:
        for image in {node.image for node in nodes if getattr(node, "image", None)}:
            if not image.size[0]:
                lost(f"the file of image {image.name} is missing")
        if any(node.type == "TEX_SKY" and getattr(node, "sun_disc", False) for node in nodes):
            lost("the sun of its Sky Texture is as coarse as the baked picture; a Sun lamp is exact")
    path = bake(world)
    if path is None:
        lost("is black, for its nodes could not be baked")
    return path and ({"string filename": path}, 1.0, FLIPPED)


def simple(node, graph, files):
    """A Background of a colour or a picture; raises Unknown otherwise."""
    amount = graph.source(node.inputs[0]) if node.type == "MIX_SHADER" else None
    if amount and amount[0].type == "LIGHT_PATH":
        lit = graph.source(node.inputs[1])
        return lit and simple(lit[0], graph, files)
    if node.type != "BACKGROUND" or node.inputs["Strength"].is_linked:
        raise Unknown("world")
    strength, found = max(0.0, node.inputs["Strength"].default_value), graph.source(node.inputs["Color"])
    if found is None or found[0].type in ("RGB", "BLACKBODY"):
        return {"rgb L": [max(0.0, c) for c in graph.constant(node, "Color").rgb]}, strength, np.eye(4)
    picture = found[0]
    image = getattr(picture, "image", None)
    is_known = image and image.source in ("FILE", "GENERATED") and (image.is_float or image.colorspace_settings.name in ENCODINGS)
    if picture.type != "TEX_ENVIRONMENT" or picture.projection != "EQUIRECTANGULAR" or not is_known:
        raise Unknown("world")
    source, turn = coordinates(graph, picture.inputs["Vector"])
    if source != ("generated",) or turn[:3, 3].any() or not np.allclose(turn[:3, :3] @ turn[:3, :3].T, np.eye(3), atol=1e-5):
        raise Unknown("world")
    return {"string filename": files.sky(image)}, strength, np.linalg.inv(turn) @ FLIPPED
