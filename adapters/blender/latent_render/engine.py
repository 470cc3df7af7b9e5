"""The render engine: F12 exports, renders, develops and shows."""
import os
import traceback

import bpy
import numpy as np

from . import baking, develop, job, tools
from .export import camera
from .export.scene import Exporter

last = {"word": "", "lost": [], "samples": "", "wanted": []}  # of the last render, for the panels
planned = None  # a list while a farm is planned: the scene of each frame, and its options


def program(name):
    addon = bpy.context.preferences.addons.get(__package__)
    return tools.find(name, addon.preferences.tools if addon else "")


def folder_of(scene):
    """Each .blend file has a folder of its own in that of the panel: others may have scenes of the same names."""
    file = os.path.splitext(os.path.basename(bpy.data.filepath))[0]
    folder = os.path.realpath(bpy.path.abspath(scene.latent.folder))
    return os.path.join(folder, file) if file else folder


def name_of(scene, layer):
    """Of the files of a frame."""
    parts = [scene.name, *([layer] if len(scene.original.view_layers) > 1 else []), f"{scene.frame_current:04d}"]
    return "-".join("".join(c if c.isalnum() or c in "._ " else "_" for c in part) for part in parts)


def develop_words(settings, aperture):
    """Arguments of latent-develop for a picture as the camera sees it. `aperture`: that of its blades, or None."""
    return settings.develop_options.split() + (["--aperture", aperture] if aperture else [])


class LatentEngine(bpy.types.RenderEngine):
    bl_idname = "LATENT"
    bl_label = "Latent"
    bl_use_preview = False
    bl_use_eevee_viewport = True
    bl_use_shading_nodes_custom = False
    bl_use_exclude_layers = True
    lost, wanted = {}, {}  # of the view layers that it has rendered

    def update_render_passes(self, scene=None, renderlayer=None):
        self.register_pass(scene, renderlayer, "Combined", 4, "RGBA", "COLOR")
        for layer in scene.latent.layers:
            name, channels, kind, _ = develop.PASSES[layer]
            self.register_pass(scene, renderlayer, name, len(channels), channels, kind)

    def render(self, depsgraph):
        try:
            self.render_all(depsgraph)
        except Exception as failure:  # whatever it is, Blender must say it, and not show an empty picture alone
            if isinstance(failure, OSError):
                failure = f"{failure.filename or folder_of(depsgraph.scene_eval)}: {failure.strerror}; the panel Job says where files go"
            elif not isinstance(failure, (tools.Failure, ValueError)):
                traceback.print_exc()
            self.fill(depsgraph.scene_eval, depsgraph.view_layer_eval.name, {})  # Blender expects a result
            self.report({"ERROR"}, f"Latent: {failure}")
            self.error_set(f"Latent: {failure}")

    def render_all(self, depsgraph):
        scene, layer = depsgraph.scene_eval, depsgraph.view_layer_eval.name
        settings, folder = scene.latent, folder_of(scene)
        samples = depsgraph.view_layer_eval.samples or settings.samples
        render = program("latent-render")
        self.say("exporting")
        name = "scene" if planned is None else f"frame-{scene.frame_current:04d}"
        exported = Exporter(depsgraph, folder, settings, lambda world: baking.world(world, folder)).export(name, self.frame_set)
        options = job.options(settings, exported.aperture, exported.moves)
        words = sum(options.values(), [])
        exported.digest.update(tools.said(render, "--version").encode())  # another renderer may make other samples
        if planned is not None:
            planned.append((exported.path, words))
            return self.fill(scene, layer, {})
        mine = job.Job(folder, name_of(scene, layer))
        word = mine.begin(exported.digest, options, exported.parts, exported.aperture, samples)
        self.lost, self.wanted = {**self.lost, **dict.fromkeys(exported.lost)}, {**self.wanted, **dict.fromkeys(exported.wanted)}
        last.update(word=word, lost=list(self.lost), samples=mine.samples, wanted=list(self.wanted))
        print("\n".join([f"Latent: {word}", *(f"Latent: not exported: {line}" for line in exported.lost)]))
        if exported.lost:
            self.report({"WARNING"}, f"Latent: {len(exported.lost)} things were not exported as they are; the panel lists them")
        self.say(word)
        command = [render, exported.path, "-o", mine.samples, "--spp", samples, "--checkpoint", "5s", "--json", *words]
        report, warnings = tools.run(command, lambda share: self.progress(share, word), self.stopped)
        print("\n".join(warnings))
        if report is not None:
            mine.finish(samples)
        self.say("developing")
        try:
            self.show(scene, layer, mine)
        except tools.Failure:
            if report is not None:
                raise
            self.fill(scene, layer, {})  # interrupted before anything was committed
        self.say(f"done; {word}" if report is not None else "interrupted; F12 resumes")

    def stopped(self):
        return self.test_break()

    def say(self, text):
        self.update_stats("", f"Latent: {text}")

    def progress(self, share, word):
        self.update_progress(share)
        self.say(f"{100 * share:.0f} %; {word}")

    def show(self, scene, layer, mine):
        """Develops what there is, and fills the passes."""
        settings = scene.latent
        names = [name for name in develop.PASSES if name in settings.layers]
        layers = [name.lower() for name in names] + (["lights"] if settings.light_groups != "NONE" else [])
        channels, _ = mine.develop(program("latent-develop"), mine.picture, develop_words(settings, mine.note["aperture"]), layers)
        if "Z" in channels:
            channels["Z"] = channels["Z"] * camera.depth_per_distance(scene)
        passes = {"Combined": with_alpha(develop.rgb(channels)), **{develop.PASSES[name][0]: develop.of_pass(channels, develop.PASSES[name][3]) for name in names}}
        for light in develop.lights(channels):
            self.add_pass(f"Light {light}", 3, "RGB", layer=layer)
            passes[f"Light {light}"] = develop.rgb(channels, f"light.{light}.")
        self.fill(scene, layer, passes)

    def fill(self, scene, layer, passes):
        render, (width, height) = scene.render, camera.size(scene)
        result = self.begin_result(0, 0, width, height, layer=layer)  # no larger than the region that Blender wants
        is_region = (result.resolution_x, result.resolution_y) != (width, height)
        left, low = (int(render.border_min_x * width), int(render.border_min_y * height)) if is_region else (0, 0)
        for target in result.layers[0].passes:  # of each view
            if target.name in passes:
                shown = np.ascontiguousarray(passes[target.name][::-1][low : low + result.resolution_y, left : left + result.resolution_x], np.float32)
                try:
                    target.rect.foreach_set(shown.ravel())
                except TypeError:  # Blender 3.4 counts pixels
                    target.rect.foreach_set(shown.reshape(-1, shown.shape[2]))
        self.end_result(result)


def with_alpha(picture):
    return np.concatenate([picture, np.ones((*picture.shape[:2], 1), np.float32)], -1)
