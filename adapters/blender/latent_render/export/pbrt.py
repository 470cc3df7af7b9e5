"""The language of pbrt-v4: directives with typed parameters. Needs no Blender."""
import hashlib
import os


def quoted(text):
    """A string. Characters that would end it become others."""
    return '"' + str(text).replace("\\", "/").replace('"', "'").replace("\n", " ") + '"'


def value_of(value):
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return quoted(value)
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return f"{value:.9g}"
    return "[ " + " ".join(map(value_of, value)) + " ]"


def directive(word, *names, **parameters):
    """`parameters`: "type name" to a value or several."""
    return " ".join([word, *map(quoted, names), *(f"{quoted(key)} {value_of(value)}" for key, value in parameters.items())])


def columns(rows):
    """The numbers of a 4 x 4 matrix as pbrt stores them, one column after another. `rows`: as Blender's."""
    return [number for column in zip(*rows) for number in column]


MATRIX = "[ " + " ".join(["%.9g"] * 16) + " ]"


def matrix(rows, word="Transform"):
    return f"{word} {MATRIX % tuple(columns(rows))}"


def moving(start, end, word="Transform"):
    """A matrix that changes while the shutter is open, by its columns."""
    first, last = (f"{word} {MATRIX % tuple(numbers)}" for numbers in (start, end))
    return first if first == last else f"ActiveTransform StartTime {first} ActiveTransform EndTime {last} ActiveTransform All"


class Document:
    """A scene in three parts: what comes before WorldBegin; definitions, named by their content; what is there.
    `body` holds strings, and iterators of strings where there are very many."""

    def __init__(self):
        self.head, self.definitions, self.body = [], {}, []

    def define(self, word, *names, **parameters):
        """Adds a definition, such as a MakeNamedMaterial, unless there is the same: returns its name."""
        digest = hashlib.blake2b(directive(word, *names, **parameters).encode(), digest_size=6).hexdigest()
        name = f"{word.removeprefix('MakeNamed').lower()} {digest}"
        self.definitions[name] = directive(word, name, *names, **parameters)
        return name

    def material(self, kind, parameters):
        return self.define("MakeNamedMaterial", **{"string type": kind, **parameters})

    def lines(self):
        yield from self.head
        yield "WorldBegin"
        yield from self.definitions.values()
        for item in self.body:
            yield from [item] if isinstance(item, str) else item

    def write(self, path):
        """Returns the digest of the text."""
        digest = hashlib.blake2b(digest_size=16)
        with open(path + ".unfinished", "w", encoding="utf-8", newline="\n") as file:
            for line in self.lines():
                digest.update(line.encode() + b"\n")
                file.write(line + "\n")
        os.replace(path + ".unfinished", path)
        return digest
