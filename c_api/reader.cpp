// The reading half of latent.h: a Gathering, and cursors over its records.
#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "base/printable.h"
#include "base/url.h"
#include "c_api/abi.h"
#include "c_api/records.h"
#include "sampledb/read/record_cursor.h"

using namespace latent;
using namespace latent::sampledb;

struct latent_reader {
    explicit latent_reader(std::unique_ptr<Gathering> opened) : gathering(std::move(opened)) {
        const Job& from = gathering->job();
        for (const WavelengthDensity::Knot& knot : from.density.knots()) knots.push_back({knot.cumulative, knot.lambda, 0});
        for (const ExtraColumnSpec& column : from.extra)
            extra.push_back({column.name.c_str(), static_cast<uint32_t>(column.type), 0});
        for (const std::filesystem::path& file : gathering->files()) files.push_back(shown_name(file));
        for (const LeftOut& item : gathering->report().left_out)
            left_out.push_back(printable_line(item.place + ": " + item.reason));
        job.size = sizeof job;
        job.id_low = from.id.low, job.id_high = from.id.high;
        job.aspect_width = from.aspect_width, job.aspect_height = from.aspect_height;
        job.kind = static_cast<uint32_t>(from.kind);
        job.batch = from.batch;
        job.light_unit = from.light_unit_cd_m2;
        job.light_paths_per_sample = from.light_paths_per_sample;
        job.precision = from.precision;
        job.run_samples = from.run_samples, job.run_bytes = from.run_bytes;
        job.sampler = static_cast<uint32_t>(from.positions.sampler);
        job.shift_u = from.positions.shift_u, job.shift_v = from.positions.shift_v;
        job.knots = knots.empty() ? nullptr : knots.data(), job.knot_count = knots.size();
        job.extra = extra.empty() ? nullptr : extra.data(), job.extra_count = extra.size();
    }

    const std::shared_ptr<const Gathering> gathering;
    std::vector<latent_knot> knots;
    std::vector<latent_column> extra;
    std::vector<std::string> files, left_out;
    latent_job job{};
};

struct latent_cursor {
    latent_cursor(const latent_reader& reader, const RecordSelection& selection, uint32_t shown)
        : gathering(reader.gathering), job(gathering->job()), records(*gathering, selection), columns(shown) {}

    const std::shared_ptr<const Gathering> gathering;  // the reader may be closed first
    const Job& job;
    RecordCursor records;
    const uint32_t columns;
    Page page;
    c::RecordView view;
};

namespace {

constexpr uint32_t kAllColumns = 63;

Result<RecordSelection> selection_from(const latent_selection& given, uint32_t columns) {
    RecordSelection selection;
    if (columns > kAllColumns)
        return Error{ErrorCode::kUnsupported, "selection.columns has a column that this version does not have"};
    selection.columns.samples = (columns & LATENT_SAMPLES) != 0;
    selection.columns.positions = (columns & LATENT_POSITIONS) != 0;
    selection.columns.values = (columns & (LATENT_VALUES | LATENT_WAVELENGTHS)) != 0;
    selection.columns.share = (columns & LATENT_SHARES) != 0;
    selection.columns.extra = (columns & LATENT_EXTRA) != 0;
    if (given.classes > 2) return Error{ErrorCode::kOutOfRange, "selection.classes is not 0, 1 or 2"};
    selection.camera = given.classes != 2;
    selection.light = given.classes != 1;
    if (given.samples.first != 0 || given.samples.end != 0) selection.samples = SampleRange{given.samples.first, given.samples.end};
    if (selection.samples && selection.samples->empty()) return latent::usage_error("selection.samples is empty");
    if (given.runs.first != 0 || given.runs.end != 0) selection.first_run = given.runs.first, selection.end_run = given.runs.end;
    if (selection.first_run > selection.end_run) return latent::usage_error("selection.runs ends before it begins");
    const std::array<double, 4> region = {given.u0, given.v0, given.u1, given.v1};
    if (region != std::array<double, 4>{}) {
        const Result<FilmRegion> film = FilmRegion::from(region);
        if (!film) return film.error();
        selection.region = *film;
    }
    return selection;
}

}  // namespace

latent_status latent_reader_open(const char* const* paths, size_t count, const latent_read_options* options, latent_reader** reader,
                                 latent_error* error) {
    return c::guarded(error, [&]() -> Status {
        if (reader == nullptr) return latent::usage_error("reader is null");
        *reader = nullptr;
        if (paths == nullptr || count == 0) return latent::usage_error("no paths");
        GatherOptions gather;
        for (size_t i = 0; i < count; ++i) {
            if (paths[i] == nullptr) return latent::usage_error("a path is null");
            gather.inputs.emplace_back(paths[i]);
        }
        if (options != nullptr) {
            const Result<latent_read_options> given = c::taken(options, offsetof(latent_read_options, job_low), "options");
            if (!given) return given.error();
            gather.skip_duplicates = given->skip_duplicates != 0;
            if (given->verify != 0) gather.verify = VerifyLevel::kStored;
            if (given->job_low != 0 || given->job_high != 0) gather.job = JobId{given->job_low, given->job_high};
        }
        Result<std::unique_ptr<Gathering>> opened = Gathering::open(gather);
        if (!opened) return opened.error();
        *reader = new latent_reader(std::move(*opened));
        return {};
    });
}

