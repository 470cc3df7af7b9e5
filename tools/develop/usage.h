// tools/develop/usage.h: what is wrong with the arguments.
#pragma once

#include <string>
#include <utility>

#include "base/result.h"

namespace latent::develop {

inline Error usage(std::string message) { return {ErrorCode::kUsage, std::move(message)}; }

}  // namespace latent::develop
