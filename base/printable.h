// base/printable.h: text of unknown origin, made safe to show.
#pragma once

#include <string>
#include <string_view>

namespace latent {

// `text` with every byte that is neither a line break nor part of a visible UTF-8 character written as \xNN: what a damaged file
// holds in place of words must not steer a terminal.
std::string printable(std::string_view text);

// The same with line breaks written so, too: a name, which must not pass for a line of its own.
std::string printable_line(std::string_view text);

}  // namespace latent
