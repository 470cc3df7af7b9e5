// One target as libFuzzer runs it: LATENT_FUZZ_TARGET is its name.
#include <algorithm>
#include <cstring>

#include "tests/fuzz/mutate.h"
#include "tests/fuzz/target.h"

namespace {

const latent::fuzz::Target& target() {
    static const latent::fuzz::Target chosen = latent::fuzz::LATENT_FUZZ_TARGET();
    return chosen;
}

}  // namespace

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t capacity);

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    (void)target().run(std::as_bytes(std::span(data, size)));
    return 0;
}

// Half of the mutants of a text change whole words. One mutant of eight keeps its wrong checksums: what refuses these is code, too.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t capacity, unsigned seed) {
    const bool changes_words = target().is_text && seed % 2 == 0, mends = target().mend != nullptr && seed % 8 != 0;
    if (!changes_words) size = LLVMFuzzerMutate(data, size, capacity);
    if (!changes_words && !mends) return size;
    latent::Bytes bytes(size);
    std::memcpy(bytes.data(), data, size);
    if (changes_words) bytes = latent::fuzz::mutated(std::move(bytes), seed, true);
    if (mends) target().mend(bytes);
    size = std::min(bytes.size(), capacity);
    std::memcpy(data, bytes.data(), size);
    return size;
}
