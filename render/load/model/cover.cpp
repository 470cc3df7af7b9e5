#include "render/load/model/cover.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "render/math/equal_area.h"

namespace latent::render {

namespace {

constexpr double kMissed = std::numeric_limits<double>::infinity();
constexpr double kFar = 5;  // times the distance of other things: the picture of a sky, no wall

// The distance along d to a triangle, its edges included.
double distance_to(const std::array<Vec3d, 3>& p, const Vec3d& from, const Vec3d& d) {
    constexpr double kEdge = -1e-9;
    const Vec3d ab = p[1] - p[0], ac = p[2] - p[0], o = from - p[0], x = cross(d, ac), y = cross(o, ab);
    const double determinant = dot(ab, x);
    if (determinant == 0) return kMissed;
    const double u = dot(o, x) / determinant, v = dot(d, y) / determinant, t = dot(ac, y) / determinant;
    return t > 0 && u >= kEdge && v >= kEdge && u + v <= 1 - kEdge ? t : kMissed;
}

bool is_clear(std::uint32_t material, const SceneDescription& scene) {
    if (material == kNone) return true;
    const MaterialDescription& m = scene.materials[material];
    if (m.type == "mix") return is_clear(m.mixed[0], scene) || is_clear(m.mixed[1], scene);
    return m.type == "dielectric" || m.type == "thindielectric";
}

bool is_opaque(const LoadedShape& loaded, const SceneDescription& scene) {
    const ShapeDescription& shape = loaded.shape;
    return loaded.mesh && shape.kind == ShapeKind::kTriangles && !shape.alpha.is_textured() && shape.alpha.value >= 1 &&
           !is_clear(shape.material, scene);
}

// The first and the last opaque surface along a ray.
struct Met {
    double first_distance = kMissed, last_distance = 0;
    std::uint32_t first = kNone, last = kNone;  // indices into Model::shapes; kNone: an instance

    void add(const LoadedMesh& mesh, const Affined& to_world, std::uint32_t shape, const Vec3d& from, const Vec3d& d) {
        for (std::size_t k = 0; k + 2 < mesh.indices.size(); k += 3) {
            std::array<Vec3d, 3> p;
            for (std::size_t c = 0; c < 3; ++c) p[c] = to_world.point(mesh.positions[mesh.indices[k + c]]);
            const double t = distance_to(p, from, d);
            if (t == kMissed) continue;
            if (t < first_distance) {
                first_distance = t;
                first = shape;
            }
            if (t > last_distance) {
                last_distance = t;
                last = shape;
            }
        }
    }
};

Met met_by(const Model& model, const Vec3d& from, const Vec3d& d) {
    Met met;
    for (std::uint32_t i = 0; i < model.shapes.size(); ++i) {
        if (is_opaque(model.shapes[i], model.scene)) met.add(*model.shapes[i].mesh, {}, i, from, d);
    }
    for (const InstanceDescription& instance : model.scene.instances) {
        for (const LoadedShape& shape : model.objects[instance.object]) {
            if (is_opaque(shape, model.scene)) met.add(*shape.mesh, instance.world_from_object, kNone, from, d);
        }
    }
    return met;
}

double median(std::vector<double> x) {
    const auto middle = x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2);
    std::ranges::nth_element(x, middle);
    return *middle;
}

SpectrumInput color_of(std::uint32_t material, const SceneDescription& scene) {
    const MaterialDescription& m = scene.materials[material];
    if (m.type == "mix") return color_of(m.mixed[0], scene);
    for (const char* name : {"base_color", "reflectance"}) {
        if (const auto found = m.spectra.find(name); found != m.spectra.end()) return found->second;
    }
    return color::Spectrum::constant(0.5);
}

}  // namespace

std::optional<Cover> cover_of_sky(const Model& model, const Vec3d& up) {
    constexpr int kSide = 24;
    const Vec3d& from = model.scene.camera.world_from_camera.t;
    std::vector<Met> seen;
    std::set<std::uint32_t> outermost;
    for (int i = 0; i < kSide * kSide; ++i) {
        const auto middle = [](int cell) { return (static_cast<float>(cell) + 0.5f) / kSide; };
        const Vec3d d(sphere_from_square({middle(i % kSide), middle(i / kSide)}));
        seen.push_back(met_by(model, from, d));
        if (seen.back().first_distance == kMissed) return std::nullopt;
        if (dot(d, up) > 0 && seen.back().first != kNone && seen.back().first == seen.back().last)
            outermost.insert(seen.back().last);
    }
    std::vector<double> near, far;
    for (const Met& met : seen) (outermost.contains(met.first) ? far : near).push_back(met.first_distance);
    Cover cover;
    if (!near.empty() && !far.empty() && median(far) >= kFar * median(near)) cover.skies.assign(outermost.begin(), outermost.end());
    near.insert(near.end(), far.begin(), far.end());
    cover.distance = median(near);
    return cover;
}

void light_up(const Cover& cover, const color::Spectrum& white, Model& model) {
    SceneDescription& scene = model.scene;
    for (const std::uint32_t i : cover.skies) {
        ShapeDescription& shape = model.shapes[i].shape;
        if (shape.area_light != kNone) continue;
        TextureDescription color{.kind = TextureKind::kScale, .is_spectrum = true, .amount = 1};
        color.spectra[0] = color_of(shape.material, scene);
        shape.area_light = static_cast<std::uint32_t>(scene.area_lights.size());
        scene.area_lights.push_back(
            {.spectrum = white, .two_sided = true, .picture = static_cast<std::uint32_t>(scene.textures.size())});
        scene.textures.push_back(std::move(color));
        model.radiances.push_back(1);
    }
    if (!cover.skies.empty()) return;
    LightDescription lamp;
    lamp.spectrum = white;
    lamp.scale = std::numbers::pi * cover.distance * cover.distance;
    lamp.from = scene.camera.world_from_camera.t;
    scene.lights.push_back(std::move(lamp));
}

}  // namespace latent::render
