#include "render/load/model/cover.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "render/math/equal_area.h"
#include "render/texture/textures.h"

namespace latent::render {

namespace {

constexpr double kOpaque = 0.9;  // an alpha that looks opaque

// Where a ray meets a triangle of a shape: u of the way along its first side, v along its last.
struct Met {
    double distance;
    LoadedShape* loaded;
    std::size_t triangle;  // index of its first corner
    double u, v;
};

// What it meets along d of the triangle p, edges included.
std::optional<Met> meet(const std::array<Vec3d, 3>& p, const Vec3d& from, const Vec3d& d) {
    constexpr double kEdge = -1e-9;
    const Vec3d ab = p[1] - p[0], ac = p[2] - p[0], o = from - p[0], x = cross(d, ac), y = cross(o, ab);
    const double determinant = dot(ab, x);
    if (determinant == 0) return std::nullopt;
    const double u = dot(o, x) / determinant, v = dot(d, y) / determinant, t = dot(ac, y) / determinant;
    if (!(t > 0 && u >= kEdge && v >= kEdge && u + v <= 1 - kEdge)) return std::nullopt;
    return Met{t, nullptr, 0, u, v};
}

bool is_clear(std::uint32_t material, const SceneDescription& scene) {
    if (material == kNone) return true;
    const MaterialDescription& m = scene.materials[material];
    if (m.type == "mix") return is_clear(m.mixed[0], scene) || is_clear(m.mixed[1], scene);
    return m.type == "dielectric" || m.type == "thindielectric";
}

// Whether it is opaque where no texture makes it transparent.
bool may_close(const LoadedShape& loaded, const SceneDescription& scene) {
    const ShapeDescription& shape = loaded.shape;
    return loaded.mesh && shape.kind == ShapeKind::kTriangles && (shape.alpha.is_textured() || shape.alpha.value > kOpaque) &&
           !is_clear(shape.material, scene);
}

// What a triangle has of a mesh for its textures.
MeshDescription corners_of(const LoadedMesh& mesh, std::size_t triangle) {
    MeshDescription out;
    out.more_uvs.resize(mesh.more_uvs.size());
    for (std::size_t c = 0; c < 3; ++c) {
        const std::uint32_t vertex = mesh.indices[triangle + c];
        if (!mesh.uvs.empty()) out.uvs.push_back(mesh.uvs[vertex]);
        for (std::size_t i = 0; i < mesh.more_uvs.size(); ++i) out.more_uvs[i].push_back(mesh.more_uvs[i][vertex]);
        if (!mesh.colors.empty()) out.colors.push_back(mesh.colors[vertex]);
    }
    return out;
}

double alpha_at(const Met& met, const Textures& textures) {
    const FloatSource alpha = textures.source(met.loaded->shape.alpha);
    const MeshDescription mesh = corners_of(*met.loaded->mesh, met.triangle);
    TexturePoint point{};
    point.vertices = {.mesh = &mesh,
                      .vertex = {0, 1, 2},
                      .weight = {static_cast<float>(1 - met.u - met.v), static_cast<float>(met.u), static_cast<float>(met.v)}};
    if (!mesh.uvs.empty()) point.uv = point.vertices.sum(mesh.uvs, point.vertices.weight);
    return alpha.at(point);
}

// Rays from one place, spread evenly over the sphere.
class Rays {
 public:
    static constexpr std::size_t kSide = 24, kCount = kSide * kSide;
    static constexpr std::size_t kMaxOpen = kCount / 64;  // that meet nothing in a closed space: seams of textures, a small window

    explicit Rays(const Vec3d& from) : from_(from) {
        const auto at = [](std::size_t cell, float inside) { return (static_cast<float>(cell) + inside) / kSide; };
        for (std::size_t i = 0; i < kCount; ++i) {  // not the cells' middles, which may lie in the model's planes of symmetry
            const Vec3f d = sphere_from_square({at(i % kSide, 0.382f), at(i / kSide, 0.618f)});
            x_[i] = d.x, y_[i] = d.y, z_[i] = d.z;
        }
    }
    // What each ray meets, in no order.
    std::array<std::vector<Met>, kCount>& met() { return met_; }

    void add(LoadedShape& loaded, const Affined& to_world) {
        const LoadedMesh& mesh = *loaded.mesh;
        for (std::size_t k = 0; k + 2 < mesh.indices.size(); k += 3) {
            std::array<Vec3d, 3> p;
            for (std::size_t c = 0; c < 3; ++c) p[c] = to_world.point(mesh.positions[mesh.indices[k + c]]);
            add(p, loaded, k);
        }
    }

 private:
    // Most rays pass beside the ball about a small triangle, which is quickly seen.
    void add(const std::array<Vec3d, 3>& p, LoadedShape& loaded, std::size_t triangle) {
        const Vec3d middle = (p[0] + p[1] + p[2]) * (1.0 / 3) - from_;
        double radius = 0;
        for (const Vec3d& corner : p) radius = std::max(radius, length(corner - from_ - middle));
        const double distance = length(middle), sine = distance > 0 ? radius / distance : 1;
        const Vec3f axis(distance > 0 ? middle * (1 / distance) : middle);
        const float cosine = sine < 1 ? static_cast<float>(std::sqrt(1 - sine * sine)) - 1e-4f : -2.0f;
        for (std::size_t i = 0; i < kCount; ++i) {
            if (x_[i] * axis.x + y_[i] * axis.y + z_[i] * axis.z < cosine) continue;
            const std::optional<Met> met = meet(p, from_, Vec3d(Vec3f(x_[i], y_[i], z_[i])));
            if (met) met_[i].push_back({met->distance, &loaded, triangle, met->u, met->v});
        }
    }

    Vec3d from_;
    std::array<float, kCount> x_, y_, z_;
    std::array<std::vector<Met>, kCount> met_{};
};

}  // namespace

bool uncover_sky(Model& model) {
    Rays rays(model.scene.camera.world_from_camera.t);
    for (LoadedShape& shape : model.shapes) {
        if (may_close(shape, model.scene)) rays.add(shape, {});
    }
    for (const InstanceDescription& instance : model.scene.instances) {
        for (LoadedShape& shape : model.objects[instance.object]) {
            if (may_close(shape, model.scene)) rays.add(shape, instance.world_from_object);
        }
    }
    const auto erase = [&](const auto& is_gone) {
        for (std::vector<Met>& met : rays.met()) std::erase_if(met, is_gone);
    };
    const auto is_closed = [&] {
        return static_cast<std::size_t>(std::ranges::count_if(rays.met(), &std::vector<Met>::empty)) <= Rays::kMaxOpen;
    };
    const auto is_textured = [](const Met& met) { return met.loaded->shape.alpha.is_textured(); };
    if (!is_closed()) return false;
    if (std::ranges::any_of(rays.met(), [&](const std::vector<Met>& met) { return std::ranges::any_of(met, is_textured); })) {
        SpectrumLibrary library;
        const Result<Textures> textures = Textures::build(model.scene, 0, library);
        if (!textures) return false;  // the scene cannot be rendered
        erase([&](const Met& met) { return is_textured(met) && !(alpha_at(met, *textures) > kOpaque); });
    }
    bool is_uncovered = false;
    for (; is_closed(); is_uncovered = true) {
        for (const std::vector<Met>& met : rays.met()) {
            if (!met.empty()) std::ranges::max_element(met, {}, &Met::distance)->loaded->shape.backdrop = true;
        }
        erase([](const Met& met) { return met.loaded->shape.backdrop; });
    }
    return is_uncovered;
}

}  // namespace latent::render
