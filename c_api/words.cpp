#include "c_api/words.h"

#include <algorithm>

#include "base/printable.h"

namespace latent::c {

std::string reworded(std::string_view message, std::span<const Word> words) {
    constexpr std::string_view kEnds = " :;,)";  // what may follow an option; a name such as a--job.latent stays
    std::string text;
    while (!message.empty()) {
        const auto fits = [&](const Word& word) {
            const std::size_t size = word.option.size();
            return message.starts_with(word.option) && (message.size() == size || kEnds.find(message[size]) != kEnds.npos);
        };
        const bool begins = text.empty() || text.back() == ' ' || text.back() == '(';
        const auto word = begins ? std::ranges::find_if(words, fits) : words.end();
        text += word == words.end() ? message.substr(0, 1) : word->word;
        message.remove_prefix(word == words.end() ? 1 : word->option.size());
    }
    return printable_line(text);
}

}  // namespace latent::c
