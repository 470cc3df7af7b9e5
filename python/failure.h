// python/failure.h: errors on their way to Python, where they are latent.Error.
#pragma once

#include <stdexcept>
#include <string>

#include "c_api/latent.h"

namespace latent::python {

// One line of UTF-8: a message of C or of a tool, with its options as the arguments that Python has for them.
std::string in_words_of_python(const std::string& message);

struct Failure : std::runtime_error {
    explicit Failure(const std::string& message) : std::runtime_error(in_words_of_python(message)) {}
};

inline void check(latent_status status, const latent_error& error) {
    if (status != LATENT_OK) throw Failure(error.message);
}

}  // namespace latent::python
