#include "render/texture/noise.h"

#include <array>

namespace latent::render {

namespace {

// The permutation of [Perlin02].
constexpr std::array<std::uint8_t, 256> kPermutation = {
    151, 160, 137, 91,  90,  15,  131, 13,  201, 95,  96,  53,  194, 233, 7,   225, 140, 36,  103, 30,  69,  142, 8,   99,
    37,  240, 21,  10,  23,  190, 6,   148, 247, 120, 234, 75,  0,   26,  197, 62,  94,  252, 219, 203, 117, 35,  11,  32,
    57,  177, 33,  88,  237, 149, 56,  87,  174, 20,  125, 136, 171, 168, 68,  175, 74,  165, 71,  134, 139, 48,  27,  166,
    77,  146, 158, 231, 83,  111, 229, 122, 60,  211, 133, 230, 220, 105, 92,  41,  55,  46,  245, 40,  244, 102, 143, 54,
    65,  25,  63,  161, 1,   216, 80,  73,  209, 76,  132, 187, 208, 89,  18,  169, 200, 196, 135, 130, 116, 188, 159, 86,
    164, 100, 109, 198, 173, 186, 3,   64,  52,  217, 226, 250, 124, 123, 5,   202, 38,  147, 118, 126, 255, 82,  85,  212,
    207, 206, 59,  227, 47,  16,  58,  17,  182, 189, 28,  42,  223, 183, 170, 213, 119, 248, 152, 2,   44,  154, 163, 70,
    221, 153, 101, 155, 167, 43,  172, 9,   129, 22,  39,  253, 19,  98,  108, 110, 79,  113, 224, 232, 178, 185, 112, 104,
    218, 246, 97,  228, 251, 34,  242, 193, 238, 210, 144, 12,  191, 179, 162, 241, 81,  51,  145, 235, 249, 14,  239, 107,
    49,  192, 214, 31,  181, 199, 106, 157, 184, 84,  204, 176, 115, 121, 50,  45,  127, 4,   150, 254, 138, 236, 205, 93,
    222, 114, 67,  29,  24,  72,  243, 141, 128, 195, 78,  66,  215, 61,  156, 180};

// One of the twelve gradients (0, +-1, +-1) ..., by the hash of a lattice point, times the way from it.
float gradient(int x, int y, int z, const Vec3f& d) {
    const auto next = [](int i) { return kPermutation[static_cast<std::size_t>(i & 255)]; };
    const int h = next(next(next(x) + y) + z) & 15;
    const bool diagonal = h == 12 || h == 13;
    const float u = h < 8 || diagonal ? d.x : d.y, v = h < 4 || diagonal ? d.y : d.z;
    return ((h & 1) != 0 ? -u : u) + ((h & 2) != 0 ? -v : v);
}

float lerp(float t, float a, float b) { return (1 - t) * a + t * b; }
float smooth_step(float x, float low, float high) {
    const float t = std::clamp((x - low) / (high - low), 0.0f, 1.0f);
    return t * t * (3 - 2 * t);
}

// How many octaves vary more slowly than the footprint.
float visible_octaves(const SpacePoint& at, int octaves) {
    const float squared = std::max(length_squared(at.dpdx), length_squared(at.dpdy));
    return std::clamp(-1 - 0.5f * std::log2(squared), 0.0f, static_cast<float>(octaves));
}

}  // namespace

float noise(const Vec3f& p) {
    // Far away a float cannot tell points of the lattice apart, and beyond 2^31 no index could.
    if (!(max_abs(p) < 1e9f)) return 0;
    const float fx = std::floor(p.x), fy = std::floor(p.y), fz = std::floor(p.z);
    const int x = static_cast<int>(fx), y = static_cast<int>(fy), z = static_cast<int>(fz);
    const Vec3f d(p.x - fx, p.y - fy, p.z - fz);
    const auto fade = [](float t) { return t * t * t * (t * (t * 6 - 15) + 10); };
    const float wx = fade(d.x), wy = fade(d.y), wz = fade(d.z);
    const auto along_x = [&](int j, int k) {
        const Vec3f from(d.x, d.y - static_cast<float>(j), d.z - static_cast<float>(k));
        return lerp(wx, gradient(x, y + j, z + k, from), gradient(x + 1, y + j, z + k, from - Vec3f(1, 0, 0)));
    };
    return lerp(wz, lerp(wy, along_x(0, 0), along_x(1, 0)), lerp(wy, along_x(0, 1), along_x(1, 1)));
}

float fractal_noise(const SpacePoint& at, float omega, int octaves) {
    const float visible = visible_octaves(at, octaves);
    const int whole = static_cast<int>(visible);
    float sum = 0, frequency = 1, weight = 1;
    for (int i = 0; i < whole; ++i, frequency *= 1.99f, weight *= omega) sum += weight * noise(at.p * frequency);
    return sum + weight * smooth_step(visible - static_cast<float>(whole), 0.3f, 0.7f) * noise(at.p * frequency);
}

float turbulence(const SpacePoint& at, float omega, int octaves) {
    constexpr float kMean = 0.2f;
    const float visible = visible_octaves(at, octaves);
    const int whole = static_cast<int>(visible);
    float sum = 0, frequency = 1, weight = 1;
    for (int i = 0; i < whole; ++i, frequency *= 1.99f, weight *= omega) sum += weight * std::abs(noise(at.p * frequency));
    const float part = smooth_step(visible - static_cast<float>(whole), 0.3f, 0.7f);
    sum += weight * lerp(part, kMean, std::abs(noise(at.p * frequency)));
    for (int i = whole; i < octaves; ++i, weight *= omega) sum += weight * kMean;
    return sum;
}

}  // namespace latent::render
