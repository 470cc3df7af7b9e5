"""Image textures: their files, and where they lie on a surface."""
import hashlib
import os
import struct
import zlib
from dataclasses import dataclass

import numpy as np

from .report import Unknown

ENCODINGS = {"sRGB": "sRGB", "Non-Color": "linear", "Raw": "linear", "Generic Data": "linear", "Linear": "linear", "Linear Rec.709": "linear"}
WRAPS = {"REPEAT": "repeat", "EXTEND": "clamp", "CLIP": "black"}
EXTENSIONS = {"PNG": ".png", "JPEG": ".jpg", "OPEN_EXR": ".exr", "OPEN_EXR_MULTILAYER": ".exr", "HDR": ".hdr", "TIFF": ".tif", "TARGA": ".tga",
              "TARGA_RAW": ".tga", "BMP": ".bmp", "WEBP": ".webp"}
LUMINANCE = (0.2126, 0.7152, 0.0722)


@dataclass(frozen=True)
class Constant:
    rgb: tuple

    def number(self):
        """A colour as a number, as Blender has it: its luminance."""
        return self.rgb[0] if len(set(self.rgb)) == 1 else sum(c * w for c, w in zip(self.rgb, LUMINANCE))


@dataclass
class Picture:
    parameters: dict  # of imagemap
    of_color: bool = True

    @property
    def is_moved(self):
        """Whether it has a place of its own."""
        return any(name in key for key in self.parameters for name in ("uscale", "vscale", "udelta", "vdelta"))


