"""Jobs on the disk: which file of samples belongs to a scene, and why there is a new one. Needs no Blender.

FOLDER/meshes, FOLDER/pictures   shared by all frames
FOLDER/scene.pbrt                the scene that was exported last
FOLDER/NAME-KEY.latent           samples; KEY is a digest of the scene and of the options that make another job
FOLDER/NAME.json                 the last job of this frame: its key, and a digest of each of its parts
"""
import glob
import json
import os


def options(settings, aperture, moves):
    """Arguments of latent-render that make another job if they change."""
    words = ["--record", settings.record.lower(), "--seed", str(settings.seed)]
    if settings.light_groups != "NONE":
        words.append("--light-groups")
    aovs = [name.lower() for name in ("ALBEDO", "NORMAL", "DEPTH", "POSITION") if name in settings.layers]
    aovs += ["lens"] if aperture else []
    if settings.keep_time and moves:
        aovs.append("time")
    if aovs:
        words += ["--aov", ",".join(aovs)]
    return words + settings.render_options.split()


class Job:
    def __init__(self, folder, name, digest, words, parts):
        digest = digest.copy()
        digest.update("\0".join(words).encode())
        self.folder, self.name, self.key = folder, name, digest.hexdigest()[:12]
        self.parts = {**parts, "options": " ".join(words)}
        self.samples = os.path.join(folder, f"{name}-{self.key}.latent")
        self.picture = os.path.join(folder, f"{name}.exr")
        self.note = os.path.join(folder, f"{name}.json")

    def others(self):
        """Samples of earlier jobs of this frame."""
        return [path for path in sorted(glob.glob(os.path.join(glob.escape(self.folder), f"{glob.escape(self.name)}-????????????.latent"))) if path != self.samples]

    def word(self):
        """What will happen: a line for the user. Call it before the render."""
        last = read(self.note)
        if last and last["key"] != self.key:
            changed = [name for name in {**last["parts"], **self.parts} if last["parts"].get(name) != self.parts.get(name)]
            reason = ", ".join(changed[:4]) + (f" and {len(changed) - 4} more" if len(changed) > 4 else "") or "what the scene consists of"
            if os.path.exists(self.samples):
                return f"back to an earlier job, which continues ({reason} changed)"
            return f"new job: {reason} changed; the samples of the last one are kept"
        if os.path.exists(self.samples):
            return "same job: missing samples are added"
        return "same job: it resumes" if last else "new job"

    def remember(self):
        with open(self.note + ".unfinished", "w") as file:
            json.dump({"key": self.key, "parts": self.parts}, file, indent=1)
        os.replace(self.note + ".unfinished", self.note)


def read(path):
    try:
        with open(path) as file:
            last = json.load(file)
        return last if {"key", "parts"} <= set(last) else None
    except (OSError, ValueError, TypeError):
        return None
