#include "render/load/model/stage.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "render/math/elementary.h"
#include "render/math/equal_area.h"

namespace latent::render {

namespace {

constexpr double kHalfHeight = 0.36397;  // half the height of the window: tan 20 degrees
constexpr double kShare = 0.8;           // the part of the picture that the model takes

constexpr float kBackground = 0.4f;   // radiance of the sky where cameras of the stage look at it
constexpr std::uint32_t kSide = 512;  // pixels along a side of its picture; 0.4 degrees: no step is seen

// A rectangle of light around a direction, in the plane at distance 1 that it stands on. Its outer fifth fades.
class SoftBox {
 public:
    SoftBox(const Vec3d& towards, double half_width, double half_height, float radiance)
        : z_(normalize(towards)),
          x_(normalize(cross(Vec3f(0, 1, 0), z_)) / static_cast<float>(half_width)),
          y_(normalize(cross(z_, x_)) / static_cast<float>(half_height)),
          radiance_(radiance) {}

    float radiance(const Vec3f& d) const {
        const float z = dot(d, z_);
        return z > 0 ? radiance_ * within(dot(d, x_) / z) * within(dot(d, y_) / z) : 0;
    }

 private:
    static float within(float x) {
        const float t = std::clamp(5 * (1 - std::abs(x)), 0.0f, 1.0f);
        return t * t * (3 - 2 * t);
    }
    Vec3f z_, x_, y_;
    float radiance_;
};

float studio_radiance(const Vec3f& d) {
    static const Vec3f key(normalize(Vec3d(0.5, 0.8, 0.6)));
    static const SoftBox fill({-0.75, 0.5, 0.45}, 0.5, 0.55, 2), rim({0.95, 0.5, -0.2}, 0.15, 0.5, 3);
    const float front = std::max(d.z, 0.0f);
    return kBackground - 0.32f * front * front + 0.3f * std::max(d.y, 0.0f) +
           25 * exp_nonpositive(std::min(25 * (dot(d, key) - 1), 0.0f)) + fill.radiance(d) + rim.radiance(d);
}

float room_radiance(const Vec3f& d) { return 0.9f + 0.3f * d.y + 0.15f * d.z; }

// The directions of the sky's pixels.
Vec3f sky_direction(std::uint32_t x, std::uint32_t y) {
    return sphere_from_square({(static_cast<float>(x) + 0.5f) / kSide, (static_cast<float>(y) + 0.5f) / kSide});
}

LightDescription make_sky(float (*radiance)(const Vec3f&), const color::Spectrum& white, const ModelOptions& options) {
    auto image = std::make_shared<ImageDescription>(ImageDescription{.width = kSide, .height = kSide});
    for (std::uint32_t y = 0; y < kSide; ++y) {
        for (std::uint32_t x = 0; x < kSide; ++x) image->rgb.insert(image->rgb.end(), 3, radiance(sky_direction(x, y)));
    }
    LightDescription sky;
    sky.kind = LightKind::kInfinite;
    sky.spectrum = white;
    sky.image = std::move(image);
    sky.world_from_light = world_from_stage(options);
    return sky;
}

// From above, over that of `white`.
double irradiance_of_ground() {
    double sum = 0;
    for (std::uint32_t y = 0; y < kSide; ++y) {
        for (std::uint32_t x = 0; x < kSide; ++x) {
            const Vec3f d = sky_direction(x, y);
            if (d.y > 0) sum += static_cast<double>(d.y * studio_radiance(d));
        }
    }
    return sum * 4 * std::numbers::pi / (kSide * kSide);
}

// A left-handed camera: x to the right in the picture where the world's is right-handed.
Affined looking_along(const Vec3d& forward, const Vec3d& up, const Vec3d& from) {
    const Vec3d right = normalize(cross(forward, up));
    return {right, cross(right, forward), forward, from};
}

}  // namespace

Affined world_from_stage(const ModelOptions& options) {
    return options.is_z_up ? Affined({1, 0, 0}, {0, 0, 1}, {0, -1, 0}, {}) : Affined();
}

CameraDescription framing(std::span<const Vec3d> points, const FilmDescription& film, const ModelOptions& options) {
    CameraDescription camera;
    camera.y1 = kHalfHeight;
    camera.x1 = kHalfHeight * film.width / film.height;
    camera.y0 = -camera.y1;
    camera.x0 = -camera.x1;
    const Affined turn = world_from_stage(options);
    const Vec3d from = options.view == ModelView::kTop     ? Vec3d(0, 1, 0)
                       : options.view == ModelView::kFront ? Vec3d(0, 0, 1)
                                                           : Vec3d(0.45, 0.35, 0.82),
                up = options.view == ModelView::kTop ? Vec3d(0, 0, -1) : Vec3d(0, 1, 0);
    const Affined axes = looking_along(turn.vector(-normalize(from)), turn.vector(up), {});
    // In these axes, p is within the window of a camera at c if |p.x - c.x| <= w (p.z - c.z): the largest of x - w z and of
    // -x - w z say how far back it must be, and where between them.
    constexpr double kNever = -std::numeric_limits<double>::infinity();
    double right = kNever, left = kNever, above = kNever, below = kNever, nearest = -kNever;
    const double across = kShare * camera.x1, upright = kShare * camera.y1;
    for (const Vec3d& p : points) {
        const double x = dot(p, axes.x), y = dot(p, axes.y), z = dot(p, axes.z);
        right = std::max(right, x - across * z);
        left = std::max(left, -x - across * z);
        above = std::max(above, y - upright * z);
        below = std::max(below, -y - upright * z);
        nearest = std::min(nearest, z);
    }
    Vec3d place;
    if (!points.empty()) {
        const double back = std::min(-(right + left) / (2 * across), -(above + below) / (2 * upright));
        // A point, or a line towards the camera, is seen from somewhere.
        place = {(right - left) / 2, (above - below) / 2, back < nearest ? back : nearest - 1};
    }
    camera.world_from_camera = axes;
    camera.world_from_camera.t = axes.vector(place);
    return camera;
}

LightDescription studio_sky(const color::Spectrum& white, const ModelOptions& options) {
    return make_sky(studio_radiance, white, options);
}

LightDescription room_sky(const color::Spectrum& white, const ModelOptions& options) {
    return make_sky(room_radiance, white, options);
}

LoadedShape studio_ground(const Box& box, const ModelOptions& options, SceneDescription& scene) {
    constexpr std::uint32_t kRings = 32, kSpokes = 64;
    const Vec3d half = (box.high - box.low) * 0.5, middle = box.middle(), up = world_from_stage(options).y;
    const double size = std::max(length(half), 1e-9), whole = 2 * size, end = 8 * size;
    // A hair below the model, whose own base would else be the same surface.
    const Vec3d center = middle - up * (std::abs(dot(half, up)) + 1e-4 * size);
    const Affined turn = world_from_stage(options);
    LoadedMesh mesh;
    const auto add = [&](double radius, double angle) {
        const double t = std::clamp((radius - whole) / (end - whole), 0.0, 1.0), alpha = 1 - t * t * (3 - 2 * t);
        mesh.positions.push_back(center + turn.x * (radius * std::cos(angle)) - turn.z * (radius * std::sin(angle)));
        mesh.colors.push_back({1, 1, 1, static_cast<float>(alpha)});
    };
    add(0, 0);
    for (std::uint32_t ring = 0; ring < kRings; ++ring) {
        for (std::uint32_t spoke = 0; spoke < kSpokes; ++spoke) {
            add(whole + (end - whole) * ring / (kRings - 1), 2 * std::numbers::pi * spoke / kSpokes);
            const std::uint32_t here = 1 + ring * kSpokes + spoke, next = 1 + ring * kSpokes + (spoke + 1) % kSpokes;
            if (ring == 0) {
                mesh.indices.insert(mesh.indices.end(), {0, here, next});
            } else {
                mesh.indices.insert(mesh.indices.end(), {here - kSpokes, here, next, here - kSpokes, next, next - kSpokes});
            }
        }
    }
    TextureDescription fading{.kind = TextureKind::kVertexColor};
    fading.picture.channel = 3;
    LoadedShape ground;
    ground.mesh = std::move(mesh);
    ground.shape.material = static_cast<std::uint32_t>(scene.materials.size());
    ground.shape.alpha.texture = static_cast<std::uint32_t>(scene.textures.size());
    scene.textures.push_back(std::move(fading));
    const double reflectance = std::numbers::pi * static_cast<double>(kBackground) / irradiance_of_ground();
    scene.materials.push_back({.spectra = {{"reflectance", color::Spectrum::constant(reflectance)}}});
    return ground;
}

}  // namespace latent::render
