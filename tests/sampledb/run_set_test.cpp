// What a tool sees of the files that it was given: docs/format.md, "Selection".
#include "sampledb/read/run_set.h"

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <thread>

#include "sampledb/codec/page_decoder.h"
#include "tests/faults/process.h"
#include "tests/support/synthetic.h"

namespace latent::sampledb {
namespace {

namespace fs = std::filesystem;
using synthetic::make_job;

class RunSetTest : public ::testing::Test {
 protected:
    latent::testing::TemporaryFolder folder_;

    // A part of two runs that begins at run `index` of S samples (the synthetic job's, made short).
    fs::path part(const std::string& name, std::uint64_t index, bool footer = true, std::uint64_t job = 1) {
        const Job j = make_job(RecordKind::kXyz, job);
        const std::uint64_t first = index * j.run_samples;
        return file(name, j, {Coverage(SampleRange{first, first + 1000}), Coverage(SampleRange{first + 1000, first + 2000})},
                    footer);
    }
    fs::path file(const std::string& name, const Job& job, const std::vector<Coverage>& runs, bool footer = true,
                  const synthetic::Scene& scene = {}) {
        synthetic::write_file(folder_ / name, synthetic::make_file(job, runs, footer, scene).bytes);
        return folder_ / name;
    }
    fs::path text(const std::string& name, const std::string& content) {
        std::ofstream(folder_ / name) << content;
        return folder_ / name;
    }
    void cut(const fs::path& path, std::uint64_t bytes_less) { fs::resize_file(path, fs::file_size(path) - bytes_less); }

