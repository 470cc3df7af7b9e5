"""A whole scene: what is where, and how often."""
import hashlib
import os
from array import array
from dataclasses import dataclass, field

import numpy as np

from . import camera, curves, lamps, materials, mesh, volumes, world
from .pbrt import Document, directive, matrix
from .pictures import Files
from .report import Report

MESHES = ("MESH", "CURVE", "SURFACE", "FONT", "META", "CURVES")
RAYS = ("camera", "diffuse", "glossy", "transmission", "volume_scatter", "shadow")


@dataclass
class Model:
    """A shape with its materials, and where it stands."""

    name: str
    shapes: list  # lines of each part
    emits: bool
    center: object = None  # of its box, in its own space
    radius: float = 0.0
    poses: array = field(default_factory=lambda: array("d"))  # 16 numbers each, row by row
    ends: array = field(default_factory=lambda: array("d"))  # the same when the shutter closes, if anything moves

    def count(self):
        return len(self.poses) // 16


@dataclass
class Exported:
    path: str
    digest: object
    parts: dict  # what there is, to a digest of it: which of them made another job?
    lost: list
    wanted: list  # (material, node, output) that may be baked
    aperture: str = None  # an argument of latent-develop --aperture
    moves: bool = False


def blurred(owner, what="use_motion_blur"):
    return getattr(getattr(owner, "cycles", None), what, True)


def ball(points):
    """The middle of a box around points, and its radius."""
    low, high = points.min(0), points.max(0)
    return (low + high) / 2, float(np.linalg.norm(high - low)) / 2


def flat(pose):
    return [number for row in pose for number in row]


