"""Small scenes, one feature each, rendered by Latent's add-on and by Cycles: run by bench/blender inside Blender, or by a Python that has bpy.

    blender -b --factory-startup --python bench/blender_features.py -- FOLDER SAMPLES [NAME...]

Prints a line of JSON for each scene, and keeps the pictures in FOLDER. Both renderers use box filters, neither denoises, and no view
transform is applied.
"""
import json
import math
import os
import pathlib
import subprocess
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

from blender_parts import (NEW, SIZE, above, ball, diffuse, end, in_front, lamp, lit_floor, material, on_show, picture_image, plane,
                           principled, put, shot, side_by_side, sky, start, with_texture)  # noqa: E402
import bpy  # noqa: E402
import latent_render  # noqa: E402
import numpy as np  # noqa: E402

FEATURES = {}


def feature(within, why="", kind="light"):
    """`within`: percent by which the mean may differ; `why`: the reason of a difference. `kind`: light, or place: centroids of four balls."""

    def keep(build):
        FEATURES[build.__name__] = (build, within, why, kind)
        return build

    return keep


# ----- what several features need


def four_balls():
    """Small bright balls in the corners of the view, at several depths."""
    glow = material("Emission", "Emission", Color=(1, 1, 1, 1), Strength=1.0)[0]
    for x, z, y in ((-0.9, -0.9, 0), (0.8, -0.9, 0.7), (-1.0, 0.9, 1.4), (0.9, 0.8, -0.5)):
        ball(glow, 0.15, 32, location=(x, y, z))


# ----- lamps


@feature(1)
def point_sharp():
    lit_floor()
    lamp("POINT", 30, shadow_soft_size=0)


@feature(1)
def point_ball():
    lit_floor()
    lamp("POINT", 30, shadow_soft_size=0.1, color=(1, 0.6, 0.3))


@feature(1, "" if NEW else "Cycles 3.4 multiplies a spot by the cosine from its axis; 4.0 and Latent do not")
def spot():
    lit_floor()
    lamp("SPOT", 30, shadow_soft_size=0, spot_size=1.2, spot_blend=0.4)


@feature(1)
def sun_sharp():
    lit_floor()
    lamp("SUN", 2, angle=0)


@feature(1)
def sun_wide():
    lit_floor()
    ball(diffuse(), 0.5, location=(0, 0, 0.8))
    lamp("SUN", 2, angle=0.2)


@feature(1)
def area_square():
    lit_floor()
    lamp("AREA", 30, shape="SQUARE", size=0.8)


@feature(1)
def area_rectangle():
    lit_floor()
    lamp("AREA", 30, shape="RECTANGLE", size=0.8, size_y=0.4, color=(0.4, 0.7, 1))


@feature(1)
def area_disk():
    lit_floor()
    lamp("AREA", 30, shape="DISK", size=0.8)


@feature(1)
def area_ellipse():
    lit_floor()
    lamp("AREA", 30, shape="ELLIPSE", size=0.8, size_y=0.4)


@feature(1, "the spread is a power of the cosine")
def area_spread():
    lit_floor()
    lamp("AREA", 30, shape="SQUARE", size=0.8, spread=1.0)


@feature(1)
def lamp_nodes():
    lit_floor()
    data = lamp("POINT", 10, shadow_soft_size=0).data
    data.use_nodes = True
    node = data.node_tree.nodes["Emission"]
    node.inputs["Color"].default_value, node.inputs["Strength"].default_value = (0.2, 0.9, 0.4, 1), 3


@feature(2, "blackbody of another fit of the observer")
def lamp_blackbody():
    lit_floor()
    data = lamp("POINT", 10, shadow_soft_size=0).data
    data.use_nodes = True
    tree = data.node_tree
    body = tree.nodes.new("ShaderNodeBlackbody")
    body.inputs[0].default_value = 3500
    tree.links.new(body.outputs[0], tree.nodes["Emission"].inputs["Color"])