class Files:
    """The pictures of a job. Those that lie on the disk stay there; packed and generated ones become files in `folder`."""

    def __init__(self, folder):
        self.folder, self.known, self.wanted, self.contents = folder, {}, [], {}  # contents of files of others, which may change under their names

    def baked(self, graph, node, output):
        """What Cycles has baked of a node, if it has; otherwise, it may be wanted."""
        from .. import baking

        if graph.groups or graph.material is None:
            return None
        path = baking.path_of(self.folder, graph.material, node.name, output.identifier)
        if not os.path.exists(path):
            self.wanted.append((graph.material.name, node.name, output.identifier))
            return None
        return Picture({"string filename": path, **graph.places.moved(("uv", ""), np.eye(4))})

    def path(self, image):
        if image.name_full not in self.known:
            self.known[image.name_full] = self.file(image)
        return self.known[image.name_full]

    def file(self, image):
        import bpy

        if image.source in ("TILED", "MOVIE", "SEQUENCE"):
            raise Unknown(f"image {image.name} ({image.source.lower()})")
        packed, space = image.packed_file, image.colorspace_settings.name
        disk = os.path.realpath(bpy.path.abspath(image.filepath, library=image.library)) if image.filepath else ""
        if image.source == "FILE" and not (packed or image.is_dirty or os.path.isfile(disk)):
            raise Unknown(f"image {image.name}, whose file is missing")
        if image.source != "FILE" or image.is_dirty or image.is_float and ENCODINGS.get(space) != "linear":
            return self.drawn(image, pixels(image)[..., :3])
        if packed:
            return self.written(bytes(packed.data), EXTENSIONS.get(image.file_format, ".png"))
        with open(disk, "rb") as file:
            self.contents[disk] = hashlib.blake2b(file.read(), digest_size=8).hexdigest()
        return disk

    def sky(self, image):
        """A picture of all directions. Cycles interpolates between texels, and lights of Latent do not: few texels become many."""
        rows = pixels(image)[..., :3]
        if not image.is_float and ENCODINGS.get(image.colorspace_settings.name) == "sRGB":
            rows = np.where(rows > 0.04045, ((rows + 0.055) / 1.055) ** 2.4, rows / 12.92)
        width = max(4096, rows.shape[1])
        for axis, size in ((0, width // 2), (1, width)):
            at = (np.arange(size) + 0.5) * rows.shape[axis] / size - 0.5
            below = np.floor(at).astype(int)
            share = (at - below).astype(np.float32).reshape((-1, 1, 1) if axis == 0 else (-1, 1))
            rows = rows.take(below, axis, mode="wrap") * (1 - share) + rows.take(below + 1, axis, mode="wrap") * share
        return self.written(pfm(rows), ".pfm")

    def written(self, data, extension):
        """The path of a file with this content."""
        os.makedirs(self.folder, exist_ok=True)
        path = os.path.join(self.folder, hashlib.blake2b(data, digest_size=12).hexdigest() + extension)
        if not os.path.exists(path):
            with open(path + ".unfinished", "wb") as file:
                file.write(data)
            os.replace(path + ".unfinished", path)
        return path

    def drawn(self, image, rows):
        return self.written(pfm(rows), ".pfm") if image.is_float else self.written(png(rows), ".png")


def pixels(image):
    """Red, green, blue and alpha in rows, which run upwards. Bytes are numbers from 0 to 1, and encoded."""
    if not image.has_data and not image.pixels:
        raise Unknown(f"image {image.name}, which is empty")
    values = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(values)
    rows = values.reshape(image.size[1], image.size[0], -1)
    if rows.shape[2] < 3:
        rows = np.repeat(rows[..., :1], 3, 2)
    return rows if rows.shape[2] == 4 else np.concatenate([rows, np.ones_like(rows[..., :1])], 2)


# Blender's own writers encode colours, and change its data while it renders.


def pfm(rows):
    """Values as they are."""
    rgb = np.repeat(rows, 3, 2) if rows.shape[2] == 1 else rows
    return b"PF\n%d %d\n-1.0\n" % (rows.shape[1], rows.shape[0]) + np.ascontiguousarray(rgb, "<f4").tobytes()


def png(rows):
    """Values from 0 to 1 as bytes."""
    height, width, channels = rows.shape
    lines = np.zeros((height, 1 + width * channels), np.uint8)
    lines[:, 1:] = np.round(255 * np.clip(rows[::-1], 0, 1)).astype(np.uint8).reshape(height, -1)

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    head = struct.pack(">IIBBBBB", width, height, 8, {1: 0, 3: 2}[channels], 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(lines.tobytes(), 1)) + chunk(b"IEND", b"")


def picture(graph, node, output):
    image = node.image
    if image is None:
        raise Unknown("an Image Texture without an image")
    if node.projection != "FLAT":
        raise Unknown(f"an Image Texture with {node.projection.lower()} projection")
    place = graph.places.relative  # there is none of a lamp
    path, space = graph.files.path(image), image.colorspace_settings.name
    if output.name == "Alpha":
        alpha, space = pixels(image)[..., 3:], "Raw"
        if alpha.min() == 1 and node.extension != "CLIP":
            return Constant((1.0, 1.0, 1.0))
        path = graph.files.drawn(image, alpha)
    if space not in ENCODINGS and not image.is_float:
        graph.lost(f"image {image.name}: its colour space {space} is read as sRGB")
    parameters = {"string filename": path, **place(graph, node.inputs["Vector"], 1.0)}
    if not image.is_float:
        parameters["string encoding"] = ENCODINGS.get(space, "sRGB")
    if node.extension not in WRAPS:
        graph.lost(f"image {image.name}: extension {node.extension.lower()} is repeat")
    parameters["string wrap"] = WRAPS.get(node.extension, "repeat")
    parameters["string filter"] = "point" if node.interpolation == "Closest" else "bilinear"
    return Picture(parameters, output.name == "Color")


class Places:
    """Where the pictures of one material lie. The first one decides which coordinates the mesh gets: a UV map or others, times a matrix.
    The others may be shifted and scaled relative to it, for pbrt can say that, and no more."""

    def __init__(self):
        self.source, self.matrix, self.color = None, None, None
        self.direction = None  # coordinates whose first one the gloss follows

    def need_color(self, name):
        if self.color not in (None, name):
            raise Unknown(f"colour attribute {name} beside {self.color}")
        self.color = name

    def settle(self, lost):
        """Once all nodes are read."""
        if self.source is None and self.direction:
            self.source, self.matrix = self.direction, np.eye(4)
        if self.direction not in (None, self.source):
            lost("its gloss is stretched along its textures")

    def relative(self, graph, socket, scale):
        """Parameters of a mapping: those of coordinates times `scale`."""
        source, matrix = self.coordinates(graph, socket)
        return self.moved(source, np.diag([scale, scale, scale, 1.0]) @ matrix)

    def moved(self, source, matrix):
        if self.source is None:
            self.source, self.matrix = source, matrix
        if source != self.source:
            raise Unknown("a texture with other coordinates than the first one of the material")
        flat = lambda m: m[np.ix_([0, 1, 3], [0, 1, 3])]  # noqa: E731  from u and v to u and v
        if source[0] != "uv" and not np.allclose(matrix, self.matrix):
            raise Unknown("a second texture that is mapped otherwise")
        if source[0] != "uv":
            return {}
        change = flat(matrix) @ np.linalg.inv(flat(self.matrix)) if abs(np.linalg.det(flat(self.matrix))) > 1e-12 else np.eye(3)
        if abs(change[0, 1]) > 1e-6 or abs(change[1, 0]) > 1e-6:
            raise Unknown("a texture that is rotated relative to the first one of the material")
        wanted = {"float uscale": change[0, 0], "float vscale": change[1, 1], "float udelta": change[0, 2], "float vdelta": change[1, 2]}
        return {key: float(number) for key, number in wanted.items() if abs(number - ("scale" in key)) > 1e-9}

    def coordinates(self, graph, socket):
        """("uv", name of the map or ""), ("generated",) or ("object",), and the matrix of Mapping nodes on the way."""

        def linked(node, output):
            if node.type == "MAPPING":
                source, matrix = self.coordinates(graph, node.inputs["Vector"])
                return source, mapping(graph, node) @ matrix
            if node.type == "UVMAP":
                return ("uv", node.uv_map), np.eye(4)
            if node.type == "TEX_COORD" and output.name in ("UV", "Generated", "Object") and not (output.name == "Object" and node.object):
                return {"UV": ("uv", ""), "Generated": ("generated",), "Object": ("object",)}[output.name], np.eye(4)
            if node.type == "ATTRIBUTE":
                return ("uv", node.attribute_name), np.eye(4)
            raise Unknown(f"texture coordinates of {node.bl_label} ({output.name})")

        is_picture = socket.node.type == "TEX_IMAGE"
        return graph.follow(socket, linked, lambda _: (("uv", "") if is_picture else ("generated",), np.eye(4)))


def mapping(graph, node):
    """The matrix of a Mapping node."""
    from mathutils import Euler, Matrix

    def vector(name):
        socket = node.inputs.get(name)
        if socket is None:
            return (0.0, 0.0, 0.0)
        if socket.is_linked:
            raise Unknown(f"Mapping with a linked {name}")
        return tuple(socket.default_value)

    location, scale = Matrix.Translation(vector("Location")), Matrix.Diagonal((*vector("Scale"), 1.0))
    turn = Euler(vector("Rotation")).to_matrix().to_4x4()
    kinds = {"POINT": lambda: location @ turn @ scale, "TEXTURE": lambda: (location @ turn @ scale).inverted_safe(), "VECTOR": lambda: turn @ scale}
    if node.vector_type not in kinds:
        raise Unknown("Mapping of normals")
    return np.array(kinds[node.vector_type]())
