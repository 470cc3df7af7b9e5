"""The strips of a picture become one: tiled OpenEXR files, as latent-develop writes them, whose tiles are copied as they are."""
import os
import re
import struct

from latent_farm import files
from latent_farm.errors import Failure

MAGIC, TILED = 20000630, 0x200


def without_crop(recipe):
    """The recipe of the whole picture; docs/recipes.md."""
    recipe = re.sub(rb'"crop":"[^"]*",|,?"crop":"[^"]*"', b"", recipe, count=1)
    return recipe.replace(b',"develop":{}', b"")


class Strip:
    """The header of a file, and where its tiles are."""

    def __init__(self, path):
        self.path = path
        try:
            self.file = files.opened(path)
            self.size = os.fstat(self.file.fileno()).st_size
            self._read_header()
        except FileNotFoundError:
            raise Failure(f"{path}: no such file") from None
        except OSError as error:
            raise Failure(f"{path}: cannot be read: {error.strerror}") from None
        except (struct.error, ValueError, KeyError):
            raise Failure(f"{path}: is no strip that latent-develop wrote") from None

    def _read_header(self):
        magic, version = self._unpack("<ii")
        if magic != MAGIC or version & ~0xff != TILED:
            raise ValueError
        self.version, self.attributes = version, {}
        while name := self._text():
            kind, (size,) = self._text(), self._unpack("<i")
            self.attributes[name] = kind, self._bytes(size)
        self.window = struct.unpack("<4i", self.attributes.pop(b"dataWindow")[1])
        if b"latentRecipe" in self.attributes:
            kind, recipe = self.attributes[b"latentRecipe"]
            self.attributes[b"latentRecipe"] = kind, without_crop(recipe)
        width, height, mode = struct.unpack("<IIB", self.attributes[b"tiles"][1])
        if mode & 0xf or not width or not height:
            raise Failure(f"{self.path}: has smaller levels; strips have none")
        x0, y0, x1, y1 = self.window
        self.tile_height = height
        self.across, self.down = -(-(x1 - x0 + 1) // width), -(-(y1 - y0 + 1) // height)
        if not 0 < self.across * self.down <= self.size // 8:
            raise ValueError
        self.offsets = self._unpack(f"<{self.across * self.down}Q")

    def _bytes(self, count):
        data = self.file.read(count) if 0 <= count <= self.size else b""
        if len(data) != count:
            raise ValueError
        return data

    def _unpack(self, form):
        return struct.unpack(form, self._bytes(struct.calcsize(form)))

    def _text(self):
        text = b""
        while (byte := self._bytes(1)) != b"\0":
            text += byte
            if len(text) > 255:
                raise ValueError
        return text

    def tile(self, index):
        """Its place, and the bytes that follow."""
        try:
            self.file.seek(self.offsets[index])
            x, y, level_x, level_y, size = self._unpack("<5i")
            data = self._bytes(size)
        except (struct.error, ValueError, OverflowError, OSError):
            x = y = level_x = level_y = -1
        if (x, y, level_x, level_y) != (index % self.across, index // self.across, 0, 0):
            raise Failure(f"{self.path}: tile {index} is missing or damaged; develop the strip again")
        return data


def check(strips):
    """That each goes on where the one before ends, with whole tiles."""
    for before, strip in zip(strips, strips[1:]):
        if strip.attributes != before.attributes or strip.version != before.version or \
                (strip.window[0], strip.window[2]) != (before.window[0], before.window[2]):
            raise Failure(f"{strip.path}: is a strip of another picture than {before.path}")
        if strip.window[1] != before.window[3] + 1:
            raise Failure(f"{strip.path}: begins at row {strip.window[1]}, but {before.path} ends at row {before.window[3]}")
        if (strip.window[1] - strips[0].window[1]) % strip.tile_height:
            raise Failure(f"{strip.path}: begins at row {strip.window[1]}, inside a tile of the picture")


def header_of(strips):
    first, window = strips[0], (*strips[0].window[:3], strips[-1].window[3])
    attributes = {**first.attributes, b"dataWindow": (b"box2i", struct.pack("<4i", *window))}
    text = b"".join(name + b"\0" + kind + b"\0" + struct.pack("<i", len(value)) + value
                    for name, (kind, value) in sorted(attributes.items()))
    return struct.pack("<ii", MAGIC, first.version) + text + b"\0"


def write(strips, file):
    header = header_of(strips)
    offsets = []
    file.write(header)
    file.write(bytes(8 * sum(len(strip.offsets) for strip in strips)))
    row = 0  # of tiles
    for strip in strips:
        for index in range(len(strip.offsets)):
            data = strip.tile(index)
            offsets.append(file.tell())
            file.write(struct.pack("<5i", index % strip.across, row + index // strip.across, 0, 0, len(data)))
            file.write(data)
        row += strip.down
    file.seek(len(header))
    file.write(struct.pack(f"<{len(offsets)}Q", *offsets))


def join(paths, output, replace):
    if output.exists() and not replace:
        raise Failure(f"{output}: exists; choose another name, or use --force")
    strips = sorted((Strip(path) for path in paths), key=lambda strip: strip.window[1])
    check(strips)
    with files.written(output) as file:
        write(strips, file)
