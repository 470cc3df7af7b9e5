"""Files that strangers made: their names run no command, whatever runs the steps, and are not obeyed by a terminal."""
import json
import os
import pathlib
import shlex
import shutil
import stat
import subprocess
import sys
import unittest
from unittest import mock

from support import SCENE, TOOLS, FarmTest, run
from latent_farm import files
from latent_farm.errors import Failure
from latent_farm.folder import Folder
from latent_farm.names import is_control

REFUSED = ["line\ntouch hacked\n#", "return\rtouch hacked", "tab\there", "\x1b[31mred\x1b[0m", "bell\a", "delete\x7f", "next\x85line", "line\u2028separator",
           "reversed\u202etbrp", "isolated\u2066", os.fsdecode(b"not UTF-8 \xff"), os.fsdecode(b"cut short \xc3(")]
TAKEN = [" leading space", "trailing space ", "'; touch hacked; '", '"; touch hacked; "', "$(touch hacked)", "`touch hacked`", "; touch hacked ;", "&touch hacked&",
         "|touch hacked", "a >hacked", "$HOME", "${IFS}", "-o", "--help", "{}", "{= system(qq{touch hacked}) =}", "{= qx(touch hacked) =}{#}{%}", "%A_%a %s%n", "back\\slash\\",
         "\\n", "*", "?[a-z]", "~root", "!!", "#SBATCH --wrap=hacked", "naïve été 日本語", "\U0001f469\u200d\U0001f4bb", "x" * 250, ".hidden", "a=b,c:d@e+f", "..", "logs"]
SBATCH = """#!{python}
# A stand-in for sbatch, which runs the jobs as Slurm does: a copy of the script, in the folder of --chdir.
import os, pathlib, re, shutil, subprocess, sys
words = sys.argv[1:]
options = dict(word.partition("=")[::2] for word in words if word.startswith("--"))
script, *offset = [word for word in words if not word.startswith("--")]
copy = pathlib.Path({copy!r})
shutil.copy(script, copy)
for line in re.findall("(?m)^#SBATCH (.*)$", copy.read_text()):
    assert re.fullmatch(r"(--[a-z-]+(=[A-Z0-9:@]+|=/dev/null)? ?)+", line), line
for index in options.get("--array", "0").split(","):
    subprocess.run(["bash", copy, *offset], cwd=options["--chdir"], env={{**os.environ, "SLURM_ARRAY_TASK_ID": index}}, stderr=subprocess.DEVNULL, check=True)
print(7)
"""


