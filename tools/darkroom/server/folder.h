// tools/darkroom/server/folder.h: the folder of recipes and prints. Nothing is written outside of it.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "base/recipe.h"
#include "base/result.h"

namespace latent::darkroom {

class Folder {
 public:
    explicit Folder(std::filesystem::path path) : path_(std::move(path)) {}
    const std::filesystem::path& path() const { return path_; }

    // A file in the folder. Errors: kUsage, for a name that is hidden, leads elsewhere, or is longer than 100 bytes.
    Result<std::filesystem::path> file(const std::string& name) const;

    // Names of the files NAME.json, sorted.
    std::vector<std::string> recipes() const;
    // ICC profiles in it, and those that the system has: paths, at most 200 of each.
    std::vector<std::string> profiles() const;
    Result<Recipe> recipe(const std::string& name) const;
    // As a whole or not at all. Errors: kExists, unless it replaces the one of that name.
    Status save(const std::string& name, const Recipe& recipe, bool replace) const;
    // Errors: kExists, if there is one of that name.
    Status copy(const std::string& name, const std::string& to) const;
    Status rename(const std::string& name, const std::string& to) const;

 private:
    std::filesystem::path path_;
};

}  // namespace latent::darkroom
