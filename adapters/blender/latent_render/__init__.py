"""Latent as a render engine of Blender (docs/blender.md)."""
bl_info = {
    "name": "Latent",
    "description": "Render raw spectral samples, and develop them into pictures",
    "author": "The Latent project",
    "version": (0, 2, 0),
    "blender": (3, 4, 0),
    "location": "Render properties, Render Engine",
    "category": "Render",
}


import bpy  # noqa: E402  Blender reads what is above without running it

from . import darkroom, engine, panels, properties  # noqa: E402

CLASSES = (*darkroom.CLASSES, *properties.CLASSES, *panels.CLASSES, engine.LatentEngine)


def register():
    for made in CLASSES:
        bpy.utils.register_class(made)
    for owner, settings in properties.OWNERS:
        owner.latent = bpy.props.PointerProperty(type=settings)
    for panel in panels.shared_panels():
        panel.COMPAT_ENGINES = panel.COMPAT_ENGINES | {"LATENT"}  # a set of its own: others inherit the old one


def unregister():
    for panel in panels.shared_panels():
        panel.COMPAT_ENGINES = panel.COMPAT_ENGINES - {"LATENT"}
    for owner, _ in properties.OWNERS:
        del owner.latent
    for made in reversed(CLASSES):
        bpy.utils.unregister_class(made)
