"""The other tools, and Slurm's: where they are, and what they answer."""
import json
import os
import pathlib
import shutil
import subprocess
import sys

from latent_farm.errors import Failure, Misuse, USAGE

TEXT = {"encoding": "utf-8", "errors": "surrogateescape"}  # as names of files are read


def path_of(name):
    """Beside latent-farm itself, or on the PATH."""
    beside = pathlib.Path(sys.argv[0]).resolve().parent / name
    found = str(beside) if os.access(beside, os.X_OK) else shutil.which(name)
    if not found:
        raise Failure(f"{name}: not found, neither beside latent-farm nor on the PATH")
    return found


def output_of(command):
    """The standard output of a command that must succeed."""
    try:
        done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, **TEXT)
    except OSError as error:
        raise Failure(f"{command[0]}: {error.strerror}") from None
    if done.returncode != 0:
        lines = done.stderr.strip().splitlines() or [f"ended with status {done.returncode}"]
        fault = Misuse if done.returncode == USAGE else Failure
        raise fault(lines[-1].removeprefix(os.path.basename(command[0]) + ": "))
    return done.stdout


def check_options(option, name, words, output):
    """Errors: Misuse, if the tool does not know some of `words`, the value of our `option`. It gets a file to read that cannot be there."""
    command = [path_of(name), f"{os.devnull}/none", "-o", f"no such folder/{output}", *words]
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, **TEXT)
    if done.returncode == USAGE:
        raise Misuse(f"{option}: " + (done.stderr.strip().splitlines() or [name])[-1])


def forecast(arguments, output):
    """What latent-render expects of a render, measured as by its --dry-run. Warnings go to standard error."""
    command = [path_of("latent-render"), *arguments, "--dry-run", "--json", "--quiet", "-o", str(output)]
    return json.loads(output_of(command))


def noise(arguments, width):
    """What latent-inspect says about the noise of samples, in a picture `width` pixels wide; 0: as wide as they were rendered for."""
    size = ["--size", str(width)] if width else []
    return json.loads(output_of([path_of("latent-inspect"), "noise", "--json", "--quiet", *map(str, arguments), *size]))


def info(files):
    """What latent-inspect says about each file, in their order; of one that cannot be read, its error."""
    command = [path_of("latent-inspect"), "info", "--json", "--quiet", *map(str, files)]
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, **TEXT)
    try:
        answer = json.loads(done.stdout)
    except ValueError:
        raise Failure(done.stderr.strip() or f"latent-inspect ended with status {done.returncode}") from None
    return answer if isinstance(answer, list) else [answer]
