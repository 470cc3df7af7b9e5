// tools/inspect/print.h: reports on standard output. Whether they could be written shows at the end (base/cli.h). For main.cpp.
#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "base/cli.h"
#include "base/json.h"
#include "base/url.h"
#include "sampledb/read/input_files.h"
#include "tools/inspect/info.h"
#include "tools/inspect/verify.h"

namespace latent::inspect {

template <class Report>
std::string to_json_text(const Report& report) {
    return json_text(to_json(report));
}
template <class Report>
std::string text_of(const Report& report, bool as_json) {
    std::string text = as_json ? to_json_text(report) : to_text(report);
    if (as_json) text += '\n';
    return text;
}

inline int status_of(const FileInfo& info) { return info.left_out().empty() ? cli::kDone : cli::kDoneWithLosses; }
inline int status_of(const VerifyReport& report) {
    return report.damage.empty() && report.violations.count() == 0 ? cli::kDone : cli::kDamaged;
}

// The graver of two statuses: found damaged, then failed, then something left out, then done.
inline int graver(int a, int b) {
    static constexpr int kAscending[] = {cli::kDone, cli::kDoneWithLosses, cli::kFailed, cli::kDamaged};
    return std::ranges::find(kAscending, a) < std::ranges::find(kAscending, b) ? b : a;
}

// Looks at every file, also behind one that cannot be read, and returns the gravest status. What lies in a folder and is not a
// Latent file is skipped. As JSON, one file is an object; several are an array, where a file that cannot be read has an "error".
template <class Look>
int print_each(const std::vector<std::filesystem::path>& named, bool as_json, const Look& look) {
    struct Listed {
        sampledb::InputFile file;
        Status status;  // an error: it cannot be listed
    };
    std::vector<Listed> files;
    for (const std::filesystem::path& name : named) {
        const Result<std::vector<sampledb::InputFile>> found = sampledb::list_input_files({name});
        if (!found) files.push_back({{name}, found.error()});
        for (const sampledb::InputFile& file : found ? *found : std::vector<sampledb::InputFile>{}) files.push_back({file, {}});
    }
    int gravest = cli::kDone;
    const bool array = as_json && files.size() != 1;
    if (array) cli::print("[");
    bool is_first = true;
    std::size_t skipped = 0;
    for (const Listed& listed : files) {
        const std::filesystem::path& path = listed.file.path;
        const auto report = listed.status ? look(path) : decltype(look(path))(listed.status.error());
        if (!report && !listed.file.named && report.error().code == ErrorCode::kForeign) {
            cli::note(report.error().message + ", skipped");
            ++skipped;
            continue;
        }
        if (as_json && !std::exchange(is_first, false)) cli::print(",\n");
        if (report) {
            gravest = graver(gravest, status_of(*report));
            cli::print(as_json ? to_json_text(*report) : to_text(*report));
        } else {
            gravest = graver(gravest, cli::fail(report.error()));
            if (as_json) cli::print(json_text(nlohmann::json{{"file", shown_name(path)}, {"error", report.error().message}}));
        }
    }
    if (as_json) cli::print(array ? "]\n" : "\n");
    if (skipped == files.size()) return cli::fail({ErrorCode::kNotFound, named[0].string() + ": holds no .latent file"});
    return gravest;
}

}  // namespace latent::inspect
