"""latent-merge and latent-develop as functions."""

from __future__ import annotations

import os
import warnings
from typing import Any, Optional, Sequence, Union

import numpy as np

from . import _latent

Path = Union[str, "os.PathLike[str]"]


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
    memory: int = 2**30,
    threads: int = 0,
) -> dict[str, Any]:
    """Joins files, folders and unfinished parts of one job into one file, as latent-merge does.

    require: samples (first, end) that must be present. verify: how the copies are checked, "quick", "stored" or "full". compact:
    rewrite many small runs as a few large ones. job: 32 hexadecimal digits, if folders hold several. memory: bytes. threads: at most;
    0: all. Returns counts (samples, files, runs_in, runs_out, camera_records, light_records, bytes) and left_out, a list of lines.
    """
    levels = {"stored": 0, "quick": 1, "full": 2}
    if verify not in levels:
        raise ValueError("verify is 'quick', 'stored' or 'full'")
    options = {"verify": levels[verify], "replace": replace, "require": require, "compact": compact,
               "skip_duplicates": skip_duplicates, "keep_going": keep_going, "job": job, "memory": memory, "threads": threads}
    return _latent.merge([os.fspath(path) for path in paths], os.fspath(output), options)


def develop(*paths: Path, **options: Any) -> np.ndarray:
    """Develops files, folders and unfinished parts of one job into a picture, as latent-develop does, with the same bits.

    Returns float32 (height, width, 3): linear X, Y, Z (a camera's R, G, B without camera_xyz). With spectral_bins: (height, width,
    bins), radiance in W m^-2 sr^-1 nm^-1. Left-out input and advice are issued as LatentWarning.

    size: width, or (width, height), in pixels; default: the largest with 16 samples per pixel. crop: (x0, y0, x1, y1), pixels of the
    whole picture. filter: such as "box" or "quartic:-3,1.5", the default. observer: a name ("cie1964", "kodak_trix_400") or a CSV
    file. camera_xyz: X, Y, Z of a camera. raw_balance: False for channels of a camera with one scale. lens_filter: such as "wratten-25". filter_factor: a factor of the exposure, or "auto".
    lights: such as ["lamp=2.5"]. dim_fireflies: dims specks of light. image: "camera", "light" or "both". estimator: "standard", or "ratio", with less colour noise of few
    wavelengths. spectral_bins: their number, or "FROM:TO:STEP" in nm. samples: (first, end). job: 32 hexadecimal digits, if folders
    hold several. skip_duplicates: files may hold the same samples. memory: bytes to work in, beside the picture's own. threads: at
    most; 0: all.

    >>> xyz = latent.develop("night.latent", size=512, filter="box")
    """
    if options.get("layers") or options.get("halves"):
        raise TypeError("develop_layers returns layers and halves")
    return _develop(paths, **options)[0]


def develop_layers(*paths: Path, **options: Any) -> dict[str, np.ndarray]:
    """The channels of a picture by their names in latent-develop's EXR, float32 (height, width) each: "R", "G", "B" (which hold X, Y,
    Z) or spectral bins, and those of two more options:

    layers: of "variance", "weight" and "count"; and of "albedo", "normal", "depth", "position" and "id", if the scene was rendered with
    --aov. halves: the picture of each half of the samples, too. Other options: see `develop`.
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
    image: str = "both",
    estimator: str = "standard",
    spectral_bins: Union[int, str] = "",
    layers: Sequence[str] = (),
    halves: bool = False,
    samples: Optional[tuple[int, int]] = None,
    job: Optional[str] = None,
    skip_duplicates: bool = False,
    memory: int = 2**30,
    threads: int = 0,
) -> tuple[np.ndarray, list[str]]:
    """Pixels (height, width, channels), and the names of the channels."""
    if image not in ("both", "camera", "light"):
        raise ValueError("image is 'both', 'camera' or 'light'")
    if estimator not in ("standard", "ratio"):
        raise ValueError("estimator is 'standard' or 'ratio'")
    if estimator == "ratio" and spectral_bins:
        raise ValueError("the ratio estimator is of colours: it has no spectral_bins")
    factor = 0.0 if filter_factor == "auto" else float(filter_factor)
    if filter_factor != "auto" and not 0 < factor < float("inf"):
        raise ValueError("filter_factor is a number above 0, or 'auto'")
    options = {
        "size": "" if size is None else "x".join(str(side) for side in np.atleast_1d(size)),
        "crop": crop, "filter": filter, "observer": os.fspath(observer), "camera_xyz": camera_xyz,
        "raw_balance": raw_balance, "lens_filter": lens_filter,
        "filter_factor": factor, "lights": list(lights), "dim_fireflies": dim_fireflies, "image": image, "ratio": estimator == "ratio",
        "spectral_bins": str(spectral_bins), "layers": ",".join(layers), "halves": halves, "samples": samples, "job": job,
        "skip_duplicates": skip_duplicates, "memory": memory, "threads": threads}
    pixels, names, left_out, advice = _latent.develop([os.fspath(path) for path in paths], options)
    for line in [*left_out, *advice]:
        warnings.warn(line, LatentWarning, stacklevel=3)
    return pixels, names
