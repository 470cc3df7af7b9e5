// Whole .latent files, as the tools read them.
#include "sampledb/read/file_reader.h"
#include "sampledb/read/part_name.h"
#include "sampledb/read/record_cursor.h"
#include "sampledb/write/part_writer.h"
#include "tests/fuzz/mend.h"
#include "tests/fuzz/target.h"
#include "tests/support/synthetic.h"
#include "tools/develop/picture/picture.h"
#include "tools/develop/picture/pixel_array.h"
#include "tools/merge/merge.h"

namespace latent::fuzz {

using namespace sampledb;

namespace {

constexpr std::size_t kMaxRuns = 8;  // that are looked at closely: an input may have thousands of empty ones

bool run_file(ByteSpan bytes) {
    bool sound = false;
    const MemorySource source(bytes);
    for (const bool use_footer : {true, false}) {
        const Result<FileContents> file = read_file(source, VerifyLevel::kFull, use_footer);
        if (!file) continue;
        sound |= file->damage.empty();
        (void)read_file(source, VerifyLevel::kQuick, use_footer);
        PageDecoder decoder;
        Page page;
        for (std::size_t i = 0; i < std::min(file->runs.size(), kMaxRuns); ++i) {
            const Result<RunIndex> index = read_run_index(source, file->runs[i], file->header.job);
            require(index.has_value(), "the index of a verified run can be read");
            for (const PageInfo& info : index->pages) {
                require(static_cast<bool>(read_page(source, info, file->header.job, {}, decoder, page)),
                        "a page of a verified run can be read");
            }
        }
    }
    return sound;
}

std::vector<Job> jobs() {
    Job xyz = synthetic::make_short_job(), spectral = synthetic::make_short_job(RecordKind::kSpectral), other = spectral;
    other.density = {};
    other.positions = {};
    other.extra = {{"depth", ColumnType::kF32}, {"light_group", ColumnType::kU8}};
    return {xyz, spectral, other};
}

std::vector<Bytes> file_seeds() {
    std::vector<Bytes> seeds;
    for (const Job& job : jobs()) {
        for (const bool footer : {true, false}) {
            Coverage gaps(SampleRange{4096, 4160});
            gaps.add({4200, 4220});
            const std::vector<Coverage> runs = {Coverage(SampleRange{0, 40}), gaps};
            seeds.push_back(synthetic::make_file(job, runs, footer, {.light_per_sample = 0.4, .split_shares = true}).bytes);
        }
    }
    return seeds;
}

// An attempt is read, developed, merged, and resumed.
bool run_part(ByteSpan bytes) {
    const std::filesystem::path path = as_file("a.latent.part.0123456789abcdef", bytes), name = path.parent_path() / "a.latent";
    RunSetOptions wanted;
    wanted.inputs = {path};
    const auto run_set = RunSet::open(wanted);
    if (!run_set) return false;
    RecordCursor cursor(**run_set, {});
    Page page;
    for (int damaged = 0; damaged < 64;) {
        const Result<bool> more = cursor.next(page);
        if (more && !*more) break;
        if (!more) ++damaged;
    }

    develop::PictureOptions picture;
    picture.inputs = {path};
    picture.size = "24";
    if (bytes.size() % 4 < 2) picture.filter = "box";  // a quarter of the time is in tables of the other
    picture.layers = {true, true, true, true};
    picture.memory = std::uint64_t{32} << 20;
    picture.threads = 1;
    develop::PixelArray pixels;
    const bool developed = develop::develop_picture(picture, pixels, {}).has_value();

    merge::MergeOptions merging;
    merging.inputs = {path};
    merging.output = path.parent_path() / "merged.latent";
    merging.replace = true;
    merging.threads = 1;
    merging.compact = bytes.size() % 2 == 0;
    (void)merge::merge(merging);

    PartOptions part;
    part.path = name;
    part.range = {0, 8192};
    if (const auto writer = PartWriter::open(part, (*run_set)->job()); writer) (void)(*writer)->missing();
    (void)remove_everything(name);
    return developed;
}

}  // namespace

Target file() { return {"file", run_file, mend_file, false, 4000, file_seeds}; }
Target part() { return {"part", run_part, mend_file, false, 250, file_seeds}; }

}  // namespace latent::fuzz
