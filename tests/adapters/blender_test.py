"""The add-on inside Blender: blender_test.py SOURCES TOOLS [PYTHON]. Status 77, skipped, where Blender is not installed.
PYTHON: a Python that has bpy, to be tested instead."""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

sources, tools, *python = sys.argv[1:]
here = pathlib.Path(__file__).resolve().parent
blender = shutil.which("blender")
if not blender and not python:
    print("skipped: Blender is not installed (scripts/install blender)")
    sys.exit(77)
with tempfile.TemporaryDirectory() as folder:
    made = subprocess.run([sys.executable, "-B", f"{sources}/adapters/blender/make_zip", folder], check=True, capture_output=True, text=True).stdout.strip()
    words = [made, folder, sources]
    script = str(here / "blender_inside.py")
    command = [*python, script, *words] if python else [blender, "-b", "--factory-startup", "-noaudio", "--python", script, "--", *words]
    # Blender's Python takes the library beside the first python3 on the PATH for its own.
    environment = {**os.environ, "PATH": f"{tools}:{os.defpath}", "BLENDER_USER_RESOURCES": f"{folder}/profile", "BLENDER_USER_CONFIG": f"{folder}/profile/config",
                   "BLENDER_USER_SCRIPTS": f"{folder}/profile/scripts", "PYTHONDONTWRITEBYTECODE": "1"}
    done = subprocess.run(command, env=environment, stdin=subprocess.DEVNULL, capture_output=True, text=True)
    lines = done.stdout.splitlines()
    print("\n".join(line for line in lines if not line.startswith(("Fra:", "Saved:", " Time:"))))
    if done.returncode or "all passed" not in lines:
        sys.exit(done.stderr[-6000:] or 1)
