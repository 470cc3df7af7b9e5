// tests/c_api/submitted_grain.h: what submit_shim.cpp notes of a grain.
#pragma once

#include <cstdint>

namespace latent {

struct SubmittedGrain {
    std::uint64_t first, end;  // samples
    std::int64_t nanoseconds;  // of rendering, from latent_writer_next to latent_writer_submit
    std::uint64_t thread;
};

}  // namespace latent
