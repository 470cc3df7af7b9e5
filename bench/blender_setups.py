"""Five larger scenes, made after common tutorials, rendered by Latent's add-on and by Cycles: run by bench/blender inside Blender.

    blender -b --factory-startup --python bench/blender_setups.py -- FOLDER SAMPLES [NAME...]
"""
import json
import math
import os
import pathlib
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import bpy  # noqa: E402
from blender_parts import ball, end, in_front, lamp, material, plane, principled, put, shot, side_by_side, sky, socket, start  # noqa: E402
import latent_render  # noqa: E402
import numpy as np  # noqa: E402

WIDTH, HEIGHT = 192, 144


def look(camera, target):
    from mathutils import Vector

    direction = Vector(target) - camera.location
    camera.rotation_euler = direction.to_track_quat("-Z", "Y").to_euler()


def product():
    """A bottle-like body of three materials on a sweep, lit by two softboxes and a rim light."""
    points, faces = [], []
    profile = [(-5.0, 0.0), *((1.5 + 1.5 * math.sin(a), 1.5 - 1.5 * math.cos(a)) for a in np.linspace(0, math.pi / 2, 12)), (3.0, 6.0)]
    for y, z in profile:
        points += [(-6, y, z), (6, y, z)]
    for i in range(len(profile) - 1):
        faces.append((2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2))
    sweep = bpy.data.meshes.new("sweep")
    sweep.from_pydata(points, [], faces)
    for polygon in sweep.polygons:
        polygon.use_smooth = True
    owner = bpy.data.objects.new("sweep", sweep)
    bpy.context.scene.collection.objects.link(owner)
    sweep.materials.append(principled(Base_Color=(0.8, 0.8, 0.8, 1), Roughness=0.6)[0])
    bpy.ops.mesh.primitive_cylinder_add(vertices=64, radius=0.5, depth=1.4, location=(0, 0, 0.7))
    body = put(principled(Base_Color=(0.05, 0.15, 0.4, 1), Roughness=0.3, Clearcoat=1.0)[0])
    body.modifiers.new("bevel", "BEVEL").width = 0.06
    for polygon in body.data.polygons:
        polygon.use_smooth = abs(polygon.normal.z) < 0.5
    bpy.ops.mesh.primitive_cylinder_add(vertices=64, radius=0.25, depth=0.3, location=(0, 0, 1.55))
    put(principled(Base_Color=(0.9, 0.75, 0.4, 1), Metallic=1.0, Roughness=0.2)[0])
    ball(principled(Base_Color=(0.7, 0.05, 0.05, 1), Roughness=0.15)[0], 0.3, location=(0.9, -0.4, 0.3))
    lamp("AREA", 250, (-3, -2, 3), (0.8, 0, -0.9), shape="RECTANGLE", size=1.5, size_y=2.5)
    lamp("AREA", 120, (3, -2, 2.5), (0.9, 0, 0.9), shape="SQUARE", size=1.2)
    lamp("AREA", 80, (0, 2, 3.5), (-0.6, 0, 0), shape="DISK", size=0.6)
    sky(0.05)
    camera = in_front(4.5, 50, 1.6)
    look(camera, (0.1, 0, 0.8))
    dof = camera.data.dof
    dof.use_dof, dof.focus_distance, dof.aperture_fstop = True, 4.5, 1.4


def interior():
    """A room with a window that a sky and a sun light."""
    white, wood = principled(Base_Color=(0.75, 0.73, 0.7, 1), Roughness=0.9, Specular=0.2)[0], principled(Base_Color=(0.35, 0.2, 0.1, 1), Roughness=0.4)[0]
    plane(wood, 4.0)
    plane(white, 4.0, location=(0, 0, 2.6))
    plane(white, 4.0, location=(0, 2, 1.3), rotation=(math.pi / 2, 0, 0))
    plane(white, 4.0, location=(2, 0, 1.3), rotation=(0, math.pi / 2, 0))
    plane(white, 4.0, location=(0, -2, 1.3), rotation=(math.pi / 2, 0, 0))
    for low, high, left, right in ((0, 0.8, -2, 2), (2.1, 2.6, -2, 2), (0.8, 2.1, -2, -0.8), (0.8, 2.1, 0.8, 2)):  # around the window
        bpy.ops.mesh.primitive_cube_add(size=1, location=(-2, (left + right) / 2, (low + high) / 2))
        put(white).scale = (0.1, right - left, high - low)
    bpy.ops.mesh.primitive_cube_add(size=0.7, location=(0.8, 0.9, 0.35), rotation=(0, 0, 0.4))
    put(principled(Base_Color=(0.2, 0.4, 0.3, 1), Roughness=0.5)[0])
    ball(principled(Base_Color=(0.9, 0.9, 0.9, 1), Metallic=1.0, Roughness=0.05)[0], 0.35, location=(0, 0.4, 0.35))
    sky(2.0, (0.5, 0.7, 1.0, 1))
    lamp("SUN", 8, rotation=(0, -1.0, 0.25), angle=0.01)
    camera = in_front(1.8, 22, 1.4)
    camera.location = (1.2, -1.8, 1.4)
    look(camera, (-0.4, 0.9, 0.8))


