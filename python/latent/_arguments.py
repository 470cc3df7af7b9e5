"""What callers pass, checked and converted. A refusal names the argument, what it takes, and what it was given."""

from __future__ import annotations

import json
import math
import operator
import os
import re
import reprlib
from typing import Any, Iterable, Mapping, Sequence, Union

import numpy as np

Path = Union[str, "os.PathLike[str]"]


def shown(value: Any) -> str:
    """The start of a value, on one line."""
    return reprlib.repr(" ".join(str(value).split()) if isinstance(value, np.ndarray) else value)


def path(name: str, value: Any) -> bytes:
    try:
        encoded = os.fsencode(value)
    except TypeError:
        raise TypeError(f"{name}: a path is needed, not {shown(value)}") from None
    except UnicodeEncodeError:
        encoded = b""
    if not encoded or b"\0" in encoded:
        raise ValueError(f"{name}: {shown(value)} is not the name of a file")
    return encoded


def paths(values: Iterable[Any]) -> list[bytes]:
    """At least one. A single path is taken as well."""
    if isinstance(values, (str, bytes, os.PathLike)):
        values = [values]
    elif not isinstance(values, (tuple, list)):
        raise TypeError(f"paths: a list of paths is needed, not {shown(values)}")
    if not values:
        raise ValueError("paths: give at least one")
    return [path("paths", value) for value in values]


def flag(name: str, value: Any) -> bool:
    if not isinstance(value, (bool, np.bool_)):
        raise TypeError(f"{name}: True or False is needed, not {shown(value)}")
    return bool(value)


def whole(name: str, value: Any, least: int = 0, most: int = 2**64 - 1) -> int:
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"{name}: a whole number is needed, not {shown(value)}") from None
    if not least <= number <= most:
        raise ValueError(f"{name}: {shown(number)} is not in {least}..{most}")
    return number


def several(name: str, value: Any, form: str) -> None:
    """Refuses what is not a sequence of as many items as `form`, such as "(first, end)", has names."""
    if not isinstance(value, (tuple, list, np.ndarray)):
        raise TypeError(f"{name}: {form} is needed, not {shown(value)}")
    if len(value) != form.count(",") + 1:
        raise ValueError(f"{name}: {form} is needed, not {shown(value)}")


def wholes(name: str, value: Any, form: str, least: int = 0, most: int = 2**64 - 1) -> tuple[int, ...]:
    several(name, value, form)
    return tuple(whole(name, number, least, most) for number in value)


def optional(convert: Any, name: str, value: Any) -> Any:
    """None stays None."""
    return None if value is None else convert(name, value)


def interval(name: str, value: Any) -> tuple[int, int]:
    first, end = wholes(name, value, "(first, end)")
    if first >= end:
        raise ValueError(f"{name}: {first}:{end} is empty; it goes from the first to the one behind the last")
    return first, end


def real(name: str, value: Any) -> float:
    if not isinstance(value, (int, float, np.integer, np.floating)):
        raise TypeError(f"{name}: a number is needed, not {shown(value)}")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise ValueError(f"{name}: {shown(value)} is not finite")
    return number


def region(name: str, value: Any) -> list[float]:
    several(name, value, "(u0, v0, u1, v1)")
    u0, v0, u1, v1 = (real(name, side) for side in value)
    if not (0 <= u0 < u1 <= 1 and 0 <= v0 < v1 <= 1):
        raise ValueError(f"{name}: {shown(value)} is not (u0, v0, u1, v1) with 0 <= u0 < u1 <= 1 and 0 <= v0 < v1 <= 1")
    return [u0, v0, u1, v1]


def text(name: str, value: Any) -> str:
    if not isinstance(value, str):
        raise TypeError(f"{name}: a text is needed, not {shown(value)}")
    if "\0" in value or any("\ud800" <= character <= "\udfff" for character in value):
        raise ValueError(f"{name}: {shown(value)} has characters that cannot be stored")
    return value


def texts(name: str, values: Any) -> list[str]:
    if not isinstance(values, (tuple, list)):
        raise TypeError(f"{name}: a list of texts is needed, not {shown(values)}")
    if "" in values:
        raise ValueError(f"{name}: a text in {shown(values)} is empty")
    return [text(name, value) for value in values]


def choice(name: str, value: Any, choices: Sequence[str]) -> str:
    if not isinstance(value, str) or value not in choices:
        raise ValueError(f"{name}: {shown(value)} is not one of {', '.join(map(repr, choices))}")
    return value


def job_id(name: str, value: Any) -> tuple[int, int]:
    """Its two halves, high and low."""
    if not isinstance(value, str) or not re.fullmatch("[0-9a-fA-F]{32}", value):
        raise ValueError(f"{name}: {shown(value)} is not 32 hexadecimal digits")
    return int(value[:16], 16), int(value[16:], 16)


def column(name: str, values: Any, kind: Any, *shape: int) -> np.ndarray:
    """A contiguous array of `kind` and `shape` (any (n,), if none is given). Fractions are not cut off, and nothing wraps or
    overflows; real numbers may be rounded."""
    try:
        array = np.asarray(values)
    except ValueError:
        raise ValueError(f"{name}: an array of numbers is needed, not {shown(values)}") from None
    kind = np.dtype(kind)
    if array.shape != shape if shape else array.ndim != 1:
        raise ValueError(f"{name}: an array of shape {shape or '(n,)'} is needed, not {array.shape}")
    if array.size == 0:
        return np.empty(array.shape, kind)
    if array.dtype.kind not in ("biuf" if kind.kind == "f" else "biu"):
        raise TypeError(f"{name}: {'numbers' if kind.kind == 'f' else 'whole numbers'} are needed, not {array.dtype}")
    with np.errstate(all="ignore"):
        converted = np.ascontiguousarray(array, kind)
    lost = np.isinf(converted) & np.isfinite(array) if kind.kind == "f" else (array < 0) | (array > np.iinfo(kind).max)
    if lost.any():
        raise ValueError(f"{name}: {array[lost][0]} does not fit into {kind}")
    return converted


def positions(name: str, values: Any, n: int) -> np.ndarray:
    """In units of 2^-32: uint32 as they are, others from 0 <= x < 1."""
    if getattr(values, "dtype", None) == np.uint32:
        return column(name, values, np.uint32, n)
    array = column(name, values, np.float64, n)
    outside = ~((array >= 0) & (array < 1))
    if outside.any():
        raise ValueError(f"{name}: {array[outside][0]} is not in 0 <= x < 1")
    return np.floor(array * 2.0**32).astype(np.uint32)


def mapping(name: str, value: Any, what: str) -> dict[str, Any]:
    if not isinstance(value, Mapping):
        raise TypeError(f"{name}: a dict of {what} is needed, not {shown(value)}")
    return {text(name, key): item for key, item in value.items()}


def json_object(name: str, value: Any) -> str:
    """A dict as JSON; text stays as it is."""
    if isinstance(value, str):
        return text(name, value)
    if not isinstance(value, Mapping):
        raise TypeError(f"{name}: a dict is needed, not {shown(value)}")
    try:
        return json.dumps(dict(value), allow_nan=False)
    except (TypeError, ValueError, RecursionError) as error:
        raise ValueError(f"{name}: JSON cannot hold it: {error}") from None
