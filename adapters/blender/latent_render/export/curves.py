"""Strands: particle hair and hair curves as pbrt's curves."""
import numpy as np

from .mesh import read
from .pbrt import directive


def bezier(points):
    """Cubic Bezier segments through the points of a strand (Catmull-Rom): 3 n + 1 control points."""
    p = np.asarray(points, float)
    before, after = np.vstack([2 * p[0] - p[1], p[:-1]]), np.vstack([p[1:], 2 * p[-1] - p[-2]])
    tangent = (after - before) / 6
    out = np.empty((3 * (len(p) - 1) + 1, 3))
    out[0::3], out[1::3], out[2::3] = p, (p + tangent)[:-1], (p - tangent)[1:]
    return out


def shape(points, root, tip, alpha):
    """`root`, `tip`: diameters at both ends."""
    control = bezier(points)
    return directive("Shape", "curve", **{"string type": "cylinder", "point3 P": [float(c) for c in control.ravel()], "float width0": float(root),
                                          "float width1": float(tip), **alpha})


def particle_strands(owner, modifier, depsgraph_mode):
    """Points of each strand, in the world, of a particle system of hair."""
    system = modifier.particle_system
    steps = 2**(system.settings.render_step if depsgraph_mode == "RENDER" else system.settings.display_step)
    parents, children = len(system.particles), len(system.child_particles)
    first = 0 if children == 0 or system.settings.use_parent_particles else parents
    for number in range(first, parents + children):
        strand = [tuple(system.co_hair(owner, particle_no=number, step=step)) for step in range(steps + 1)]
        kept = [point for i, point in enumerate(strand) if i == 0 or point != strand[i - 1]]
        if len(kept) > 1:
            yield kept


def hair_curves(curves):
    """(points, diameters at both ends) of each curve of a Curves object, in its space."""
    positions = read(curves.points, "position", 3)
    radii = read(curves.attributes["radius"].data, "value", 1) if "radius" in curves.attributes else np.full(len(positions), 0.005)
    for curve in curves.curves:
        first, count = curve.first_point_index, curve.points_length
        if count > 1:
            yield positions[first : first + count], 2 * radii[first], 2 * radii[first + count - 1]
