"""Meshes as binary PLY files, named by their content. Needs numpy, which Blender has, but no Blender."""
import glob
import hashlib
import os

import numpy as np


def shared(columns):
    """Corners of equal values become one vertex. `columns`: arrays of one row for each corner.
    Returns the corner that stands for each vertex, and the vertex of each corner."""
    keys = [np.ascontiguousarray(column).reshape(len(column), -1) for column in columns]
    # Bytes as integers: exact, and quick to compare. Minus zero counts as zero.
    words = np.concatenate([(key + 0.0).astype("<f4").view("<u4") if key.dtype.kind == "f" else key.astype("<u4") for key in keys], 1)
    order = np.lexsort(words.T[::-1])
    ranked = words[order]
    first = np.ones(len(order), bool)
    first[1:] = (ranked[1:] != ranked[:-1]).any(1)
    vertex = np.empty(len(order), np.int32)
    vertex[order] = np.cumsum(first, dtype=np.int32) - 1
    return order[first], vertex


NOISE = 1e-6  # Blender 3.4 adds up the normals of a vertex in an order that changes


def write(folder, positions, triangles, normals=None, uvs=None, colors=None):
    """Writes a mesh to a file in `folder` that its content names, unless it is there: returns its name. One row for each vertex; triangles hold
    three numbers of vertices. Normals that differ by no more than NOISE are the same: otherwise, an unchanged scene would be another job."""
    columns = [("x y z", positions), ("nx ny nz", normals), ("u v", uvs), ("red green blue", colors)]
    fields = [(name, data[:, i]) for names, data in columns if data is not None for i, name in enumerate(names.split())]
    vertices = np.empty(len(positions), [(name, "<f4") for name, _ in fields])
    for name, data in fields:
        vertices[name] = data
    faces = np.empty(len(triangles), [("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, triangles
    head = ["ply", "format binary_little_endian 1.0", f"element vertex {len(vertices)}", *(f"property float {name}" for name, _ in fields),
            f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header", ""]
    head, turned = "\n".join(head).encode(), [name for name, _ in fields if name.startswith("n")]
    digest = hashlib.blake2b(head, digest_size=12)
    for name, data in fields:
        if name not in turned:
            digest.update(np.ascontiguousarray(data, "<f4"))
    digest.update(faces.tobytes())
    stem = os.path.join(folder, digest.hexdigest())
    for path in sorted(glob.glob(glob.escape(stem) + "*.ply")):
        known = np.fromfile(path, vertices.dtype, len(vertices), offset=len(head))
        if all(np.abs(known[name] - vertices[name]).max(initial=0) <= NOISE for name in turned):
            return os.path.basename(path)
    of_normals = hashlib.blake2b(b"".join(np.ascontiguousarray(vertices[name]) for name in turned), digest_size=6).hexdigest()
    path = f"{stem}-{of_normals}.ply"
    os.makedirs(folder, exist_ok=True)
    with open(path + ".unfinished", "wb") as file:
        for piece in (head, vertices.tobytes(), faces.tobytes()):
            file.write(piece)
    os.replace(path + ".unfinished", path)
    return os.path.basename(path)
