"""How a render is cut into tasks: laws for all sizes, without rendering anything."""
import itertools
import random
import unittest

import support  # noqa: F401  (finds the modules)
from latent_farm import ranges, sizing


class Sizing(unittest.TestCase):
    def test_tasks_of_a_long_render_take_10_to_60_minutes(self):
        for hours, machines in itertools.product([1, 7, 100, 5000], [1, 8, 50, 1000]):
            seconds = hours * 3600
            tasks = sizing.count_tasks(seconds, machines)
            self.assertLessEqual(seconds / tasks, 3600)
            if seconds >= 600 * machines:
                self.assertGreaterEqual(seconds / tasks, 600 * (tasks - 1) / tasks)

    def test_every_machine_has_a_task_however_short_the_render(self):
        for seconds, machines in itertools.product([0.1, 20, 4000], [1, 8, 333]):
            self.assertGreaterEqual(sizing.count_tasks(seconds, machines), machines)

    def test_tasks_are_whole_runs_and_hold_every_sample(self):
        chance = random.Random(1)
        for _ in range(2000):
            samples, tasks = chance.randrange(1, 1 << chance.randrange(1, 50)), chance.randrange(1, 2000)
            before = 1 << chance.randrange(10, 23)
            for may_shorten in (True, False):
                length, run = sizing.cut(samples, tasks, before, may_shorten)
                self.assertEqual(length % run, 0)
                self.assertGreaterEqual(length * tasks, samples)
                self.assertTrue(1024 <= run <= before and run & (run - 1) == 0)
                self.assertTrue(may_shorten or run == before)

    def test_no_task_is_a_tenth_longer_than_their_mean_unless_runs_cannot_be_shorter(self):
        chance = random.Random(2)
        for _ in range(2000):
            samples, tasks = chance.randrange(1, 1 << chance.randrange(1, 50)), chance.randrange(1, 2000)
            length, run = sizing.cut(samples, tasks, 1 << chance.randrange(10, 23), True)
            self.assertTrue(run == 1024 or length <= 1.1 * samples / tasks)

    def test_a_job_of_one_run_gives_eight_machines_an_eighth_each(self):
        self.assertEqual(sizing.cut(1 << 19, 8, 1 << 19, True), (1 << 16, 1 << 16))
        length, _ = sizing.cut(500_000, 8, 1 << 19, True)
        self.assertLessEqual(length, 1.1 * 500_000 / 8)

    def test_arrays_hold_every_task_once_with_indices_below_1000(self):
        tasks = [0, 1, 999, 1000, 1001, 4500]
        arrays = sizing.arrays_of(tasks)
        self.assertEqual([offset + index for offset, indices in arrays for index in indices], tasks)
        self.assertTrue(all(0 <= index < 1000 for _, indices in arrays for index in indices))
        self.assertEqual(sizing.arrays_of([]), [])


class Ranges(unittest.TestCase):
    def test_union_and_missing_are_those_of_sets(self):
        chance = random.Random(3)
        for _ in range(500):
            held = [(first, first + chance.randrange(0, 9)) for first in (chance.randrange(40) for _ in range(chance.randrange(6)))]
            numbers = {n for first, end in held for n in range(first, end)}
            joined = ranges.union(held)
            self.assertEqual([n for first, end in joined for n in range(first, end)], sorted(numbers))
            self.assertTrue(all(a[1] < b[0] for a, b in itertools.pairwise(joined)))
            first = chance.randrange(20)
            wanted = (first, first + chance.randrange(25))
            gaps = ranges.missing(wanted, joined)
            self.assertEqual([n for first, end in gaps for n in range(first, end)], sorted(set(range(*wanted)) - numbers))
            self.assertEqual(ranges.size(joined), len(numbers))

    def test_arrays_are_written_as_slurm_reads_them(self):
        self.assertEqual(ranges.array_list([7, 0, 1, 2, 9, 8]), "0-2,7-9")
        self.assertEqual(ranges.array_list([5]), "5")
        self.assertEqual(ranges.array_list([]), "")


if __name__ == "__main__":
    unittest.main()
