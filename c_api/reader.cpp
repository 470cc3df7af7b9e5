// The reading half of latent.h: a RunSet, and cursors over its records.
#include <array>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "base/printable.h"
#include "base/url.h"
#include "c_api/abi.h"
#include "c_api/handles.h"
#include "c_api/origin.h"
#include "c_api/records.h"
#include "sampledb/read/record_cursor.h"

using namespace latent;
using namespace latent::sampledb;

struct latent_reader {
    explicit latent_reader(std::unique_ptr<RunSet> opened) : run_set(std::move(opened)) {
        const Job& from = run_set->job();
        for (const WavelengthDensity::Knot& knot : from.density.knots()) knots.push_back({knot.cumulative, knot.lambda, 0});
        for (const ExtraColumnSpec& column : from.extra)
            extra.push_back({column.name.c_str(), static_cast<uint32_t>(column.type), 0});
        for (const std::filesystem::path& file : run_set->files()) files.push_back(shown_name(file));
        for (const LeftOut& item : run_set->report().left_out) left_out.push_back(printable_line(item.place + ": " + item.reason));
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
        job.width = from.positions.width, job.height = from.positions.height;
        job.knots = knots.empty() ? nullptr : knots.data(), job.knot_count = knots.size();
        job.extra = extra.empty() ? nullptr : extra.data(), job.extra_count = extra.size();
    }

    // Read on demand.
    const Result<c::Origin>& origin() const {
        const std::lock_guard lock(mutex);
        if (!its_origin) its_origin = c::origin_of(*run_set);
        return *its_origin;
    }

    const std::unique_ptr<RunSet> run_set;
    mutable std::mutex mutex;  // guards what follows
    mutable std::optional<Result<c::Origin>> its_origin;
    std::vector<latent_knot> knots;
    std::vector<latent_column> extra;
    std::vector<std::string> files, left_out;
    latent_job job{};
};

struct latent_cursor {
    latent_cursor(std::shared_ptr<const latent_reader> its_reader, const RecordSelection& selection, uint32_t shown)
        : reader(std::move(its_reader)), records(*reader->run_set, selection), columns(shown) {}

    const std::shared_ptr<const latent_reader> reader;
    RecordCursor records;
    const uint32_t columns;
    Page page;
    c::RecordView view;
};

namespace {

using Readers = c::Handles<latent_reader>;
using Cursors = c::Handles<latent_cursor>;

constexpr uint32_t kAllColumns = 63;

Result<RecordSelection> selection_from(const latent_selection& given, uint32_t columns) {
    RecordSelection selection;
    if (columns > kAllColumns)
        return Error{ErrorCode::kUnsupported, "selection.columns has a column that this version does not have"};
    selection.columns.samples = (columns & LATENT_SAMPLES) != 0;
    selection.columns.positions = (columns & LATENT_POSITIONS) != 0;
    selection.columns.values = (columns & (LATENT_VALUES | LATENT_WAVELENGTHS)) != 0;
    selection.columns.share = (columns & LATENT_SHARES) != 0;
    if ((columns & LATENT_EXTRA) == 0) selection.columns.extra.reset();
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
        RunSetOptions selection;
        for (size_t i = 0; i < count; ++i) {
            if (paths[i] == nullptr) return latent::usage_error("a path is null");
            selection.inputs.emplace_back(paths[i]);
        }
        if (options != nullptr) {
            const Result<latent_read_options> given = c::taken(options, offsetof(latent_read_options, job_low), "options");
            if (!given) return given.error();
            selection.skip_duplicates = given->skip_duplicates != 0;
            if (given->verify != 0) selection.verify = VerifyLevel::kStored;
            if (given->job_low != 0 || given->job_high != 0) selection.job = JobId{given->job_low, given->job_high};
        }
        Result<std::unique_ptr<RunSet>> opened = RunSet::open(selection);
        if (!opened) return opened.error();
        *reader = Readers::open().add(std::make_shared<latent_reader>(std::move(*opened)));
        return {};
    });
}

latent_status latent_reader_job(const latent_reader* reader, latent_job* job, latent_error* error) {
    return c::guarded(error, [&]() -> Status {
        const auto object = Readers::open().find(reader, "reader");
        if (!object) return object.error();
        return c::give((*object)->job, job, c::kJobSize, "job");
    });
}

latent_status latent_reader_get_info(const latent_reader* reader, latent_reader_info* info, latent_error* error) {
    return c::guarded(error, [&]() -> Status {
        const auto object = Readers::open().find(reader, "reader");
        if (!object) return object.error();
        latent_reader_info value{};
        value.files = (*object)->files.size();
        value.runs = (*object)->run_set->runs().size();
        value.samples = (*object)->run_set->coverage().size();
        value.light_paths = (*object)->run_set->light_paths();
        value.left_out = (*object)->left_out.size();
        for (const SelectedRun& run : (*object)->run_set->runs()) {
            value.pages += run.header.page_count;
            value.camera_records += run.header.camera_records;
            value.light_records += run.header.light_records;
            value.pairs += run.header.pair_count;
        }
        return c::give(value, info, sizeof(latent_reader_info), "info");
    });
}

