"""Checks that fail a file, and rules that only writers must keep."""
import contextlib
import json
import struct

M32, M64 = 2**32 - 1, 2**64 - 1
UNREADABLE = (ValueError, struct.error, IndexError, OverflowError)  # what Python raises where bytes make no sense


def check(condition, what):
    if not condition:
        raise ValueError(what)


class Rules:
    """Rules that only writers must keep are checked, too, except inside `with Rules.for_readers()`."""

    checked = True

    @classmethod
    @contextlib.contextmanager
    def for_readers(cls):
        cls.checked = False
        try:
            yield
        finally:
            cls.checked = True


def rule(condition, what):
    check(condition or not Rules.checked, what)


def fields(layout, data, at):
    return struct.unpack_from("<" + layout, data, at)


def depth_of(value):
    return 1 + max(map(depth_of, value.values() if isinstance(value, dict) else value), default=0) if isinstance(value, (dict, list)) else 0


def is_provenance(text, most):
    """Nothing, or a JSON object nested at most `most` deep."""
    try:
        return not text or (isinstance(value := json.loads(bytes(text)), dict) and depth_of(value) <= most)
    except (ValueError, RecursionError):
        return False
