// sampledb/data/grain.h: what a renderer hands over at once.
#pragma once

#include <cstdint>

#include "sampledb/data/coverage.h"
#include "sampledb/data/record.h"

namespace latent::sampledb {

inline constexpr std::uint32_t kGrainSamples = 1024;

// One sample number's worth of records for 1024 consecutive samples, or fewer at the end of a range.
struct Grain {
    SampleRange range;  // first is a multiple of kGrainSamples
    Records records;    // in any order; all records of all its samples, light records included
};

}  // namespace latent::sampledb
