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
    return "[ " + " ".join(value_of(item) for item in value) + " ]"


def directive(word, *names, **parameters):
    return with_parameters(" ".join([word, *map(quoted, names)]), parameters)


def with_parameters(head, parameters):
    """`parameters`: "type name" to a value or several."""
    return head + "".join(f" {quoted(key)} {value_of(value)}" for key, value in parameters.items())


def matrix(rows, word="Transform"):
    """`rows`: 4 x 4, as Blender's. pbrt stores the columns one after another."""
    return f"{word} [ " + " ".join(f"{rows[i][j]:.9g}" for j in range(4) for i in range(4)) + " ]"


def moving(start, end, word="Transform"):
    """Lines of a matrix that changes while the shutter is open."""
    lines = [matrix(rows, word) for rows in (start, end)]
    return lines[:1] if lines[0] == lines[1] else ["ActiveTransform StartTime", lines[0], "ActiveTransform EndTime", lines[1], "ActiveTransform All"]


class Document:
    """A scene in three parts: what comes before WorldBegin; definitions, named by their content; what is there.
    `body` holds strings, and iterators of strings where there are very many."""

    def __init__(self):
        self.head, self.definitions, self.body = [], {}, []

    def define(self, kind, make):
        """Adds the definition `make(name)`, unless there is the same: returns its name."""
        name = f"{kind} {hashlib.blake2b(make('').encode(), digest_size=6).hexdigest()}"
        self.definitions.setdefault(name, make(name))
        return name

    def texture(self, kind, of, parameters):
        """`kind`: float or spectrum; `of`: such as imagemap."""
        return self.define("texture", lambda name: with_parameters(f"Texture {quoted(name)} {quoted(kind)} {quoted(of)}", parameters))

    def material(self, of, parameters):
        return self.define("material", lambda name: directive("MakeNamedMaterial", name, **{"string type": of, **parameters}))

    def medium(self, of, parameters):
        return self.define("medium", lambda name: directive("MakeNamedMedium", name, **{"string type": of, **parameters}))

    def lines(self):
        yield from self.head
        yield "WorldBegin"
        yield from self.definitions.values()
        for item in self.body:
            if isinstance(item, str):
                yield item
            else:
                yield from item

    def write(self, path):
        """Returns the digest of the text."""
        digest = hashlib.blake2b(digest_size=16)
        with open(path + ".unfinished", "w", encoding="utf-8", newline="\n") as file:
            for line in self.lines():
                digest.update(line.encode() + b"\n")
                file.write(line + "\n")
        os.replace(path + ".unfinished", path)
        return digest
