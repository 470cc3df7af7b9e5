// base/progress.h: one line that moves, on a terminal; nothing elsewhere.
#pragma once

#include <chrono>
#include <functional>
#include <string>

namespace latent {

// Engines call this with the done part (0..1) and what else there is to say ("1.2 M samples/s, 3.4 GiB"). May be empty.
// Called from one thread at a time.
using Progress = std::function<void(double done, const std::string& detail)>;

namespace cli {

// A bar on stderr with the time left, redrawn at most ten times a second; does nothing unless stderr is a terminal.
Progress progress_to_stderr(std::string verb);

}  // namespace cli
}  // namespace latent
