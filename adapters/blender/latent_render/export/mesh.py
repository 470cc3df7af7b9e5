"""Meshes: from Blender's polygons to PLY files, one for each material."""
import numpy as np

from . import ply


def read(collection, name, width, kind=np.float32):
    """An attribute of all elements of a collection: (count, width), or (count,) for a width of 1."""
    data = np.empty(len(collection) * width, kind)
    collection.foreach_get(name, data)
    return data.reshape(-1, width) if width > 1 else data


# Attributes that may be colours: where their values are, and how many.
COLORS = {"FLOAT_COLOR": ("color", 4), "BYTE_COLOR": ("color", 4), "FLOAT_VECTOR": ("vector", 3), "FLOAT": ("value", 1), "INT": ("value", 1, np.int32)}


class Corners:
    """The corners of a mesh's triangles, with what lies there. Blender's normals are in another place since 4.1."""

    def __init__(self, mesh):
        self.mesh = mesh
        self.normals = self.read_normals()
        mesh.calc_loop_triangles()
        self.triangles = read(mesh.loop_triangles, "vertices", 3, np.int32)
        self.loops = read(mesh.loop_triangles, "loops", 3, np.int32)
        self.materials = read(mesh.loop_triangles, "material_index", 1, np.int32)
        self.positions = read(mesh.vertices, "co", 3)

    def read_normals(self):
        """(values, whether they belong to corners), or None of flat faces."""
        mesh = self.mesh
        if hasattr(mesh, "normals_domain"):
            domain, corners, name = mesh.normals_domain, mesh.corner_normals, "vector"
        else:
            smooth = read(mesh.polygons, "use_smooth", 1, bool)
            domain = "CORNER" if mesh.use_auto_smooth or smooth.any() != smooth.all() else "POINT" if smooth.any() else "FACE"
            if domain == "CORNER":
                mesh.calc_normals_split()
            corners, name = mesh.loops, "normal"
        if domain == "POINT":
            return read(mesh.vertices, "normal", 3), False
        if domain == "CORNER" and name == "vector" and "sharp_edge" not in mesh.attributes and not mesh.has_custom_normals:
            # Only some faces are flat: as in 3.4, Cycles takes the normals of vertices for the others.
            of_face = self.of_face()
            smooth, at = read(mesh.polygons, "use_smooth", 1, bool)[of_face, None], read(mesh.loops, "vertex_index", 1, np.int32)
            return np.where(smooth, read(mesh.vertices, "normal", 3)[at], read(mesh.polygons, "normal", 3)[of_face]), True
        return (read(corners, name, 3), True) if domain == "CORNER" else None

    def colors(self, name):
        """(values, whether they belong to corners) of an attribute. Numbers are grey."""
        colors = self.mesh.color_attributes
        found = self.mesh.attributes.get(name) if name else (colors[colors.render_color_index] if len(colors) else None)
        if found is None or found.data_type not in COLORS or found.domain == "EDGE":
            return None
        values = read(found.data, *COLORS[found.data_type]).reshape(len(found.data), -1)
        values = np.repeat(values, 3, 1) if values.shape[1] == 1 else values[:, :3]
        return (values[self.of_face()], True) if found.domain == "FACE" else (values, found.domain == "CORNER")

    def of_face(self):
        """The face of each corner of the polygons."""
        return np.repeat(np.arange(len(self.mesh.polygons)), read(self.mesh.polygons, "loop_total", 1, np.int32))

    def local(self, points):
        """In texture space: from -1 to 1 over the box of the mesh."""
        return (points - np.array(self.mesh.texspace_location)) / np.maximum(np.array(self.mesh.texspace_size), 1e-9)

    def radial(self, axis, lost):
        """Of each corner: turns about the axis through the middle, and the height or, where a face lies across the axis, the distance.
        The turns of a face do not jump, and those of a corner on the axis are those of its face."""
        mesh, of_face, turned = self.mesh, self.of_face(), lambda points: np.roll(points, 2 - "XYZ".index(axis), 1)
        at = turned(self.local(self.positions))[read(mesh.loops, "vertex_index", 1, np.int32)]
        faces = turned(self.local(read(mesh.polygons, "center", 3)))[of_face]
        turns = np.arctan2(faces[:, 1], faces[:, 0]) / (2 * np.pi)
        distance = np.hypot(at[:, 0], at[:, 1])
        ahead = np.where(distance > 1e-4, (np.arctan2(at[:, 1], at[:, 0]) / (2 * np.pi) - turns + 0.5) % 1 - 0.5, 0)
        if (abs(ahead) > 0.25).any():
            lost("the radial direction of its gloss needs smaller faces around the axis")
        across = abs(turned(read(mesh.polygons, "normal", 3))[of_face, 2]) > 0.7
        return np.c_[turns + ahead, np.where(across, distance, at[:, 2])].astype(np.float32)

    def place(self, places, lost):
        """Texture coordinates as `places` asks: (values, whether they belong to corners), or None."""
        if places.source is None:
            return None
        kind, *name = places.source
        if kind == "radial":
            return self.radial(*name, lost), True
        points = self.positions
        if kind == "uv":
            layers = self.mesh.uv_layers
            layer = layers.get(name[0]) if name[0] else next((layer for layer in layers if layer.active_render), layers.active)
            if layer is None:
                lost(f"UV map {name[0] or '(active)'} is missing")
                return None
            points = np.pad(read(layer.data, "uv", 2), ((0, 0), (0, 1)))
        elif kind == "generated":
            points = (self.local(self.positions) + 1) / 2
        return (np.c_[points, np.ones(len(points))] @ places.matrix.T)[:, :2].astype(np.float32), kind == "uv"


def export(corners, places_of_slot, folder, lost):
    """Files in `folder` for the materials that are used: [(slot, name)]. `places_of_slot`: texture coordinates that each wants."""
    written = []
    slots = np.clip(corners.materials, 0, len(places_of_slot) - 1)
    for slot in np.unique(slots):
        at, loop = (numbers[slots == slot].ravel() for numbers in (corners.triangles, corners.loops))
        places = places_of_slot[slot]
        columns = {"positions": (corners.positions, False), "normals": corners.normals, "uvs": corners.place(places, lost),
                   "colors": None if places.color is None else corners.colors(places.color)}
        if places.color is not None and columns["colors"] is None:
            lost(f"attribute {places.color} is missing")
        columns = {name: column for name, column in columns.items() if column is not None}
        broken = [name for name, (data, _) in columns.items() if not np.isfinite(data).all()]
        if broken:
            lost(f"is left out: some of its {' and '.join(broken)} are no numbers")
            return []
        stands, vertex = ply.shared([at.astype(np.uint32), *(data[loop] for data, of_corners in columns.values() if of_corners)])
        kept = {name: data[(loop if of_corners else at)[stands]] for name, (data, of_corners) in columns.items()}
        written.append((int(slot), ply.write(folder, triangles=vertex.reshape(-1, 3), **kept)))
    return written
