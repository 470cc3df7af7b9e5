#include "tools/darkroom/server/folder.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/file.h"

namespace latent::darkroom {

Result<std::filesystem::path> Folder::file(const std::string& name) const {
    constexpr std::size_t kLongest = 100;
    const bool steers = std::ranges::any_of(name, [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; });
    if (name.empty() || name.size() > kLongest || name.front() == '.' || name.front() == '-' || steers ||
        name.find_first_of("/\\") != std::string::npos)
        return usage_error(
            "the name must be that of a file in the folder of recipes: 1 to 100 bytes, no slash, no dot or dash in front");
    return path_ / name;
}

std::vector<std::string> Folder::recipes() const {
    std::vector<std::string> names;
    std::error_code error;
    for (std::filesystem::directory_iterator it(path_, error), end; !error && it != end; it.increment(error)) {
        const std::filesystem::path& path = it->path();
        if (path.extension() == ".json" && file(path.filename().string())) names.push_back(path.stem().string());
    }
    std::ranges::sort(names);
    return names;
}

std::vector<std::string> Folder::profiles() const {
    constexpr std::size_t kMostProfiles = 200;
    std::vector<std::string> paths;
    const auto add = [&](auto it, std::error_code& error) {
        for (std::size_t found = 0; !error && it != decltype(it)() && found < kMostProfiles; it.increment(error)) {
            const std::filesystem::path& path = it->path();
            if (path.extension() != ".icc" && path.extension() != ".icm") continue;
            paths.push_back(std::filesystem::absolute(path).lexically_normal().string());
            ++found;
        }
    };
    std::error_code here, system;
    add(std::filesystem::directory_iterator(path_, here), here);
    add(std::filesystem::recursive_directory_iterator("/usr/share/color/icc", system), system);
    std::ranges::sort(paths);
    return paths;
}

Result<Recipe> Folder::recipe(const std::string& name) const {
    const Result<std::filesystem::path> path = file(name + ".json");
    if (!path) return path.error();
    return read_recipe(*path);
}

Status Folder::save(const std::string& name, const Recipe& recipe, bool replace) const {
    const Result<std::filesystem::path> path = file(name + ".json");
    if (!path) return path.error();
    if (const Result<std::string> fits = recipe_text(recipe); !fits) return fits.error();
    Result<OutputFile> out = OutputFile::create(*path, replace);
    if (!out) return out.error();
    const std::string text = recipe.dump(2, ' ', true) + "\n";
    if (Status s = out->file().write_all(0, std::as_bytes(std::span(text))); !s) return s;
    return out->publish();
}

Status Folder::copy(const std::string& name, const std::string& to) const {
    const Result<Recipe> kept = recipe(name);
    if (!kept) return kept.error();
    const Status saved = save(to, *kept, false);
    if (!saved && saved.error().code == ErrorCode::kExists)
        return Error{ErrorCode::kExists, fmt::format("there is a recipe of the name {} already", to)};
    return saved;
}

Status Folder::rename(const std::string& name, const std::string& to) const {
    if (Status s = copy(name, to); !s) return s;
    std::error_code error;
    std::filesystem::remove(*file(name + ".json"), error);
    if (error) return Error{ErrorCode::kIo, fmt::format("{}: {}", name, error.message())};
    return {};
}

}  // namespace latent::darkroom
