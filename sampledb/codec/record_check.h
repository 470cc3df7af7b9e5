// sampledb/codec/record_check.h: whether records are such as a run of a job may hold. docs/format.md, "Records".
#pragma once

#include "base/result.h"
#include "sampledb/data/coverage.h"
#include "sampledb/data/job.h"
#include "sampledb/data/record.h"

namespace latent::sampledb {

// Errors: kOutOfRange, naming the sample of the first record that does not fit the job or the coverage, and why.
Status check_records(const Job& job, const Coverage& coverage, const Records& records);

}  // namespace latent::sampledb
