#include "tools/inspect/damage.h"

#include <fmt/format.h>

namespace latent::inspect {

using namespace sampledb;

Damage lost_run(std::size_t number, const RunInfo& run, const Error& why) {
    return {run.offset, run.header.size(),
            fmt::format("run {} at byte {}: {}; samples {}:{} lost", number, run.offset, why.message, run.header.samples.first,
                        run.header.samples.end)};
}

}  // namespace latent::inspect
