#include "render/load/model/cover.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "render/math/equal_area.h"

namespace latent::render {

namespace {

constexpr double kMissed = std::numeric_limits<double>::infinity();

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

struct Met {
    double distance;
    ShapeDescription* shape;
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
    // Of each ray, in no order.
    std::array<std::vector<Met>, kCount>& met() { return met_; }

    void add(LoadedShape& loaded, const Affined& to_world) {
        const LoadedMesh& mesh = *loaded.mesh;
        for (std::size_t k = 0; k + 2 < mesh.indices.size(); k += 3) {
            std::array<Vec3d, 3> p;
            for (std::size_t c = 0; c < 3; ++c) p[c] = to_world.point(mesh.positions[mesh.indices[k + c]]);
            add(p, loaded.shape);
        }
    }

 private:
    // Most rays pass beside the ball about a small triangle, which is quickly seen.
    void add(const std::array<Vec3d, 3>& p, ShapeDescription& shape) {
        const Vec3d middle = (p[0] + p[1] + p[2]) * (1.0 / 3) - from_;
        double radius = 0;
        for (const Vec3d& corner : p) radius = std::max(radius, length(corner - from_ - middle));
        const double distance = length(middle), sine = distance > 0 ? radius / distance : 1;
        const Vec3f axis(distance > 0 ? middle * (1 / distance) : middle);
        const float cosine = sine < 1 ? static_cast<float>(std::sqrt(1 - sine * sine)) - 1e-4f : -2.0f;
        for (std::size_t i = 0; i < kCount; ++i) {
            if (x_[i] * axis.x + y_[i] * axis.y + z_[i] * axis.z < cosine) continue;
            const double t = distance_to(p, from_, Vec3d(Vec3f(x_[i], y_[i], z_[i])));
            if (t != kMissed) met_[i].push_back({t, &shape});
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
        if (is_opaque(shape, model.scene)) rays.add(shape, {});
    }
    for (const InstanceDescription& instance : model.scene.instances) {
        for (LoadedShape& shape : model.objects[instance.object]) {
            if (is_opaque(shape, model.scene)) rays.add(shape, instance.world_from_object);
        }
    }
    for (bool is_uncovered = false;; is_uncovered = true) {
        for (std::vector<Met>& met : rays.met()) {
            std::erase_if(met, [](const Met& at) { return at.shape->backdrop; });
            if (met.empty()) return is_uncovered;
        }
        for (const std::vector<Met>& met : rays.met()) std::ranges::max_element(met, {}, &Met::distance)->shape->backdrop = true;
    }
}

}  // namespace latent::render
