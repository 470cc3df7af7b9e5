// tools/inspect/print.h: reports on standard output. Whether they could be written shows at the end (base/cli.h). For main.cpp.
#pragma once

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/cli.h"
#include "sampledb/input_files.h"
#include "tools/inspect/info.h"
#include "tools/inspect/verify.h"

namespace latent::inspect {

inline void put(const std::string& text) { std::fputs(text.c_str(), stdout); }

template <class Report>
void print(const Report& report, bool as_json) {
    put(as_json ? to_json(report).dump(2) + "\n" : to_text(report));
}

inline int status_of(const FileInfo&) { return cli::kDone; }
inline int status_of(const VerifyReport& report) { return report.damage.empty() ? cli::kDone : cli::kDamaged; }

// Looks at every file, also behind one that cannot be read, and returns the worst status: damage over failure over success.
// As JSON, one file is an object; several are an array, where a file that cannot be read has an "error".
template <class Look>
int print_each(const std::vector<std::filesystem::path>& named, bool as_json, const Look& look) {
    int worst = cli::kDone;
    std::vector<nlohmann::json> reports;
    const auto failed = [&](const std::filesystem::path& path, const Error& error) {
        worst = std::max(worst, cli::fail(error));
        reports.push_back({{"file", path.string()}, {"error", error.message}});
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
            worst = std::max(worst, status_of(*report));
            if (as_json) {
                reports.push_back(to_json(*report));
            } else {
                print(*report, false);
            }
        }
    }
    if (as_json) put((reports.size() == 1 ? reports.front() : nlohmann::json(reports)).dump(2) + "\n");
    return worst;
}

}  // namespace latent::inspect
