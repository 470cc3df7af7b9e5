"""The commands of latent-farm, whatever a folder is called: run by stand-ins for sbatch and parallel's tasks, without rendering."""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import types
import unittest
from unittest import mock

from support import FarmTest
from latent_farm import engines, files, scripts, slurm
from latent_farm.errors import Failure
from latent_farm.folder import Folder
from latent_farm.plan import Stage

SBATCH = """#!{python}
import json, pathlib, sys
calls = pathlib.Path({calls!r})
number = 100 + len(calls.read_text().splitlines()) if calls.exists() else 100
with calls.open("a") as file:
    file.write(json.dumps(sys.argv[1:]) + "\\n")
print(f"{{number}};cluster")
"""
PLAN = types.SimpleNamespace(name="scene", sbatch=[], throttle=0)
NAME = "a night's work AFTER $HOME"


class Commands(FarmTest):
    def setUp(self):
        super().setUp()
        self.night = Folder(self.folder / NAME)
        self.night.make()
        self.calls = self.folder / "calls"
        path = self.folder / "bin"
        path.mkdir()
        (path / "sbatch").write_text(SBATCH.format(python=sys.executable, calls=str(self.calls)))
        (path / "sbatch").chmod(0o755)
        patch = mock.patch.dict(os.environ, PATH=f"{path}:{os.environ['PATH']}")
        patch.start()
        self.addCleanup(patch.stop)

    def called(self):
        calls = [json.loads(line) for line in self.calls.read_text().splitlines()]
        self.calls.unlink()
        return calls

    def test_what_is_not_installed_is_named_before_anything_is_measured(self):
        for engine, program in (("slurm", "sbatch"), ("parallel", "parallel")):
            with mock.patch.dict(os.environ, PATH=str(self.folder)), self.assertRaisesRegex(Failure, f"^{program}: not found; install"):
                engines.check(engine)
        for engine in ("slurm", "shell", None):
            engines.check(engine)

    def test_the_lines_that_plan_prints_are_what_submit_runs(self):
        chain = slurm.Chain(self.night, types.SimpleNamespace(name="scene", sbatch=["--comment=two words"], throttle=7))
        render, merge, develop = Stage("render", [0, 1, 5, 1500]), Stage("merge"), Stage("develop", [0, 1, 2])
        for stages in [render, merge, Stage("develop")], [merge, develop, Stage("join")], [render], [Stage("join")]:
            numbers, _ = chain.submit(stages)
            submitted = self.called()
            self.succeed("bash", "-ec", "\n".join(chain.lines(stages)[0]))
            self.assertEqual(self.called(), submitted)
            self.assertEqual(numbers, [str(100 + i) for i in range(len(submitted))])
            self.assertEqual(json.loads(self.night.jobs.read_text()), numbers)

    def test_a_cluster_that_does_not_answer_is_named_with_the_engines_that_need_none(self):
        for program in ("sbatch", "squeue"):
            path = self.folder / "bin" / program
            path.write_text(f"#!/bin/sh\necho '{program}: error: no address' >&2\necho '{program}: fatal: no controller' >&2\nexit 1\n")
            path.chmod(0o755)
        with self.assertRaisesRegex(Failure, "^Slurm: sbatch: fatal: no controller; .*--engine shell$"):
            slurm.Chain(self.night, PLAN).submit([Stage("merge")])
        self.night.jobs.write_text('["7"]')
        with self.assertRaisesRegex(Failure, "^Slurm: squeue: fatal: no controller; .*remove .*/jobs.json$"):
            slurm.in_queue(self.night)

    def test_each_stage_waits_for_all_jobs_of_the_one_before(self):
        slurm.Chain(self.night, PLAN).submit([Stage("render", [0, 1500]), Stage("merge"), Stage("develop")])
        waits = [[word for word in call if word.startswith("--dependency")] for call in self.called()]
        self.assertEqual(waits, [[], [], ["--dependency=afterok:100:101"], ["--dependency=afterok:102"]])

    def stages(self, tasks):
        return [Stage("render", tasks), Stage("merge")]

    def tasks_run_by(self, engine, tasks):
        """The status and the tasks, in the order in which they ran, of the engine's line; submit does the same. Task 13 fails."""
        chain = self.night, types.SimpleNamespace(engine=engine, hosts=""), self.stages(tasks)
        [line] = engines.lines_of(*chain)
        status, ran = self.ran_by(lambda: subprocess.run(["/bin/sh", "-c", line], capture_output=True).returncode)
        with (self.folder / "said").open("w") as said, mock.patch("sys.stderr", said):
            again, ran_again = self.ran_by(lambda: engines.Foreground().run([chain]))
        self.assertEqual((bool(status), sorted(ran)), (bool(again), sorted(ran_again)))
        return status, ran

    def ran_by(self, act):
        task = self.night.path / "task"
        task.write_text('#!/bin/sh\necho "$1" >>"$(dirname "$0")/logs/ran"\n[ "$1" != 13 ]\n')
        task.chmod(0o755)
        merge = self.night.path / "merge"
        merge.write_text('#!/bin/sh\necho merge >>"$(dirname "$0")/logs/ran"\n')
        merge.chmod(0o755)
        files.write(self.night.path / "run", scripts.RUN, 0o777)
        status = act()
        ran = pathlib.Path(self.night.logs / "ran")
        lines = ran.read_text().split()
        ran.unlink()
        return status, lines

    def test_a_shell_runs_every_task_and_no_step_after_a_failure(self):
        self.assertEqual(self.tasks_run_by("shell", [0, 1, 2, 7]), (0, ["0", "1", "2", "7", "merge"]))
        self.assertEqual(self.tasks_run_by("shell", [12, 13, 14]), (1, ["12", "13", "14"]))

    @unittest.skipUnless(shutil.which("parallel"), "GNU parallel is not installed")
    def test_parallel_runs_every_task_and_no_step_after_a_failure(self):
        status, ran = self.tasks_run_by("parallel", [0, 1, 2, 7])
        self.assertEqual((status, sorted(ran)), (0, ["0", "1", "2", "7", "merge"]))
        status, ran = self.tasks_run_by("parallel", [12, 13, 14])
        self.assertNotEqual(status, 0)
        self.assertEqual(sorted(ran), ["12", "13", "13", "13", "14"])  # three tries


if __name__ == "__main__":
    unittest.main()
