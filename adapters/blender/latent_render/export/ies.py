"""Photometric profiles (ANSI/IES LM-63): the intensity of a lamp by direction. Needs no Blender."""
import re

import numpy as np

WATTS = 4 * np.pi / 177.83  # a candela in Cycles' unit of lamps: light of D65 has 177.83 lm / W
DOWN, AROUND = (np.arange(512) + 0.5) * np.pi / 512, (np.arange(1024) + 0.5) * np.pi / 512  # of pixels: from -z, and from +x towards +y


def directions():
    """Of the pixels of a picture: unit vectors."""
    down = DOWN[:, None] + 0 * AROUND
    return np.stack([np.sin(down) * np.cos(AROUND), np.sin(down) * np.sin(AROUND), -np.cos(down)], -1)


def read(text):
    """The intensity in candela of a profile, in longitude and latitude as pbrt's goniometric lights have it: rows from -z up, columns from +x
    towards +y. ValueError, IndexError: it is no profile."""
    found = re.search(r"^TILT\s*=\s*(\S+)[^\n]*\n(.*)", text.replace("\r", "\n"), re.M | re.S)
    if not found:
        raise ValueError("has no line TILT=")
    numbers = [float(word) for word in found[2].replace(",", " ").split()]
    if found[1].upper() == "INCLUDE":
        numbers = numbers[2 + 2 * int(numbers[1]) :]
    factor, downs, arounds, kind = numbers[2] * numbers[10] * numbers[11], int(numbers[3]), int(numbers[4]), int(numbers[5])
    angles, values = numbers[13 : 13 + downs + arounds], numbers[13 + downs + arounds :][: downs * arounds]
    if kind != 1:
        raise ValueError("has angles of type A or B")
    if min(downs, arounds) < 1 or len(values) < downs * arounds:
        raise ValueError("ends too early")
    down, around, candela = np.array(angles[:downs]), np.array(angles[downs:]), factor * np.array(values).reshape(arounds, downs)
    if (np.diff(down) <= 0).any() or (np.diff(around) <= 0).any() or not np.isfinite(candela).all():
        raise ValueError("has angles that do not rise, or values that are no numbers")
    turned = (270 - np.degrees(AROUND)) % 360
    # A file of part of the circle means its mirror images too.
    folded = {0: 0 * turned, 90: np.minimum(turned % 180, 180 - turned % 180), 180: np.minimum(turned, 360 - turned)}.get(around[-1], turned)
    rows = np.array([np.interp(np.degrees(DOWN), down, row, 0, 0) for row in candela])
    return np.array([np.interp(folded, around, column) for column in rows.T], np.float32)