    static Result<std::unique_ptr<RunSet>> open(std::vector<fs::path> inputs, bool skip_duplicates = false) {
        RunSetOptions options;
        options.inputs = std::move(inputs);
        options.skip_duplicates = skip_duplicates;
        return RunSet::open(options);
    }
    static std::string message(const Result<std::unique_ptr<RunSet>>& run_set) { return run_set ? "" : run_set.error().message; }
};

bool mentions(const std::string& text, const std::string& what) { return text.find(what) != std::string::npos; }

TEST_F(RunSetTest, PartsAddUp) {
    const auto g = open({part("b.latent", 3), part("a.latent", 0)});
    ASSERT_TRUE(g) << message(g);
    EXPECT_EQ((*g)->coverage().size(), 4000u);
    EXPECT_EQ((*g)->light_paths(), 4000u);
    ASSERT_EQ((*g)->runs().size(), 4u);
    EXPECT_EQ((*g)->runs()[0].header.samples.first, 0u);
    EXPECT_EQ((*g)->runs()[3].header.samples.end, 3u * (1u << 14) + 2000);
    EXPECT_TRUE((*g)->report().left_out.empty());
}

TEST_F(RunSetTest, WhatShouldNotBeThereIsRefusedByName) {
    const fs::path a = part("a.latent", 0);
    const auto twice = open({a, a});
    ASSERT_FALSE(twice);
    EXPECT_TRUE(mentions(message(twice), "a.latent and ")) << message(twice);
    const fs::path overlapping = part("overlap.latent", 0);
    EXPECT_TRUE(mentions(message(open({a, overlapping})), "both hold samples 0:")) << message(open({a, overlapping}));

    const fs::path other = part("other.latent", 5, true, 2);
    EXPECT_TRUE(mentions(message(open({a, other})), "different jobs"));
    EXPECT_TRUE(mentions(message(open({a, other})), "other.latent"));
    Job film = make_job(RecordKind::kXyz);
    film.aspect_width = 5;
    const fs::path wide = file("wide.latent", film, {Coverage(SampleRange{1u << 14, (1u << 14) + 100})});
    EXPECT_TRUE(mentions(message(open({a, wide})), "the film aspect differs"));

    const fs::path words = text("words.txt", "These are not samples.\n");
    const auto foreign = open({a, words});
    ASSERT_FALSE(foreign);
    EXPECT_EQ(foreign.error().code, ErrorCode::kForeign);
    EXPECT_TRUE(mentions(message(foreign), "words.txt"));
    EXPECT_EQ(open({a, "/dev/null"}).error().code, ErrorCode::kForeign);
    EXPECT_EQ(open({a, folder_ / "nowhere.latent"}).error().code, ErrorCode::kNotFound);
    EXPECT_EQ(open({}).error().code, ErrorCode::kNotFound);
}

TEST_F(RunSetTest, SkipDuplicatesKeepsOneOfEach) {
    const fs::path a = part("a.latent", 0);
    const auto g = open({a, a, part("b.latent", 0)}, true);
    ASSERT_TRUE(g) << message(g);
    EXPECT_EQ((*g)->coverage().size(), 2000u);
    EXPECT_EQ((*g)->report().repeated_runs, 4u);
    EXPECT_TRUE((*g)->report().left_out.empty());
}

TEST_F(RunSetTest, AFolderGivesItsGoodRunsAndAListOfTheRest) {
    part("a.latent", 0);
    part("copy.latent", 0);
    part("b.latent", 3);
    text("words.latent", "These are not samples.\n");
    text("notes.txt", "These neither.\n");
    text(".hidden", "What other programs keep for themselves.\n");
    ASSERT_EQ(::mkfifo((folder_ / "pipe").c_str(), 0600), 0);  // nobody writes to it: opening it could wait for ever
    fs::create_directories(folder_ / "more");
    part("more/d.latent", 9);
    fs::create_symlink("nowhere", folder_ / "link.latent");
    fs::create_symlink("loop.latent", folder_ / "loop.latent");
    text("empty.latent", "");
    cut(part("c.latent", 6), 5000);
    const auto g = open({folder_.path()});
    ASSERT_TRUE(g) << message(g);
    EXPECT_EQ((*g)->coverage().size(), 5000u);
    EXPECT_EQ((*g)->report().repeated_runs, 2u);
    std::map<std::string, std::string> left_out;
    for (const LeftOut& left : (*g)->report().left_out) left_out[fs::path(left.place).filename().string()] = left.reason;
    EXPECT_EQ(left_out.size(), (*g)->report().left_out.size());
    EXPECT_TRUE(left_out["c.latent"].starts_with("truncated or damaged at its end: ")) << left_out["c.latent"];
    EXPECT_EQ(left_out["empty.latent"], "empty, not a Latent file");
    for (const char* name : {"link.latent", "loop.latent", "words.latent"}) EXPECT_TRUE(left_out.contains(name)) << name;
    EXPECT_EQ(left_out.size(), 5u);
    const std::string at = folder_.path().string() + "/";  // by their names already, these are no sample files
    EXPECT_THAT((*g)->report().notes,
                ::testing::IsSupersetOf({at + "more: a folder inside a folder is not searched, skipped",
                                         at + "notes.txt: not a Latent file, skipped", at + "pipe: not a regular file, skipped"}));
}

TEST_F(RunSetTest, ToKeepGoingIsToLeaveOutWhatWasNamedAndCannotBeUsed) {
    const fs::path a = part("a.latent", 0), again = part("again.latent", 0), b = part("b.latent", 3);
    const fs::path notes = text("notes.txt", "These are not samples.\n"), missing = folder_ / "missing.latent";
    RunSetOptions options;
    options.inputs = {a, again, notes, missing, b};
    for (const fs::path& refused : {again, notes, missing}) {
        options.inputs = {a, refused, b};
        EXPECT_FALSE(RunSet::open(options)) << refused;
    }
    options.inputs = {a, again, notes, missing, b};
    options.keep_going = true;
    const auto g = RunSet::open(options);
    ASSERT_TRUE(g) << message(g);
    EXPECT_EQ((*g)->coverage().size(), (*open({a}))->coverage().size() + (*open({b}))->coverage().size());
    std::vector<std::string> left_out;
    for (const LeftOut& left : (*g)->report().left_out) left_out.push_back(left.place + ": " + left.reason);
    EXPECT_THAT(left_out, ::testing::ElementsAre(notes.string() + ": not a Latent file", missing.string() + ": no such file"));
}

TEST_F(RunSetTest, AGlobIsAFolderByAnotherName) {
    part("a1.latent", 0);
    part("a2.latent", 0);
    part("b.latent", 3);
    const auto g = open({folder_ / "a*.latent"});
    ASSERT_TRUE(g) << message(g);
    EXPECT_EQ((*g)->coverage().size(), 2000u);
    EXPECT_EQ((*g)->report().repeated_runs, 2u);
}

TEST_F(RunSetTest, ATruncatedPartYieldsItsGoodRuns) {
    const fs::path a = part("a.latent", 0), b = part("b.latent", 3);
    cut(b, 5000);
    const auto g = open({a, b});
    ASSERT_TRUE(g) << message(g);
    EXPECT_EQ((*g)->coverage().size(), 3000u);
    ASSERT_EQ((*g)->report().left_out.size(), 1u);
    EXPECT_TRUE(mentions((*g)->report().left_out[0].reason, "footer"));
    fs::resize_file(b, 100);
    const auto header_only = open({a, b});
    ASSERT_TRUE(header_only) << message(header_only);
    EXPECT_EQ((*header_only)->coverage().size(), 2000u);
    EXPECT_EQ((*header_only)->report().left_out.size(), 1u);
    EXPECT_FALSE(open({b}));  // nothing is left
}

TEST_F(RunSetTest, AnEmptyPartIsAPart) {
    const fs::path empty = file("empty.latent", make_job(RecordKind::kXyz), {});
    const auto alone = open({empty});
    ASSERT_TRUE(alone) << message(alone);
    EXPECT_TRUE((*alone)->runs().empty());
    EXPECT_TRUE((*alone)->coverage().empty());
    EXPECT_TRUE((*alone)->report().left_out.empty());
    const auto with_another = open({empty, part("a.latent", 0)});
    ASSERT_TRUE(with_another) << message(with_another);
    EXPECT_EQ((*with_another)->coverage().size(), 2000u);
}

TEST_F(RunSetTest, AnUnfinishedTailIsOnlyANote) {
    const fs::path a = part("a.latent.part.0123", 0, false);
    cut(a, 5000);
    text("a.latent.part.4567", "");
    const auto g = open({folder_ / "a.latent"});  // not published yet: its attempts
    ASSERT_TRUE(g) << message(g);
    EXPECT_EQ((*g)->coverage().size(), 1000u);
    EXPECT_TRUE((*g)->report().left_out.empty());
    EXPECT_EQ((*g)->report().notes.size(), 2u);
}

TEST_F(RunSetTest, AttemptsOfOnePartAreChosenByTheSelectionRule) {
    const Job job = make_job(RecordKind::kXyz);
    const auto range = [](std::uint64_t first, std::uint64_t end) { return Coverage(SampleRange{first, end}); };
    file("a.latent.part.1", job, {range(0, 1024), range(1024, 3072)}, false);
    file("a.latent.part.2", job, {range(0, 2048)}, false);
    file("a.latent.part.3", job, {range(3072, 4096)}, false);
    const auto g = open({folder_ / "a.latent"});
    ASSERT_TRUE(g) << message(g);
    EXPECT_EQ((*g)->coverage(), range(0, 4096));
    EXPECT_EQ((*g)->report().superseded_runs, 1u);
    EXPECT_TRUE((*g)->report().left_out.empty());
}

TEST_F(RunSetTest, TheSameSamplesWithOtherContentAreReported) {
    const Job job = make_job(RecordKind::kXyz);
    const Coverage coverage(SampleRange{0, 1000});
    file("a.latent", job, {coverage});
    file("b.latent", job, {coverage}, true, {.seed = 2});
    const auto g = open({folder_.path()});
    ASSERT_TRUE(g) << message(g);
    ASSERT_EQ((*g)->report().left_out.size(), 1u);
    ASSERT_EQ((*g)->runs().size(), 1u);
    const auto [a, b] = std::pair(open({folder_ / "a.latent"}), open({folder_ / "b.latent"}));
    EXPECT_EQ((*g)->runs()[0].header.content_hash,
              std::min((*a)->runs()[0].header.content_hash, (*b)->runs()[0].header.content_hash));
}

TEST_F(RunSetTest, JobChoosesAmongSeveral) {
    part("a.latent", 0, true, 1);
    part("b.latent", 0, true, 2);
    EXPECT_TRUE(mentions(message(open({folder_.path()})), "--job"));
    RunSetOptions options;
    options.inputs = {folder_.path()};
    options.job = make_job(RecordKind::kXyz, 2).id;
    const auto g = RunSet::open(options);
    ASSERT_TRUE(g) << message(g);
    EXPECT_EQ((*g)->job().id, *options.job);
    EXPECT_EQ((*g)->files().size(), 1u);
    EXPECT_TRUE((*g)->report().left_out.empty());
}

TEST_F(RunSetTest, DamageIsFoundByTheLevelThatLooksForIt) {
    const fs::path a = part("a.latent", 0);
    std::fstream(a, std::ios::in | std::ios::out).seekp(3 * 4096).put('x');  // within the first run's pages
    RunSetOptions options;
    options.inputs = {a};
    const auto headers = RunSet::open(options);
    ASSERT_TRUE(headers);
    EXPECT_EQ((*headers)->coverage().size(), 2000u);
    options.verify = VerifyLevel::kStored;
    const auto stored = RunSet::open(options);
    ASSERT_TRUE(stored);
    EXPECT_EQ((*stored)->coverage().size(), 1000u);
    ASSERT_EQ((*stored)->report().left_out.size(), 1u);
    EXPECT_TRUE(mentions((*stored)->report().left_out[0].reason, "samples 0:1000 lost"));
}

// Sums over all records of what a run set reads.
struct Sums {
    std::uint64_t records = 0, samples = 0, positions = 0;
    bool operator==(const Sums&) const = default;
};

Sums read_all(const RunSet& g) {
    Sums sums;
    PageDecoder decoder;
    Page page;
    for (std::size_t run = 0; run < g.runs().size(); ++run) {
        const auto pages = g.pages(run);
        EXPECT_TRUE(pages);
        for (const PageInfo& info : **pages) {
            EXPECT_TRUE(g.read_page(run, info, ColumnSet{}, decoder, page));
            sums.records += page.count;
            for (std::size_t i = 0; i < page.count; ++i) {
                sums.samples += page.sample[i];
                sums.positions += page.u[i] ^ page.v[i];
            }
        }
    }
    return sums;
}

TEST_F(RunSetTest, ASliceReadsExactlyItsSamples) {
    for (const RecordKind kind : {RecordKind::kXyz, RecordKind::kSpectral}) {
        Job job = make_job(kind);
        job.extra = {{"depth", ColumnType::kF32}};
        const fs::path path = file("a.latent", job, {Coverage(SampleRange{0, 3000}), Coverage(SampleRange{3000, 6000})}, true,
                                   {.light_per_sample = 0.4});
        RunSetOptions options;
        options.inputs = {path};
        options.samples = SampleRange{1234, 4321};
        const auto g = RunSet::open(options);
        ASSERT_TRUE(g) << message(g);
        EXPECT_EQ((*g)->coverage(), Coverage(*options.samples));
        EXPECT_EQ((*g)->light_paths(), 3087u);
        const Records expected = synthetic::make_records(job, *options.samples, {.light_per_sample = 0.4});
        Sums wanted;
        wanted.records = expected.size();
        for (std::size_t i = 0; i < expected.size(); ++i) {
            wanted.samples += expected.sample[i];
            wanted.positions += expected.u[i] ^ expected.v[i];
        }
        EXPECT_EQ(read_all(**g), wanted);

        // every column keeps to its record
        PageDecoder decoder;
        Page page;
        for (std::size_t run = 0; run < 2; ++run) {
            for (const PageInfo& info : **(*g)->pages(run)) {
                ASSERT_TRUE((*g)->read_page(run, info, {}, decoder, page));
                for (std::size_t i = 0; i < page.count; ++i) {
                    const Records one =
                        synthetic::make_records(job, {page.sample[i], page.sample[i] + 1}, {.light_per_sample = 0.4});
                    std::size_t row = 0, first_pair = 0;
                    for (; one.record_class[row] != page.record_class || one.u[row] != page.u[i]; ++row) {
                        if (!one.pairs.empty()) first_pair += one.pairs[row];
                        ASSERT_LT(row + 1, one.size());
                    }
                    EXPECT_EQ(page.v[i], one.v[row]);
                    EXPECT_EQ(std::memcmp(&page.extra[0].values[i * 4], &one.extra[0].values[row * 4], 4), 0);
                    if (kind == RecordKind::kXyz) {
                        EXPECT_EQ(page.z[i], one.z[row]);
                    } else {
                        ASSERT_EQ(page.pairs[i], one.pairs[row]);
                        EXPECT_EQ(page.xi[i], one.xi[row]);
                        for (std::size_t p = 0; p < page.pairs[i]; ++p)
                            EXPECT_EQ(page.power[page.first_pair[i] + p], one.power[first_pair + p]);
                    }
                }
            }
        }
    }
}

TEST_F(RunSetTest, AListOfRunsThatMemoryIsTooSmallForIsRefusedWithWhatItNeeds) {
    std::vector<Coverage> runs;
    for (std::uint64_t i = 0; i < 2000; ++i) runs.emplace_back(SampleRange{i << 14, (i << 14) + 1});
    Coverage gaps;
    for (std::uint64_t i = 0; i < 60000; ++i) gaps.add({(i << 14) + 2, (i << 14) + 3});
    const Job job = make_job(RecordKind::kXyz);
    for (const std::vector<Coverage>& list : {runs, std::vector{gaps}}) {
        RunSetOptions options;
        options.inputs = {file("a.latent", job, list)};
        options.memory = 128 << 10;
        const auto small = RunSet::open(options);
        ASSERT_FALSE(small);
        EXPECT_EQ(small.error().code, ErrorCode::kOutOfRange);
        unsigned enough = 0;
        const std::string words = "intervals of samples need at least ";
        const std::size_t at = small.error().message.find(words);
        ASSERT_NE(at, std::string::npos) << small.error().message;
        ASSERT_EQ(std::sscanf(small.error().message.c_str() + at + words.size(), "%uM", &enough), 1);
        options.memory = std::uint64_t{enough} << 20;
        const auto large = RunSet::open(options);
        ASSERT_TRUE(large) << message(large);
        EXPECT_LE((*large)->list_memory(), options.memory);
        EXPECT_GE((*large)->list_memory(), (*large)->coverage().ranges().size() * 2 * sizeof(SampleRange));
    }
}

TEST_F(RunSetTest, ManyPartsNeedFewDescriptorsAndFewerIfTheSystemAllowsNoMore) {
    std::vector<fs::path> parts;
    const Job job = make_job(RecordKind::kXyz);
    for (std::uint64_t i = 0; i < 600; ++i) {
        parts.push_back(file(std::to_string(i) + ".latent", job, {Coverage(SampleRange{i << 14, (i << 14) + 4})}));
    }
    RunSetOptions options;
    options.inputs = parts;
    options.memory = 300 << 10;  // far too little for all indexes: they are read again
    auto g = RunSet::open(options);
    ASSERT_TRUE(g) << message(g);
    EXPECT_EQ((*g)->runs().size(), 600u);
    Sums first, second;
    std::thread other([&] { second = read_all(**g); });
    first = read_all(**g);
    other.join();
    EXPECT_EQ(first, second);
    EXPECT_GE(first.records, 2400u);
    const auto descriptors = std::distance(fs::directory_iterator("/proc/self/fd"), fs::directory_iterator());
    EXPECT_LE(descriptors, 256);
    EXPECT_GT((*g)->bytes_read(), 0u);
    g->reset();

    struct rlimit before;
    ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
    const struct rlimit low = {40, before.rlim_max};
    ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &low), 0);
    const auto with_few = RunSet::open(options);
    const Sums third = with_few ? read_all(**with_few) : Sums();
    ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &before), 0);
    ASSERT_TRUE(with_few) << message(with_few);
    EXPECT_EQ(first, third);
}

}  // namespace
}  // namespace latent::sampledb
