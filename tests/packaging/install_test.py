"""What is built and what is installed loads nothing from the folder in which the user is, and is hardened; installed scenes render.

Usage: install_test.py BUILD"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import check_elf

BUILD = pathlib.Path(sys.argv[1]).resolve()


def needed(path):
    return re.findall(r"\(NEEDED\).*\[(.*)\]", check_elf.readelf("-d", path))


class Install(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        cls.folder = pathlib.Path(temporary.name)
        cls.stage = cls.folder / "stage"
        subprocess.run(["cmake", "--install", BUILD, "--prefix", cls.stage], check=True, capture_output=True)

    def test_every_program_and_library_is_safe(self):
        for folder in (BUILD, self.stage):
            files, faults = check_elf.check(folder)
            self.assertEqual(faults, 0, folder)
            self.assertGreater(files, 6, folder)

    def test_libraries_beside_a_strangers_file_are_not_loaded(self):
        tools = [path for folder in (BUILD / "bin", self.stage / "bin") for path in sorted(folder.glob("latent-*")) if check_elf.is_elf(path)]
        self.assertGreaterEqual(len(tools), 10)
        current = self.folder / "current"
        current.mkdir(exist_ok=True)
        for library in {"latent_http.so", "latent_oiio.so", *(name for tool in tools for name in needed(tool))}:
            (current / library).write_text("not a library: a tool that loads this fails")
        env = {key: value for key, value in os.environ.items() if key != "LD_LIBRARY_PATH"}
        for tool in tools:
            run = subprocess.run([tool, "--version"], cwd=current, env=env, capture_output=True, text=True)
            self.assertEqual(run.returncode, 0, f"{tool}: {run.stderr}")

    def test_every_installed_scene_renders(self):
        scenes = sorted((self.stage / "share/latent/scenes").glob("*.pbrt"))
        self.assertGreater(len(scenes), 20)
        for scene in scenes:
            part = self.folder / (scene.stem + ".latent")
            command = [self.stage / "bin/latent-render", scene, "--resolution", "4x4", "--spp", "1", "--quiet", "-o", part]
            run = subprocess.run(command, capture_output=True, text=True)
            self.assertEqual(run.returncode, 0, run.stderr)

    def test_faults_are_found(self):
        source = self.folder / "a.c"
        source.write_text("int main(void) { return 0; }\n")

        def faults(name, *flags):
            subprocess.run(["cc", source, "-o", self.folder / name, *flags], check=True)
            return " ".join(check_elf.faults(self.folder / name))

        safe = ["-Wl,-rpath,$ORIGIN/../lib"]
        self.assertEqual(faults("other", *safe), "")
        for path in ("$ORIGIN/../lib:", ":$ORIGIN", "lib", "/usr/lib::/lib", ".", "$ORIGINAL/lib"):
            self.assertIn("from the current folder", faults("other", f"-Wl,-rpath,{path}"), path)
        self.assertIn("from the current folder", faults("other", "-Wl,--disable-new-dtags,-rpath,lib"))
        ours = faults("latent-a", *safe, "-no-pie", "-Wl,-z,norelro,-z,lazy,-z,execstack", "-fno-stack-protector")
        for word in ("PIE", "relro", "now", "hold code", "stack-protector", "FORTIFY"):
            self.assertIn(word, ours)


unittest.main(argv=sys.argv[:1])