latent_status latent_reader_job(const latent_reader* reader, latent_job* job, latent_error* error) {
    return c::guarded(error, [&]() -> Status {
        if (reader == nullptr) return latent::usage_error("reader is null");
        return c::give(reader->job, job, sizeof(latent_job), "job");
    });
}

latent_status latent_reader_get_info(const latent_reader* reader, latent_reader_info* info, latent_error* error) {
    return c::guarded(error, [&]() -> Status {
        if (reader == nullptr) return latent::usage_error("reader is null");
        latent_reader_info value{};
        value.files = reader->files.size();
        value.runs = reader->gathering->runs().size();
        value.samples = reader->gathering->coverage().size();
        value.light_paths = reader->gathering->light_paths();
        value.left_out = reader->left_out.size();
        for (const SelectedRun& run : reader->gathering->runs()) {
            value.pages += run.header.page_count;
            value.camera_records += run.header.camera_records;
            value.light_records += run.header.light_records;
            value.pairs += run.header.pair_count;
        }
        return c::give(value, info, sizeof(latent_reader_info), "info");
    });
}

size_t latent_reader_coverage(const latent_reader* reader, latent_range* ranges, size_t capacity) {
    if (reader == nullptr) return 0;
    const std::span<const SampleRange> covered = reader->gathering->coverage().ranges();
    for (size_t i = 0; ranges != nullptr && i < std::min(capacity, covered.size()); ++i)
        ranges[i] = {covered[i].first, covered[i].end};
    return covered.size();
}

latent_status latent_reader_run(const latent_reader* reader, uint64_t run, latent_run* info, latent_error* error) {
    return c::guarded(error, [&]() -> Status {
        if (reader == nullptr) return latent::usage_error("reader is null");
        const std::vector<SelectedRun>& runs = reader->gathering->runs();
        if (run >= runs.size()) return Error{ErrorCode::kOutOfRange, "there is no run " + std::to_string(run)};
        const SelectedRun& from = runs[run];
        const RunHeader& header = from.header;
        const std::span<const SampleRange> covered = from.coverage.ranges();
        latent_run value{};
        value.file = reader->files[from.file].c_str();
        value.offset = from.offset;
        value.samples = from.coverage.size();
        value.pages = header.page_count;
        value.camera_records = header.camera_records, value.light_records = header.light_records;
        value.pairs = header.pair_count;
        if (!covered.empty()) value.interval = {covered.front().first, covered.back().end};
        return c::give(value, info, sizeof(latent_run), "info");
    });
}

const char* latent_reader_left_out(const latent_reader* reader, uint64_t i) {
    return reader != nullptr && i < reader->left_out.size() ? reader->left_out[i].c_str() : nullptr;
}

void latent_reader_close(latent_reader* reader) { delete reader; }

latent_status latent_cursor_open(const latent_reader* reader, const latent_selection* selection, latent_cursor** cursor,
                                 latent_error* error) {
    return c::guarded(error, [&]() -> Status {
        if (cursor == nullptr) return latent::usage_error("cursor is null");
        *cursor = nullptr;
        if (reader == nullptr) return latent::usage_error("reader is null");
        latent_selection given{};
        if (selection != nullptr) {
            const Result<latent_selection> known = c::taken(selection, sizeof(latent_selection), "selection");
            if (!known) return known.error();
            given = *known;
        }
        const uint32_t columns = given.columns == 0 ? kAllColumns : given.columns;
        const Result<RecordSelection> made = selection_from(given, columns);
        if (!made) return made.error();
        *cursor = new latent_cursor(*reader, *made, columns);
        return {};
    });
}

latent_status latent_cursor_next(latent_cursor* cursor, latent_records* records, latent_error* error) {
    return c::guarded(error, [&]() -> Status {
        if (cursor == nullptr) return latent::usage_error("cursor is null");
        if (const auto fits = c::taken(records, sizeof(latent_records), "records"); !fits) return fits.error();
        const Result<bool> more = cursor->records.next(cursor->page);
        if (!more) return more.error();
        latent_records view = cursor->view.of(cursor->job, cursor->page, cursor->columns);
        view.run = cursor->records.run();
        view.page = cursor->records.page();
        return c::give(view, records, sizeof(latent_records), "records");
    });
}

void latent_cursor_close(latent_cursor* cursor) { delete cursor; }
