"""What shader nodes compute: constants as far as possible, otherwise textures of pbrt. Needs no Blender."""
from dataclasses import dataclass, field

from .report import Unknown

LUMINANCE = (0.2126, 0.7152, 0.0722)


@dataclass(frozen=True)
class Constant:
    rgb: tuple

    def number(self):
        """A colour as a number, as Blender has it: its luminance."""
        return self.rgb[0] if len(set(self.rgb)) == 1 else sum(c * w for c, w in zip(self.rgb, LUMINANCE))


@dataclass
class Texture:
    """`inputs`: parameters that are values themselves."""

    kind: str
    parameters: dict
    inputs: dict = field(default_factory=dict)
    of_color: bool = True

    @property
    def is_picture(self):
        return self.kind == "imagemap"

    @property
    def is_moved(self):
        """Whether it has a place of its own."""
        return any(name in key for key in self.parameters for name in ("uscale", "vscale", "udelta", "vdelta"))


def constant(number):
    return Constant((float(number),) * 3)


WHITE, BLACK = constant(1), constant(0)


def is_constant(*values):
    return all(isinstance(value, Constant) for value in values)


def parameter(document, name, kind, value):
    """A parameter of a material: `kind` is float or spectrum."""
    if is_constant(value):
        return {f"rgb {name}": [max(0.0, c) for c in value.rgb]} if kind == "spectrum" else {f"float {name}": value.number()}
    parameters = dict(value.parameters)
    for key, inner in value.inputs.items():
        parameters |= parameter(document, key, "float" if key in ("amount", "scale") else kind, inner)
    return {f"texture {name}": document.define("Texture", kind, value.kind, **parameters)}


def each(function, *values):
    if not is_constant(*values):
        raise Unknown("arithmetic with a picture")
    return Constant(tuple(float(function(*components)) for components in zip(*(value.rgb for value in values))))


def clamped(value):
    return each(lambda c: min(1.0, max(0.0, c)), value) if is_constant(value) else value


def mix(first, second, amount):
    if is_constant(first, second, amount):
        return each(lambda a, b, t: a + (b - a) * t, first, second, amount)
    if is_constant(amount) and amount.number() in (0.0, 1.0):
        return second if amount.number() else first
    return first if first == second else Texture("mix", {}, {"tex1": first, "tex2": second, "amount": amount})


def rest(amount):
    """1 - amount."""
    return mix(WHITE, BLACK, amount)


def product(first, second):
    if is_constant(first, second):
        return each(lambda a, b: a * b, first, second)
    if is_constant(first):
        first, second = second, first
    if is_constant(second) and len(set(second.rgb)) > 1:
        if not first.is_picture or first.of_color:  # pbrt scales by numbers alone
            raise Unknown("a colour times a picture")
        return mix(BLACK, second, first)
    return Texture("scale", {}, {"tex": first, "scale": second})
