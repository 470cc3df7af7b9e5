"""One scene, or the frames of an animation: which folders a command is about."""
import argparse
import glob
import os
import pathlib
import re

from latent_farm.errors import Failure, Misuse
from latent_farm.folder import Folder
from latent_farm.names import check_is_no_url, check_name


def planned(out):
    """The folder itself, if it holds a plan, or those of the frames in it."""
    check_is_no_url(out, "a plan is a folder")
    if not out:
        raise Misuse("the name of the folder is empty")
    if Folder(out).has_plan():
        return [Folder(out)]
    return sorted((Folder(path.parent) for path in pathlib.Path(out).glob("*/plan.json")), key=lambda folder: in_order(folder.path.name))


def in_order(name):
    """A key that puts shot.9 before shot.10."""
    return [(int(word), "") if word.isdecimal() else (-1, word) for word in re.split(r"(\d+)", name)]


def existing(out):
    """The same, where there must be something."""
    folders = planned(out)
    if not folders:
        raise Failure(f"{out}: holds no plan; make one with latent-farm plan")
    return folders


def scenes_of(names):
    """Scene files; a pattern that the shell has left alone stands for those that match it."""
    for name in names:
        check_is_no_url(name, "a scene is a file")
    scenes = [scene for name in names for scene in (not os.path.exists(name) and sorted(glob.glob(name)) or [name])]
    for scene in scenes:
        check_name(os.path.abspath(scene))
    return scenes


def name_of(scene):
    """frame.0001 for frame.0001.pbrt and frame.0001.pbrt.gz."""
    name = pathlib.Path(scene).name
    stem = pathlib.Path(name.removesuffix(".gz")).stem
    return name if stem in ("", ".", "..") else stem  # ...pbrt


def moments(args, scenes):
    """(name, scene, options) of each frame of --frames: the moments of one animated scene."""
    if len(scenes) != 1:
        raise Misuse("--frames: needs one scene, whose animation it divides")
    if Folder(args.out).has_plan():
        raise Misuse(f"{args.out}: holds the plan of a single scene; choose another --out")
    first, last = args.frames
    digits = max(4, len(str(last)))
    for number in range(first, last + 1):
        yield f"{name_of(scenes[0])}.{number:0{digits}}", scenes[0], ["--time", f"{number / (args.fps or 24):.9g}"]


def frames_of(args):
    """[(folder, arguments)]: one for each scene, with a folder of its own in --out if there are several; without scenes, what is
    planned already."""
    def frame(folder, scene, options=()):
        return folder, argparse.Namespace(**{**vars(args), "scene": scene, "options": [*args.options, *options]})

    scenes = scenes_of(args.scene or [])
    folders = planned(args.out)
    if getattr(args, "frames", None):
        return [frame(Folder(pathlib.Path(args.out) / name), scene, options) for name, scene, options in moments(args, scenes)]
    if not scenes:
        if not folders:
            raise Misuse(f"{args.out}: holds no plan yet; name a scene and --spp")
        return [frame(folder, None) for folder in folders]
    if len(scenes) == 1:
        if folders and not Folder(args.out).has_plan():
            raise Misuse(f"{args.out}: holds the frames of an animation; choose another --out, or name all its scenes")
        return [frame(Folder(args.out), scenes[0])]
    if Folder(args.out).has_plan():
        raise Misuse(f"{args.out}: holds the plan of a single scene; choose another --out")
    names = [name_of(scene) for scene in scenes]
    for name in names:
        if names.count(name) > 1:
            raise Misuse(f"{name}: several scenes have this name, and their frames would have the same folder")
    return [frame(Folder(pathlib.Path(args.out) / name), scene) for name, scene in zip(names, scenes)]
