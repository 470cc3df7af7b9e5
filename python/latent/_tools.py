"""latent-merge and latent-develop as functions."""

from __future__ import annotations

import warnings
from typing import Any, Optional, Sequence, Union

import numpy as np

from . import _arguments, _latent
from ._arguments import Path

_LEVELS = ["stored", "quick", "full"]  # as latent_merge_options.verify counts them
_MOST_THREADS = 4096


class LatentWarning(UserWarning):
    """Something was left out, or there is advice."""


def merge(
    *paths: Path,
    output: Path,
    replace: bool = False,
    require: Optional[tuple[int, int]] = None,
    verify: str = "stored",
    compact: bool = False,
    skip_duplicates: bool = False,
    keep_going: bool = False,
    job: Optional[str] = None,
    memory: Optional[int] = None,
    threads: int = 0,
) -> dict[str, Any]:
    """Joins files, folders and unfinished parts of one job into one file, as latent-merge does.

    require: samples (first, end) that must be present. verify: how the copies are checked, "quick", "stored" or "full". compact:
    rewrite many small runs as a few large ones. job: 32 hexadecimal digits, if folders hold several. memory: bytes; default: 1 GiB, at
    most half of what may be used. threads: at most; 0: all. Returns counts (samples, files, runs_in, runs_out, camera_records,
    light_records, bytes) and left_out, a list of lines.
    """
    options = {
        "verify": _LEVELS.index(_arguments.choice("verify", verify, _LEVELS)), "replace": _arguments.flag("replace", replace),
        "require": _arguments.optional(_arguments.interval, "require", require), "compact": _arguments.flag("compact", compact),
        "skip_duplicates": _arguments.flag("skip_duplicates", skip_duplicates), "keep_going": _arguments.flag("keep_going", keep_going),
        "job": _arguments.optional(_arguments.job_id, "job", job), "memory": 0 if memory is None else _arguments.whole("memory", memory, 1),
        "threads": _arguments.whole("threads", threads, 0, _MOST_THREADS)}
    return _latent.merge(_arguments.paths(paths), _arguments.path("output", output), options)


def develop(*paths: Path, **options: Any) -> np.ndarray:
    """Develops files, folders and unfinished parts of one job into a picture, as latent-develop does, with the same bits.

    Returns float32 (height, width, 3): linear X, Y, Z (a camera's R, G, B without camera_xyz). With spectral_bins: (height, width,
    bins), radiance in W m^-2 sr^-1 nm^-1. Left-out input and advice are issued as LatentWarning.

    size: width, or (width, height), in pixels; default: the size rendered for. crop: (x0, y0, x1, y1), pixels of the whole picture.
    filter: such as "box" or "quartic:-3,1.5", the default. observer: a name ("cie1964", "kodak_trix_400") or a CSV file.
    camera_xyz: X, Y, Z of a camera. raw_balance: False for channels of a camera with one scale. lens_filter: such as "wratten-25".
    filter_factor: a factor of the exposure, or "auto". lights: such as ["lamp=2.5"]. aperture, shutter: such as "0.35,blades:6" and
    "0.2:0.5", of files rendered with --aov lens,time. exposure_follows: these darken the picture. focus: a distance, or
    (x, y), a pixel that is to be sharp. dim_fireflies: dims specks of light. denoise: the share of noise to remove, from 0 to 1.
    image: "camera", "light" or "both". estimator: "standard", or "ratio", with less colour noise of few wavelengths. spectral_bins: their
    number, or "FROM:TO:STEP" in nm. samples: (first, end). job: 32 hexadecimal digits, if folders hold several. skip_duplicates:
    files may hold the same samples. memory: bytes to work in, beside the picture's own; default: 1 GiB, at most half of what may be
    used. threads: at most; 0: all.

    >>> xyz = latent.develop("night.latent", size=512, filter="box")
    """
    if options.get("layers") or options.get("halves"):
        raise TypeError("develop_layers returns layers and halves")
    return _develop(paths, **options)[0]


def develop_layers(*paths: Path, **options: Any) -> dict[str, np.ndarray]:
    """The channels of a picture by their names in latent-develop's EXR, float32 (height, width) each: "R", "G", "B" (which hold X, Y,
    Z) or spectral bins, and those of two more options:

    layers: of "variance", "weight" and "count"; "lights", if the scene was rendered with --light-groups; "albedo", "normal", "depth",
    "position" and "id", if it was with --aov; and names of other columns. halves: the picture of each half of the samples, too. Other
    options: see `develop`.
    """
    pixels, names = _develop(paths, **options)
    return {name: pixels[:, :, i] for i, name in enumerate(names)}


