// sampledb/codec/rounding.h: values rounded to the precision of their job, without bias. docs/format.md, "Rounding".
#pragma once

#include <cstdint>

#include "sampledb/data/job.h"
#include "sampledb/data/page.h"

namespace latent::sampledb {

// The random number of value `index` (0: x or the first power) of a record, from the 64 bits that `rounding_seed` gives the record.
std::uint64_t rounding_key(const JobId& job);
std::uint64_t rounding_seed(std::uint64_t key, std::uint64_t sample, std::uint32_t u, std::uint32_t v);
std::uint32_t rounding_random(std::uint64_t seed, std::uint32_t index);

// The bits of a float without its `dropped` last ones, 0..22: the neighbour above in magnitude with a probability of what was
// dropped, else the one below. What has no neighbour above stays as it is: infinities, NaN, the last numbers before infinity.
constexpr std::uint32_t rounded(std::uint32_t bits, unsigned dropped, std::uint32_t random) {
    const std::uint32_t step = std::uint32_t{1} << dropped, low = step - 1;
    const std::uint32_t next = (bits + (random & low)) & ~low;
    return (bits & 0x7FFFFFFF) > 0x7F800000 - step ? bits : next;
}

// Rounds x, y, z or the powers of a page. Rounding again changes nothing.
void round_values(const Job& job, Page& page);

}  // namespace latent::sampledb
