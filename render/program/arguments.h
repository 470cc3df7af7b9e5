// render/program/arguments.h: the arguments of latent-render that are more than one number. Errors of all: kUsage, with an example.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "base/result.h"
#include "render/program/job.h"

namespace latent::render {

// "0/4" is the first of four.
Result<Shard> parse_shard(std::string_view text);
// "1920x1080"
Result<Resolution> parse_resolution(std::string_view text);
// "0:0.02", seconds from 0 to 1e6
Result<std::array<double, 2>> parse_shutter(std::string_view text);
// "12" or "unlimited"
Result<std::uint32_t> parse_depth(std::string_view text);
// "2%@1920", or "2%" of the picture that is rendered for
Result<NoiseTarget> parse_noise_target(std::string_view text);
// "0:1M", ending before 2^62
Result<sampledb::SampleRange> parse_samples(std::string_view text);

}  // namespace latent::render
