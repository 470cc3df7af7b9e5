#include "render/sampling/pixel_sampler.h"

#include "render/sampling/number_matrices.h"
#include "sampledb/data/pixel_position.h"

namespace latent::render {
namespace {

using sampledb::reverse_bits;

constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15u;

// The dimension that each matrix is for.
constexpr std::array<std::uint32_t, kNumberMatrices> kRoles = {
    Dimension::of_camera_vertex(0, Dimension::kLightU),
    Dimension::of_camera_vertex(0, Dimension::kLightV),
    Dimension::of_camera_vertex(0, Dimension::kDirectionU),
    Dimension::of_camera_vertex(0, Dimension::kDirectionV),
    Dimension::kLensU,
    Dimension::kLensV,
    Dimension::kTime,
    Dimension::kXi,
    Dimension::of_camera_vertex(0, Dimension::kDistance),
    Dimension::of_camera_vertex(1, Dimension::kLightU),
    Dimension::of_camera_vertex(1, Dimension::kLightV),
    Dimension::of_camera_vertex(1, Dimension::kDirectionU),
    Dimension::of_camera_vertex(1, Dimension::kDirectionV),
    Dimension::of_camera_vertex(0, Dimension::kLobe),
    Dimension::kKeptWavelength,
};
// Column j of a matrix of Sobol's sequence, digits from the lowest bit on. The first `degree` columns are given by odd numbers, the
// others follow from a polynomial whose coefficients but the first and the last are the bits of `inner` [Joe08].
constexpr std::array<std::uint32_t, 32> sobol(std::uint32_t degree, std::uint32_t inner,
                                              const std::array<std::uint32_t, 4>& first) {
    std::array<std::uint32_t, 32> columns{};
    for (std::uint32_t j = 0; j < 32; ++j) {
        if (degree == 0) {  // the first dimension
            columns[j] = 1u << j;
            continue;
        }
        if (j < degree) {
            for (std::uint32_t digit = 0; digit <= j; ++digit) columns[j] |= (first[j] >> (j - digit) & 1) << digit;
            continue;
        }
        columns[j] = columns[j - degree] ^ columns[j - degree] << degree;
        for (std::uint32_t i = 1; i < degree; ++i) columns[j] ^= (inner >> (degree - 1 - i) & 1) != 0 ? columns[j - i] : 0;
    }
    return columns;
}
constexpr std::array<std::array<std::uint32_t, 32>, 7> kSobol = {
    sobol(0, 0, {}),        sobol(1, 0, {1}),          sobol(2, 1, {1, 3}),       sobol(3, 1, {1, 3, 1}),
    sobol(3, 2, {1, 1, 1}), sobol(4, 1, {1, 1, 3, 3}), sobol(4, 4, {1, 3, 5, 13})};

// In the order of the dimensions of Sobol's sequence.
constexpr std::array<std::uint32_t, kSobol.size()> kStarts = {Dimension::kStartDirectionU,
                                                              Dimension::kStartDirectionV,
                                                              Dimension::kStartU,
                                                              Dimension::kStartV,
                                                              Dimension::of_light_vertex(1, Dimension::kDistance),
                                                              Dimension::of_light_vertex(1, Dimension::kDirectionU),
                                                              Dimension::of_light_vertex(1, Dimension::kDirectionV)};

// Permutes the digits below each digit, whose bits are given from the lowest on; every choice is a function of the key
// [Vegdahl21].
std::uint32_t scrambled(std::uint32_t digits, std::uint32_t key) {
    digits += key;
    digits ^= digits * 0x6c50b47cu;
    digits ^= digits * 0xb82f1e52u;
    digits ^= digits * 0xc7afe638u;
    return digits ^ digits * 0x8d22f6e6u;
}

std::uint32_t product(const std::array<std::uint32_t, 32>& columns, std::uint32_t x) {
    std::uint32_t digits = 0;
    for (std::uint32_t j = 0; x != 0; x >>= 1, ++j) digits ^= (x & 1) != 0 ? columns[j] : 0;
    return digits;
}

}  // namespace

PixelSampler::PixelSampler(const sampledb::PositionSamplerSpec& positions, std::uint64_t seed)
    : Sampler(seed), lattice_(positions), pixel_seed_(mix(seed + 0xbb67ae8584caa73bu)) {
    for (std::size_t i = 0; i < kRoles.size(); ++i) set_spread(kRoles[i], i);
    for (std::size_t i = 0; i < kStarts.size(); ++i) set_spread(kStarts[i], kRoles.size() + i);
}

Sampler::Key PixelSampler::key_of(std::uint64_t n) const {
    Key key = Sampler::key_of(n);
    key.place = lattice_.place(n);
    return key;
}

Uniform PixelSampler::spread(std::uint32_t as, const Key& key, std::uint64_t random) const {
    const std::uint32_t digits = as < kNumberMatrices ? at_pass(as, key) : at_start(as - kNumberMatrices, key);
    return {std::uint64_t{reverse_bits(digits)} << 32 | (random & 0xffffffffu)};
}

std::uint32_t PixelSampler::at_pass(std::uint32_t matrix, const Key& key) const {
    const auto& [x, y, pass] = key.place;
    const std::uint64_t pixel = mix(pixel_seed_ + (pass >> 32) * kGolden + (std::uint64_t{y} << 32 | x));
    return scrambled(product(kNumberMatrix[matrix], static_cast<std::uint32_t>(pass)),
                     static_cast<std::uint32_t>(mix(pixel + matrix * kGolden)));
}

std::uint32_t PixelSampler::at_start(std::uint32_t number, const Key& key) const {
    const auto key_of = [&](std::uint64_t what) { return static_cast<std::uint32_t>(mix(seed_ + (what + 1) * kGolden)); };
    const std::uint32_t index = reverse_bits(scrambled(reverse_bits(static_cast<std::uint32_t>(key.n)), key_of(key.n >> 32 << 3)));
    return scrambled(product(kSobol[number], index), key_of(number + 1));
}

}  // namespace latent::render
