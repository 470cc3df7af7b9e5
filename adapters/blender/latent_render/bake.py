"""Run by another Blender: python bake.py JOB, or blender -b --factory-startup --python bake.py -- JOB. JOB is a JSON file:

{"library": FILE.blend, "world": NAME, "output": FILE.exr, "width": W, "samples": N}: a world as a picture in longitude and latitude.
{"library": FILE.blend, "object": NAME, "material": NAME, "tasks": [[NODE, OUTPUT, FILE.pfm], ...], "side": W}: values of nodes over the UV map
of an object.
"""
import json
import sys

import bpy
import numpy as np


def light_path_is_0():
    """For what lights the scene, not what the camera sees."""
    for tree in (*(of.node_tree for of in (*bpy.data.worlds, *bpy.data.materials) if of.node_tree), *bpy.data.node_groups):
        zero = tree.nodes.new("ShaderNodeValue").outputs[0]
        zero.default_value = 0
        for target in [link.to_socket for link in tree.links if link.from_node.type == "LIGHT_PATH"]:
            tree.links.new(zero, target)


def bake_world(job):
    with bpy.data.libraries.load(job["library"]) as (there, here):
        here.worlds = [job["world"]]
    scene = bpy.context.scene
    light_path_is_0()
    for thing in list(scene.objects):
        bpy.data.objects.remove(thing)
    scene.world = here.worlds[0]
    data = bpy.data.cameras.new("bake")
    data.type = "PANO"
    (data if hasattr(data, "panorama_type") else data.cycles).panorama_type = "EQUIRECTANGULAR"
    owner = bpy.data.objects.new("bake", data)
    owner.rotation_euler = (1.5707963267948966, 0, -1.5707963267948966)  # along +x, where the middle of Blender's pictures is
    scene.collection.objects.link(owner)
    scene.camera = owner
    render, cycles = scene.render, scene.cycles
    render.engine, render.filepath = "CYCLES", job["output"]
    render.resolution_x, render.resolution_y, render.resolution_percentage = job["width"], job["width"] // 2, 100
    render.image_settings.file_format, render.image_settings.color_depth, render.image_settings.color_mode = "OPEN_EXR", "32", "RGB"
    cycles.device, cycles.samples, cycles.use_denoising, cycles.use_adaptive_sampling = "CPU", job["samples"], False, False
    cycles.pixel_filter_type = "BOX"
    bpy.ops.render.render(write_still=True)


def bake_nodes(job):
    with bpy.data.libraries.load(job["library"]) as (there, here):
        here.objects = [job["object"]]
    scene, owner = bpy.context.scene, here.objects[0]
    scene.collection.objects.link(owner)
    owner.hide_render = False
    bpy.context.view_layer.objects.active = owner
    owner.select_set(True)
    light_path_is_0()
    scene.render.engine, scene.render.bake.margin = "CYCLES", 4
    scene.cycles.device, scene.cycles.samples, scene.cycles.use_denoising = "CPU", 16, False
    for node, output, path in job["tasks"]:
        image = bpy.data.images.new("baked", job["side"], job["side"], float_buffer=True)
        for slot in owner.material_slots:  # each needs an image to be baked into
            if slot.material and slot.material.node_tree:
                tree = slot.material.node_tree
                target = tree.nodes.new("ShaderNodeTexImage")
                target.image, tree.nodes.active = image, target
                if slot.material.name == job["material"]:
                    for other in [other for other in tree.nodes if other.type == "OUTPUT_MATERIAL"]:
                        tree.nodes.remove(other)
                    emit, end = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeOutputMaterial")
                    tree.links.new(next(o for o in tree.nodes[node].outputs if o.identifier == output), emit.inputs["Color"])
                    tree.links.new(emit.outputs[0], end.inputs["Surface"])
        bpy.ops.object.bake(type="EMIT")
        pixels = np.empty(len(image.pixels), np.float32)
        image.pixels.foreach_get(pixels)
        with open(path, "wb") as file:  # the values themselves; Blender would encode them
            file.write(b"PF\n%d %d\n-1.0\n" % tuple(image.size) + np.ascontiguousarray(pixels.reshape(-1, 4)[:, :3], "<f4").tobytes())


if __name__ == "__main__":
    with open(sys.argv[-1]) as file:
        task = json.load(file)
    (bake_world if "world" in task else bake_nodes)(task)
