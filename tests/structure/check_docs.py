#!/usr/bin/env python3
"""Links between the pages lead somewhere, and the commands that they show have the options that they are shown with.

    check_docs.py SOURCES TOOLS     SOURCES: the top of the tree; TOOLS: the folder of the tools

Prints one line for each fault; status 1 if there are any. Links to other sites are not followed."""
import pathlib
import re
import shlex
import subprocess
import sys

sources, tools = map(pathlib.Path, sys.argv[1:])
SKIPPED = re.compile(r"(build.*|node_modules|out|\.git|\.peers)$")


def pages(folder):
    for path in sorted(folder.iterdir()):
        if path.is_dir() and not SKIPPED.match(path.name):
            yield from pages(path)
        elif path.suffix == ".md":
            yield path


def anchors(text):
    """Those that GitHub makes of headings."""
    seen = {}
    for heading in re.findall(r"^#+ +(.*?) *$", re.sub(r"^```.*?^```", "", text, flags=re.M | re.S), flags=re.M):
        words = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)
        anchor = re.sub(r"[^\w\- ]", "", words.lower()).replace(" ", "-")
        count = seen[anchor] = seen.get(anchor, -1) + 1
        yield f"{anchor}-{count}" if count else anchor


def link_faults(page, text):
    prose = re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)
    for target in re.findall(r"\]\(([^)\s]+)\)", re.sub(r"`[^`\n]*`", "``", prose)):
        if re.match(r"[a-z]+:", target):
            continue
        name, _, anchor = target.partition("#")
        path = page.parent / name if name else page
        if not path.exists():
            yield f"the link to {target} leads nowhere"
        elif anchor and path.suffix == ".md" and anchor not in set(anchors(path.read_text())):
            yield f"{path.name} has no heading for the link to #{anchor}"


helps = {}


def help_of(command):
    if command not in helps:
        done = subprocess.run([tools / command[0], *command[1:], "--help"], capture_output=True, text=True)
        helps[command] = done.stdout if done.returncode == 0 else None
    return helps[command]


def command_faults(text):
    for block in re.findall(r"^```sh\n(.*?)^```", text, flags=re.M | re.S):
        for line in block.replace("\\\n", " ").splitlines():
            for command in re.split(r"[|;&]+|\bdo\b|\$\(", line):
                try:
                    words = shlex.split(command, comments=True)
                except ValueError:  # a quotation that goes on elsewhere
                    continue
                if words and re.match(r"(scripts|bench)/", words[0]) and not (sources / words[0]).exists():
                    yield f"there is no {words[0]}"
                if not words or not (tools / words[0]).is_file():
                    continue
                tool = (words[0],)
                if len(words) > 1 and re.fullmatch(r"[a-z]+", words[1]) and help_of((*tool, words[1])) and tool[0] in ("latent-inspect", "latent-farm"):
                    tool = (*tool, words[1])
                known = help_of(tool) or ""
                own = words[:words.index("--")] if "--" in words else words  # what follows is for another program
                for option in (word.partition("=")[0] for word in own if word.startswith("--")):
                    if not re.search(re.escape(option) + r"\b(?!-)", known):
                        yield f"{' '.join(tool)} has no {option}"


faults = 0
for page in pages(sources):
    text = page.read_text()
    for fault in [*link_faults(page, text), *command_faults(text)]:
        print(f"{page.relative_to(sources)}: {fault}")
        faults += 1
sys.exit(1 if faults else 0)
