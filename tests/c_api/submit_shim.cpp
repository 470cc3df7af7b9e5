// tests/c_api/submit_shim.cpp: preloaded into a program that writes through latent.h, it notes how long each grain was rendered.
// For every latent_writer_submit that has returned, a SubmittedGrain is appended to the file named by LATENT_TEST_SUBMITTED.
#include <dlfcn.h>
#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdlib>

#include "c_api/latent.h"
#include "tests/c_api/submitted_grain.h"

namespace {

std::int64_t now() { return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1); }

template <class Function>
Function* next(const char* name) {
    return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

std::atomic<std::uint32_t> threads = 0;
thread_local std::uint32_t thread = threads++;
thread_local std::int64_t begun = 0;  // when this thread was given its grain

}  // namespace

extern "C" int latent_writer_next(latent_writer* writer, latent_range* grain) {
    static auto* const original = next<decltype(latent_writer_next)>("latent_writer_next");
    const int given = original(writer, grain);
    begun = now();
    return given;
}

extern "C" latent_status latent_writer_submit(latent_writer* writer, latent_range grain, const latent_records* records,
                                              latent_error* error) {
    static auto* const original = next<decltype(latent_writer_submit)>("latent_writer_submit");
    static const int out = open(std::getenv("LATENT_TEST_SUBMITTED"), O_WRONLY | O_CREAT | O_APPEND, 0600);
    const latent::SubmittedGrain note{grain.first, grain.end, now() - begun, thread};
    const latent_status status = original(writer, grain, records, error);
    if (write(out, &note, sizeof note) != sizeof note) std::abort();
    return status;
}
