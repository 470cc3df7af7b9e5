# latent.develop and latent.merge: the same bits as the tools', whatever the options; what they leave out is a warning or a list.
# Usage: tools_test.py FOLDER_OF_TOOLS FOLDER_OF_EXAMPLES, with the module in PYTHONPATH.
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy as np

import exr
import latent

TOOLS, EXAMPLES = map(pathlib.Path, sys.argv[1:3])
AOVS = ["albedo", "normal", "depth", "position", "id"]


def tool(name, *arguments):
    return subprocess.run([TOOLS / name, *map(str, arguments)], check=True, capture_output=True, text=True).stdout


class Tools(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def generated(self, name="a.latent", *options, records=60000):
        path = self.folder / name
        tool("latent-inspect", "gen", "-o", path, "--records", records, "--light", "0.1", "--run-samples", "4096", *options)
        return path

    def developed(self, path, *options):
        tool("latent-develop", path, "-o", self.folder / "p.exr", "--force", *options)
        return exr.read(self.folder / "p.exr")

    def expect_equal(self, pixels, picture):
        self.assertEqual(pixels.dtype, np.float32)
        for i, name in enumerate("RGB"):
            np.testing.assert_array_equal(pixels[:, :, i], picture[name])

    def test_pixels_are_those_of_the_tool_to_the_bit(self):
        path = self.generated()
        self.expect_equal(latent.develop(path, size=300, memory=2**25), self.developed(path, "--size", "300"))
        self.expect_equal(latent.develop(path, size=np.int64(40), filter="box", image="camera", samples=(0, 20000), threads=1),
                          self.developed(path, "--size", "40", "--filter", "box", "--image", "camera", "--samples", "0:20000"))
        width, height = latent.develop(path, size=600).shape[1::-1]
        crop = (10, 20, 400, 300)
        self.expect_equal(latent.develop(path, size=(width, height), crop=crop),
                          self.developed(path, "--size", f"{width}x{height}", "--crop", ",".join(map(str, crop))))
        self.expect_equal(latent.develop(path), self.developed(path))

    def test_spectral_pictures_are_those_of_the_tool_to_the_bit(self):
        path = self.generated("s.latent", "--kind", "spectral", "--wavelengths", "8")
        self.expect_equal(
            latent.develop(path, size=50, observer="kodak_trix_400", lens_filter="wratten-25", filter_factor="auto"),
            self.developed(path, "--size", "50", "--observer", "kodak_trix_400", "--lens-filter", "wratten-25", "--filter-factor", "auto"))
        self.expect_equal(latent.develop(path, size=50, observer="canon_eos_5d", camera_xyz=True),
                          self.developed(path, "--size", "50", "--observer", "canon_eos_5d", "--camera-output", "xyz"))
        self.expect_equal(latent.develop(path, size=50, estimator="ratio"), self.developed(path, "--size", "50", "--estimator", "ratio"))
        self.assertFalse(np.array_equal(latent.develop(path, size=50, estimator="ratio"), latent.develop(path, size=50)))
        bins = latent.develop(path, size=50, spectral_bins=7)
        picture = self.developed(path, "--size", "50", "--spectral-bins", "7")
        self.assertEqual(bins.shape[2], 7)
        for i, name in enumerate(sorted(picture)):  # S0.393,571nm ...: ascending
            np.testing.assert_array_equal(bins[:, :, i], picture[name])

    def test_layers_are_those_of_the_tool_to_the_bit(self):
        path = self.generated()
        with self.assertWarnsRegex(latent.LatentWarning, "variance is that of the camera image"):
            layers = latent.develop_layers(path, size=60, layers=["variance", "count"], halves=True)
        picture = self.developed(path, "--size", "60", "--layers", "variance,count", "--halves")
        self.assertEqual(set(layers), set(picture))
        self.assertIn("variance.G", layers)
        for name, layer in layers.items():
            np.testing.assert_array_equal(layer, picture[name], name)

    def test_what_samples_see_is_that_of_the_tool_to_the_bit(self):
        path = self.folder / "cornell.latent"
        tool("latent-render", EXAMPLES.parent / "scenes" / "cornell.pbrt", "-o", path, "--quiet", "--samples", "0:4096", "--aov", ",".join(AOVS))
        layers = latent.develop_layers(path, size=32, layers=AOVS)
        picture = self.developed(path, "--size", "32", "--layers", ",".join(AOVS))
        self.assertEqual(set(layers), set(picture))
        self.assertLessEqual({"albedo.R", "N.X", "Z", "P.X", "id.object", "id.material"}, set(layers))
        for name, layer in layers.items():
            np.testing.assert_array_equal(layer, picture[name], name)
        # Means of the records' own columns.
        records = latent.open(path).read()
        boxed = latent.develop_layers(path, size=32, filter="box", layers=["depth", "normal"])
        pixel = (records["u"] * 32).astype(int) + (records["v"] * 32).astype(int) * 32
        for layer, column in {"Z": "depth", "N.Y": "normal.y"}.items():
            hits = np.isfinite(records[column])
            count, total = (np.bincount(pixel[hits], weights, 1024) for weights in (None, records[column][hits]))
            np.testing.assert_allclose(boxed[layer].ravel()[count > 0], total[count > 0] / count[count > 0], rtol=1e-5, atol=1e-6)

    def test_what_the_writer_was_given_beside_light_is_developed(self):
        random = np.random.default_rng(4)
        n, path = 20000, self.folder / "w.latent"
        u, v = random.random(n), random.random(n)
        extra = {"depth": 1 + u, "object": (v > 0.5) + 7, "material": np.full(n, 3), "normal.x": u, "normal.y": v, "normal.z": u * v,
                 "R": 2 * u}
        types = {"depth": "f4", "object": "u8", "material": "u2", "normal.x": "f4", "normal.y": "f4", "normal.z": "f4",
                 "R": "f8"}
        with latent.Writer(path, job_id="2" * 32, samples=(0, n), extra=types) as part:
            part.write(sample=np.arange(n), u=u, v=v, x=u, y=u, z=u, extra=extra)
        tool("latent-inspect", "verify", "--deep", "--strict", path)
        self.assertEqual(latent.open(path).job["extra"], types)
        layers = latent.develop_layers(path, size=16, filter="box", layers=["depth", "normal", "id"])
        np.testing.assert_allclose(layers["Z"], 1 + layers["G"], rtol=1e-6)
        np.testing.assert_array_equal(layers["id.object"], np.repeat([[7], [8]], 8, 0) * np.ones((1, 16)))
        np.testing.assert_array_equal(layers["id.material"], 3)
        # Any column, by its name.
        own = latent.develop_layers(path, size=16, filter="box", layers=["object", "normal.y", "R"])
        np.testing.assert_array_equal(own["object"], layers["id.object"])
        np.testing.assert_array_equal(own["normal.y"], layers["N.Y"])
        np.testing.assert_allclose(own["extra.R"], 2 * own["G"], rtol=1e-6)
        picture = self.developed(path, "--size", "16", "--filter", "box", "--layers", "object,normal.y,R")
        for name, layer in own.items():
            np.testing.assert_array_equal(layer, picture[name], name)
        with self.assertRaisesRegex(latent.Error, "layers gloss: no layer and no column of the files, which have depth, object, "):
            latent.develop_layers(path, size=16, layers=["gloss"])
        with self.assertRaisesRegex(latent.Error, "layers albedo: the files have no column albedo.x"):
            latent.develop_layers(path, size=16, layers=["albedo"])

    def test_how_samples_were_made_is_the_same_before_and_after_a_merge(self):
        names = {"light_groups": [{"name": "lamp", "spectrum": {"nm": [400, 700], "value": [1, 1]}}, {"name": "sk\u00ff"}, {}], "materials": ["glass", ""]}
        paths = [self.folder / f"{i}.latent" for i in range(2)]
        for i, path in enumerate(paths):
            zeros = np.zeros(1024)
            with latent.Writer(path, job_id="4" * 32, samples=(i * 1024, (i + 1) * 1024), provenance={"host": f"node{i}", "cpu_seconds": [2.5, "long"][i], **names}) as part:
                part.write(sample=np.arange(1024) + i * 1024, u=zeros, v=zeros, x=zeros, y=zeros, z=zeros)
        latent.merge(*paths, output=self.folder / "m.latent")
        for night in (latent.open(*paths), latent.open(self.folder / "m.latent")):
            self.assertEqual(night.parts, [{"provenance": {"host": f"node{i}", "cpu_seconds": [2.5, "long"][i], **names}, "samples": [(i * 1024, (i + 1) * 1024)]} for i in range(2)])
            self.assertEqual((night.light_groups, night.materials), (["lamp", "sk\u00ff", ""], ["glass", ""]))
        told = latent.info(self.folder / "m.latent")
        self.assertEqual((told["parts"], told["materials"], told["samples"], told["cpu_seconds"]), (night.parts, ["glass", ""], 2048, 2.5))
        silent = latent.open(self.generated())
        self.assertEqual((silent.light_groups, silent.materials, silent.parts[0]["provenance"]), ([], [], {"program": "latent-inspect gen"}))

    def test_fireflies_and_raw_channels_are_those_of_the_tool(self):
        random = np.random.default_rng(5)
        n, path = 20000, self.folder / "f.latent"
        value = np.where(np.arange(n) % 5000 == 0, 1000, 1)
        with latent.Writer(path, job_id="3" * 32, samples=(0, n)) as part:
            part.write(sample=np.arange(n), u=random.random(n), v=random.random(n), x=value, y=value, z=value)
        dimmed = latent.develop(path, size=10, dim_fireflies=True)
        self.expect_equal(dimmed, self.developed(path, "--size", "10", "--dim-fireflies"))
        self.assertLess(dimmed.max(), 1.1)
        self.assertGreater(latent.develop(path, size=10).max(), 3)
        path = self.generated("s.latent", "--kind", "spectral", "--wavelengths", "8")
        self.expect_equal(latent.develop(path, size=10, observer="canon_eos_5d", raw_balance=False),
                          self.developed(path, "--size", "10", "--observer", "canon_eos_5d", "--raw-balance", "none"))

    def test_pixels_outlive_everything_else(self):
        pixels = latent.develop(self.generated(), size=64)[:, :, 1]
        total = pixels.sum()
        _ = [np.ones(pixels.size * 3, np.float32) for _ in range(50)]
        self.assertEqual(pixels.sum(), total)
        self.assertGreater(total, 0)

    def test_what_is_damaged_is_a_warning(self):
        path = self.generated()
        data = bytearray(path.read_bytes())
        data[len(data) // 2] ^= 1
        path.write_bytes(data)
        with self.assertWarns(latent.LatentWarning) as caught:
            latent.develop(path, size=20)
        self.assertIn("a.latent", str(caught.warning))
        self.assertEqual(caught.filename, __file__)

    def test_merge_writes_what_the_tool_writes(self):
        parts = [self.generated(f"{i}.latent", "--first", first, records=32768) for i, first in enumerate((0, 32768))]
        tool("latent-merge", *parts, "-o", self.folder / "tool.latent")
        counts = latent.merge(*reversed(parts), output=self.folder / "m.latent", require=(0, 65536))
        self.assertEqual((self.folder / "m.latent").read_bytes(), (self.folder / "tool.latent").read_bytes())
        self.assertEqual((counts["samples"], counts["files"], counts["left_out"]), (65536, 2, []))
        self.assertEqual(counts["bytes"], (self.folder / "m.latent").stat().st_size)
        compact = latent.merge(*parts, output=self.folder / "m.latent", replace=True, compact=True, verify="full")
        self.assertLess(compact["runs_out"], compact["runs_in"])
        before = parts[0].read_bytes()
        parts[1].write_bytes(before)
        self.assertEqual(latent.merge(*parts, output=self.folder / "n.latent", skip_duplicates=True)["samples"], 32768)
        data = bytearray(before)
        data[len(data) // 2] ^= 1
        parts[0].write_bytes(data)
        left_out = latent.merge(parts[0], output=self.folder / "o.latent")["left_out"]
        self.assertEqual(len(left_out), 1)
        self.assertIn("0.latent", left_out[0])

    def example(self, name, *arguments):
        return subprocess.run([sys.executable, "-B", EXAMPLES / name, *map(str, arguments)], check=True, capture_output=True, text=True)

    def test_an_imported_dump_develops_to_the_means_of_its_pixels(self):
        random = np.random.default_rng(1)
        width, height, samples = 16, 10, 8
        y, x, _ = np.mgrid[0:height, 0:width, 0:samples]
        rgb = random.random((height, width, samples, 3))
        xy = np.stack([x + random.random(x.shape), y + random.random(x.shape)], -1)
        xy[0, 0, 0] = -1  # not on the film
        np.savez(self.folder / "dump.npz", xy=xy, rgb=rgb, size=[width, height])
        out = self.example("import_array.py", self.folder / "dump.npz", self.folder / "d.latent")
        self.assertIn("1 of 1280 samples", out.stderr)
        tool("latent-inspect", "verify", "--deep", "--strict", self.folder / "d.latent")
        pixels = latent.develop(self.folder / "d.latent", size=(width, height), filter="box")
        means = rgb.mean(2)
        means[0, 0] = rgb[0, 0, 1:].mean(0)
        luminance = means @ [0.2126390, 0.7151687, 0.0721923]
        np.testing.assert_allclose(pixels[:, :, 1], luminance, rtol=1e-5)

    def test_the_example_shows_a_picture_and_the_spectrum_of_a_pixel(self):
        path = self.generated("s.latent", "--kind", "spectral", "--wavelengths", "8")
        out = self.example("look.py", path, self.folder / "p.ppm", 0.3, 0.6).stdout.splitlines()
        self.assertRegex(out[0], r"^61 x 61 pixels, mean Y [\d.]+, median standard error [\d.]+%$")
        self.assertEqual(len(out), 48)
        pixels = latent.develop(path)
        bins = latent.develop(path, spectral_bins=47)[int(0.6 * 61), int(0.3 * 61)]
        np.testing.assert_allclose([float(line.split()[2]) for line in out[1:]], bins, rtol=1e-3)
        data = (self.folder / "p.ppm").read_bytes()
        self.assertTrue(data.startswith(b"P6 61 61 255\n"))
        self.assertEqual(len(data), 13 + 3 * 61 * 61)
        code = np.frombuffer(data[13:], np.uint8).reshape(61, 61, 3)
        self.assertGreater(np.corrcoef(code[:, :, 1].ravel(), np.log(pixels[:, :, 1].ravel() + 1e-3))[0, 1], 0.8)

    def test_misuse_is_an_exception(self):
        path = self.generated()
        self.assertRaisesRegex(latent.Error, "absent", latent.develop, self.folder / "absent.latent")
        self.assertRaisesRegex(latent.Error, "needs spectral records", latent.develop, path, observer="kodak_trix_400")
        self.assertRaisesRegex(latent.Error, "nonesuch", latent.develop, path, filter="nonesuch")
        self.assertRaises(latent.Error, latent.develop, path, size=(10, 1000))
        self.assertRaises(latent.Error, latent.develop, path, size=10, crop=(0, 0, 11, 1))
        self.assertRaises(latent.Error, latent.develop_layers, path, layers=["depth"])
        self.assertRaises(ValueError, latent.develop, path, job="x")
        self.assertRaises(ValueError, latent.develop, path, image="none")
        self.assertRaises(ValueError, latent.develop, path, estimator="mean")
        self.assertRaises(ValueError, latent.develop, path, estimator="ratio", spectral_bins=7)
        self.assertRaisesRegex(latent.Error, "spectral", latent.develop, path, estimator="ratio")
        self.assertRaises(ValueError, latent.develop, path, filter_factor=0)
        self.assertRaises(ValueError, latent.develop, path, samples=(5, 5))
        self.assertRaises(TypeError, latent.develop, path, layers=["variance"])
        self.assertRaises(TypeError, latent.develop, path, width=10)
        self.assertRaises(ValueError, latent.merge, path, output=self.folder / "m.latent", verify="none")
        self.assertRaises(latent.Error, latent.merge, path, output=path)
        self.assertRaises(latent.Error, latent.merge, path, output=self.folder / "m.latent", require=(0, 2**40))
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), ["a.latent"])


unittest.main(argv=sys.argv[:1], warnings="error")
