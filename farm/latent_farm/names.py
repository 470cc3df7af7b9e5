"""Text from outside: which names are refused, and how it is shown."""
import re
import unicodedata

from latent_farm.errors import Misuse

REVERSING = {"LRE", "RLE", "LRO", "RLO", "PDF", "LRI", "RLI", "FSI", "PDI"}  # a line with one of these reads as another


def is_control(character):
    """A character that a terminal obeys instead of showing it, or a byte of a file name that is not UTF-8."""
    return unicodedata.category(character) in ("Cc", "Cs", "Zl", "Zp") or unicodedata.bidirectional(character) in REVERSING


def _escaped(character):
    code = ord(character)
    return f"\\x{code - 0xdc00:02x}" if 0xdc80 <= code <= 0xdcff else character.encode("unicode_escape").decode()


def shown(text, most=1000):
    """`text` as part of a line: control characters are escaped, as \\n, and what exceeds `most` characters is left out."""
    text = text if len(text) <= most else text[:most] + "..."
    return text if text.isprintable() else "".join(_escaped(c) if is_control(c) else c for c in text)


def check_name(text, advice="rename it"):
    """That it can be written into scripts and reports."""
    if found := next(filter(is_control, text), None):
        what = "a byte that is not UTF-8," if unicodedata.category(found) == "Cs" else "the control character"
        raise Misuse(f"{text}: contains {what} {shown(found)}; {advice}")


URL = re.compile(r"(?i)(https?:/*)(?:[^\s/?#]*@)?([^\s?#]*)([?#]\S*)?")  # with one slash, where it was taken for a path


def without_secrets(text):
    """URLs without user and password, and with ?... for their query, which may be a key."""
    return URL.sub(lambda url: url[1] + url[2] + ("?..." if (url[3] or "").startswith("?") else ""), text)


def check_is_no_url(name, what):
    if URL.match(name):
        raise Misuse(f"{what}, not a URL: {name}")
