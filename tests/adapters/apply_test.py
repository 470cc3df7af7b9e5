# adapters/pbrt-v4/apply changes a tree once and as a whole, or not at all. The trees here hold only the places that it looks for.
# Usage: apply_test.py APPLY
import importlib.machinery
import importlib.util
import pathlib
import subprocess
import sys
import tempfile
import unittest

APPLY = sys.argv[1]
loader = importlib.machinery.SourceFileLoader("apply", APPLY)
apply = importlib.util.module_from_spec(importlib.util.spec_from_loader("apply", loader))
loader.exec_module(apply)


def run(*arguments):
    return subprocess.run([sys.executable, "-B", APPLY, *map(str, arguments)], capture_output=True, text=True)


class Apply(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.tree = pathlib.Path(folder.name)
        for name, place, _ in apply.CHANGES:
            path = self.tree / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text((path.read_text() if path.exists() else "// first\n") + place + "// next\n")

    def texts(self):
        return {str(path.relative_to(self.tree)): path.read_text() for path in self.tree.rglob("*") if path.is_file()}

    def test_every_change_is_made_and_nothing_else(self):
        before = self.texts()
        self.assertEqual(run(self.tree, "--check").returncode, 0)
        self.assertEqual(self.texts(), before)
        done = run(self.tree)
        self.assertEqual(done.returncode, 0, done.stderr)
        after = self.texts()
        for name, place, replacement in apply.CHANGES:
            self.assertIn(replacement, after[name])
            after[name] = after[name].replace(replacement, place)
        self.assertEqual(set(after) - set(before), {"src/pbrt/latent_film.h", "src/pbrt/latent_film.cpp"})
        self.assertEqual({name: after[name] for name in before}, before)

    def test_a_second_time_changes_nothing(self):
        run(self.tree)
        before = self.texts()
        again = run(self.tree)
        self.assertEqual((again.returncode, self.texts()), (0, before))
        self.assertIn("already", again.stdout)

    def test_a_place_that_is_missing_or_there_twice_leaves_the_tree_as_it_was(self):
        for name, place, _ in apply.CHANGES:
            path, good = self.tree / name, (self.tree / name).read_text()
            for bad in (good.replace(place, ""), good + place):
                path.write_text(bad)
                before = self.texts()
                refused = run(self.tree)
                self.assertEqual((refused.returncode, self.texts()), (1, before))
                self.assertIn(str(path), refused.stderr)
            path.write_text(good)

    def test_another_folder_is_refused(self):
        refused = run("/tmp")
        self.assertEqual(refused.returncode, 1)
        self.assertIn("is not a source tree of pbrt-v4", refused.stderr)


unittest.main(argv=sys.argv[:1])
