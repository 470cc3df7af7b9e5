// render/scene/description.h: what a scene file says, resolved: plain data that geometry, lights and materials are built from.
// Conventions are pbrt-v4's (docs/scenes.md): left-handed coordinates; directions of the world's, places counted from `origin`,
// unless said otherwise.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "color/rgb_basis.h"
#include "color/spectrum.h"
#include "render/math/vec.h"
#include "render/scene/measured_brdf.h"
#include "render/scene/source_location.h"
#include "render/scene/texture.h"
#include "render/scene/volume.h"

namespace latent::render {

inline constexpr std::uint32_t kUnlimited = 0xFFFFFFFF;  // depth without a bound

struct FilmDescription {
    // Their ratio is the film's aspect; the numbers count samples for --spp, and set the footprint of textures.
    std::uint32_t width = 1280, height = 720;
};

enum class CameraKind : std::uint8_t { kPerspective, kOrthographic, kSpherical };
enum class SphericalMapping : std::uint8_t { kEqualArea, kEquirectangular };

// Camera space: x right in the image, y up, z forward (left-handed). Film point (u, v) is the point
// (x0 + u (x1 - x0), y1 + v (y0 - y1)) of the window, which lies at z = 1 for a perspective camera.
struct CameraDescription {
    CameraKind kind = CameraKind::kPerspective;
    Affined world_from_camera{};
    std::optional<Affined> end{};             // that world_from_camera becomes at the end of the motion; nothing: it stays
    double x0 = -1, x1 = 1, y0 = -1, y1 = 1;  // the visible window; fov and screenwindow are resolved into it
    double lens_radius = 0, focal_distance = 1e6;
    double focal_slope = 0;  // [per nm] focal_distance is that of 595 nm; where a lens tells wavelengths apart, others differ
    SphericalMapping mapping = SphericalMapping::kEqualArea;
    std::uint32_t medium = kNone;
    SourceLocation location{};
};

// What light does at a surface: the name of a closure (render/bsdf/closures.h) and, by name, of what it is made; or "mix", a choice
// at each point between two other materials: of the second with the number "amount", or, in each wavelength, the spectrum
// "selector".
struct MaterialDescription {
    std::string type = "diffuse";
    std::string name{};  // as MakeNamedMaterial gives it; else empty
    // An input that is in none of these maps has the default of its closure.
    std::map<std::string, FloatInput, std::less<>> numbers{};
    std::map<std::string, SpectrumInput, std::less<>> spectra{};
    std::map<std::string, std::uint32_t, std::less<>> options{};  // flags, choices, counts
    bool remap_roughness = false;                                 // where a texture gives a facet's alpha, it gives alpha squared
    std::shared_ptr<const MeasuredBrdf> measured{};               // for a closure that is made of measurements
    FloatInput displacement{};                                    // along the normal, by a texture alone
    std::uint32_t normal_map = kNone;       // index into SceneDescription::textures, unless there is a displacement
    float normal_scale = 1;                 // factor of its x and y
    bool normals_follow_v = false;          // its y axis is that of v; else it is to the left of its x axis, that of u
    std::uint32_t coat_normal_map = kNone;  // the same of a coat, which else has the normals of the shape
    float coat_normal_scale = 1;
    std::array<std::uint32_t, 2> mixed{kNone, kNone};  // mix: materials
    SourceLocation location{};

