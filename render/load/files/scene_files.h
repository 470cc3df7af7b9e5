// render/load/files/scene_files.h: the files that a scene is made of, found and read.
#pragma once

#include <filesystem>
#include <string>

#include "base/hash.h"
#include "base/result.h"

namespace latent::render {

class SceneFiles {
 public:
    // Names in a scene are relative to the folder of its first file.
    explicit SceneFiles(const std::filesystem::path& scene) : folder_(scene.parent_path()) {}

    // Backslashes, as exporters on Windows write, are slashes unless there is a file of that very name.
    std::filesystem::path resolve(const std::string& name) const;
    // The whole content of a regular file, unpacked if it is gzip's, without a byte order mark. Errors name the file.
    static Result<std::string> read_text(const std::filesystem::path& path);
    // The same of a file that the scene names.
    Result<std::string> read(const std::string& name) const { return read_text(resolve(name)); }
    // Of the bytes of a file that stays on disk.
    Result<Hash128> hash(const std::string& name) const;

 private:
    std::filesystem::path folder_;
};

}  // namespace latent::render
