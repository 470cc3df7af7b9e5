"""The desktop's thumbnailer shows any file of ours, and bounds what a stranger's file can take. Usage: thumbnail_test.py TOOLS"""
import os
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest

TOOLS = pathlib.Path(sys.argv[1]).resolve()
THUMBNAIL = pathlib.Path(__file__).resolve().parent.parent.parent / "packaging/latent-thumbnail"


class Thumbnail(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        (self.folder / "tmp").mkdir()

    def thumbnail(self, name, first_in_path=TOOLS, pixels=64):
        env = {**os.environ, "PATH": f"{first_in_path}:{TOOLS}:{os.environ['PATH']}", "TMPDIR": str(self.folder / "tmp")}
        run = subprocess.run([THUMBNAIL, name, "out.png", str(pixels)], cwd=self.folder, env=env, capture_output=True, text=True)
        self.assertEqual(list((self.folder / "tmp").iterdir()), [], "nothing is left behind")
        return run

    def gen(self, name, *more):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        subprocess.run([TOOLS / "latent-inspect", "gen", "-o", path, "--records", "10000", "--quiet", *more], check=True, capture_output=True)

    def test_a_file_of_any_name_has_a_thumbnail_of_the_size_asked_for(self):
        for name in ("a.latent", "-o.latent", "http:/b.latent", "a name\nof two lines.latent"):
            self.gen(name)
            run = self.thumbnail(name.replace("http:/", "http://"))
            self.assertEqual(run.returncode, 0, run.stderr)
            png = (self.folder / "out.png").read_bytes()
            self.assertEqual(png[:8], b"\x89PNG\r\n\x1a\n")
            self.assertEqual(max(struct.unpack(">II", png[16:24])), 64)
            (self.folder / "out.png").unlink()

    def test_a_damaged_file_has_none(self):
        (self.folder / "a.latent").write_bytes(b"LATENT" * 1000)
        self.assertNotEqual(self.thumbnail("a.latent").returncode, 0)
        self.assertFalse((self.folder / "out.png").exists())

    def test_a_file_of_which_a_part_is_lost_has_one(self):
        self.gen("a.latent", "--run-samples", "1024")
        bytes_of_file = bytearray((self.folder / "a.latent").read_bytes())
        bytes_of_file[len(bytes_of_file) // 2] ^= 1
        (self.folder / "a.latent").write_bytes(bytes_of_file)
        run = self.thumbnail("a.latent")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertTrue((self.folder / "out.png").exists())

    def test_what_develops_it_has_little_time_memory_and_disk(self):
        self.gen("a.latent")
        greedy = self.folder / "greedy"
        greedy.mkdir()
        (greedy / "latent-develop").write_text(
            "#!/usr/bin/env python3\nimport resource as r, sys\n"
            f"open({str(self.folder / 'limits')!r}, 'w').write(repr([r.getrlimit(x)[1] for x in (r.RLIMIT_CPU, r.RLIMIT_AS, r.RLIMIT_FSIZE)]))\n"
            "bytearray(1 << 32)\n")
        (greedy / "latent-develop").chmod(0o755)
        run = self.thumbnail("a.latent", greedy)
        self.assertIn("MemoryError", run.stderr)
        self.assertNotEqual(run.returncode, 0)
        cpu_seconds, memory_bytes, file_bytes = eval((self.folder / "limits").read_text())
        self.assertTrue(0 < cpu_seconds <= 60)
        self.assertTrue(0 < memory_bytes <= 2 << 30)
        self.assertTrue(0 < file_bytes <= 1 << 30)


unittest.main(argv=sys.argv[:1])
