"""What fills a closed surface, and clouds of voxels: pbrt's homogeneous and nanovdb media. Coefficients are constants."""
import hashlib
import os
import shutil
import subprocess

import bpy

from .nodes import Graph
from .pbrt import directive, matrix
from .report import Unknown

CONVERTER = "nanovdb_convert"  # of Debian's libnanovdb-tools


def coefficients(output, graph):
    """Parameters of a medium, or None."""
    socket = output.inputs["Volume"]
    return graph.follow(socket, lambda node, _: of_node(graph, node), lambda _: None) if socket.is_linked else None


# Shares of light that nodes absorb of what they do not scatter, by constants; None: the square root of a colour is kept.
ABSORBING = {"VOLUME_ABSORPTION": 1.0, "VOLUME_SCATTER": 0.0, "PRINCIPLED_VOLUME": None}


def of_node(graph, node):
    """Cycles' coefficients. An input that a node lacks is 0."""
    if node.type not in ABSORBING:
        graph.lost(f"volume {node.bl_label} is left out")
        return None
    if getattr(node, "phase", "HENYEY_GREENSTEIN") != "HENYEY_GREENSTEIN":
        graph.lost(f"{node.bl_label}: light scatters by Henyey and Greenstein")
    if graph.number(node, "Blackbody Intensity") > 0:
        graph.lost("the blackbody emission of a volume is left out")
    density, share, tint = graph.number(node, "Density"), ABSORBING[node.type], graph.constant(node, "Color").rgb
    absorbed = [1 - max(0.0, a) ** 0.5 for a in graph.constant(node, "Absorption Color").rgb] if share is None else [share] * 3
    absorb = [density * max(0.0, 1 - c) * max(0.0, a) for c, a in zip(tint, absorbed)]
    scatter = [density * c * (node.type != "VOLUME_ABSORPTION") for c in tint]
    parameters = {"rgb sigma_s": scatter, "rgb sigma_a": absorb, "float g": graph.number(node, "Anisotropy")}
    emit = [graph.number(node, "Emission Strength") * c for c in graph.constant(node, "Emission Color").rgb]
    if max(emit) > 0:
        # pbrt's media emit sigma_a Le; Blender's emit, whatever they absorb.
        if min(absorb) > 0:
            parameters["rgb Le"] = [e / a for e, a in zip(emit, absorb)]
        else:
            graph.lost("emission of a volume that absorbs nothing is left out")
    return parameters


def voxels(owner, pose, folder, report):
    """Lines of a volume object: its densities times what its Principled Volume says of density 1, in a box that nothing else sees."""
    lost = report.of(f"object {owner.name}")
    material = next((slot.material for slot in owner.material_slots if slot.material), None)
    tree = material and material.node_tree
    graph = tree and Graph(tree, lost)
    output = graph and graph.output("OUTPUT_MATERIAL")
    found = output and graph.source(output.inputs["Volume"])
    if not found or found[0].type != "PRINCIPLED_VOLUME":
        lost("a volume without a Principled Volume is left out")
        return []
    parameters, density = coefficients(output, graph), found[0].inputs["Density Attribute"].default_value
    try:
        file = converted(owner, folder)
    except (OSError, RuntimeError, Unknown, subprocess.CalledProcessError) as error:
        lost(f"its voxels are left out: {error}")
        return []
    if parameters.pop("rgb Le", None):
        lost("the emission of its voxels is left out")
    name = f"voxels {os.path.basename(file)} {owner.name}"
    corners = [coordinate for corner in owner.bound_box for coordinate in corner]  # first those of the lowest x, around it
    faces = [number for a, b, c, d in ((0, 1, 2, 3), (7, 6, 5, 4), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)) for number in (a, b, c, a, c, d)]
    return ["AttributeBegin", matrix(pose, "ConcatTransform"),
            directive("MakeNamedMedium", name, **{"string type": "nanovdb", "string filename": file, "string gridname": density, **parameters}),
            directive("MediumInterface", name, ""), 'Material "interface"',
            directive("Shape", "trianglemesh", **{"point3 P": corners, "integer indices": faces}), "AttributeEnd"]


def converted(owner, folder):
    """The path of a NanoVDB file with the grids of a volume object."""
    program = shutil.which(CONVERTER)
    if not program:
        raise Unknown(f"{CONVERTER} is not on the PATH (Debian has it in libnanovdb-tools)")
    grids = owner.data.grids
    if not grids.load():
        raise Unknown(grids.error_message or "its file cannot be read")
    path = bpy.path.abspath(grids.frame_filepath or "", library=owner.original.data.library)
    os.makedirs(folder, exist_ok=True)
    saved = os.path.join(folder, "unfinished.vdb")
    if owner.modifiers or not os.path.isfile(path):
        if not grids.save(saved):
            raise Unknown(f"its grids cannot be saved: {grids.error_message}")
        path = saved
    with open(path, "rb") as file:
        digest = hashlib.blake2b(file.read(), digest_size=12).hexdigest()
    made = os.path.join(folder, digest + ".nvdb")
    if not os.path.exists(made):
        part = os.path.join(folder, "unfinished.nvdb")
        subprocess.run([program, "-f", path, part], check=True, capture_output=True)
        os.replace(part, made)
    if path == saved:
        os.remove(saved)
    return made