def with_profile(data):
    """An IES profile that no turn or mirror image maps to itself."""
    down, around = range(0, 181, 5), range(0, 361, 10)
    values = [200 + 150 * math.cos(math.radians(v)) + 100 * math.sin(math.radians(v)) * (math.cos(math.radians(h)) + 0.5 * math.sin(math.radians(2 * h + 30)))
              for h in around for v in down]
    numbers = [1, -1, 1.5, len(down), len(around), 1, 2, 0, 0, 0, 0.9, 1, 50, *down, *around, *values]
    text = bpy.data.texts.new("profile")
    text.write("IESNA:LM-63-2002\nTILT=NONE\n" + "\n".join(f"{number:.6g}" for number in numbers) + "\n")
    data.use_nodes = True
    node = data.node_tree.nodes.new("ShaderNodeTexIES")
    node.mode, node.ies = "INTERNAL", text
    node.inputs["Strength"].default_value = 0.5
    data.node_tree.links.new(node.outputs[0], data.node_tree.nodes["Emission"].inputs["Strength"])


@feature(1, "" if NEW else "Cycles 3.4 multiplies a spot by the cosine from its axis; 4.0 and Latent do not")
def spot_scaled():
    """An oval cone since Blender 4."""
    lit_floor()
    lamp("SPOT", 10, shadow_soft_size=0, spot_size=0.8, spot_blend=0.3).scale = (1.5, 0.6, 1)


@feature(1)
def lamp_seen():
    lit_floor()
    lamp("POINT", 10, shadow_soft_size=0.2).visible_camera = True


@feature(1)
def lamp_profile():
    lit_floor()
    with_profile(lamp("POINT", 10, shadow_soft_size=0, rotation=(0.5, 0.3, 0.7)).data)


@feature(1, "" if NEW else "Cycles 3.4 multiplies a spot by the cosine from its axis; 4.0 and Latent do not")
def spot_profile():
    lit_floor()
    with_profile(lamp("SPOT", 10, shadow_soft_size=0, spot_size=1.2, spot_blend=0.4).data)


# ----- worlds


@feature(1)
def world_color():
    lit_floor()
    sky(0.7, (0.8, 0.5, 0.3, 1))


@feature(1)
def world_of_light_alone():
    """One sky lights the scene, another one is what the camera would see."""
    lit_floor()
    tree, background = sky(0.7, (0.8, 0.5, 0.3, 1))
    path, seen, choice = (tree.nodes.new(f"ShaderNode{name}") for name in ("LightPath", "Background", "MixShader"))
    seen.inputs["Color"].default_value = (0, 0, 5, 1)
    for source, target in ((path.outputs["Is Camera Ray"], choice.inputs[0]), (background.outputs[0], choice.inputs[1]), (seen.outputs[0], choice.inputs[2]),
                           (choice.outputs[0], tree.nodes["World Output"].inputs["Surface"])):
        tree.links.new(source, target)


@feature(1)
def world_baked_of_light_alone():
    """The same within a node that is baked."""
    lit_floor()
    tree, background = sky(0.7)
    path, choice, ramp = (tree.nodes.new(f"ShaderNode{name}") for name in ("LightPath", "MixRGB", "TexGradient"))
    choice.inputs[2].default_value = (0, 0, 5, 1)
    tree.links.new(path.outputs["Is Camera Ray"], choice.inputs[0])
    tree.links.new(ramp.outputs["Color"], choice.inputs[1])
    tree.links.new(choice.outputs[0], background.inputs["Color"])


@feature(1)
def world_sky():
    lit_floor()
    tree, background = sky(0.1)
    texture = tree.nodes.new("ShaderNodeTexSky")
    texture.sun_disc = False
    tree.links.new(texture.outputs[0], background.inputs["Color"])


