"""Jobs on the disk: which file of samples belongs to a scene, and why there is a new one. Needs no Blender.

FOLDER/meshes, FOLDER/pictures   shared by all frames
FOLDER/scene.pbrt                the scene that was exported last
FOLDER/NAME-KEY.latent           samples; KEY is a digest of the scene and of the options that make another job
FOLDER/NAME.json                 the last job of this frame: its key, a digest of each of its parts, and how its pictures were developed
"""
import glob
import json
import os
import re

from . import develop, tools


def options(settings, aperture, moves):
    """Arguments of latent-render that make another job if they change, by their names in the panels."""
    aovs = [name.lower() for name in ("ALBEDO", "NORMAL", "DEPTH", "POSITION") if name in settings.layers]
    aovs += (["lens"] if aperture else []) + (["time"] if settings.keep_time and moves else [])
    return {"records": ["--record", settings.record.lower()], "seed": ["--seed", str(settings.seed)], "further options": settings.render_options.split(),
            "light groups": ["--light-groups"] if settings.light_groups != "NONE" else [], "passes": ["--aov", ",".join(aovs)] if aovs else []}


class Job:
    """The last job of a frame, as its note tells it."""

    def __init__(self, folder, name):
        self.name, self.picture, self.path = name, os.path.join(folder, f"{name}.exr"), os.path.join(folder, f"{name}.json")
        self.note = read(self.path)
        self.samples = os.path.join(folder, f"{name}-{self.note['key']}.latent") if self.note else ""

    def begin(self, digest, options, parts, aperture, wanted):
        """Takes the place of the last job. `wanted`: samples per pixel. Returns what will happen: a line for the user."""
        digest, parts = digest.copy(), {**parts, **{name: " ".join(words) for name, words in options.items()}}
        digest.update("\0".join(parts[name] for name in options).encode())
        last, key = self.note, digest.hexdigest()[:12]
        self.samples = os.path.join(os.path.dirname(self.path), f"{self.name}-{key}.latent")
        there = os.path.exists(self.samples)
        done = (last or {}).get("done", {})  # samples per pixel, by key
        self.keep(key=key, parts=parts, aperture=aperture, done=done)
        if not last or last["key"] == key:
            if there and done.get(key, 0) >= wanted:
                return "same job: all of its samples are there"
            return "same job: missing samples are added" if there else "same job: it resumes" if last else "new job"
        changed = [name for name in {**last["parts"], **parts} if last["parts"].get(name) != parts.get(name)]
        reason = ", ".join(changed[:4]) + (f" and {len(changed) - 4} more" if len(changed) > 4 else "") or "what the scene consists of"
        return f"back to an earlier job: {reason} changed" if there else f"new job: {reason} changed; the samples of the last one are kept"

    def finish(self, samples):
        done = self.note["done"]
        self.keep(done={**done, self.note["key"]: max(samples, done.get(self.note["key"], 0))})

    def keep(self, **facts):
        self.note = {**(read(self.path) or {}), **facts}  # F12 may have changed it while the darkroom developed
        with open(self.path + ".unfinished", "w") as file:
            json.dump(self.note, file, indent=1)
        os.replace(self.path + ".unfinished", self.path)

    @property
    def files(self):
        """Its samples, whole or interrupted."""
        return sorted(glob.glob(glob.escape(self.samples) + "*")) if self.samples else []

    def develop(self, program, picture, words, layers=(), stop=lambda: False):
        """A picture by these options: its channels, and where it is. It is developed into `picture` unless F12 or the darkroom has done so."""
        key, known = [*words, *(f"{path} {os.stat(path).st_mtime_ns}" for path in self.files)], self.note.get("developed", {})
        for path, (of, has) in known.items():
            if of == key and set(layers) <= set(has) and os.path.exists(path):
                return develop.read(path), path
        if program is None:
            raise tools.Failure("this picture is not there yet")
        channels = develop.develop(program, self.samples, picture, [*words, *(["--layers", ",".join(layers)] if layers else [])], stop)
        self.keep(developed={**known, picture: (key, list(layers))})
        return channels, picture


def old(folder):
    """Samples that are no longer those of their frame."""
    found = [(path, re.match(r"(.+)-([0-9a-f]{12})\.latent", os.path.basename(path))) for path in sorted(glob.glob(os.path.join(glob.escape(folder), "*.latent*")))]
    notes = {name: read(os.path.join(folder, f"{name}.json")) for name in {match[1] for _, match in found if match}}
    return [path for path, match in found if match and notes[match[1]] and notes[match[1]]["key"] != match[2]]


def read(path):
    try:
        with open(path) as file:
            last = json.load(file)
        return last if {"key", "parts", "aperture"} <= set(last) else None
    except (OSError, ValueError, TypeError):
        return None
