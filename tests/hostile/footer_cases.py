"""Footers of both forms whose fields are at their ceilings and beyond, and what provenance may hold."""
from forged import BLOCK, FRONT, File, base, first_form_of, footer_of
from cases import case, extremes, named

# ---- footers


def with_footer(make_footer):
    def make():
        job, runs = base("spectral", [(0, 300), (1024, 1100)])
        file = File(job, [run.sealed() for run in runs])
        front = file.pieces(footer=False)
        at, places = len(front[0]), []
        for run in front[1:]:
            places.append(at)
            at += len(run)
        footer = make_footer(at, places, [run.header for run in runs])
        return front + (footer if isinstance(footer, list) else [footer])
    return make


for field, at, ceilings in (("offset", 8, [BLOCK]), ("runs", 16, [1, 3, 2**20, 2**20 + 1]), ("provenance", 24, [1, 2**24, 2**24 + 1]),
                            ("zero", 48, [1])):
    for value in extremes("Q", ceilings):
        case(f"footer-{field}-{named(value)}")(
            with_footer(lambda end, places, headers, at=at, value=value: footer_of(end, headers, fields=[(at, value)])))
for field, at, ceilings in (("offset", 0, [BLOCK]), ("size", 8, [FRONT, 2**30, 2**30 + 1]), ("zero", 24, [1])):
    for value in extremes("Q", ceilings):
        case(f"first-form-{field}-{named(value)}")(with_footer(
            lambda end, places, headers, at=at, value=value: first_form_of(end, list(zip(places, headers)), fields=[(at, value)])))
for count, length in ((2**64 - 1, 0), (2**22, 0), (0, 2**64 - 1), (0, 2**30), (2**63, 2**63)):
    case(f"first-form-counts-{named(count)}-{named(length)}")(with_footer(
        lambda end, places, headers, c=(count, length): first_form_of(end, list(zip(places, headers)), counts=c)))

TEXTS = {
    "nested": lambda n: b"[" * n,
    "nested-objects": lambda n: (b'{"a":' * n)[:n],
    "one-string": lambda n: b'{"a":"' + b"x" * (n - 8) + b'"}',
    "deletes": lambda n: b'{"a":"' + b"\x7f" * (n - 8) + b'"}',
    "controls": lambda n: b'{"a":"' + b"\xc2\x9b" * (n // 2 - 4) + b'"}',
    "no-utf8": lambda n: b"\xff" * n,
    "spaces": lambda n: b"{" + b" " * (n - 2) + b"}",
    "zeros": bytes,
    "number": lambda n: b'{"a":' + b"9" * (n - 6) + b"}",
    "members": lambda n: b"{" + b",".join([b'"a":0'] * (n // 6 - 1)) + b"}",
    "parts": lambda n: b'{"parts":[' + b",".join([b"{}"] * (n // 3 - 5)) + b"]}",
    "parts-of-samples": lambda n: b'{"parts":[' + b",".join([b'{"samples":[[0,1]]}'] * (n // 20 - 2)) + b"]}",
    "part-of-samples": lambda n: b'{"parts":[{"provenance":{},"samples":[' + b",".join([b"[0,1]"] * (n // 6 - 10)) + b"]}]}",
}
for name, text in TEXTS.items():
    def in_header(text=text):
        job, runs = base("xyz")
        return File(job, [run.sealed() for run in runs], text(2**19)).pieces()

    case(f"origin-{name}")(in_header)
    for size in (2**16, 2**24):
        case(f"merged-{name}-{named(size)}", large=size > 2**16)(
            with_footer(lambda end, places, headers, text=text, size=size: footer_of(end, headers, text(size))))
