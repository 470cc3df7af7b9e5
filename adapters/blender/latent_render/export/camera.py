"""The camera and the film. Blender's camera looks along -z, pbrt's along +z with x to the right: one axis is mirrored."""
import math

import numpy as np

from .pbrt import columns, directive, moving
from .report import find

MIRRORED = np.diag([1.0, 1.0, -1.0, 1.0])
# pbrt's panorama begins at +x and goes by +z, and its pole is +y; the middle of Blender's lies in front.
PANORAMIC = np.array([[0.0, 0.0, 1.0, 0.0], [0.0, 1.0, 0.0, 0.0], [-1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
CUBE = np.indices((2, 2, 2)).reshape(3, 8).T * 2 - 1  # its corners


def size(scene):
    render = scene.render
    share = render.resolution_percentage / 100
    return max(1, int(render.resolution_x * share)), max(1, int(render.resolution_y * share))


def export(scene, owner, poses, report):
    """Directives. `owner`: the evaluated object; `poses`: its matrices when the shutter opens and closes."""
    data, lost = owner.data, report.of(f"camera {owner.name}")
    world_to_camera = [(PANORAMIC if data.type == "PANO" else MIRRORED) @ np.array(pose.normalized().inverted()) for pose in poses]
    place = moving(*(columns(rows) for rows in (world_to_camera[0], world_to_camera[-1])))
    parameters = {"float shutteropen": 0.0, "float shutterclose": 1.0} if len(poses) > 1 else {}
    if data.type == "PANO":
        kind = find(data, "panorama_type", "cycles.panorama_type", otherwise="EQUIRECTANGULAR")
        west, east, south, north = (find(data, name, f"cycles.{name}", otherwise=0)
                                    for name in ("longitude_min", "longitude_max", "latitude_min", "latitude_max"))
        if kind != "EQUIRECTANGULAR":
            lost(f"panorama {kind.lower()} is equirectangular, the only one")
        elif east - west < 6.28 or north - south < 3.14:
            lost("its panorama goes all around, whatever its latitudes and longitudes")
        return [place, directive("Camera", "spherical", **{"string mapping": "equirectangular", **parameters})]
    kind = "orthographic" if data.type == "ORTHO" else "perspective"
    parameters |= {"float screenwindow": window(scene, data), **({"float fov": 90.0} if kind == "perspective" else {})}
    if data.dof.use_dof and data.type == "ORTHO":
        lost("an orthographic camera has no depth of field")
    elif data.dof.use_dof:
        target, distance, pose = data.dof.focus_object, data.dof.focus_distance, poses[0]
        if target:
            distance = abs((target.matrix_world.translation - pose.translation).dot(pose.col[2].xyz.normalized()))
        parameters |= {"float lensradius": data.lens * 5e-4 / max(1e-6, data.dof.aperture_fstop), "float focaldistance": max(1e-4, distance)}
        if abs(data.dof.aperture_ratio - 1) > 1e-3:
            lost("anamorphic bokeh is left out here (Darkroom has it)")
    return [place, directive("Camera", kind, **parameters)]


def window(scene, data):
    """Left, right, low and high of the picture, in perspective at a distance of 1. Shift, sensor and aspect are in them."""
    frame = data.view_frame(scene=scene)
    scale = 1.0 if data.type == "ORTHO" else 1 / -frame[0].z
    return [scale * pick(corner[i] for corner in frame) for i in (0, 1) for pick in (min, max)]


def depth_per_distance(scene):
    """Latent's depth is a distance from the camera, Blender's lies along its axis: (height, width) factors."""
    data, (width, height) = scene.camera.data, size(scene)
    if data.type != "PERSP":
        return np.float32(1)
    left, right, low, high = window(scene, data)
    x, y = left + (np.arange(width) + 0.5) / width * (right - left), high + (np.arange(height) + 0.5) / height * (low - high)
    return (1 / np.sqrt(1 + x**2 + y[:, None] ** 2)).astype(np.float32)


def sees(scene, owner, points, faces, near=0.0, far=np.inf):
    """Which of some faces (rows of numbers of points in the world) may be in the picture, between two depths; what hides them does not count."""
    data, view = owner.data, np.array(owner.matrix_world.normalized().inverted())
    local = points @ view[:3, :3].T + view[:3, 3]
    x, y, z = local.T
    if data.type == "PANO":
        corners, beyond = min(far, 1e6) * CUBE, [side for axis in (x, y, z) for side in (axis < -far, axis > far)] + [x**2 + y**2 + z**2 < near**2]
    else:
        bounds, is_flat = window(scene, data), data.type == "ORTHO"
        left, right, low, high = (side * (1.0 if is_flat else -z) for side in bounds)
        beyond = [x < left, x > right, y < low, y > high, -z < near, -z > far]
        corners = np.array([(x * scale, y * scale, -depth) for depth in (near, min(far, 1e6)) for scale in (1.0 if is_flat else depth,)
                            for x in bounds[:2] for y in bounds[2:]])
    seen = ~np.any([side[faces].all(1) for side in beyond], 0)
    if faces.shape[1] == 3:  # what is in view may still lie on one side of a triangle
        first, second, third = (local[faces[seen, corner]] for corner in range(3))
        side = np.einsum("fi,fci->fc", np.cross(second - first, third - first), corners - first[:, None])
        seen[seen] = (side.min(1, initial=np.inf) <= 0) & (side.max(1, initial=-np.inf) >= 0)
    return seen


def sees_balls(scene, owner, centers, radii, near=0.0, far=np.inf):
    """Which of some balls, by the cubes around them."""
    cubes = np.reshape(centers, (-1, 1, 3)) + np.reshape(radii, (-1, 1, 1)) * CUBE
    return sees(scene, owner, cubes.reshape(-1, 3), np.arange(cubes.size // 3).reshape(-1, 8), near, far)


def blades(data):
    """An argument of latent-develop --aperture, if the lens has blades."""
    if not (data.type == "PERSP" and data.dof.use_dof and data.dof.aperture_blades >= 3):
        return None
    return f"blades:{data.dof.aperture_blades}:{math.degrees(data.dof.aperture_rotation):.6g}"


def shutter_times(scene):
    """When the shutter opens and closes, in frames from the current one; None without motion blur."""
    render = scene.render
    if not render.use_motion_blur:
        return None
    position = find(scene, "render.motion_blur_position", "cycles.motion_blur_position", otherwise="CENTER")
    start = {"START": 0.0, "CENTER": -render.motion_blur_shutter / 2, "END": -render.motion_blur_shutter}[position]
    return start, start + render.motion_blur_shutter
