// render/load/files/scene_files.h: the files that a scene is made of, found, read, and hashed by content.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/hash.h"
#include "base/result.h"

namespace latent::render {

class SceneFiles {
 public:
    // Names in a scene are relative to the folder of its first file.
    explicit SceneFiles(const std::filesystem::path& scene) : folder_(scene.parent_path()) {}

    std::filesystem::path resolve(const std::string& name) const { return folder_ / name; }
    // The whole content of a regular file. Errors name the file.
    static Result<std::string> read_text(const std::filesystem::path& path);
    // The same of a file that the scene names; its content counts in the hash, its name does not.
    Result<std::string> read(const std::string& name);

    // What else shapes the picture counts too.
    void count(std::string_view text);
    void count(double value);
    Hash128 hash() const { return hasher_.digest(); }

 private:
    std::filesystem::path folder_;
    Hasher128 hasher_;
};

}  // namespace latent::render
