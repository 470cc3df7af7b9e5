// base/terminal.h: standard error: a terminal, or a log.
#pragma once

#include <string>

namespace latent::cli {

// Whether progress can be a bar on standard error; else it is lines of a log.
bool stderr_is_terminal();

// Writes a line of a log to standard error, with date and time.
void log_line(const std::string& text);

}  // namespace latent::cli
