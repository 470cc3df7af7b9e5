// render/load/files/scene_files.h: the files that a scene is made of, found and read.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>

#include "base/hash.h"
#include "base/result.h"
#include "render/load/files/diagnostics.h"

namespace latent::render {

enum class AlphaUse : std::uint8_t;

// What stands in for a file until it is fetched.
bool is_lfs_pointer(std::string_view content);
inline constexpr std::string_view kLfsPointer = "is a Git LFS pointer instead of the file; fetch that with: git lfs pull";

class SceneFiles {
 public:
    // Names in a scene are relative to the folder of its first file.
    explicit SceneFiles(const std::filesystem::path& scene) : folder_(scene.parent_path()) {}

    // Backslashes, as exporters on Windows write, are slashes unless there is a file of that very name. Where there is none, one
    // whose name differs in upper and lower case alone is meant, if there is exactly one.
    std::filesystem::path resolve(const std::string& name) const;
    // A note on each of those, about the scene.
    void tell_of_other_names(const std::filesystem::path& scene, Diagnostics& diagnostics) const;
    // The whole content of a regular file, unpacked if it is gzip's, without a byte order mark. Errors name the file.
    static Result<std::string> read_text(const std::filesystem::path& path);
    // The same of a file that the scene names.
    Result<std::string> read(const std::string& name) const { return read_text(resolve(name)); }
    // The same of a file that a scene may name again and again, to include it each time. Errors: also kOutOfRange, if all that was
    // included adds up to more than 16 MiB and more than 100 times the files themselves: a few small files, nested, could become
    // as large as memory.
    Result<std::string> include(const std::filesystem::path& path);
    // The hash of a file that stays on disk. It is read once, however often the scene names it.
    Result<Hash128> hash(const std::string& name);
    // alpha_use of pictures.h, of a picture that is looked at once.
    Result<AlphaUse> alpha_use(const std::string& name);

 private:
    std::filesystem::path folder_;
    std::set<std::filesystem::path> included_;
    std::map<std::filesystem::path, Result<Hash128>> hashes_;
    std::map<std::filesystem::path, Result<AlphaUse>> alphas_;
    mutable std::map<std::string, std::filesystem::path> other_names_;  // by the name in the scene
    std::uint64_t distinct_bytes_ = 0, included_bytes_ = 0;             // in these files; in all inclusions
};

}  // namespace latent::render