class Exporter:
    """`settings`: those of the scene; `bake(world)`: the path of a picture of a world, or None; `bakes`: values of nodes that were baked."""

    def __init__(self, depsgraph, folder, settings, bake=lambda of: None):
        self.depsgraph, self.folder, self.settings, self.bake = depsgraph, folder, settings, bake
        self.scene = depsgraph.scene_eval
        self.document, self.report = Document(), Report()
        self.files = Files(os.path.join(folder, "pictures"))
        self.models, self.lamps, self.portals, self.parts = {}, [], [], {}
        self.known_materials, self.known_objects, self.emitting, self.shapes = {}, set(), {}, {}

    def export(self, stem="scene", frame_set=None):
        """Writes STEM.pbrt. `frame_set(frame, subframe)` moves the scene for motion blur."""
        os.makedirs(self.folder, exist_ok=True)
        shutter = camera.shutter_times(self.scene)
        opened, closed = self.poses_at(shutter, frame_set) if shutter and frame_set else ({}, {})
        for instance in self.depsgraph.object_instances:
            self.add(instance, opened, closed)
        for key, model in list(self.models.items()):
            if not np.isfinite(np.frombuffer(model.poses)).all():
                self.report.lost(f"object {model.name}", "is left out: its place is no number")
                del self.models[key]
        view = self.scene.camera
        if view is None:
            raise ValueError("the scene has no camera")
        view = view.evaluated_get(self.depsgraph)
        poses = [opened.get(("camera",), view.matrix_world), closed[("camera",)]] if ("camera",) in closed else [view.matrix_world]
        center, radius = self.bounds()
        lines = camera.export(self.scene, view, poses, (0.0, 1.0), self.report)
        self.part("camera", lines)
        depth = self.settings.max_depth
        integrator = directive("Integrator", "bdpt" if self.settings.integrator == "BDPT" else "volpath", **{"integer maxdepth": depth})
        self.document.head += [camera.film(self.scene), *lines, integrator]
        for owner, pose, name in self.lamps:
            from_lamp = lamps.export(owner, pose, name, self.report, self.files, radius, center, lambda *ball: camera.sees(self.scene, view, *ball))
            self.part(f"lamp {owner.name}", from_lamp)
            self.document.body += from_lamp
        lines = world.export(getattr(self.depsgraph.view_layer, "world_override", None) or self.scene.world, self.files, self.portals, self.report, self.bake)
        self.part("world", lines)
        self.document.body += lines
        for number, model in enumerate(self.models.values()):
            self.write_model(model, f"object {number + 1}")
        self.look_at_scene(bool(shutter))
        path = os.path.join(self.folder, f"{stem}.pbrt")
        digest = self.document.write(path)
        for picture, content in sorted(self.files.contents.items()):
            self.part(f"picture {os.path.basename(picture)}", [content])
            digest.update(content.encode())
        return Exported(path, digest, self.parts, list(self.report.lines), self.files.wanted, camera.blades(view.data), bool(closed))

    def look_at_scene(self, moves):
        """What Latent cannot say of a scene as such."""
        scene, render, cycles = self.scene, self.scene.render, getattr(self.scene, "cycles", None)
        curve, bounces = render.motion_blur_shutter_curve.curves[0], getattr(cycles, "volume_bounces", self.settings.max_depth)
        scatters = any('"rgb sigma_s"' in line for line in (*self.document.definitions.values(), *(line for line in self.document.body if isinstance(line, str))))
        for holds, owner, what in ((render.film_transparent, "film", "a transparent background is opaque"),
                                   (getattr(cycles, "film_exposure", 1) != 1, "film", "its exposure is 1; the darkroom has another one"),
                                   (render.use_multiview, "stereoscopy", "all views are that of the camera itself"),
                                   (moves and getattr(cycles, "rolling_shutter_type", "NONE") != "NONE", "shutter", "it opens for all rows at once; the darkroom can roll it"),
                                   (moves and any(point.location[1] < 1 for point in curve.points), "shutter", "it opens and closes at once, whatever its curve"),
                                   (scatters and bounces < self.settings.max_depth - 1, "volumes", f"light scatters up to {self.settings.max_depth} times, not {bounces + 1}")):
            if holds:
                self.report.lost(owner, what)

    def part(self, name, lines):
        self.parts[name] = hashlib.blake2b("\n".join(lines).encode(), digest_size=8).hexdigest()

    # ----- what there is

    def key(self, instance):
        parent = instance.parent.name_full if instance.parent else ""
        return instance.object.name_full, parent, tuple(instance.persistent_id)

    def poses_at(self, shutter, frame_set):
        """Poses of all instances when the shutter opens and when it closes."""
        now, poses = self.scene.frame_current + self.scene.frame_subframe, []
        for time in shutter:
            frame_set(int(np.floor(now + time)), float((now + time) % 1))
            there = {self.key(instance): instance.matrix_world.copy() for instance in self.depsgraph.object_instances}
            self.shapes_at(there)
            there[("camera",)] = self.scene.camera.evaluated_get(self.depsgraph).matrix_world.copy() if self.scene.camera else None
            poses.append(there)
        frame_set(int(np.floor(now)), float(now % 1))
        return poses

    def shapes_at(self, there):
        """Lists objects whose vertices are elsewhere than when the shutter opened."""
        for instance in self.depsgraph.object_instances:
            owner = instance.object
            if owner.type != "MESH" or ("shape", owner.name_full) in there or not blurred(owner, "use_deform_motion"):
                continue
            digest = hashlib.blake2b(mesh.read(owner.data.vertices, "co", 3).tobytes(), digest_size=8).digest()
            there["shape", owner.name_full] = digest
            if self.shapes.setdefault(owner.name_full, digest) != digest:
                self.report.lost(f"object {owner.name}", "its deformation during the exposure is left out")

    def add(self, instance, opened, closed):
        owner = instance.object
        if owner.as_pointer() not in self.known_objects:
            self.known_objects.add(owner.as_pointer())
            self.look_at(owner.original)
        if owner.type == "LIGHT" and instance.show_self:
            pose = instance.matrix_world.copy()
            if lamps.is_portal(owner) and self.settings.portals:
                self.portals.append(lamps.portal(owner, pose))
            elif lamps.is_portal(owner):
                self.report.lost(f"lamp {owner.name}", "a portal is left out; the job's panel can send the sky through portals only")
            else:
                self.lamps.append((owner.original, pose, lamps.group(self.settings, owner.original)))
                if closed and closed.get(self.key(instance)) not in (None, opened.get(self.key(instance))):
                    self.report.lost(f"lamp {owner.name}", "its motion is left out")
        elif owner.type == "POINTCLOUD":
            self.report.lost(f"object {owner.name}", "a point cloud is left out")
        elif owner.type == "VOLUME":
            lines = volumes.voxels(owner, instance.matrix_world, os.path.join(self.folder, "volumes"), self.report)
            self.part(f"object {owner.name}", lines)
            self.document.body += lines
        elif owner.type in MESHES:
            if instance.show_self:
                self.add_shape(instance, owner, opened, closed)
            if instance.show_particles and not instance.is_instance:
                self.add_particle_hair(owner)

    def look_at(self, owner):
        """What Latent cannot say of an object as such. Lamps are hidden from cameras unless the user wills it; the panel Spectrum says more."""
        layer, is_lamp = self.depsgraph.view_layer, owner.type == "LIGHT"
        linking = getattr(owner, "light_linking", None)
        hidden = [ray.replace("_", " ") for ray in RAYS if not getattr(owner, f"visible_{ray}") and not (is_lamp and ray == "camera")]
        for holds, what in ((hidden, f"stays visible to {', '.join(hidden)} rays"),
                            (not is_lamp and owner.is_shadow_catcher, "a shadow catcher is an ordinary surface"),
                            (owner.holdout_get(view_layer=layer), "a holdout is an ordinary surface"),
                            (linking and (linking.receiver_collection or linking.blocker_collection), "light linking is left out"),
                            (owner.indirect_only_get(view_layer=layer), "stays visible to the camera, not to indirect light alone")):
            if holds and owner.type in (*MESHES, "VOLUME", "LIGHT"):
                self.report.lost(f"{'lamp' if is_lamp else 'object'} {owner.name}", what)

    def add_shape(self, instance, owner, opened, closed):
        own = tuple(slot.material.as_pointer() if slot.material and slot.link == "OBJECT" else 0 for slot in owner.material_slots)
        key = (owner.data.as_pointer(), own)
        if key not in self.emitting:
            self.emitting[key] = any(self.lookup(material, owner).emits for material in self.slots(owner))
        if self.emitting[key]:
            key = (*key, lamps.group(self.settings, owner.original))
        model = self.models.get(key)
        if model is None:
            model = self.models[key] = self.read_strands(owner) if owner.type == "CURVES" else self.read_mesh(owner)
        if not model.shapes:
            return
        pose = instance.matrix_world
        who = self.key(instance) if closed and blurred(owner) and blurred(instance.parent or owner) else None
        model.poses.extend(flat(opened.get(who, pose)))
        if closed:
            model.ends.extend(flat(closed.get(who, pose)))

    def slots(self, owner):
        """The materials of an object, by slot."""
        of_data = list(owner.data.materials) if hasattr(owner.data, "materials") else []
        mine = [slot.material for slot in owner.material_slots]
        return [mine[i] if i < len(mine) and (owner.material_slots[i].link == "OBJECT" or not material) else material for i, material in enumerate(of_data)] or mine

    def lookup(self, material, owner):
        """A material as it is written. One that emits is another one in each light group."""
        material = self.depsgraph.view_layer.material_override or material
        name, group = material.name_full if material else "", lamps.group(self.settings, owner.original)
        made = self.known_materials.get((name, "")) or self.known_materials.get((name, group))
        if made is None:
            made = materials.export(self.document, material.original if material else None, self.report, self.files, group)
            self.known_materials[name, group if made.emits else ""] = made
            self.part(f"material {name or '(none)'}", made.lines)
        return made

    def read_mesh(self, owner):
        try:
            data = owner.to_mesh()
        except RuntimeError:
            return Model(owner.name, [], False)
        slots = self.slots(owner) or [None]
        try:
            if data is None or len(data.polygons) == 0:
                return Model(owner.name, [], False)
            corners = mesh.Corners(data)
            of_slot = [self.lookup(material, owner) for material in slots]
            files = mesh.export(corners, len(slots), lambda slot: of_slot[slot].places, os.path.join(self.folder, "meshes"),
                                self.report.of(f"object {owner.name}"))
            box = ball(corners.positions)
        finally:
            owner.to_mesh_clear()
        shapes, emits = [], False
        for slot, name in files:
            made = of_slot[slot]
            emits |= made.emits
            shapes.append([*made.lines, directive("Shape", "plymesh", **{"string filename": f"meshes/{name}", **made.alpha})])
        self.part(f"object {owner.name}", [name for _, name in files])
        return Model(owner.name, shapes, emits, *box)

    def read_strands(self, owner):
        made = self.lookup((self.slots(owner) or [None])[0], owner)
        strands = [curves.shape(points, root, tip, made.alpha) for points, root, tip in curves.hair_curves(owner.data)]
        self.part(f"object {owner.name}", strands)
        return Model(owner.name, [[*made.lines, *strands]] if strands else [], made.emits, *ball(np.array(owner.bound_box)))

    def add_particle_hair(self, owner):
        for modifier in owner.modifiers:
            if modifier.type != "PARTICLE_SYSTEM" or not modifier.show_render:
                continue
            settings = modifier.particle_system.settings
            if settings.type != "HAIR" or settings.render_type != "PATH":
                continue
            slots = self.slots(owner) or [None]
            made = self.lookup(slots[min(len(slots), max(1, settings.material)) - 1], owner)
            root, tip = settings.root_radius * settings.radius_scale, settings.tip_radius * settings.radius_scale
            strands = [curves.shape(points, root, tip, made.alpha) for points in curves.particle_strands(owner, modifier, self.depsgraph.mode)]
            if strands:
                self.part(f"hair {modifier.particle_system.name}", strands)
                model = Model(owner.name, [[*made.lines, *strands]], made.emits, np.array(owner.matrix_world.translation), max(owner.dimensions))
                model.poses.extend(flat(np.eye(4)))
                self.models[("hair", owner.name_full, modifier.name)] = model

    # ----- where it is

    def bounds(self):
        """A ball around everything, for lamps that are far away."""
        from mathutils import Vector

        low, high = np.full(3, np.inf), np.full(3, -np.inf)
        for model in self.models.values():
            if not model.count():
                continue
            poses = np.frombuffer(model.poses).reshape(-1, 4, 4)
            centers = poses[:, :3, :3] @ model.center + poses[:, :3, 3]
            reach = model.radius * np.sqrt((poses[:, :3, :3] ** 2).sum((1, 2)))
            low, high = np.minimum(low, (centers - reach[:, None]).min(0)), np.maximum(high, (centers + reach[:, None]).max(0))
        if not np.isfinite(low).all():
            return Vector((0, 0, 0)), 1.0
        return Vector((low + high) / 2), max(1e-3, float(np.linalg.norm(high - low)) / 2)

    def write_model(self, model, name):
        count = model.count()
        if not model.shapes or not count:
            return
        self.part(f"place of {model.name}", [hashlib.blake2b(model.poses.tobytes() + model.ends.tobytes(), digest_size=8).hexdigest()])
        content = [line for shape in model.shapes for line in ["AttributeBegin", *shape, "AttributeEnd"]]
        body = self.document.body
        if count == 1 or model.emits:
            for pose in range(count):
                body += ["AttributeBegin", *placed(model, pose), *content, "AttributeEnd"]
            return
        body += [f'ObjectBegin "{name}"', *content, "ObjectEnd"]
        body.append(copies(model, name))


def placed(model, number):
    start, end = (matrix(np.frombuffer(poses)[16 * number : 16 * number + 16].reshape(4, 4), "ConcatTransform") for poses in (model.poses, model.ends or model.poses))
    return [start] if start == end else ["ActiveTransform StartTime", start, "ActiveTransform EndTime", end, "ActiveTransform All"]


def copies(model, name):
    """Lines of each instance."""
    if model.ends:
        for number in range(model.count()):
            yield "\n".join(["AttributeBegin", *placed(model, number), f'ObjectInstance "{name}"', "AttributeEnd"])
        return
    columns = np.frombuffer(model.poses).reshape(-1, 4, 4).transpose(0, 2, 1).reshape(-1, 16)
    pattern = "AttributeBegin ConcatTransform [ " + " ".join(["%.9g"] * 16) + f' ] ObjectInstance "{name}" AttributeEnd'
    for chunk in range(0, len(columns), 65536):
        for row in columns[chunk : chunk + 65536].tolist():
            yield pattern % tuple(row)
