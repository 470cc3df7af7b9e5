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
// From the camera to a sky: in metres, the unit of glTF, and over the distance of other things. Halls are smaller.
constexpr double kSkyDistance = 25, kSkyRatio = 2;

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
};

// Rays from one place, spread evenly over the sphere.
class Rays {
 public:
    static constexpr std::size_t kSide = 24, kCount = kSide * kSide;

    explicit Rays(const Vec3d& from) : from_(from) {
        const auto middle = [](std::size_t cell) { return (static_cast<float>(cell) + 0.5f) / kSide; };
        for (std::size_t i = 0; i < kCount; ++i) {
            const Vec3f d = sphere_from_square({middle(i % kSide), middle(i / kSide)});
            x_[i] = d.x, y_[i] = d.y, z_[i] = d.z;
        }
    }
    Vec3d direction(std::size_t i) const { return Vec3d(Vec3f(x_[i], y_[i], z_[i])); }
    const std::array<Met, kCount>& met() const { return met_; }

    void add(const LoadedMesh& mesh, const Affined& to_world, std::uint32_t shape) {
        for (std::size_t k = 0; k + 2 < mesh.indices.size(); k += 3) {
            std::array<Vec3d, 3> p;
            for (std::size_t c = 0; c < 3; ++c) p[c] = to_world.point(mesh.positions[mesh.indices[k + c]]);
            add(p, shape);
        }
    }

 private:
    // Most rays pass beside the ball about a small triangle, which is quickly seen.
    void add(const std::array<Vec3d, 3>& p, std::uint32_t shape) {
        const Vec3d middle = (p[0] + p[1] + p[2]) * (1.0 / 3) - from_;
        double radius = 0;
        for (const Vec3d& corner : p) radius = std::max(radius, length(corner - from_ - middle));
        const double distance = length(middle), sine = distance > 0 ? radius / distance : 1;
        const Vec3f axis(distance > 0 ? middle * (1 / distance) : middle);
        const float cosine = sine < 1 ? static_cast<float>(std::sqrt(1 - sine * sine)) - 1e-4f : -2.0f;
        for (std::size_t i = 0; i < kCount; ++i) {
            if (x_[i] * axis.x + y_[i] * axis.y + z_[i] * axis.z < cosine) continue;
            const double t = distance_to(p, from_, direction(i));
            if (t == kMissed) continue;
            Met& met = met_[i];
            if (t < met.first_distance) {
                met.first_distance = t;
                met.first = shape;
            }
            if (t > met.last_distance) {
                met.last_distance = t;
                met.last = shape;
            }
        }
    }

    Vec3d from_;
    std::array<float, kCount> x_, y_, z_;
    std::array<Met, kCount> met_{};
};

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
    Rays rays(model.scene.camera.world_from_camera.t);
    for (std::uint32_t i = 0; i < model.shapes.size(); ++i) {
        if (is_opaque(model.shapes[i], model.scene)) rays.add(*model.shapes[i].mesh, {}, i);
    }
    for (const InstanceDescription& instance : model.scene.instances) {
        for (const LoadedShape& shape : model.objects[instance.object]) {
            if (is_opaque(shape, model.scene)) rays.add(*shape.mesh, instance.world_from_object, kNone);
        }
    }
    std::set<std::uint32_t> outermost;
    for (std::size_t i = 0; i < Rays::kCount; ++i) {
        const Met& met = rays.met()[i];
        if (met.first_distance == kMissed) return std::nullopt;
        if (dot(rays.direction(i), up) > 0 && met.first != kNone && met.first == met.last) outermost.insert(met.first);
    }
    std::vector<double> near, far;
    for (const Met& met : rays.met()) (outermost.contains(met.first) ? far : near).push_back(met.first_distance);
    Cover cover;
    if (!near.empty() && !far.empty() && median(far) >= std::max(kSkyDistance, kSkyRatio * median(near)))
        cover.skies.assign(outermost.begin(), outermost.end());
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
        shape.material = static_cast<std::uint32_t>(scene.materials.size());
        scene.materials.push_back({.spectra = {{"reflectance", color::Spectrum::constant(0)}}});
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
