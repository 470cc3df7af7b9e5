// sampledb/read/input_files.h: from what a user names (files, URLs, folders, globs, parts not yet published) to a list of files.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "base/result.h"
#include "sampledb/read/file_reader.h"

namespace latent::sampledb {

struct InputFile {
    std::filesystem::path path;
    bool named = true;  // one by one, by the user; false: found in a folder, by a glob, or as an attempt
};

// Files in the order given; those of a folder or glob sorted by name. Errors: kNotFound, kIo.
Result<std::vector<InputFile>> list_input_files(const std::vector<std::filesystem::path>& inputs);

// What is wrong with the end of a file: a published name promises a footer, so what follows the last run was cut or damaged.
// None for finished files and for attempts, whose last write may be unfinished.
std::optional<Damage> damage_at_end(const std::filesystem::path& path, const FileContents& file);

}  // namespace latent::sampledb
