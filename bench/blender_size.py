"""Exports much: run by bench/blender inside Blender. blender -b --python bench/blender_size.py -- FOLDER nothing|instances|triangles"""
import json
import pathlib
import shutil
import sys
import time

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import bpy  # noqa: E402
import numpy as np  # noqa: E402
from blender_parts import above, ball, diffuse, end, material, start, with_texture  # noqa: E402
from latent_render import engine  # noqa: E402

folder, what = (sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:])
folder = pathlib.Path(folder) / what
shutil.rmtree(folder, ignore_errors=True)
scene = start(1, folder)
scene.render.engine = "LATENT"
above()


def grid(side, height):
    """A mesh of side x side vertices."""
    x, y = np.meshgrid(np.linspace(-2, 2, side, dtype=np.float32), np.linspace(-2, 2, side, dtype=np.float32))
    corner = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)[None]).ravel()
    faces = np.stack([corner, corner + 1, corner + side + 1, corner + side], 1).astype(np.int32)
    made = bpy.data.meshes.new("grid")
    made.vertices.add(side * side)
    made.vertices.foreach_set("co", np.stack([x, y, height(x, y)], -1).ravel())
    made.loops.add(faces.size)
    made.loops.foreach_set("vertex_index", faces.ravel())
    made.polygons.add(len(faces))
    made.polygons.foreach_set("loop_start", np.arange(0, faces.size, 4, dtype=np.int32))
    made.polygons.foreach_set("loop_total", np.full(len(faces), 4, np.int32))
    made.polygons.foreach_set("use_smooth", np.ones(len(faces), bool))
    made.update(calc_edges=True)
    made.uv_layers.new(name="UVMap")
    uv = np.stack([x, y], -1).reshape(-1, 2)[faces.ravel()]
    made.uv_layers[0].data.foreach_set("uv", uv.ravel())
    owner = bpy.data.objects.new("grid", made)
    scene.collection.objects.link(owner)
    return owner


if what == "instances":
    ball(diffuse(), 0.001, 8)
    child = bpy.context.object
    owner = grid(1000, lambda x, y: 0 * x)
    child.parent, owner.instance_type = owner, "VERTS"
    count = "1000000 instances"
elif what == "triangles":
    owner = grid(1582, lambda x, y: 0.1 * np.sin(20 * x) * np.sin(20 * y))
    made, tree, node = material("BsdfDiffuse")
    with_texture(made, tree, node, "Color")
    owner.data.materials.append(made)
    count = f"{2 * 1581 * 1581} triangles with normals and texture coordinates"
else:
    count = "nothing"


def only_export(*_words, **_more):
    raise engine.tools.Failure("exported")


engine.tools.run = only_export
begin = time.monotonic()
try:
    bpy.ops.render.render()
except RuntimeError as failure:
    assert "exported" in str(failure), failure
seconds = time.monotonic() - begin
size = sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())
print("RESULT " + json.dumps({"count": count, "seconds": seconds, "bytes": size}), flush=True)
end()
