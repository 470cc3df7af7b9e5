"""latent-farm --until-noise: a plan grows until its picture is clean, and what it makes is an ordinary picture."""
import json
import unittest

from support import SCENE, FarmTest, one_frame

TARGET = 0.06  # of sodium.pbrt at 64 x 64, which 16 samples per pixel miss


class UntilNoise(FarmTest):
    def submit(self, *more, status=0, command="submit", scene=(SCENE,), render=("--", "--resolution", "64x64")):
        return self.succeed("latent-farm", command, *scene, "--out", self.folder / "night", "--engine", "shell", *more, *render, status=status)

    def noise(self, samples, *more):
        """What latent-inspect finds in the merged file."""
        report = json.loads(self.succeed("latent-inspect", "noise", self.folder / "night/samples.latent", "--samples", f"0:{samples}", "--json", *more).stdout)
        return report["levels"][0]["relative"]["median"]

    def test_the_plan_grows_until_the_picture_is_as_clean_as_was_asked_for(self):
        night = self.folder / "night"
        self.submit(f"--until-noise={100 * TARGET:g}%", "--on-done", "echo done >>times")
        status = self.status()
        self.assertEqual((status["steps_left"], status["missing_samples"], status["noise"]["over"]), ([], [], True))
        self.assertGreater(status["spp"], 16)
        self.assertEqual(status["noise"]["samples"], status["samples"])
        self.assertEqual(status["noise"]["median"], self.noise(status["samples"]))
        self.assertLessEqual(status["noise"]["median"], TARGET)
        self.assertEqual((night / "times").read_text(), "done\n")
        run_samples = json.loads((night / "plan.json").read_text())["run_samples"]
        self.assertEqual((night / "picture.exr").read_bytes(), self.single_process(status["spp"], run_samples))
        self.assertIn(f"noise:   {100 * status['noise']['median']:.3g} %, of {100 * TARGET:g}%\n", self.succeed("latent-farm", "status", night).stdout)

        # A smaller target goes on from there, though the parts are gone.
        for part in night.glob("parts/*"):
            part.unlink()
        self.submit(f"--until-noise={80 * TARGET:g}%", command="submit", scene=(), render=())
        more = self.status()
        self.assertGreater(more["samples"], status["samples"])
        self.assertLessEqual(self.noise(more["samples"]), 0.8 * TARGET)

    def test_it_is_measured_in_a_picture_of_the_width_that_was_named(self):
        self.submit(f"--until-noise={100 * TARGET:g}%@32", "--max-spp", 16)
        status = self.status()
        self.assertEqual(status["noise"]["median"], self.noise(status["samples"], "--size", "32"))

    def test_it_ends_with_max_spp_in_any_case(self):
        self.submit("--until-noise", "0.1%", "--max-spp", 20)
        status = self.status()
        self.assertEqual((status["spp"], status["steps_left"], status["noise"]["over"]), (20, [], True))
        self.assertGreater(status["noise"]["median"], 0.001)
        self.assertIn("of 0.1%; --max-spp 20 is reached\n", self.succeed("latent-farm", "status", self.folder / "night").stdout)
        self.submit("--max-spp", 24, command="submit", scene=(), render=())
        self.assertEqual(self.status()["spp"], 24)

    def test_a_plan_that_grows_says_what_is_left_and_what_it_takes(self):
        report = one_frame(json.loads(self.submit("--until-noise", "1%", "--json", command="plan").stdout))
        self.assertEqual(report["steps"], ["render", "noise"])
        night = self.folder / "night"
        self.assertIn("noise:   not measured yet, of 1%\n", self.succeed("latent-farm", "status", night).stdout)
        self.assertEqual(self.status()["steps_left"], ["render", "noise", "merge", "develop"])
        self.fail_with("missing: task 0; render", "latent-farm", "noise", night, status=1)

    def test_what_cannot_be_is_refused_in_one_line(self):
        out = ("--out", self.folder / "night")
        self.fail_with("is not a noise (try 2%", "latent-farm", "plan", SCENE, *out, "--until-noise", "2", status=2)
        self.fail_with("is not a noise (try 2%", "latent-farm", "plan", SCENE, *out, "--until-noise", "2%@0", status=2)
        self.fail_with("needs --until-noise", "latent-farm", "plan", SCENE, *out, "--spp", 1, "--max-spp", 9, status=2)
        self.fail_with("before the --", "latent-farm", "plan", SCENE, *out, "--spp", 1, "--", "--until-noise", "2%", status=2)
        self.fail_with("is for one scene", "latent-farm", "plan", SCENE, SCENE.with_name("cornell.pbrt"), *out, "--until-noise", "2%", status=2)
        self.plan()
        self.fail_with("its plan has no --until-noise", "latent-farm", "noise", self.folder / "night", status=2)
        self.plan("--until-noise", "2%")
        for text in ("{", "[]", '{"samples": 1}', '{"samples": 1, "width": 0, "median": 1e300, "exponent": 0.5}', "\x1b[31m"):
            (self.folder / "night/noise.json").write_text(text)
            self.fail_with("noise.json", "latent-farm", "status", self.folder / "night", status=1)


unittest.main()
