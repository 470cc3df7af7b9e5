#include "sampledb/data/pixel_lattice.h"

#include <cassert>
#include <numeric>
#include <utility>

#include "sampledb/data/pixel_position.h"

namespace latent::sampledb {

namespace {

// The multiples of (0.5698..., 0.7549...) fill the unit square evenly, however many there are [Roberts18]. In units of 2^-32.
constexpr std::uint64_t kStepX = 2447445414, kStepY = 3242174889;

std::uint64_t rounded(std::uint64_t fraction, std::uint32_t size) { return (fraction * size + (std::uint64_t{1} << 31)) >> 32; }

// x with x a = 1 mod m, which have no common divisor; a below m, m at most 2^40.
std::uint64_t inverse(std::uint64_t a, std::uint64_t m) {
    auto r0 = static_cast<std::int64_t>(m), r1 = static_cast<std::int64_t>(a);
    std::int64_t x0 = 0, x1 = 1;
    while (r1 != 0) {
        const std::int64_t quotient = r0 / r1;
        r0 = std::exchange(r1, r0 - quotient * r1);
        x0 = std::exchange(x1, x0 - quotient * x1);
    }
    return static_cast<std::uint64_t>(x0 < 0 ? x0 + static_cast<std::int64_t>(m) : x0) % m;
}

}  // namespace

PixelLattice::PixelLattice(const PositionSamplerSpec& spec)
    : width_(spec.width),
      height_(spec.height),
      pixels_(std::uint64_t{spec.width} * spec.height),
      by_pixels_(pixels_),
      by_width_(width_),
      key_(pixel_key(spec)) {
    assert(spec.sampler == PositionSampler::kPixels && pixels_ > 0);
    std::uint64_t step = rounded(kStepY, height_) * width_ + rounded(kStepX, width_);
    while (std::gcd(step, pixels_) != 1) ++step;
    step_ = step % pixels_;
    back_ = inverse(step_, pixels_);
    first_ = key_ % pixels_;
}

PixelLattice::Place PixelLattice::place(std::uint64_t sample) const {
    const auto [pass, rest] = by_pixels_(sample);
    const std::uint64_t pixel = by_pixels_.product(rest, step_) + first_;
    const auto [y, x] = by_width_(pixel < pixels_ ? pixel : pixel - pixels_);
    return {static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), pass};
}

std::uint64_t PixelLattice::sample(const Place& place) const {
    const std::uint64_t pixel = std::uint64_t{place.y} * width_ + place.x;
    return place.pass * pixels_ + by_pixels_.product(pixel < first_ ? pixel + pixels_ - first_ : pixel - first_, back_);
}

FilmPosition PixelLattice::position(const Place& place) const {
    const std::uint64_t shifts = pixel_shifts(key_, place.x, place.y);
    const auto pass = static_cast<std::uint32_t>(place.pass);
    return {film_coordinate(place.x, reverse_bits(pass) ^ static_cast<std::uint32_t>(shifts), width_),
            film_coordinate(place.y, reverse_bits(pascal(pass)) ^ static_cast<std::uint32_t>(shifts >> 32), height_)};
}

PixelLattice::Block PixelLattice::block(const FilmNode& node) const {
    const auto begin = [&](std::uint32_t at, std::uint32_t side) {
        return static_cast<std::uint32_t>(std::uint64_t{at} * side >> node.level);
    };
    const auto end = [&](std::uint32_t at, std::uint32_t side) {
        return static_cast<std::uint32_t>(((std::uint64_t{at} + 1) * side + (std::uint64_t{1} << node.level) - 1) >> node.level);
    };
    const std::uint32_t x = begin(node.x, width_), y = begin(node.y, height_);
    return {x, y, end(node.x, width_) - x, end(node.y, height_) - y};
}

}  // namespace latent::sampledb
