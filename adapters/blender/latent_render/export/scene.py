"""A whole scene: what is where, and how often."""
import hashlib
import os
from array import array
from dataclasses import dataclass, field

import numpy as np

from . import camera, curves, lamps, materials, mesh, volumes, world
from .pbrt import Document, directive, moving
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
    points: object = None  # in its own space
    faces: object = ()  # numbers of points
    poses: array = field(default_factory=lambda: array("d"))  # 16 numbers each, row by row
    ends: array = field(default_factory=lambda: array("d"))  # the same when the shutter closes, if anything moves

    def placed(self):
        """Poses of its copies, and centres and radii of balls around them."""
        low, high = self.points.min(0), self.points.max(0)
        poses = np.frombuffer(self.poses).reshape(-1, 4, 4)
        return poses, poses[:, :3, :3] @ ((low + high) / 2) + poses[:, :3, 3], np.linalg.norm(high - low) / 2 * np.sqrt((poses[:, :3, :3] ** 2).sum((1, 2)))


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


def flat(pose):
    return [number for row in pose for number in row]


class Exporter:
    """`settings`: those of the scene; `bake(world)`: the path of a picture of a world, or None."""

    def __init__(self, depsgraph, folder, settings, bake=lambda of: None):
        self.depsgraph, self.folder, self.settings, self.bake = depsgraph, folder, settings, bake
        self.scene = depsgraph.scene_eval
        self.document, self.report = Document(), Report()
        self.files = Files(os.path.join(folder, "pictures"))
        self.models, self.lamps, self.portals, self.parts = {}, [], [], {}
        self.known_materials, self.known_objects, self.emitting, self.stills = {}, set(), {}, {}

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
        view = self.scene.camera.evaluated_get(self.depsgraph)  # Blender does not render without one
        poses = [opened.get(("camera",), view.matrix_world), closed[("camera",)]] if ("camera",) in closed else [view.matrix_world]
        scene_ball = self.bounds()
        lines = camera.export(self.scene, view, poses, self.report)
        self.clip(view)
        kind, depth = "bdpt" if self.settings.integrator == "BDPT" else "volpath", self.settings.max_depth
        film = camera.film(self.scene)
        for part, of in (("resolution", [film]), ("camera", lines), ("integrator", [kind]), ("bounces", [str(depth)])):
            self.part(part, of)
        self.document.head += [film, *lines, directive("Integrator", kind, **{"integer maxdepth": depth})]
        for owner, pose, name in self.lamps:
            from_lamp = lamps.Lamp(owner, name, self.report, self.files, scene_ball, lambda *ball: camera.sees_balls(self.scene, view, *ball).any()).export(pose)
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
            view = self.scene.camera.evaluated_get(self.depsgraph)
            there[("camera",)], dof = view.matrix_world.copy(), view.data.dof
            lens = camera.window(self.scene, view.data), dof.aperture_fstop, dof.focus_distance
            self.stays(f"camera {view.name}", lens, "its zoom or focus during the exposure is left out")
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
            self.stays(f"object {owner.name}", digest, "its deformation during the exposure is left out")

    def stays(self, owner, what, otherwise):
        """Lists what is not as when the shutter opened."""
        if self.stills.setdefault(owner, what) != what:
            self.report.lost(owner, otherwise)

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
        linking, bounces = getattr(owner, "light_linking", None), getattr(getattr(owner.data, "cycles", None), "max_bounces", 1024)
        hidden = [ray.replace("_", " ") for ray in RAYS if not getattr(owner, f"visible_{ray}") and not (is_lamp and ray == "camera")]
        for holds, what in ((hidden, f"stays visible to {', '.join(hidden)} rays"),
                            (is_lamp and bounces < self.settings.max_depth, "its light bounces as often as that of others"),
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
            model = self.models[key] = self.read_mesh(owner) if owner.type != "CURVES" else self.read_strands(
                owner, f"object {owner.name}", (self.slots(owner) or [None])[0], list(curves.hair_curves(owner.data)))
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
        finally:
            owner.to_mesh_clear()
        shapes, emits = [], False
        for slot, name in files:
            made = of_slot[slot]
            emits |= made.emits
            shapes.append([*made.lines, directive("Shape", "plymesh", **{"string filename": f"meshes/{name}", **made.alpha})])
        self.part(f"object {owner.name}", [name for _, name in files])
        return Model(owner.name, shapes, emits, corners.positions, corners.triangles)

    def read_strands(self, owner, part, material, strands):
        """`strands`: points, and diameters at both ends."""
        made = self.lookup(material, owner)
        lines = [curves.shape(*strand, made.alpha) for strand in strands]
        self.part(part, lines)
        shapes = [[*made.lines, *lines]] if strands else []
        return Model(owner.name, shapes, made.emits, np.concatenate([points for points, _, _ in strands] or [np.zeros((1, 3))]))

    def add_particle_hair(self, owner):
        for modifier in owner.modifiers:
            if modifier.type != "PARTICLE_SYSTEM" or not modifier.show_render:
                continue
            settings = modifier.particle_system.settings
            if settings.type != "HAIR" or settings.render_type != "PATH":
                continue
            slots = self.slots(owner) or [None]
            ends = settings.root_radius * settings.radius_scale, settings.tip_radius * settings.radius_scale
            strands = [(points, *ends) for points in curves.particle_strands(owner, modifier, self.depsgraph.mode)]
            material = slots[min(len(slots), max(1, settings.material)) - 1]
            model = self.models["hair", owner.name_full, modifier.name] = self.read_strands(owner, f"hair {modifier.particle_system.name}", material, strands)
            model.poses.extend(flat(np.eye(4)) if strands else [])

    # ----- where it is

    def bounds(self):
        """A ball around everything, for lamps that are far away."""
        from mathutils import Vector

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
        count = len(model.poses) // 16
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
    return moving(*(np.frombuffer(poses)[16 * number : 16 * number + 16].reshape(4, 4) for poses in (model.poses, model.ends or model.poses)), "ConcatTransform")


def copies(model, name):
    """Lines of each instance."""
    if model.ends:
        for number in range(len(model.poses) // 16):
            yield "\n".join(["AttributeBegin", *placed(model, number), f'ObjectInstance "{name}"', "AttributeEnd"])
        return
    columns = np.frombuffer(model.poses).reshape(-1, 4, 4).transpose(0, 2, 1).reshape(-1, 16)
    pattern = "AttributeBegin ConcatTransform [ " + " ".join(["%.9g"] * 16) + f' ] ObjectInstance "{name}" AttributeEnd'
    for chunk in range(0, len(columns), 65536):
        for row in columns[chunk : chunk + 65536].tolist():
            yield pattern % tuple(row)
