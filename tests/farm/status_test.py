"""latent-farm status: what it reads from the files in a folder, whoever wrote them and whatever else lies there."""
import os
import shutil
import subprocess
import time
import types
import unittest
from unittest import mock

from support import SCENE, TOOLS, FarmTest
from latent_farm import state
from latent_farm.folder import Folder
from latent_farm.status import machines_of


class Status(FarmTest):
    def test_missing_samples_and_tasks_are_named(self):
        report = self.plan("--tasks", 4)
        length = report["task_samples"]
        status = self.status()
        self.assertEqual((status["committed"], status["missing_tasks"], status["complete"]), (0, "0-3", False))
        for task in (0, 2):
            self.succeed(self.folder / "night/task", task)
        status = self.status()
        self.assertEqual(status["committed"], 2 * length)
        self.assertEqual(status["missing_samples"], [[length, 2 * length], [3 * length, 4 * length]])
        self.assertEqual(status["missing_tasks"], "1,3")
        self.assertEqual(status["tasks_finished"], 2)
        self.assertEqual(status["steps_left"], ["render", "merge", "develop"])
        text = self.succeed("latent-farm", "status", self.folder / "night").stdout
        self.assertIn("         tasks 1,3\n", text)
        self.assertIn(f"{length}:{2 * length}", text)
        self.assertIn("left:    render, merge, develop\n", text)

    def test_machines_are_those_that_wrote_the_parts(self):
        self.plan("--tasks", 2, command="submit")
        machines = self.status()["machines"]
        self.assertEqual(list(machines), [os.uname().nodename])
        machine = machines[os.uname().nodename]
        self.assertEqual((machine["parts"], machine["samples"]), (2, 4 * 64 * 64))
        self.assertLess(abs(machine["last_commit"] - time.time()), 3600)

    def test_an_unfinished_part_is_rendered_until_it_stands_still_for_too_long(self):
        self.plan("--tasks", 2, "--checkpoint", "0.05", spp=400)
        task = subprocess.Popen([self.folder / "night/task", "1"], stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
        while not self.status()["committed"]:
            time.sleep(0.05)
        task.kill()
        task.wait()
        status = self.status()
        self.assertEqual((status["tasks_working"], status["stalled"]), (1, []))
        self.assertGreater(status["samples_per_second"], 0)
        self.assertGreater(status["seconds_left"], 0)
        attempt = next((self.folder / "night/parts").iterdir())
        os.utime(attempt, (time.time() - 400,) * 2)
        status = self.status()
        self.assertEqual((status["tasks_working"], status["stalled"]), (0, [attempt.name]))
        self.assertIsNone(status["seconds_left"])
        self.assertEqual(self.status("night", "--stalled-after", "10m")["stalled"], [])

    def test_an_attempt_at_a_finished_task_counts_for_nothing(self):
        self.plan("--tasks", 2)
        for task in range(2):
            self.succeed(self.folder / "night/task", task)
        parts, before = self.folder / "night/parts", self.status()
        shutil.copy(parts / "part-00001.latent", parts / "part-00001.latent.part.n1.7")
        after = self.status()
        self.assertEqual((after["spare"], after["spare_bytes"]), (["part-00001.latent.part.n1.7"], (parts / "part-00001.latent").stat().st_size))
        for what in ("machines", "bytes", "bytes_when_finished", "committed", "tasks_working", "stalled"):
            self.assertEqual(after[what], before[what], what)
        self.assertIn("spare:   1 attempt at finished tasks", self.succeed("latent-farm", "status", self.folder / "night").stdout)

    def test_a_task_that_was_killed_and_is_rendered_again_counts_once(self):
        now = 1e9
        files = [state.PartFile(f"part-00000.latent.part.{i}", 0, True, [(0, held)], host, now - 100, now - age, held, 0)
                 for i, (held, host, age) in enumerate([(500, "live", 5), (300, "killed", 60), (200, "killed", 80)])]
        machines, stalled = machines_of(types.SimpleNamespace(rate=7), files, {0}, now, 300)
        self.assertEqual({host: machine["working"] for host, machine in machines.items()}, {"live": 1, "killed": 0})
        self.assertAlmostEqual(sum(machine["samples_per_second"] for machine in machines.values()), 500 / 95)
        self.assertEqual(stalled, [])
        _, stalled = machines_of(types.SimpleNamespace(rate=7), files, {0}, now + 400, 300)
        self.assertEqual(stalled, ["part-00000.latent.part.0"])

    def test_a_part_that_was_cut_short_is_not_finished(self):
        self.plan("--tasks", 2)
        for task in range(2):
            self.succeed(self.folder / "night/task", task)
        part = self.folder / "night/parts/part-00000.latent"
        os.truncate(part, part.stat().st_size * 2 // 3)
        status = self.status()
        self.assertEqual((status["tasks_finished"], [machine["parts"] for machine in status["machines"].values()]), (1, [1]))

    def test_the_rate_of_a_resumed_part_counts_what_its_last_attempt_rendered(self):
        self.plan("--tasks", 1, "--checkpoint", "0.05", "--until", "render", spp=400)
        task = subprocess.Popen([self.folder / "night/task", "0"], stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
        while not self.status()["committed"]:
            time.sleep(0.05)
        task.kill()
        task.wait()
        committed = self.status()["committed"]
        self.succeed(self.folder / "night/task", "0")
        part = self.folder / "night/parts/part-00000.latent"
        os.utime(part, (time.time() + 1000,) * 2)
        folder = Folder(self.folder / "night")
        with mock.patch.dict(os.environ, PATH=f"{TOOLS}:{os.environ['PATH']}"):
            [file] = state.read_state(folder, folder.read_plan()).files
        self.assertAlmostEqual(file.rate * (file.changed - file.begun), 400 * 64 * 64 - committed, delta=1)

    def test_what_is_no_part_of_the_job_is_listed_and_does_not_count(self):
        self.plan("--tasks", 2)
        parts = self.folder / "night/parts"
        self.succeed("latent-render", SCENE, "--resolution", "64x64", "--spp", 4, "--seed", 9, "-o", parts / "part-00000.latent")
        (parts / "notes.txt").write_text("a shopping list")
        (parts / "part-00001.latent").write_text("not samples")
        (parts / ".part-00001.latent.Xy12").write_text("rsync has not finished with it")
        status = self.status()
        self.assertEqual((status["committed"], status["missing_tasks"]), (0, "0-1"))
        reasons = {os.path.basename(item["place"]): item["reason"] for item in status["left_out"]}
        self.assertEqual(set(reasons), {"notes.txt", "part-00000.latent", "part-00001.latent"})
        self.assertIn("job", reasons["part-00000.latent"])

    def test_damaged_parts_are_to_be_rendered_again(self):
        self.plan("--tasks", 2, "--until", "merge", command="submit")
        part = self.folder / "night/parts/part-00000.latent"
        os.truncate(part, part.stat().st_size * 2 // 3)
        os.unlink(self.folder / "night/samples.latent")
        status = self.status()
        self.assertEqual(status["missing_tasks"], "0")
        self.assertLess(status["committed"], status["samples"])
        self.succeed("latent-farm", "resume", self.folder / "night", "--engine", "shell")
        self.assertTrue(self.status()["merged"])

    def test_the_merged_file_stands_for_parts_that_are_gone(self):
        self.plan("--tasks", 2, command="submit")
        shutil.rmtree(self.folder / "night/parts")
        status = self.status()
        self.assertTrue(status["complete"] and status["merged"])
        self.assertEqual((status["missing_tasks"], status["steps_left"]), ("", []))


if __name__ == "__main__":
    unittest.main()
