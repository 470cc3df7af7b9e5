"""The render engine: F12 exports, renders, develops and shows."""
import os
import time
import traceback

import bpy
import numpy as np

from . import baking, develop, job, tools
from .export import camera
from .export.scene import Exporter

last = {"word": "", "lost": [], "samples": "", "picture": "", "aperture": None, "wanted": [], "seconds": {}}  # of the last render, for the panels
planned = None  # a list while a farm is planned: the scene of each frame, and its options


def preference(context=None):
    addon = (context or bpy.context).preferences.addons.get(__package__)
    return addon.preferences.tools if addon else ""


def program(name):
    return tools.find(name, preference())


def folder_of(scene):
    return os.path.realpath(bpy.path.abspath(scene.latent.folder))


def name_of(scene, layer):
    """Of the files of a frame."""
    parts = [scene.name, *([layer] if len(scene.original.view_layers) > 1 else []), f"{scene.frame_current:04d}"]
    return "-".join("".join(c if c.isalnum() or c in "._ " else "_" for c in part) for part in parts)


class LatentEngine(bpy.types.RenderEngine):
    bl_idname = "LATENT"
    bl_label = "Latent"
    bl_use_preview = False
    bl_use_eevee_viewport = True
    bl_use_shading_nodes_custom = False
    bl_use_exclude_layers = True

    def update_render_passes(self, scene=None, renderlayer=None):
        self.register_pass(scene, renderlayer, "Combined", 4, "RGBA", "COLOR")
        for layer in scene.latent.layers:
            name, channels, kind, _ = develop.PASSES[layer]
            self.register_pass(scene, renderlayer, name, len(channels), channels, kind)

    def render(self, depsgraph):
        try:
            self.render_all(depsgraph)
        except Exception as failure:  # whatever it is, Blender must say it, and not show an empty picture alone
            if not isinstance(failure, (tools.Failure, ValueError, OSError)):
                traceback.print_exc()
            self.fill(depsgraph.scene_eval, depsgraph.view_layer_eval.name, {})  # Blender expects a result
            self.report({"ERROR"}, f"Latent: {failure}")
            self.error_set(f"Latent: {failure}")

    def render_all(self, depsgraph):
        scene, layer = depsgraph.scene_eval, depsgraph.view_layer_eval.name
        settings, folder = scene.latent, folder_of(scene)
        render = program("latent-render")
        begin = time.monotonic()
        self.say("exporting")
        name = "scene" if planned is None else f"frame-{scene.frame_current:04d}"
        exported = Exporter(depsgraph, folder, settings, lambda world: baking.world(world, folder)).export(name, self.frame_set)
        words = job.options(settings, exported.aperture, exported.moves)
        exported.digest.update(tools.version(render).encode())  # another renderer may make other samples
        if planned is not None:
            planned.append((exported.path, words))
            return self.fill(scene, layer, {})
        mine = job.Job(folder, name_of(scene, layer), exported.digest, words, exported.parts)
        word = mine.word()
        mine.remember()
        last.update(word=word, lost=exported.lost, samples=mine.samples, picture=mine.picture, aperture=exported.aperture, wanted=exported.wanted,
                    seconds={"export": time.monotonic() - begin})
        print(f"Latent: {word}")
        for line in exported.lost:
            print(f"Latent: not exported: {line}")
        if exported.lost:
            self.report({"WARNING"}, f"Latent: {len(exported.lost)} things were not exported as they are; the panel lists them")
        self.say(word)
        begin = time.monotonic()
        command = [render, exported.path, "-o", mine.samples, "--spp", settings.samples, "--checkpoint", "5s", "--json", *words]
        report, warnings = tools.run(command, lambda share: self.progress(share, word), self.stopped)
        print("\n".join(warnings))
        last["seconds"]["render"] = time.monotonic() - begin
        begin = time.monotonic()
        self.say("developing")
        try:
            self.show(scene, layer, mine, exported.aperture)
        except tools.Failure:
            if report is not None:
                raise
            self.fill(scene, layer, {})  # interrupted before anything was committed
        last["seconds"]["develop"] = time.monotonic() - begin
        self.say(f"done; {word}" if report is not None else "interrupted; F12 resumes")

    def stopped(self):
        """Whether the user pressed Esc."""
        return self.test_break()

    def say(self, text):
        self.update_stats("", f"Latent: {text}")

    def progress(self, share, word):
        self.update_progress(share)
        self.say(f"{100 * share:.0f} %; {word}")

    def show(self, scene, layer, mine, aperture):
        """Develops what there is, and fills the passes."""
        settings, developer = scene.latent, program("latent-develop")
        words = settings.develop_options.split() + (["--aperture", aperture] if aperture else [])
        passes = {}
        groups = develop.groups_of(program("latent-inspect"), mine.samples) if settings.light_groups != "NONE" else []
        for group in groups:
            alone = develop.develop(developer, mine.samples, mine.picture, [*words, *develop.without(groups, group)])
            self.add_pass(f"Light {group}", 3, "RGB", layer=layer)
            passes[f"Light {group}"] = develop.rgb(alone)
        layers = [name for name in develop.PASSES if name in settings.layers]
        channels = develop.develop(developer, mine.samples, mine.picture, [*words, *(["--layers", ",".join(layers).lower()] if layers else [])])
        passes["Combined"] = with_alpha(develop.rgb(channels))
        for name in layers:
            passes[develop.PASSES[name][0]] = develop.of_pass(channels, develop.PASSES[name][3])
        self.fill(scene, layer, passes)

    def fill(self, scene, layer, passes):
        width, height = camera.size(scene)
        left, low, right, high = 0, 0, width, height
        # Without a crop, Blender 3.4 wants the region alone, later versions the whole picture.
        if scene.render.use_border and (scene.render.use_crop_to_border or bpy.app.version < (4, 0, 0)):
            border = scene.render
            left, right = int(border.border_min_x * width), int(border.border_max_x * width)
            low, high = int(border.border_min_y * height), int(border.border_max_y * height)
        result = self.begin_result(0, 0, right - left, high - low, layer=layer)
        there = result.layers[0].passes
        for name, values in passes.items():
            target = there.get(name) if hasattr(there, "get") else next((p for p in there if p.name == name), None)
            if target is not None:
                shown = np.ascontiguousarray(values[::-1][low:high, left:right], np.float32)
                try:
                    target.rect.foreach_set(shown.ravel())
                except TypeError:  # Blender 3.4 counts pixels
                    target.rect.foreach_set(shown.reshape(-1, shown.shape[2]))
        self.end_result(result)


def with_alpha(picture):
    return np.concatenate([picture, np.ones((*picture.shape[:2], 1), np.float32)], -1)
