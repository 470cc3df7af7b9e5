"""latent-farm on a Slurm cluster of three nodes that loses power and cables: the picture is that of a single process, and what was
committed is not rendered again. The scenarios are named on the command line; without names, those that are quick."""
import json
import os
import pathlib
import re
import subprocess
import sys
import time
import unittest

from support import SOURCE, TOOLS, FarmTest, one_frame, run

CLUSTER = pathlib.Path(__file__).with_name("cluster")
SCENE = SOURCE / "scenes/cornell.pbrt"
OPTIONS = ["--resolution", "64x64", "--integrator", "bdpt", "--record", "xyz"]
STATUS = re.compile(r"committed (\d+) of (\d+) samples")
ATTEMPT = re.compile(r"(?m)^task \d+ on (.*), .*$")
TAKEN_OVER = re.compile(r"(?m)committed (\d+) of \d+ samples \([\d.]+ %\)$")  # from earlier attempts: nothing was rendered yet
SLOW = {"test_c_a_pulled_cable_makes_two_writers_and_no_damage", "test_d_preempted_tasks_resume",
        "test_e_tasks_at_their_time_limit_requeue_themselves"}


class Slurm(FarmTest):
    def setUp(self):
        super().setUp()
        self.lab = self.folder / "cluster"
        self.cluster("up", 3)
        self.addCleanup(self.cluster, "down")
        self.night = self.folder / "night"

    def cluster(self, verb, *arguments):
        done = run(CLUSTER, self.lab, verb, *arguments, env={**os.environ, "PATH": f"{TOOLS}:{os.environ['PATH']}"})
        self.assertEqual(done.returncode, 0, f"{verb} {arguments}\n{done.stdout}{done.stderr}")
        return done.stdout

    def farm(self, *arguments):
        report = json.loads(self.cluster("exec", "latent-farm", arguments[0], "--json", *arguments[1:]))
        return one_frame(report) if len(report["frames"]) == 1 else report

    def submit(self, *more, spp=200, tasks=6, command="submit", develop="--size 64"):
        """One processor for a task, so that two run on a node."""
        return self.farm(command, SCENE, "--spp", spp, "--out", self.night, "--tasks", tasks, "--cpus", 1, "--memory", "100M",
                         "--checkpoint", "0.5", f"--develop={develop}", *more, "--", *OPTIONS)

    def queue(self):
        return [line.split() for line in self.cluster("exec", "squeue", "-h", "-r", "-o", "%i %T %N %j").splitlines()]

    def wait_for(self, condition, what, seconds=400):
        end = time.time() + seconds
        while not condition():
            self.assertLess(time.time(), end, f"{what}: not within {seconds} s\n{self.queue()}\n{self.logs()}")
            time.sleep(0.2)

    def wait_for_end(self, seconds=600):
        self.wait_for(lambda: not self.queue(), "the queue is empty", seconds)

    def logs(self):
        return "\n".join(f"{log.name}:\n{log.read_text()}" for log in sorted(self.night.glob("logs/*.log")))

    def working_on(self, node):
        """The logs of tasks on a node that have committed something and are not done."""
        found = []
        for log in self.night.glob("logs/task-*.log"):
            attempt = re.split(ATTEMPT, log.read_text())[-1]
            host = re.findall(ATTEMPT, log.read_text())[-1:]
            if host == [node] and STATUS.search(attempt) and "rendered in" not in attempt:
                found.append(log)
        return found

    def check_picture(self, report, spp=200):
        """The picture is that of one process, and status has nothing left to say."""
        self.assertTrue((self.night / "picture.exr").exists(), self.logs())
        self.succeed("latent-render", SCENE, "--spp", spp, "--run-samples", report["run_samples"], *OPTIONS, "-o", self.folder / "one.latent")
        self.succeed("latent-develop", self.folder / "one.latent", "--size", 64, "-o", self.folder / "one.exr")
        self.assertEqual((self.night / "picture.exr").read_bytes(), (self.folder / "one.exr").read_bytes())
        status = self.farm("status", self.night)
        self.assertEqual((status["committed"], status["missing_tasks"], status["steps_left"]), (report["samples"], "", []))

    def check_nothing_was_rendered_twice(self):
        """Of every task, each attempt begins with at least what the one before is known to have committed, and what it renders is all
        that is committed later. Returns the number of attempts that resumed."""
        attempts = resumed = kept = 0
        for log in self.night.glob("logs/task-*.log"):
            before = 0
            for attempt in re.split(ATTEMPT, log.read_text())[2::2]:
                found = [tuple(map(int, match)) for match in STATUS.findall(attempt)]
                if not found:
                    continue
                taken_over = TAKEN_OVER.search(attempt)
                begun = int(taken_over[1]) if taken_over else 0
                self.assertGreaterEqual(begun, before, log.read_text())
                attempts += 1
                resumed += begun > 0
                kept += begun
                rendered = re.search(r"samples \d+:\d+, (\d+) rendered", attempt)
                if rendered and "another process" not in attempt:
                    self.assertEqual(int(rendered[1]), found[-1][0] - begun, log.read_text())
                before = found[-1][0]
        print(f"{attempts} attempts; {resumed} resumed, with {kept} samples that were committed before and not rendered again", file=sys.stderr)
        return resumed

    def test_a_undisturbed_it_makes_the_picture_of_one_process(self):
        report = self.submit()
        self.assertEqual(report["steps"], ["render", "merge", "develop"])
        refused = run(CLUSTER, self.lab, "exec", TOOLS / "latent-farm", "resume", self.night)
        self.assertEqual(refused.returncode, 1)
        self.assertIn("still in Slurm's queue", refused.stderr)
        self.wait_for_end()
        self.check_picture(report)
        self.check_nothing_was_rendered_twice()
        self.assertEqual(set(self.farm("status", self.night)["machines"]), {"n1", "n2", "n3"})

    def test_b_a_power_cut_costs_no_committed_run(self):
        report = self.submit()
        self.wait_for(lambda: self.working_on("n2"), "n2 has committed something")
        self.cluster("off", "n2")
        self.wait_for_end()
        self.check_picture(report)
        self.assertGreaterEqual(self.check_nothing_was_rendered_twice(), 1)

    def test_c_a_pulled_cable_makes_two_writers_and_no_damage(self):
        report = self.submit(spp=1800, tasks=3)
        self.wait_for(lambda: self.working_on("n2"), "n2 has committed something")
        self.cluster("unplug", "n2")
        self.wait_for(lambda: any("restart 1" in log.read_text() for log in self.night.glob("logs/task-*.log")), "a second writer")
        self.wait_for_end()
        self.cluster("plug", "n2")
        self.check_picture(report, spp=1800)

    def test_d_preempted_tasks_resume(self):
        report = self.submit()
        self.wait_for(lambda: self.working_on("n1") and self.working_on("n2"), "n1 and n2 have committed something")
        self.cluster("exec", "sbatch", "--partition=urgent", "--nodes=3", "--exclusive", "--output=/dev/null", "--wrap", "sleep 1")
        self.wait_for_end()
        self.check_picture(report)
        self.assertGreaterEqual(self.check_nothing_was_rendered_twice(), 1)

    def test_e_tasks_at_their_time_limit_requeue_themselves(self):
        report = self.submit("--time", "1m", spp=2900, tasks=3)
        self.wait_for_end()
        self.check_picture(report, spp=2900)
        self.assertGreaterEqual(self.check_nothing_was_rendered_twice(), 1)

    def test_f_after_a_task_failed_for_good_the_same_command_completes_the_chain(self):
        task = self.night / "task"
        report = self.submit(command="plan")
        whole = task.read_text()
        broken = whole.replace("#!/bin/sh\n", '#!/bin/sh\n[ "$1" != 3 ] || { sleep 1; exit 1; }\n')
        self.assertNotEqual(broken, whole)
        task.write_text(broken)
        self.cluster("exec", "bash", "-ec", "\n".join(report["commands"]))  # as a user would paste them
        self.wait_for_end()
        self.assertFalse((self.night / "samples.latent").exists())
        status = self.farm("status", self.night)
        self.assertEqual(status["missing_tasks"], "3")
        finished = {path.name: path.stat().st_ino for path in (self.night / "parts").glob("*.latent")}
        self.assertEqual(len(finished), 5)
        again = self.farm("resume", self.night)
        self.assertEqual(again["missing_tasks"], "3")
        self.wait_for_end()
        self.check_picture(report)
        for name, inode in finished.items():
            self.assertEqual((self.night / "parts" / name).stat().st_ino, inode, f"{name} was rendered again")

    def test_g_strips_are_developed_by_an_array_and_joined(self):
        report = self.submit("--strips", 3, spp=4, tasks=2, develop="--size 600x600")
        self.assertEqual((report["steps"], len(report["jobs"])), (["render", "merge", "develop", "join"], 4))
        self.wait_for_end()
        self.assertEqual(self.farm("status", self.night)["steps_left"], [], self.logs())
        self.assertEqual(len(list(self.night.glob("logs/develop-*.log"))), 3)

    def test_h_names_that_strangers_chose_are_only_names(self):
        names = ['"; touch hacked; "', "'$(touch hacked)`touch hacked`", "%A_%a", "back\\\\slash\\", "-o", "{}", "#SBATCH --wrap", "é 日本"]
        scenes = [self.folder / f"{name}.pbrt" for name in names]
        for scene in scenes:
            scene.write_bytes(SCENE.read_bytes())
        self.farm("submit", *scenes, "--spp", 1, "--out", self.night, "--tasks", 1, "--cpus", 1, "--memory", "100M", "--", "--resolution", "16x16")
        self.wait_for_end()
        self.assertEqual({path.parent.name for path in self.night.glob("*/picture.exr")}, set(names), self.logs())
        for name in names:
            self.assertEqual({path.name for path in (self.night / name / "logs").iterdir()}, {"task-00000.log", "merge.log", "develop.log"})
        self.assertEqual(list(self.folder.rglob("hacked")), [])

    def test_i_frames_are_printed_and_a_command_runs_when_all_are_done(self):
        scenes = [self.folder / f"frame.{number}.pbrt" for number in (1, 2)]
        for scene in scenes:
            scene.write_bytes(SCENE.read_bytes())
        report = self.farm("submit", *scenes, "--spp", 1, "--out", self.night, "--tasks", 2, "--cpus", 1, "--memory", "100M", "--print=", "--on-done",
                           "ls frame.*/picture.png >told", "--", "--resolution", "16x16")
        self.assertEqual(len(report["jobs"]), 4 + 4 + len(report["steps"]))
        refused = run(CLUSTER, self.lab, "exec", TOOLS / "latent-farm", "resume", self.night)
        self.assertIn("still in Slurm's queue", refused.stderr)
        self.wait_for_end()
        self.assertEqual((self.night / "told").read_text().split(), [f"frame.{number}/picture.png" for number in (1, 2)], self.logs())


    def test_j_a_plan_grows_until_its_picture_is_clean(self):
        self.farm("submit", SCENE, "--until-noise", "4%", "--out", self.night, "--tasks", 4, "--cpus", 1, "--memory", "100M", "--on-done", "echo done >>told",
                  "--", *OPTIONS)
        self.wait_for_end()
        status = self.farm("status", self.night)
        self.assertEqual((status["steps_left"], status["missing_samples"]), ([], []), self.logs())
        self.assertGreater(status["spp"], 16)
        self.assertLessEqual(status["noise"]["median"], 0.04)
        self.assertEqual((self.night / "told").read_text(), "done\n")


def load(names):
    every = unittest.defaultTestLoader.getTestCaseNames(Slurm)
    chosen = [name for name in every if name.split("_")[1] in names] if names else [name for name in every if name not in SLOW]
    return unittest.TestSuite(Slurm(name) for name in chosen)


if __name__ == "__main__":
    possible = subprocess.run([CLUSTER, "/nonexistent", "possible"], capture_output=True, text=True)
    if possible.returncode != 0:
        print(f"skipped: {possible.stdout.strip()}")
        sys.exit(77)
    sys.exit(not unittest.TextTestRunner(verbosity=2).run(load(sys.argv[1:])).wasSuccessful())
