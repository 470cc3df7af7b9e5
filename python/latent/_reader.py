"""Files of records, read as arrays."""

from __future__ import annotations

import json
from typing import Any, Iterator, Optional, Sequence

import numpy as np

from . import _arguments, _latent
from ._arguments import Path


_CLASSES = ["both", "camera", "light"]  # as latent_selection.classes counts them


class Reader:
    """Files, folders and unfinished parts of one job, as one set of runs in which no sample counts twice.

    >>> night = latent.open("night.latent")
    >>> for page in night.pages(["u", "v", "y"], region=(0.4, 0.4, 0.6, 0.6)):
    ...     total += page["y"].sum()
    """

    def __init__(self, paths: Sequence[Path], *, job: Optional[str] = None, skip_duplicates: bool = False, verify: bool = False):
        self._reader = _latent.Reader(
            _arguments.paths(paths), _arguments.optional(_arguments.job_id, "job", job), _arguments.flag("skip_duplicates", skip_duplicates),
            _arguments.flag("verify", verify))

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

    @property
    def parts(self) -> list[dict[str, Any]]:
        """How the samples were made: for each part its "samples", intervals (first, end), and its "provenance", what its writer tells:
        program, scene, command, host, ... A merged file has the parts that it was made of."""
        parts = json.loads(self._reader.provenance())["parts"]
        return [{**part, "samples": [tuple(interval) for interval in part["samples"]]} for part in parts]

    @property
    def light_groups(self) -> list[str]:
        """Names of the groups of lights, as the column light_group counts them, for `lights` of `develop`."""
        return self._reader.light_groups()

    @property
    def materials(self) -> list[str]:
        """Names of the materials; the column material counts them from 1."""
        return self._reader.materials()

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
        return _latent.Pages(
            self._reader, self._known(columns), _arguments.optional(_arguments.region, "region", region),
            _arguments.optional(_arguments.interval, "samples", samples),
            _CLASSES.index(_arguments.choice("classes", classes, _CLASSES)),
            _arguments.optional(_arguments.interval, "runs", runs))

    def _known(self, columns: Optional[Sequence[str]]) -> Optional[list[str]]:
        if columns is None:
            return None
        names, known = _arguments.texts("columns", columns), list(self._types())
        if not names:
            raise ValueError(f"columns: give at least one of {', '.join(known)}")
        for name in names:
            if name not in known:
                raise KeyError(f"columns: there is no {_arguments.shown(name)}; there are {', '.join(known)}")
        return names

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


def open(*paths: Path, job: Optional[str] = None, skip_duplicates: bool = False, verify: bool = False) -> Reader:
    """Opens files, folders or unfinished parts of one job.

    job: 32 hexadecimal digits, if there are several. skip_duplicates: files may hold the same samples. verify: read and check every
    byte first.
    """
    return Reader(paths, job=job, skip_duplicates=skip_duplicates, verify=verify)


def info(*paths: Path, job: Optional[str] = None, skip_duplicates: bool = False) -> dict[str, Any]:
    """The job, the counts and the making of files in one dict: `Reader.job`, `Reader.info`, and its light_groups, materials, parts.

    cpu_seconds is the processor time of all parts that report it.
    """
    reader = open(*paths, job=job, skip_duplicates=skip_duplicates)
    return {**reader.job, **reader.info, "light_groups": reader.light_groups, "materials": reader.materials, "parts": reader.parts,
            "cpu_seconds": sum(_cpu_seconds(part["provenance"]) for part in reader.parts)}


def _cpu_seconds(provenance: Any) -> float:
    seconds = provenance.get("cpu_seconds") if isinstance(provenance, dict) else None  # writers may say what they like
    return seconds if isinstance(seconds, (int, float)) and seconds > 0 else 0