def _develop(
    paths: Sequence[Path],
    *,
    size: Union[int, tuple[int, int], None] = None,
    crop: Optional[tuple[int, int, int, int]] = None,
    filter: str = "",
    observer: Path = "",
    camera_xyz: bool = False,
    raw_balance: bool = True,
    lens_filter: str = "",
    filter_factor: Union[float, str] = 1,
    lights: Sequence[str] = (),
    dim_fireflies: bool = False,
    denoise: float = 0,
    aperture: str = "",
    shutter: str = "",
    exposure_follows: bool = False,
    focus: Union[float, tuple[float, float], None] = None,
    image: str = "both",
    estimator: str = "standard",
    spectral_bins: Union[int, str] = "",
    layers: Sequence[str] = (),
    halves: bool = False,
    samples: Optional[tuple[int, int]] = None,
    job: Optional[str] = None,
    skip_duplicates: bool = False,
    memory: Optional[int] = None,
    threads: int = 0,
) -> tuple[np.ndarray, list[str]]:
    """Pixels (height, width, channels), and the names of the channels."""
    if _arguments.choice("estimator", estimator, ["standard", "ratio"]) == "ratio" and spectral_bins:
        raise ValueError("estimator: 'ratio' is of colours, so it has no spectral_bins")
    if isinstance(filter_factor, str) and filter_factor == "auto":
        filter_factor = 0
    elif _arguments.real("filter_factor", filter_factor) <= 0:
        raise ValueError(f"filter_factor: {_arguments.shown(filter_factor)} is not above 0, or 'auto'")
    if not isinstance(spectral_bins, str):
        spectral_bins = str(_arguments.whole("spectral_bins", spectral_bins, 1))
    if not 0 <= _arguments.real("denoise", denoise) <= 1:
        raise ValueError(f"denoise: {_arguments.shown(denoise)} is not from 0 to 1")
    options = {
        "size": _arguments.optional(_size, "size", size) or "",
        "crop": _arguments.optional(_crop, "crop", crop), "filter": _arguments.text("filter", filter),
        "observer": b"" if observer == "" else _arguments.path("observer", observer), "camera_xyz": _arguments.flag("camera_xyz", camera_xyz),
        "raw_balance": _arguments.flag("raw_balance", raw_balance), "lens_filter": _arguments.text("lens_filter", lens_filter),
        "filter_factor": float(filter_factor), "lights": _arguments.texts("lights", lights),
        "dim_fireflies": _arguments.flag("dim_fireflies", dim_fireflies), "denoise": float(denoise),
        "aperture": _arguments.text("aperture", aperture), "shutter": _arguments.text("shutter", shutter),
        "exposure_follows": _arguments.flag("exposure_follows", exposure_follows), "focus": _focus(focus),
        "image": _arguments.choice("image", image, ["both", "camera", "light"]), "ratio": estimator == "ratio",
        "spectral_bins": _arguments.text("spectral_bins", spectral_bins), "layers": ",".join(_arguments.texts("layers", layers)),
        "halves": _arguments.flag("halves", halves), "samples": _arguments.optional(_arguments.interval, "samples", samples),
        "job": _arguments.optional(_arguments.job_id, "job", job), "skip_duplicates": _arguments.flag("skip_duplicates", skip_duplicates),
        "memory": 0 if memory is None else _arguments.whole("memory", memory, 1),
        "threads": _arguments.whole("threads", threads, 0, _MOST_THREADS)}
    pixels, names, lines = _latent.develop(_arguments.paths(paths), options)
    for line in lines:
        warnings.warn(line, LatentWarning, stacklevel=3)
    return pixels, names


def _focus(value: Union[float, tuple[float, float], None]) -> str:
    """As latent-develop takes it."""
    if value is None:
        return ""
    numbers = value if isinstance(value, (tuple, list)) else [value]
    if isinstance(value, (tuple, list)) and len(value) != 2:
        raise ValueError(f"focus: {_arguments.shown(value)} is neither a distance nor (x, y)")
    return ",".join(repr(float(_arguments.real("focus", number))) for number in numbers)


def _size(name: str, value: Any) -> str:
    """As latent-develop takes it."""
    sides = _arguments.wholes(name, value, "(width, height)", 1) if isinstance(value, (tuple, list, np.ndarray)) else [
        _arguments.whole(name, value, 1)]
    return "x".join(map(str, sides))


def _crop(name: str, value: Any) -> tuple[int, ...]:
    x0, y0, x1, y1 = _arguments.wholes(name, value, "(x0, y0, x1, y1)", 0, 2**63 - 1)
    if not (x0 < x1 and y0 < y1):
        raise ValueError(f"{name}: {_arguments.shown(value)} is not (x0, y0, x1, y1) with x0 < x1 and y0 < y1")
    return x0, y0, x1, y1


_develop.__qualname__ = "develop"  # as messages about unknown arguments call it
