// latent.h, seen from its callers: what the examples write is a file like any other, records come back with all their bits, and
// misuse is an error.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <functional>
#include <map>
#include <memory>
#include <numeric>
#include <set>
#include <thread>

#include "base/printable.h"
#include "c_api/latent.h"
#include "tests/c_api/submitted_grain.h"
#include "tests/faults/process.h"
#include "tests/support/opened_runs.h"
#include "tests/support/synthetic.h"

namespace latent::sampledb {
namespace {

namespace fs = std::filesystem;
using namespace latent::testing;

struct WriterCloser {
    void operator()(latent_writer* w) const { latent_writer_close(w); }
};
struct ReaderCloser {
    void operator()(latent_reader* r) const { latent_reader_close(r); }
};
struct CursorCloser {
    void operator()(latent_cursor* c) const { latent_cursor_close(c); }
};
using Writer = std::unique_ptr<latent_writer, WriterCloser>;
using Reader = std::unique_ptr<latent_reader, ReaderCloser>;
using Cursor = std::unique_ptr<latent_cursor, CursorCloser>;

// A job of the library in the types of C; what it points to lives as long.
struct CJob {
    explicit CJob(const Job& job) {
        for (const auto& knot : job.density.knots()) knots.push_back({knot.cumulative, knot.lambda, 0});
        for (const ExtraColumnSpec& column : job.extra) names.push_back(column.name);
        for (std::size_t i = 0; i < names.size(); ++i)
            extra.push_back({names[i].c_str(), static_cast<std::uint32_t>(job.extra[i].type), 0});
        c.size = sizeof c;
        c.id_low = job.id.low, c.id_high = job.id.high;
        c.aspect_width = job.aspect_width, c.aspect_height = job.aspect_height;
        c.kind = static_cast<std::uint32_t>(job.kind), c.batch = job.batch;
        c.light_unit = job.light_unit_cd_m2, c.light_paths_per_sample = job.light_paths_per_sample;
        c.precision = job.precision, c.run_samples = job.run_samples, c.run_bytes = job.run_bytes;
        c.sampler = static_cast<std::uint32_t>(job.positions.sampler);
        c.shift_u = job.positions.shift_u, c.shift_v = job.positions.shift_v;
        c.knots = knots.data(), c.knot_count = knots.size();
        c.extra = extra.data(), c.extra_count = extra.size();
    }
    CJob(const CJob&) = delete;
    CJob& operator=(const CJob&) = delete;
    std::vector<latent_knot> knots;
    std::vector<std::string> names;
    std::vector<latent_column> extra;
    latent_job c{};
};

struct CRecords {
    explicit CRecords(const Records& r) {
        for (const RecordClass record_class : r.record_class) classes.push_back(static_cast<std::uint8_t>(record_class));
        for (const ExtraColumn& column : r.extra) extra.push_back(column.values.data());
        c.size = sizeof c;
        c.count = r.size();
        c.sample = r.sample.data(), c.record_class = classes.data(), c.u = r.u.data(), c.v = r.v.data(), c.share = r.share.data();
        c.x = r.x.data(), c.y = r.y.data(), c.z = r.z.data();
        c.pairs = r.pairs.data(), c.power = r.power.data(), c.lambda_nm = r.lambda_nm.data(), c.pair_count = r.power.size();
        c.xi = r.xi.data(), c.index = r.index.data(), c.extra = extra.data();
    }
    CRecords(const CRecords&) = delete;
    CRecords& operator=(const CRecords&) = delete;
    std::vector<std::uint8_t> classes;
    std::vector<const void*> extra;
    latent_records c{};
};

latent_write_options options_for(std::uint64_t end) {
    latent_write_options options{};
    options.size = sizeof options;
    options.samples = {0, end};
    return options;
}

Writer open_writer(const std::filesystem::path& path, const CJob& job, std::uint64_t end) {
    const latent_write_options options = options_for(end);
    latent_writer* writer = nullptr;
    latent_error error{};
    EXPECT_EQ(latent_writer_open(path.c_str(), &job.c, &options, &writer, &error), LATENT_OK) << error.message;
    return Writer(writer);
}

void write_all(latent_writer* writer, const Job& job, int threads, const synthetic::Scene& scene = {}) {
    std::vector<std::thread> pool;
    for (int i = 0; i < threads; ++i) {
        pool.emplace_back([&] {
            latent_range grain;
            latent_error error{};
            while (latent_writer_next(writer, &grain) != 0) {
                const Records made = synthetic::make_records(job, {grain.first, grain.end}, scene);
                const CRecords given(made);
                EXPECT_EQ(latent_writer_submit(writer, grain, &given.c, &error), LATENT_OK) << error.message;
            }
        });
    }
    for (std::thread& thread : pool) thread.join();
    latent_error error{};
    EXPECT_EQ(latent_writer_finish(writer, &error), LATENT_OK) << error.message;
}

Reader open_reader(const std::filesystem::path& path) {
    const std::string name = path.string();
    const char* const names[] = {name.c_str()};
    latent_reader* reader = nullptr;
    latent_error error{};
    EXPECT_EQ(latent_reader_open(names, 1, nullptr, &reader, &error), LATENT_OK) << error.message;
    return Reader(reader);
}

// A record with all its bits, as text, so that records sort and compare.
template <class T>
void put(std::string& text, const T& value) {
    text.append(reinterpret_cast<const char*>(&value), sizeof value);
}

using Lines = std::multiset<std::string>;

Lines lines_of(const Job& job, const Records& r) {
    Lines lines;
    std::size_t pair = 0;
    std::vector<float> lambda(1024);
    for (std::size_t i = 0; i < r.size(); ++i) {
        std::string line;
        put(line, r.sample[i]), put(line, static_cast<std::uint8_t>(r.record_class[i])), put(line, r.u[i]), put(line, r.v[i]),
            put(line, r.share[i]);
        if (job.kind == RecordKind::kXyz) {
            put(line, r.x[i]), put(line, r.y[i]), put(line, r.z[i]);
        } else {
            const std::uint16_t n = r.pairs[i];
            if (!job.density.empty() && n == job.batch) job.density.batch(r.xi[i], std::span(lambda).first(n));
            if (!job.density.empty() && n == 1 && job.batch > 1) lambda[0] = job.density.wavelength(r.xi[i], r.index[i], job.batch);
            for (std::uint16_t p = 0; p < n; ++p, ++pair)
                put(line, r.power[pair]), put(line, job.density.empty() ? r.lambda_nm[pair] : lambda[p]);
        }
        for (const ExtraColumn& column : r.extra) {
            const std::size_t bytes = width(column.type);
            line.append(reinterpret_cast<const char*>(column.values.data()) + i * bytes, bytes);
        }
        lines.insert(line);
    }
    return lines;
}

Lines lines_of(const Job& job, const latent_reader* reader, const latent_selection* selection) {
    Lines lines;
    latent_cursor* opened = nullptr;
    latent_error error{};
    EXPECT_EQ(latent_cursor_open(reader, selection, &opened, &error), LATENT_OK) << error.message;
    const Cursor cursor(opened);
    for (;;) {
        latent_records r{};
        r.size = sizeof r;
        EXPECT_EQ(latent_cursor_next(opened, &r, &error), LATENT_OK) << error.message;
        if (r.count == 0 || error.status != LATENT_OK) return lines;
        for (std::size_t i = 0; i < r.count; ++i) {
            std::string line;
            put(line, r.sample[i]), put(line, r.record_class[i]), put(line, r.u[i]), put(line, r.v[i]), put(line, r.share[i]);
            if (job.kind == RecordKind::kXyz) {
                put(line, r.x[i]), put(line, r.y[i]), put(line, r.z[i]);
            } else {
                for (std::size_t p = r.first_pair[i]; p < r.first_pair[i] + r.pairs[i]; ++p)
                    put(line, r.power[p]), put(line, r.lambda_nm[p]);
            }
            for (std::size_t e = 0; e < job.extra.size(); ++e) {
                const std::size_t bytes = width(job.extra[e].type);
                line.append(static_cast<const char*>(r.extra[e]) + i * bytes, bytes);
            }
            lines.insert(line);
        }
    }
}

std::vector<Job> jobs_of_every_kind() {
    Job xyz = synthetic::make_short_job(), spectral = synthetic::make_short_job(RecordKind::kSpectral),
        explicit_wavelengths = spectral, extra = xyz;
    explicit_wavelengths.density = {};
    extra.positions = {};
    extra.extra = {{"light_group", ColumnType::kU8}, {"time", ColumnType::kF64},   {"depth", ColumnType::kF32},
                   {"normal.x", ColumnType::kF32},   {"object", ColumnType::kU64}, {"material", ColumnType::kU16}};
    return {xyz, spectral, explicit_wavelengths, extra};
}

constexpr std::uint64_t kSamples = 9000;

TEST(CApi, RecordsComeBackWithAllTheirBitsWhateverTheirKind) {
    for (const Job& job : jobs_of_every_kind()) {
        const TemporaryFolder folder;
        const CJob c_job(job);
        synthetic::Scene scene;
        scene.split_shares = true;
        write_all(open_writer(folder / "a.latent", c_job, kSamples).get(), job, 4, scene);
        const Reader reader = open_reader(folder / "a.latent");
        ASSERT_NE(reader, nullptr);
        EXPECT_TRUE(lines_of(job, reader.get(), nullptr) == lines_of(job, synthetic::make_records(job, {0, kSamples}, scene)));
        latent_job again{};
        again.size = sizeof again;
        ASSERT_EQ(latent_reader_job(reader.get(), &again, nullptr), LATENT_OK);
        // The job that comes out opens the part that is there: it is the same.
        const latent_write_options options = options_for(kSamples);
        latent_writer* writer = nullptr;
        latent_error error{};
        ASSERT_EQ(latent_writer_open((folder / "a.latent").c_str(), &again, &options, &writer, &error), LATENT_OK) << error.message;
        EXPECT_EQ(latent_writer_missing(writer, nullptr, 0), 0u);
        latent_writer_close(writer);
    }
}

TEST(CApi, ASelectionHoldsExactlyTheRecordsThatItDescribes) {
    for (const Job& job : jobs_of_every_kind()) {
        const TemporaryFolder folder;
        const CJob c_job(job);
        write_all(open_writer(folder / "a.latent", c_job, kSamples).get(), job, 1);
        const Reader reader = open_reader(folder / "a.latent");
        ASSERT_NE(reader, nullptr);
        latent_selection selection{};
        selection.size = sizeof selection;
        selection.classes = 1;
        selection.samples = {1000, 7777};
        selection.u0 = 0.1, selection.v0 = 0.25, selection.u1 = 0.7, selection.v1 = 1;
        const Records all = synthetic::make_records(job, {1000, 7777});
        Records expected = all.without_rows();
        for (std::size_t i = 0, pair = 0; i < all.size(); ++i) {
            const double u = all.u[i] * 0x1p-32, v = all.v[i] * 0x1p-32;
            if (all.record_class[i] == RecordClass::kCamera && u >= 0.1 && u < 0.7 && v >= 0.25) expected.append(all, i, pair);
            if (!all.pairs.empty()) pair += all.pairs[i];
        }
        ASSERT_GT(expected.size(), 1000u);
        EXPECT_TRUE(lines_of(job, reader.get(), &selection) == lines_of(job, expected));
    }
}

TEST(CApi, ColumnsThatWereNotAskedForAreNull) {
    const TemporaryFolder folder;
    const Job job = synthetic::make_short_job(RecordKind::kSpectral);
    write_all(open_writer(folder / "a.latent", CJob(job), kSamples).get(), job, 1);
    const Reader reader = open_reader(folder / "a.latent");
    latent_selection selection{};
    selection.size = sizeof selection;
    selection.columns = LATENT_VALUES;
    selection.u1 = selection.v1 = 0.5;
    latent_cursor* opened = nullptr;
    ASSERT_EQ(latent_cursor_open(reader.get(), &selection, &opened, nullptr), LATENT_OK);
    const Cursor cursor(opened);
    latent_records r{};
    r.size = sizeof r;
    ASSERT_EQ(latent_cursor_next(opened, &r, nullptr), LATENT_OK);
    ASSERT_GT(r.count, 0u);
    EXPECT_NE(r.power, nullptr);
    EXPECT_EQ(r.sample, nullptr);
    EXPECT_EQ(r.u, nullptr);
    EXPECT_EQ(r.share, nullptr);
    EXPECT_EQ(r.lambda_nm, nullptr);
    EXPECT_EQ(r.x, nullptr);
    EXPECT_EQ(r.extra, nullptr);
}

TEST(CApi, ACursorGoesOnWhenItsReaderIsClosed) {
    const TemporaryFolder folder;
    const Job job = synthetic::make_short_job();
    write_all(open_writer(folder / "a.latent", CJob(job), kSamples).get(), job, 1);
    Reader reader = open_reader(folder / "a.latent");
    latent_cursor* opened = nullptr;
    ASSERT_EQ(latent_cursor_open(reader.get(), nullptr, &opened, nullptr), LATENT_OK);
    const Cursor cursor(opened);
    reader.reset();
    latent_records r{};
    r.size = sizeof r;
    ASSERT_EQ(latent_cursor_next(opened, &r, nullptr), LATENT_OK);
    EXPECT_GT(r.count, 0u);
}

TEST(CApi, InfoAndRunsAddUpToTheFile) {
    const TemporaryFolder folder;
    const Job job = synthetic::make_short_job();
    write_all(open_writer(folder / "a.latent", CJob(job), kSamples).get(), job, 2);
    const Reader reader = open_reader(folder / "a.latent");
    latent_reader_info info{};
    info.size = sizeof info;
    ASSERT_EQ(latent_reader_get_info(reader.get(), &info, nullptr), LATENT_OK);
    const Records all = synthetic::make_records(job, {0, kSamples});
    EXPECT_EQ(info.samples, kSamples);
    EXPECT_EQ(info.camera_records + info.light_records, all.size());
    EXPECT_EQ(info.runs, 3u);
    EXPECT_EQ(info.light_paths, kSamples);
    latent_range covered[2];
    ASSERT_EQ(latent_reader_coverage(reader.get(), covered, 2), 1u);
    EXPECT_EQ(covered[0].end, kSamples);
    std::uint64_t pages = 0, samples = 0;
    for (std::uint64_t i = 0; i < info.runs; ++i) {
        latent_run run{};
        run.size = sizeof run;
        ASSERT_EQ(latent_reader_run(reader.get(), i, &run, nullptr), LATENT_OK);
        pages += run.pages, samples += run.samples;
    }
    EXPECT_EQ(pages, info.pages);
    EXPECT_EQ(samples, info.samples);
}

TEST(CApi, ACheckpointOutlivesAWriterThatDidNotFinish) {
    const TemporaryFolder folder;
    const Job job = synthetic::make_short_job();
    const CJob c_job(job);
    latent_range grain;
    {
        const Writer writer = open_writer(folder / "a.latent", c_job, kSamples);
        for (int i = 0; i < 3; ++i) {
            ASSERT_EQ(latent_writer_next(writer.get(), &grain), 1);
            const Records made = synthetic::make_records(job, {grain.first, grain.end});
            const CRecords records(made);
            ASSERT_EQ(latent_writer_submit(writer.get(), grain, &records.c, nullptr), LATENT_OK);
        }
        ASSERT_EQ(latent_writer_checkpoint(writer.get(), nullptr), LATENT_OK);
    }
    const Writer writer = open_writer(folder / "a.latent", c_job, kSamples);
    latent_range missing[2];
    ASSERT_EQ(latent_writer_missing(writer.get(), missing, 2), 1u);
    EXPECT_EQ(missing[0].first, 3072u);
    EXPECT_EQ(missing[0].end, kSamples);
    write_all(writer.get(), job, 2);
    const Reader reader = open_reader(folder / "a.latent");
    ASSERT_NE(reader, nullptr);
    EXPECT_TRUE(lines_of(job, reader.get(), nullptr) == lines_of(job, synthetic::make_records(job, {0, kSamples})));
}

// Every call, given nothing or the wrong thing, returns a status and a line of text.
TEST(CApi, MisuseIsAnErrorWithAMessage) {
    const TemporaryFolder folder;
    const std::string path = folder / "a.latent";
    const Job job = synthetic::make_short_job();
    const CJob good(job);
    const latent_write_options options = options_for(kSamples);
    latent_writer* writer = nullptr;
    latent_error error{};
    const auto refused = [&](latent_status status, latent_status expected) {
        EXPECT_EQ(status, expected) << error.message;
        EXPECT_EQ(error.status, expected);
        EXPECT_GT(std::strlen(error.message), 5u);
        error = {};
    };
    const auto open = [&](const char* name, const latent_job* with, const latent_write_options* how) {
        const latent_status status = latent_writer_open(name, with, how, &writer, &error);
        EXPECT_EQ(writer, nullptr);
        return status;
    };
    refused(open(nullptr, &good.c, &options), LATENT_USAGE);
    refused(open(path.c_str(), nullptr, &options), LATENT_USAGE);
    refused(open(path.c_str(), &good.c, nullptr), LATENT_USAGE);
    refused(latent_writer_open(path.c_str(), &good.c, &options, nullptr, &error), LATENT_USAGE);
    refused(open((folder / "a.txt").c_str(), &good.c, &options), LATENT_USAGE);
    refused(open((folder / "none" / "a.latent").c_str(), &good.c, &options), LATENT_NOT_FOUND);
    const auto with = [&](auto change) {
        latent_job bad = good.c;
        change(bad);
        return open(path.c_str(), &bad, &options);
    };
    refused(with([](latent_job& j) { j.size = 0; }), LATENT_USAGE);
    refused(with([](latent_job& j) { j.size = ~std::size_t{0}; }), LATENT_USAGE);
    refused(with([](latent_job& j) { j.kind = 3; }), LATENT_OUT_OF_RANGE);
    refused(with([](latent_job& j) { j.batch = 5; }), LATENT_OUT_OF_RANGE);
    refused(with([](latent_job& j) { j.batch = 65537; }), LATENT_OUT_OF_RANGE);
    refused(with([](latent_job& j) { j.aspect_width = 0; }), LATENT_OUT_OF_RANGE);
    refused(with([](latent_job& j) { j.precision = 256 + 9; }), LATENT_OUT_OF_RANGE);
    refused(with([](latent_job& j) { j.run_samples = 1000; }), LATENT_OUT_OF_RANGE);
    refused(with([](latent_job& j) { j.light_unit = -1; }), LATENT_OUT_OF_RANGE);
    refused(with([](latent_job& j) { j.sampler = 257; }), LATENT_UNSUPPORTED);
    refused(with([](latent_job& j) { j.extra_count = 1, j.extra = nullptr; }), LATENT_USAGE);
    refused(with([](latent_job& j) { j.knot_count = 2, j.knots = nullptr; }), LATENT_USAGE);
    const auto how = [&](auto change) {
        latent_write_options bad = options;
        change(bad);
        return open(path.c_str(), &good.c, &bad);
    };
    refused(how([](latent_write_options& o) { o.samples = {5, 5}; }), LATENT_USAGE);
    refused(how([](latent_write_options& o) { o.samples = {6, 5}; }), LATENT_USAGE);
    refused(how([](latent_write_options& o) { o.checkpoint_seconds = -1; }), LATENT_OUT_OF_RANGE);
    refused(how([](latent_write_options& o) { o.provenance = "[1]"; }), LATENT_OUT_OF_RANGE);
    EXPECT_TRUE(folder.names().empty());

    ASSERT_EQ(latent_writer_open(path.c_str(), &good.c, &options, &writer, &error), LATENT_OK) << error.message;
    const Writer closer(writer);
    const Records made = synthetic::make_records(job, {0, 1024});
    const CRecords records(made);
    const auto submit = [&](latent_range grain, auto change) {
        latent_records bad = records.c;
        change(bad);
        return latent_writer_submit(writer, grain, &bad, &error);
    };
    const auto same = [](latent_records&) {};
    refused(latent_writer_submit(nullptr, {0, 1024}, &records.c, &error), LATENT_USAGE);
    refused(latent_writer_submit(writer, {0, 1024}, nullptr, &error), LATENT_USAGE);
    refused(submit({0, 1000}, same), LATENT_OUT_OF_RANGE);
    refused(submit({1024, 0}, same), LATENT_OUT_OF_RANGE);
    refused(submit({kSamples + 1000, kSamples + 2000}, same), LATENT_OUT_OF_RANGE);
    refused(submit({1024, 2048}, same), LATENT_OUT_OF_RANGE);  // records of other samples
    refused(submit({0, 1024}, [](latent_records& r) { r.size -= 8; }), LATENT_USAGE);
    refused(submit({0, 1024}, [](latent_records& r) { r.y = nullptr; }), LATENT_USAGE);
    refused(submit({0, 1024}, [](latent_records& r) { r.sample = nullptr; }), LATENT_USAGE);
    refused(latent_writer_finish(writer, &error), LATENT_USAGE);
    EXPECT_EQ(submit({0, 1024}, same), LATENT_OK) << error.message;  // the grain is still wanted
    refused(submit({0, 1024}, same), LATENT_OUT_OF_RANGE);           // and now it is not
    latent_range grain;
    ASSERT_EQ(latent_writer_next(writer, &grain), 1);
    while (latent_writer_next(writer, &grain) != 0) {
        const Records rest = synthetic::make_records(job, {grain.first, grain.end});
        const CRecords given(rest);
        ASSERT_EQ(latent_writer_submit(writer, grain, &given.c, &error), LATENT_OK) << error.message;
    }
    ASSERT_EQ(latent_writer_finish(writer, &error), LATENT_OK) << error.message;
    refused(latent_writer_finish(writer, &error), LATENT_USAGE);
    refused(submit({0, 1024}, same), LATENT_USAGE);
    EXPECT_EQ(latent_writer_next(nullptr, &grain), 0);
    EXPECT_EQ(latent_writer_missing(nullptr, nullptr, 0), 0u);
    refused(latent_writer_checkpoint(nullptr, &error), LATENT_USAGE);
    refused(latent_writer_get_info(writer, nullptr, &error), LATENT_USAGE);
    latent_writer_stop(nullptr);
    latent_writer_close(nullptr);

    latent_reader* reader = nullptr;
    const char* names[] = {path.c_str(), nullptr};
    refused(latent_reader_open(nullptr, 1, nullptr, &reader, &error), LATENT_USAGE);
    refused(latent_reader_open(names, 2, nullptr, &reader, &error), LATENT_USAGE);
    refused(latent_reader_open(names, 1, nullptr, nullptr, &error), LATENT_USAGE);
    const std::string absent = folder / "absent.latent";
    const char* absent_names[] = {absent.c_str()};
    refused(latent_reader_open(absent_names, 1, nullptr, &reader, &error), LATENT_NOT_FOUND);
    const Reader read = open_reader(path);
    latent_run run{};
    refused(latent_reader_run(read.get(), 0, &run, &error), LATENT_USAGE);  // no size
    run.size = sizeof run;
    refused(latent_reader_run(read.get(), 99, &run, &error), LATENT_OUT_OF_RANGE);
    latent_cursor* cursor = nullptr;
    latent_selection selection{};
    selection.size = sizeof selection;
    selection.u0 = 0.5, selection.u1 = 0.4, selection.v1 = 1;
    refused(latent_cursor_open(read.get(), &selection, &cursor, &error), LATENT_OUT_OF_RANGE);
    refused(latent_cursor_open(nullptr, nullptr, &cursor, &error), LATENT_USAGE);
    refused(latent_cursor_next(nullptr, nullptr, &error), LATENT_USAGE);
    EXPECT_EQ(latent_reader_left_out(read.get(), 0), nullptr);
}

TEST(CApi, AReaderTellsHowItsSamplesWereMade) {
    const TemporaryFolder folder;
    const Job job = synthetic::make_short_job();
    const CJob c_job(job);
    latent_write_options options = options_for(2048);
    options.provenance = R"({"light_groups": [{"name": "lamp"}, {}], "materials": ["glass", 7]})";
    latent_writer* writer = nullptr;
    ASSERT_EQ(latent_writer_open((folder / "a.latent").c_str(), &c_job.c, &options, &writer, nullptr), LATENT_OK);
    write_all(writer, job, 1);
    latent_writer_close(writer);
    const Reader reader = open_reader(folder / "a.latent");
    const char* json = nullptr;
    ASSERT_EQ(latent_reader_provenance(reader.get(), &json, nullptr), LATENT_OK);
    EXPECT_EQ(std::string(json), R"({"parts":[{"provenance":)" + std::string(options.provenance) + R"(,"samples":[[0,2048]]}]})");
    EXPECT_STREQ(latent_reader_light_group(reader.get(), 0), "lamp");
    EXPECT_STREQ(latent_reader_light_group(reader.get(), 1), "");
    EXPECT_EQ(latent_reader_light_group(reader.get(), 2), nullptr);
    EXPECT_EQ(latent_reader_material(reader.get(), 0), nullptr);
    EXPECT_STREQ(latent_reader_material(reader.get(), 1), "glass");
    EXPECT_STREQ(latent_reader_material(reader.get(), 2), "");
    EXPECT_EQ(latent_reader_material(reader.get(), 3), nullptr);
}

// Handles that are null, made up, closed, or of what failed to open: every function answers.
TEST(CApi, FunctionsOnHandlesThatAreNotOpenEndInAStatus) {
    const TemporaryFolder folder;
    const std::string path = folder / "a.latent";
    const Job job = synthetic::make_short_job();
    const CJob c_job(job);
    const Records made = synthetic::make_records(job, {0, 1024});
    const CRecords records(made);
    const latent_write_options options = options_for(1024);
    latent_error error{};
    std::vector<latent_writer*> writers = {nullptr, reinterpret_cast<latent_writer*>(std::uintptr_t{0xDEADBEEF0})};
    latent_writer* writer = reinterpret_cast<latent_writer*>(&error);
    ASSERT_EQ(latent_writer_open((folder / "none" / "a.latent").c_str(), &c_job.c, &options, &writer, nullptr), LATENT_NOT_FOUND);
    writers.push_back(writer);
    ASSERT_EQ(latent_writer_open(path.c_str(), &c_job.c, &options, &writer, nullptr), LATENT_OK);
    ASSERT_EQ(latent_writer_submit(writer, {0, 1024}, &records.c, nullptr), LATENT_OK);
    ASSERT_EQ(latent_writer_finish(writer, nullptr), LATENT_OK);
    latent_writer_close(writer);
    writers.push_back(writer);
    const auto refused = [&](latent_status status) {
        EXPECT_EQ(status, LATENT_USAGE);
        EXPECT_GT(std::strlen(error.message), 5u);
        error = {};
    };
    for (latent_writer* const gone : writers) {
        latent_range grain{7, 7};
        latent_writer_info info{};
        info.size = sizeof info;
        EXPECT_EQ(latent_writer_missing(gone, &grain, 1), 0u);
        EXPECT_EQ(latent_writer_next(gone, &grain), 0);
        refused(latent_writer_submit(gone, {0, 1024}, &records.c, &error));
        refused(latent_writer_checkpoint(gone, &error));
        refused(latent_writer_finish(gone, &error));
        refused(latent_writer_get_info(gone, &info, &error));
        latent_writer_stop(gone);
        latent_writer_close(gone);
    }

    std::vector<latent_reader*> readers = {nullptr, reinterpret_cast<latent_reader*>(writers.back())};
    latent_reader* reader = nullptr;
    const std::string absent = folder / "absent.latent";
    const char* const names[] = {path.c_str(), absent.c_str()};
    ASSERT_EQ(latent_reader_open(&names[1], 1, nullptr, &reader, nullptr), LATENT_NOT_FOUND);
    readers.push_back(reader);
    ASSERT_EQ(latent_reader_open(names, 1, nullptr, &reader, nullptr), LATENT_OK);
    latent_cursor* cursor = nullptr;
    ASSERT_EQ(latent_cursor_open(reader, nullptr, &cursor, nullptr), LATENT_OK);
    latent_reader_close(reader);
    readers.push_back(reader);
    latent_records read{};
    read.size = sizeof read;
    ASSERT_EQ(latent_cursor_next(cursor, &read, nullptr), LATENT_OK);  // outlives its reader
    EXPECT_GT(read.count, 0u);
    latent_cursor_close(cursor);
    refused(latent_cursor_next(cursor, &read, &error));
    latent_cursor_close(cursor);
    refused(latent_cursor_next(reinterpret_cast<latent_cursor*>(reader), &read, &error));
    for (latent_reader* const gone : readers) {
        latent_job its_job{};
        its_job.size = sizeof its_job;
        latent_reader_info info{};
        info.size = sizeof info;
        latent_run run{};
        run.size = sizeof run;
        latent_range range{};
        refused(latent_reader_job(gone, &its_job, &error));
        refused(latent_reader_get_info(gone, &info, &error));
        refused(latent_reader_run(gone, 0, &run, &error));
        refused(latent_cursor_open(gone, nullptr, &cursor, &error));
        EXPECT_EQ(cursor, nullptr);
        EXPECT_EQ(latent_reader_coverage(gone, &range, 1), 0u);
        EXPECT_EQ(latent_reader_left_out(gone, 0), nullptr);
        const char* json = "";
        refused(latent_reader_provenance(gone, &json, &error));
        EXPECT_EQ(json, nullptr);
        EXPECT_EQ(latent_reader_light_group(gone, 0), nullptr);
        EXPECT_EQ(latent_reader_material(gone, 1), nullptr);
        latent_reader_close(gone);
    }
}

TEST(CApi, ClosingAWriterEndsTheCallsOfOtherThreads) {
    const TemporaryFolder folder;
    const Job job = synthetic::make_short_job();
    const CJob c_job(job);
    for (int i = 0; i < 10; ++i) {
        const latent_write_options options = options_for(std::uint64_t{1} << 22);
        latent_writer* writer = nullptr;
        ASSERT_EQ(latent_writer_open((folder / "a.latent").c_str(), &c_job.c, &options, &writer, nullptr), LATENT_OK);
        latent_range first;
        ASSERT_EQ(latent_writer_next(writer, &first), 1);  // never submitted: in the end, all wait for it
        std::atomic<int> submitted = 0;
        std::vector<std::thread> threads;
        for (int t = 0; t < 3; ++t) {
            threads.emplace_back([&, writer] {
                latent_range grain;
                while (latent_writer_next(writer, &grain) != 0) {
                    const Records made = synthetic::make_records(job, {grain.first, grain.end});
                    const CRecords records(made);
                    if (latent_writer_submit(writer, grain, &records.c, nullptr) != LATENT_OK) return;
                    ++submitted;
                }
            });
        }
        while (submitted < 10 * i) std::this_thread::yield();
        latent_writer_close(writer);
        for (std::thread& thread : threads) thread.join();
    }
}

// Shares, jobs, and words of messages.
TEST(CApi, WhatIsNotFiniteOrOfAnotherJobIsRefusedInWordsOfC) {
    const TemporaryFolder folder;
    Job job = synthetic::make_short_job();
    for (const char* name : {"a.latent", "b.latent"}) {
        ++job.id.low;
        write_all(open_writer(folder / name, CJob(job), 2048).get(), job, 1);
    }
    const std::string whole = folder / ".";
    const char* const paths[] = {whole.c_str()};
    latent_reader* reader = nullptr;
    latent_error error{};
    EXPECT_EQ(latent_reader_open(paths, 1, nullptr, &reader, &error), LATENT_MISMATCH);
    EXPECT_NE(std::strstr(error.message, "; choose one with options.job_low and job_high"), nullptr) << error.message;
    latent_read_options one{};
    one.size = sizeof one;
    one.job_low = job.id.low, one.job_high = job.id.high;
    ASSERT_EQ(latent_reader_open(paths, 1, &one, &reader, &error), LATENT_OK) << error.message;
    const Reader closer(reader);
    latent_job read{};
    read.size = sizeof read;
    ASSERT_EQ(latent_reader_job(reader, &read, &error), LATENT_OK);
    EXPECT_EQ(read.id_low, job.id.low);
    // As programs have it that were compiled before there were jobs to choose from.
    one.size = offsetof(latent_read_options, job_low);
    EXPECT_EQ(latent_reader_open(paths, 1, &one, &reader, &error), LATENT_MISMATCH);

    const Writer writer = open_writer(folder / "c.latent", CJob(job), 1024);
    for (const float bad : {std::nanf(""), INFINITY, -INFINITY}) {
        Records made = synthetic::make_records(job, {0, 1024});
        made.share[5] = bad;
        const CRecords records(made);
        EXPECT_EQ(latent_writer_submit(writer.get(), {0, 1024}, &records.c, &error), LATENT_OUT_OF_RANGE);
        EXPECT_EQ(std::string(error.message), "sample " + std::to_string(made.sample[5]) + ": a share that is not finite");
    }
    Job stored = synthetic::make_job(sampledb::RecordKind::kSpectral);
    stored.density = {};
    const Writer of_wavelengths = open_writer(folder / "w.latent", CJob(stored), 1024);
    for (const float bad : {std::nanf(""), INFINITY, 0.0F, -550.0F}) {
        Records made = synthetic::make_records(stored, {0, 1024});
        made.lambda_nm[5] = bad;
        const CRecords records(made);
        EXPECT_EQ(latent_writer_submit(of_wavelengths.get(), {0, 1024}, &records.c, &error), LATENT_OUT_OF_RANGE);
    }
    // Names of any bytes and length: one line of UTF-8, cut between characters.
    for (const std::string& name : {std::string("\xff\n\x1b[2J"), "x" + std::string(1500, '\xc3'), [] {
                                        std::string text = "y";
                                        for (int i = 0; i < 700; ++i) text += "\u00e9";
                                        return text;
                                    }()}) {
        const char* const bad[] = {name.c_str()};
        EXPECT_NE(latent_reader_open(bad, 1, nullptr, &reader, &error), LATENT_OK);
        const std::string message = error.message;
        EXPECT_EQ(printable_line(message), message);
    }
}

TEST(CApi, StructsOfANewerHeaderAreTakenIfTheirNewFieldsAreZero) {
    const TemporaryFolder folder;
    const CJob good(synthetic::make_short_job());
    struct {
        latent_job job;
        std::uint64_t added;
    } newer{good.c, 0};
    newer.job.size = sizeof newer;
    const latent_write_options options = options_for(kSamples);
    latent_writer* writer = nullptr;
    EXPECT_EQ(latent_writer_open((folder / "a.latent").c_str(), &newer.job, &options, &writer, nullptr), LATENT_OK);
    latent_writer_close(writer);
    newer.added = 1;
    EXPECT_EQ(latent_writer_open((folder / "b.latent").c_str(), &newer.job, &options, &writer, nullptr), LATENT_UNSUPPORTED);
}

TEST(CExamples, WriteAFileThatEveryToolAcceptsAndReadItBack) {
    const TemporaryFolder folder;
    const std::string a = folder / "a.latent", merged = folder / "m.latent", picture = folder / "m.exr";
    ASSERT_EQ(run({tool("example_write"), a, "20000"}).status, 0);
    const Outcome verified = run({tool("latent-inspect"), "verify", "--deep", "--strict", a});
    EXPECT_EQ(verified.status, 0) << verified.out << verified.err;
    EXPECT_EQ(run({tool("latent-merge"), a, "-o", merged}).status, 0);
    const Outcome developed = run({tool("latent-develop"), merged, "--size", "48", "-o", picture});
    EXPECT_EQ(developed.status, 0) << developed.err;
    const Outcome read = run({tool("example_read"), merged});
    EXPECT_EQ(read.status, 0) << read.err;
    EXPECT_NE(read.out.find("20000 samples"), std::string::npos) << read.out;
    EXPECT_NE(read.out.find("20000 records, mean power"), std::string::npos) << read.out;
    EXPECT_EQ(run({tool("example_read"), a, "--records"}).out, run({tool("example_read"), merged, "--records"}).out);
}

// Killed as soon as a checkpoint is on disk: that stays, and the part ends as if nothing had happened.
TEST(CExamples, AKilledWriterResumesAndTheRecordsAreTheSame) {
    const TemporaryFolder folder;
    const std::string killed = folder / "a.latent", whole = folder / "b.latent";
    const std::vector<std::string> command = {tool("example_write"), killed, "2000000", "7", "0.02"};
    RunSetOptions options;
    options.inputs = {killed};
    const auto committed = [&]() -> std::uint64_t {
        const auto run_set = RunSet::open(options);
        return run_set ? (*run_set)->coverage().size() : 0;
    };
    std::uint64_t seen = 0;
    {
        Child child(command);
        while (seen == 0) seen = committed();
        child.kill_now();
        child.wait();
    }
    const std::uint64_t survived = committed();
    EXPECT_GE(survived, seen);
    EXPECT_LT(survived, 2000000u);
    ASSERT_EQ(run(command).status, 0);
    ASSERT_EQ(run({tool("example_write"), whole, "2000000", "7"}).status, 0);
    EXPECT_EQ(synthetic::runs_of(killed), synthetic::runs_of(whole));
}

// Runs the example with a checkpoint interval until `enough(samples submitted, samples on disk)`, kills it `pause` later, and
// returns the most that one thread had rendered of what is lost, in seconds. Left out are the first of a thread's lost grains, part
// of which it may have rendered before the checkpoint began, and the three that took longest: while rendering waits for a late
// disk, grains in progress are finished.
double seconds_lost_to_a_kill(const std::string& interval, std::chrono::milliseconds pause,
                              const std::function<bool(std::uint64_t, std::uint64_t)>& enough) {
    const TemporaryFolder folder;
    const std::string part = folder / "a.latent", log = folder / "log";
    RunSetOptions options;
    options.inputs = {part};
    const auto on_disk = [&] {
        const auto run_set = RunSet::open(options);
        return run_set ? (*run_set)->coverage() : Coverage();
    };
    {
        Child child({tool("example_write"), part, "100000000", "7", interval}, {{"LD_PRELOAD", tool("liblatent_submit_shim.so")},
                                                                                {"LATENT_TEST_SUBMITTED", log},
                                                                                {"ASAN_OPTIONS", "verify_asan_link_order=0"}});
        const auto submitted = [&] { return fs::exists(log) ? fs::file_size(log) / sizeof(SubmittedGrain) * LATENT_GRAIN : 0; };
        while (!enough(submitted(), on_disk().size())) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        std::this_thread::sleep_for(pause);
        child.kill_now();
        child.wait();
    }
    const Coverage survived = on_disk();
    const std::string notes = read_text(log);
    std::map<std::uint64_t, std::vector<std::int64_t>> lost;  // nanoseconds of each grain, by thread
    for (std::size_t at = 0; at + sizeof(SubmittedGrain) <= notes.size(); at += sizeof(SubmittedGrain)) {
        SubmittedGrain grain{};
        std::memcpy(&grain, &notes[at], sizeof grain);
        if (!survived.contains(SampleRange{grain.first, grain.end})) lost[grain.thread].push_back(grain.nanoseconds);
    }
    double most = 0;
    for (auto& [thread, times] : lost) {
        times.erase(times.begin());
        std::sort(times.begin(), times.end(), std::greater<>());
        times.erase(times.begin(), times.begin() + std::min<std::ptrdiff_t>(3, std::ssize(times)));
        most = std::max(most, 1e-9 * static_cast<double>(std::accumulate(times.begin(), times.end(), std::int64_t{0})));
    }
    return most;
}

TEST(CExamples, AKillCostsAtMostOneCheckpointIntervalOfRendering) {
    constexpr double kInterval = 0.03;
    double most = 0;
    for (const int milliseconds : {0, 10, 17, 25, 40}) {
        SCOPED_TRACE(milliseconds);
        const double lost = seconds_lost_to_a_kill(std::to_string(kInterval), std::chrono::milliseconds(milliseconds),
                                                   [](std::uint64_t, std::uint64_t on_disk) { return on_disk > 0; });
        EXPECT_LE(lost, kInterval);
        most = std::max(most, lost);
    }
    EXPECT_GT(most, 0);
    // Where no checkpoint comes, more than that is lost.
    const auto nearly_a_run = [](std::uint64_t submitted, std::uint64_t) { return submitted > 900000; };
    EXPECT_GT(seconds_lost_to_a_kill("1000", std::chrono::milliseconds(0), nearly_a_run), kInterval);
}

}  // namespace
}  // namespace latent::sampledb
