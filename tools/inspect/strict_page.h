// tools/inspect/strict_page.h: fields, bits and bytes of a stored page that have no meaning and should be zero; what else readers
// let pass. docs/format.md, "Page".
#pragma once

#include <cstddef>

#include "base/bytes.h"
#include "base/result.h"
#include "sampledb/data/page.h"
#include "tools/inspect/violation.h"

namespace latent::inspect {

// Checks page `number` of run `run`, which is known to be sound in full. What is wrong joins `violations`. Errors: kCorrupt.
Status check_page_strictly(const sampledb::Job& job, const sampledb::PageInfo& info, ByteSpan stored, std::size_t run,
                           std::size_t number, Violations& violations);

}  // namespace latent::inspect
