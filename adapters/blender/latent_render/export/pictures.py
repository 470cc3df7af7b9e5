"""Pictures: their files, and what an image texture is."""
import hashlib
import os

import numpy as np

from .report import Unknown
from .values import WHITE, Texture

ENCODINGS = {"sRGB": "sRGB", "Non-Color": "linear", "Raw": "linear", "Generic Data": "linear", "Linear": "linear", "Linear Rec.709": "linear"}
# Of each byte of sRGB, for numpy's powers differ with the place of their numbers in memory, and another picture would be another job.
DECODED = np.float32([b / 255 / 12.92 if b <= 10 else ((b / 255 + 0.055) / 1.055) ** 2.4 for b in range(256)])
WRAPS = {"REPEAT": "repeat", "EXTEND": "clamp", "CLIP": "black"}


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
        return Texture("imagemap", {"string filename": path, **graph.places.moved(("uv", ""), np.eye(4))})

    def path(self, image):
        if image.name_full not in self.known:
            self.known[image.name_full] = self.file(image)
        return self.known[image.name_full]

    def file(self, image):
        if image.source in ("TILED", "MOVIE", "SEQUENCE"):
            raise Unknown(f"image {image.name} ({image.source.lower()})")
        disk = os.path.realpath(image.filepath_from_user())
        if image.source == "FILE" and not (image.packed_file or image.is_dirty or os.path.isfile(disk)):
            raise Unknown(f"image {image.name}, whose file is missing")
        if image.source != "FILE" or image.is_dirty or image.is_float and ENCODINGS.get(image.colorspace_settings.name) != "linear":
            return self.drawn(light(image))
        if image.packed_file:
            return self.written(bytes(image.packed_file.data), os.path.splitext(disk)[1] or (".exr" if image.is_float else ".png"))
        with open(disk, "rb") as file:
            self.contents[disk] = hashlib.blake2b(file.read(), digest_size=8).hexdigest()
        return disk

    def sky(self, image):
        """A picture of all directions. Cycles interpolates between texels, and lights of Latent do not: few texels become many."""
        rows = light(image)
        width = max(4096, rows.shape[1])
        for axis, size in ((0, width // 2), (1, width)):
            at = (np.arange(size) + 0.5) * rows.shape[axis] / size - 0.5
            below = np.floor(at).astype(int)
            share = (at - below).astype(np.float32).reshape((-1, 1, 1) if axis == 0 else (-1, 1))
            rows = rows.take(below, axis, mode="wrap") * (1 - share) + rows.take(below + 1, axis, mode="wrap") * share
        return self.drawn(rows)

    def drawn(self, rows):
        """The path of a picture of these values (PFM). Blender's own writers encode colours, and change its data while it renders."""
        rgb = np.ascontiguousarray(np.broadcast_to(rows, (*rows.shape[:2], 3)), "<f4")
        return self.written(b"PF\n%d %d\n-1.0\n" % (rows.shape[1], rows.shape[0]) + rgb.tobytes(), ".pfm")

    def written(self, data, extension):
        os.makedirs(self.folder, exist_ok=True)
        path = os.path.join(self.folder, hashlib.blake2b(data, digest_size=12).hexdigest() + extension)
        if not os.path.exists(path):
            with open(path + ".unfinished", "wb") as file:
                file.write(data)
            os.replace(path + ".unfinished", path)
        return path


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


def light(image):
    """Red, green and blue in rows, decoded."""
    rows = pixels(image)[..., :3]
    if image.is_float or ENCODINGS.get(image.colorspace_settings.name) == "linear":
        return rows
    return DECODED[np.round(255 * rows).astype(int)]


def picture(graph, node, output):
    image = node.image
    if image is None:
        raise Unknown("an Image Texture without an image")
    if node.projection != "FLAT":
        raise Unknown(f"an Image Texture with {node.projection.lower()} projection")
    path, space = graph.files.path(image), image.colorspace_settings.name
    if output.name == "Alpha":
        alpha = pixels(image)[..., 3:]
        if alpha.min() == 1 and node.extension != "CLIP":
            return WHITE
        path, space = graph.files.drawn(alpha), "Raw"
    if space not in ENCODINGS and not image.is_float:
        graph.lost(f"image {image.name}: its colour space {space} is read as sRGB")
    if node.extension not in WRAPS:
        graph.lost(f"image {image.name}: extension {node.extension.lower()} is repeat")
    encoding = {} if image.is_float or path.endswith(".pfm") else {"string encoding": ENCODINGS.get(space, "sRGB")}
    return Texture("imagemap", {"string filename": path, **encoding, **graph.places.relative(graph, node.inputs["Vector"], 1.0),
                                "string wrap": WRAPS.get(node.extension, "repeat"), "string filter": "point" if node.interpolation == "Closest" else "bilinear"},
                   of_color=output.name == "Color")
