"""Read, write, merge and develop .latent files: the raw samples of renderings, as NumPy arrays.

Records are columns: arrays of the same length n, one for each property.

    sample       (n,) uint64   sample number
    class        (n,) uint8    0 camera, 1 light
    u, v         (n,) float64  position on the film, 0..1, to the right and downwards
    share        (n,) float32  of the sample's denominator; 0 in light records
    x, y, z      (n,) float32  XYZ jobs: CIE 1931, not normalised
    power        (n, k) float32  spectral jobs: radiance / (k p), p the density of wavelengths in 1/nm
    wavelengths  (n, k) float32  spectral jobs: nm; pairs that a record does not have are 0 in both
    ...          (n,)          the extra columns of the job; extra.NAME if the name is taken

The meaning of the numbers is defined in docs/format.md, "Records". A pixel is sum(value) / sum(share) over its camera records.
"""

from __future__ import annotations

import os
from typing import Any, Iterator, Mapping, Optional, Sequence, Union

import numpy as np

from . import _latent
from ._latent import Error
from ._tools import LatentWarning, develop, develop_layers, merge

__all__ = ["Error", "LatentWarning", "Reader", "Writer", "develop", "develop_layers", "info", "merge", "open"]
__version__ = _latent.version()
Error.__module__ = __name__

Path = Union[str, "os.PathLike[str]"]


class Reader:
    """Files, folders and unfinished parts of one job, as one set of runs in which no sample counts twice.

    >>> night = latent.open("night.latent")
    >>> for page in night.pages(["u", "v", "y"], region=(0.4, 0.4, 0.6, 0.6)):
    ...     total += page["y"].sum()
    """

    def __init__(self, paths: Sequence[Path], *, skip_duplicates: bool = False, verify: bool = False):
        self._reader = _latent.Reader([os.fspath(path) for path in paths], skip_duplicates, verify)

    @property
    def job(self) -> dict[str, Any]:
        """What all samples have in common: id, kind, aspect, wavelengths (k), light_unit (cd/m^2 of Y = 1), ..."""
        return self._reader.job()

    @property
    def info(self) -> dict[str, int]:
        """Counts: files, runs, pages, samples, camera_records, light_records, pairs, light_paths."""
        return self._reader.info()

    @property
    def coverage(self) -> np.ndarray:
        """The samples that were found: (m, 2) uint64, intervals first .. end - 1, ascending."""
        return self._reader.coverage()

    @property
    def left_out(self) -> list[str]:
        """Damaged or foreign items when the files were opened, one line each."""
        return self._reader.left_out()

    def pages(
        self,
        columns: Optional[Sequence[str]] = None,
        *,
        region: Optional[tuple[float, float, float, float]] = None,
        samples: Optional[tuple[int, int]] = None,
        classes: str = "both",
        runs: Optional[tuple[int, int]] = None,
    ) -> Iterator[dict[str, np.ndarray]]:
        """Iterates over pages of at most 6144 records, in the order of the file; memory does not grow with the file.

        columns: names, default all. region: (u0, v0, u1, v1) in 0..1. samples: (first, end). classes: "camera", "light" or "both".
        runs: (first, end), to divide the work. The arrays are yours. Raises latent.Error where a page is damaged; `next` on the same
        iterator continues after it.
        """
        if classes not in ("both", "camera", "light"):
            raise ValueError("classes is 'camera', 'light' or 'both'")
        return _latent.Pages(self._reader, None if columns is None else list(columns), region, samples, classes, runs)

    def read(self, columns: Optional[Sequence[str]] = None, **selection: Any) -> dict[str, np.ndarray]:
        """All records of a selection at once, as `pages` takes it: one array for each column."""
        pages = list(self.pages(columns, **selection))
        if pages:
            return {name: np.concatenate([page[name] for page in pages]) for name in pages[0]}
        return {name: np.empty(shape, kind) for name, (kind, shape) in self._types().items() if columns is None or name in columns}

    def _types(self) -> dict[str, tuple[str, tuple[int, ...]]]:
        job = self.job
        types: dict[str, tuple[str, tuple[int, ...]]] = {
            "sample": ("u8", (0,)), "class": ("u1", (0,)), "u": ("f8", (0,)), "v": ("f8", (0,)), "share": ("f4", (0,))}
        if job["kind"] == "xyz":
            types.update({name: ("f4", (0,)) for name in "xyz"})
        else:
            types.update({name: ("f4", (0, job["wavelengths"])) for name in ("power", "wavelengths")})
        types.update({name: (kind, (0,)) for name, kind in job["extra"].items()})
        return types


def open(*paths: Path, skip_duplicates: bool = False, verify: bool = False) -> Reader:
    """Opens files, folders or unfinished parts of one job. verify: read and check every byte first."""
    return Reader(paths, skip_duplicates=skip_duplicates, verify=verify)


def info(*paths: Path) -> dict[str, Any]:
    """The job and the counts of files, `Reader.job` and `Reader.info`, in one dict."""
    reader = open(*paths)
    return {**reader.job, **reader.info}


def _fixed(column: Any) -> np.ndarray:
    """Positions in units of 2^-32: uint32 as they are, others from 0 <= x < 1."""
    array = np.asarray(column)
    if array.dtype == np.uint32:
        return array
    array = array.astype(np.float64)
    if array.size and not (array.min() >= 0 and array.max() < 1):
        raise ValueError("a position is not in 0 <= x < 1")
    return np.floor(array * 2.0**32).astype(np.uint32)


