// c_api/words.h: messages that name options of the tools, in the words of another caller.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace latent::c {

struct Word {
    std::string_view option;  // "--job", as messages have it
    std::string_view word;    // what the caller gives instead
};

// One line of UTF-8: `message` with each option of `words` replaced; the first that fits counts.
std::string reworded(std::string_view message, std::span<const Word> words);

}  // namespace latent::c