def hdri(folder="/tmp"):
    """A picture in longitude and latitude, with a bright patch."""
    width = 64
    values = np.full((width // 2, width, 4), 0.2, np.float32)
    values[18:22, 8:14, :3] = (40, 30, 20)
    values[20:28, 40:60, :3] = (0.2, 0.6, 1.5)
    image = bpy.data.images.new("hdri", width, width // 2, float_buffer=True)
    image.colorspace_settings.name = "Linear Rec.709" if NEW else "Linear"
    image.pixels.foreach_set(values.ravel())
    image.update()
    return image


@feature(1)
def world_picture_turned():
    lit_floor()
    ball(material("BsdfGlossy", Color=(0.9, 0.9, 0.9, 1), Roughness=0.0)[0], 0.9, location=(0, 0, 0.9))
    tree, background = sky(0.5)
    texture, turn, coordinates = (tree.nodes.new(f"ShaderNode{name}") for name in ("TexEnvironment", "Mapping", "TexCoord"))
    texture.image, texture.interpolation = hdri(), "Linear"
    turn.inputs["Rotation"].default_value = (0.3, 0.2, 1.1)
    tree.links.new(coordinates.outputs["Generated"], turn.inputs["Vector"])
    tree.links.new(turn.outputs[0], texture.inputs["Vector"])
    tree.links.new(texture.outputs[0], background.inputs["Color"])


@feature(1)
def world_portal():
    """A room whose fourth wall is open; the camera stands in it."""
    plane(diffuse(), 2.0)
    for place, turn in (((0, 1, 1), (math.pi / 2, 0, 0)), ((1, 0, 1), (0, math.pi / 2, 0)), ((-1, 0, 1), (0, math.pi / 2, 0)), ((0, 0, 2), (0, 0, 0))):
        plane(diffuse(), 2.0, location=place, rotation=turn)
    in_front(0.9, 40)
    bpy.context.object.location.z = 1
    sky(1.0, (0.6, 0.8, 1, 1))
    gate = lamp("AREA", 1, location=(0, -1, 1), rotation=(math.pi / 2, 0, 0), shape="SQUARE", size=2.0).data
    target = gate if hasattr(gate, "is_portal") else gate.cycles
    target.is_portal = bpy.context.scene.latent.portals = True


# ----- cameras


@feature(0.5, kind="place")
def camera_perspective():
    four_balls()
    in_front(4)


@feature(0.5, kind="place")
def camera_shift_and_wide():
    four_balls()
    camera = in_front(4)
    camera.data.shift_x, camera.data.shift_y, camera.data.lens = 0.1, -0.05, 42
    bpy.context.scene.render.resolution_x = 96


@feature(0.5, kind="place")
def camera_tall_and_turned():
    four_balls()
    in_front(6).rotation_euler = (1.6, 0.1, 0.02)
    bpy.context.scene.render.resolution_y = 80
    bpy.context.object.data.sensor_fit = "VERTICAL"


@feature(0.5, kind="place")
def camera_orthographic():
    four_balls()
    camera = in_front(4)
    camera.data.type, camera.data.ortho_scale = "ORTHO", 3.0


@feature(0.5, kind="place")
def camera_panorama():
    glow = material("Emission", "Emission", Color=(1, 1, 1, 1), Strength=1.0)[0]
    for x, y, z in ((-2, 2, 1), (2, 1, 1), (-2, 1.5, -1), (1.5, 2, -1.2)):
        ball(glow, 0.3, 32, location=(x, y, z))
    bpy.ops.object.camera_add(rotation=(math.pi / 2, 0, 0))
    camera = bpy.context.scene.camera = bpy.context.object
    camera.data.type = "PANO"
    if hasattr(camera.data, "panorama_type"):
        camera.data.panorama_type = "EQUIRECTANGULAR"
    else:
        camera.data.cycles.panorama_type = "EQUIRECTANGULAR"
    bpy.context.scene.render.resolution_x = 128


@feature(1)
def depth_of_field():
    four_balls()
    camera = in_front(4)
    camera.data.dof.use_dof, camera.data.dof.focus_distance, camera.data.dof.aperture_fstop = True, 3.5, 0.15


@feature(1)
def depth_of_field_blades():
    four_balls()
    camera = in_front(4)
    dof = camera.data.dof
    dof.use_dof, dof.focus_distance, dof.aperture_fstop, dof.aperture_blades, dof.aperture_rotation = True, 3.0, 0.1, 5, 0.3


def move(owner, *places):
    for frame, place in places:
        owner.location = place
        owner.keyframe_insert("location", frame=frame)
    for curve in fcurves(owner):
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"
    bpy.context.scene.frame_set(2)


def fcurves(owner):
    action = owner.animation_data.action
    if hasattr(action, "fcurves"):
        return action.fcurves
    return [curve for layer in action.layers for strip in layer.strips for bag in strip.channelbags for curve in bag.fcurves]


@feature(1)
def motion_of_an_object():
    in_front(5)
    sky(0.2)
    move(ball(diffuse(0.8), 0.4), (1, (-1, 0, 0)), (3, (1, 0, 0.5)))
    bpy.context.scene.render.use_motion_blur, bpy.context.scene.render.motion_blur_shutter = True, 0.5


@feature(1)
def motion_of_one_of_two_objects():
    in_front(5)
    sky(0.2)
    for side in (-0.6, 0.6):
        move(ball(diffuse(0.8), 0.4), (1, (-1, 0, side)), (3, (1, 0, side)))
    bpy.context.object.cycles.use_motion_blur = False
    bpy.context.scene.render.use_motion_blur = True


@feature(1)
def motion_of_the_camera():
    four_balls()
    move(in_front(5), (1, (-0.5, -5, 0)), (3, (0.5, -5, 0)))
    bpy.context.scene.render.use_motion_blur = True


# ----- shapes


@feature(1)
def instances_of_a_collection():
    inner = bpy.data.collections.new("inner")
    ball(diffuse(0.7), 0.3)
    owner = bpy.context.object
    inner.objects.link(owner)
    bpy.context.scene.collection.objects.unlink(owner)
    for i in range(3):
        bpy.ops.object.empty_add(location=(i - 1, 0, 0), rotation=(0, 0.3 * i, 0))
        bpy.context.object.instance_type, bpy.context.object.instance_collection = "COLLECTION", inner
    in_front(4)
    sky(0.5)
    lamp("SUN", 2, angle=0)


@feature(1)
def subdivision_flat_and_curve():
    bpy.ops.mesh.primitive_cube_add(size=1, location=(-0.8, 0, 0))
    put(diffuse(0.7)).modifiers.new("s", "SUBSURF").render_levels = 2
    bpy.ops.mesh.primitive_cube_add(size=0.8, location=(0.8, 0, 0), rotation=(0.4, 0.3, 0.2))
    put(diffuse(0.4))
    bpy.ops.curve.primitive_bezier_circle_add(radius=0.8, location=(0, 0, 0.4), rotation=(1.2, 0, 0))
    bpy.context.object.data.bevel_depth = 0.1
    put(diffuse(0.9))
    in_front(4)
    sky(0.3)
    lamp("SUN", 2, angle=0, rotation=(0.8, 0.3, 0))


@feature(1)
def color_attribute():
    made, tree, node = material("BsdfDiffuse")
    color = tree.nodes.new("ShaderNodeVertexColor")
    color.layer_name = "paint"
    tree.links.new(color.outputs["Color"], node.inputs["Color"])
    owner = ball(made, 1.0, 32)
    layer = owner.data.color_attributes.new("paint", "FLOAT_COLOR", "POINT")
    colors = np.ones((len(owner.data.vertices), 4), np.float32)
    colors[:, :3] = np.random.default_rng(3).random((len(colors), 3))
    layer.data.foreach_set("color", colors.ravel())
    in_front(4.6)
    sky(0.8)


# ----- materials


@feature(2, kind="ball")
def diffuse_color():
    on_show(material("BsdfDiffuse", Color=(0.8, 0.3, 0.1, 1))[0])


@feature(2, kind="ball")
def diffuse_picture():
    made, tree, node = material("BsdfDiffuse")
    with_texture(made, tree, node, "Color")
    on_show(made)


@feature(2, "between texels, Cycles interpolates encoded bytes, Latent light")
def diffuse_picture_enlarged():
    made, tree, node = material("BsdfDiffuse")
    with_texture(made, tree, node, "Color", interpolation="Linear")
    plane(made, 5.0)
    above()
    sky()


@feature(2)
def picture_on_second_uv_map_turned():
    made, tree, node = material("BsdfDiffuse")
    texture = with_texture(made, tree, node, "Color", extension="EXTEND")
    place, turn = tree.nodes.new("ShaderNodeUVMap"), tree.nodes.new("ShaderNodeMapping")
    place.uv_map = "second"
    turn.inputs["Rotation"].default_value, turn.inputs["Scale"].default_value, turn.inputs["Location"].default_value = (0, 0, 0.6), (0.8, 1.2, 1), (0.1, 0.2, 0)
    tree.links.new(place.outputs[0], turn.inputs["Vector"])
    tree.links.new(turn.outputs[0], texture.inputs["Vector"])
    owner = plane(made, 5.0)
    owner.data.uv_layers.new(name="second")
    uv = np.array([[0, 0], [1, 0.2], [0.9, 1], [-0.1, 0.8]], np.float32)
    owner.data.uv_layers["second"].data.foreach_set("uv", uv.ravel())
    above()
    sky()


@feature(2)
def checker_and_mix():
    made, tree, node = material("BsdfDiffuse")
    checker, uv = tree.nodes.new("ShaderNodeTexChecker"), tree.nodes.new("ShaderNodeTexCoord")
    checker.inputs["Color1"].default_value, checker.inputs["Color2"].default_value, checker.inputs["Scale"].default_value = (0.8, 0.1, 0.1, 1), (0.1, 0.2, 0.7, 1), 5
    tree.links.new(uv.outputs["UV"], checker.inputs["Vector"])
    mixture = tree.nodes.new("ShaderNodeMixRGB")
    mixture.inputs[0].default_value, mixture.inputs[2].default_value = 0.3, (0.9, 0.9, 0.2, 1)
    tree.links.new(checker.outputs["Color"], mixture.inputs[1])
    tree.links.new(mixture.outputs[0], node.inputs["Color"])
    plane(made, 5.0)
    above()
    sky()


@feature(2)
def ramp_of_a_picture():
    made, tree, node = material("BsdfDiffuse")
    texture, ramp = with_texture(made, tree, node, "Color", "Non-Color", interpolation="Linear"), tree.nodes.new("ShaderNodeValToRGB")
    ramp.color_ramp.elements[0].color, ramp.color_ramp.elements[1].color = (0.1, 0.5, 0.1, 1), (0.8, 0.6, 0.5, 1)
    tree.links.new(texture.outputs["Color"], ramp.inputs[0])
    tree.links.new(ramp.outputs["Color"], node.inputs["Color"])
    plane(made, 5.0)
    above()
    sky()


@feature(2)
def translucent():
    plane(material("BsdfTranslucent", Color=(0.3, 0.7, 0.2, 1))[0], 3.0)
    above()
    lamp("POINT", 60, location=(0, 0, -1.5), shadow_soft_size=0)


@feature(2, "the reflectance of the weaker colours rises towards the rim", kind="ball")
def glossy_smooth():
    on_show(material("BsdfGlossy", Color=(0.9, 0.6, 0.3, 1), Roughness=0.0)[0])


@feature(2, "the reflectance of the weaker colours rises towards the rim", kind="ball")
def glossy_rough():
    made, _, node = material("BsdfGlossy", Color=(0.9, 0.6, 0.3, 1), Roughness=0.4)
    node.distribution = "GGX"
    on_show(made)


def drawn(of):
    """A ball whose highlight is a line."""
    ball(of)
    in_front(4.6)
    lamp("SUN", 2, angle=0.1, rotation=(0.8, 0.3, 0))


@feature(5, kind="ball")
def glossy_highlight_drawn():
    made, _, node = material("BsdfAnisotropic", Color=(0.9, 0.9, 0.9, 1), Roughness=0.3, Anisotropy=0.6, Rotation=0.1)
    node.distribution = "GGX"
    drawn(made)


@feature(5, kind="ball")
def principled_highlight_drawn():
    drawn(principled(Base_Color=(0.9, 0.9, 0.9, 1), Metallic=1.0, Roughness=0.4, Anisotropic=0.8)[0])


@feature(2, kind="ball")
def glass_smooth():
    on_show(material("BsdfGlass", Color=(1, 1, 1, 1), Roughness=0.0, IOR=1.5)[0])


@feature(2, "" if NEW else "Cycles 3.4 takes Fresnel's reflectance at the surface's normal, 4.3 and Latent at that of each facet", kind="ball")
def glass_rough():
    made, _, node = material("BsdfGlass", Color=(1, 1, 1, 1), Roughness=0.3, IOR=1.5)
    node.distribution = "GGX"
    on_show(made)


@feature(2)
def emission():
    ball(material("Emission", "Emission", Color=(1, 0.5, 0.2, 1), Strength=3.0)[0], 0.4, location=(0, 0, 1))
    lit_floor()


@feature(2)
def emission_picture():
    made, tree, node = material("Emission", "Emission", Strength=3.0)
    with_texture(made, tree, node, "Color", extension="EXTEND")
    plane(made, 1.0, location=(0, 0, 1.5), rotation=(0.4, 0, 0))
    lit_floor()


def mix_of(first, second, fac):
    """A material that mixes two shaders."""
    made, tree, node = material("MixShader", "Shader", Fac=fac)
    for i, shader in enumerate((first, second), 1):
        tree.links.new(tree.nodes.new(f"ShaderNode{shader}").outputs[0], node.inputs[i])
    return made


@feature(2, kind="ball")
def transparent_mix():
    on_show(mix_of("BsdfTransparent", "BsdfDiffuse", 0.3))


@feature(2, kind="ball")
def mix_of_two():
    on_show(mix_of("BsdfDiffuse", "Emission", 0.4), 0.5)


@feature(2, kind="ball")
def mix_within_a_mix():
    made, tree, node = material("MixShader", "Shader", Fac=0.5)
    inner = tree.nodes.new("ShaderNodeMixShader")
    inner.inputs[0].default_value = 0.3
    tree.links.new(inner.outputs[0], node.inputs[1])
    for target, color in ((inner.inputs[1], (0.9, 0.1, 0.1, 1)), (inner.inputs[2], (0.1, 0.1, 0.9, 1)), (node.inputs[2], (0.1, 0.9, 0.1, 1))):
        matt = tree.nodes.new("ShaderNodeBsdfDiffuse")
        matt.inputs["Color"].default_value = color
        tree.links.new(matt.outputs[0], target)
    on_show(made)


@feature(5, "the diffuse part is Lambert's in Latent, Burley's in 3.4", kind="ball")
def principled_plastic():
    on_show(principled(Base_Color=(0.7, 0.1, 0.1, 1), Roughness=0.4)[0])


@feature(5, kind="ball")
def principled_metal():
    on_show(principled(Base_Color=(0.9, 0.6, 0.3, 1), Metallic=1.0, Roughness=0.3)[0])


@feature(5, "the diffuse part is Lambert's in Latent, Burley's in 3.4", kind="ball")
def principled_coat():
    on_show(principled(Base_Color=(0.1, 0.3, 0.7, 1), Clearcoat=1.0, Clearcoat_Roughness=0.05)[0])


@feature(5, kind="ball")
def principled_anisotropic():
    on_show(principled(Base_Color=(0.9, 0.6, 0.3, 1), Metallic=1.0, Roughness=0.4, Anisotropic=0.8)[0])


@feature(2, "Cycles 4 and later give back the light between facets as of the geometric mean of both alphas" if NEW else "", kind="ball")
def glossy_anisotropic():
    on_show(material("BsdfGlossy" if NEW else "BsdfAnisotropic", Color=(0.9, 0.6, 0.3, 1), Roughness=0.4, Anisotropy=0.6)[0])


@feature(5, kind="ball")
def principled_glass():
    on_show(principled(Base_Color=(1, 1, 1, 1), Transmission=1.0, Roughness=0.0, IOR=1.45)[0])


@feature(5, "light that passes coloured glass several times has a spectrum, not three numbers", kind="ball")
def principled_glass_coloured():
    on_show(principled(Base_Color=(0.8, 0.5, 0.3, 1), Transmission=1.0, Roughness=0.0, IOR=1.45)[0])


@feature(5, "light that passes coloured glass several times has a spectrum, not three numbers", kind="ball")
def principled_partly_glass():
    on_show(principled(Base_Color=(0.9, 0.5, 0.3, 1), Transmission=0.6, Roughness=0.2, IOR=1.45)[0])


@feature(5, kind="ball")
def principled_metal_and_glass():
    on_show(principled(Base_Color=(0.9, 0.6, 0.3, 1), Metallic=0.5, Transmission=0.8, Roughness=0.2)[0])


def between_facets(name, **inputs):
    """With light that goes from facet to facet."""

    def build():
        made, _, node = principled(**inputs)
        node.distribution = "MULTI_GGX"
        on_show(made)

    build.__name__ = f"between_facets_{name}"
    feature(5, "what several facets reflect or refract has another lobe", kind="ball")(build)


for tenths in (3, 6, 10):
    between_facets(f"metal_{tenths / 10}", Base_Color=(0.9, 0.6, 0.3, 1), Metallic=1.0, Roughness=tenths / 10)
for tenths in (3, 8):
    between_facets(f"glass_{tenths / 10}", Base_Color=(1, 1, 1, 1), Transmission=1.0, Roughness=tenths / 10, IOR=1.45)


@feature(5, "the diffuse part is Lambert's in Latent, Burley's in 3.4", kind="ball")
def principled_alpha():
    on_show(principled(Base_Color=(0.2, 0.5, 0.3, 1), Alpha=0.5, Specular=0.0)[0])


@feature(5, kind="ball")
def principled_alpha_of_an_opaque_picture():
    made, tree, node = principled(Roughness=0.6, Specular=0.0)
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image, texture.interpolation = picture_image(), "Closest"
    tree.links.new(texture.outputs["Color"], node.inputs["Base Color"])
    tree.links.new(texture.outputs["Alpha"], node.inputs["Alpha"])
    on_show(made)


@feature(5, "bumps are of different heights at the scale of a texel")
def bump():
    made, tree, node = material("BsdfDiffuse")
    relief, texture = tree.nodes.new("ShaderNodeBump"), tree.nodes.new("ShaderNodeTexImage")
    texture.image = picture_image("Non-Color", 16, 5)
    relief.inputs["Distance"].default_value = 0.05
    tree.links.new(texture.outputs["Color"], relief.inputs["Height"])
    tree.links.new(relief.outputs[0], node.inputs["Normal"])
    plane(made, 5.0)
    above()
    lamp("SUN", 2, angle=0, rotation=(0.7, 0, 0))


@feature(5)
def normal_map():
    made, tree, node = material("BsdfDiffuse")
    relief, texture = tree.nodes.new("ShaderNodeNormalMap"), tree.nodes.new("ShaderNodeTexImage")
    image = texture.image = bpy.data.images.new("normals", 32, 32)
    image.colorspace_settings.name = "Non-Color"
    values = np.ones((32, 32, 4), np.float32)
    x = np.arange(32) / 32 * 2 * np.pi
    values[..., 0], values[..., 1] = 0.5 + 0.3 * np.sin(2 * x)[None, :], 0.5 + 0.2 * np.sin(x)[:, None]
    image.pixels.foreach_set(values.ravel())
    image.update()
    tree.links.new(texture.outputs["Color"], relief.inputs["Color"])
    tree.links.new(relief.outputs[0], node.inputs["Normal"])
    plane(made, 5.0)
    above()
    lamp("SUN", 2, angle=0, rotation=(0.7, 0.3, 0))


@feature(2, kind="ball")
def volume_absorption():
    made, tree, node = material("VolumeAbsorption", "Volume", Color=(0.8, 0.4, 0.2, 1), Density=0.8)
    tree.links.remove(tree.nodes["Material Output"].inputs["Surface"].links[0])
    tree.links.new(node.outputs[0], tree.nodes["Material Output"].inputs["Volume"])
    on_show(made)


@feature(2, kind="ball")
def volume_scatter():
    made, tree, node = material("VolumeScatter", "Volume", Color=(0.8, 0.6, 0.4, 1), Density=1.5, Anisotropy=0.3)
    tree.links.remove(tree.nodes["Material Output"].inputs["Surface"].links[0])
    tree.links.new(node.outputs[0], tree.nodes["Material Output"].inputs["Volume"])
    on_show(made)


CLOUD = """import sys
import numpy as np
import pyopenvdb
x, y, z = (np.mgrid[:40, :40, :40] - 19.5) / 20
grid = pyopenvdb.FloatGrid()
grid.copyFromArray(np.maximum(0, 1 - x**2 - (y - 0.2 * z) ** 2 - z**2).astype(np.float32))
grid.name, grid.gridClass = "density", pyopenvdb.GridClass.FOG_VOLUME
grid.transform = pyopenvdb.createLinearTransform(voxelSize=0.05)
pyopenvdb.write(sys.argv[1], grids=[grid])
"""


@feature(2, "" if NEW else "Cycles 3.4 places voxels half a voxel aside", kind="ball")
def volume_of_voxels():
    path = bpy.context.scene.latent.folder + "/cloud.vdb"
    os.makedirs(os.path.dirname(path), exist_ok=True)
    subprocess.run(["/usr/bin/python3", "-c", CLOUD, path], check=True)  # Debian's module is for Debian's Python
    bpy.ops.object.volume_import(filepath=path, location=(-1, -1, -1))
    made, tree, node = material("VolumePrincipled", "Volume", Color=(0.6, 0.6, 0.6, 1), Density=3.0, Anisotropy=0.3)
    tree.links.remove(tree.nodes["Material Output"].inputs["Surface"].links[0])
    tree.links.new(node.outputs[0], tree.nodes["Material Output"].inputs["Volume"])
    put(made)
    in_front(4.6)
    sky(0.02)
    lamp("SUN", 2, angle=0, rotation=(0.8, 0.3, 0))
    bpy.context.scene.cycles.volume_step_rate = 0.2


@feature(10, "Latent's wanders below a surface; Cycles' has none", kind="ball")
def subsurface():
    made, tree, node = material("SubsurfaceScattering", "BSSRDF", Color=(0.8, 0.5, 0.3, 1), Scale=0.1)
    on_show(made)


@feature(10, "hair of other models: Latent's is [Chiang16], seen as round tubes")
def hair():
    owner = ball(diffuse(0.3), 0.6, 16)
    bpy.ops.object.particle_system_add()
    settings = owner.particle_systems[0].settings
    settings.type, settings.count, settings.hair_length, settings.root_radius, settings.tip_radius = "HAIR", 800, 0.5, 2.0, 1.0
    settings.radius_scale = 0.01
    owner.data.materials.append(material("BsdfHairPrincipled", Color=(0.6, 0.3, 0.1, 1))[0])
    settings.material = 2
    in_front(4.6)
    sky(0.7)


# ----- renders


def centroids(picture):
    """Of the light in each quarter."""
    height, width = picture.shape[:2]
    y, x = np.mgrid[:height, :width]
    grey = picture.mean(2)
    found = []
    for rows in (slice(0, height // 2), slice(height // 2, height)):
        for columns in (slice(0, width // 2), slice(width // 2, width)):
            part = grey[rows, columns]
            found.append(((x[rows, columns] * part).sum() / part.sum(), (y[rows, columns] * part).sum() / part.sum()))
    return np.array(found)


def compare(name, folder, samples):
    build, within, why, kind = FEATURES[name]
    start(samples, folder / "jobs")
    build()
    ours, seconds = shot("LATENT", folder / f"{name}.latent.exr")
    theirs, cycles_seconds = shot("CYCLES", folder / f"{name}.cycles.exr")
    if kind == "ball":
        y, x = np.mgrid[:SIZE, :SIZE] - (SIZE - 1) / 2
        ours, theirs = (picture * (np.hypot(x, y) < 0.3 * SIZE)[..., None] for picture in (ours, theirs))
    error = float(np.abs(centroids(ours) - centroids(theirs)).max()) if kind == "place" else float(100 * (ours.mean() / theirs.mean() - 1))
    height, width = ours.shape[:2]
    blocks = [p[: height // 8 * 8, : width // 8 * 8].reshape(height // 8, 8, width // 8, 8, 3).mean((1, 3)) for p in (ours, theirs)]
    lit = blocks[1].mean(2) > 0.05 * blocks[1].mean()
    spread = float(100 * np.median(np.abs(blocks[0].mean(2) / np.maximum(blocks[1].mean(2), 1e-9) - 1)[lit]))
    return {"name": name, "error": error, "within": within, "kind": kind, "blocks": spread, "why": why, "seconds": seconds, "cycles": cycles_seconds,
            "lost": list(latent_render.engine.last["lost"])}


def main():
    folder, samples, *names = (sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:])
    folder = pathlib.Path(folder)
    os.makedirs(folder, exist_ok=True)
    for name in names or FEATURES:
        result = compare(name, folder, int(samples))
        side_by_side(folder, name)
        print("RESULT " + json.dumps(result), flush=True)


if __name__ == "__main__":
    main()
    latent_render.unregister()
    end()
