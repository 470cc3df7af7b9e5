# Whatever is passed to `import latent`, it is taken as documented or refused: by an exception of Python's kinds or latent.Error, with
# one line that names the argument. Every parameter of every function is in the table below, with what it must not take.
# Usage: arguments_test.py LATENT-INSPECT, with the module in PYTHONPATH.
import copy
import inspect
import os
import pathlib
import pickle
import re
import subprocess
import sys
import tempfile
import threading
import unittest

import numpy as np

import latent
from latent import _tools

INSPECT = sys.argv[1]
N = 1024
NAN, INF = float("nan"), float("inf")


class Odd:
    """No number, no text, no path, no list."""


PATHS = [5, 1.5, None, [], Odd(), "", b"", "a\0b", b"a.latent\0b", "a\ud8ffb", pathlib.Path("a\0b")]
FLAGS = [None, "", "no", "False", 0, 1, 2.0, [], np.array([True, False]), Odd()]
WHOLE = [None, "1", "", b"1", 1.0, 1.5, NAN, INF, 1j, [], [1], np.float32(1), np.array([1, 2]), np.array([1.0]), Odd(), 10**30, -10**30]
COUNT = WHOLE + [-1, 2**64]
PAIR = [5, 0.5, "", "05", "0:5", b"05", (), (1,), (1, 2, 3), {1: 2, 3: 4}, {0, 1}, iter([0, 1]), Odd(), np.zeros((2, 2), int), (0, None), (0, "1"),
        (0, 1.5), (0.0, 1.0), (0, NAN), (0, 1j), (None, None), [[0], [1]]]
INTERVAL = PAIR + [(2, 1), (5, 5), (-1, 3), (0, 2**64), (-2, -1), (10**30, 10**31)]
REAL = [None, "1", "", b"1", NAN, INF, -INF, 1j, [], [1.0], np.array([1.0]), np.complex64(1), Odd(), 10**400]
TEXT = [5, None, b"box", [], ["box"], Odd(), "a\0b", "\ud800"]
TEXTS = [5, None, "lamp=2", b"a", {"a": 1}, {"a"}, Odd(), [5], [None], [b"a"], [["a"]], ["a\0b"]]
JOB = [5, b"1" * 32, "", "1" * 31, "1" * 33, "g" * 32, "+1" * 16, "1_" * 16, " " + "1" * 31, "1" * 31 + "\n", "\u0661" * 32, [], Odd()]
POSITION = [None, "a", [-0.1], [1.0], [1], [NAN], [INF], [1j], ["0"], [None], [Odd()], [], [0.1, 0.2], [[0.1]], 0.5, [b"0"],
            np.array([2**32], np.uint64), np.array([], np.uint32), [np.datetime64("2000")], {0: 0.5}]
FLOATS = ["a", 5, [1e39], [-1e300], [1j], ["1"], [None], [Odd()], [], [1.0, 2.0], [[1.0]], [np.timedelta64(1)], {0: 1.0}, [[1], [1, 2]], [10**400]]  # the third and fourth are float64
WHOLES = ["a", [0.0], [1.5], [NAN], [1j], ["1"], [None], [-1], [2**64], [Odd()], [[0]], {0: 1}, [np.datetime64("2000")], [[0], [0, 1]]]
COLUMNS = ["sample", 5, b"u", {"u"}, {"u": 1}, [], [1], [None], ["foo"], ["u", "\0"], ["power"], [["u"]], Odd()]
PARAMETERS = {
    "sizes": WHOLE + [0, -1, (1,), (1, 2, 3), (1.5, 2), ("1", "2"), (0, 5), (None, None), {1: 2}, np.array([[1, 2]]), 2**62, (2**23, 2**23)],
    "regions": [5, "abcd", (), (0, 0, 1), (0, 0, 1, 1, 1), (0, 0, 0, 0), (0.5, 0, 0.4, 1), (0, 0, NAN, 1), (0, 0, INF, 1), (-1, 0, 1, 1), (0, 0, 1, 2),
                ("0", "0", "1", "1"), (0, 0, 1, 1j), {0: 0, 1: 0, 2: 1, 3: 1}, Odd(), np.zeros((2, 2))],
}

