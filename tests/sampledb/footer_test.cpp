// Footers and walks find the same runs; where they do not, that is told; and nothing in a footer is taken for a run.
#include "sampledb/format/footer.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/hash.h"
#include "sampledb/codec/run_codec.h"
#include "sampledb/data/limits.h"
#include "sampledb/format/frames.h"
#include "sampledb/read/file_reader.h"
#include "sampledb/read/footer_reader.h"
#include "tests/support/synthetic.h"

namespace latent::sampledb {
namespace {

using synthetic::FileBytes;
using synthetic::make_job;

constexpr std::uint64_t kFirstHead = 24, kFirstEntry = 264, kTrailer = 64;

// A file of small runs, and the list that a footer has of them.
struct FooterCase {
    Job job;
    FileBytes file;  // without a footer
    std::vector<RunInfo> runs;

    explicit FooterCase(std::size_t count) : job(make_job(RecordKind::kXyz)) {
        job.run_samples = 1024;
        std::vector<Coverage> coverage;
        for (std::uint64_t i = 0; i < count; ++i) coverage.emplace_back(SampleRange{i * 1024, i * 1024 + 3});
        file = synthetic::make_file(job, coverage, false, {.light_per_sample = 0});
        runs = synthetic::runs_of(file);
    }
    std::size_t footer() const { return file.bytes.size(); }
    Bytes with(ByteSpan end) const {
        Bytes bytes = file.bytes;
        bytes.insert(bytes.end(), end.begin(), end.end());
        return bytes;
    }
    // Footers of both forms that list these runs.
    Bytes second(const std::vector<RunInfo>& list) const { return with(*encode_footer(list, "", footer())); }
    Bytes first(const std::vector<RunInfo>& list) const { return with(synthetic::make_first_footer(list, footer())); }
};

FileContents read(ByteSpan bytes, bool use_footer = true, VerifyLevel level = VerifyLevel::kHeaders) {
    const Result<FileContents> contents = read_file(MemorySource(bytes), level, use_footer);
    EXPECT_TRUE(contents) << contents.error().message;
    return contents.value_or(FileContents{});
}

bool mentions(const FileContents& file, const std::string& what) {
    return std::ranges::any_of(file.damage, [&](const Damage& damage) { return damage.reason.find(what) != std::string::npos; });
}
std::uint64_t losses(const FileContents& file) {
    return static_cast<std::uint64_t>(std::ranges::count(file.damage, true, &Damage::loss));
}

// Of the first form's entries the 125th and every 512th from there holds a run's header at the start of a block.
const FooterCase& many() {
    static const FooterCase runs(150);
    return runs;
}

TEST(Footer, OfEitherFormIsReadAndWalkedToTheSameRuns) {
    const FooterCase& c = many();
    for (const Bytes& bytes : {c.first(c.runs), c.second(c.runs)}) {
        for (const bool use_footer : {true, false}) {
            const FileContents file = read(bytes, use_footer, VerifyLevel::kStored);
            EXPECT_TRUE(file.finished);
            EXPECT_EQ(file.runs, c.runs);
            EXPECT_TRUE(file.damage.empty()) << file.damage[0].reason;
            EXPECT_EQ(file.end, c.footer());
        }
    }
}

TEST(Footer, CutAtAnyByteLeavesEveryRunAndIsNoRun) {
    const FooterCase& c = many();
    for (const Bytes& bytes : {c.first(c.runs), c.second(c.runs)}) {
        std::vector<std::size_t> cuts;
        for (std::size_t cut = c.footer(); cut < bytes.size(); cut += cut - c.footer() < 512 ? 1 : 89) cuts.push_back(cut);
        for (std::size_t cut = c.footer() + kBlock; cut < bytes.size(); cut += kBlock)
            cuts.insert(cuts.end(), {cut - 1, cut, cut + 1});
        for (const std::size_t cut : cuts) {
            SCOPED_TRACE(cut - c.footer());
            const FileContents file = read(ByteSpan(bytes).first(cut));
            ASSERT_FALSE(file.finished);
            ASSERT_EQ(file.runs, c.runs);
            ASSERT_TRUE(file.damage.empty()) << file.damage[0].reason;
            ASSERT_EQ(file.unfinished_tail, cut - c.footer());
        }
    }
}

TEST(Footer, WhoseHeadIsLostHoldsNoRunForASearch) {
    // A search goes through all of it; of the first form without an end it meets a run's header at the start of a block.
    const FooterCase& c = many();
    for (const Bytes& whole : {c.first(c.runs), c.second(c.runs)}) {
        for (const std::size_t cut : {whole.size(), whole.size() - 1}) {
            Bytes bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(cut));
            bytes[c.footer() + 3] ^= std::byte{1};
            const FileContents file = read(bytes);
            EXPECT_FALSE(file.finished);
            EXPECT_EQ(file.runs, c.runs);
            EXPECT_TRUE(file.damage.empty()) << file.damage[0].reason;
        }
    }
}

TEST(Footer, BehindADamagedRunEndsTheSearch) {
    const FooterCase& c = many();
    for (Bytes bytes : {c.first(c.runs), c.second(c.runs)}) {
        bytes[c.runs.back().offset + 100] ^= std::byte{1};
        const std::size_t cut = bytes.size() - 10;
        for (const bool footer : {true, false}) {
            const FileContents file = read(ByteSpan(bytes).first(footer ? bytes.size() : cut), false);
            EXPECT_EQ(file.runs.size(), c.runs.size() - 1);
            ASSERT_EQ(file.damage.size(), 1u);
            EXPECT_EQ(file.damage[0].offset, c.runs.back().offset);
            EXPECT_EQ(file.damage[0].size, c.runs.back().header.size());
            EXPECT_EQ(file.lost_by_list.size(), footer ? 3u : 0u);
        }
    }
}

TEST(Footer, ThatOmitsARunIsNotBelievedAndThatIsTold) {
    const FooterCase c(6);
    for (std::size_t omitted = 0; omitted < c.runs.size(); ++omitted) {
        std::vector<RunInfo> list = c.runs;
        list.erase(list.begin() + static_cast<std::ptrdiff_t>(omitted));
        for (const Bytes& bytes : {c.first(list), c.second(list)}) {
            for (const bool use_footer : {true, false}) {
                const FileContents file = read(bytes, use_footer);
                EXPECT_TRUE(file.finished);
                EXPECT_EQ(file.runs, c.runs);
                EXPECT_EQ(losses(file), 0u);
                EXPECT_TRUE(mentions(file, "the footer does not match the runs"));
            }
        }
    }
    // One entry that spans two runs accounts for all bytes.
    std::vector<RunInfo> list = c.runs;
    list[2].header.pages_size += list[3].header.size();
    list[2].header.decoded_size += list[3].header.size();
    list.erase(list.begin() + 3);
    const Bytes bytes = c.second(list);
    EXPECT_EQ(read(bytes, false).runs, c.runs);
    EXPECT_TRUE(mentions(read(bytes, false), "a different header for the run at byte " + std::to_string(c.runs[2].offset)));
    EXPECT_TRUE(mentions(read(bytes, false), "does not list the run at byte " + std::to_string(c.runs[3].offset)));
    EXPECT_EQ(losses(read(bytes, true, VerifyLevel::kQuick)), 1u);
}

TEST(Footer, ThatListsAnotherHeaderIsCaughtByAWalkAndWhenTheRunIsUsed) {
    const FooterCase c(3);
    std::vector<RunInfo> list = c.runs;
    list[1].header.content_hash.low ^= 1;
    for (const Bytes& bytes : {c.first(list), c.second(list)}) {
        const FileContents listed = read(bytes);
        ASSERT_EQ(listed.runs, list);
        const Result<RunIndex> index = read_run_index(MemorySource(bytes), listed.runs[1], c.job);
        ASSERT_FALSE(index);
        EXPECT_EQ(index.error().code, ErrorCode::kCorrupt);
        const FileContents walked = read(bytes, false);
        EXPECT_EQ(walked.runs, c.runs);
        EXPECT_TRUE(mentions(walked, "a different header for the run at byte " + std::to_string(c.runs[1].offset)));
        EXPECT_EQ(read(bytes, true, VerifyLevel::kQuick).runs.size(), 2u);
    }
}

TEST(Footer, NamesTheSamplesOfARunWhoseHeaderIsGone) {
    const FooterCase c(5);
    for (Bytes bytes : {c.first(c.runs), c.second(c.runs)}) {
        for (const std::size_t run : {1u, 2u, 4u}) bytes[c.runs[run].offset + 50] ^= std::byte{1};
        const FileContents file = read(bytes, false);
        EXPECT_EQ(file.runs.size(), 2u);
        EXPECT_EQ(losses(file), 3u);
        for (const std::size_t run : {1u, 2u, 4u}) {
            EXPECT_TRUE(mentions(file, "samples " + std::to_string(run * 1024) + ":"));
            EXPECT_TRUE(file.lost_by_list.contains(c.runs[run].header.samples));
        }
        EXPECT_EQ(file.lost_by_list.size(), 9u);
    }
}

// One field of the head is another, at both ends, and every hash is right.
TEST(Footer, ThatMisleadsIsNotBelieved) {
    const FooterCase c(2);
    const auto patched = [&](std::size_t offset, std::uint64_t value) {
        Bytes bytes = c.second(c.runs);
        for (const std::size_t head : {c.footer(), bytes.size() - kFooterHeadSize}) {
            store_le(&bytes[head + offset], value);
            store_le(&bytes[head + 56], hash64(ByteSpan(bytes).subspan(head, 56)));
        }
        const FileContents file = read(bytes);
        EXPECT_EQ(file.runs, c.runs);
        return file.finished;
    };
    EXPECT_TRUE(patched(16, 2));
    EXPECT_FALSE(patched(8, c.footer() + kBlock));     // it is elsewhere
    EXPECT_FALSE(patched(8, c.footer() + 8));          // at no start of a block
    EXPECT_FALSE(patched(16, 3));                      // counts more runs than it holds
    EXPECT_FALSE(patched(16, ~std::uint64_t{0}));      // or than a file has
    EXPECT_FALSE(patched(24, 1));                      // provenance that is not there
    EXPECT_FALSE(patched(24, ~std::uint64_t{0} - 3));  // or more than there may be
    EXPECT_FALSE(patched(32, 1));                      // other entries
    EXPECT_FALSE(patched(40, 1));                      // other provenance
    EXPECT_FALSE(patched(48, 1));                      // where zeros belong
}

TEST(Footer, OfTheFirstFormThatMisleadsIsNotBelieved) {
    const FooterCase c(2);
    const auto patched = [&](std::size_t offset, std::uint64_t value) {
        Bytes bytes = c.first(c.runs);
        store_le(&bytes[c.footer() + offset], value);
        const std::size_t trailer = bytes.size() - kTrailer;
        store_le(&bytes[trailer + 16], hash64(ByteSpan(bytes).subspan(c.footer(), trailer - c.footer())));
        store_le(&bytes[trailer + 48], hash64(ByteSpan(bytes).subspan(trailer, 48)));
        const FileContents file = read(bytes);
        EXPECT_EQ(file.runs, c.runs);
        return file.finished && file.damage.empty();
    };
    const std::size_t trailer = kFirstHead + 2 * kFirstEntry;
    EXPECT_TRUE(patched(8, 2));
    EXPECT_FALSE(patched(8, 3));  // counts more runs than it holds
    EXPECT_FALSE(patched(8, ~std::uint64_t{0}));
    EXPECT_FALSE(patched(16, 1));                               // provenance that is not there
    EXPECT_FALSE(patched(kFirstHead, c.file.header_size + 1));  // a run that is not aligned
    EXPECT_FALSE(patched(kFirstHead, std::uint64_t{1} << 60));  // or beyond the file
    EXPECT_FALSE(patched(kFirstHead, c.file.run_ends[0]));      // or within another
    EXPECT_FALSE(patched(trailer, 4096));                       // the footer is elsewhere
    EXPECT_FALSE(patched(trailer + 8, ~std::uint64_t{0}));      // or larger than the file
    EXPECT_FALSE(patched(trailer + 24, 1));                     // where zeros belong
}

TEST(Footer, HoldsNoMoreThanAReaderTakes) {
    EXPECT_TRUE(encode_footer({}, std::string(kMaxFooterProvenance, ' '), 0));
    EXPECT_FALSE(encode_footer({}, std::string(kMaxFooterProvenance + 1, ' '), 0));
    const std::vector<RunInfo> runs(kMaxRunsPerFile + 1);
    EXPECT_FALSE(encode_footer(runs, "", 0));
}

TEST(Footer, ListsMoreRunsThanAreReadAtOnce) {
    const FooterCase c(1);
    std::vector<RunInfo> list;
    constexpr std::uint64_t kMany = 20000;
    for (std::uint64_t i = 0; i < kMany; ++i) list.push_back({i * c.runs[0].header.size(), c.runs[0].header});
    const std::uint64_t end = kMany * c.runs[0].header.size();
    Bytes bytes(end);
    const Bytes footer = *encode_footer(list, "{}", end);
    bytes.insert(bytes.end(), footer.begin(), footer.end());
    const MemorySource source(bytes);
    const Result<FooterReader> reader = FooterReader::open(source, *read_footer_end(source));
    ASSERT_TRUE(reader);
    std::vector<RunInfo> listed;
    EXPECT_TRUE(reader->for_each_run(0, c.job.id, [&](const RunInfo& run) { listed.push_back(run); }));
    EXPECT_EQ(listed, list);
    EXPECT_EQ(*reader->provenance(), "{}");
}

// A run whose version or features this program does not know, its hash right.
TEST(Walk, GoesOnBehindARunOfAnotherVersionAndSaysSo) {
    const FooterCase c(5);
    for (const auto& [at, value, said] :
         {std::tuple<std::size_t, std::uint16_t, const char*>{8, 2, "format version 2"}, {16, 4, "uses features 0x4"}}) {
        for (const std::size_t run : {0u, 2u, 4u}) {
            Bytes bytes = c.file.bytes;
            std::byte* const header = &bytes[c.runs[run].offset];
            store_le(header + at, value);
            store_le(header + 248, hash64({header, 248}));
            for (const bool damaged : {false, true}) {  // with the run before it lost, it is searched for
                if (damaged && run == 0) continue;
                if (damaged) bytes[c.runs[run - 1].offset] ^= std::byte{1};
                const FileContents file = read(bytes);
                EXPECT_EQ(file.runs.size(), damaged ? 3u : 4u);
                EXPECT_EQ(file.unfinished_tail, 0u);
                EXPECT_EQ(losses(file), damaged ? 2u : 1u);
                EXPECT_TRUE(mentions(file, said));
                EXPECT_TRUE(mentions(file, "samples " + std::to_string(run * 1024) + ":" + std::to_string(run * 1024 + 3)));
            }
            // A footer of a later writer lists the run, too; that is no contradiction.
            Bytes listed = c.second(c.runs);
            store_le(&listed[c.runs[run].offset + at], value);
            store_le(&listed[c.runs[run].offset + 248], hash64({&listed[c.runs[run].offset], 248}));
            std::byte* const footer = &listed[c.footer()];
            store_le(footer + 64 + 128 * run + at - 8, value);
            store_le(footer + 32, hash64({footer + 64, 128 * c.runs.size()}));
            store_le(footer + 56, hash64({footer, 56}));
            std::copy_n(footer, 64, listed.end() - 64);
            for (const bool by_footer : {false, true}) {
                const FileContents file = *read_file(MemorySource(listed), VerifyLevel::kHeaders, by_footer);
                EXPECT_TRUE(file.finished);
                EXPECT_EQ(file.runs.size(), 4u);
                ASSERT_EQ(file.damage.size(), 1u);
                EXPECT_TRUE(mentions(file, said));
            }
        }
    }
}

TEST(Walk, TellsDamageBeforeARunThatIsCutOff) {
    const FooterCase c(4);
    Bytes bytes = c.file.bytes;
    bytes[c.runs[1].offset] ^= std::byte{1};
    bytes[c.runs[2].offset] ^= std::byte{1};
    bytes.pop_back();
    const FileContents file = read(bytes);
    EXPECT_EQ(file.runs.size(), 1u);
    ASSERT_EQ(file.damage.size(), 1u);
    EXPECT_EQ(file.damage[0].offset, c.runs[1].offset);
    EXPECT_EQ(file.damage[0].size, 2 * c.runs[1].header.size());
    EXPECT_EQ(file.unfinished_tail, c.runs[3].header.size() - 1);
}

TEST(Headers, ThatDifferAreTold) {
    const Job job = make_job(RecordKind::kXyz);
    const std::vector<Coverage> runs = {Coverage(SampleRange{0, 100})};
    const FileBytes a = synthetic::make_file(job, runs, true, {}, R"({"host":"a"})"),
                    b = synthetic::make_file(job, runs, true, {}, R"({"host":"b"})");
    ASSERT_EQ(a.header_size, b.header_size);
    Bytes mixed = a.bytes;
    std::copy_n(b.bytes.begin() + static_cast<std::ptrdiff_t>(b.header_size / 2), b.header_size / 2,
                mixed.begin() + static_cast<std::ptrdiff_t>(a.header_size / 2));
    EXPECT_TRUE(read(a.bytes).damage.empty());
    const FileContents file = read(mixed);
    EXPECT_EQ(file.header.provenance_json, R"({"host":"a"})");
    EXPECT_TRUE(mentions(file, "its two copies differ"));
    EXPECT_EQ(losses(file), 0u);
    EXPECT_EQ(file.runs.size(), 1u);
}

TEST(Damage, OfAnyNumberOfPlacesIsAShortList) {
    std::vector<Damage> list;
    for (std::uint64_t i = 0; i < 5 * kMaxDamage; ++i) add_damage(list, {i * 10, 5, "hole", false});
    ASSERT_EQ(list.size(), kMaxDamage + 1);
    EXPECT_EQ(list.back().offset, kMaxDamage * 10);
    EXPECT_EQ(list.back().offset + list.back().size, 5 * kMaxDamage * 10 - 5);
    EXPECT_EQ(list.back().places, 4 * kMaxDamage);
    EXPECT_EQ(list.back().reason, "4000 more, in bytes 10000..49995");
    EXPECT_FALSE(list.back().loss);
    add_damage(list, {7, 1, "loss"});
    EXPECT_TRUE(list.back().loss);
    EXPECT_EQ(list.size(), kMaxDamage + 1);
}

}  // namespace
}  // namespace latent::sampledb
