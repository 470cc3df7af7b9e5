"""The command line of latent-farm, in outline."""
import argparse
import signal
import sys

from latent_farm.commands import RUN
from latent_farm.errors import DONE, FAILED, Failure, Misuse, STOPPED
from latent_farm.grammar import make_commands
from latent_farm.names import shown, without_secrets
from latent_farm.output import say


def run(arguments, version):
    tool = make_commands()
    own = arguments[:arguments.index("--")] if "--" in arguments else arguments
    if "--version" in own:
        say(f"latent-farm {version}\n")
        return DONE
    command = tool.commands.get(own[0]) if own else None
    if "--help" in own or "-h" in own:
        say((command or tool).help())
        return DONE
    if command is None:
        raise Misuse(f"'{own[0]}' is not a command (--help lists them)" if own else "a command is missing (--help lists them)")
    defaults = argparse.Namespace(scene=None, spp=None, tasks=0, options=arguments[len(own) + 1:])
    return RUN[own[0]](command.parser.parse_args(own[1:], defaults))


def fail(text, status):
    print(f"latent-farm: {shown(without_secrets(text))}", file=sys.stderr)
    return status


def main(arguments, version):
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)  # as for every tool whose reader has gone
    for stream in filter(None, (sys.stdout, sys.stderr)):
        stream.reconfigure(errors="backslashreplace")
    try:
        return run(arguments, version)
    except Failure as error:
        return fail(str(error), error.status)
    except OSError as error:
        return fail(f"{error.filename}: {error.strerror}" if error.filename else str(error), FAILED)
    except KeyboardInterrupt:
        return fail("interrupted; run the same command again to resume", STOPPED)
