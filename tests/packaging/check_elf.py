#!/usr/bin/env python3
"""Programs and libraries load nothing from the current folder, and ours are hardened.

    check_elf.py PATH...

PATH is a program, a library, an object file, a folder, a Debian package, a wheel or a tar archive. Each file in it must have no entry
in its search path that is empty or relative, for both mean the folder in which the user is. What Latent installs must also have what
Debian's hardening gives: position-independent code, relocations that are done and read-only before it runs, a stack without code,
checked buffers, and, where the compiler's own start files have it, checked jumps. Prints one line for each fault; status 1 if there
are any."""
import functools
import os
import pathlib
import re
import subprocess
import sys
import tempfile

OURS = re.compile(r"(latent-\w+|liblatent\.so.*|latent_\w+\.so|_latent\b.*\.so)$")


def readelf(*arguments):
    return subprocess.run(["readelf", "-W", *map(str, arguments)], check=True, capture_output=True, text=True, env={**os.environ, "LC_ALL": "C"}).stdout


def is_elf(path):
    if path.is_symlink() or not path.is_file():
        return False
    with open(path, "rb") as file:
        return file.read(4) == b"\x7fELF"


def machine(header):
    return re.search(r"Machine:.*", header)[0]


def marks_jumps(path):
    return re.search(r"Properties:.*\b(IBT|BTI)\b", readelf("-n", path)) is not None


@functools.cache
def compiler_marks_jumps():
    """Whether it does so unasked: it needs the system's start files for that."""
    with tempfile.TemporaryDirectory() as folder:
        program = os.path.join(folder, "a")
        subprocess.run(["c++", "-x", "c++", "-", "-o", program], check=True, input="int main() {}", text=True)
        return marks_jumps(program)


def search_path_faults(dynamic):
    for kind, entries in re.findall(r"\((RPATH|RUNPATH)\).*?\[(.*)\]", dynamic):
        for entry in entries.split(":"):
            if not re.match(r"(/|\$ORIGIN(/|$)|\$\{ORIGIN\}(/|$))", entry):
                yield f"its {kind} [{entries}] has the entry '{entry}': libraries would be loaded from the current folder"
    for name in re.findall(r"\(NEEDED\).*\[(.*)\]", dynamic):
        if "/" in name and not name.startswith("/"):
            yield f"it needs '{name}', a path that begins in the current folder"


def hardening_faults(path, header, dynamic):
    segments, imports = readelf("-l", path), set(re.findall(r" UND (\w+)", readelf("--dyn-syms", path)))
    if "DYN (" not in header:
        yield "it is not position-independent (PIE)"
    if "GNU_RELRO" not in segments:
        yield "its relocations stay writable (-z relro)"
    if not re.search(r"\((BIND_NOW|FLAGS)\).*BIND_NOW|\(FLAGS_1\).*NOW", dynamic):
        yield "its functions are bound late (-z now)"
    if not re.search(r"GNU_STACK.* RW +0x", segments):
        yield "its stack may hold code"
    if "(TEXTREL)" in dynamic:
        yield "it relocates its code"
    if "__stack_chk_fail" not in imports:
        yield "its stack is not protected (-fstack-protector-strong)"
    if not any(re.fullmatch(r"__\w+_chk", name) for name in imports):
        yield "its buffers are not checked (-D_FORTIFY_SOURCE=2)"
    if machine(header) == machine(readelf("-h", sys.executable)) and compiler_marks_jumps() and not marks_jumps(path):
        yield "its jumps are not checked (-fcf-protection)"


def faults(path):
    header = readelf("-h", path)
    if "REL (" in header:  # an object file
        return
    dynamic = readelf("-d", path)
    yield from search_path_faults(dynamic)
    if OURS.match(path.name):
        yield from hardening_faults(path, header, dynamic)


def unpacked(path, folder):
    """The files of an archive, in `folder`; else `path` itself."""
    unpack = (["dpkg-deb", "-x", path, folder] if path.suffix == ".deb"
              else [sys.executable, "-m", "zipfile", "-e", path, folder] if path.suffix == ".whl"
              else ["tar", "-xf", path, "-C", folder] if re.search(r"\.tar(\.\w+)?$", path.name) else None)
    if unpack is None:
        return path
    subprocess.run(list(map(str, unpack)), check=True)
    return pathlib.Path(folder)


def check(path):
    """Prints the faults below `path`; returns how many files there are, and how many faults."""
    with tempfile.TemporaryDirectory() as folder:
        root = unpacked(path, folder)
        files = [f for f in (sorted(root.rglob("*")) if root.is_dir() else [root]) if is_elf(f)]
        found = [f"{path}{'' if root == f else ': ' + str(f.relative_to(root))}: {fault}" for f in files for fault in faults(f)]
    print("".join(line + "\n" for line in found), end="")
    return len(files), len(found)


def main(paths):
    results = {path: check(pathlib.Path(path)) for path in paths}
    for path, (files, _) in results.items():
        if files == 0:
            print(f"{path}: there is no program or library in it")
    print(f"{sum(files for files, _ in results.values())} programs and libraries: {sum(found for _, found in results.values())} faults")
    return 1 if any(files == 0 or found for files, found in results.values()) else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]) if len(sys.argv) > 1 else print(__doc__) or 2)
