"""Panels, and those of Blender that apply to this engine, too."""
import textwrap

import bpy

from . import engine

# Panels of other engines that set what is exported.
SHARED = {"EEVEE_MATERIAL_PT_surface", "EEVEE_MATERIAL_PT_volume", "EEVEE_WORLD_PT_surface", "DATA_PT_EEVEE_light", "DATA_PT_spot", "EEVEE_MATERIAL_PT_context_material",
          "EEVEE_NEXT_MATERIAL_PT_surface", "DATA_PT_camera_dof", "DATA_PT_camera_dof_aperture"}
UNUSED = {"RENDER_PT_simplify_greasepencil", "VIEWLAYER_PT_filter", "VIEWLAYER_PT_layer_passes", "RENDER_PT_stereoscopy",
          "DATA_PT_light", "DATA_PT_area"}  # the last two: DATA_PT_EEVEE_light says the same


def shared_panels():
    for panel in bpy.types.Panel.__subclasses__():
        engines = getattr(panel, "COMPAT_ENGINES", None)
        if engines is not None and panel.__name__ not in UNUSED and "freestyle" not in panel.__name__ and ("BLENDER_RENDER" in engines or panel.__name__ in SHARED):
            yield panel


def wrapped(layout, text, icon):
    """A text in as many lines as the panel needs."""
    column, size = layout.column(align=True), 6.5 * bpy.context.preferences.system.ui_scale  # pixels of a letter
    for number, line in enumerate(textwrap.wrap(text, max(16, int(bpy.context.region.width / size) - 8) if bpy.context.region else 80)):
        column.label(text=line, icon="BLANK1" if number else icon)


class LatentPanel:
    """Shows the properties in FIELDS of what `settings` returns, if there is such a thing; subclasses add to it."""

    bl_space_type, bl_region_type, bl_context = "PROPERTIES", "WINDOW", "render"
    COMPAT_ENGINES, FIELDS = {"LATENT"}, ()
    settings = staticmethod(lambda context: context.scene.latent)

    @classmethod
    def poll(cls, context):
        return context.engine == "LATENT" and bool(cls.settings(context))

    def draw(self, context):
        self.layout.use_property_split = True
        for name in self.FIELDS:
            self.layout.prop(self.settings(context), name)
        self.more(self.layout, context)

    def more(self, layout, context):
        pass


class LATENT_PT_samples(LatentPanel, bpy.types.Panel):
    bl_label, FIELDS = "Samples", ("samples", "integrator", "max_depth", "record", "light_groups")

    def more(self, layout, _):
        if engine.last["word"]:
            wrapped(layout, engine.last["word"], "INFO")


class LATENT_PT_motion(LatentPanel, bpy.types.Panel):
    bl_label, bl_options = "Motion Blur", {"DEFAULT_CLOSED"}

    def draw_header(self, context):
        self.layout.prop(context.scene.render, "use_motion_blur", text="")

    def more(self, layout, context):
        render = context.scene.render
        layout.prop(render if hasattr(render, "motion_blur_position") else context.scene.cycles, "motion_blur_position", text="Position")
        layout.prop(render, "motion_blur_shutter", text="Shutter")


class LATENT_PT_job(LatentPanel, bpy.types.Panel):
    bl_label, bl_options, FIELDS = "Job", {"DEFAULT_CLOSED"}, ("folder", "seed", "portals", "keep_time", "render_options", "develop_options")

    def more(self, layout, _):
        layout.operator("latent.clean")


class LATENT_PT_lost(LatentPanel, bpy.types.Panel):
    bl_label, settings = "Not exported", staticmethod(lambda _: engine.last["lost"])

    def more(self, layout, context):
        for line in self.settings(context):
            wrapped(layout, line, "ERROR")
        if engine.last["wanted"]:
            layout.operator("latent.bake")


class LATENT_PT_darkroom(LatentPanel, bpy.types.Panel):
    bl_label, FIELDS = "Darkroom", ("observer", "film", "paper", "stops", "noise", "aperture", "shutter")
    settings = staticmethod(lambda context: context.scene.latent.darkroom)

    def more(self, layout, context):
        for light in self.settings(context).mix:
            row = layout.row(align=True)
            row.prop(light, "factor", text=light.name)
            row.prop(light, "mute", text="", icon="HIDE_ON" if light.mute else "HIDE_OFF")
            row.prop(light, "solo", text="", icon="SOLO_ON" if light.solo else "SOLO_OFF")
            layout.prop(light, "change")
        layout.operator("latent.develop")
        layout.operator("latent.darkroom")


class LATENT_PT_farm(LatentPanel, bpy.types.Panel):
    bl_label, bl_options, FIELDS = "Farm", {"DEFAULT_CLOSED"}, ("farm_folder",)

    def more(self, layout, _):
        row = layout.row()
        row.operator("latent.farm", text="Plan this frame").animation = False
        row.operator("latent.farm", text="Plan all frames").animation = True


class LATENT_PT_passes(LatentPanel, bpy.types.Panel):
    bl_label, bl_context, FIELDS = "Passes", "view_layer", ("layers",)


class LATENT_PT_material(LatentPanel, bpy.types.Panel):
    bl_label, bl_context, FIELDS = "Spectra", "material", ("metal", "glass", "abbe", "reflectance")
    settings = staticmethod(lambda context: context.material and context.material.latent)


class LATENT_PT_lamp(LatentPanel, bpy.types.Panel):
    bl_label, bl_context, FIELDS = "Spectrum", "data", ("spectrum",)
    settings = staticmethod(lambda context: context.light and context.light.latent)

    def more(self, layout, context):
        if self.settings(context).spectrum in ("DAYLIGHT", "BLACKBODY"):
            layout.prop(self.settings(context), "kelvin")
        layout.prop(self.settings(context), "visible")
        if context.light.type == "AREA":
            layout.prop(context.light, "spread")


CLASSES = (LATENT_PT_samples, LATENT_PT_lost, LATENT_PT_darkroom, LATENT_PT_motion, LATENT_PT_job, LATENT_PT_farm, LATENT_PT_passes, LATENT_PT_material, LATENT_PT_lamp)
