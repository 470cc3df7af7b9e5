// sampledb/codec/delta2.h: values along records <-> their second differences, of which each record has its own. docs/format.md,
// "Transforms".
#pragma once

#include <cstdint>
#include <span>

namespace latent::sampledb {

// For each record: its first value, zigzag(b1 - b0), then zigzag(b_i - 2 b_{i-1} + b_{i-2}), all in steps of 2^step.
// `pairs` add up to values.size() and words.size().
void to_delta2(std::span<const float> values, std::span<const std::uint16_t> pairs, unsigned step, std::span<std::uint32_t> words);
void from_delta2(std::span<const std::uint32_t> words, std::span<const std::uint16_t> pairs, unsigned step,
                 std::span<float> values);

}  // namespace latent::sampledb