    FloatInput number(std::string_view input, float otherwise = 0) const {
        const auto found = numbers.find(input);
        return found != numbers.end() ? found->second : FloatInput(otherwise);
    }
};

// Media that may add up to one, their sums resolved; what is scattered by each is kept apart (render/bsdf/phase.h).
inline constexpr std::uint32_t kMaxSummed = 7;

// Henyey-Greenstein. sigma_a and sigma_s are scaled by the density of the volume, which is 1 everywhere if it is uniform; a
// spectral volume replaces them.
struct MediumDescription {
    std::string name{};
    color::Spectrum sigma_a{}, sigma_s{};  // 1/m, `scale` not applied
    double scale = 1, g = 0;
    color::Spectrum Le{};  // radiance that absorbing matter emits
    double Le_scale = 1;
    Volume volume{};
    std::array<std::uint32_t, 2> summed{kNone, kNone};  // instead of all this: media that are both there
    // Not of a uniform volume: its place, and the box in its own space outside of which it is empty.
    Affined world_from_medium{};
    Vec3d low{0, 0, 0}, high{1, 1, 1};
    SourceLocation location{};
};

// Emission everywhere: `spectrum` is what is emitted, lines widened, normalised to Y = 1 (an rgb: so that its illuminant has);
// radiance or intensity is scale x spectrum, and `power` or `illuminance`, where given, further scale it as pbrt does.
struct AreaLightDescription {
    color::Spectrum spectrum{};
    double scale = 1;
    std::optional<double> power{};  // for each triangle, patch or sphere by itself
    bool two_sided = false;         // else emits on the side of the geometric normal
    std::uint32_t picture = kNone;  // index into SceneDescription::textures: a spectrum that varies, times the other one
    double mean_luminance = 1;      // mean of that picture
    double exponent = 0;            // radiance is that of the normal times cos^exponent
    std::string name{};             // "": none
    std::uint32_t group = 0;        // LightGroups (scene/light_groups.h); 0 unless the job asks for them
    SourceLocation location{};
};

// Linear rgb with sRGB primaries, rows from the top. Of all directions: the square of pbrt's equal-area octahedral mapping.
struct ImageDescription {
    std::uint32_t width = 0, height = 0;
    std::vector<float> rgb{};
};

enum class LightKind : std::uint8_t { kPoint, kSpot, kDistant, kInfinite, kGoniometric, kProjection };

struct LightDescription {
    LightKind kind = LightKind::kPoint;
    color::Spectrum spectrum{};  // for an image, the normalised illuminant that its rgb multiplies
    double scale = 1;
    std::optional<double> power{};        // those of a point
    std::optional<double> illuminance{};  // distant, infinite
    Affined world_from_light{};           // the current transformation alone; `from` and `to` are not part of it
    Vec3d from{0, 0, 0}, to{0, 0, 1};     // in light space: point, spot and distant
    double cone_degrees = 30, cone_delta_degrees = 5;
    double fov_degrees = 90;                          // projection: of the shorter side
    std::shared_ptr<const ImageDescription> image{};  // goniometric, projection; infinite: or null, constant
    // Infinite: corners, in turn, of a rectangle in the world (not in light space), through which alone it shines.
    std::optional<std::array<Vec3d, 4>> portal{};
    std::uint32_t medium = kNone;  // that a point or spot light lies in
    std::string name{};            // "": none
    std::uint32_t group = 0;       // as an area light's
    SourceLocation location{};
};

enum class ShapeKind : std::uint8_t { kTriangles, kBilinear, kTube, kSphere, kDisk, kCylinder };

// Triangles, patches or tubes. Vertices are in the space of the world or of the object that the shape belongs to, counted from the
// origin of either.
struct MeshDescription {
    std::vector<Vec3f> positions{};  // for tubes, the points of cubic Bezier curves, their axes
    std::vector<Vec3f> normals{};    // per vertex, unit length, or empty; for tubes, per segment: where v = 0 as it begins
    // Per vertex, of any length, or empty: where u and v run for normal maps and anisotropy, instead of along dp/du and dp/dv.
    std::vector<Vec3f> tangents{}, bitangents{};
    std::vector<Vec2f> uvs{};                    // per vertex, or empty
    std::vector<std::vector<Vec2f>> more_uvs{};  // further sets, each per vertex
    std::vector<std::array<float, 4>> colors{};  // linear sRGB and alpha, per vertex, or empty
    std::vector<float> radii{};                  // for tubes, per point
    std::vector<std::uint32_t> indices{};  // 3 per triangle, 4 per patch (p00 p10 p01 p11); for tubes: the first of four points
};

struct ShapeDescription {
    ShapeKind kind = ShapeKind::kTriangles;
    std::shared_ptr<const MeshDescription> mesh{};
    Affined to_world{};  // quadrics: from their own space
    // Quadrics: |p| = radius of a sphere; inner_radius <= |(x, y)| <= radius at z = height of a disk; |(x, y)| = radius of a
    // cylinder.
    double radius = 1, inner_radius = 0, height = 0;
    double z_min = -1, z_max = 1;    // for a sphere and a cylinder, the part between these, not beyond the sphere
    double phi_max_degrees = 360;    // the part up to this angle from x about z
    bool flip_normal = false;        // triangles: ng = -(p1 - p0) x (p2 - p0); tubes and quadrics: ng points inwards, down
    bool ribbon = false;             // for hair: v runs across a fibre from 0 to 1
    bool pairs = false;              // triangles 2 i and 2 i + 1 are the halves of a flat patch
    FloatInput alpha = 1;            // share of the surface that is there; the rest are holes, too fine to see
    std::uint32_t material = kNone;  // kNone: "interface", which scatters nothing
    std::uint32_t area_light = kNone;
    std::uint32_t inside_medium = kNone, outside_medium = kNone;  // equal: crossing the surface changes nothing, as in pbrt
    // Is seen, also in mirrors and through clear glass, and that is all: it hides no light from anything and gives none to it.
    bool backdrop = false;
    SourceLocation location{};
};

inline bool is_nowhere(const FloatInput& alpha) { return !alpha.is_textured() && !(alpha.value > 0); }

// Shapes that are placed several times; they carry no area lights.
struct ObjectDescription {
    std::string name{};
    Vec3d origin{};  // that the shapes are counted from, in the space that they were modelled in
    std::vector<ShapeDescription> shapes{};
};
struct InstanceDescription {
    std::uint32_t object = 0;
    Affined world_from_object{};   // between the two origins
    std::optional<Affined> end{};  // that it becomes at the end of its motion, about the point that was the object's origin
    SourceLocation location{};
};

// Where all motions stand when the shutter opens and when it closes: 0 at their start, 1 at their end. Before and after nothing
// moves.
struct ShutterDescription {
    double open = 0, close = 1;
};

struct SceneDescription {
    std::vector<std::string> files{};  // that directives were read from; locations refer to them
    FilmDescription film;
    Vec3d origin{};  // in world space, as the file has it: near what floats are to tell apart
    CameraDescription camera;
    ShutterDescription shutter{};
    color::RgbSpectra rgb_spectra = color::RgbSpectra::kSmooth;  // what an rgb stands for
    std::string integrator = "volpath";                          // as the scene names it
    std::uint32_t max_depth = 5;
    std::vector<TextureDescription> textures{};
    std::vector<MaterialDescription> materials{};
    std::vector<MediumDescription> media{};
    std::vector<LightDescription> lights{};
    std::vector<AreaLightDescription> area_lights{};
    std::vector<ShapeDescription> shapes{};
    std::vector<ObjectDescription> objects{};
    std::vector<InstanceDescription> instances{};
};

inline bool has_motion(const SceneDescription& scene) {
    const auto moves = [](const InstanceDescription& instance) { return instance.end.has_value(); };
    return scene.camera.end.has_value() || std::any_of(scene.instances.begin(), scene.instances.end(), moves);
}

inline bool has_backdrops(const SceneDescription& scene) {
    const auto any = [](const std::vector<ShapeDescription>& shapes) {
        return std::ranges::any_of(shapes, &ShapeDescription::backdrop);
    };
    return any(scene.shapes) ||
           std::ranges::any_of(scene.objects, [&](const ObjectDescription& object) { return any(object.shapes); });
}

}  // namespace latent::render
