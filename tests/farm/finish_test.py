"""How a render ends: what failed is named with its reason, what is done is printed, filmed and told."""
import json
import os
import re
import shutil
import signal
import struct
import subprocess
import sys
import time
import unittest

from support import SCENE, FarmTest, start
from latent_farm.frames import in_order
from latent_farm.names import is_control

FFMPEG = """#!{python}
# A stand-in for ffmpeg: its film holds its arguments and the pictures.
import json, sys
pictures = sys.stdin.buffer.read()
if b"unprintable" in pictures:
    sys.exit("first words\\nInvalid data \\x1b[31mfound")
with open(sys.argv[-1].removeprefix("file:"), "wb") as film:
    film.write(json.dumps(sys.argv[1:-1]).encode() + b"\\n" + pictures)
"""
PNG = b"\x89PNG\r\n\x1a\n"


class Failures(FarmTest):
    def test_a_failed_task_is_named_with_its_machine_its_reason_and_its_log_until_it_is_tried_again(self):
        self.plan("--tasks", 3)
        night = self.folder / "night"
        (night / "parts/part-00001.latent").write_text("not samples")
        done = self.succeed("latent-farm", "resume", night, status=1)
        said = [line for line in done.stderr.splitlines() if line.startswith("latent-render: ")][-1]
        [failed] = self.status()["failed"]
        self.assertEqual(json.loads(self.succeed("latent-farm", "status", night, "--json").stdout)["failed"], [failed])
        self.assertEqual(failed, {"step": "task", "task": 1, "host": os.uname().nodename, "status": 1, "reason": said, "log": "logs/task-00001.log"})
        text = self.succeed("latent-farm", "status", night).stdout
        self.assertIn(f"failed:  task 1 on {os.uname().nodename}: {said}\n         log: logs/task-00001.log\n", text)
        (night / "parts/part-00001.latent").unlink()
        self.assertIn(said, self.succeed("latent-farm", "status", night).stdout)
        self.succeed("latent-farm", "resume", night)
        self.assertEqual(self.status()["failed"], [])
        self.assertIn("task 1: failed with status 1\ntask 1 on ", (night / "logs/task-00001.log").read_text())

    def test_later_steps_are_named_too(self):
        self.plan("--tasks", 1, "--develop=--filter nonsense")
        self.succeed("latent-farm", "resume", self.folder / "night", status=1)
        [failed] = self.status()["failed"]
        self.assertEqual((failed["step"], failed["task"], failed["log"]), ("develop", None, "logs/develop.log"))
        self.assertIn("nonsense", failed["reason"])

    def test_a_folder_with_the_name_of_a_picture_is_no_picture(self):
        self.plan("--tasks", 1)
        (self.folder / "night/picture.exr").mkdir()
        self.succeed("latent-farm", "resume", self.folder / "night", status=1)
        status = self.status()
        self.assertEqual((status["steps_left"], [failed["step"] for failed in status["failed"]]), (["develop"], ["develop"]))
        self.fail_with("the name of the folder is empty", "latent-farm", "status", "", status=2)

    def test_a_task_that_is_killed_or_interrupted_says_so(self):
        self.plan("--tasks", 1, "--checkpoint", "0.05", spp=4000)
        night = self.folder / "night"
        for number, status in ((signal.SIGKILL, 137), (signal.SIGTERM, 75), (signal.SIGINT, 75)):
            task = subprocess.Popen([night / "run", "task", "0"], stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
            while not (children := subprocess.run(["pgrep", "-P", str(task.pid), "latent-render"], capture_output=True, text=True).stdout.split()):
                time.sleep(0.05)
            before = self.status()["committed"]
            while self.status()["committed"] == before:
                time.sleep(0.05)
            os.kill(int(children[0]) if number == signal.SIGKILL else task.pid, number)
            self.assertEqual(task.wait(), status)
            self.assertEqual([failed["reason"] for failed in self.status()["failed"]], ["killed, perhaps because memory ran out"] * (status == 137))
        self.assertTrue((night / "logs/task-00000.log").read_text().endswith("task 0: interrupted; what it finished is saved\n"))

    def test_a_submission_that_is_interrupted_saves_its_work_and_leaves_nothing_running(self):
        for engine, number in [("shell", signal.SIGINT), ("shell", signal.SIGTERM)] + [("parallel", signal.SIGTERM)] * bool(shutil.which("parallel")):
            name = f"{engine}-{number}"
            self.plan("--tasks", 2, "--checkpoint", "0.05", spp=4000, out=name, engine=engine)
            farm = start("latent-farm", "resume", self.folder / name)
            while not self.status(name)["committed"]:
                time.sleep(0.05)
            self.assertGreater(self.status(name)["tasks_working"], 0)
            farm.send_signal(number)
            said = farm.communicate()[1]
            self.assertEqual(farm.returncode, 75, said)
            self.assertTrue(said.endswith(f"latent-farm: interrupted; what was finished is saved; go on with latent-farm resume {self.folder / name}\n"), said)
            self.assertEqual(subprocess.run(["pgrep", "-f", f"latent-render.*{self.folder / name}/"]).returncode, 1, "none is running")
            report = self.status(name)
            self.assertEqual((report["tasks_working"], report["failed"]), (0, []))

    def test_a_log_with_anything_in_it_gives_one_harmless_line(self):
        self.plan("--tasks", 1)
        log = self.folder / "night/logs/task-00000.log"
        for data, reason in ((b"task 0 on n1, 2026-01-01T00:00:00Z\n\xff\x1b[31m\rwhy \x9b\ntask 0: failed with status 3\n", "why \\x9b"),
                             (b"x" * 300000 + b"\ntask 0: failed with status 3\n", "x" * 300 + "..."), (b"task 0: failed with status 3", "status 3")):
            log.write_bytes(data)
            text = self.succeed("latent-farm", "status", self.folder / "night").stdout
            self.assertFalse(any(is_control(c) for c in text.replace("\n", "")))
            self.assertRegex(text, rf"(?m)^failed:  task 0 on (n1|an unknown machine): {re.escape(reason)}$")
            self.assertEqual(len(self.status()["failed"]), 1)
        for data in (b"", b"\0" * 70000, b"task 0: failed with status 3\ntask 0 on n2, 2026-01-01T00:00:00Z\n"):
            log.write_bytes(data)
            self.assertEqual(self.status()["failed"], [])


class Finish(FarmTest):
    def test_the_print_is_that_of_latent_convert_and_made_anew_with_other_options(self):
        report = self.plan("--tasks", 1, "--develop=--size 32", "--print=--sensitivity 0.5", command="submit")
        self.assertEqual(report["steps"], ["render", "merge", "develop", "print"])
        picture, made = self.folder / "night/picture.exr", self.folder / "night/picture.png"
        self.succeed("latent-convert", picture, "--sensitivity", 0.5, "-o", self.folder / "x.png")
        self.assertEqual(made.read_bytes(), (self.folder / "x.png").read_bytes())
        self.assertEqual(self.plan("--print=--sensitivity 0.5")["steps"], [])
        self.assertEqual(self.plan("--print=--sensitivity 2")["steps"], ["print"])
        self.assertEqual(self.plan("--develop=--size 16")["steps"], ["develop", "print"])
        self.assertEqual(self.plan("--until", "develop")["steps"], ["develop"])

    def film(self, *more, status=0, path=True, spp=1):
        """An animation of three frames, by the stand-in for ffmpeg, if `path`."""
        tools = self.folder / "bin"
        tools.mkdir(exist_ok=True)
        (tools / "ffmpeg").write_text(FFMPEG.format(python=sys.executable))
        (tools / "ffmpeg").chmod(0o755)
        scenes = []
        for number in (1, 9, 10):
            scenes.append(self.folder / f"frame.{number}.pbrt")
            scenes[-1].write_text(SCENE.read_text().replace("2856", str(2856 + number)))
        given = [] if "--engine" in more else ["--engine", "shell"]
        found = f"{tools}:{os.environ['PATH']}" if path else os.environ["PATH"]
        return self.succeed("latent-farm", "submit", *scenes, "--spp", spp, "--out", self.folder / "film", "--tasks", 1, "--json", *given, *more,
                            "--", "--resolution", "16x16", status=status, env={**os.environ, "PATH": found})

    def test_prints_of_an_animation_become_a_film_in_the_order_of_their_numbers(self):
        self.assertIn("the film may flicker", self.film("--print=", "--fps", 25).stderr)
        film = self.folder / "film/film.mp4"
        words, pictures = film.read_bytes().split(b"\n", 1)
        self.assertEqual(pictures, b"".join((self.folder / f"film/frame.{number}/picture.png").read_bytes() for number in (1, 9, 10)))
        self.assertTrue(pictures.startswith(PNG) and pictures.count(PNG) == 3)
        self.assertEqual(struct.unpack(">2I", pictures[16:24]), (16, 16), "the size rendered for")
        self.assertIn(["-framerate", "25"], [json.loads(words)[i:i + 2] for i in range(20)])
        made = film.stat().st_mtime_ns
        self.film()
        self.assertEqual(film.stat().st_mtime_ns, made)
        self.fail_with("film.mp4: exists; ", "latent-farm", "film", self.folder / "film")
        self.assertNotIn("flicker", self.film("--print=-s 2", spp=2).stderr)
        self.assertNotEqual(film.stat().st_mtime_ns, made)
        self.assertEqual(sorted(["a.10", "a.9", "a", "b.1", "a.09x"], key=in_order), ["a", "a.9", "a.09x", "a.10", "b.1"])

    def test_without_ffmpeg_there_are_prints_and_what_ffmpeg_refuses_leaves_no_film(self):
        if not shutil.which("ffmpeg"):
            self.film("--print=", path=False)
            self.assertFalse((self.folder / "film/film.mp4").exists())
            self.fail_with("ffmpeg: not found", "latent-farm", "film", self.folder / "film")
        self.film("--print=")
        (self.folder / "film/frame.9/picture.png").write_bytes(PNG + b"unprintable")
        env = {**os.environ, "PATH": f"{self.folder / 'bin'}:{os.environ['PATH']}"}
        self.fail_with("ffmpeg: Invalid data \\x1b[31mfound\n", "latent-farm", "film", self.folder / "film", "-o", self.folder / "new.mp4", env=env)
        (self.folder / "film/frame.9/picture.png").write_bytes(b"nothing of the kind")
        self.fail_with("frame.9/picture.png: is not a PNG file; print this frame again", "latent-farm", "film", self.folder / "film", "-o", self.folder / "new.mp4", env=env)
        (self.folder / "film/frame.9/picture.png").unlink()
        self.fail_with("frame.9/picture.png: no such file; print this frame first", "latent-farm", "film", self.folder / "film", "-o", self.folder / "new.mp4", env=env)
        self.assertEqual([name for name in os.listdir(self.folder) if name.endswith((".mp4", ".tmp"))], [])

    @unittest.skipUnless(shutil.which("ffmpeg"), "ffmpeg is not installed")
    def test_ffmpeg_makes_a_film_of_as_many_frames(self):
        self.film("--print=", path=False)
        said = self.succeed("ffmpeg", "-v", "error", "-i", self.folder / "film/film.mp4", "-f", "framemd5", "-")
        self.assertEqual(len([line for line in said.stdout.splitlines() if not line.startswith("#")]), 3, said.stdout)

    def test_the_command_runs_once_in_the_folder_when_all_is_done_and_not_after_a_failure(self):
        told = self.folder / "told"
        command = f"""printf '%s|%s\n' "$folder" "it's $(ls picture.exr)" >>'{told}'""".replace("\n", "\\n")
        self.plan("--tasks", 2, "--on-done", command, command="submit")
        night = self.folder / "night"
        self.assertEqual(told.read_text(), f"{night}|it's picture.exr\n")
        self.succeed("latent-farm", "resume", night)
        self.assertEqual(told.read_text().count("\n"), 1)
        self.succeed("latent-farm", "resume", night, "--develop=--filter nonsense", status=1)
        self.assertEqual(told.read_text().count("\n"), 1)
        self.succeed("latent-farm", "resume", night, "--develop=", "--on-done", "echo no news >&2; exit 3", status=1)
        [failed] = json.loads(self.succeed("latent-farm", "status", night, "--json").stdout)["failed"]
        self.assertEqual((failed["step"], failed["status"], failed["reason"]), ("done", 3, "no news"))
        self.assertIn("then:    done\nfailed:  done on ", self.succeed("latent-farm", "status", night).stdout)
        self.succeed("latent-farm", "resume", night, "--on-done", "true")
        self.assertEqual(json.loads(self.succeed("latent-farm", "resume", night, "--json").stdout)["steps"], [])

    def test_the_command_runs_once_for_all_frames(self):
        for engine in ["shell"] + ["parallel"] * bool(shutil.which("parallel")):
            told = self.folder / engine
            self.film("--engine", engine, "--on-done", f"ls -d */picture.exr >>{told}")
            self.assertEqual(told.read_text().split(), [f"frame.{number}/picture.exr" for number in (1, 10, 9)])
            shutil.rmtree(self.folder / "film")

    def test_reports_of_one_scene_and_of_many_have_the_same_shape(self):
        self.film()
        many = json.loads(self.succeed("latent-farm", "status", self.folder / "film", "--json").stdout)
        one = json.loads(self.succeed("latent-farm", "status", self.folder / "film/frame.1", "--json").stdout)
        self.assertEqual((one.keys(), one["frames"][0].keys()), (many.keys(), many["frames"][0].keys()))
        self.assertEqual(many["frames"][0], {**one["frames"][0], "free_bytes": many["frames"][0]["free_bytes"]})
        self.assertEqual((many["samples"], many["frames_done"]), (3 * one["samples"], 3))
        farm = ["latent-farm", "resume", "--json"]
        self.assertEqual(json.loads(self.succeed(*farm, self.folder / "film").stdout).keys(), json.loads(self.succeed(*farm, self.folder / "film/frame.1").stdout).keys())

    def test_metrics_are_those_of_the_report(self):
        self.plan("--tasks", 2, out='a "night"\\', command="submit")
        text = self.succeed("latent-farm", "status", self.folder / 'a "night"\\', "--prometheus").stdout
        status = self.status('a "night"\\')
        label = str(self.folder / 'a "night"\\').replace("\\", "\\\\").replace('"', '\\"')
        rows = dict(re.fullmatch(r"(latent_farm_\w+\{.*\}) (\S+)", line).groups() for line in text.splitlines() if not line.startswith("#"))
        for name, value in (("samples", status["samples"]), ("samples_committed", status["committed"]), ("tasks_finished", 2), ("steps_left", 0), ("steps_failed", 0)):
            self.assertEqual(float(rows[f'latent_farm_{name}{{folder="{label}"}}']), value)
        machine = f'latent_farm_machine_last_commit_timestamp_seconds{{folder="{label}",machine="{os.uname().nodename}"}}'
        self.assertEqual(float(rows[machine]), status["machines"][os.uname().nodename]["last_commit"])
        typed = re.findall(r"(?m)^# TYPE (\w+) gauge$", text)
        self.assertEqual((len(typed), set(typed)), (len(set(typed)), set(re.findall(r"(?m)^# HELP (\w+) \w", text))))
        self.assertLessEqual({row.split("{")[0] for row in rows}, set(typed))


if __name__ == "__main__":
    unittest.main()
