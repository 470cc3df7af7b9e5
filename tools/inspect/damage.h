// tools/inspect/damage.h: how what is lost of a file is told: by run, byte and sample numbers.
#pragma once

#include <cstddef>

#include "base/result.h"
#include "sampledb/data/unreadable.h"
#include "sampledb/read/file_reader.h"

namespace latent::inspect {

// The `number`th run of a file is lost, and why.
sampledb::Damage lost_run(std::size_t number, const sampledb::RunInfo& run, const Error& why);

}  // namespace latent::inspect
