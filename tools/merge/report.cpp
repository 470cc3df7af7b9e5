#include "tools/merge/report.h"

#include <fmt/format.h>

#include "base/json.h"
#include "base/size.h"
#include "sampledb/read/report_json.h"

namespace latent::merge {

std::string to_json(const MergeReport& r) {
    const nlohmann::json report = {{"job", to_hex(r.job.id)},
                                   {"files", r.files},
                                   {"runs_in", r.runs_in},
                                   {"runs_out", r.runs_out},
                                   {"superseded_runs", r.run_set.superseded_runs},
                                   {"repeated_runs", r.run_set.repeated_runs},
                                   {"camera_records", r.camera_records},
                                   {"light_records", r.light_records},
                                   {"bytes", r.bytes},
                                   {"left_out", r.run_set.left_out},
                                   {"notes", r.run_set.notes}};
    return with_member(json_text(report), "samples", r.coverage) + "\n";
}

std::string to_text(const MergeReport& r) {
    std::string text =
        fmt::format("{}: {} from {}, samples {}, {} camera and {} light records, {}\n", r.output, counted(r.runs_out, "run"),
                    counted(r.files, "file"), to_string(r.coverage), r.camera_records, r.light_records, format_size(r.bytes));
    if (r.compacted) text += fmt::format("compacted {} into {}\n", counted(r.runs_in, "run"), r.runs_out);
    return text;
}

}  // namespace latent::merge
