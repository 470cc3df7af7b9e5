"""What Latent cannot say, as pictures: another Blender renders them with Cycles."""
import hashlib
import json
import os
import subprocess
import sys

import bpy

HERE = os.path.dirname(os.path.abspath(__file__))


def command(job):
    script = os.path.join(HERE, "bake.py")
    if bpy.app.binary_path:
        return [bpy.app.binary_path, "-b", "--factory-startup", "-noaudio", "--python-exit-code", "1", "--python", script, "--", job]
    return [sys.executable, script, job]


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


def run(folder, name, blocks, **job):
    """Gives data blocks to bake.py in a file: whether it succeeded."""
    library, path = os.path.join(folder, f"{name}.blend"), os.path.join(folder, f"{name}.json")
    os.makedirs(folder, exist_ok=True)
    bpy.data.libraries.write(library, set(blocks), fake_user=True)
    with open(path, "w") as file:
        json.dump({"library": library, **job}, file)
    done = subprocess.run(command(path), stdin=subprocess.DEVNULL, capture_output=True, text=True)
    for made in (library, path):
        os.remove(made)
    if done.returncode:
        print(done.stdout[-2000:], done.stderr[-2000:])
    return done.returncode == 0


def world(of, folder, width=2048, samples=4):
    """The path of a picture of a world, or None if it could not be made. It is made once for the same nodes."""
    of, folder = of.original, os.path.join(folder, "pictures")
    name = hashlib.blake2b(f"{width} {samples} {fingerprint(of.node_tree)}".encode(), digest_size=12).hexdigest()
    path = os.path.join(folder, f"world-{name}.exr")
    if not os.path.exists(path):
        run(folder, "world", [of], world=of.name, output=path, width=width, samples=samples)
    return path if os.path.exists(path) else None


def path_of(folder, material, node, output):
    """Where the picture of a node's output is, once it is baked. Another one belongs to other nodes."""
    name = hashlib.blake2b(f"{material.name} {node} {output} {fingerprint(material.node_tree)}".encode(), digest_size=12).hexdigest()
    return os.path.join(folder, f"baked-{name}.pfm")


def nodes(scene, wanted, folder, side=512):
    """Bakes (material, node, output), each on the first mesh with a UV map that has the material: how many, and names of those that failed."""
    folder, failed, made = os.path.join(folder, "pictures"), [], 0
    for name in sorted({material for material, _, _ in wanted}):
        material = bpy.data.materials.get(name)
        owner = next((o for o in scene.objects if o.type == "MESH" and o.data.uv_layers and material in [slot.material for slot in o.material_slots]), None)
        tasks = [(node, output, path_of(folder, material, node, output)) for of, node, output in wanted if of == name]
        if owner is None or not run(folder, "nodes", [owner], object=owner.name, material=name, tasks=tasks, side=side):
            failed.append(name)
        else:
            made += len(tasks)
    return made, failed
