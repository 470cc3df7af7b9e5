"""A whole scene: what is where, and how often."""
import hashlib
import os
from array import array
from dataclasses import dataclass, field

import numpy as np
from mathutils import Matrix, Vector

from . import camera, curves, lamps, materials, mesh, volumes, world
from .pbrt import Document, columns, directive, moving
from .pictures import Files
from .report import Report, find

MESHES = ("MESH", "CURVE", "SURFACE", "FONT", "META", "CURVES")


@dataclass
class Model:
    """A shape with its materials, and where it stands."""

    name: str
    shapes: list = ()  # lines of each part
    emits: bool = False
    points: object = None  # in its own space
    faces: object = ()  # numbers of points
    poses: array = field(default_factory=lambda: array("d"))  # 16 numbers each, by columns
    ends: array = field(default_factory=lambda: array("d"))  # the same when the shutter closes, if anything moves

    def placed(self):
        """Poses of its copies, and centres and radii of balls around them."""
        low, high = self.points.min(0), self.points.max(0)
        poses = np.frombuffer(self.poses).reshape(-1, 4, 4).transpose(0, 2, 1)
        return poses, poses[:, :3, :3] @ ((low + high) / 2) + poses[:, :3, 3], np.linalg.norm(high - low) / 2 * np.sqrt((poses[:, :3, :3] ** 2).sum((1, 2)))

    def places(self):
        ends = self.ends or self.poses
        for i in range(0, len(self.poses), 16):
            yield moving(self.poses[i : i + 16], ends[i : i + 16], "ConcatTransform")


@dataclass
class Exported:
    path: str
    digest: object
    parts: dict  # what there is, to a digest of it: which of them made another job?
    lost: list
    wanted: list  # (material, node, output) that may be baked
    aperture: str  # an argument of latent-develop --aperture, or None
    moves: bool


def digest_of(data):
    return hashlib.blake2b(data, digest_size=8).hexdigest()


