"""What the panels set: of a scene, a material and a lamp."""
import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty

from . import develop
from .darkroom import DarkroomSettings
from .export import spectra


class SceneSettings(bpy.types.PropertyGroup):
    samples: IntProperty(name="Samples", description="Samples per pixel. More are added to those that are there", default=64, min=1, soft_max=4096)
    integrator: EnumProperty(name="Integrator", items=[("PATH", "Path tracing", "From the camera"), ("BDPT", "Bidirectional", "From the camera and from lamps: for caustics")])
    max_depth: IntProperty(name="Bounces", description="Scattering vertices of the longest path", default=16, min=0, max=1024)
    record: EnumProperty(name="Records", items=[("SPECTRAL", "Spectral", "A value for each wavelength: observers, films and lamps can be chosen later"),
                                                ("XYZ", "XYZ", "Colours only: a sixth of the space")])
    light_groups: EnumProperty(name="Light groups", items=[("NONE", "None", ""), ("LAMPS", "Each lamp", "Lamps and objects that emit, by name"),
                                                           ("COLLECTIONS", "Collections", "All that is in a collection")])
    layers: EnumProperty(name="Passes", options={"ENUM_FLAG"}, items=[(name, made[0], "") for name, made in develop.PASSES.items()])
    keep_time: BoolProperty(name="Keep the time", description="Store when each sample was taken, to shorten the exposure later")
    portals: BoolProperty(name="Sky through portals only", description="Less noise indoors. The sky is black where it is seen beside a portal")
    seed: IntProperty(name="Seed", default=0, min=0)
    folder: StringProperty(name="Folder", description="Scenes, samples and pictures", subtype="DIR_PATH", default="//latent")
    farm_folder: StringProperty(name="Plan", description="Where latent-farm writes its plan", subtype="DIR_PATH", default="//latent/farm")
    darkroom: bpy.props.PointerProperty(type=DarkroomSettings)
    render_options: StringProperty(name="Render", description="Further options of latent-render")
    develop_options: StringProperty(name="Develop", description="Further options of latent-develop, such as --dim-fireflies")


class MaterialSettings(bpy.types.PropertyGroup):
    metal: EnumProperty(name="Metal", description="Measured index of refraction, for Glossy and for Principled of Metallic 1",
                        items=[("NONE", "By colour", ""), *((name, name, "") for name in spectra.METALS)])
    glass: EnumProperty(name="Glass", description="Index of refraction at every wavelength", items=[("NONE", "By IOR", ""), *((name, name, "") for name in spectra.GLASSES)])
    abbe: FloatProperty(name="Abbe number", description="Dispersion: 60 is little, 25 much; 0 is none", default=0, min=0, max=200)
    reflectance: StringProperty(name="Reflectance", description="CSV of wavelength in nm and reflectance, instead of the colour", subtype="FILE_PATH")


class LampSettings(bpy.types.PropertyGroup):
    spectrum: EnumProperty(name="Spectrum", items=[("COLOR", "Colour", "A smooth spectrum of the lamp's colour"), ("DAYLIGHT", "Daylight", ""), ("BLACKBODY", "Blackbody", ""),
                                                   ("SODIUM", "Sodium", ""), *((key, label, "") for key, label in spectra.LAMPS)])
    kelvin: FloatProperty(name="Temperature", description="Kelvin", default=5000, min=1000, max=25000)
    visible: EnumProperty(name="Visible", items=[("AUTO", "Outside of the picture", "To mirrors, unless the camera may see it, too; Cycles shows lamps to mirrors alone"),
                                                 ("ALWAYS", "Always", "To the camera and to mirrors"), ("NEVER", "Never", "It only shines")])


class Preferences(bpy.types.AddonPreferences):
    bl_idname = __package__
    tools: StringProperty(name="Folder of the programs", description="Where latent-render is; empty: on the PATH", subtype="DIR_PATH")

    def draw(self, _):
        self.layout.prop(self, "tools")


CLASSES = (SceneSettings, MaterialSettings, LampSettings, Preferences)
OWNERS = ((bpy.types.Scene, SceneSettings), (bpy.types.Material, MaterialSettings), (bpy.types.Light, LampSettings))
