// sampledb/write/writer_counts.h: what a part writer has done so far.
#pragma once

#include <cstdint>

namespace latent::sampledb {

struct WriterCounts {
    std::uint64_t samples_committed = 0;  // in the range, by this and other attempts; all of it: there is nothing left to render
    std::uint64_t bytes_written = 0;
    std::uint64_t runs_written = 0, checkpoints_written = 0;
};

}  // namespace latent::sampledb
