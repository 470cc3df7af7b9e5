"""What the tests of latent-farm share: the tools as they were built, a small scene, and a folder that goes away."""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

TOOLS = pathlib.Path(os.environ["LATENT_TOOLS"])
SOURCE = pathlib.Path(os.environ["LATENT_SOURCE"])
SCENE = SOURCE / "scenes/sodium.pbrt"
sys.path.insert(0, str(SOURCE / "farm"))


def words(command):
    program = TOOLS / command[0] if str(command[0]).startswith("latent-") else command[0]
    return [str(program), *map(str, command[1:])]


def run(*command, **settings):
    """A tool and its arguments. Its status, standard output and standard error."""
    return subprocess.run(words(command), stdin=subprocess.DEVNULL, capture_output=True, text=True, **settings)


def start(*command):
    """The same, while it runs."""
    return subprocess.Popen(words(command), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def one_frame(report):
    """The report on a plan of one scene."""
    [frame] = report["frames"]
    return {**report, **frame}


class FarmTest(unittest.TestCase):
    """Every test has a folder of its own, self.folder."""

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="latent-farm-test-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def succeed(self, *command, status=0, **settings):
        done = run(*command, **settings)
        self.assertEqual(done.returncode, status, f"{done.stderr[-3000:]}\n{done.stdout[-3000:]}\n{command}")
        return done

    def fail_with(self, text, *command, status=1, **settings):
        """One line on standard error that holds `text`."""
        done = self.succeed(*command, status=status, **settings)
        self.assertIn(text, done.stderr)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        return done

    def plan(self, *more, command="plan", spp=4, out="night", scene=SCENE, engine="shell", options=()):
        done = self.succeed("latent-farm", command, scene, "--spp", spp, "--out", self.folder / out, "--engine", engine, "--json", *more,
                            "--", "--resolution", "64x64", *options)
        return one_frame(json.loads(done.stdout))

    def status(self, out="night", *more):
        return one_frame(json.loads(self.succeed("latent-farm", "status", self.folder / out, "--json", *more).stdout))

    def single_process(self, spp, run_samples, options=(), develop=()):
        """The picture of one process that renders everything, as bytes."""
        self.succeed("latent-render", SCENE, "--resolution", "64x64", "--spp", spp, "--run-samples", run_samples, *options,
                     "-o", self.folder / "single.latent", "--force")
        self.succeed("latent-develop", self.folder / "single.latent", *develop, "-o", self.folder / "single.exr", "--force")
        return (self.folder / "single.exr").read_bytes()
