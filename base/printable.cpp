#include "base/printable.h"

#include <fmt/format.h>

namespace latent {

namespace {

// Length of the visible UTF-8 character at the front of `text`, which is not empty; 0 if there is none.
std::size_t character_length(std::string_view text) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    if (byte(0) < 0x80) return byte(0) >= 0x20 && byte(0) != 0x7f ? 1 : 0;
    const std::size_t length = byte(0) >= 0xf0 ? 4 : byte(0) >= 0xe0 ? 3 : 2;
    if (byte(0) < 0xc2 || byte(0) > 0xf4 || text.size() < length) return 0;
    for (std::size_t i = 1; i < length; ++i) {
        if ((byte(i) & 0xc0) != 0x80) return 0;
    }
    // Control characters U+0080 .. U+009F, overlong forms, surrogates, and what is beyond U+10FFFF.
    const unsigned second = byte(1);
    if ((byte(0) == 0xc2 && second < 0xa0) || (byte(0) == 0xe0 && second < 0xa0) || (byte(0) == 0xed && second >= 0xa0) ||
        (byte(0) == 0xf0 && second < 0x90) || (byte(0) == 0xf4 && second >= 0x90))
        return 0;
    return length;
}

std::string escaped(std::string_view text, bool keep_line_breaks) {
    std::string out;
    while (!text.empty()) {
        const std::size_t length = keep_line_breaks && text[0] == '\n' ? 1 : character_length(text);
        if (length > 0) {
            out += text.substr(0, length);
        } else {
            out += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[0]));
        }
        text.remove_prefix(length > 0 ? length : 1);
    }
    return out;
}

}  // namespace

std::string printable(std::string_view text) { return escaped(text, true); }
std::string printable_line(std::string_view text) { return escaped(text, false); }

}  // namespace latent
