#include "base/terminal.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string_view>

namespace latent::cli {

bool stderr_is_terminal() {
    const char* terminal = std::getenv("TERM");
    return ::isatty(STDERR_FILENO) && terminal && std::string_view(terminal) != "dumb";
}

void log_line(const std::string& text) { fmt::print(stderr, "{:%F %T} {}\n", fmt::localtime(std::time(nullptr)), text); }

}  // namespace latent::cli
