"""Lamps. Blender gives them in watts; Latent's numbers are radiances and intensities of Cycles' unit."""
import math

import bpy
import numpy as np
from mathutils import Matrix, Vector

from . import ies, spectra
from .nodes import Graph
from .pbrt import directive, matrix
from .report import find
from .values import is_constant

ALONG_Z = {"point3 from": [0.0, 0.0, 0.0], "point3 to": [0.0, 0.0, -1.0]}
# Watts of an area lamp for each unit of radiance and area: Blender 3's counted pi / 4 of the power.
AREA_FACTOR = math.pi if bpy.app.version >= (4, 0, 0) else 4.0


class Lamp:
    """`scene_ball`: centre and radius of all there is; `sees(center, radius)`: whether a ball may be in the picture."""

    def __init__(self, owner, name, report, files, scene_ball, sees):
        self.owner, self.data, self.name, self.files, self.scene_ball, self.sees = owner, owner.data, name, files, scene_ball, sees
        self.lost, self.lost_of_all = report.of(f"lamp {owner.name}"), report.of("lamps")
        self.profile = None  # that of an IES texture: a picture
        data = self.data
        factor = 2.0 ** getattr(data, "exposure", 0.0)
        if data.type != "AREA" and not getattr(data, "normalize", True):  # since Blender 4.5
            factor *= math.pi * math.sin(data.angle / 2) ** 2 or 1.0 if data.type == "SUN" else 4 * math.pi * data.shadow_soft_size**2 or 4.0
        tint = data.temperature_color if getattr(data, "use_temperature", False) else (1, 1, 1)
        self.color = [factor * c * t * n for c, t, n in zip(data.color, tint, self.emitted())]

    def emitted(self):
        """The colour that the nodes of the lamp give."""
        if not self.data.use_nodes or not self.data.node_tree:
            return 1, 1, 1
        graph = Graph(self.data.node_tree, self.lost)
        output = graph.output("OUTPUT_LIGHT")
        node, _ = output and graph.source(output.inputs["Surface"]) or (None, None)
        if not node or node.type != "EMISSION":
            self.lost("its nodes are ignored: no Emission leads to the output")
            return 1, 1, 1
        texture, _ = graph.source(node.inputs["Strength"]) or (None, None)
        self.profile = self.read_profile(texture) if texture and texture.type == "TEX_IES" else None
        color, amount = graph.of(node, "Color"), graph.of(node if self.profile is None else texture, "Strength")
        if is_constant(color, amount):
            return [c * amount.number() for c in color.rgb]
        self.profile = None
        self.lost("a texture of its nodes is ignored")
        return 1, 1, 1

    def read_profile(self, node):
        if node.inputs["Vector"].is_linked:
            self.lost("the coordinates of its IES profile are its own")
        try:
            if node.mode == "INTERNAL":
                return ies.read(node.ies.as_string() if node.ies else "")
            with open(bpy.path.abspath(node.filepath), encoding="latin-1") as file:
                return ies.read(file.read())
        except (OSError, ValueError, IndexError) as error:
            self.lost(f"its IES profile is left out: {error}")
            return None

    def export(self, pose):
        """Directives of the lamp at `pose`."""
        watts, color, kind = self.data.energy, self.color, self.data.type
        if not np.isfinite([watts, *color, *np.ravel(pose)]).all():
            self.lost("is left out: its light or its place is no number")
            return []
        if watts < 0 or min(color) < 0:
            self.lost("negative light is left out")
        if watts <= 0 or min(color) < 0 or max(color) <= 0:
            return []
        axes = np.array(pose.to_3x3().normalized())
        if kind in ("SPOT", "AREA") and np.abs(axes.T @ axes - np.eye(3)).max() > 1e-3:
            self.lost("its shear is left out")
        if self.profile is not None and kind in ("SUN", "AREA"):
            self.lost("its IES profile is left out: only points and spots have one")
        place, *lines = MAKERS[kind](self, pose, watts)
        return ["AttributeBegin", matrix(place), *lines, "AttributeEnd"]

    # What the kinds of lamps are made of.
    def source(self, kind, key, scale, word="LightSource", **more):
        spectrum, factor = spectra.lamp(self.data.latent, key, self.color)
        return directive(word, kind, **{**spectrum, "float scale": float(scale * factor), "string name": self.name, **more})

    def surface(self, kind, shape, center, radius, radiance, **more):
        """A shape that emits, within a ball: its parameters. An unseen one shines all the same: only rays do not meet it."""
        way = self.data.latent.visible
        visible = way == "ALWAYS" or way == "AUTO" and (self.owner.visible_camera or not self.sees(center, radius))
        if way == "AUTO" and not visible:
            self.lost_of_all("mirrors do not show those that the camera does not see, and gloss is noisier (Visible in their panel changes that)")
        return ['Material "diffuse" "rgb reflectance" [ 0 0 0 ]', self.source("diffuse", "L", radiance, "AreaLightSource", **more),
                directive("Shape", kind, **shape, **({} if visible else {"float alpha": 0.0}))]

    def by_direction(self, pose, watts, share=1.0):
        """A point whose light depends on the direction: on its profile, and on `share`, a picture as profiles have."""
        self.has_no_size()
        picture = (1 if self.profile is None else ies.WATTS * self.profile) * share
        place = [[row[i] for i in (0, 2, 1, 3)] for row in at(pose)]  # pbrt exchanges y and z of these lights
        if picture.max() <= 0:
            self.lost("is left out: its profile or its cone is empty")
            return [place]
        return [place, self.source("goniometric", "I", watts / (4 * math.pi), **{"string filename": self.files.drawn(picture[..., None])})]

    def has_no_size(self):
        if self.data.shadow_soft_size > 1e-6:
            unseen = ", so the camera does not see it" if self.owner.visible_camera else ""
            self.lost(f"its size is left out{unseen}: its shadows are sharp")

    # Each kind: its place, and its lines.
    def point(self, pose, watts):
        radius = self.data.shadow_soft_size
        if self.profile is not None:
            return self.by_direction(pose, watts)
        if radius < 1e-6:
            return [at(pose), self.source("point", "I", watts / (4 * math.pi))]
        return [at(pose), *self.surface("sphere", {"float radius": radius}, pose.translation, radius, watts / (4 * math.pi**2 * radius**2))]

    def spot(self, pose, watts):
        """The edge is a smoothstep of the cosine, as pbrt's."""
        cone = self.data.spot_size / 2
        outer = math.cos(cone)
        inner = outer + (1 - outer) * self.data.spot_blend
        stretch = np.maximum(1e-6, np.abs(pose.to_scale())) if bpy.app.version >= (4, 0, 0) else np.ones(3)
        if self.profile is not None or np.ptp(stretch) > 1e-4 * stretch.max():
            local = ies.directions() / stretch
            rise = np.clip((-local[..., 2] / np.linalg.norm(local, axis=-1) - outer) / max(inner - outer, 1e-6), 0, 1)
            return self.by_direction(pose, watts, rise * rise * (3 - 2 * rise))
        self.has_no_size()
        edge = {"float coneangle": math.degrees(cone), "float conedeltaangle": math.degrees(max(0.0, cone - math.acos(min(1.0, inner))))}
        return [at(pose), self.source("spot", "I", watts / (4 * math.pi), **ALONG_Z, **edge)]

    def sun(self, pose, watts):
        """With an angle: a disk so far away that its light falls off by less than a thousandth across the scene."""
        half, turned = self.data.angle / 2, at(pose)
        turned.translation = (0, 0, 0)
        if half < 1e-5:
            return [turned, self.source("distant", "L", watts, **ALONG_Z)]
        center, distance = self.scene_ball[0], 2000 * self.scene_ball[1]
        turned.translation, radius = center + distance * turned.col[2].xyz, distance * math.tan(half)
        # The disk faces along its +z, and shines along -z.
        return [turned, "ReverseOrientation",
                *self.surface("disk", {"float radius": radius}, turned.translation, radius, watts / (math.pi * math.sin(half) ** 2))]

    def area(self, pose, watts):
        data, is_round = self.data, self.data.shape in ("DISK", "ELLIPSE")
        wide, high = (side * abs(stretch) for side, stretch in zip(sides(data), pose.to_scale()))
        surface = wide * high * (math.pi / 4 if is_round else 1)
        if surface <= 0:
            self.lost("an area of no size is left out")
            return [at(pose)]
        radiance, more = watts / (AREA_FACTOR * (surface if getattr(data, "normalize", True) else 1)), {}
        if data.spread < math.pi - 1e-3:
            # Cycles: max(0, 1 - tan a / tan(spread / 2)) times a factor that keeps the power. Here: cos^n a that is half at the same angle.
            self.lost("its spread is a power of the cosine of equal half-width")
            power = math.log(0.5) / math.log(math.cos(math.atan(0.5 * math.tan(max(data.spread, 1e-3) / 2))))
            more, radiance = {"float latent:exponent": power}, radiance * (power + 2) / 2
        x, y, ball = wide / 2, high / 2, (pose.translation, math.hypot(wide, high) / 2)
        if is_round:
            return [at(pose) @ Matrix.Diagonal((x, y, 1, 1)), "ReverseOrientation", *self.surface("disk", {"float radius": 1.0}, *ball, radiance, **more)]
        corners = [-x, -y, 0.0, -x, y, 0.0, x, -y, 0.0, x, y, 0.0]  # facing -z
        return [at(pose), *self.surface("bilinearmesh", {"point3 P": corners, "integer indices": [0, 1, 2, 3]}, *ball, radiance, **more)]


MAKERS = {"POINT": Lamp.point, "SPOT": Lamp.spot, "SUN": Lamp.sun, "AREA": Lamp.area}


def at(pose):
    """Without a scale, which lamps ignore but for areas and the cones of spots. A mirrored pose stays so: its quaternion is that of its opposite."""
    return Matrix.LocRotScale(pose.translation, pose.to_quaternion(), Vector((-1, -1, -1)) if pose.is_negative else None)


def sides(data):
    return data.size, data.size_y if data.shape in ("RECTANGLE", "ELLIPSE") else data.size


def portal(owner, pose):
    """Corners of a portal, in the world: a sky shines through it alone."""
    x, y = (side / 2 for side in sides(owner.data))
    return [pose @ Vector(corner) for corner in ((-x, -y, 0), (-x, y, 0), (x, y, 0), (x, -y, 0))]


def is_portal(owner):
    return owner.data.type == "AREA" and find(owner.data, "is_portal", "cycles.is_portal", otherwise=False)
