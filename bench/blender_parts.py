"""Parts of the scenes that bench/blender builds inside Blender, and their renders."""
import math
import os
import pathlib
import sys
import time

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "adapters/blender"))

import bpy  # noqa: E402
import latent_render  # noqa: E402
import numpy as np  # noqa: E402

SIZE = 64
NEW = bpy.app.version >= (4, 0, 0)
if not hasattr(bpy.types.Scene, "latent"):
    latent_render.register()


def start(samples, folder, width=SIZE, height=SIZE):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    render, cycles = scene.render, scene.cycles
    render.resolution_x, render.resolution_y, render.resolution_percentage = width, height, 100
    image = render.image_settings
    if hasattr(image, "media_type"):
        image.media_type = "IMAGE"
    image.file_format, image.color_depth, image.color_mode, image.exr_codec = "OPEN_EXR", "32", "RGB", "NONE"
    cycles.device, cycles.samples, cycles.use_denoising, cycles.use_adaptive_sampling, cycles.pixel_filter_type = "CPU", samples, False, False, "BOX"
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = cycles.volume_bounces = 16
    cycles.transparent_max_bounces = 16
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.blur_glossy = 0
    latent = scene.latent
    latent.samples, latent.folder, latent.max_depth, latent.develop_options = samples, str(folder), 17, "--filter box"
    return scene


def material(shader, output="BSDF", **inputs):
    """Of one shader node. Inputs: names with _ for blanks."""
    made = bpy.data.materials.new("material")
    made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    end = tree.nodes.new("ShaderNodeOutputMaterial")
    node = tree.nodes.new(f"ShaderNode{shader}")
    for name, value in inputs.items():
        socket(node, name).default_value = value
    tree.links.new(node.outputs[output], end.inputs["Surface"])
    return made, tree, node


def socket(node, name):
    names = (name.replace("_", " "), {"Fac": "Factor"}.get(name))  # the second since 5.0
    return next(s for s in node.inputs if s.name in names and s.enabled)


def diffuse(value=0.5):
    return material("BsdfDiffuse", Color=(value, value, value, 1))[0]


def principled(**inputs):
    renamed = {"Specular": "Specular_IOR_Level", "Clearcoat": "Coat_Weight", "Clearcoat_Roughness": "Coat_Roughness", "Transmission": "Transmission_Weight",
               "Emission": "Emission_Color"} if NEW else {}
    return material("BsdfPrincipled", **{renamed.get(name, name): value for name, value in inputs.items()})


def put(of):
    owner = bpy.context.object
    if of is not None:
        owner.data.materials.append(of)
    return owner


def plane(of, size=4.0, **where):
    bpy.ops.mesh.primitive_plane_add(size=size, **where)
    return put(of)


def ball(of, radius=1.0, segments=64, **where):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=segments, ring_count=segments // 2, radius=radius, **where)
    for polygon in bpy.context.object.data.polygons:
        polygon.use_smooth = True
    return put(of)


def lamp(kind, energy, location=(0.3, 0.2, 2.0), rotation=(0.2, 0.1, 0), **values):
    bpy.ops.object.light_add(type=kind, location=location, rotation=rotation)
    data = bpy.context.object.data
    data.energy = energy
    for name, value in values.items():
        setattr(data, name, value)
    return bpy.context.object


def sky(strength=1.0, color=(1, 1, 1, 1)):
    made = bpy.context.scene.world = bpy.data.worlds.new("world")
    made.use_nodes = True
    background = made.node_tree.nodes["Background"]
    background.inputs["Color"].default_value, background.inputs["Strength"].default_value = color, strength
    return made.node_tree, background


def above(width=4.0):
    """An orthographic camera that looks down on the origin."""
    bpy.ops.object.camera_add(location=(0, 0, 5))
    camera = bpy.context.scene.camera = bpy.context.object
    camera.data.type, camera.data.ortho_scale = "ORTHO", width
    return camera


def in_front(distance=5.0, lens=50.0, height=0.0):
    """A perspective camera that looks along +y at the origin."""
    bpy.ops.object.camera_add(location=(0, -distance, height), rotation=(math.pi / 2 - math.atan2(height, distance), 0, 0))
    camera = bpy.context.scene.camera = bpy.context.object
    camera.data.lens = lens
    return camera


def lit_floor():
    plane(diffuse(), 20.0)
    above()


def on_show(of, strength=1.0):
    """A ball in front of a bright sky whose halves differ."""
    ball(of)
    in_front(4.6)
    tree, background = sky(strength)
    coordinates, split, ramp = (tree.nodes.new(f"ShaderNode{name}") for name in ("TexCoord", "SeparateXYZ", "ValToRGB"))
    tree.links.new(coordinates.outputs["Generated"], split.inputs[0])
    tree.links.new(split.outputs["Z"], ramp.inputs[0])
    ramp.color_ramp.elements[0].color = (0.2, 0.2, 0.2, 1)
    tree.links.new(ramp.outputs["Color"], background.inputs["Color"])


def picture_image(space="sRGB", side=8, seed=1):
    """Random colours in the file's encoding, or random numbers."""
    image = bpy.data.images.new("picture", side, side)
    image.colorspace_settings.name = space
    values = np.ones((side, side, 4), np.float32)
    values[..., :3] = np.random.default_rng(seed).random((side, side, 3 if space == "sRGB" else 1))
    image.pixels.foreach_set(values.ravel())
    image.update()
    return image


def with_texture(made, tree, node, name, space="sRGB", extension="REPEAT", interpolation="Closest"):
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image, texture.extension, texture.interpolation = picture_image(space), extension, interpolation
    tree.links.new(texture.outputs["Color"], socket(node, name))
    return texture


def end():
    """Blender itself would end with 1 after a render that was stopped, and bpy 4.3 crashes at its end once a property had a callback."""
    sys.stdout.flush()
    os._exit(0)


# ----- renders


def shot(kind, path):
    scene = bpy.context.scene
    scene.render.engine, scene.render.filepath = kind, str(path)
    begin = time.monotonic()
    bpy.ops.render.render(write_still=True)
    seconds = time.monotonic() - begin
    image = bpy.data.images.load(str(path), check_existing=False)
    width, height = image.size
    values = np.empty(width * height * 4, np.float32)
    image.pixels.foreach_get(values)
    bpy.data.images.remove(image)
    return values.reshape(height, width, 4)[..., :3].astype(float), seconds


def side_by_side(folder, name, scale=3):
    """Latent left, Cycles right, as a PNG."""
    pictures = []
    for renderer in ("latent", "cycles"):
        image = bpy.data.images.load(str(folder / f"{name}.{renderer}.exr"), check_existing=False)
        width, height = image.size
        values = np.empty(width * height * 4, np.float32)
        image.pixels.foreach_get(values)
        bpy.data.images.remove(image)
        pictures.append(values.reshape(height, width, 4)[..., :3])
    row = np.concatenate(pictures, 1)
    row = np.repeat(np.repeat(np.clip(row / max(1e-9, 2.5 * row.mean()), 0, 1) ** (1 / 2.2), scale, 0), scale, 1)
    image = bpy.data.images.new("pair", row.shape[1], row.shape[0])
    values = np.ones((*row.shape[:2], 4), np.float32)
    values[..., :3] = row
    image.pixels.foreach_set(values.ravel())
    image.filepath_raw, image.file_format = str(folder / f"{name}.png"), "PNG"
    image.save()
    bpy.data.images.remove(image)
