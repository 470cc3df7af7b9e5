"""After the render: develops the samples again, as the panel says, into an image of Blender; and plans renders on many machines."""
import atexit
import os
import subprocess
import webbrowser

import bpy
import numpy as np
from bpy.props import CollectionProperty, EnumProperty, FloatProperty, StringProperty

from . import develop, engine, tools

IMAGE = "Latent Darkroom"


class LightMix(bpy.types.PropertyGroup):
    factor: FloatProperty(name="Factor", default=1, min=0, soft_max=10)
    change: StringProperty(name="Spectrum", description="A filter or another spectrum of the same luminance, such as 6500K, D65, F11 or wratten-80a")


class DarkroomSettings(bpy.types.PropertyGroup):
    observer: StringProperty(name="Observer", default="cie1931", description="latent-develop --list-observers shows all")
    film: StringProperty(name="Film", description="latent-develop --list-films shows all; empty: none")
    paper: StringProperty(name="Paper", description="What a negative film is printed on", default="endura")
    stops: FloatProperty(name="Exposure", description="Stops", default=0, soft_min=-5, soft_max=5)
    noise: EnumProperty(name="Noise", items=[("KEEP", "Keep", ""), ("FIREFLIES", "Dim fireflies", ""), ("DENOISE", "Denoise", "")])
    aperture: FloatProperty(name="Aperture", description="Share of the radius of the rendered lens; needs depth of field with blades, or --aov lens", default=1, min=0.01, max=1)
    shutter: FloatProperty(name="Shutter", description="Share of the rendered exposure; needs Keep the time", default=1, min=0.01, max=1)
    mix: CollectionProperty(type=LightMix)


def options(settings, groups, aperture):
    """Arguments of latent-develop. `aperture`: that of the camera's blades, or None."""
    words = ["--observer", settings.observer] if not settings.film else ["--film", settings.film]
    words += {"KEEP": [], "FIREFLIES": ["--dim-fireflies"], "DENOISE": ["--denoise"]}[settings.noise]
    parts = ([f"{settings.aperture:.6g}"] if settings.aperture < 1 else []) + ([aperture] if aperture else [])
    words += ["--aperture", ",".join(parts)] if parts else []
    words += ["--shutter", f"0:{settings.shutter:.6g}"] if settings.shutter < 1 else []
    for light in settings.mix:
        if light.name in groups and (light.factor != 1 or light.change):
            words += ["--light", f"{light.name}=" + ",".join([f"{light.factor:.6g}", *([light.change] if light.change else [])])]
    return words


def show(pixels):
    """(height, width, 3), linear, into the image that the panel fills."""
    height, width = pixels.shape[:2]
    image = bpy.data.images.get(IMAGE)
    if image is None or tuple(image.size) != (width, height):
        if image is not None:
            bpy.data.images.remove(image)
        image = bpy.data.images.new(IMAGE, width, height, float_buffer=True)
    image.pixels.foreach_set(np.ascontiguousarray(engine.with_alpha(pixels)[::-1], np.float32).ravel())
    image.update()
    return image


class Operator:
    def execute(self, context):
        try:
            self.run(context)
        except (tools.Failure, OSError, ValueError) as failure:
            self.report({"ERROR"}, f"Latent: {failure}")
            return {"CANCELLED"}
        return {"FINISHED"}


class LATENT_OT_light_mix(Operator, bpy.types.Operator):
    """Lists the light groups of the last render"""

    bl_idname, bl_label = "latent.light_mix", "List the lights"

    def run(self, context):
        mix = context.scene.latent.darkroom.mix
        groups = develop.groups_of(engine.program("latent-inspect"), engine.last["samples"])
        for name in groups:
            if name not in mix:
                mix.add().name = name
        for name in [light.name for light in mix if light.name not in groups]:
            mix.remove(mix.find(name))


class LATENT_OT_develop(Operator, bpy.types.Operator):
    """Develops the samples of the last render into the image Latent Darkroom. Nothing is rendered"""

    bl_idname, bl_label = "latent.develop", "Develop"

    def run(self, context):
        settings, samples = context.scene.latent.darkroom, engine.last["samples"]
        if not samples:
            raise tools.Failure("nothing was rendered yet")
        picture = os.path.splitext(engine.last["picture"])[0] + ".darkroom.exr"
        words = options(settings, [light.name for light in settings.mix], engine.last["aperture"])
        channels = develop.develop(engine.program("latent-develop"), samples, picture, words)
        if not settings.film and settings.observer.startswith("cie"):
            show(develop.rgb(channels) * np.float32(2.0**settings.stops))
            return
        # What a camera or a film has seen is printed: it is no light of the scene any more.
        printed = picture[:-4] + ".png"
        words = ["--paper", settings.paper] if settings.film and settings.paper else []
        tools.run([engine.program("latent-convert"), picture, "-o", printed, "--force", "--quiet", "--json", "--stops", f"{settings.stops:.6g}", *words])
        image = bpy.data.images.get(IMAGE)
        if image is not None:
            bpy.data.images.remove(image)
        image = bpy.data.images.load(printed)
        image.name = IMAGE


class LATENT_OT_darkroom(Operator, bpy.types.Operator):
    """Opens the samples of the last render in latent-darkroom, a page in the browser. It ends with Blender"""

    bl_idname, bl_label = "latent.darkroom", "Open latent-darkroom"

    def run(self, context):
        samples = engine.last["samples"]
        if not samples:
            raise tools.Failure("nothing was rendered yet")
        words = [engine.program("latent-darkroom"), samples, "--recipes", os.path.dirname(samples)]
        room = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, text=True)
        atexit.register(room.terminate)
        address = room.stdout.readline().strip()
        if not address:
            raise tools.Failure("latent-darkroom did not start; the terminal says why")
        webbrowser.open(address)


class LATENT_OT_farm(Operator, bpy.types.Operator):
    """Exports the frame, or all frames, and plans their render on many machines with latent-farm. Nothing is started"""

    bl_idname, bl_label = "latent.farm", "Plan"
    animation: bpy.props.BoolProperty(name="All frames")

    def run(self, context):
        settings = context.scene.latent
        engine.planned = []
        try:
            bpy.ops.render.render(animation=self.animation)
            scenes = engine.planned
        finally:
            engine.planned = None
        folder = os.path.realpath(bpy.path.abspath(settings.farm_folder))
        words = [engine.program("latent-farm"), "plan", *(path for path, _ in scenes), "--spp", settings.samples, "--out", folder, "--json", "--", *scenes[0][1]]
        tools.run(words)
        self.report({"INFO"}, f"Latent: {len(scenes)} frames are planned in {folder}")


class LATENT_OT_bake(Operator, bpy.types.Operator):
    """Bakes to pictures, with Cycles in the background, what the last render could not export of materials"""

    bl_idname, bl_label = "latent.bake", "Bake them"

    def run(self, context):
        from . import baking

        made, failed = baking.nodes(context.scene, engine.last["wanted"], engine.folder_of(context.scene))
        for name in failed:
            self.report({"WARNING"}, f"Latent: {name} could not be baked; a mesh with a UV map must have this material")
        self.report({"INFO"}, f"Latent: {made} pictures were baked; F12 takes them")


CLASSES = (LightMix, DarkroomSettings, LATENT_OT_light_mix, LATENT_OT_develop, LATENT_OT_darkroom, LATENT_OT_farm, LATENT_OT_bake)
