#!/usr/bin/env python3
"""Shell completions know every option of every help text, and manual pages name every tool and command.

    check_completions.py FOLDER_OF_TOOLS"""
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
COMMANDS = {"latent-render": [], "latent-merge": [], "latent-develop": [], "latent-convert": [], "latent-print": [], "latent-darkroom": [],
            "latent-inspect": ["info", "verify", "recover", "cat", "gen"], "latent-farm": ["plan", "submit", "status", "resume"]}


def options_of(tools, *command):
    text = subprocess.run([tools / command[0], *command[1:], "--help"], check=True, capture_output=True, text=True).stdout
    lines = re.findall(r"^  (-[-\w,]+)", text, re.M)
    return [name for line in lines for name in line.split(",")]


def main(tools):
    missing = []
    with tempfile.TemporaryDirectory() as out:
        out = pathlib.Path(out)
        subprocess.run([ROOT / "packaging/completions", tools, out], check=True)
        for tool, commands in COMMANDS.items():
            texts = {"bash": (out / "bash" / tool).read_text(), "zsh": (out / "zsh" / f"_{tool}").read_text(),
                     "fish": (out / "fish" / f"{tool}.fish").read_text()}
            for command in [(tool,), *((tool, command) for command in commands)]:
                if not (ROOT / "packaging/man" / ("-".join(command) + ".h2m")).exists():
                    missing.append("manual page of " + " ".join(command))
                for option in options_of(tools, *command):
                    long_or_short = "-l " if option.startswith("--") else "-s "
                    spelled = {"bash": option, "zsh": f"*{option}[", "fish": long_or_short + option.lstrip("-")}
                    without = [shell for shell, text in texts.items() if spelled[shell] not in text]
                    missing += [f"{shell}: {' '.join(command)} {option}" for shell in without]
    print("\n".join(missing) or "all options are completed")
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1]).resolve()))
