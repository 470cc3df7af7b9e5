"""Parts, written from arrays."""

from __future__ import annotations

from typing import Any, Iterator, Mapping, Union

import numpy as np

from . import _arguments, _latent
from ._arguments import Path, column


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
        provenance: Union[Mapping[str, Any], str] = "",
        replace: bool = False,
    ):
        most = 2**32 - 1
        self._samples = _arguments.interval("samples", samples)
        self._wavelengths = _arguments.whole("wavelengths", wavelengths, 0, 1024)
        self._extra = {name: _arguments.choice(f"extra: {name}", kind, _latent.types)
                       for name, kind in _arguments.mapping("extra", extra, "names and types").items()}
        high, low = _arguments.job_id("job_id", job_id)
        width, height = _arguments.wholes("aspect", aspect, "(width, height)", 1, most)
        job = {
            "id_high": high, "id_low": low, "aspect_width": width, "aspect_height": height, "wavelengths": self._wavelengths,
            "light_unit": _arguments.real("light_unit", light_unit),
            "light_paths_per_sample": _arguments.whole("light_paths_per_sample", light_paths_per_sample, 0, most),
            "precision": _arguments.whole("precision", precision, 1, 23),
            "run_samples": _arguments.whole("run_samples", run_samples, 0, most), "extra": self._extra}
        self._writer = _latent.Writer(
            _arguments.path("path", path), job, self._samples, _arguments.real("checkpoint_seconds", checkpoint_seconds),
            _arguments.json_object("provenance", provenance), _arguments.flag("replace", replace))

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
        camera. extra: every extra column of the job. Columns of whole numbers take no floats."""
        columns = self._columns(sample, u, v, x, y, z, power, wavelengths, share, record_class, extra)
        self._writer.submit(_arguments.interval("grain", grain), *columns)

    def write(self, *, sample: Any, u: Any, v: Any, x: Any = None, y: Any = None, z: Any = None, power: Any = None,
              wavelengths: Any = None, share: Any = None, record_class: Any = None, extra: Mapping[str, Any] = {}) -> None:
        """Submits all records of the part, grain by grain; columns as in `submit`. All missing samples count as rendered, whether they
        have records or not. Records of samples that were on disk when the part was opened are left out. To write a part piece by
        piece, use `grains` and `submit`."""
        sample, u, v, values, share, record_class, extras = self._columns(
            sample, u, v, x, y, z, power, wavelengths, share, record_class, extra)
        first, end = self._samples
        outside = (sample < np.uint64(first)) | (sample >= np.uint64(end))
        if outside.any():
            raise ValueError(f"sample: {sample[outside][0]} is not in {first}:{end}, the samples of this part")
        order = np.argsort(sample, kind="stable")
        sample = sample[order]
        late = np.zeros(len(sample), bool)
        for first, end in self.missing:
            late[slice(*np.searchsorted(sample, np.asarray((first, end), np.uint64)))] = True
        for grain in self.grains():
            begin, end = np.searchsorted(sample, np.asarray(grain, np.uint64))
            rows = order[begin:end]
            self._writer.submit(grain, sample[begin:end], u[rows], v[rows], [column[rows] for column in values],
                                None if share is None else share[rows], None if record_class is None else record_class[rows],
                                [column[rows] for column in extras])
            late[begin:end] = False
        if late.any():
            raise ValueError(f"sample: {sample[late][0]} was submitted before; write takes all records of a part in one call")

    def _columns(self, sample: Any, u: Any, v: Any, x: Any, y: Any, z: Any, power: Any, wavelengths: Any, share: Any,
                 record_class: Any, extra: Mapping[str, Any]) -> tuple[Any, ...]:
        """Contiguous arrays of the types of the job, all of one length."""
        sample = column("sample", sample, np.uint64)
        n, k = len(sample), self._wavelengths
        xyz, spectral = {"x": x, "y": y, "z": z}, {"power": power, "wavelengths": wavelengths}
        wanted, others, kind = (spectral, xyz, "spectral") if k else (xyz, spectral, "XYZ")
        for name, given in wanted.items():
            if given is None:
                raise ValueError(f"{name}: records of {kind} jobs need it")
        for name, given in others.items():
            if given is not None:
                raise ValueError(f"{name}: records of {kind} jobs do not have it")
        values = [column(name, given, np.float32, *((n, k) if k else (n,))) for name, given in wanted.items()]
        if share is not None:
            share = column("share", share, np.float32, n)
        if record_class is not None:
            record_class = column("record_class", record_class, np.uint8, n)
        if set(_arguments.mapping("extra", extra, "columns")) != set(self._extra):
            for name in self._extra.keys() - extra.keys():
                raise ValueError(f"extra: {name!r} is missing; the columns of this job are {list(self._extra)}")
            raise ValueError(f"extra: {_arguments.shown(list(extra))}; the columns of this job are {list(self._extra)}")
        extras = [column(f"extra: {name}", extra[name], kind, n) for name, kind in self._extra.items()]
        return sample, _arguments.positions("u", u, n), _arguments.positions("v", v, n), values, share, record_class, extras

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
