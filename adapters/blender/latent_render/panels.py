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
    column, size = layout.column(align=True), 6.5 * bpy.context.preferences.system.ui_scale  # pixels of a letter
    for number, line in enumerate(textwrap.wrap(text, max(16, int(bpy.context.region.width / size) - 8) if bpy.context.region else 80)):
        column.label(text=line, icon="BLANK1" if number else icon)


# ----- what stands below the fields of a panel


def job(layout, _):
    layout.operator("latent.clean")


def samples(layout, _):
    if engine.last["word"]:
        wrapped(layout, engine.last["word"], "INFO")


def motion(layout, context):
    render = context.scene.render
    layout.prop(render, "use_motion_blur")
    layout.prop(render if hasattr(render, "motion_blur_position") else context.scene.cycles, "motion_blur_position", text="Position")
    layout.prop(render, "motion_blur_shutter", text="Shutter")


def lost(layout, _):
    for line in engine.last["lost"]:
        wrapped(layout, line, "ERROR")
    if engine.last["wanted"]:
        layout.operator("latent.bake")


def darkroom(layout, context):
    for light in context.scene.latent.darkroom.mix:
        row = layout.row(align=True)
        row.prop(light, "factor", text=light.name)
        row.prop(light, "mute", text="", icon="HIDE_ON" if light.mute else "HIDE_OFF")
        row.prop(light, "solo", text="", icon="SOLO_ON" if light.solo else "SOLO_OFF")
        layout.prop(light, "change")
    layout.operator("latent.develop")
    layout.operator("latent.darkroom")


def farm(layout, _):
    row = layout.row()
    row.operator("latent.farm", text="Plan this frame").animation = False
    row.operator("latent.farm", text="Plan all frames").animation = True


def lamp(layout, context):
    if context.light.latent.spectrum in ("DAYLIGHT", "BLACKBODY"):
        layout.prop(context.light.latent, "kelvin")
    layout.prop(context.light.latent, "visible")
    if context.light.type == "AREA":
        layout.prop(context.light, "spread")


def panel(label, context, *fields, settings=lambda context: context.scene.latent, more=None, closed=False):
    """A class that shows some properties of what `settings` returns, if there is such a thing, and then what `more` adds."""

    def draw(self, context):
        self.layout.use_property_split = True
        for name in fields:
            self.layout.prop(settings(context), name)
        if more:
            more(self.layout, context)

    shown = classmethod(lambda _, context: context.engine == "LATENT" and bool(settings(context)))
    return type(f"LATENT_PT_{label.replace(' ', '_').lower()}", (bpy.types.Panel,), {
        "bl_label": label, "bl_context": context, "bl_space_type": "PROPERTIES", "bl_region_type": "WINDOW",
        "bl_options": {"DEFAULT_CLOSED"} if closed else set(), "COMPAT_ENGINES": {"LATENT"}, "draw": draw, "poll": shown})


CLASSES = (
    panel("Samples", "render", "samples", "integrator", "max_depth", "record", "light_groups", more=samples),
    panel("Not exported", "render", settings=lambda _: engine.last["lost"], more=lost),
    panel("Darkroom", "render", "observer", "film", "paper", "stops", "noise", "aperture", "shutter",
          settings=lambda context: context.scene.latent.darkroom, more=darkroom),
    panel("Motion Blur", "render", more=motion, closed=True),
    panel("Job", "render", "folder", "seed", "portals", "keep_time", "render_options", "develop_options", more=job, closed=True),
    panel("Farm", "render", "farm_folder", more=farm, closed=True),
    panel("Passes", "view_layer", "layers"),
    panel("Spectra", "material", "metal", "glass", "abbe", "reflectance", settings=lambda context: context.material and context.material.latent),
    panel("Spectrum", "data", "spectrum", settings=lambda context: context.light and context.light.latent, more=lamp),
)
