"""Builds a scene in Blender, renders it with Cycles and exports it: blender -b --python bench/blender_scene.py -- FOLDER WIDTH HEIGHT SAMPLES

Writes FOLDER/cycles.exr (linear, Rec. 709, float32) and the scene as scene.glb, scene.gltf and scene.obj.
"""
import math
import sys

import bpy

folder, width, height, samples = sys.argv[sys.argv.index("--") + 1 :]
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
world = scene.world = bpy.data.worlds.new("world")
world.use_nodes = True
world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0


def material(name, **inputs):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    node = made.node_tree.nodes["Principled BSDF"]
    for key, value in {"Specular": 0.5, "Roughness": 0.5, **inputs}.items():
        node.inputs[key.replace("_", " ")].default_value = value
    return made, node


def put(made, x, y, z=1, scale=1):
    """The newest object."""
    added = bpy.context.object
    added.location, added.scale = (x, y, z), (scale,) * 3
    added.data.materials.append(made)
    return added


def smooth(shape):
    for polygon in shape.data.polygons:
        polygon.use_smooth = True


# A floor with a picture on it.
picture = bpy.data.images.new("grid", 256, 256)
picture.generated_type = "COLOR_GRID"
picture.filepath_raw, picture.file_format = f"{folder}/grid.png", "PNG"
picture.save()
made, node = material("floor", Roughness=1, Specular=0)
texture = made.node_tree.nodes.new("ShaderNodeTexImage")
texture.image = picture
made.node_tree.links.new(texture.outputs["Color"], node.inputs["Base Color"])
bpy.ops.mesh.primitive_plane_add(size=14)
put(made, 0, 0, 0)

bpy.ops.mesh.primitive_monkey_add(rotation=(0, 0, 0.4))
smooth(put(material("metal", Base_Color=(0.9, 0.6, 0.3, 1), Metallic=1, Roughness=0.3)[0], -2.4, 0))
bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32)
glass, _ = material("glass", Transmission=1, Roughness=0, IOR=1.5)
# Only with a thickness does Blender export solid glass.
group = bpy.data.node_groups.new("glTF Material Output", "ShaderNodeTree")
group.inputs.new("NodeSocketFloat", "Thickness")
node = glass.node_tree.nodes.new("ShaderNodeGroup")
node.node_tree = group
node.inputs["Thickness"].default_value = 2
smooth(put(glass, 0, -1))
bpy.ops.mesh.primitive_torus_add(rotation=(0.9, 0, 0))
smooth(put(material("lacquer", Base_Color=(0.1, 0.3, 0.7, 1), Clearcoat=1, Clearcoat_Roughness=0.05)[0], 2.5, 0.3))
bpy.ops.mesh.primitive_cube_add(rotation=(0, 0, 0.6))
cube = put(material("plastic", Base_Color=(0.7, 0.1, 0.1, 1), Roughness=0.4)[0], -0.6, 2.6, 0.8, 0.8)
again = cube.copy()  # an instance: the same mesh
again.location = (1.6, 3.0, 0.8)
scene.collection.objects.link(again)

bpy.ops.mesh.primitive_plane_add(size=2, rotation=(0, math.radians(115), 0))
put(material("lamp", Base_Color=(0, 0, 0, 1), Specular=0, Emission=(1, 0.8, 0.6, 1), Emission_Strength=6)[0], 5, 1, 3)
bpy.ops.object.light_add(type="POINT", location=(-3, -3, 4))
bpy.context.object.data.energy, bpy.context.object.data.shadow_soft_size = 500, 0
bpy.ops.object.light_add(type="SPOT", location=(0.5, -1, 6), rotation=(0, 0, 0))
bpy.context.object.data.energy, bpy.context.object.data.shadow_soft_size = 800, 0
bpy.context.object.data.spot_size, bpy.context.object.data.spot_blend = 0.9, 0.4
bpy.ops.object.light_add(type="SUN", rotation=(0.7, 0.2, 0.5))
bpy.context.object.data.energy, bpy.context.object.data.angle = 0.5, 0

bpy.ops.object.camera_add(location=(0, -9, 4.2), rotation=(math.radians(70), 0, 0))
scene.camera = bpy.context.object
scene.camera.data.lens = 40

render = scene.render
render.engine, render.resolution_x, render.resolution_y, render.resolution_percentage = "CYCLES", int(width), int(height), 100
render.image_settings.file_format, render.image_settings.color_depth, render.image_settings.color_mode = "OPEN_EXR", "32", "RGB"
render.image_settings.exr_codec, render.filepath = "NONE", f"{folder}/cycles.exr"
cycles = scene.cycles
cycles.device, cycles.samples, cycles.use_denoising, cycles.use_adaptive_sampling = "CPU", int(samples), False, False
cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = 16
cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.blur_glossy = 0
cycles.pixel_filter_type = "BOX"

bpy.context.view_layer.update()
lights = dict(export_cameras=True, export_lights=True, export_apply=True)
bpy.ops.export_scene.gltf(filepath=f"{folder}/scene.glb", export_format="GLB", **lights)
bpy.ops.export_scene.gltf(filepath=f"{folder}/scene.gltf", export_format="GLTF_SEPARATE", **lights)
bpy.ops.export_scene.obj(filepath=f"{folder}/scene.obj")

bpy.ops.render.render(write_still=True)
