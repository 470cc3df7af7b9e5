"""Where the pictures of a material lie on its surface."""
import numpy as np
from mathutils import Euler, Matrix

from .report import Unknown


class Places:
    """Where the pictures of one material lie. The first one decides which coordinates the mesh gets: a UV map or others, times a matrix.
    The others may be shifted and scaled relative to it, for pbrt can say that, and no more."""

    def __init__(self):
        self.source, self.matrix, self.color = None, None, None
        self.direction = None  # coordinates whose first one the gloss follows

    def settle(self, lost):
        if self.source is None and self.direction:
            self.source, self.matrix = self.direction, np.eye(4)
        if self.direction not in (None, self.source):
            lost("its gloss is stretched along its textures")

    def relative(self, graph, socket, scale):
        """Parameters of a mapping: those of coordinates times `scale`."""
        source, matrix = coordinates(graph, socket)
        return self.moved(source, np.diag([scale, scale, scale, 1.0]) @ matrix)

    def moved(self, source, matrix):
        if self.source is None:
            self.source, self.matrix = source, matrix
        if source != self.source:
            raise Unknown("a texture with other coordinates than the first one of the material")
        if source[0] != "uv":
            if not np.allclose(matrix, self.matrix):
                raise Unknown("a second texture that is mapped otherwise")
            return {}
        after, before = (m[np.ix_([0, 1, 3], [0, 1, 3])] for m in (matrix, self.matrix))  # from u and v to u and v
        change = after @ np.linalg.inv(before) if abs(np.linalg.det(before)) > 1e-12 else np.eye(3)
        if max(abs(change[0, 1]), abs(change[1, 0])) > 1e-6:
            raise Unknown("a texture that is rotated relative to the first one of the material")
        wanted = {"float uscale": change[0, 0], "float vscale": change[1, 1], "float udelta": change[0, 2], "float vdelta": change[1, 2]}
        return {key: float(number) for key, number in wanted.items() if abs(number - ("scale" in key)) > 1e-9}


def coordinates(graph, socket):
    """("uv", name of the map or ""), ("generated",) or ("object",), and the matrix of Mapping nodes on the way."""

    def linked(node, output):
        if node.type == "MAPPING":
            source, matrix = coordinates(graph, node.inputs["Vector"])
            return source, mapping(node) @ matrix
        if node.type in ("UVMAP", "ATTRIBUTE"):
            return ("uv", node.uv_map if node.type == "UVMAP" else node.attribute_name), np.eye(4)
        if node.type == "TEX_COORD" and output.name in SOURCES and not (output.name == "Object" and node.object):
            return SOURCES[output.name], np.eye(4)
        raise Unknown(f"texture coordinates of {node.bl_label} ({output.name})")

    return graph.follow(socket, linked, lambda _: (SOURCES["UV" if socket.node.type == "TEX_IMAGE" else "Generated"], np.eye(4)))


SOURCES = {"UV": ("uv", ""), "Generated": ("generated",), "Object": ("object",)}


def mapping(node):
    values = {socket.name: socket.default_value for socket in node.inputs if socket.enabled}
    linked = [socket.name for socket in node.inputs if socket.is_linked and socket.name != "Vector"]
    if linked or node.vector_type == "NORMAL":
        raise Unknown(f"Mapping with a linked {linked[0]}" if linked else "Mapping of normals")
    place = Matrix.Translation(values.get("Location", (0, 0, 0))) @ Euler(values["Rotation"]).to_matrix().to_4x4() @ Matrix.Diagonal((*values["Scale"], 1.0))
    return np.array(place.inverted_safe() if node.vector_type == "TEXTURE" else place)
