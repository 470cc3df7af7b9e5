"""Seconds until the darkroom shows: run by bench/blender inside Blender. blender -b --python bench/blender_darkroom.py -- FOLDER SAMPLES"""
import json
import pathlib
import resource
import sys
import time

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import bpy  # noqa: E402
from blender_parts import ball, diffuse, end, in_front, lamp, plane, principled, sky, start  # noqa: E402
from latent_render import engine  # noqa: E402

folder, samples = sys.argv[-2:]
scene = start(int(samples), pathlib.Path(folder) / "darkroom", 1280, 720)
scene.latent.develop_options, scene.latent.light_groups, scene.render.engine = "", "LAMPS", "LATENT"
plane(diffuse(), 20.0, location=(0, 0, -1))
ball(principled(Metallic=1.0, Roughness=0.3)[0])
in_front(6.0, 50.0, 2.0)
sky(0.3)
for kind, watts, place in (("AREA", 200, (2, -2, 4)), ("SPOT", 300, (-3, -2, 4))):
    lamp(kind, watts, place, (0, 0.5 if place[0] > 0 else -0.6, 0))


def cost(what, work):
    """Wall time, and CPU time of Blender and of what it runs."""
    cpu = lambda: sum(sum(resource.getrusage(who)[:2]) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))  # noqa: E731
    begin, used = time.monotonic(), cpu()
    work()
    print("RESULT " + json.dumps({"what": what, "seconds": time.monotonic() - begin, "cpu": cpu() - used}), flush=True)


show = engine.LatentEngine.show
engine.LatentEngine.show = lambda *words: cost("pictures of all lights after F12", lambda: show(*words))
bpy.ops.render.render()
engine.LatentEngine.show = show
darkroom = scene.latent.darkroom
cost("first look", bpy.ops.latent.develop)
for number, light in enumerate(darkroom.mix):
    cost(f"another factor of {light.name}", lambda: setattr(light, "factor", 0.5 + number))  # noqa: B023
darkroom.mix[0].change = "2856K"
cost("another spectrum of a light", bpy.ops.latent.develop)
cost("a factor after that", lambda: setattr(darkroom.mix[0], "factor", 0.1))
darkroom.observer = "canon_eos_5d"
cost("another observer, printed", bpy.ops.latent.develop)
end()