class Names(FarmTest):
    """The scenes of a film, whose names are what a stranger chose, and those of the folders of its frames."""

    def scenes(self, names):
        made = []
        for name in names:
            made.append(self.folder / "scenes" / f"{name}.pbrt")
            made[-1].parent.mkdir(exist_ok=True)
            shutil.copy(SCENE, made[-1])
        return made

    def farm(self, command, *arguments, **settings):
        return self.succeed("latent-farm", command, *arguments, "--out", "film", "--spp", 1, "--tasks", 1, "--", "--resolution", "16x16", cwd=self.folder, **settings)

    def check_film(self):
        """Every frame has the picture of the first, and no command in a name has run."""
        pictures = {path.parent.name: path.read_bytes() for path in self.folder.glob("film/*/picture.exr")}
        self.assertEqual(set(pictures), {f"{name}.pbrt" if name == ".." else name for name in TAKEN})
        self.assertEqual(len(set(pictures.values())), 1)
        self.assertEqual({path.name for path in self.folder.iterdir()} - {"bin"}, {"scenes", "film"})
        self.assertEqual([path for path in self.folder.rglob("*") if path.name == "hacked"], [])
        for log in self.folder.glob("film/*/logs/*.log"):
            if log.name != "parallel.log":
                self.assertRegex(log.read_text(), rf"^{log.name.split('-')[0].removesuffix('.log')}( 0)? on ")

    def test_there_are_forty(self):
        self.assertGreaterEqual(len(set(REFUSED + TAKEN)), 40)

    def test_control_characters_are_refused_and_shown_harmlessly(self):
        self.assertEqual([name for name in TAKEN if any(map(is_control, name))], [])
        for scene in self.scenes(REFUSED):
            for arguments in ([scene, "--out", self.folder / "film"], [SCENE, "--out", self.folder / scene.stem], [SCENE, "--out", self.folder / "film", "--hosts", scene]):
                done = self.fail_with("; rename it\n", "latent-farm", "plan", *arguments, "--spp", 1, "--engine", "parallel", status=2)
                self.assertRegex(done.stderr, r": contains (the control character|a byte that is not UTF-8,) \\\w+; ")
                self.assertFalse(any(is_control(c) for c in done.stderr.removesuffix("\n")), done.stderr)
        self.fail_with("contains the control character \\x0b", "latent-farm", "plan", SCENE, "--out", "film", "--spp", 1, "--develop=a\vb", status=2)
        self.fail_with("contains the control character \\n", "latent-farm", "plan", SCENE, "--out", "film", "--spp", 1, "--", "a\nb", status=2)
        self.assertEqual(os.listdir(self.folder), ["scenes"])

    def test_a_shell_makes_all_frames(self):
        self.farm("submit", *self.scenes(TAKEN), "--engine", "shell")
        self.check_film()

    def test_the_steps_work_from_inside_their_folder(self):
        self.farm("plan", *self.scenes(TAKEN), "--engine", "shell")
        for name in TAKEN:
            for step in ["./task", "0"], ["sh", "merge"], ["./develop"], ["bash", "run", "develop"]:
                self.succeed(*step, cwd=self.folder / "film" / (f"{name}.pbrt" if name == ".." else name))
        self.check_film()

    @unittest.skipUnless(shutil.which("parallel"), "GNU parallel is not installed")
    def test_parallel_makes_all_frames_over_ssh(self):
        (self.folder / "bin").mkdir()
        ssh = self.folder / "bin/ssh"  # HOST COMMAND, as the login shell over there reads it; sshd sets SHELL, which parallel needs
        ssh.write_text('#!/bin/sh\nwhile [ "$1" != -- ]; do shift; done\nshift\ncd / && SHELL=/bin/sh exec sh -c "$*"\n')
        ssh.chmod(0o755)
        hosts = self.folder / "bin/hosts {= system(qq{touch hacked}) =}"
        hosts.write_text(f"{ssh} there\n")
        self.farm("submit", *self.scenes(TAKEN), "--engine", "parallel", "--hosts", hosts)
        self.check_film()

    def test_slurm_makes_all_frames(self):
        (self.folder / "bin").mkdir()
        sbatch = self.folder / "bin/sbatch"
        sbatch.write_text(SBATCH.format(python=sys.executable, copy=str(self.folder / "bin/slurm_script")))
        sbatch.chmod(0o755)
        self.farm("submit", *self.scenes(TAKEN), "--engine", "slurm", env={**os.environ, "PATH": f"{self.folder / 'bin'}:{os.environ['PATH']}"})
        self.check_film()


