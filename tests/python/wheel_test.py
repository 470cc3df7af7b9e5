# The wheel holds the module, whole, and works where it is installed. Usage: wheel_test.py PYTHON_FOLDER BUILD LATENT-INSPECT
import base64
import csv
import hashlib
import importlib.util
import io
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest
import zipfile

SOURCES, BUILD, INSPECT = sys.argv[1:4]


def pip(*arguments):
    subprocess.run([sys.executable, "-m", "pip", "--quiet", *map(str, arguments)], check=True, capture_output=True)


@unittest.skipIf(importlib.util.find_spec("pip") is None, "pip is not installed (scripts/install python)")
class Wheel(unittest.TestCase):
    def test_the_wheel_is_whole_and_can_be_imported(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            pip("wheel", SOURCES, "-w", folder, "--no-deps", "--no-index", "--config-settings", f"build={BUILD}")
            (path,) = folder.glob("latent-*.whl")
            with zipfile.ZipFile(path) as wheel:
                names = set(wheel.namelist())
                (record,) = (n for n in names if n.endswith(".dist-info/RECORD"))
                rows = list(csv.reader(io.StringIO(wheel.read(record).decode())))
                self.assertEqual({row[0] for row in rows}, names)
                for file, digest, size in rows:
                    if file != record:
                        data = wheel.read(file)
                        self.assertEqual(int(size), len(data), file)
                        self.assertEqual(digest, "sha256=" + base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode())
            subprocess.run([sys.executable, "-B", pathlib.Path(SOURCES).parent / "tests/packaging/check_elf.py", path], check=True)
            pip("install", "--target", folder / "site", "--no-deps", "--no-index", path)
            subprocess.run([INSPECT, "gen", "-o", folder / "a.latent", "--records", "4096", "--quiet"], check=True, capture_output=True)
            out = subprocess.run([sys.executable, "-B", "-c", "import latent, sys; print(latent.__file__, latent.develop(sys.argv[1], size=8).shape)",
                                  str(folder / "a.latent")], check=True, capture_output=True, text=True,
                                 env={**os.environ, "PYTHONPATH": str(folder / "site")}).stdout
            self.assertEqual(out.split(" ", 1), [str(folder / "site/latent/__init__.py"), "(8, 8, 3)\n"])


unittest.main(argv=sys.argv[:1])
