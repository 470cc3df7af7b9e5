// tools/inspect/print.h: reports on standard output. Whether they could be written shows at the end (base/cli.h). For main.cpp.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "base/cli.h"
#include "base/json.h"
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
    return as_json ? to_json_text(report) + "\n" : to_text(report);
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

// Looks at every file, also behind one that cannot be read, and returns the gravest status.
// As JSON, one file is an object; several are an array, where a file that cannot be read has an "error".
template <class Look>
int print_each(const std::vector<std::filesystem::path>& named, bool as_json, const Look& look) {
    int gravest = cli::kDone;
    std::vector<std::string> reports;
    const auto failed = [&](const std::filesystem::path& path, const Error& error) {
        gravest = graver(gravest, cli::fail(error));
        reports.push_back(json_text(nlohmann::json{{"file", path.string()}, {"error", error.message}}));
    };
    for (const std::filesystem::path& name : named) {
        const Result<std::vector<sampledb::InputFile>> files = sampledb::list_input_files({name});
        if (!files) failed(name, files.error());
        for (const sampledb::InputFile& file : files ? *files : std::vector<sampledb::InputFile>{}) {
            const auto report = look(file.path);
            if (!report) {
                failed(file.path, report.error());
                continue;
            }
            gravest = graver(gravest, status_of(*report));
            if (as_json) {
                reports.push_back(to_json_text(*report));
            } else {
                cli::print(to_text(*report));
            }
        }
    }
    if (as_json && reports.size() == 1) cli::print(reports.front() + "\n");
    if (as_json && reports.size() != 1) cli::print(fmt::format("[{}]\n", fmt::join(reports, ",\n")));
    return gravest;
}

}  // namespace latent::inspect
