#include "tools/inspect/cat.h"

#include <algorithm>
#include <cerrno>
#include <string>
#include <utility>

#include "base/url.h"
#include "sampledb/read/record_cursor.h"
#include "tools/inspect/damage.h"
#include "tools/inspect/npy_rows.h"
#include "tools/inspect/text_rows.h"

namespace latent::inspect {

using namespace sampledb;

namespace {

constexpr std::size_t kFlushBytes = std::size_t{1} << 16;

Status write(std::FILE* out, const void* bytes, std::size_t size) {
    if (std::fwrite(bytes, 1, size, out) != size) return error_from_errno(errno, "standard output", "cannot write");
    return {};
}
Status flush(std::FILE* out) {
    if (std::fflush(out) != 0) return error_from_errno(errno, "standard output", "cannot write");
    return {};
}

// Calls `take` with every page of the selection and the number of its rows to print. Damage costs the page or the run that it is
// in, and is added to the report.
template <class Take>
Result<RunSetReport> for_each_page(const RunSet& run_set, const RecordSelection& selection, std::uint64_t limit, const Take& take) {
    RunSetReport report = run_set.report();
    RecordCursor cursor(run_set, selection);
    Page page;
    while (limit > 0) {
        const Result<bool> more = cursor.next(page);
        if (!more) {
            if (!is_unreadable(more.error())) return more.error();
            const std::string name = shown_name(run_set.files()[run_set.runs()[cursor.run()].file]);
            leave_out(report.left_out, {name, more.error().message.substr(name.size() + 2)});
            continue;
        }
        if (!*more) break;
        const std::size_t rows = std::min<std::uint64_t>(page.count, limit);
        limit -= rows;
        if (Status s = take(page, rows); !s) return s.error();
    }
    return report;
}

Result<RunSetReport> cat_text(const CatOptions& options, const RunSet& run_set, const RecordSelection& selection, std::FILE* out) {
    TextRows lines(run_set.job(), options.format);
    std::string text = lines.heading();
    const auto write_out = [&]() -> Status {
        if (Status s = write(out, text.data(), text.size()); !s) return s;
        text.clear();
        return flush(out);
    };
    const Result<RunSetReport> report =
        for_each_page(run_set, selection, options.limit, [&](const Page& page, std::size_t rows) -> Status {
            for (std::size_t row = 0; row < rows; ++row) {
                lines.put(text, page, row);
                if (text.size() < kFlushBytes) continue;
                if (Status s = write_out(); !s) return s;
            }
            return {};
        });
    if (!report) return report;
    if (Status s = write_out(); !s) return s.error();
    return report;
}

// The header comes last: only then is the number of rows known.
Result<RunSetReport> cat_npy(const CatOptions& options, const RunSet& run_set, RecordSelection selection, std::FILE* out) {
    if (std::fseek(out, 0, SEEK_END) != 0 || std::ftell(out) != 0) {
        return usage_error("--format npy needs a new or empty file as standard output, not a pipe: add > FILE.npy");
    }
    Result<NpyRows> fields = NpyRows::of(run_set.job(), options.columns);
    if (!fields) return fields.error();
    selection.columns = fields->columns();
    const std::string placeholder(fields->header(0).size(), ' ');
    if (Status s = write(out, placeholder.data(), placeholder.size()); !s) return s.error();
    std::uint64_t count = 0;
    const Result<RunSetReport> report =
        for_each_page(run_set, selection, options.limit, [&](const Page& page, std::size_t rows) -> Status {
            count += rows;
            const ByteSpan bytes = fields->encode(page, rows);
            return write(out, bytes.data(), bytes.size());
        });
    if (!report) return report;
    if (Status s = flush(out); !s) return s.error();
    if (std::fseek(out, 0, SEEK_SET) != 0) return error_from_errno(errno, "standard output", "cannot seek");
    const std::string header = fields->header(count);
    if (Status s = write(out, header.data(), header.size()); !s) return s.error();
    if (Status s = flush(out); !s) return s.error();
    return report;
}

}  // namespace

Result<RunSetReport> cat(const CatOptions& options, std::FILE* out) {
    if (!options.columns.empty() && options.format != CatFormat::kNpy) {
        return usage_error("--columns needs --format npy");
    }
    RunSetOptions wanted;
    wanted.inputs = options.inputs;
    wanted.samples = options.samples;
    wanted.job = options.job;
    wanted.memory = options.memory;
    const Result<std::unique_ptr<RunSet>> run_set = RunSet::open(wanted);
    if (!run_set) return run_set.error();
    RecordSelection selection;
    if (options.region) {
        const Result<FilmRegion> region = FilmRegion::from(*options.region);
        if (!region) return region.error();
        selection.region = *region;
    }
    if (options.format == CatFormat::kNpy) return cat_npy(options, **run_set, selection, out);
    return cat_text(options, **run_set, selection, out);
}

}  // namespace latent::inspect
