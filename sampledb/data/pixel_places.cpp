#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sampledb/data/pixel_places.cpp"  // compiled once per instruction set by foreach_target.h
#include "sampledb/data/pixel_places.h"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>

#include "sampledb/data/pixel_position.h"

HWY_BEFORE_NAMESPACE();
namespace latent::sampledb::HWY_NAMESPACE {
namespace {

constexpr std::size_t kAtOnce = 256;

// reverse_bits but for its last step: compilers make a bswap of the whole, of which there is no vector.
inline std::uint32_t reverse_halves(std::uint32_t x) {
    x = (x >> 1 & 0x55555555) | (x & 0x55555555) << 1;
    x = (x >> 2 & 0x33333333) | (x & 0x33333333) << 2;
    x = (x >> 4 & 0x0F0F0F0F) | (x & 0x0F0F0F0F) << 4;
    return (x >> 8 & 0x00FF00FF) | (x & 0x00FF00FF) << 8;
}
inline std::uint32_t swap_halves(std::uint32_t x) { return x >> 16 | x << 16; }

// At most kAtOnce numbers of at most 31 bits, in plain loops that compilers make vectors of.
void positions_of_few(const PositionSamplerSpec& spec, const PixelLattice::Block& block, std::uint64_t first_pass,
                      std::span<const std::uint64_t> numbers, std::uint32_t* u, std::uint32_t* v) {
    std::array<std::uint32_t, kAtOnce> x, y, pass_u, pass_v, shift_u, shift_v;
    const std::size_t count = numbers.size();
    const auto width = static_cast<std::int32_t>(block.width), height = static_cast<std::int32_t>(block.height);
    for (std::size_t i = 0; i < count; ++i) {
        const auto number = static_cast<std::int32_t>(numbers[i]);
        const auto row = static_cast<std::int32_t>(static_cast<double>(number) / width);
        const auto pass = static_cast<std::int32_t>(static_cast<double>(row) / height);
        x[i] = block.x + static_cast<std::uint32_t>(number - row * width);
        y[i] = block.y + static_cast<std::uint32_t>(row - pass * height);
        pass_u[i] = static_cast<std::uint32_t>(first_pass) + static_cast<std::uint32_t>(pass);
    }
    for (std::size_t i = 0; i < count; ++i) {
        pass_v[i] = reverse_halves(pascal(pass_u[i]));
        pass_u[i] = reverse_halves(pass_u[i]);
    }
    const std::uint64_t key = pixel_key(spec);
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint64_t shifts = pixel_shifts(key, x[i], y[i]);
        shift_u[i] = static_cast<std::uint32_t>(shifts);
        shift_v[i] = static_cast<std::uint32_t>(shifts >> 32);
    }
    for (std::size_t i = 0; i < count; ++i) {
        shift_u[i] = film_coordinate(x[i], swap_halves(pass_u[i]) ^ shift_u[i], spec.width);
        shift_v[i] = film_coordinate(y[i], swap_halves(pass_v[i]) ^ shift_v[i], spec.height);
    }
    std::copy_n(shift_u.begin(), count, u);
    std::copy_n(shift_v.begin(), count, v);
}

}  // namespace
}  // namespace latent::sampledb::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "base/simd_dispatch.h"

namespace latent::sampledb {

namespace {
LATENT_SIMD_EXPORT(positions_of_few);
}

PixelPlaces::PixelPlaces(const PositionSamplerSpec& spec, const FilmNode& node, std::uint64_t first_pass)
    : spec_(spec), lattice_(spec), block_(lattice_.block(node)), first_(first_pass) {}

void PixelPlaces::samples(std::span<const std::uint64_t> numbers, std::span<std::uint64_t> n) const {
    for (std::size_t i = 0; i < numbers.size(); ++i) n[i] = lattice_.sample(block_.place(numbers[i], first_));
}

void PixelPlaces::positions(std::span<const std::uint64_t> numbers, std::span<std::uint32_t> u, std::span<std::uint32_t> v) const {
    for (std::size_t begin = 0; begin < numbers.size(); begin += HWY_STATIC_DISPATCH(kAtOnce)) {
        const auto few = numbers.subspan(begin, std::min(HWY_STATIC_DISPATCH(kAtOnce), numbers.size() - begin));
        std::uint64_t all = 0;
        for (const std::uint64_t number : few) all |= number;
        if (all >> 31 == 0) {
            LATENT_SIMD_CALL(positions_of_few)(spec_, block_, first_, few, &u[begin], &v[begin]);
            continue;
        }
        for (std::size_t i = 0; i < few.size(); ++i) {
            const FilmPosition at = lattice_.position(block_.place(few[i], first_));
            u[begin + i] = at.u;
            v[begin + i] = at.v;
        }
    }
}

}  // namespace latent::sampledb
#endif
