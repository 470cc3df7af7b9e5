// bench/sampledb_bench.cpp: records to bytes and back, one thread: records per second, bytes per record of each column. Every
// result is checked.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <map>
#include <memory>

#include "sampledb/codec/page_decoder.h"
#include "sampledb/codec/run_codec.h"
#include "tests/support/synthetic.h"

namespace latent::sampledb {
namespace {

void print_sizes(const std::string& name, std::uint64_t records, std::uint64_t bytes,
                 const std::map<std::string, std::uint64_t>& columns) {
    const auto each = [records](std::uint64_t size) { return static_cast<double>(size) / static_cast<double>(records); };
    fmt::print("{}: {} records, {:.2f} B each:", name, records, each(bytes));
    for (const auto& [column, size] : columns) fmt::print(" {} {:.2f}", column, each(size));
    fmt::print("\n");
}

struct Input {
    Job job;
    SampleRange range;
    Records records;
    Bytes run;
    RunHeader header;
    RunIndex index;
};

struct Form {
    const char* name;
    PositionSamplerSpec positions;
};
const Form kForms[] = {{"positions of Halton", {PositionSampler::kHalton23, 0x12345678, 0x9ABCDEF0}},
                       {"explicit positions", {}},
                       {"positions by pixels of 960 x 640", synthetic::pixels_of(960, 640)},
                       {"positions by pixels of 9600 x 6400", synthetic::pixels_of(9600, 6400)}};
constexpr int kFormCount = static_cast<int>(std::size(kForms));

// One run as the renderer would make it: default S, 5 % light records.
Input make_input(RecordKind kind, const Form& form) {
    Input input;
    input.job = synthetic::make_job(kind);
    const std::uint64_t bytes = synthetic::make_records(input.job, {0, 1}).raw_bytes();
    input.job.run_samples = default_run_samples(bytes);
    input.range = {0, input.job.run_samples};
    const Job emitting = input.job;  // Halton's positions, where the file may not leave them out
    input.job.positions = form.positions;
    input.records = synthetic::make_records(form.positions.sampler == PositionSampler::kNone ? emitting : input.job, input.range,
                                            {.black = 0.05, .light_per_sample = 0.05});
    input.run = *encode_run(input.job, Coverage(input.range), input.records);
    input.header = *decode_run_header(input.run);
    input.index = *decode_run_index(ByteSpan(input.run).subspan(input.header.index_offset()), input.header, input.job);
    std::map<std::string, std::uint64_t> columns;
    for (const PageInfo& info : input.index.pages) {
        const auto stored = stored_columns(input.job, info, ByteSpan(input.run).subspan(info.offset, info.stored_size));
        for (const StoredColumn& column : *stored) columns[column.name] += column.stored;
    }
    print_sizes(fmt::format("{}, {}", kind == RecordKind::kXyz ? "XYZ" : "spectral", form.name), input.records.size(),
                input.run.size(), columns);
    return input;
}

const Input& input_of(const benchmark::State& state) {
    static const std::vector<Input> inputs = [] {
        std::vector<Input> all;
        for (const RecordKind kind : {RecordKind::kXyz, RecordKind::kSpectral}) {
            for (const Form& form : kForms) all.push_back(make_input(kind, form));
        }
        return all;
    }();
    return inputs[static_cast<std::size_t>(state.range(0))];
}

void count(benchmark::State& state, const Input& input) {
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * static_cast<std::int64_t>(input.records.size()));
    state.counters["B/record"] = static_cast<double>(input.run.size()) / static_cast<double>(input.records.size());
}

void encode(benchmark::State& state) {
    const Input& input = input_of(state);
    const std::shared_ptr<const Records> records(std::shared_ptr<const Records>(), &input.records);  // not owned
    RunBuilder builder;
    Bytes run;
    for (auto _ : state) run = *builder.build(input.job, Coverage(input.range), {records}, std::move(run));
    if (run != input.run) state.SkipWithError("another run");
    count(state, input);
}

void decode(benchmark::State& state) {
    const Input& input = input_of(state);
    PageDecoder decoder;
    Page page;
    for (auto _ : state) {
        std::size_t records = 0;
        for (const PageInfo& info : input.index.pages) {
            if (!decoder.decode(input.job, info, ByteSpan(input.run).subspan(info.offset, info.stored_size), ColumnSet{}, page))
                state.SkipWithError("unreadable");
            records += page.count;
        }
        if (records != input.records.size()) state.SkipWithError("records are missing");
    }
    count(state, input);
}

BENCHMARK(encode)->ArgName("form")->DenseRange(0, 2 * kFormCount - 1)->Unit(benchmark::kMillisecond);
BENCHMARK(decode)->ArgName("form")->DenseRange(0, 2 * kFormCount - 1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace latent::sampledb

BENCHMARK_MAIN();
