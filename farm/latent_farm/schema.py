"""What the members of a state file may hold, so that whatever lies in a folder is refused with one line."""
import dataclasses
import typing

from latent_farm.errors import Failure
from latent_farm.names import is_control, shown


class Rule(typing.NamedTuple):
    text: str  # as in "must be <text>"
    holds: typing.Callable


def whole(least, most):
    return Rule(f"a whole number from {least} to {most}", lambda value: type(value) is int and least <= value <= most)


def real(least, most):
    return Rule(f"a number from {least:g} to {most:g}", lambda value: type(value) in (int, float) and least <= value <= most)


def one_of(*words):
    return Rule("one of " + ", ".join(words), lambda value: type(value) is str and value in words)


def _is_text(value):
    return type(value) is str and not any(map(is_control, value))


BOOLEAN = Rule("true or false", lambda value: type(value) is bool)
TEXT = Rule("text without control characters", _is_text)
TEXTS = Rule("a list of texts without control characters", lambda value: type(value) is list and all(map(_is_text, value)))
HEX = Rule("32 hexadecimal digits", lambda value: type(value) is str and len(value) == 32 and set(value) <= set("0123456789abcdef"))
NUMBERS = Rule("a list of the numbers of jobs, as texts",
               lambda value: type(value) is list and all(type(number) is str and number.isdecimal() for number in value))


def member(rule, **default):
    """A field of a dataclass whose value obeys `rule`."""
    return dataclasses.field(metadata={"rule": rule}, **default)


def checked(kind, data):
    """A dataclass `kind` of members, from JSON."""
    if type(data) is not dict:
        raise Failure("not an object")
    fields = {field.name: field for field in dataclasses.fields(kind)}
    for name, value in data.items():
        if name not in fields:
            raise Failure(f'unknown member "{shown(name, 40)}"')
        rule = fields[name].metadata["rule"]
        if not rule.holds(value):
            raise Failure(f'"{name}" must be {rule.text}')
    for name, field in fields.items():
        if name not in data and field.default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING:
            raise Failure(f'"{name}" is missing')
    return kind(**data)
