"""latent-farm plans, runs and extends a render, with real tools on a small scene: its picture is that of a single process."""
import base64
import json
import os
import pathlib
import resource
import shutil
import signal
import socket
import struct
import subprocess
import sys
import time
import unittest

from support import SCENE, SOURCE, TOOLS, FarmTest, one_frame, run
from latent_farm.strips import Strip


def animated_triangle():
    """glTF: a triangle that moves up by 1 within a second."""
    numbers = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0) + struct.pack("<2f", 0, 1) + struct.pack("<6f", 0, 0, 0, 0, 1, 0)
    views = [(0, 36), (36, 8), (44, 24)]
    types = [("VEC3", 3), ("SCALAR", 2), ("VEC3", 2)]
    return {"asset": {"version": "2.0"},
            "buffers": [{"byteLength": len(numbers), "uri": "data:;base64," + base64.b64encode(numbers).decode()}],
            "bufferViews": [{"buffer": 0, "byteOffset": at, "byteLength": size} for at, size in views],
            "accessors": [{"bufferView": view, "componentType": 5126, "type": kind, "count": count} for view, (kind, count) in enumerate(types)],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "cameras": [{"type": "perspective", "perspective": {"yfov": 1}}],
            "nodes": [{"mesh": 0}, {"camera": 0, "translation": [0, 0, 3]}], "scenes": [{"nodes": [0, 1]}],
            "animations": [{"samplers": [{"input": 1, "output": 2}], "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}]}]}


class Plan(FarmTest):
    def test_a_farm_makes_the_picture_of_one_process_bit_for_bit(self):
        report = self.plan("--tasks", 4, "--develop", "--size 32", command="submit")
        self.assertEqual(report["tasks"], 4)
        self.assertEqual((self.folder / "night/picture.exr").read_bytes(),
                         self.single_process(4, report["run_samples"], develop=["--size", "32"]))
        again = self.plan(command="submit")
        self.assertEqual(again["steps"], [])

    def test_a_plan_starts_nothing_and_its_commands_do_the_work(self):
        report = self.plan("--tasks", 3, out="a night's $work")
        self.assertEqual(os.listdir(self.folder / "a night's $work/parts"), [])
        for command in report["commands"]:
            self.succeed("/bin/sh", "-c", command)
        self.assertTrue((self.folder / "a night's $work/picture.exr").exists())
        self.assertEqual(self.status("a night's $work")["steps_left"], [])

    def test_a_larger_spp_extends_the_plan_and_renders_only_what_is_new(self):
        first = self.plan("--tasks", 3, spp=3, command="submit")
        kept = {name: (self.folder / "night/parts" / name).stat().st_ino for name in ("part-00000.latent", "part-00001.latent")}
        more = self.plan(spp=7.3)
        self.assertEqual(more["task_samples"], first["task_samples"])
        self.assertEqual(more["missing_samples"], more["samples"] - first["samples"])
        self.plan(spp=7.3, command="submit")
        for name, inode in kept.items():
            self.assertEqual((self.folder / "night/parts" / name).stat().st_ino, inode)
        self.assertEqual((self.folder / "night/picture.exr").read_bytes(), self.single_process(7.3, first["run_samples"]))

    def test_parts_may_be_deleted_after_the_merge_and_the_plan_extended_afterwards(self):
        first = self.plan("--tasks", 2, spp=2, command="submit")
        for part in (self.folder / "night/parts").iterdir():
            part.unlink()
        self.assertEqual(self.plan(spp=2)["steps"], [])
        self.plan(spp=4, command="submit")
        self.assertEqual((self.folder / "night/picture.exr").read_bytes(), self.single_process(4, first["run_samples"]))

    def test_what_a_killed_task_had_committed_is_not_rendered_again(self):
        self.plan("--tasks", 2, "--checkpoint", "0.05", spp=400)
        task = subprocess.Popen([self.folder / "night/task", "0"], stderr=subprocess.PIPE)
        while not self.status()["committed"]:
            time.sleep(0.05)
        task.kill()
        task.communicate()
        committed = self.status()["committed"]
        done = self.succeed(self.folder / "night/task", "0")
        self.assertRegex(done.stderr.splitlines()[0], rf"committed {committed} of \d+ samples")
        self.assertEqual(self.status()["tasks_finished"], 1)

    def test_a_task_that_is_signalled_ends_with_status_75_and_resumes(self):
        for number in (signal.SIGTERM, signal.SIGUSR1, signal.SIGUSR2):
            with self.subTest(number):
                self.plan("--tasks", 2, "--checkpoint", "0.05", spp=400, out=str(number))
                task = subprocess.Popen([self.folder / str(number) / "task", "1"], stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
                while not self.status(str(number))["committed"]:
                    time.sleep(0.05)
                task.send_signal(number)
                self.assertEqual(task.wait(), 75)

    def test_eight_machines_share_a_job_of_one_run(self):
        report = self.plan("--machines", 8, spp=16)
        self.assertEqual(report["tasks"], 8)
        self.assertEqual(report["task_samples"] * 8, report["samples"])
        self.assertEqual(report["missing_tasks"], "0-7")

    def test_a_petabyte_is_planned_in_parts_that_fit_into_files(self):
        spp = 7_000_000_000  # 2.9e13 samples; with 35 bytes each, 1 PB
        report = self.plan("--machines", 1000, "--until", "render", spp=spp)
        self.assertEqual(report["samples"], spp * 64 * 64)
        self.assertLessEqual(report["task_seconds"], 1.01 * 3600)
        self.assertGreater(report["samples"], (1 << 20) * report["run_samples"])
        first = (report["tasks"] - 1) * report["task_samples"]
        for begin, end in (0, report["task_samples"]), (first, report["samples"]):  # what the first and the last task render
            done = self.succeed("latent-render", SCENE, "--resolution", "64x64", "--run-samples", report["run_samples"], "--samples",
                                f"{begin}:{end}", "--dry-run", "--max-time", "0.1", "--json", "-o", self.folder / "x.latent")
            self.assertEqual(json.loads(done.stdout)["job"], report["job"])
        self.assertEqual(self.status()["missing_tasks"], f"0-{report['tasks'] - 1}")
        farm = ["latent-farm", "plan", SCENE, "--spp", spp, "--out", self.folder / "x", "--engine", "shell"]
        self.fail_with("use --until render", *farm, "--", "--resolution", "64x64", status=2)
        self.fail_with("or more", *farm, "--tasks", 1, "--until", "render", "--", "--resolution", "64x64", status=2)
        self.fail_with("fewer than 2^62 samples", *farm, "--spp", "9e14", "--", "--resolution", "128x128", status=2)
        self.assertFalse((self.folder / "x").exists())

    def test_a_copy_of_the_plan_renders_elsewhere_and_its_parts_are_brought_back(self):
        report = self.plan("--tasks", 3)
        for machine, tasks in ("node1", (0, 1)), ("node2", (1, 2)):  # task 1 on both
            there = self.folder / machine
            shutil.copytree(self.folder / "night", there / "night")
            shutil.copy(SCENE, there)
            for task in tasks:
                self.succeed("night/task", task, cwd=there, env={**os.environ, "LATENT_SCENE": SCENE.name})
            shutil.copytree(there / "night/parts", self.folder / "night/parts", dirs_exist_ok=True)
        self.assertEqual(self.status()["missing_tasks"], "")
        self.succeed("latent-farm", "resume", self.folder / "night", "--engine", "shell")
        self.assertEqual((self.folder / "night/picture.exr").read_bytes(), self.single_process(4, report["run_samples"]))

    def test_runs_have_the_length_that_latent_render_is_asked_for(self):
        for i, option in enumerate((["--run-samples", "1Ki"], ["--run-samples=1Ki"])):
            report = self.plan("--tasks", 3, spp=3, command="submit", out=str(i), options=option)
            self.assertEqual(report["run_samples"], 1024)
            more = self.plan(spp=4, command="submit", out=str(i), options=option)  # which asks latent-render again
            self.assertEqual((more["run_samples"], more["samples"]), (1024, 64 * 64 * 4))
            self.assertEqual((self.folder / str(i) / "picture.exr").read_bytes(), self.single_process(4, 1024))

    def test_the_merge_names_what_is_missing_and_leaves_no_file(self):
        report = self.plan("--tasks", 4)
        for task in (0, 1, 3):
            self.succeed(self.folder / "night/task", task)
        done = self.succeed(self.folder / "night/merge", status=1)
        self.assertIn(f"samples {2 * report['task_samples']}:{3 * report['task_samples']} are required", done.stderr)
        self.assertFalse((self.folder / "night/samples.latent").exists())

    def test_a_part_that_is_damaged_after_it_was_finished_is_named_and_loses_only_what_is_damaged(self):
        report = self.plan("--tasks", 4, options=["--run-samples", "1Ki"])
        for task in range(4):
            self.succeed(self.folder / "night/task", task)
        part = self.folder / "night/parts/part-00002.latent"
        data = bytearray(part.read_bytes())
        data[len(data) // 2] ^= 1
        part.write_bytes(data)
        done = self.succeed("latent-farm", "resume", self.folder / "night", "--engine", "shell", status=1)
        self.assertIn("are required, but no part holds them; left out: parts/part-00002.latent: ", done.stderr)
        self.succeed("latent-inspect", "recover", part, "-o", self.folder / "saved.latent", status=3)
        (self.folder / "saved.latent").rename(part)
        done = self.succeed("latent-farm", "resume", self.folder / "night", "--engine", "shell")
        self.assertIn(", 1024 rendered", done.stderr)
        self.assertEqual((self.folder / "night/picture.exr").read_bytes(), self.single_process(4, report["run_samples"]))

    def test_what_develop_needs_of_the_lens_is_missed_before_anything_is_rendered(self):
        farm = ["latent-farm", "plan", SCENE, "--spp", 4, "--engine", "shell", "--out", self.folder / "night"]
        for options, column in (("--aperture 0.5", "lens"), ("--focus=3", "lens"), ("--shutter 0:0.5", "time")):
            for given in ([], ["--", "--aov", "albedo"]):
                self.fail_with(f"add, at the end of the line: -- --aov {column}", *farm, f"--develop={options}", *given, status=2)
        farm[2] = SOURCE / "scenes/bokeh.pbrt"
        self.succeed(*farm, "--develop=--aperture 0.5", "--", "--aov=albedo,lens", "--resolution", "32x32")

    def test_what_would_spoil_a_plan_is_refused_with_one_line(self):
        self.plan(spp=4)
        night = self.folder / "night"
        rubbish = self.folder / "rubbish"
        shutil.copytree(night, rubbish)
        (rubbish / "plan.json").write_text("rubbish")
        self.fail_with("plan.json: damaged, or made by another version of latent-farm: not JSON", "latent-farm", "status", rubbish)
        self.fail_with("plan.json: damaged, or made by another version of latent-farm: not JSON", "latent-farm", "resume", rubbish, "--engine", "shell")
        shutil.copy(SOURCE / "scenes/cornell.pbrt", self.folder / "other.pbrt")
        farm = ["latent-farm", "plan", "--engine", "shell", "--out", night]
        self.fail_with("holds a plan for", *farm, self.folder / "other.pbrt", "--spp", 4, status=2)
        self.fail_with("has --spp 4", *farm, SCENE, "--spp", 2, status=2)
        self.fail_with("other options", *farm, SCENE, "--spp", 4, "--", "--seed", 7, status=2)
        self.fail_with("--shard of latent-render: latent-farm gives every task its own", "latent-farm", "plan", SCENE, "--spp", 4, "--out", self.folder / "x", "--", "--shard", "0/2", status=2)
        self.fail_with("none.pbrt: cannot open: No such file", "latent-farm", "plan", self.folder / "none.pbrt", "--spp", 4, "--out", self.folder / "y")
        self.fail_with("holds no plan", "latent-farm", "resume", self.folder / "z")
        self.fail_with("holds no plan", "latent-farm", "status", self.folder / "z")
        self.fail_with("--out", "latent-farm", "plan", SCENE, "--spp", 4, status=2)
        for name in ("x", "y", "z"):
            self.assertFalse((self.folder / name).exists(), name)

    def test_files_that_render_options_name_are_found_from_any_folder(self):
        (self.folder / "lamp.pbrt").write_text('LightSource "point" "float scale" 9\n')
        jobs = []
        for options in ([], ["--add", "lamp.pbrt"], ["--add=lamp.pbrt"]):
            report = one_frame(json.loads(self.succeed("latent-farm", "plan", SCENE, "--spp", 4, "--out", "night", "--engine", "shell",
                                                       "--json", "--", "--resolution", "64x64", *options, cwd=self.folder).stdout))
            jobs.append(report["job"])
            for command in report["commands"]:
                self.succeed("/bin/sh", "-c", command, cwd="/")
            shutil.rmtree(self.folder / "night")
        self.assertEqual(jobs[1], jobs[2])
        self.assertNotEqual(jobs[0], jobs[1])

    def test_other_options_of_develop_make_the_picture_anew(self):
        self.plan("--tasks", 2, "--develop=--size 16", command="submit")
        first = (self.folder / "night/picture.exr").read_bytes()
        self.assertEqual(self.plan("--develop=--size 16", command="submit")["steps"], [])
        self.assertEqual(self.plan("--develop=--size 32", command="submit")["steps"], ["develop"])
        self.assertNotEqual((self.folder / "night/picture.exr").read_bytes(), first)

    def test_strips_make_the_pixels_of_a_picture_that_is_developed_as_a_whole(self):
        size = "--size 700x700 --layers variance"
        report = self.plan("--tasks", 1, "--strips", 3, "--develop", size, command="submit")
        self.assertEqual(report["steps"], ["render", "merge", "develop", "join"])
        joined = self.folder / "night/picture.exr"
        self.single_process(4, report["run_samples"], develop=size.split())
        for crop in ("0,0,700,700", "130,200,400,699"):
            printed = []
            for picture in (joined, self.folder / "single.exr"):
                printed.append(self.folder / f"print-{len(printed)}.tif")
                self.succeed("latent-convert", picture, "--crop", crop, "-o", printed[-1], "--force")
            self.assertEqual(printed[0].read_bytes(), printed[1].read_bytes())
        self.assertEqual(sorted(self.tiles(joined)), sorted(self.tiles(self.folder / "single.exr")))
        self.assertFalse((self.folder / "night/strips").exists())
        self.assertEqual(self.plan("--strips", 3)["steps"], [])
        self.assertEqual(self.plan("--strips", 2)["steps"], ["develop", "join"])
        self.assertEqual(self.plan("--strips", 1)["steps"], ["develop"])

    def tiles(self, picture):
        strip = Strip(picture)
        self.addCleanup(strip.file.close)
        return [strip.tile(index) for index in range(len(strip.offsets))]

    def test_with_compact_the_merged_file_has_one_run_however_often_it_is_extended(self):
        for spp in (4, 6):
            report = self.plan("--tasks", 3, "--compact", spp=spp)
            self.succeed("/bin/sh", "-c", report["commands"][0])
            merged = json.loads(self.succeed("latent-inspect", "info", "--json", self.folder / "night/samples.latent").stdout)
            self.assertEqual((merged["runs"], merged["samples"]), (1, [[0, report["samples"]]]))

    def test_only_strips_that_are_missing_are_developed_again(self):
        self.plan("--tasks", 1, "--strips", 3, "--develop=--size 700x700", "--until", "merge", command="submit")
        report = self.plan("--until", "develop")
        self.assertEqual(report["steps"], ["develop", "join"])
        for strip in (0, 2):
            self.succeed(self.folder / "night/develop", strip)
        self.fail_with("strips/strip-00001.exr: no such file", self.folder / "night/join")
        kept = (self.folder / "night/strips/strip-00000.exr").stat().st_ino
        line = self.plan("--until", "develop")["commands"][0]
        self.assertIn("seq 1 1", line)
        self.assertEqual((self.folder / "night/strips/strip-00000.exr").stat().st_ino, kept)
        self.fail_with("is a strip of another picture", "latent-farm", "join", *self.other_strips(), "-o", self.folder / "x.exr")
        self.assertFalse((self.folder / "x.exr").exists())
        self.succeed("/bin/sh", "-c", line)
        self.assertEqual(self.status()["steps_left"], [])

    def other_strips(self):
        other = self.folder / "other.exr"
        self.succeed("latent-develop", self.folder / "night/samples.latent", "--size", "700", "--crop", "0,256,700,512", "--filter", "box", "-o", other)
        return self.folder / "night/strips/strip-00000.exr", other

    def test_strips_need_the_size_of_the_picture(self):
        farm = ["latent-farm", "plan", SCENE, "--spp", 1, "--out", self.folder / "x", "--engine", "shell", "--strips", 4]
        self.fail_with('--develop="--size', *farm, status=2)
        self.fail_with("--mipmap", *farm, "--develop=--size 600x600 --mipmap", status=2)

    def test_a_sequence_of_sub_frames_is_refused_before_anything_is_rendered(self):
        self.fail_with("--until merge", "latent-farm", "plan", SCENE, "--spp", 1, "--out", self.folder / "x", "--engine", "shell",
                       "--develop=--frames 8", status=2)
        self.assertFalse((self.folder / "x").exists())

    def test_an_animation_has_a_chain_for_each_frame(self):
        for number in range(3):
            text = SCENE.read_text().replace("2856", str(2856 + number))
            (self.folder / f"frame.{number}.pbrt").write_text(text)
        film = self.folder / "film"
        arguments = ["--spp", 2, "--out", film, "--engine", "shell", "--machines", 6, "--", "--resolution", "64x64"]
        scenes = sorted(self.folder.glob("frame.*.pbrt"))
        frames = json.loads(self.succeed("latent-farm", "plan", "--json", *scenes, *arguments).stdout)["frames"]
        self.assertEqual([frame["tasks"] for frame in frames], [2, 2, 2])
        self.assertEqual(len({frame["job"] for frame in frames}), 3)
        again = json.loads(self.succeed("latent-farm", "plan", "--json", self.folder / "frame.*.pbrt", *arguments).stdout)["frames"]
        for what in ("folder", "job", "machines", "commands"):
            self.assertEqual([frame[what] for frame in again], [frame[what] for frame in frames])
        self.succeed("/bin/sh", "-c", frames[1]["commands"][0])
        self.assertIn("1 of 3 frames are done", self.succeed("latent-farm", "status", film).stdout)
        self.succeed("latent-farm", "resume", film, "--engine", "shell")
        pictures = {(film / f"frame.{number}/picture.exr").read_bytes() for number in range(3)}
        self.assertEqual(len(pictures), 3)
        status = json.loads(self.succeed("latent-farm", "status", film, "--json").stdout)
        self.assertEqual([frame["steps_left"] for frame in status["frames"]], [[], [], []])
        self.fail_with("frames of an animation", "latent-farm", "plan", scenes[0], *arguments, status=2)
        self.fail_with("same folder", "latent-farm", "plan", scenes[0], scenes[0], "--spp", 1, "--out", self.folder / "x", status=2)

    def test_frames_are_moments_of_an_animation(self):
        scene = self.folder / "door.gltf"
        scene.write_text(json.dumps(animated_triangle()))
        farm = ["latent-farm", "plan", "--json", scene, "--frames", "0:4", "--fps", 2, "--spp", 1, "--out", self.folder / "film",
                "--engine", "shell", "--", "--resolution", "16x16"]
        frames = json.loads(self.succeed(*farm).stdout)["frames"]
        self.assertEqual([pathlib.Path(frame["folder"]).name for frame in frames], [f"door.000{number}" for number in range(5)])
        # It moves for a second: two frames are at its end, or after it.
        jobs = [frame["job"] for frame in frames]
        self.assertEqual(len(set(jobs[:3])), 3)
        self.assertEqual(jobs[2:], [jobs[2]] * 3)
        single = json.loads(self.succeed("latent-render", scene, "--time", "0.5", "--spp", 1, "--resolution", "16x16", "--run-samples",
                                         frames[1]["run_samples"], "--dry-run", "--json", "-o", self.folder / "x.latent").stdout)
        self.assertEqual(jobs[1], single["job"])
        self.assertEqual(json.loads(self.succeed(*farm).stdout)["frames"][1]["job"], jobs[1])
        self.succeed("latent-farm", "resume", self.folder / "film", "--engine", "shell", "--until", "develop")
        pictures = [(self.folder / f"film/door.000{number}/picture.exr").read_bytes() for number in range(5)]
        self.assertNotEqual(pictures[0], pictures[1])
        self.assertEqual(pictures[3], pictures[4])
        self.fail_with("needs one scene", *farm[:4], scene, *farm[4:], status=2)
        for wrong in ("4:0", "1", "1:2:3", "a:b", "0:100000", "-1:2"):
            self.fail_with("is not a range", "latent-farm", "plan", scene, f"--frames={wrong}", "--spp", 1, "--out", self.folder / "x", status=2)

    def test_a_scene_that_has_changed_is_another_job(self):
        scene = self.folder / "scene.pbrt"
        shutil.copy(SCENE, scene)
        self.plan(spp=2, scene=scene)
        scene.write_text(scene.read_text().replace("2856", "2857"))
        self.fail_with("has changed", "latent-farm", "plan", scene, "--spp", 3, "--out", self.folder / "night", "--engine", "shell")

    def test_no_task_renders_a_scene_that_has_changed_since_it_was_planned(self):
        scene, planned = self.folder / "scene.pbrt", SCENE.read_text()
        scene.write_text(planned)
        self.plan("--tasks", 2, scene=scene)
        scene.write_text(planned.replace("2856", "2857"))
        night = self.folder / "night"
        for command in (["resume", night], ["submit", "--out", night], ["submit", scene, "--spp", 4, "--out", night], ["plan", scene, "--out", night]):
            self.fail_with("scene.pbrt: has changed", "latent-farm", *command, "--engine", "shell")
        self.assertEqual(os.listdir(night / "parts"), [])
        scene.unlink()
        self.fail_with("scene.pbrt: ", "latent-farm", "resume", night, "--engine", "shell")
        (self.folder / "moved.pbrt").write_text(planned)
        moved = {**os.environ, "LATENT_SCENE": str(self.folder / "moved.pbrt")}
        self.succeed("latent-farm", "resume", night, "--engine", "shell", "--until", "merge", env=moved)
        self.succeed("latent-farm", "resume", night, "--engine", "shell", "--until", "develop")  # without the scene

    def test_what_until_leaves_out_is_named_when_nothing_else_is_left(self):
        self.plan("--tasks", 1, "--until", "render", spp=1, command="submit")
        said = "except what --until render leaves out: merge, develop\n"
        self.assertTrue(self.succeed("latent-farm", "resume", self.folder / "night", "--engine", "shell").stdout.endswith("nothing is left to do, " + said))
        text = self.succeed("latent-farm", "status", self.folder / "night").stdout
        self.assertIn("all done, " + said, text)
        self.assertIn(", 1 sample per pixel, ", text)
        self.assertEqual(self.plan("--until", "develop", spp=1)["steps"], ["merge", "develop"])

    def test_the_tasks_that_cannot_be_made_are_explained_and_the_same_command_runs_again(self):
        for _ in range(2):
            done = self.succeed("latent-farm", "plan", SCENE, "--spp", 1, "--out", self.folder / "night", "--engine", "shell", "--tasks", 1000,
                                "--", "--resolution", "64x64")
            self.assertRegex(done.stdout, r"4096 samples in 4 tasks of up to 1024 .*\nmissing: 4096 samples of tasks 0-3;")
        self.assertEqual(done.stderr, "")
        done = self.succeed("latent-farm", "plan", SCENE, "--spp", 1, "--out", self.folder / "x", "--engine", "shell", "--tasks", 1000,
                            "--", "--resolution", "64x64")
        self.assertEqual(done.stderr, "latent-farm: --tasks 1000: there are 4 tasks, since tasks consist of whole runs, here of 1024 samples\n")

    def test_wrong_arguments_are_explained_before_there_is_a_plan(self):
        farm = ["latent-farm", "plan", SCENE, "--spp", 1, "--out", self.folder / "x"]
        self.fail_with("none: no such file", *farm, "--engine", "parallel", "--hosts", self.folder / "none")
        (self.folder / "hosts").write_text("# node1\n\n")
        self.fail_with("hosts: lists no machine", *farm, "--engine", "parallel", "--hosts", self.folder / "hosts")
        self.fail_with("at least 1, or auto", *farm, "--engine", "shell", "--tasks", "foo", status=2)
        self.fail_with("--bogus", *farm, "--engine", "shell", "--", "--bogus", status=2)
        self.fail_with("did you mean --sensitivity?", *farm, "--print=--sensitivty 2", status=2)
        self.fail_with("--develop: latent-develop: unknown argument --bogus", *farm, "--develop=--bogus", status=2)
        self.fail_with('as in --print="--option value"', *farm, "--print", "--auto", status=2)
        self.assertFalse((self.folder / "x").exists())

    def test_how_steps_are_run_is_remembered_until_it_is_changed(self):
        (self.folder / "hosts").write_text("node1\n")
        self.plan("--tasks", 2, "--hosts", self.folder / "hosts", "--develop=--size 16", "--checkpoint", "2m", engine="parallel")
        def planned(*more):
            return json.loads(self.succeed("latent-farm", "plan", SCENE, "--out", self.folder / "night", "--json", *more).stdout)
        self.assertIn(f"--sshloginfile {self.folder / 'hosts'} ", planned()["commands"][0])
        self.assertNotIn("--sshloginfile", planned("--hosts", "")["commands"][0])
        self.assertEqual(planned("--engine", "shell")["engine"], "shell")
        self.assertEqual(planned("--develop=")["engine"], "shell")
        plan = json.loads((self.folder / "night/plan.json").read_text())
        self.assertEqual((plan["checkpoint"], plan["develop"], plan["hosts"]), (120, [], ""))

    def test_what_the_farm_decides_is_named_with_the_option_that_decides_it(self):
        for option, advice in (("--spp=3", "write it before the --"), ("--threads", "use --cpus, before the --"), ("-o", "the folder that --out names")):
            self.fail_with(advice, "latent-farm", "plan", SCENE, "--out", self.folder / "x", "--", option, status=2)

    def test_one_task_has_no_more_samples_than_there_are(self):
        done = self.succeed("latent-farm", "plan", SCENE, "--spp", 1, "--out", self.folder / "x", "--engine", "shell", "--", "--resolution", "64x64")
        self.assertRegex(done.stdout, r"^4096 samples in 1 task \(\d+s\), runs of 4096\n")

    def test_the_machines_are_those_of_a_file_wherever_the_commands_are_run(self):
        (self.folder / "hosts").write_text("node1\n")
        report = self.succeed("latent-farm", "plan", SCENE, "--spp", 1, "--out", "night", "--engine", "parallel", "--hosts", "hosts", "--json",
                              "--", "--resolution", "16x16", cwd=self.folder)
        self.assertIn(f"--sshloginfile {os.path.realpath(self.folder / 'hosts')} ", json.loads(report.stdout)["commands"][0])

    def test_urls_are_refused_and_shown_without_what_is_secret(self):
        for given, shown in (("https://me:word@host/a.pbrt?tok=SECRET", "a scene is a file, not a URL: https://host/a.pbrt?...\n"),
                             ("HTTP://host/a.pbrt?tok=SECRET", "a scene is a file, not a URL: HTTP://host/a.pbrt?...\n"),
                             ("https:/me:wo@word@host/a?SECRET#b", "a scene is a file, not a URL: https:/host/a?...\n"),
                             ("http://host/a.pbrt#b", "a scene is a file, not a URL: http://host/a.pbrt\n")):
            done = self.fail_with(shown, "latent-farm", "plan", given, "--spp", 4, "--out", self.folder / "x", status=2)
            self.assertNotRegex(done.stderr, "SECRET|word")
        url = "https://me:word@host/night?tok=SECRET"
        for command in (["status", url], ["resume", url], ["plan", SCENE, "--spp", 4, "--out", url], ["status", "night", url],
                        ["join", url, "-o", self.folder / "x.exr"], ["plan", SCENE, "--out", "x", "--spp", url]):
            done = run("latent-farm", *command, cwd=self.folder)
            self.assertNotRegex(done.stderr, "SECRET|word")
            self.assertRegex(done.stderr, r"https?:/+host/night\?\.\.\.")
        self.assertEqual(os.listdir(self.folder), [])

    def test_numbers_are_written_as_for_every_tool(self):
        plan = ["latent-farm", "plan", SCENE, "--engine", "shell", "--out"]
        size = ["--json", "--", "--resolution", "16x16", "--run-samples", 1024]
        written = one_frame(json.loads(self.succeed(*plan, self.folder / "a", "--spp", "0.25Ki", "--tasks", "0.03K", *size).stdout))
        plain = one_frame(json.loads(self.succeed(*plan, self.folder / "b", "--spp", 256, "--tasks", 30, *size).stdout))
        self.assertEqual(written["samples"], plain["samples"])
        self.assertEqual(written["tasks"], plain["tasks"])
        for option, text in (("--spp", "1Q"), ("--spp", "K"), ("--spp", "nan"), ("--tasks", "1.5"), ("--tasks", "-1"), ("--tasks", "1KiB")):
            self.fail_with(f"'{text}' is not a", *plan, self.folder / "c", "--spp", 4, f"{option}={text}", status=2)

    def test_with_too_little_memory_there_is_one_line(self):
        said = set()
        for mebibytes in range(8, 32):
            limit = mebibytes << 20
            done = run(sys.executable, TOOLS / "latent-farm", "status", self.folder,
                       preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)))
            self.assertNotIn(f'File "{TOOLS}/latent-farm"', done.stderr)  # a traceback; below some limit Python itself does not start
            if done.stderr.startswith("latent-farm: "):
                self.assertEqual((done.returncode, done.stderr.count("\n")), (1, 1), done.stderr)
                said.add(done.stderr)
        self.assertGreater(len(said), 1)  # not only that the folder holds no plan

    def test_help_fits_80_columns_and_is_found_for_every_command(self):
        for command in ([], ["plan"], ["submit"], ["resume"], ["status"], ["join"], ["film"]):
            text = self.succeed("latent-farm", *command, "--help").stdout
            self.assertLessEqual(max(map(len, text.splitlines())), 80)
            self.assertIn("Usage: latent-farm", text)
        self.assertRegex(self.succeed("latent-farm", "--version").stdout, r"^latent-farm \d+\.\d+\.\d+\n$")


@unittest.skipUnless(shutil.which("parallel"), "GNU parallel is not installed")
class Parallel(FarmTest):
    def test_parallel_runs_the_same_tasks(self):
        report = self.plan("--tasks", 3, engine="parallel", command="submit")
        self.assertEqual((self.folder / "night/picture.exr").read_bytes(), self.single_process(4, report["run_samples"]))
        self.assertIn("task 2", (self.folder / "night/logs/parallel.log").read_text())

    @unittest.skipUnless(os.path.exists("/usr/sbin/sshd") and os.geteuid() == 0, "no ssh server can be started here (root, openssh-server)")
    def test_parallel_reaches_machines_over_ssh_and_tries_a_task_again_on_another(self):
        os.makedirs("/run/sshd", exist_ok=True)  # where the server has no privileges; systemd would make it
        for key in ("host", "user"):
            self.succeed("ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", self.folder / key)
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            port = probe.getsockname()[1]
        server = subprocess.Popen(["/usr/sbin/sshd", "-D", "-e", "-f", "/dev/null", "-h", self.folder / "host", "-p", str(port),
                                   "-o", "ListenAddress=127.0.0.1", "-o", "StrictModes=no", "-o", "PidFile=none",
                                   "-o", f"AuthorizedKeysFile={self.folder / 'user.pub'}"], stderr=subprocess.DEVNULL)
        self.addCleanup(server.wait)
        self.addCleanup(server.terminate)
        ssh = f"ssh -p {port} -i {self.folder / 'user'} -o StrictHostKeyChecking=no -o UserKnownHostsFile=/dev/null -o LogLevel=ERROR"
        for _ in range(100):
            if run(*ssh.split(), "root@127.0.0.1", "true").returncode == 0:
                break
            time.sleep(0.1)
        hosts = self.folder / "hosts"
        hosts.write_text(f"# two machines that are one\n{ssh} root@127.0.0.1\n{ssh} root@localhost\n")
        report = self.plan("--tasks", 5, "--hosts", hosts, engine="parallel")
        self.assertEqual(report["machines"], 2)
        task = self.folder / "night/task"
        once = self.folder / "once"
        task.write_text(task.read_text().replace("#!/bin/sh\n", f"#!/bin/sh\n[ $1 != 2 ] || ! mkdir {once} 2>/dev/null || exit 1\n"))
        self.succeed("/bin/bash", "-c", report["commands"][0])
        self.assertTrue(once.is_dir())
        self.assertEqual((self.folder / "night/picture.exr").read_bytes(), self.single_process(4, report["run_samples"]))
        log = (self.folder / "night/logs/parallel.log").read_text()
        self.assertTrue("127.0.0.1" in log and "localhost" in log, log)


if __name__ == "__main__":
    unittest.main()