class Writer:
    """Writes a part: a range of samples under one name, resumable after kill -9.

    >>> with latent.Writer("night.latent", job_id="0123456789abcdef0123456789abcdef", samples=(0, 100_000)) as part:
    ...     for first, end in part.grains():
    ...         part.submit((first, end), sample=n, u=u, v=v, x=x, y=y, z=z)

    job_id: 32 hexadecimal digits that identify everything that shapes a record. wavelengths: k of a spectral job, 0 in XYZ jobs.
    extra: further columns and their types, such as {"depth": "f4"}, for layers of `develop_layers`; names are in docs/format.md.
    samples: (first, end); first is preferably a multiple of run_samples. Leaving the `with` block finishes the file, unless by an exception.
    """

    def __init__(
        self,
        path: Path,
        *,
        job_id: str,
        samples: tuple[int, int],
        wavelengths: int = 0,
        aspect: tuple[int, int] = (1, 1),
        light_unit: float = 1.0,
        light_paths_per_sample: int = 0,
        precision: int = 23,
        run_samples: int = 0,
        extra: Mapping[str, str] = {},
        checkpoint_seconds: float = 60.0,
        provenance: str = "",
        replace: bool = False,
    ):
        if len(job_id) != 32:
            raise ValueError("job_id is not 32 hexadecimal digits")
        self._extra = dict(extra)
        job = {
            "id_high": int(job_id[:16], 16), "id_low": int(job_id[16:], 16), "aspect_width": aspect[0], "aspect_height": aspect[1],
            "spectral": wavelengths > 0, "wavelengths": wavelengths, "light_unit": light_unit,
            "light_paths_per_sample": light_paths_per_sample, "precision": precision, "run_samples": run_samples,
            "extra": self._extra}
        self._spectral = wavelengths > 0
        self._writer = _latent.Writer(os.fspath(path), job, samples, checkpoint_seconds, provenance, replace)

    @property
    def missing(self) -> np.ndarray:
        """The samples that were missing when the part was opened: (m, 2) uint64."""
        return self._writer.missing()

    def grains(self) -> Iterator[tuple[int, int]]:
        """Yields the missing grains (first, end), 1024 samples or fewer. Several threads may share the work."""
        while (grain := self._writer.next()) is not None:
            yield grain

    def submit(self, grain: tuple[int, int], *, sample: Any, u: Any, v: Any, x: Any = None, y: Any = None, z: Any = None,
               power: Any = None, wavelengths: Any = None, share: Any = None, record_class: Any = None,
               extra: Mapping[str, Any] = {}) -> None:
        """All records of the samples of a grain, in any order. u, v: floats 0 <= x < 1, or uint32 in units of 2^-32. XYZ jobs: x, y,
        z (n,). Spectral jobs: power, wavelengths (n, k). share: default 1 in camera and 0 in light records. record_class: default 0,
        camera. extra: every extra column of the job."""
        values = [power, wavelengths] if self._spectral else [x, y, z]
        if any(value is None for value in values):
            raise ValueError("power and wavelengths are needed" if self._spectral else "x, y and z are needed")
        self._writer.submit(tuple(grain), sample, _fixed(u), _fixed(v), values, share, record_class,
                            self._extra_columns(extra))

    def _extra_columns(self, given: Mapping[str, Any]) -> list[np.ndarray]:
        """Contiguous, in the order and of the types of the job; no whole number changes."""
        if set(given) != set(self._extra):
            raise ValueError(f"extra columns of the job: {', '.join(self._extra) or 'none'}")
        columns = []
        for name, kind in self._extra.items():
            column = np.asarray(given[name])
            columns.append(np.ascontiguousarray(column, np.dtype(kind)))
            if columns[-1].dtype.kind == "u" and not np.array_equal(columns[-1], column):
                raise ValueError(f"extra: {name} holds values that are no {columns[-1].dtype}")
        return columns

    def write(self, *, sample: Any, extra: Mapping[str, Any] = {}, **columns: Any) -> None:
        """Submits whole arrays, grain by grain. All missing samples count as rendered, whether they have records or not."""
        order = np.argsort(sample, kind="stable")
        sample = np.asarray(sample, np.uint64)[order]
        columns = {name: np.asarray(column)[order] for name, column in columns.items() if column is not None}
        extra = {name: np.asarray(column)[order] for name, column in extra.items()}
        for grain in self.grains():
            rows = slice(*np.searchsorted(sample, np.asarray(grain, np.uint64)))
            self.submit(grain, sample=sample[rows], extra={name: column[rows] for name, column in extra.items()},
                        **{name: column[rows] for name, column in columns.items()})

    def checkpoint(self) -> None:
        """Commits everything up to the first missing grain, and returns when it is on disk."""
        self._writer.checkpoint()

    def finish(self) -> None:
        """Completes the file under its name. All grains must have been submitted."""
        self._writer.finish()

    def close(self) -> None:
        """Work that is not committed is lost, unless the part is finished."""
        self._writer.close()

    def __enter__(self) -> Writer:
        return self

    def __exit__(self, kind: Any, value: Any, traceback: Any) -> None:
        try:
            if kind is None:
                self.finish()
        finally:
            self.close()
