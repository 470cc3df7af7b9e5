"""The command line's grammar and its help, in the layout of the other tools."""
import argparse
import textwrap

from latent_farm.errors import Misuse

WIDTH, COLUMN = 80, 31


class Command:
    """One command of a tool: what it takes, and what --help says about it. Or the tool itself, with commands."""

    def __init__(self, name, about, usage, epilog):
        self.name, self.about, self.usage, self.epilog = name, about, usage, epilog
        self.arguments, self.options, self.commands = [], [], {}
        self.parser = argparse.ArgumentParser(prog=name, add_help=False, allow_abbrev=False)
        self.parser.error = self._misuse

    def _misuse(self, message):
        if message.endswith("expected one argument"):  # argparse takes words with a dash for options
            option = message.split()[1].removesuffix(":").split("/")[-1]
            message = f"{option}: a value is missing; one that begins with a dash needs an equals sign, as in {option}=\"--option value\""
        raise Misuse(f"{message} (--help explains)")

    def argument(self, name, text, **settings):
        self.arguments.append((settings.get("metavar", name), text))
        self.parser.add_argument(name, **settings)

    def option(self, names, value, text, **settings):
        """`names`: "-o,--output"; `value`: what follows, such as FILE; None for a switch."""
        shown = names + (f" {value}" if value else "")
        default = settings.pop("shown_default", None)
        self.options.append((shown + (f" [{default}]" if default is not None else ""), text))
        if not value:
            settings.setdefault("action", "store_true")
        else:
            settings["metavar"] = value
        self.parser.add_argument(*names.split(","), **settings)

    def help(self):
        parts = [self.about, "Usage: " + self.usage]
        if self.arguments:
            parts.append("Arguments:\n" + "\n".join(row(*item) for item in self.arguments))
        parts.append("Options:\n" + "\n".join(row(*item) for item in [*self.options, ("--version", "print the version"),
                                                                      ("-h,--help", "print this help")]))
        if self.commands:
            parts.append("Commands:\n" + "\n".join(row(name, command.about) for name, command in self.commands.items()))
        return "\n\n".join([*parts, self.epilog.strip()]) + "\n"


def row(left, right):
    lines = textwrap.wrap(right, WIDTH - COLUMN, break_on_hyphens=False)
    head = "  " + left
    if len(head) + 1 > COLUMN - 1:
        lines.insert(0, "")
    return "\n".join(((head if i == 0 else "").ljust(COLUMN) + line).rstrip() for i, line in enumerate(lines))
