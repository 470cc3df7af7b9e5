#include "render/load/model/cover.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>

#include "render/math/equal_area.h"

namespace latent::render {

namespace {

// The distance along d to a triangle, its edges included; infinite if it is missed.
double distance_to(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& from, const Vec3d& d) {
    constexpr double kMissed = std::numeric_limits<double>::infinity(), kEdge = -1e-9;
    const Vec3d ab = b - a, ac = c - a, p = cross(d, ac), o = from - a, q = cross(o, ab);
    const double determinant = dot(ab, p);
    if (determinant == 0) return kMissed;
    const double u = dot(o, p) / determinant, v = dot(d, q) / determinant, t = dot(ac, q) / determinant;
    return t > 0 && u >= kEdge && v >= kEdge && u + v <= 1 - kEdge ? t : kMissed;
}

// The shapes that a ray meets first and last, or kNone.
struct Met {
    std::uint32_t first = kNone, last = kNone;
};
Met met_by(std::span<const LoadedShape> shapes, const Vec3d& from, const Vec3d& d) {
    Met met;
    double nearest = std::numeric_limits<double>::infinity(), farthest = 0;
    for (std::uint32_t i = 0; i < shapes.size(); ++i) {
        if (!shapes[i].mesh || shapes[i].shape.kind != ShapeKind::kTriangles) continue;
        const std::vector<Vec3d>& p = shapes[i].mesh->positions;
        const std::vector<std::uint32_t>& corners = shapes[i].mesh->indices;
        for (std::size_t k = 0; k + 2 < corners.size(); k += 3) {
            const double t = distance_to(p[corners[k]], p[corners[k + 1]], p[corners[k + 2]], from, d);
            if (!std::isfinite(t)) continue;
            if (t < nearest) {
                nearest = t;
                met.first = i;
            }
            if (t > farthest) {
                farthest = t;
                met.last = i;
            }
        }
    }
    return met;
}

SpectrumInput color_of(std::uint32_t index, const SceneDescription& scene) {
    if (index == kNone) return color::Spectrum::constant(0.5);
    const MaterialDescription& material = scene.materials[index];
    if (material.type == "mix") return color_of(material.mixed[0], scene);
    for (const char* name : {"base_color", "reflectance"}) {
        if (const auto found = material.spectra.find(name); found != material.spectra.end()) return found->second;
    }
    return color::Spectrum::constant(0.5);
}

}  // namespace

std::vector<std::uint32_t> covers_of_sky(std::span<const LoadedShape> shapes, const Vec3d& from, const Vec3d& up) {
    constexpr int kSide = 24;
    std::set<std::uint32_t> visible, outermost;
    for (int i = 0; i < kSide * kSide; ++i) {
        const auto middle = [](int cell) { return (static_cast<float>(cell) + 0.5f) / kSide; };
        const Vec3d d(sphere_from_square({middle(i % kSide), middle(i / kSide)}));
        const Met met = met_by(shapes, from, d);
        if (met.first == kNone) return {};
        if (dot(d, up) <= 0) continue;
        visible.insert(met.first);
        outermost.insert(met.last);
    }
    std::vector<std::uint32_t> covers;
    std::ranges::set_intersection(visible, outermost, std::back_inserter(covers));
    if (covers.empty()) covers.assign(visible.begin(), visible.end());
    return covers;
}

void let_shine(const std::vector<std::uint32_t>& covers, const color::Spectrum& white, Model& model) {
    SceneDescription& scene = model.scene;
    for (const std::uint32_t cover : covers) {
        ShapeDescription& shape = model.shapes[cover].shape;
        if (shape.area_light != kNone) continue;
        TextureDescription color{.kind = TextureKind::kScale, .is_spectrum = true, .amount = 1};
        color.spectra[0] = color_of(shape.material, scene);
        shape.area_light = static_cast<std::uint32_t>(scene.area_lights.size());
        scene.area_lights.push_back(
            {.spectrum = white, .two_sided = true, .picture = static_cast<std::uint32_t>(scene.textures.size())});
        scene.textures.push_back(std::move(color));
        model.radiances.push_back(1);
    }
}

}  // namespace latent::render
