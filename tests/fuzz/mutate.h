// tests/fuzz/mutate.h: bytes with a few changes, such as readers are surprised by.
#pragma once

#include <cstdint>

#include "base/bytes.h"

namespace latent::fuzz {

// A function of its arguments alone. `is_text`: numbers and words change as such, too.
Bytes mutated(Bytes bytes, std::uint64_t seed, bool is_text);

}  // namespace latent::fuzz