READING = {"job": JOB + ["1" * 32], "skip_duplicates": FLAGS}
DEVELOPING = {
    "size": PARAMETERS["sizes"],
    "crop": PAIR + [(0, 0, 1), (0, 0, 0, 0), (0, 0, 9, 9), (-1, 0, 2, 2), (3, 3, 2, 2), (0, 0, 1.5, 2), (0, 0, 2**70, 1), (NAN,) * 4, "abcd"],
    "filter": TEXT + ["nonesuch", "box:", "quartic:nan"], "observer": [path for path in PATHS if path not in ("", b"")] + ["nonesuch", "absent.csv"],
    "camera_xyz": FLAGS + [True], "raw_balance": FLAGS + [False], "lens_filter": TEXT + ["nonesuch"],
    "filter_factor": REAL + [0, -1, "automatic", 2.0], "lights": TEXTS + [["lamp=2"]], "dim_fireflies": FLAGS, "denoise": REAL + [-0.1, 1.1, NAN],
    "aperture": TEXT + ["nonesuch", "2", "0.5"], "shutter": TEXT + ["nonesuch:", "0.2:0.5"], "exposure_follows": FLAGS,
    "focus": [value for value in REAL if value is not None] + [0, -1, 2.0, (1.0,), (1.0, 2.0), (1, 2, 3), (0, None)],
    "image": TEXT + ["", "none", ["both"]], "estimator": TEXT + ["", "mean", "ratio"],
    "spectral_bins": [None, 1.5, 0, -1, NAN, 1j, [], Odd(), "x", "\0", 10**30, 7, "400:700:10"], "layers": TEXTS + [["nonesuch"], ["depth"], [""]],
    "halves": FLAGS, "samples": INTERVAL + [(10**9, 10**9 + 1)], **READING, "memory": COUNT + [0, 1], "threads": COUNT + [2**31, 2**40]}
SUBMITTED = {
    "sample": WHOLES + [0, None, [N]], "u": POSITION, "v": POSITION, "x": FLOATS + [None], "y": FLOATS + [None], "z": FLOATS + [None],
    "power": FLOATS + [[[1.0]]], "wavelengths": FLOATS + [[[1.0]]], "share": FLOATS + [[NAN], [INF]],
    "record_class": WHOLES + [0, [], [0, 0], [1], [2], [256]],
    "extra": [None, 5, "id", [], ["id"], {}, {"id": [0]}, {"id": [0], "z": [0.0], "a": [1]}, {1: [0]}, Odd()]
    + [{"id": bad, "z": [0.0]} for bad in WHOLES + [[256], [0, 0]]] + [{"id": [0], "z": bad} for bad in FLOATS[4:] + FLOATS[:2]]}


