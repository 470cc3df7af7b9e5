# import latent on the conformance corpus: the records of sound files have the bits that `cat` writes; damage and foreign files are
# what expected.json says. Usage: corpus_test.py LATENT-INSPECT, with the module in PYTHONPATH.
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy as np

import latent

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "corpus"))
from corpus import CARELESS, DAMAGED, REFUSED, VALID
from make_corpus import make

INSPECT = sys.argv.pop(1)


def bits(column):
    return np.ascontiguousarray(column).view(np.uint8)


class Corpus(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory(prefix="latent-corpus-")
        cls.folder = pathlib.Path(cls.scratch.name) / "corpus"
        cls.files = make(cls.folder)

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def of(self, *outcomes):
        """Path and entry of each file with one of these outcomes."""
        return [(self.folder / name, entry) for name, entry in self.files.items() if entry["outcome"] in outcomes]

    def test_records_of_sound_files_have_the_bits_that_cat_writes(self):
        files = self.of(VALID, CARELESS)
        self.assertGreater(len(files), 100)
        for path, _ in files:
            with self.subTest(path.name):
                with open(self.folder / "a.npy", "wb") as out:
                    subprocess.run([INSPECT, "cat", "--format", "npy", path], stdout=out, stderr=subprocess.DEVNULL)
                written = np.load(self.folder / "a.npy")
                columns = latent.open(path).read()
                order = list(columns)
                if "power" in columns:  # cat has them the other way round
                    order[5:7] = ["wavelengths", "power"]
                self.assertEqual(len(order), len(written.dtype.names))
                for name, field in zip(order, written.dtype.names):
                    np.testing.assert_array_equal(bits(columns[name]), bits(written[field]), name)

    def test_the_runs_of_a_damaged_file_are_found_and_damage_is_named(self):
        for path, entry in self.of(DAMAGED):
            with self.subTest(path.name):
                expected = sorted(interval for run in entry["runs"] for interval in run["samples"])
                try:
                    reader = latent.open(path, verify=True)
                except latent.Error:
                    self.assertEqual(expected, [])
                    continue
                found = reader.coverage.tolist()
                if entry["found_at"] == "headers":  # a footer that is sound is not compared with all runs
                    self.assertTrue(all(interval in expected for interval in found), found)
                elif entry["found_at"] == "full":  # every byte has the right checksum
                    self.assertTrue(all(interval in found for interval in expected), found)
                else:
                    self.assertEqual(found, expected)
                    self.assertEqual(len(reader.left_out), 1)

    def test_refused_files_raise(self):
        for path, _ in self.of(REFUSED):
            with self.subTest(path.name), self.assertRaises(latent.Error):
                latent.open(path)


if __name__ == "__main__":
    unittest.main()
