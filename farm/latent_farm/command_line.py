"""The command line of latent-farm, in outline."""
import argparse
import sys

from latent_farm.commands import RUN
from latent_farm.errors import DONE, Failure, Misuse, STOPPED, without_secrets
from latent_farm.grammar import make_commands


def run(arguments, version):
    tool = make_commands()
    own = arguments[:arguments.index("--")] if "--" in arguments else arguments
    if "--version" in own:
        print(f"latent-farm {version}")
        return DONE
    command = tool.commands.get(own[0]) if own else None
    if "--help" in own or "-h" in own:
        print((command or tool).help(), end="")
        return DONE
    if command is None:
        raise Misuse(f"'{own[0]}' is not a command (--help lists them)" if own else "a command is missing (--help lists them)")
    defaults = argparse.Namespace(scene=None, spp=None, tasks=0, options=arguments[len(own) + 1:])
    return RUN[own[0]](command.parser.parse_args(own[1:], defaults))


def main(arguments, version):
    try:
        return run(arguments, version)
    except (Failure, argparse.ArgumentError) as error:
        print(f"latent-farm: {without_secrets(str(error))}", file=sys.stderr)
        return getattr(error, "status", Misuse.status)
    except KeyboardInterrupt:
        print("latent-farm: interrupted; run the same command again to resume", file=sys.stderr)
        return STOPPED
