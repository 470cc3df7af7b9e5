"""After the render: develops the samples again, as the panel says, into an image of Blender; and plans renders on many machines."""
import atexit
import os
import subprocess
import webbrowser
from concurrent import futures

import bpy
import numpy as np
from bpy.props import BoolProperty, CollectionProperty, EnumProperty, FloatProperty, StringProperty

from . import baking, develop, engine, job, tools

IMAGE = "Latent Darkroom"


def listed(name, kind, option):
    """For a text that has candidates: what a program lists for an option of its own, each with what it is."""

    def search(_, context, text):
        try:
            return tools.listed(engine.program(name), kind, option)
        except tools.Failure:
            return []

    return search


def follow(_, context):
    """Called when a control of the mix has moved: shows a sum of pictures, if they are there."""
    settings = context.scene.latent.darkroom
    if IMAGE in bpy.data.images and settings.adds_up:
        try:
            show(settings, developing(context)()[0])
        except (tools.Failure, OSError, ValueError):
            pass  # Develop says why


class LightMix(bpy.types.PropertyGroup):
    factor: FloatProperty(name="Factor", default=1, min=0, soft_max=10, update=follow)
    mute: BoolProperty(name="Mute", description="Without this light", update=follow)
    solo: BoolProperty(name="Solo", description="This light alone, and others that are solo", update=follow)
    change: StringProperty(name="Spectrum", description="A filter or another spectrum of the same luminance, such as 6500K, D65, F11 or wratten-80a",
                           search=listed("latent-develop", "lens-filter", "--list-observers"))


class DarkroomSettings(bpy.types.PropertyGroup):
    observer: StringProperty(name="Observer", description="An eye, a camera or a black-and-white film, or a table (CSV)", default="cie1931",
                             search=listed("latent-develop", "observer", "--list-observers"))
    film: StringProperty(name="Film", description="Instead of an observer; empty: none", search=listed("latent-develop", "film", "--list-films"))
    paper: StringProperty(name="Paper", description="What a negative film is printed on", default="endura", search=listed("latent-convert", "paper", "--list-papers"))
    stops: FloatProperty(name="Exposure", description="Stops", default=0, soft_min=-5, soft_max=5, update=follow)
    noise: EnumProperty(name="Noise", items=[("KEEP", "Keep", ""), ("FIREFLIES", "Dim fireflies", ""), ("DENOISE", "Denoise", "")])
    aperture: FloatProperty(name="Aperture", description="Share of the radius of the rendered lens; needs depth of field with blades, or --aov lens", default=1, min=0.01, max=1)
    shutter: FloatProperty(name="Shutter", description="Share of the rendered exposure; needs Keep the time", default=1, min=0.01, max=1)
    mix: CollectionProperty(type=LightMix)

    @property
    def printed(self):
        """What a camera or a film has seen is printed: it is no light of the scene any more."""
        return bool(self.film) or not self.observer.startswith("cie")

    @property
    def adds_up(self):
        """Whether a light mix is a sum of the pictures of the lights."""
        return not self.printed and self.noise == "KEEP"

    def factors(self):
        solo = any(light.solo for light in self.mix)
        return {light.name: 0.0 if light.mute or solo and not light.solo else light.factor for light in self.mix}

    def options(self, scene, aperture):
        """Arguments of latent-develop. Factors are left for later where the pictures of the lights need only be added up."""
        parts = ([f"{self.aperture:.6g}"] if self.aperture < 1 else []) + ([aperture] if aperture else [])
        words = engine.develop_words(scene.latent, ",".join(parts))
        words += ["--film", self.film] if self.film else ["--observer", self.observer] if self.observer != "cie1931" else []
        words += {"KEEP": [], "FIREFLIES": ["--dim-fireflies"], "DENOISE": ["--denoise"]}[self.noise]
        words += ["--shutter", f"0:{self.shutter:.6g}"] if self.shutter < 1 else []
        for light, factor in zip(self.mix, self.factors().values()):
            changes = ([light.change] if light.change else []) + ([f"{factor:.6g}"] if factor != 1 and not self.adds_up else [])
            words += ["--light", f"{light.name}={','.join(changes)}"] if changes else []
        return words


def job_of(context):
    """That of the frame in view, though Blender may have been closed since."""
    last = job.Job(engine.folder_of(context.scene), engine.name_of(context.scene, context.view_layer.name))
    if not last.files:
        raise tools.Failure(f"frame {context.scene.frame_current} has no samples yet; render it with F12")
    return last


def developing(context, program=None, converter=None):
    """A function that makes what the panel asks for, before lights are mixed: its channels and its path. It needs no Blender, and ends early if
    what it is given says so. Without a program, it fails if the picture is not there yet; with a converter, it prints the picture."""
    settings, last = context.scene.latent.darkroom, job_of(context)
    layers = ["lights"] if settings.adds_up and last.note["parts"].get("light groups") else []
    path, words = os.path.splitext(last.picture)[0] + ".darkroom.exr", settings.options(context.scene, last.note["aperture"])
    printing = ["--force", "--quiet", "--json", "--stops", f"{settings.stops:.6g}"]
    printing += ["--paper", settings.paper] if settings.film and settings.paper else []

    def develop_and_print(stop=lambda: False):
        channels, made = last.develop(program, path, words, layers, stop)
        if converter:
            tools.run([converter, made, "-o", print_of(made), *printing])
        return channels, made

    return develop_and_print


