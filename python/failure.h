// python/failure.h: errors on their way to Python, where they are latent.Error.
#pragma once

#include <stdexcept>
#include <string>

#include "c_api/latent.h"

namespace latent::python {

struct Failure : std::runtime_error {
    explicit Failure(const std::string& message) : std::runtime_error(message) {}
};

inline void check(latent_status status, const latent_error& error) {
    if (status != LATENT_OK) throw Failure(error.message);
}

}  // namespace latent::python