class Folders(FarmTest):
    """What lies in the folder of a plan, and should not."""

    def test_nothing_is_written_through_a_link_nor_left_behind(self):
        victim = self.folder / "victim"
        victim.write_text("precious")
        victim.chmod(0o600)
        night = self.folder / "night"
        night.mkdir()
        for name in ["plan.json", "task", "merge", "develop", "run", "task.sbatch"]:
            (night / name).symlink_to(victim)
            (night / f".{name}.{os.getpid()}").symlink_to(victim)
        with mock.patch("secrets.token_hex", return_value="known"):
            (night / ".latent-known.tmp").symlink_to(victim)
            with self.assertRaisesRegex(Failure, "task: cannot be written: File exists$"):
                files.write(night / "task", "#!/bin/sh\n", 0o777)
            (night / ".latent-known.tmp").unlink()
            files.write(night / "task", "#!/bin/sh\n", 0o777)
        self.assertEqual((night / "task").stat().st_mode & 0o111, 0o111 & ~self.umask())
        (night / "plan.json").unlink()
        self.plan()
        self.assertEqual((victim.read_text(), stat.S_IMODE(victim.stat().st_mode)), ("precious", 0o600))
        self.assertEqual([name for name in os.listdir(night) if name.endswith(".tmp")], [])
        self.assertFalse(any((night / name).is_symlink() for name in ("plan.json", "task", "merge", "develop", "run", "task.sbatch")))

    def umask(self):
        mask = os.umask(0)
        os.umask(mask)
        return mask

    def test_logs_are_not_written_through_links_or_into_pipes(self):
        self.plan("--tasks", 1)
        log = self.folder / "night/logs/task-00000.log"
        victim = self.folder / "victim"
        for make in (lambda: log.symlink_to(victim), lambda: os.mkfifo(log), log.mkdir):
            make()
            self.fail_with("task-00000.log: is not a regular file; remove it", self.folder / "night/run", "task", 0)
            log.rmdir() if log.is_dir() else log.unlink()
        self.assertFalse(victim.exists())

    def test_arguments_of_the_scripts_are_numbers_and_steps(self):
        self.plan("--tasks", 2)
        for arguments in (["task"], ["task", "x[$(touch hacked)]"], ["task", "-1"], ["task", "2"], ["task", "99999999999999999999"], ["../victim"], ["merge", "0"], []):
            self.succeed(self.folder / "night/run", *arguments, status=2, cwd=self.folder)
        for argument in ("", "x[$(touch hacked)]", "-1", "2", "99999999999999999999", "007"):
            self.succeed(self.folder / "night/task", argument, status=2, cwd=self.folder)
        self.assertEqual(os.listdir(self.folder), ["night"])
        self.assertEqual(os.listdir(self.folder / "night/parts"), [])

    def test_pipes_and_links_to_themselves_are_named_and_nothing_waits_for_them(self):
        self.plan("--tasks", 2, command="submit")
        night = self.folder / "night"
        (night / "parts/part-00009.latent").symlink_to("part-00009.latent")
        os.mkfifo(night / "parts/part-00010.latent")
        (night / "parts/part-00011.latent").symlink_to("nowhere")
        (night / "samples.latent").unlink()
        status = self.status()
        self.assertEqual((status["missing_tasks"], status["steps_left"]), ("", ["merge", "develop"]))
        self.assertEqual({os.path.basename(item["place"]) for item in status["left_out"]}, {f"part-{number:05}.latent" for number in (9, 10)})
        self.succeed("latent-farm", "resume", night)
        self.assertEqual(self.status()["steps_left"], [])
        for name, command in (("plan.json", ["status", night]), ("jobs.json", ["resume", night]), ("strip", ["join", night / "strip", "-o", night / "x.exr"]),
                              ("hosts", ["resume", night, "--engine", "parallel", "--hosts", night / "hosts"])):
            (night / name).unlink(missing_ok=True)
            os.mkfifo(night / name)
            self.fail_with(f"{name}: is not a regular file", "latent-farm", *command)
            (night / name).unlink()
            self.plan("--tasks", 2)

    def test_a_plan_that_names_an_endless_list_of_machines_is_refused(self):
        (self.folder / "hosts").write_text("node1\n")
        self.plan("--hosts", self.folder / "hosts", engine="parallel")
        plan = self.folder / "night/plan.json"
        plan.write_text(json.dumps({**json.loads(plan.read_text()), "hosts": "/dev/zero"}))
        self.fail_with("/dev/zero: is not a regular file", "latent-farm", "resume", self.folder / "night")

    def test_what_others_called_their_files_and_machines_does_not_reach_the_terminal(self):
        self.plan("--tasks", 1, command="submit")
        parts = self.folder / "night/parts"
        for name in REFUSED:
            (parts / name).write_text("")
        done = self.succeed("latent-farm", "status", self.folder / "night")
        self.assertEqual(done.stdout.count("left out: "), len(REFUSED))
        self.assertFalse(any(is_control(c) for c in done.stdout.replace("\n", "")))
        self.assertEqual(len(self.status()["left_out"]), len(REFUSED))

    def test_clocks_may_be_wrong_by_any_time(self):
        self.plan("--tasks", 1, command="submit")
        part = self.folder / "night/parts/part-00000.latent"
        for seconds in (-(2**33), 0, 2**31, 2**33 + 2**32):
            os.utime(part, (seconds, seconds))
            self.assertRegex(self.succeed("latent-farm", "status", self.folder / "night").stdout, r"(?m)  (0s|\d+ days|over 100 years) ago$")
            self.status()

    def test_a_report_that_cannot_be_written_is_an_error(self):
        self.plan("--tasks", 1)
        night = self.folder / "night"
        farm = shlex.join([str(TOOLS / "latent-farm"), "status", str(night)])
        again = shlex.join([str(TOOLS / "latent-farm"), "plan", str(SCENE), "--out", str(night)])
        for command, status in ((farm, 1), (farm + " --json", 1), (f"{TOOLS / 'latent-farm'} --help", 1), (again, 3)):
            for where, why in ((">&-", "Bad file descriptor"), (">/dev/full", "No space left on device")):
                done = run("/bin/sh", "-c", f"{command} {where}")
                self.assertEqual((done.returncode, done.stderr), (status, f"latent-farm: standard output: cannot write: {why}\n"))
        done = subprocess.run(["/bin/bash", "-c", f"{farm} | true; echo ${{PIPESTATUS[0]}}"], capture_output=True, text=True)
        self.assertIn((done.stdout, done.stderr), {("0\n", ""), ("141\n", "")})


if __name__ == "__main__":
    unittest.main()