def print_of(path):
    return os.path.splitext(path)[0] + ".png"


def show(settings, channels):
    pixels = develop.rgb(develop.mixed(channels, settings.factors())) * np.float32(2.0**settings.stops)
    height, width = pixels.shape[:2]
    image = bpy.data.images.get(IMAGE)
    if image is None or tuple(image.size) != (width, height) or image.source != "GENERATED":
        if image is not None:
            bpy.data.images.remove(image)
        image = bpy.data.images.new(IMAGE, width, height, float_buffer=True)
    image.pixels.foreach_set(np.ascontiguousarray(engine.with_alpha(pixels)[::-1], np.float32).ravel())
    image.update()
    return image


def put_up(image):
    """Shows an image in an editor of images, as F12 shows its picture."""
    editors = lambda: [area for window in bpy.context.window_manager.windows for area in window.screen.areas if area.type == "IMAGE_EDITOR"]  # noqa: E731
    if not bpy.app.background and not editors():
        bpy.ops.render.view_show("INVOKE_DEFAULT")
    for area in editors()[:1]:
        area.spaces.active.image = image


class Operator:
    def execute(self, context):
        return self.guarded(self.run, context)

    def guarded(self, step, context):
        """The status of an operator. What fails is a line for the user."""
        try:
            return step(context) or {"FINISHED"}
        except (tools.Failure, OSError, ValueError) as failure:
            self.report({"ERROR"}, f"Latent: {failure}")
            return {"CANCELLED"}


class LATENT_OT_develop(Operator, bpy.types.Operator):
    """Develops the samples of this frame into the image Latent Darkroom, and lists their lights. Nothing is rendered"""

    bl_idname, bl_label = "latent.develop", "Develop"

    running = False

    @classmethod
    def poll(cls, _):
        return not LATENT_OT_develop.running

    def work(self, context):
        printed = context.scene.latent.darkroom.printed
        return developing(context, engine.program("latent-develop"), engine.program("latent-convert") if printed else None)

    def finish(self, context, channels, path):
        settings, lights = context.scene.latent.darkroom, develop.lights(channels)
        if settings.adds_up:
            for name in {*settings.mix.keys()}.difference(lights):
                settings.mix.remove(settings.mix.find(name))
            for name in [name for name in lights if name not in settings.mix]:
                settings.mix.add().name = name
        if settings.printed:
            if IMAGE in bpy.data.images:
                bpy.data.images.remove(bpy.data.images[IMAGE])
            image = bpy.data.images.load(print_of(path))
            image.name = IMAGE
        else:
            image = show(settings, channels)
        put_up(image)

    def run(self, context):
        self.finish(context, *self.work(context)())

    # From the panel, Blender goes on meanwhile. Esc stops.
    def invoke(self, context, _):
        return self.guarded(self.begin, context)

    def begin(self, context):
        work = self.work(context)
        LATENT_OT_develop.running, self.stopped = True, False
        self.result = futures.ThreadPoolExecutor(1).submit(work, lambda: self.stopped)
        self.timer = context.window_manager.event_timer_add(0.1, window=context.window)
        context.window_manager.modal_handler_add(self)
        context.workspace.status_text_set("Latent: developing; Esc stops")
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        self.stopped |= event.type == "ESC"
        if not self.result.done():
            return {"PASS_THROUGH"}
        LATENT_OT_develop.running = False
        context.window_manager.event_timer_remove(self.timer)
        context.workspace.status_text_set(None)
        return self.guarded(lambda context: self.finish(context, *self.result.result()), context)

    def cancel(self, _):
        LATENT_OT_develop.running, self.stopped = False, True


class LATENT_OT_darkroom(Operator, bpy.types.Operator):
    """Opens the samples of the last render in latent-darkroom, a page in the browser. It ends with Blender"""

    bl_idname, bl_label = "latent.darkroom", "Open latent-darkroom"

    def run(self, context):
        samples = job_of(context).samples
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


class LATENT_OT_clean(Operator, bpy.types.Operator):
    """Removes samples of earlier jobs: all but those of the last job of each frame"""

    bl_idname, bl_label = "latent.clean", "Remove old jobs"

    def invoke(self, context, _):
        return context.window_manager.invoke_props_dialog(self)

    def draw(self, context):
        files = job.old(engine.folder_of(context.scene))
        self.layout.label(text=f"{sum(map(os.path.getsize, files)) / 2**20:.1f} MiB of samples; this cannot be undone", icon="TRASH")

    def run(self, context):
        for path in job.old(engine.folder_of(context.scene)):
            os.remove(path)


class LATENT_OT_bake(Operator, bpy.types.Operator):
    """Bakes to pictures, with Cycles in the background, what the last render could not export of materials"""

    bl_idname, bl_label = "latent.bake", "Bake them"

    def run(self, context):
        made, failed = baking.nodes(context.scene, engine.last["wanted"], engine.folder_of(context.scene))
        for name in failed:
            self.report({"WARNING"}, f"Latent: {name} could not be baked; a mesh with a UV map must have this material")
        self.report({"INFO"}, f"Latent: {made} pictures were baked; F12 takes them")


CLASSES = (LightMix, DarkroomSettings, LATENT_OT_develop, LATENT_OT_darkroom, LATENT_OT_farm, LATENT_OT_clean, LATENT_OT_bake)
