// sampledb/data/parse.h: sample ranges and job ids as they are written on a command line.
#pragma once

#include <string_view>

#include "base/result.h"
#include "sampledb/data/coverage.h"
#include "sampledb/data/job.h"

namespace latent::sampledb {

// "65536:131072", "64Ki:128Ki" -> samples 65536 .. 131071 (base/parse.h, "count"). Errors: kUsage (no such form, or empty).
Result<SampleRange> parse_sample_range(std::string_view text);

// 32 hexadecimal digits, as to_hex writes them. Errors: kUsage.
Result<JobId> parse_job_id(std::string_view text);

}  // namespace latent::sampledb
