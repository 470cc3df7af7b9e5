"""The state files of latent-farm with other contents: every mutant is refused with one line, or is a plan that can be worked with. The
mutants are always the same."""
import copy
import dataclasses
import json
import random
import shlex
import subprocess
import time
import types
from unittest import mock
import unittest

from support import SCENE, TOOLS, FarmTest
from latent_farm import engines, scripts, slurm, state, status
from latent_farm.errors import Failure
from latent_farm.folder import Folder
from latent_farm.names import is_control, shown
from latent_farm.plan import ENGINES, Plan, Stage

PLAN = Plan(scene=str(SCENE), spp=4, options=["--resolution", "64x64"], samples=16384, task_samples=4096, run_samples=1024, job="0123456789abcdef" * 2, rate=1e5,
            bytes_per_sample=40.5, memory=1 << 30, develop=["--size", "700x700"], strips=3, until="print", on_done="mail me", sbatch=["--partition=long"])
VALUES = [None, True, False, 0, 1, -1, 7, 10**15, 2**62, 2**63, 10**400, 0.5, -0.0, 1e308, float("nan"), float("inf"), "", "x", "a\nb", "\x1b[2J", "\udcff", "\0",
          "'", '"', "; touch hacked", "$(touch hacked)", "x" * 100000, "99999999999999999999", [], {}, [[]], [1], ["--size", "1x999999999"], ["--size=999999999x1"], ["a\nb"], ["; touch hacked"],
          *ENGINES, "render", "merge"]
FRAGMENTS = [b"", b"[", b"{", b'"', b"\xff", b"\0", b"null", b"1e999", b"[" * 100000, b"9" * 5000, b"\\ud800", b'"samples": 1,', b"-", b"NaN"]


def mutant(seed):
    """The bytes of a plan, other than PLAN in one member or in several bytes."""
    chance = random.Random(seed)
    members = dataclasses.asdict(PLAN)
    for _ in range(chance.choice((0, 1, 1, 2, 3))):
        name = chance.choice([*members, "more", "version"])
        if chance.random() < 0.1:
            members.pop(name, None)
        else:
            members[name] = copy.deepcopy(chance.choice(VALUES))
    data = bytearray(json.dumps(members).encode())
    if chance.random() < 0.4:
        for _ in range(chance.choice((1, 1, 3))):
            at = chance.randrange(len(data) + 1)
            data[at:at + chance.choice((0, 1, 1, 20, 1000))] = chance.choice((*FRAGMENTS, bytes([chance.randrange(256)])))
    return bytes(data)


class Fuzz(FarmTest):
    def setUp(self):
        super().setUp()
        self.night = Folder(self.folder / "night")
        self.night.make()

    def check_line(self, error):
        """That it ends the program with one line, which fits on a page and is about this folder."""
        self.assertIn(str(self.night.path), str(error))
        self.assertLess(len(str(error)), 2000)
        self.assertFalse(any(map(is_control, shown(str(error)))))

    def use(self, plan):
        """All that latent-farm makes of a plan, short of running it."""
        now = time.time()
        with mock.patch("latent_farm.tools.path_of", lambda name: str(TOOLS / name)):
            made = {**scripts.scripts_of(plan), **scripts.last_scripts_of(plan)}
            texts = [*made.values(), *(scripts.job_of(plan, step) for step in ("task", "merge", "develop", "done"))]
        self.assertIn(["scene=" + plan.scene], self.words(made["task"]))
        self.assertIn(["set", "--", *plan.render_options], self.words(made["task"]))
        self.assertIn(["set", "--", *plan.develop], self.words(made["develop"]))
        self.assertIn(["command=" + plan.on_done], self.words(made["done"]))
        found = state.read_state(self.night, plan)
        report = status.summary(self.night, plan, found, now, 300)
        text = status.to_text(report, now)
        self.assertFalse(any(is_control(c) for c in text.replace("\n", "")))
        json.dumps(report, allow_nan=False)
        stages = [Stage("render", [0, plan.tasks - 1]), Stage("merge"), Stage("develop", plan.strip_tasks and plan.strip_tasks[:2])]
        lines, _ = slurm.Chain(self.night, plan).lines(stages)
        for line in lines:
            self.assertEqual(shlex.split(line.partition("$(")[2].removesuffix(")"))[4:4 + len(plan.sbatch)], plan.sbatch)
        return texts + [engines.shell_line(self.night, stages), engines.parallel_line(self.night, stages, plan.hosts), *lines]

    def words(self, script):
        """Those of each line at its top, as a shell reads them."""
        return [shlex.split(line) for line in script.splitlines()[3:20] if line.startswith(("scene=", "command=", "set -- "))]

    def test_a_plan_is_refused_with_one_line_or_can_be_worked_with(self):
        refused, lines = 0, []
        for seed in range(3000):
            self.night.plan_file.write_bytes(mutant(seed))
            with self.subTest(seed):
                try:
                    plan = self.night.read_plan()
                except Failure as error:
                    self.check_line(error)
                    refused += 1
                    continue
                lines += self.use(plan)
                self.night.write_plan(plan)
                self.assertEqual(self.night.read_plan(), plan)
        self.assertTrue(1000 < refused < 2900, refused)
        checked = subprocess.run(["bash", "-n"], input="\n".join(lines), capture_output=True, text=True)  # what is quoted stays so
        self.assertEqual((checked.returncode, checked.stderr), (0, ""))

    def test_a_plan_of_very_many_tasks_is_refused_before_they_are_listed(self):
        for samples, tasks in ((10**15, 1), (2**62, 1), (2**21, 1)):
            self.night.plan_file.write_text(json.dumps({**dataclasses.asdict(PLAN), "samples": samples, "task_samples": tasks}))
            with self.assertRaisesRegex(Failure, f"plan.json: .*{samples} tasks: a plan has at most 1048576"):
                self.night.read_plan()

    def test_the_list_of_jobs_is_refused_with_one_line_or_is_one(self):
        for data in [json.dumps(value).encode() for value in VALUES] + FRAGMENTS + [b'["1", "x"]', b'["1", ["2"]]', b'["1"'] + [b"1" * (2 << 20)]:
            self.night.jobs.write_bytes(data)
            try:
                numbers = self.night.read_jobs()
                self.assertEqual([number for number in numbers if not number.isdecimal()], [])
            except Failure as error:
                self.check_line(error)

    def test_whatever_a_file_says_about_its_origin_can_be_shown(self):
        chance = random.Random(7)
        keys = ("host", "date", "committed_before", "program")
        for _ in range(2000):
            origin = chance.choice((None, [], "x", *[{key: chance.choice((*VALUES, "9999-12-31T23:59:59Z", "0001-01-01T00:00:00Z")) for key in keys}] * 8))
            info = {"job": PLAN.job, "samples": [[0, 8192]], "damage": [], "origin": origin}
            found = state.State([], [], [], [], 0, 1)
            path = mock.Mock(stat=lambda: types.SimpleNamespace(st_mtime=chance.choice((-1e11, 0.0, 1e9, 1e18)), st_size=9))
            path.name = chance.choice(("part-00000.latent", "part-00000.latent.part.0"))
            state.take(found, self.night, PLAN, path, info)
            report = status.summary(self.night, PLAN, found, time.time(), 300)
            self.assertFalse(any(is_control(c) for c in status.to_text(report, time.time()).replace("\n", "")))
            json.dumps(report, allow_nan=False)


if __name__ == "__main__":
    unittest.main()
