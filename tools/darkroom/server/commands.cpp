#include "tools/darkroom/server/commands.h"

#include <fmt/format.h>

#include <algorithm>

namespace latent::darkroom {

std::string quoted(const std::string& word) {
    const auto plain = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
               std::string_view("._/-+=,:").find(c) != std::string_view::npos;
    };
    if (!word.empty() && std::ranges::all_of(word, plain)) return word;
    std::string text = "'";
    for (const char c : word) {
        if (c == '\'')
            text += "'\\''";
        else
            text += c;
    }
    return text + "'";
}

std::string commands_for(const Recipe& recipe, const std::vector<std::filesystem::path>& inputs, const std::string& name) {
    std::string files;
    for (const std::filesystem::path& input : inputs) files += " " + quoted(input.string());
    return fmt::format("cat > {0} <<'END'\n{1}\nEND\nlatent-print{2} --recipe {0} -o {3}\n", quoted(name + ".json"),
                       recipe.dump(2, ' ', true), files, quoted(name + ".png"));
}

}  // namespace latent::darkroom
