// c_api/job.h: jobs from C, and what follows from a job alone.
#pragma once

#include <cstddef>

#include "base/result.h"
#include "c_api/latent.h"
#include "sampledb/data/job.h"

namespace latent::c {

inline constexpr std::size_t kJobSize = offsetof(latent_job, width);  // size of latent_job in its first version

// Errors: kUsage, kOutOfRange, kUnsupported, naming the field.
Result<sampledb::Job> job_from(const latent_job* job);

}  // namespace latent::c
