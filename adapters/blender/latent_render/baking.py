"""What Latent cannot say, as pictures: another Blender renders them with Cycles. It runs this file, too, with the name of a JSON file:

{"library": FILE.blend, "world": NAME, "output": FILE.exr, "width": W, "samples": N}: a world as a picture in longitude and latitude.
{"library": FILE.blend, "object": NAME, "material": NAME, "tasks": [[NODE, OUTPUT, FILE.pfm], ...], "side": W, "samples": N}: values of nodes
over the UV map of an object.
"""
import hashlib
import json
import os
import subprocess
import sys

import bpy
import numpy as np


def fingerprint(tree, seen=()):
    """Everything in a node tree that decides its picture, as text."""
    plain = lambda value: list(value) if hasattr(value, "__len__") and not isinstance(value, (str, set)) else str(value)  # noqa: E731
    lines = []
    for node in tree.nodes:
        values = {name: plain(getattr(node, name)) for name, property in node.bl_rna.properties.items()
                  if property.type in ("FLOAT", "INT", "BOOLEAN", "ENUM", "STRING")
                  and not name.startswith(("location", "select", "width", "height", "show_", "ui_", "bl_"))}
        sockets = [(socket.identifier, plain(socket.default_value)) for socket in (*node.inputs, *node.outputs) if hasattr(socket, "default_value")]
        image = getattr(node, "image", None)
        lines.append(str((node.name, node.type, sorted(values.items(), key=str), sockets, image.filepath if image else "", image.name if image else "")))
        inner = getattr(node, "node_tree", None)
        if inner and inner.name not in seen:
            lines.append(fingerprint(inner, (*seen, inner.name)))
    lines += sorted(f"{link.from_node.name}.{link.from_socket.identifier}>{link.to_node.name}.{link.to_socket.identifier}" for link in tree.links)
    return "\n".join(lines)


def named(folder, kind, tree, *facts):
    """The path of a picture. Other nodes have another one."""
    digest = hashlib.blake2b(f"{facts} {fingerprint(tree)}".encode(), digest_size=12).hexdigest()
    return os.path.join(folder, f"{kind}-{digest}{'.exr' if kind == 'world' else '.pfm'}")


def run(folder, block, **job):
    """Gives a data block to another Blender: whether it succeeded."""
    library, path = os.path.join(folder, "bake.blend"), os.path.join(folder, "bake.json")
    os.makedirs(folder, exist_ok=True)
    bpy.data.libraries.write(library, {block}, fake_user=True)
    with open(path, "w") as file:
        json.dump({"library": library, **job}, file)
    blender = [bpy.app.binary_path, "-b", "--factory-startup", "-noaudio", "--python-exit-code", "1", "--python", __file__, "--"]
    command = blender if bpy.app.binary_path else [sys.executable, __file__]
    done = subprocess.run([*command, path], stdin=subprocess.DEVNULL, capture_output=True, text=True)
    for made in (library, path):
        os.remove(made)
    if done.returncode:
        print(done.stdout[-2000:], done.stderr[-2000:])
    return done.returncode == 0


def world(of, folder, width=2048, samples=4):
    """The path of a picture of a world, or None if it could not be made. It is made once for the same nodes."""
    of, folder = of.original, os.path.join(folder, "pictures")
    path = named(folder, "world", of.node_tree, width, samples)
    if not os.path.exists(path):
        run(folder, of, world=of.name, output=path, width=width, samples=samples)
    return path if os.path.exists(path) else None


def path_of(folder, material, node, output):
    """Where the picture of a node's output is, once it is baked."""
    return named(folder, "baked", material.node_tree, material.name, node, output)


def nodes(scene, wanted, folder, side=512):
    """Bakes (material, node, output), each on the first mesh with a UV map that has the material: how many, and names of those that failed."""
    folder, failed, made = os.path.join(folder, "pictures"), [], 0
    for name in sorted({material for material, _, _ in wanted}):
        material = bpy.data.materials.get(name)
        owner = next((o for o in scene.objects if o.type == "MESH" and o.data.uv_layers and material in [slot.material for slot in o.material_slots]), None)
        tasks = [(node, output, path_of(folder, material, node, output)) for of, node, output in wanted if of == name]
        if owner and run(folder, owner, object=owner.name, material=name, tasks=tasks, side=side, samples=16):
            made += len(tasks)
        else:
            failed.append(name)
    return made, failed


# ----- in the other Blender


def loaded(job, kind):
    """The data block of a job. All of its Light Path is 0: the picture is for what lights the scene, not what the camera sees."""
    with bpy.data.libraries.load(job["library"]) as (_, here):
        setattr(here, kind + "s", [job[kind]])
    for tree in (*(of.node_tree for of in (*bpy.data.worlds, *bpy.data.materials) if of.node_tree), *bpy.data.node_groups):
        zero = tree.nodes.new("ShaderNodeValue").outputs[0]
        zero.default_value = 0
        for target in [link.to_socket for link in tree.links if link.from_node.type == "LIGHT_PATH"]:
            tree.links.new(zero, target)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device, scene.cycles.samples, scene.cycles.use_denoising = "CPU", job["samples"], False
    return scene, getattr(here, kind + "s")[0]


def bake_world(job):
    scene, world = loaded(job, "world")
    for thing in list(scene.objects):
        bpy.data.objects.remove(thing)
    data = bpy.data.cameras.new("bake")
    data.type = "PANO"
    (data if hasattr(data, "panorama_type") else data.cycles).panorama_type = "EQUIRECTANGULAR"
    owner = bpy.data.objects.new("bake", data)
    owner.rotation_euler = (1.5707963267948966, 0, -1.5707963267948966)  # along +x, where the middle of Blender's pictures is
    scene.collection.objects.link(owner)
    scene.world, scene.camera, render = world, owner, scene.render
    render.filepath, render.resolution_x, render.resolution_y, render.resolution_percentage = job["output"], job["width"], job["width"] // 2, 100
    render.image_settings.file_format, render.image_settings.color_depth, render.image_settings.color_mode = "OPEN_EXR", "32", "RGB"
    scene.cycles.use_adaptive_sampling, scene.cycles.pixel_filter_type = False, "BOX"
    bpy.ops.render.render(write_still=True)


def bake_nodes(job):
    scene, owner = loaded(job, "object")
    scene.collection.objects.link(owner)
    owner.hide_render = False
    bpy.context.view_layer.objects.active = owner
    owner.select_set(True)
    scene.render.bake.margin = 4
    for node, output, path in job["tasks"]:
        image = bpy.data.images.new("baked", job["side"], job["side"], float_buffer=True)
        for material in {slot.material for slot in owner.material_slots if slot.material and slot.material.node_tree}:
            tree = material.node_tree
            target = tree.nodes.new("ShaderNodeTexImage")  # each needs an image to be baked into
            target.image, tree.nodes.active = image, target
            if material.name == job["material"]:
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
