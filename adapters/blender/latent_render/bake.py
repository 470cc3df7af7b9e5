"""Run by another Blender: python bake.py JOB, or blender -b --factory-startup --python bake.py -- JOB. JOB is a JSON file:

{"library": FILE.blend, "world": NAME, "output": FILE.exr, "width": W, "samples": N}: a world as a picture in longitude and latitude.
"""
import json
import sys

import bpy


def settings_of(scene, width, height, samples, output):
    render, cycles = scene.render, scene.cycles
    render.engine, render.filepath = "CYCLES", output
    render.resolution_x, render.resolution_y, render.resolution_percentage = width, height, 100
    render.image_settings.file_format, render.image_settings.color_depth, render.image_settings.color_mode = "OPEN_EXR", "32", "RGB"
    cycles.device, cycles.samples, cycles.use_denoising, cycles.use_adaptive_sampling = "CPU", samples, False, False
    cycles.pixel_filter_type = "BOX"



def bake_world(job):
    with bpy.data.libraries.load(job["library"]) as (there, here):
        here.worlds = [job["world"]]
    scene = bpy.context.scene
    for thing in list(scene.objects):
        bpy.data.objects.remove(thing)
    scene.world = here.worlds[0]
    data = bpy.data.cameras.new("bake")
    data.type = "PANO"
    if hasattr(data, "panorama_type"):
        data.panorama_type = "EQUIRECTANGULAR"
    else:
        data.cycles.panorama_type = "EQUIRECTANGULAR"
    owner = bpy.data.objects.new("bake", data)
    owner.rotation_euler = (1.5707963267948966, 0, -1.5707963267948966)  # along +x, where the middle of Blender's pictures is
    scene.collection.objects.link(owner)
    scene.camera = owner
    settings_of(scene, job["width"], job["width"] // 2, job["samples"], job["output"])
    bpy.ops.render.render(write_still=True)


if __name__ == "__main__":
    with open(sys.argv[-1]) as file:
        bake_world(json.load(file))
