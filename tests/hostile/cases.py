"""The files by name, each with the function that makes it."""
from forged import WIDTH

KINDS = ("xyz", "spectral", "explicit")
CASES = {}  # name -> (function that returns pieces, whether it is large)


def case(name, large=False):
    def add(make):
        assert name not in CASES, name
        CASES[name] = (make, large)
        return make
    return add


def extremes(layout, ceilings):
    most = 256 ** WIDTH[layout] - 1
    return {value: None for value in [0, *ceilings, most // 2 + 1, most] if 0 <= value <= most}


def named(value):
    return f"{value:x}"
