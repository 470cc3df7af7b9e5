#include "base/recipe.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <vector>

#include "base/file.h"
#include "base/json.h"
#include "base/near_names.h"
#include "base/small_file.h"

namespace latent {

namespace {

constexpr std::string_view kVersionKey = "latent-recipe", kSchemaKey = "$schema";
constexpr std::string_view kBegin = "{\"latent-recipe\":";  // as recipe_text writes it

Error wrong(const std::string& what) { return usage_error(what); }

bool is_scalar(const Recipe& value) { return value.is_string() || value.is_number(); }

Status check_section(const std::string& name, const Recipe& section) {
    if (!section.is_object()) return wrong(fmt::format("{}: must be an object, {{...}}", name));
    for (const auto& [key, value] : section.items()) {
        if (is_scalar(value) || value.is_boolean()) continue;
        if (value.is_array() && std::ranges::all_of(value, is_scalar)) continue;
        return wrong(fmt::format("{}.{}: must be a text, a number, true, false, or a list of texts and numbers", name, key));
    }
    return {};
}

Status check_version(const Recipe& recipe) {
    const auto version = recipe.find(kVersionKey);
    if (version == recipe.end())
        return wrong(fmt::format("is no recipe; it must begin with \"{}\": {}", kVersionKey, kRecipeVersion));
    if (*version == kRecipeVersion) return {};
    return wrong(fmt::format("is a recipe of version {}; this program reads version {}", version->dump(), kRecipeVersion));
}

// The object at the front of `text`, as far as braces tell.
std::string_view object_at_front(std::string_view text) {
    int depth = 0;
    bool quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (quoted) {
            if (c == '\\') ++i;
            if (c == '"') quoted = false;
        } else if (c == '"') {
            quoted = true;
        } else if (c == '{') {
            ++depth;
        } else if (c == '}' && --depth == 0) {
            return text.substr(0, i + 1);
        }
    }
    return text;
}

// What follows the first kBegin in the file, that included; "" if there is none.
Result<std::string> text_inside(const File& file) {
    constexpr std::size_t kAtOnce = 1 << 20;
    std::string piece(kAtOnce + kBegin.size() - 1, '\0');  // the last bytes of a piece are the first of the next
    for (std::uint64_t at = 0;; at += kAtOnce) {
        const Result<std::size_t> got = file.read_some(at, std::as_writable_bytes(std::span(piece)));
        if (!got) return got.error();
        const std::size_t begin = std::string_view(piece).substr(0, *got).find(kBegin);
        if (begin == std::string_view::npos && *got < piece.size()) return "";
        if (begin == std::string_view::npos) continue;
        std::string text(kLongestRecipe, '\0');
        const Result<std::size_t> length = file.read_some(at + begin, std::as_writable_bytes(std::span(text)));
        if (!length) return length.error();
        text.resize(*length);
        return std::string(object_at_front(text));
    }
}

}  // namespace

Result<Recipe> parse_recipe(std::string_view text) {
    if (text.size() > kLongestRecipe) return wrong(fmt::format("too long for a recipe: more than {} bytes", kLongestRecipe));
    if (Status s = check_json_object(text, 3); !s) return wrong(s.error().message);
    std::vector<std::set<std::string>> names;  // one set for each object that is open
    std::string twice;
    const auto look = [&](int, Recipe::parse_event_t event, const Recipe& value) {
        if (event == Recipe::parse_event_t::object_start) names.emplace_back();
        if (event == Recipe::parse_event_t::object_end) names.pop_back();
        if (event == Recipe::parse_event_t::key && !names.back().insert(value.get<std::string>()).second)
            twice = value.get<std::string>();
        return true;
    };
    const Recipe recipe = Recipe::parse(text, look, false);
    if (!twice.empty()) return wrong(fmt::format("{}: given twice", twice));
    if (Status s = check_version(recipe); !s) return s.error();
    for (const auto& [name, section] : recipe.items()) {
        if (name == kVersionKey || (name == kSchemaKey && section.is_string())) continue;
        if (std::ranges::find(kRecipeSections, name) == std::end(kRecipeSections)) {
            const std::vector<std::string> sections(std::begin(kRecipeSections), std::end(kRecipeSections));
            const std::string near = near_names(name, sections);
            return wrong(
                fmt::format("{}: recipes have no such section{}", name, near.empty() ? "" : "; did you mean " + near + "?"));
        }
        if (Status s = check_section(name, section); !s) return s.error();
    }
    return recipe;
}

Result<Recipe> read_recipe(const std::filesystem::path& path) {
    const Result<File> file = File::open_read(path);
    if (!file) return file.error();
    std::string front(256, '\0');
    const Result<std::size_t> length = file->read_some(0, std::as_writable_bytes(std::span(front)));
    if (!length) return length.error();
    front.resize(*length);
    const std::size_t first = front.find_first_not_of(" \t\r\n");
    const bool is_json = first != std::string::npos && front[first] == '{';
    const Result<std::string> text = is_json ? read_small_file(path, kLongestRecipe, "a recipe") : text_inside(*file);
    if (!text) return is_json ? usage_error(text.error().message) : text.error();
    if (text->empty()) return usage_error(fmt::format("{}: holds no recipe", path.string()));
    Result<Recipe> recipe = parse_recipe(*text);
    if (!recipe) return recipe.error().at(path.string());
    return recipe;
}

Result<std::string> recipe_text(const Recipe& recipe) {
    Recipe all;
    all[kVersionKey] = kRecipeVersion;
    for (const std::string_view section : kRecipeSections) {
        if (const auto found = recipe.find(section); found != recipe.end() && !found->empty()) all[section] = *found;
    }
    std::string text = all.dump(-1, ' ', true, Recipe::error_handler_t::replace);
    if (text.size() > kLongestRecipe) return wrong(fmt::format("the recipe is too long: more than {} bytes", kLongestRecipe));
    return text;
}

}  // namespace latent
