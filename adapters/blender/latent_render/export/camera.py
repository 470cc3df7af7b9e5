"""The camera and the film. Blender's camera looks along -z, pbrt's along +z with x to the right: one axis is mirrored."""
import math

import numpy as np

from .pbrt import directive, matrix


def size(scene):
    render = scene.render
    share = render.resolution_percentage / 100
    return max(1, int(render.resolution_x * share)), max(1, int(render.resolution_y * share))


def film(scene):
    width, height = size(scene)
    return directive("Film", "rgb", **{"integer xresolution": width, "integer yresolution": height})


def export(scene, owner, poses, shutter, report):
    """Directives. `owner`: the evaluated object; `poses`: its matrices when the shutter opens and closes."""
    data, lost = owner.data, report.of(f"camera {owner.name}")
    lines = []
    turn = panoramic if data.type == "PANO" else mirrored
    world_to_camera = [turn(pose.normalized().inverted()) for pose in poses]
    if len(poses) > 1 and poses[0] != poses[1]:
        for word, rows in zip(("StartTime", "EndTime"), world_to_camera):
            lines += [f"ActiveTransform {word}", matrix(rows)]
        lines.append("ActiveTransform All")
    else:
        lines.append(matrix(world_to_camera[0]))
    parameters = {"float shutteropen": shutter[0], "float shutterclose": shutter[1]} if len(poses) > 1 else {}
    if data.type == "PANO":
        panorama = data if hasattr(data, "panorama_type") else data.cycles
        if panorama.panorama_type != "EQUIRECTANGULAR":
            lost(f"panorama {panorama.panorama_type.lower()} is equirectangular, the only one")
        elif panorama.longitude_max - panorama.longitude_min < 6.28 or panorama.latitude_max - panorama.latitude_min < 3.14:
            lost("its panorama goes all around, whatever its latitudes and longitudes")
        return [*lines, directive("Camera", "spherical", **{"string mapping": "equirectangular", **parameters})]
    kind = "orthographic" if data.type == "ORTHO" else "perspective"
    parameters |= {"float screenwindow": window(scene, data), **({"float fov": 90.0} if kind == "perspective" else {})}
    if data.dof.use_dof and data.type == "ORTHO":
        lost("an orthographic camera has no depth of field")
    elif data.dof.use_dof:
        radius = lens_radius(data)
        if radius > 0:
            parameters |= {"float lensradius": radius, "float focaldistance": max(1e-4, focus(owner, poses[0]))}
        if abs(data.dof.aperture_ratio - 1) > 1e-3:
            lost("anamorphic bokeh is left out here (Darkroom has it)")
    if data.clip_start > 0.5 * max(data.dof.focus_distance, 0.2) and data.type != "ORTHO":
        lost("clipping is ignored")
    return [*lines, directive("Camera", kind, **parameters)]


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


def sees(scene, owner, center, radius):
    """Whether a ball may be in the picture; what hides it does not count."""
    data, place = owner.data, owner.matrix_world.normalized().inverted() @ center
    if data.type == "PANO":
        return True
    scale = 1.0 if data.type == "ORTHO" else max(-place.z, 1e-6)
    left, right, low, high = (scale * side for side in window(scene, data))
    return -place.z + radius > 0 and left - radius <= place.x <= right + radius and low - radius <= place.y <= high + radius


def mirrored(inverse):
    return [list(inverse[0]), list(inverse[1]), [-c for c in inverse[2]], list(inverse[3])]


def panoramic(inverse):
    """pbrt's panorama begins at +x and goes by +z, and its pole is +y; the middle of Blender's lies in front."""
    return [list(inverse[2]), list(inverse[1]), [-c for c in inverse[0]], list(inverse[3])]


def lens_radius(data):
    if data.type == "ORTHO":
        return 1 / (2 * max(1e-6, data.dof.aperture_fstop))
    return data.lens * 1e-3 / (2 * max(1e-6, data.dof.aperture_fstop))


def focus(owner, pose):
    """The distance along the axis."""
    target = owner.data.dof.focus_object
    if target is None:
        return owner.data.dof.focus_distance
    return abs((target.matrix_world.translation - pose.translation).dot(pose.col[2].xyz.normalized()))


def blades(data):
    """An argument of latent-develop --aperture, if the lens has blades."""
    if not (data.type == "PERSP" and data.dof.use_dof and data.dof.aperture_blades >= 3 and lens_radius(data) > 0):
        return None
    return f"blades:{data.dof.aperture_blades}:{math.degrees(data.dof.aperture_rotation):.6g}"


def shutter_times(scene):
    """When the shutter opens and closes, in frames from the current one; None without motion blur."""
    render = scene.render
    if not render.use_motion_blur:
        return None
    position = getattr(render, "motion_blur_position", None) or scene.cycles.motion_blur_position
    start = {"START": 0.0, "CENTER": -render.motion_blur_shutter / 2, "END": -render.motion_blur_shutter}[position]
    return start, start + render.motion_blur_shutter
