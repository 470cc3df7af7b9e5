# docs/library.md: every piece of Python in it runs, in the order of the page.
# Usage: library_test.py LATENT-INSPECT LIBRARY.MD, with the module in PYTHONPATH.
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import numpy as np

import latent

INSPECT, PAGE = sys.argv[1:3]
N, K = 4096, 4


def render(first, end):
    random = np.random.default_rng(first)
    n = end - first
    return {"sample": np.arange(first, end), "u": random.random(n), "v": random.random(n), "power": random.random((n, K)),
            "wavelengths": np.sort(random.uniform(400, 700, (n, K)))}


class Library(unittest.TestCase):
    def files(self):
        """What the page reads."""
        def generated(name, *options):
            subprocess.run([INSPECT, "gen", "-o", name, "--records", str(N), "--run-samples", "1024", *options], check=True, capture_output=True)

        generated("night.latent")
        generated("night-0.latent")
        generated("night-1.latent", "--first", str(N))
        for name in ("day.latent", "depth-0.latent", "depth-1.latent", "depth-2.latent"):
            generated(name, "--kind", "spectral", "--wavelengths", "8")
        random = np.random.default_rng(1)
        u, v = random.random(N), random.random(N)
        with latent.Writer("seen.latent", job_id="1" * 32, samples=(0, N), extra={"depth": "f4", "gloss": "f4"}) as part:
            part.write(sample=np.arange(N), u=u, v=v, x=u, y=u, z=u, extra={"depth": u, "gloss": v})
        lens = {name: random.integers(0, 256, N).astype(np.uint8) for name in ("lens.x", "lens.y", "shutter")}
        with latent.Writer("portrait.latent", job_id="2" * 32, samples=(0, N), extra=dict.fromkeys(lens, "u1")) as part:
            part.write(sample=np.arange(N), u=u, v=v, x=u, y=u, z=u, extra=lens)

    def test_every_piece_of_python_runs(self):
        pieces = re.findall("^```python\n(.*?)^```", pathlib.Path(PAGE).read_text(), re.MULTILINE | re.DOTALL)
        self.assertGreaterEqual(len(pieces), 4)
        random = np.random.default_rng(2)
        names = {"id": "0123456789abcdef" * 2, "n": N, "np": np, "latent": latent, "render": render}
        names.update({name: random.random(N) for name in ("u", "v", "x", "y", "z", "depth", "gloss")})
        back = os.getcwd()
        self.addCleanup(os.chdir, back)
        for piece in pieces:
            with self.subTest(piece=piece.split("\n")[0]), tempfile.TemporaryDirectory() as folder:
                os.chdir(folder)
                if "Writer" not in piece:
                    self.files()
                exec(compile(piece, PAGE, "exec"), dict(names))
                os.chdir(back)


unittest.main(argv=sys.argv[:1])
