#include "sampledb/read/input_files.h"

#include <fmt/format.h>
#include <glob.h>

#include <algorithm>

#include "base/url.h"
#include "sampledb/read/part_name.h"

namespace latent::sampledb {

namespace fs = std::filesystem;

namespace {

// Everything in a folder but what is hidden, sorted, also what is no file: the reader lists what is not Latent's.
Result<std::vector<fs::path>> files_in(const fs::path& folder) {
    std::vector<fs::path> found;
    std::error_code error;
    fs::directory_iterator it(folder, error);
    for (; !error && it != fs::directory_iterator(); it.increment(error)) {
        if (!it->path().filename().string().starts_with('.')) found.push_back(it->path());
    }
    if (error) return error_from_errno(error.value(), folder.string(), "cannot list");
    std::ranges::sort(found);
    return found;
}

std::vector<fs::path> files_matching(const fs::path& pattern) {
    std::vector<fs::path> found;
    glob_t matches{};
    if (::glob(pattern.c_str(), 0, nullptr, &matches) == 0) found.assign(matches.gl_pathv, matches.gl_pathv + matches.gl_pathc);
    ::globfree(&matches);
    return found;
}

}  // namespace

std::optional<Damage> damage_at_end(const fs::path& path, const FileContents& file) {
    if (file.finished || is_attempt(path)) return {};
    const std::string found = fmt::format("{} run{} found", file.runs.size(), file.runs.size() == 1 ? " was" : "s were");
    if (file.footer_begun) {
        return Damage{file.end, file.unfinished_tail,
                      fmt::format("footer at byte {} truncated or damaged; {} before it", file.end, found)};
    }
    const std::string not_read =
        file.unfinished_tail > 0 ? fmt::format(", {} bytes from byte {} on were ignored", file.unfinished_tail, file.end) : "";
    return Damage{file.end, file.unfinished_tail,
                  fmt::format("truncated or damaged at its end: no footer{}; {}, and others may be lost", not_read, found)};
}

Result<std::vector<InputFile>> list_input_files(const std::vector<fs::path>& inputs) {
    std::vector<InputFile> files;
    const auto add_found = [&](const std::vector<fs::path>& found) {
        for (const fs::path& path : found) files.push_back({path, false});
    };
    for (const fs::path& input : inputs) {
        std::error_code error;
        if (!is_url(input) && fs::is_directory(input, error)) {
            const auto found = files_in(input);
            if (!found) return found.error();
            if (found->empty()) return Error{ErrorCode::kNotFound, input.string() + ": contains no files"};
            add_found(*found);
        } else if (is_url(input) || input.empty() || fs::exists(input, error) || error) {  // when opened, it says what is wrong
            files.push_back({input, true});
        } else {
            std::vector<fs::path> found = attempts_of(input);
            if (found.empty()) found = files_matching(input);
            if (found.empty()) return Error{ErrorCode::kNotFound, shown_name(input) + ": no such file"};
            add_found(found);
        }
    }
    return files;
}

}  // namespace latent::sampledb