class Arguments(unittest.TestCase):
    """TABLE: each function with a call that succeeds, and for each parameter what makes it fail."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.back = os.getcwd()
        cls.addClassCleanup(os.chdir, cls.back)
        os.chdir(cls.folder.name)
        for name, seed in (("a.latent", "1"), ("b.latent", "2")):
            subprocess.run([INSPECT, "gen", "-o", name, "--records", "3000", "--run-samples", "1024", "--seed", seed], check=True, capture_output=True)
        cls.night = latent.open("a.latent")

    def refused(self, call, name, value):
        """`call` raises, in one line that names the argument; nothing else comes into being."""
        with self.subTest(argument=name, value=repr(value)[:60]):
            try:
                result = call()
            except (TypeError, ValueError, KeyError, latent.Error) as error:
                message = error.args[0]
                self.assertIsInstance(message, str)
                self.assertGreater(len(message), 10)
                self.assertLess(len(message), 400)
                self.assertTrue(message.isprintable(), message)
                message = re.sub(r"latent-develop --list-observers|render the scene (?:again )?with --[a-z-]+", "", message)  # of the tools
                for foreign in ("incompatible", "Invoked with", "pybind", "C++", "std::", "NoneType", "options.", "--"):
                    self.assertNotIn(foreign, message)
                if not isinstance(error, latent.Error):
                    self.assertIn(name, message)
            else:
                self.fail(f"taken, and made {type(result).__name__}")

    def check(self, function, good, table, owner=None, hidden=()):
        signature = inspect.signature(owner or function)
        names = [p.name for p in signature.parameters.values() if p.kind not in (p.VAR_POSITIONAL, p.VAR_KEYWORD) and p.name not in ("self", *hidden)]
        self.assertEqual(sorted(table), sorted(names), "every parameter is in the table")
        function(**good)
        before = sorted(os.listdir())
        for name, values in table.items():
            default = signature.parameters[name].default
            for value in values:
                if value is None and default is None:
                    continue
                self.refused(lambda: function(**{**good, name: value}), name, value)
                self.assertEqual(sorted(os.listdir()), before, (name, value))
        with self.assertRaisesRegex(TypeError, f"{(owner or function).__name__.strip('_').split('_')[0]}.*unexpected keyword argument 'nonesuch'"):
            function(**good, nonesuch=1)

    def test_open_and_info(self):
        for function, more in ((latent.open, {"verify": FLAGS}), (latent.info, {})):
            call = lambda **given: function("a.latent", **given)  # noqa: E731
            call.__name__ = function.__name__
            self.check(call, {}, {**READING, **more}, owner=function)
            for value in PATHS:
                self.refused(lambda: function(value), "paths", value)
                self.refused(lambda: function("a.latent", value), "paths", value)
            self.refused(lambda: function(), "paths", ())
        self.check(latent.Reader, {"paths": ["a.latent"]}, {"paths": [p for p in PATHS if not isinstance(p, pathlib.Path)] + [
            [p] for p in PATHS] + [[], (), {"a.latent": 1}, "absent.latent", b"\xff\xfe", "a\nb", "\x1b[2J"], **READING, "verify": FLAGS})
        self.assertEqual(latent.Reader("a.latent").job, latent.open(b"a.latent").job)

    def test_pages_and_read(self):
        table = {"columns": COLUMNS, "region": PARAMETERS["regions"], "samples": INTERVAL, "classes": TEXT + ["", "none", 0], "runs": INTERVAL}
        self.check(self.night.pages, {}, table)
        read = lambda **given: self.night.read(**given)  # noqa: E731
        read.__name__ = "pages"
        self.check(read, {}, table, owner=latent.Reader.pages)

    def test_merge(self):
        def merge(**given):
            counts = latent.merge("a.latent", **{"output": "m.latent", **given})
            os.remove("m.latent")
            return counts

        self.check(merge, {}, {
            "output": PATHS + ["m.txt", "a.latent", "none/m.latent", "m.latent\0"], "replace": FLAGS, "require": INTERVAL + [(0, 10**9)],
            "verify": TEXT + ["", "none"], "compact": FLAGS, "keep_going": FLAGS, **READING, "memory": COUNT + [0], "threads": COUNT + [2**31, 5000]},
            owner=latent.merge)
        for value in PATHS:
            self.refused(lambda: latent.merge(value, output="m.latent"), "paths", value)

    def test_develop(self):
        for function in (latent.develop, latent.develop_layers):
            call = lambda **given: function("a.latent", **{"size": 8, **given})  # noqa: E731
            call.__name__ = "develop"
            table = {name: values for name, values in DEVELOPING.items()}
            if function is latent.develop:
                table = {**table, "layers": table["layers"][7:], "halves": [True, 1]}
            self.check(call, {}, table, owner=_tools._develop, hidden=("paths",))
            for value in PATHS:
                self.refused(lambda: function(value), "paths", value)

    def writer(self, **given):
        return latent.Writer("w.latent", **{"job_id": "1" * 32, "samples": (0, N), "extra": {"id": "u1", "z": "f8"}, **given})

    def forget(self):
        for name in os.listdir():
            if name.startswith("w."):
                os.remove(name)

    def test_writer(self):
        def opened(**given):
            writer = latent.Writer(**{"path": "w.latent", "job_id": "1" * 32, "samples": (0, N), **given})
            writer.close()
            self.forget()
            return writer

        self.check(opened, {}, {
            "path": PATHS + ["w.txt", "none/w.latent"], "job_id": JOB + [None], "samples": INTERVAL + [None], "wavelengths": COUNT + [1025],
            "aspect": PAIR + [(0, 1), (1, 0), (2**32, 1), (-1, 1)], "light_unit": REAL + [-1], "light_paths_per_sample": COUNT + [2**32],
            "precision": COUNT + [0, 24], "run_samples": COUNT + [1000, 2**32],
            "extra": [None, 5, "depth", ["depth"], {"depth"}, {1: "f4"}, {"": "f4"}, {"a\0b": "f4"}, {"a" * 65: "f4"}, {"depth": None}, {"depth": "f2"},
                      {"depth": "float"}, {"depth": np.float32}, {"depth": 5}, {"\ud800": "f4"}, Odd()],
            "checkpoint_seconds": REAL + [-1], "provenance": [None, 5, [], b"{}", "[1]", "{", "\0", {"a": NAN}, {"a": Odd()}, {"a": {1, 2}}, Odd()],
            "replace": FLAGS}, owner=latent.Writer)
        opened(provenance={"renderer": "mine", "seconds": 1.5}, aspect=np.array([3, 2]), light_unit=np.float32(683))

    def test_submit_and_write(self):
        good = {"sample": [0], "u": [0.5], "v": [0.5], "x": [1], "y": [1.0], "z": np.ones(1), "extra": {"id": [255], "z": [1e300]}}

        def submit(**given):
            with_grain = {"grain": (0, N), **good, **given}
            part = self.writer()
            try:
                part.submit(**with_grain)
            finally:
                part.close()
                self.forget()

        def write(**given):
            part = self.writer()
            try:
                part.write(**{**good, **given})
            finally:
                part.close()
                self.forget()

        self.check(submit, {}, {"grain": INTERVAL + [None, (0, 5), (N, 2 * N), (1, N)], **SUBMITTED}, owner=latent.Writer.submit)
        self.check(write, {}, SUBMITTED, owner=latent.Writer.write)

    def test_columns_of_spectral_jobs(self):
        good = {"sample": [0, 1], "u": [0.5, 0.5], "v": [0.5, 0.5], "power": np.ones((2, 3)), "wavelengths": [[400, 500, 600]] * 2}
        for function in ("submit", "write"):
            for name in ("power", "wavelengths"):
                for value in [None, np.ones((3, 2)), np.ones(6), np.ones((2, 3, 1)), np.ones((2, 3)) * 1j, np.full((2, 3), 1e39), [["a"] * 3] * 2, 5]:
                    part = self.writer(extra={}, wavelengths=3)
                    given = {**good, name: value, **({"grain": (0, N)} if function == "submit" else {})}
                    self.refused(lambda: getattr(part, function)(**given), name, value)
                    part.close()
                    self.forget()
            part = self.writer(extra={}, wavelengths=3)
            self.refused(lambda: part.write(**good, x=[1, 1]), "x", [1, 1])
            part.close()
            self.forget()

    def test_what_is_closed_says_so(self):
        part = self.writer()
        part.close()
        part.close()
        one = [0.5]
        record = {"sample": [0], "u": one, "v": one, "x": one, "y": one, "z": one, "extra": {"id": [0], "z": one}}
        for call in (part.finish, part.checkpoint, lambda: part.missing, lambda: list(part.grains()), lambda: part.submit((0, N), **record),
                     lambda: part.write(**record)):
            self.assertRaisesRegex(ValueError, "the writer is closed", call)
        self.forget()

    def test_closing_while_others_submit_ends_them(self):
        for _ in range(20):
            part, ended = self.writer(extra={}, samples=(0, 2000 * N)), []

            def work():
                try:
                    for first, end in part.grains():
                        u = np.full(end - first, 0.5)
                        part.submit((first, end), sample=np.arange(first, end), u=u, v=u, x=u, y=u, z=u)
                except (ValueError, latent.Error) as error:
                    ended.append(str(error))

            threads = [threading.Thread(target=work) for _ in range(3)]
            for thread in threads:
                thread.start()
            while next(iter(part.grains()))[0] < 20 * N:  # these are never submitted: in the end, all wait for them
                pass
            part.close()
            for thread in threads:
                thread.join(60)
                self.assertFalse(thread.is_alive())
            self.assertEqual(len(ended), 3)
            self.forget()

    def test_threads_share_an_iterator_of_pages(self):
        everything = self.night.read(["sample", "y"])
        pages, taken = self.night.pages(["sample", "y"]), []

        def work():
            taken.extend(pages)

        threads = [threading.Thread(target=work) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(sorted(zip(*(np.concatenate([page[name] for page in taken]) for name in ("sample", "y")))),
                         sorted(zip(everything["sample"], everything["y"])))

    def test_readers_are_not_copied_into_what_does_not_work(self):
        self.assertRaises(TypeError, pickle.dumps, self.night)
        np.testing.assert_array_equal(copy.copy(self.night).read(["y"])["y"], self.night.read(["y"])["y"])

    def test_one_of_two_jobs_is_chosen_by_its_id(self):
        with self.assertRaisesRegex(latent.Error, r"belong to different jobs \([0-9a-f]{32} and [0-9a-f]{32}\); choose one with job=") as caught:
            latent.open(".")
        self.assertNotIn("--", str(caught.exception))
        for name in ("a.latent", "b.latent"):
            job = latent.open(name).job
            self.assertEqual(latent.open(".", job=job["id"]).job, job)
            self.assertEqual(latent.info(".", job=job["id"].upper())["samples"], latent.info(name)["samples"])

    def test_a_missing_column_is_answered_with_those_there_are(self):
        with self.assertRaises(KeyError) as caught:
            self.night.read(["foo"])
        self.assertEqual(caught.exception.args[0], "columns: there is no 'foo'; there are sample, class, u, v, share, x, y, z")

    def test_what_a_user_sees_is_the_api(self):
        shown = {name for name in dir(latent) if not name.startswith("_")}
        self.assertEqual(shown, set(latent.__all__))
        for name in latent.__all__:
            self.assertEqual(getattr(latent, name).__module__, "latent", name)
            self.assertTrue(getattr(latent, name).__doc__, name)


unittest.main(argv=sys.argv[:1], warnings="error")