class Exporter:
    """`settings`: those of the scene; `bake(world)`: the path of a picture of a world, or None."""

    def __init__(self, depsgraph, folder, settings, bake):
        self.depsgraph, self.folder, self.settings, self.bake = depsgraph, folder, settings, bake
        self.scene, self.layer = depsgraph.scene_eval, depsgraph.view_layer
        self.document, self.report = Document(), Report()
        self.files = Files(os.path.join(folder, "pictures"))
        self.models, self.lamps, self.portals, self.parts = {}, [], [], {}
        self.model_of, self.known_materials, self.known_objects, self.stills = {}, {}, set(), {}
        self.opened, self.closed = {}, {}  # poses of all that there is, by key, if anything moves

    def export(self, stem, frame_set):
        """Writes STEM.pbrt. `frame_set(frame, subframe)` moves the scene for motion blur."""
        os.makedirs(self.folder, exist_ok=True)
        shutter = camera.shutter_times(self.scene)
        if shutter:
            self.opened, self.closed = self.poses_at(shutter, frame_set)
        for instance in self.depsgraph.object_instances:
            self.add(instance)
        for key, model in list(self.models.items()):
            if not np.isfinite(np.frombuffer(model.poses)).all():
                self.report.lost(f"object {model.name}", "is left out: its place is no number")
                del self.models[key]
        view = self.scene.camera.evaluated_get(self.depsgraph)  # Blender does not render without one
        self.clip(view)
        kind, depth = "bdpt" if self.settings.integrator == "BDPT" else "volpath", self.settings.max_depth
        width, height = camera.size(self.scene)
        film, body = directive("Film", "rgb", **{"integer xresolution": width, "integer yresolution": height}), self.document.body
        lens = camera.export(self.scene, view, [self.opened["camera"], self.closed["camera"]] if shutter else [view.matrix_world], self.report)
        for part, lines in (("resolution", [film]), ("camera", lens), ("integrator", [kind]), ("bounces", [str(depth)])):
            self.part(part, lines)
        self.document.head += [film, *lens, directive("Integrator", kind, **{"integer maxdepth": depth})]
        scene_ball = self.bounds()
        for owner, pose in self.lamps:
            lamp = lamps.Lamp(owner, self.group(owner), self.report, self.files, scene_ball, lambda *ball: camera.sees_balls(self.scene, view, *ball).any())
            body += self.part(f"lamp {owner.name}", lamp.export(pose))
        sky = getattr(self.layer, "world_override", None) or self.scene.world
        body += self.part("world", world.export(sky, self.files, self.portals, self.report, self.bake))
        for number, model in enumerate(self.models.values()):
            self.write_model(model, f"object {number + 1}")
        self.look_at_scene(bool(shutter))
        path = os.path.join(self.folder, f"{stem}.pbrt")
        digest = self.document.write(path)
        for picture, content in sorted(self.files.contents.items()):
            self.part(f"picture {os.path.basename(picture)}", [content])
            digest.update(content.encode())
        return Exported(path, digest, self.parts, list(self.report.lines), self.files.wanted, camera.blades(view.data), bool(shutter))

    def look_at_scene(self, moves):
        depth, bounces = self.settings.max_depth, find(self.scene, "cycles.volume_bounces", otherwise=1024)
        self.report.settings("scene", self.scene)
        if moves and find(self.scene, "cycles.rolling_shutter_type", otherwise="NONE") != "NONE":
            self.report.lost("shutter", "it opens for all rows at once; the darkroom can roll it")
        if moves and any(point.location[1] < 1 for point in self.scene.render.motion_blur_shutter_curve.curves[0].points):
            self.report.lost("shutter", "it opens and closes at once, whatever its curve")
        if bounces < depth - 1 and any("sigma_s" in line for line in (*self.document.definitions.values(), *self.document.body) if isinstance(line, str)):
            self.report.lost("volumes", f"light scatters up to {depth} times, not {bounces + 1}")

    def part(self, name, lines):
        """Keeps a digest of lines, and returns them."""
        self.parts[name] = digest_of("\n".join(lines).encode())
        return lines

    def group(self, owner):
        """The name of the light group of an object."""
        of_collection = self.settings.light_groups == "COLLECTIONS" and owner.users_collection
        return owner.users_collection[0].name if of_collection else owner.name

    # ----- what there is

    def key(self, instance):
        return instance.object.name_full, instance.parent and instance.parent.name_full, tuple(instance.persistent_id)

    def poses_at(self, shutter, frame_set):
        """Poses when the shutter opens and when it closes."""
        now, poses = self.scene.frame_current + self.scene.frame_subframe, []
        for time in shutter:
            frame_set(int(np.floor(now + time)), float((now + time) % 1))
            there, shapes = {}, set()
            for instance in self.depsgraph.object_instances:
                there[self.key(instance)] = instance.matrix_world.copy()
                owner = instance.object
                if owner.type == "MESH" and owner.name_full not in shapes and find(owner, "cycles.use_deform_motion", otherwise=True):
                    shapes.add(owner.name_full)
                    shape = digest_of(mesh.read(owner.data.vertices, "co", 3).tobytes())
                    self.stays(f"object {owner.name}", shape, "its deformation during the exposure is left out")
            view = self.scene.camera.evaluated_get(self.depsgraph)
            there["camera"], dof = view.matrix_world.copy(), view.data.dof
            lens = camera.window(self.scene, view.data), dof.aperture_fstop, dof.focus_distance
            self.stays(f"camera {view.name}", lens, "its zoom or focus during the exposure is left out")
            poses.append(there)
        frame_set(int(np.floor(now)), float(now % 1))
        return poses

    def stays(self, owner, what, otherwise):
        """Lists what is not as when the shutter opened."""
        if self.stills.setdefault(owner, what) != what:
            self.report.lost(owner, otherwise)

    def add(self, instance):
        owner = instance.object
        if owner.name_full not in self.known_objects:
            self.known_objects.add(owner.name_full)
            self.look_at(owner.original)
        if owner.type == "LIGHT" and instance.show_self:
            self.add_lamp(instance, owner.original)
        elif owner.type == "VOLUME":
            lines = volumes.voxels(owner, instance.matrix_world, os.path.join(self.folder, "volumes"), self.report)
            self.document.body += self.part(f"object {owner.name}", lines)
        elif owner.type in MESHES:
            if instance.show_self:
                self.add_shape(instance, owner)
            if instance.show_particles and not instance.is_instance:
                self.add_particle_hair(owner)

    def look_at(self, owner):
        """Lists what Latent cannot say of an object as such. Lamps are hidden from cameras unless the user wills it; the panel Spectrum says more."""
        if owner.type == "POINTCLOUD":
            self.report.lost(f"object {owner.name}", "a point cloud is left out")
        if owner.type not in (*MESHES, "VOLUME", "LIGHT"):
            return
        kind = "lamp" if owner.type == "LIGHT" else "object"
        self.report.settings(kind, owner)
        for holds, what in ((kind == "lamp" and find(owner, "data.cycles.max_bounces", otherwise=1024) < self.settings.max_depth, "its light bounces as often as that of others"),
                            (owner.holdout_get(view_layer=self.layer), "a holdout is an ordinary surface"),
                            (owner.indirect_only_get(view_layer=self.layer), "stays visible to the camera, not to indirect light alone")):
            if holds:
                self.report.lost(f"{kind} {owner.name}", what)

    def add_lamp(self, instance, owner):
        pose, key = instance.matrix_world.copy(), self.key(instance)
        if not lamps.is_portal(owner):
            self.lamps.append((owner, pose))
            if self.closed.get(key) not in (None, self.opened.get(key)):
                self.report.lost(f"lamp {owner.name}", "its motion is left out")
        elif self.settings.portals:
            self.portals.append(lamps.portal(owner, pose))
        else:
            self.report.lost(f"lamp {owner.name}", "a portal is left out; the job's panel can send the sky through portals only")

    def add_shape(self, instance, owner):
        who = owner.name_full, owner.data.as_pointer()
        model = self.model_of.get(who) or self.model_of.setdefault(who, self.model(owner))
        if not model.shapes:
            return
        moves = self.closed and all(find(of, "cycles.use_motion_blur", otherwise=True) for of in (owner, instance.parent or owner))
        key = self.key(instance) if moves else None
        model.poses.extend(columns(self.opened.get(key, instance.matrix_world)))
        if self.closed:
            model.ends.extend(columns(self.closed.get(key, instance.matrix_world)))

    def model(self, owner):
        """That of other objects, too, which have the same data and materials."""
        materials = self.slots(owner)
        emits = any(self.lookup(material, owner).emits for material in materials)
        key = owner.data.as_pointer(), *(material and material.name_full for material in materials), self.group(owner.original) if emits else ""
        if key not in self.models and owner.type == "CURVES":
            self.models[key] = self.read_strands(owner, f"object {owner.name}", 0, curves.hair_curves(owner.data))
        elif key not in self.models:
            self.models[key] = self.read_mesh(owner)
        return self.models[key]

    def slots(self, owner):
        """The materials of an object, by slot: at least one, which may be None."""
        materials = list(getattr(owner.data, "materials", ()))
        for i, slot in enumerate(owner.material_slots):
            if i < len(materials) and (slot.link == "OBJECT" or not materials[i]):
                materials[i] = slot.material
        return materials or [slot.material for slot in owner.material_slots] or [None]

    def lookup(self, material, owner):
        """A material as it is written. One that emits is another one in each light group."""
        material = self.layer.material_override or material
        name, group = material.name_full if material else "", self.group(owner.original)
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
            return Model(owner.name)
        try:
            if data is None or len(data.polygons) == 0:
                return Model(owner.name)
            corners = mesh.Corners(data)
            of_slot = [self.lookup(material, owner) for material in self.slots(owner)]
            files = mesh.export(corners, [made.places for made in of_slot], os.path.join(self.folder, "meshes"), self.report.of(f"object {owner.name}"))
        finally:
            owner.to_mesh_clear()
        self.part(f"object {owner.name}", [name for _, name in files])
        shapes = [[*of_slot[slot].lines, directive("Shape", "plymesh", **{"string filename": f"meshes/{name}", **of_slot[slot].alpha})] for slot, name in files]
        return Model(owner.name, shapes, any(of_slot[slot].emits for slot, _ in files), corners.positions, corners.triangles)

    def read_strands(self, owner, part, slot, strands):
        """`strands`: points, and diameters at both ends."""
        slots, strands = self.slots(owner), list(strands)
        made = self.lookup(slots[min(slot, len(slots) - 1)], owner)
        lines = self.part(part, [curves.shape(*strand, made.alpha) for strand in strands])
        return Model(owner.name, [[*made.lines, *lines]], made.emits, np.concatenate([points for points, _, _ in strands])) if strands else Model(owner.name)

    def add_particle_hair(self, owner):
        for modifier in owner.modifiers:
            settings = modifier.particle_system.settings if modifier.type == "PARTICLE_SYSTEM" and modifier.show_render else None
            if settings and settings.type == "HAIR" and settings.render_type == "PATH":
                ends = settings.root_radius * settings.radius_scale, settings.tip_radius * settings.radius_scale
                strands = [(points, *ends) for points in curves.particle_strands(owner, modifier, self.depsgraph.mode)]
                model = self.read_strands(owner, f"hair {modifier.particle_system.name}", max(0, settings.material - 1), strands)
                self.models["hair", owner.name_full, modifier.name] = model
                model.poses.extend(columns(Matrix()) if strands else [])

    # ----- where it is

    def bounds(self):
        """A ball around everything, for lamps that are far away."""
        balls = [model.placed()[1:] for model in self.models.values() if model.poses]
        if not balls:
            return Vector((0, 0, 0)), 1.0
        low, high = (sign * np.max([(sign * centers + reach[:, None]).max(0) for centers, reach in balls], 0) for sign in (-1, 1))
        return Vector((low + high) / 2), max(1e-3, float(np.linalg.norm(high - low)) / 2)

    def clip(self, view):
        """Lists whether Cycles would cut something away."""
        for near, far, what in ((0.0, view.data.clip_start, "nearer than Clip Start"), (view.data.clip_end, np.inf, "beyond Clip End")):
            if any(self.is_cut(model, view, near, far) for model in self.models.values() if model.poses and len(model.faces)):
                self.report.lost(f"camera {view.name}", f"what is {what} stays visible")

    def is_cut(self, model, view, near, far):
        poses, centers, reach = model.placed()
        poses = poses[camera.sees_balls(self.scene, view, centers, reach, near, far)]
        return any(camera.sees(self.scene, view, model.points @ pose[:3, :3].T + pose[:3, 3], model.faces, near, far).any() for pose in poses)

    def write_model(self, model, name):
        if not model.poses:
            return
        self.part(f"place of {model.name}", [digest_of(model.poses.tobytes() + model.ends.tobytes())])
        content = [line for shape in model.shapes for line in ["AttributeBegin", *shape, "AttributeEnd"]]
        if len(model.poses) == 16 or model.emits:
            for place in model.places():
                self.document.body += ["AttributeBegin", place, *content, "AttributeEnd"]
        else:
            self.document.body += [f'ObjectBegin "{name}"', *content, "ObjectEnd"]
            self.document.body.append(f'AttributeBegin {place} ObjectInstance "{name}" AttributeEnd' for place in model.places())
