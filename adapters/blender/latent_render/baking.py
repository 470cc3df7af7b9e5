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
    lines = []
    for node in tree.nodes:
        values = {}
        for name, property in node.bl_rna.properties.items():
            if property.type in ("FLOAT", "INT", "BOOLEAN", "ENUM", "STRING") and not name.startswith(("location", "select", "width", "height", "show_", "ui_", "bl_")):
                value = getattr(node, name)
                values[name] = list(value) if hasattr(value, "__len__") and not isinstance(value, (str, set)) else str(value)
        inputs = [(s.identifier, list(s.default_value) if hasattr(s.default_value, "__len__") and not isinstance(s.default_value, str) else str(s.default_value))
                  for s in node.inputs if hasattr(s, "default_value")]
        outputs = [str(list(s.default_value) if hasattr(s.default_value, "__len__") and not isinstance(s.default_value, str) else s.default_value)
                   for s in node.outputs if hasattr(s, "default_value")]
        image = getattr(node, "image", None)
        lines.append(str((node.name, node.type, sorted(values.items(), key=str), inputs, outputs, image.filepath if image else "", image.name if image else "")))
        inner = getattr(node, "node_tree", None)
        if inner and inner.name not in seen:
            lines.append(fingerprint(inner, (*seen, inner.name)))
    lines += sorted(f"{link.from_node.name}.{link.from_socket.identifier}>{link.to_node.name}.{link.to_socket.identifier}" for link in tree.links)
    return "\n".join(lines)


def world(of, folder, width=1024, samples=16):
    """The path of a picture of a world, or None if it could not be made. It is made once for the same nodes."""
    of = of.original
    name = hashlib.blake2b(f"{width} {samples} {fingerprint(of.node_tree)}".encode(), digest_size=12).hexdigest()
    folder = os.path.join(folder, "pictures")
    path = os.path.join(folder, f"world-{name}.exr")
    if os.path.exists(path):
        return path
    os.makedirs(folder, exist_ok=True)
    library, job = os.path.join(folder, "world.blend"), os.path.join(folder, "world.json")
    bpy.data.libraries.write(library, {of}, fake_user=True)
    with open(job, "w") as file:
        json.dump({"library": library, "world": of.name, "output": path, "width": width, "samples": samples}, file)
    done = subprocess.run(command(job), stdin=subprocess.DEVNULL, capture_output=True, text=True)
    for made in (library, job):
        os.remove(made)
    if done.returncode or not os.path.exists(path):
        print(done.stdout[-2000:], done.stderr[-2000:])
        return None
    return path