def glass():
    """Glass that throws caustics, by bidirectional path tracing; Cycles finds them by chance on a lamp of some size."""
    plane(principled(Base_Color=(0.7, 0.7, 0.72, 1), Roughness=0.7)[0], 10.0)
    ball(material("BsdfGlass", Color=(1, 1, 1, 1), Roughness=0.0, IOR=1.5)[0], 0.5, location=(-0.5, 0, 0.5))
    bpy.ops.mesh.primitive_torus_add(major_radius=0.45, minor_radius=0.16, major_segments=64, minor_segments=32, location=(0.7, 0.2, 0.16))
    for polygon in bpy.context.object.data.polygons:
        polygon.use_smooth = True
    put(material("BsdfGlass", Color=(0.6, 0.9, 0.7, 1), Roughness=0.0, IOR=1.5)[0])
    lamp("POINT", 150, (1.5, 1.5, 2.5), shadow_soft_size=0.15)
    sky(0.15)
    bpy.context.scene.latent.integrator = "BDPT"
    camera = in_front(3.5, 50, 1.8)
    look(camera, (0, 0, 0.25))


def hair():
    """A head of dark hair under a key light."""
    owner = ball(principled(Base_Color=(0.6, 0.4, 0.3, 1), Roughness=0.6)[0], 0.6, 24)
    bpy.ops.object.particle_system_add()
    settings = owner.particle_systems[0].settings
    settings.type, settings.count, settings.hair_length, settings.root_radius, settings.tip_radius = "HAIR", 3000, 0.35, 1.0, 0.4
    settings.radius_scale, settings.brownian_factor = 0.01, 0.05
    owner.data.materials.append(material("BsdfHairPrincipled", Color=(0.25, 0.1, 0.04, 1), Roughness=0.25, Radial_Roughness=0.3)[0])
    settings.material = 2
    lamp("AREA", 60, (-1.5, -2, 2), (0.8, 0, -0.6), shape="SQUARE", size=0.5)
    lamp("AREA", 40, (1.5, 1.5, 1.5), (-0.9, 0.6, 0), shape="SQUARE", size=0.5)
    sky(0.2)
    in_front(3.6)


def car_paint():
    """Lacquer over flakes, as a mixture of Principled BSDFs, under a sky that is baked."""
    made, tree, mixture = material("MixShader", "Shader", Fac=0.35)
    for place, values in ((1, {"Base Color": (0.4, 0.01, 0.02, 1), "Metallic": 0.0, "Roughness": 0.4}), (2, {"Base Color": (0.7, 0.15, 0.1, 1), "Metallic": 1.0, "Roughness": 0.35})):
        node = tree.nodes.new("ShaderNodeBsdfPrincipled")
        coat = "Coat Weight" if "Coat Weight" in node.inputs else "Clearcoat"
        for name, value in {**values, coat: 1.0}.items():
            socket(node, name).default_value = value
        tree.links.new(node.outputs[0], mixture.inputs[place])
    bpy.ops.mesh.primitive_monkey_add(rotation=(0, 0, 0.4), location=(0, 0, 0.9))
    for polygon in bpy.context.object.data.polygons:
        polygon.use_smooth = True
    put(made).modifiers.new("s", "SUBSURF").render_levels = 2
    plane(principled(Base_Color=(0.2, 0.2, 0.2, 1), Roughness=0.3)[0], 12.0)
    tree, background = sky(0.15)
    texture = tree.nodes.new("ShaderNodeTexSky")
    texture.sun_disc, texture.sun_elevation = False, 0.5
    tree.links.new(texture.outputs[0], background.inputs["Color"])
    lamp("SUN", 2, rotation=(0.7, 0.4, 0.3), angle=0.02)
    camera = in_front(4.2, 50, 1.6)
    look(camera, (0, 0, 0.8))


SETUPS = {build.__name__: build for build in (product, interior, glass, hair, car_paint)}


def main():
    folder, samples, *names = (sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:])
    folder = pathlib.Path(folder)
    os.makedirs(folder, exist_ok=True)
    for name in names or SETUPS:
        start(int(samples), folder / "jobs", WIDTH, HEIGHT)
        SETUPS[name]()
        ours, seconds = shot("LATENT", folder / f"{name}.latent.exr")
        lost = list(latent_render.engine.last["lost"])
        theirs, cycles_seconds = shot("CYCLES", folder / f"{name}.cycles.exr")
        side_by_side(folder, name, 2)
        blocks = [(p @ [0.2126, 0.7152, 0.0722]).reshape(HEIGHT // 16, 16, WIDTH // 16, 16).mean((1, 3)) for p in (ours, theirs)]  # single specks count little
        print("RESULT " + json.dumps({"name": name, "error": 100 * float(np.median(blocks[0] / blocks[1]) - 1), "seconds": seconds,
                                      "cycles": cycles_seconds, "lost": lost, "picture": str(folder / f"{name}.png")}), flush=True)
    latent_render.unregister()
    end()


if __name__ == "__main__":
    main()
