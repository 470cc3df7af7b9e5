# import latent: what it reads is what `cat` prints, what it writes passes verify, misuse is an exception.
# Usage: module_test.py LATENT-INSPECT CONVERGENCE.PY, with the module in PYTHONPATH.
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy as np

import latent

INSPECT, CONVERGENCE = sys.argv[1:3]


def inspect(*arguments, **options):
    return subprocess.run([INSPECT, *map(str, arguments)], check=True, capture_output=True, text=True, **options).stdout


class Module(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return pathlib.Path(self.folder.name) / name

    def generated(self, *options):
        path = self.path("a.latent")
        inspect("gen", "-o", path, "--records", "30000", "--light", "0.1", "--run-samples", "4096", *options)
        return path

    def compare_with_cat(self, path, k):
        columns = latent.open(path).read()
        records = [json.loads(line) for line in inspect("cat", "--format", "json", path).splitlines()]
        self.assertEqual(len(columns["sample"]), len(records))
        for name in columns:
            expected = {"class": lambda r: int(r["class"] == "light"),
                        "wavelengths": lambda r: r["lambda_nm"] + [0] * (k - len(r["lambda_nm"])),
                        "power": lambda r: r["power"] + [0] * (k - len(r["power"]))}.get(name, lambda r: r[name])
            wanted = np.array([expected(record) for record in records], columns[name].dtype)
            np.testing.assert_array_equal(columns[name], wanted, name)

    def test_every_column_holds_what_cat_prints(self):
        self.compare_with_cat(self.generated(), 0)

    def test_spectral_columns_hold_what_cat_prints(self):
        self.compare_with_cat(self.generated("--kind", "spectral", "--wavelengths", "5", "--single", "0.3"), 5)

    def test_numpy_loads_what_cat_writes(self):
        for path in (self.generated(), self.generated("--kind", "spectral", "--wavelengths", "5", "--single", "0.3", "--force")):
            with open(self.path("a.npy"), "wb") as out:
                subprocess.run([INSPECT, "cat", "--format", "npy", path], check=True, stdout=out)
            loaded, columns = np.load(self.path("a.npy")), latent.open(path).read()
            self.assertGreaterEqual(len(loaded), 30000)
            for name, column in columns.items():
                np.testing.assert_array_equal(loaded[{"wavelengths": "lambda_nm"}.get(name, name)], column, name)
            refused = subprocess.run([INSPECT, "cat", "--format", "npy", path], capture_output=True, text=True)
            self.assertEqual((refused.returncode, refused.stdout), (2, ""))
            self.assertIn("FILE.npy", refused.stderr)

    def test_a_selection_holds_exactly_the_records_that_it_describes(self):
        night = latent.open(self.generated())
        everything = night.read()
        u, v, sample = everything["u"], everything["v"], everything["sample"]
        keep = (everything["class"] == 0) & (u >= 0.2) & (u < 0.7) & (v >= 0.1) & (v < 0.9) & (sample >= 5000) & (sample < 20000)
        chosen = night.read(["sample", "y"], region=(0.2, 0.1, 0.7, 0.9), samples=(5000, 20000), classes="camera")
        self.assertEqual(set(chosen), {"sample", "y"})
        self.assertGreater(keep.sum(), 1000)
        np.testing.assert_array_equal(chosen["sample"], sample[keep])
        np.testing.assert_array_equal(chosen["y"], everything["y"][keep])

    def test_runs_divide_the_records(self):
        night = latent.open(self.generated())
        runs = night.info["runs"]
        self.assertGreater(runs, 3)
        halves = [night.read(["y"], runs=half)["y"] for half in ((0, 2), (2, runs))]
        np.testing.assert_array_equal(np.concatenate(halves), night.read(["y"])["y"])

    def test_no_record_gives_empty_columns(self):
        columns = latent.open(self.generated("--kind", "spectral", "--wavelengths", "5")).read(samples=(10**9, 10**9 + 1))
        self.assertEqual(columns["power"].shape, (0, 5))
        self.assertEqual(columns["u"].shape, (0,))

    def test_what_the_writer_writes_comes_back_and_passes_verify(self):
        random = np.random.default_rng(1)
        n, k = 5000, 3
        given = {"sample": np.arange(n), "u": random.random(n), "v": random.random(n),
                 "power": random.random((n, k), np.float32), "wavelengths": random.uniform(400, 700, (n, k)).astype(np.float32)}
        path = self.path("w.latent")
        with latent.Writer(path, job_id="0123456789abcdef" * 2, samples=(0, n), wavelengths=k, aspect=(3, 2)) as part:
            self.assertEqual(part.missing.tolist(), [[0, n]])
            part.write(**given)
        inspect("verify", "--deep", "--strict", path)
        night = latent.open(path)
        self.assertEqual((night.job["id"], night.job["aspect"], night.job["kind"]), ("0123456789abcdef" * 2, (3, 2), "spectral"))
        read = night.read()
        order = np.argsort(read["sample"])
        for name in ("sample", "power", "wavelengths"):
            np.testing.assert_array_equal(read[name][order], given[name], name)
        np.testing.assert_array_equal(read["u"][order], np.floor(given["u"] * 2**32) / 2**32)
        np.testing.assert_array_equal(read["share"], 1)

    def test_records_of_a_sample_that_was_submitted_before_are_refused(self):
        def records(first, end):
            zeros = np.zeros(end - first)
            return {"sample": np.arange(first, end), **{name: zeros for name in "uvxyz"}}

        with latent.Writer(self.path("w.latent"), job_id="1" * 32, samples=(0, 4096)) as part:
            part.write(**records(0, 1000))
            for first, end in ((1000, 2000), (4095, 4096)):
                self.assertRaisesRegex(ValueError, f"^sample: {first} was submitted before", part.write, **records(first, end))
        with latent.Writer(self.path("v.latent"), job_id="1" * 32, samples=(0, 4096)) as part:
            part.submit(next(part.grains()), **records(0, 1024))
            part.write(**records(1024, 4096))
        self.assertEqual([latent.open(self.path(name)).info["camera_records"] for name in ("w.latent", "v.latent")], [1000, 4096])

    def test_a_record_has_up_to_128_columns_of_its_own(self):
        random = np.random.default_rng(2)
        n, path = 4000, self.path("w.latent")
        zeros = np.zeros(n)
        extra = {f"feature {i}": random.random(n, np.float32) for i in range(128)}
        with latent.Writer(path, job_id="1" * 32, samples=(0, n), extra=dict.fromkeys(extra, "f4")) as part:
            part.write(sample=np.arange(n), u=random.random(n), v=random.random(n), x=zeros, y=zeros, z=zeros, extra=extra)
        inspect("verify", "--deep", "--strict", path)
        night = latent.open(path)
        self.assertGreaterEqual(night.info["pages"], 3)  # of at most 1536 records
        read = night.read(["sample", *extra])
        for name, column in extra.items():
            np.testing.assert_array_equal(read[name], column[read["sample"]], name)
        self.assertRaisesRegex(latent.Error, "more than 128 extra columns", latent.Writer, self.path("e.latent"), job_id="1" * 32,
                               samples=(0, n), extra=dict.fromkeys([*extra, "one more"], "f4"))

    def test_a_part_that_was_not_finished_resumes(self):
        path, job = self.path("w.latent"), {"job_id": "1" * 32, "samples": (0, 4096)}
        part = latent.Writer(path, **job)
        grain = next(part.grains())
        zeros = np.zeros(1024, np.float32)
        part.submit(grain, sample=np.arange(1024), u=zeros, v=zeros, x=zeros, y=zeros, z=zeros)
        part.checkpoint()
        part.close()
        self.assertEqual(latent.Writer(path, **job).missing.tolist(), [[1024, 4096]])

    def test_misuse_is_an_exception(self):
        night = latent.open(self.generated())
        self.assertRaises(latent.Error, latent.open, self.path("absent.latent"))
        self.assertRaises(KeyError, night.pages, ["power"])
        self.assertRaises(ValueError, night.pages, [])
        self.assertRaises(ValueError, night.pages, region=(0, 0, 1))
        self.assertRaises(ValueError, night.pages, region=(0.5, 0, 0.4, 1))
        self.assertRaises(ValueError, night.pages, samples=(5, 5))
        self.assertRaises(ValueError, night.pages, classes="none")
        self.assertRaises(TypeError, latent.Writer, self.path("w.latent"))
        self.assertRaises(ValueError, latent.Writer, self.path("w.latent"), job_id="1" * 32, samples=(2, 2))
        part = latent.Writer(self.path("w.latent"), job_id="1" * 32, samples=(0, 1024))
        one = np.zeros(1)
        self.assertRaises(ValueError, part.submit, (0, 1024), sample=[0], u=one, v=one)
        self.assertRaises(ValueError, part.submit, (0, 1024), sample=[0], u=one + 1, v=one, x=one, y=one, z=one)
        self.assertRaises(ValueError, part.submit, (0, 1024), sample=[0], u=one, v=one, x=one, y=one, z=np.zeros(2))
        self.assertRaises(latent.Error, part.submit, (0, 1024), sample=[5000], u=one, v=one, x=one, y=one, z=one)
        self.assertRaises(latent.Error, part.finish)
        part.close()
        self.assertRaises(ValueError, latent.Writer, self.path("e.latent"), job_id="1" * 32, samples=(0, 1024), extra={"depth": "f2"})
        seen = latent.Writer(self.path("e.latent"), job_id="1" * 32, samples=(0, 1024), extra={"object": "u2"})
        for extra in ({}, {"depth": [1]}, {"object": [1, 2]}, {"object": [70000]}, {"object": [1], "depth": [1]}):
            self.assertRaises(ValueError, seen.submit, (0, 1024), sample=[0], u=one, v=one, x=one, y=one, z=one, extra=extra)
        seen.submit((0, 1024), sample=[0], u=one, v=one, x=one, y=one, z=one, extra={"object": [65535]})
        seen.finish()
        self.assertEqual(latent.open(self.path("e.latent")).read()["object"].tolist(), [65535])
        self.assertRaises(ValueError, part.finish)

    def test_the_example_shows_an_error_that_falls_as_one_over_the_root_of_n(self):
        path = self.generated()
        out = subprocess.run([sys.executable, CONVERGENCE, str(path), "0.5", "0.5", "0.3"], check=True, capture_output=True, text=True,
                             env=os.environ).stdout
        rows = [line.split() for line in out.splitlines() if not line.startswith("#")]
        counts, errors = (np.array([float(row[i]) for row in rows]) for i in (0, 2))
        slope = np.polyfit(np.log(counts[3:]), np.log(errors[3:]), 1)[0]
        self.assertAlmostEqual(slope, -0.5, delta=0.1)


unittest.main(argv=sys.argv[:1])