size_t latent_reader_coverage(const latent_reader* reader, latent_range* ranges, size_t capacity) {
    const auto object = Readers::open().look_up(reader);
    if (object == nullptr) return 0;
    const std::span<const SampleRange> covered = object->run_set->coverage().ranges();
    for (size_t i = 0; ranges != nullptr && i < std::min(capacity, covered.size()); ++i)
        ranges[i] = {covered[i].first, covered[i].end};
    return covered.size();
}

latent_status latent_reader_run(const latent_reader* reader, uint64_t run, latent_run* info, latent_error* error) {
    return c::guarded(error, [&]() -> Status {
        const auto object = Readers::open().find(reader, "reader");
        if (!object) return object.error();
        const std::vector<SelectedRun>& runs = (*object)->run_set->runs();
        if (run >= runs.size()) return Error{ErrorCode::kOutOfRange, "there is no run " + std::to_string(run)};
        const SelectedRun& from = runs[run];
        const RunHeader& header = from.header;
        const std::span<const SampleRange> covered = from.coverage.ranges();
        latent_run value{};
        value.file = (*object)->files[from.file].c_str();
        value.offset = from.offset;
        value.samples = from.coverage.size();
        value.pages = header.page_count;
        value.camera_records = header.camera_records, value.light_records = header.light_records;
        value.pairs = header.pair_count;
        if (!covered.empty()) value.interval = {covered.front().first, covered.back().end};
        return c::give(value, info, sizeof(latent_run), "info");
    });
}

latent_status latent_reader_provenance(const latent_reader* reader, const char** json, latent_error* error) {
    return c::guarded(error, [&]() -> Status {
        if (json == nullptr) return latent::usage_error("json is null");
        *json = nullptr;
        const auto object = Readers::open().find(reader, "reader");
        if (!object) return object.error();
        const Result<c::Origin>& origin = (*object)->origin();
        if (!origin) return origin.error();
        *json = origin->json.c_str();
        return {};
    });
}

namespace {

// Name `i` of a list of its origin; null if there is none.
const char* name_of(const latent_reader* reader, std::vector<std::string> c::Origin::*list, uint64_t i) {
    const auto object = Readers::open().look_up(reader);
    if (object == nullptr) return nullptr;
    try {
        const Result<c::Origin>& origin = object->origin();
        return origin && i < ((*origin).*list).size() ? ((*origin).*list)[i].c_str() : nullptr;
    } catch (...) {
        return nullptr;
    }
}

}  // namespace

const char* latent_reader_light_group(const latent_reader* reader, uint64_t i) {
    return name_of(reader, &c::Origin::light_groups, i);
}

const char* latent_reader_material(const latent_reader* reader, uint64_t i) {
    return i == 0 ? nullptr : name_of(reader, &c::Origin::materials, i - 1);
}

const char* latent_reader_left_out(const latent_reader* reader, uint64_t i) {
    const auto object = Readers::open().look_up(reader);
    return object != nullptr && i < object->left_out.size() ? object->left_out[i].c_str() : nullptr;
}

void latent_reader_close(latent_reader* reader) { Readers::open().take(reader); }

latent_status latent_cursor_open(const latent_reader* reader, const latent_selection* selection, latent_cursor** cursor,
                                 latent_error* error) {
    return c::guarded(error, [&]() -> Status {
        if (cursor == nullptr) return latent::usage_error("cursor is null");
        *cursor = nullptr;
        const auto object = Readers::open().find(reader, "reader");
        if (!object) return object.error();
        latent_selection given{};
        if (selection != nullptr) {
            const Result<latent_selection> known = c::taken(selection, sizeof(latent_selection), "selection");
            if (!known) return known.error();
            given = *known;
        }
        const uint32_t columns = given.columns == 0 ? kAllColumns : given.columns;
        const Result<RecordSelection> made = selection_from(given, columns);
        if (!made) return made.error();
        *cursor = Cursors::open().add(std::make_shared<latent_cursor>(*object, *made, columns));
        return {};
    });
}

latent_status latent_cursor_next(latent_cursor* cursor, latent_records* records, latent_error* error) {
    return c::guarded(error, [&]() -> Status {
        const auto object = Cursors::open().find(cursor, "cursor");
        if (!object) return object.error();
        latent_cursor& its = **object;
        if (const auto fits = c::taken(records, sizeof(latent_records), "records"); !fits) return fits.error();
        const Result<bool> more = its.records.next(its.page);
        if (!more) return more.error();
        latent_records view = its.view.of(its.reader->run_set->job(), its.page, its.columns);
        view.run = its.records.run();
        view.page = its.records.page();
        return c::give(view, records, sizeof(latent_records), "records");
    });
}

void latent_cursor_close(latent_cursor* cursor) { Cursors::open().take(cursor); }
