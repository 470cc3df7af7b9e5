// tests/render/built_geometry.h: geometry of scenes written on the spot, and random rays.
#pragma once

#include <random>

#include "render/geometry/geometry.h"
#include "render/program/simd.h"
#include "tests/render/rays.h"
#include "tests/render/scenes.h"

namespace latent::render::testing {

class Random {
 public:
    float operator()(float low, float high) { return std::uniform_real_distribution<float>(low, high)(engine_); }
    Vec3f vector(float size) { return {(*this)(-size, size), (*this)(-size, size), (*this)(-size, size)}; }
    Vec3f direction() {
        while (true) {
            const Vec3f v = vector(1);
            if (length(v) > 0.01f && length(v) < 1) return normalize(v);
        }
    }
    // At that angle to z, anywhere around it.
    Vec3f about(const Vec3f& z, float cosine) {
        const float phi = (*this)(0, 2 * kPi), sine = std::sqrt(1 - cosine * cosine);
        return Frame::from_z(z).to_world({sine * std::cos(phi), sine * std::sin(phi), cosine});
    }

 private:
    std::mt19937 engine_{11};
};

struct Built {
    SceneDescription description;
    std::unique_ptr<Geometry> geometry;
};
// Counted from the origin of the world, far from it too.
inline Built build(const std::string& text, const std::string& simd = choose_simd("best").value()) {
    const Result<LoadedScene> scene = load_world(text);
    EXPECT_TRUE(scene) << (scene ? "" : scene.error().message);
    Built out{in_world(scene->description), nullptr};
    Result<std::unique_ptr<Geometry>> geometry = Geometry::build(out.description, simd);
    EXPECT_TRUE(geometry) << (geometry ? "" : geometry.error().message);
    out.geometry = std::move(*geometry);
    return out;
}

}  // namespace latent::render::testing
