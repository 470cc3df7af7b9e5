#include "tests/inspect/inspect_test.h"

#include <sys/stat.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/size.h"
#include "sampledb/format/footer.h"
#include "tests/faults/process.h"
#include "tests/support/opened_runs.h"
#include "tests/support/paths.h"
#include "tools/inspect/synthetic.h"

namespace latent::inspect {
namespace {

namespace fs = std::filesystem;
using namespace sampledb;
using namespace latent::testing;
using nlohmann::json;

using synthetic::make_short_job;
using synthetic::open_runs;

constexpr std::uint64_t kS = synthetic::kShortRun;

TEST_F(InspectTest, InfoTellsWhatIsInTheFile) {
    const Job job = make_short_job(RecordKind::kSpectral);
    std::vector<Coverage> runs = four_runs();
    runs.insert(runs.begin(), Coverage(SampleRange{0, 1024}));  // a checkpoint that the first run supersedes
    const fs::path file = write("a.latent", synthetic::make_file(job, runs, true, {}, R"({"host":"h"})").bytes);
    const Outcome outcome = inspect({"info", "--json", file});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const json info = json::parse(outcome.out);
    EXPECT_EQ(info["job"], to_hex(job.id));
    EXPECT_EQ(info["kind"], "spectral");
    EXPECT_EQ(info["wavelengths"], job.batch);
    EXPECT_EQ(info["samples"], json::parse("[[0,12788]]"));
    EXPECT_EQ(info["light_paths"], 12788 * job.light_paths_per_sample);
    EXPECT_EQ(info["runs"], 4);
    EXPECT_EQ(info["superseded_runs"], 1);
    EXPECT_EQ(info["open_runs"], 1);
    EXPECT_EQ(info["finished"], true);
    EXPECT_EQ(info["origin"]["host"], "h");
    EXPECT_EQ(info["camera_records"].get<std::uint64_t>() + info["light_records"].get<std::uint64_t>(),
              synthetic::make_records(job, {0, 12788}).size());
    double stored = 0;
    for (const json& column : info["columns"]) stored += column["stored_bytes_per_record"].get<double>();
    const double records =
        static_cast<double>(info["camera_records"].get<std::uint64_t>() + info["light_records"].get<std::uint64_t>());
    EXPECT_EQ(info["columns_estimated"], false);
    EXPECT_NEAR(stored * records + info["frame_bytes"].get<double>(), info["stored_bytes"].get<double>(), 0.5);
    EXPECT_GT(stored * records, 0.9 * (info["stored_bytes"].get<double>() - 4 * 5000));
    const std::string text = inspect({"info", file}).out;
    EXPECT_NE(text.find(to_hex(job.id)), std::string::npos);
    EXPECT_NE(text.find(format_size(info["stored_bytes"].get<std::uint64_t>()) + " without superseded runs"), std::string::npos)
        << text;
    const auto selected = open_runs({file});
    ASSERT_EQ(info["run_list"].size(), 4u);
    for (std::size_t i = 0; i < 4; ++i) {
        const SampleRange range = selected->runs()[i].coverage.ranges().front();
        EXPECT_EQ(info["run_list"][i]["samples"], (json{{range.first, range.end}}));
        EXPECT_EQ(info["run_list"][i]["content_hash"], to_hex(selected->runs()[i].header.content_hash));
    }
}

TEST_F(InspectTest, InfoListsTheGroupsOfLightsAndNoSpectra) {
    const std::string origin =
        R"({"program":"p","light_groups":[{"name":"lamp","spectrum":{"nm":[400,700],"value":[1,2],"goes_on":true}},)"
        R"({"name":"sky"},{"name":""}]})";
    const fs::path part = write("a.latent", synthetic::make_file(make_short_job(), four_runs(), true, {}, origin).bytes);
    const fs::path merged = folder_ / "merged.latent";
    ASSERT_EQ(run({tool("latent-merge"), part, "-o", merged}).status, 0);
    for (const fs::path& file : {part, merged}) {
        const Outcome text = inspect({"info", file});
        EXPECT_NE(text.out.find("  lights      lamp, sky, 2\n"), std::string::npos) << text.out;
        EXPECT_NE(text.out.find("latent-develop --light lamp=0.5\n"), std::string::npos) << text.out;
        EXPECT_NE(text.out.find("(NAME=6500K): lamp\n"), std::string::npos) << text.out;
        EXPECT_EQ(text.out.find("spectrum\""), std::string::npos) << text.out;
        EXPECT_EQ(
            json::parse(inspect({"info", "--json", file}).out)["light_groups"],
            json::parse(R"([{"name":"lamp","spectrum":true},{"name":"sky","spectrum":false},{"name":"2","spectrum":false}])"));
    }
}

TEST_F(InspectTest, WhatIsNoLatentFileIsSkippedInAFolderButNotWhereItIsNamed) {
    const fs::path parts = folder_ / "parts";
    fs::create_directory(parts);
    fs::rename(write("a.latent", synthetic::make_file(make_short_job(), four_runs()).bytes), parts / "a.latent");
    std::ofstream(parts / "notes.txt") << "a shopping list";
    for (const char* command : {"info", "verify"}) {
        const Outcome outcome = inspect({command, "--json", parts});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_EQ(json::parse(outcome.out).size(), 1u) << outcome.out;
        EXPECT_NE(outcome.err.find("notes.txt: not a Latent file, skipped\n"), std::string::npos) << outcome.err;
        EXPECT_EQ(inspect({command, parts / "a.latent", parts / "notes.txt"}).status, 1);
    }
    fs::remove(parts / "a.latent");
    const Outcome nothing = inspect({"verify", parts});
    EXPECT_EQ(nothing.status, 1);
    EXPECT_NE(nothing.err.find("holds no .latent file"), std::string::npos) << nothing.err;
}

TEST_F(InspectTest, ColumnsOfManyPagesAreEstimatedFromSome) {
    ASSERT_EQ(inspect({"gen", "-o", folder_ / "a.latent", "--records", "400k", "--light", "0.3", "--run-samples", "1024"}).status,
              0);
    const json info = json::parse(inspect({"info", "--json", folder_ / "a.latent"}).out);
    EXPECT_GT(info["pages"], 256);
    EXPECT_EQ(info["columns_estimated"], true);
    const double records =
        static_cast<double>(info["camera_records"].get<std::uint64_t>() + info["light_records"].get<std::uint64_t>());
    double stored = info["frame_bytes"].get<double>() / records;
    for (const json& column : info["columns"]) stored += column["stored_bytes_per_record"].get<double>();
    EXPECT_NEAR(stored, info["stored_bytes"].get<double>() / records, 1e-3);
    // Every record has a Y of 4 bytes; 256 pages of two kinds tell their share of the records to a few percent.
    EXPECT_NEAR(info["columns"]["y"]["decoded_bytes_per_record"].get<double>(), 4, 1e-3);
}

TEST_F(InspectTest, VerifyNoticesDamageToEitherCopyOfTheHeaderThoughNoRunIsLost) {
    const synthetic::FileBytes sound = synthetic::make_file(make_short_job(), four_runs());
    for (const std::size_t at : {std::size_t{45}, sound.header_size / 2 - 1, sound.header_size / 2 + 45, sound.header_size - 1}) {
        Bytes broken = sound.bytes;
        broken[at] ^= std::byte{1};
        const Outcome outcome = inspect({"verify", write("a.latent", broken)});
        EXPECT_EQ(outcome.status, 4) << at;
        EXPECT_NE(outcome.out.find("header: one of its two copies is damaged"), std::string::npos) << outcome.out;
        EXPECT_EQ(open_runs({folder_ / "a.latent"})->runs().size(), 4u);
    }
}

TEST_F(InspectTest, VerifyNamesTheRunThatIsDamaged) {
    const synthetic::FileBytes sound = synthetic::make_file(make_short_job(), four_runs());
    const fs::path file = write("a.latent", sound.bytes);
    for (const char* depth : {"--quick", "--json", "--deep"}) EXPECT_EQ(inspect({"verify", depth, file}).status, 0) << depth;
    EXPECT_EQ(inspect({"verify", file, "--threads", "1"}).out, inspect({"verify", file, "--threads", "3"}).out);
    Bytes broken = sound.bytes;
    broken[sound.run_ends[0] + 3000] ^= std::byte{1};
    const Outcome outcome = inspect({"verify", write("b.latent", broken)});
    EXPECT_EQ(outcome.status, 4);
    EXPECT_NE(outcome.out.find("b.latent: run 1 at byte " + std::to_string(sound.run_ends[0])), std::string::npos) << outcome.out;
    EXPECT_NE(outcome.out.find("samples 4096:8192 lost"), std::string::npos) << outcome.out;
    EXPECT_EQ(inspect({"verify", file, folder_ / "b.latent"}).status, 4);
}

TEST_F(InspectTest, AnUnfinishedFileIsSoundAndOneThatIsNoLatentFileIsAnError) {
    const synthetic::FileBytes unfinished = synthetic::make_file(make_short_job(), four_runs(), false);
    const Outcome outcome =
        inspect({"verify", write("a.latent.part.0", ByteSpan(unfinished.bytes).first(unfinished.run_ends[2] + 700))});
    EXPECT_EQ(outcome.status, 0) << outcome.out;
    EXPECT_NE(outcome.out.find("not finished"), std::string::npos);
    EXPECT_EQ(inspect({"verify", folder_ / "a.latent"}).out, outcome.out);  // not published yet: its attempts
    std::ofstream(folder_ / "text") << "nothing of the kind";
    for (const char* command : {"info", "verify"}) {
        const Outcome text = inspect({command, folder_ / "text"});
        EXPECT_EQ(text.status, 1);
        EXPECT_NE(text.err.find("text"), std::string::npos) << text.err;
        EXPECT_EQ(inspect({command, folder_ / "nowhere"}).status, 1);
    }
}

TEST_F(InspectTest, APublishedNameWithoutItsFooterIsDamagedHoweverItsEndWasSpoiled) {
    const synthetic::FileBytes sound = synthetic::make_file(make_short_job(), four_runs());
    const ByteSpan bytes(sound.bytes);
    Bytes flipped = sound.bytes, longer = sound.bytes;
    flipped[flipped.size() - 20] ^= std::byte{1};
    longer.resize(longer.size() + 1000, std::byte{'x'});
    for (const ByteSpan spoiled : {bytes.first(sound.run_ends[3]), bytes.first(sound.run_ends[1] + 700),
                                   bytes.first(sound.run_ends[1]), ByteSpan(flipped), ByteSpan(longer)}) {
        const fs::path file = write("a.latent", spoiled);
        const Outcome verified = inspect({"verify", file});
        EXPECT_EQ(verified.status, 4) << verified.out;
        const bool has_footer = spoiled.size() > sound.run_ends[3];
        EXPECT_NE(verified.out.find(has_footer ? "a.latent: footer at byte " : "a.latent: truncated or damaged at its end"),
                  std::string::npos)
            << verified.out;
        const Outcome recovered = inspect({"recover", file, "-o", folder_ / "b.latent", "--force"});
        EXPECT_EQ(recovered.status, 3) << recovered.out;
        EXPECT_NE(recovered.out.find("lost: "), std::string::npos) << recovered.out;
        EXPECT_EQ(inspect({"verify", folder_ / "b.latent"}).status, 0);
        const Outcome info = inspect({"info", file});
        EXPECT_EQ(info.status, 3);
        EXPECT_NE(info.out.find("truncated or damaged"), std::string::npos) << info.out;
    }
}

// Enough runs that a footer of the first form has one's header at the start of a block.
TEST_F(InspectTest, FilesOfManyRunsAreSoundWhateverTheirFooter) {
    std::vector<Coverage> runs;
    for (std::uint64_t i = 0; i < 200; ++i) runs.emplace_back(SampleRange{i * kS, i * kS + 2});
    const synthetic::FileBytes second = synthetic::make_file(make_short_job(), runs, true, {.light_per_sample = 0});
    const std::size_t end = second.run_ends.back();
    Bytes first(second.bytes.begin(), second.bytes.begin() + static_cast<std::ptrdiff_t>(end));
    const Bytes footer = synthetic::make_first_footer(synthetic::runs_of(second), end);
    first.insert(first.end(), footer.begin(), footer.end());
    for (const Bytes& bytes : {second.bytes, first}) {
        const fs::path file = write("a.latent", bytes);
        for (const char* level : {"--quick", "--deep"}) {
            const Outcome verified = inspect({"verify", level, file});
            EXPECT_EQ(verified.status, 0) << verified.out;
        }
        EXPECT_EQ(inspect({"recover", file, "-o", folder_ / "b.latent", "--force"}).status, 0);
        EXPECT_EQ(read_text(folder_ / "b.latent").size(), second.bytes.size());
        for (const std::size_t cut : {end, (end + bytes.size()) / 2, bytes.size() - 1}) {
            const fs::path part = write("a.latent.part.1", ByteSpan(bytes).first(cut));
            const Outcome verified = inspect({"verify", "--deep", part});
            EXPECT_EQ(verified.status, 0) << verified.out;
            const Outcome recovered = inspect({"recover", "--json", part, "-o", folder_ / "b.latent", "--force"});
            EXPECT_EQ(recovered.status, 0) << recovered.out;
            EXPECT_EQ(json::parse(recovered.out)["runs"], 200);
        }
    }
}

TEST_F(InspectTest, VerifyTellsWhatTheFramesContradict) {
    const synthetic::FileBytes sound = synthetic::make_file(make_short_job(), four_runs());
    const std::vector<RunInfo> runs = synthetic::runs_of(sound);
    const auto with_list = [&](const std::vector<RunInfo>& list) {
        Bytes bytes(sound.bytes.begin(), sound.bytes.begin() + static_cast<std::ptrdiff_t>(sound.run_ends.back()));
        const Bytes footer = *encode_footer(list, "", bytes.size());
        bytes.insert(bytes.end(), footer.begin(), footer.end());
        return bytes;
    };
    std::vector<RunInfo> fewer = runs, other = runs;
    fewer.erase(fewer.begin() + 1);
    other[2].header.content_hash.low ^= 1;
    Bytes header = sound.bytes;
    const Bytes another = *encode_file_header({make_short_job(), "{}"});
    std::copy_n(another.begin(), another.size() / 2, header.begin());
    for (const auto& [bytes, said] : {std::pair{with_list(fewer), "the footer does not match the runs"},
                                      {with_list(other), "the footer lists a different header for the run at byte"},
                                      {header, "its two copies differ"}}) {
        const fs::path file = write("a.latent", bytes);
        for (const char* level : {"--quick", "--deep"}) {
            const Outcome verified = inspect({"verify", level, file});
            EXPECT_EQ(verified.status, 4) << said;
            EXPECT_NE(verified.out.find(said), std::string::npos) << verified.out;
            EXPECT_NE(verified.out.find("4 runs"), std::string::npos) << verified.out;
        }
        const Outcome recovered = inspect({"recover", file, "-o", folder_ / "b.latent", "--force"});
        EXPECT_EQ(recovered.status, 0) << recovered.out;  // all runs are there
        EXPECT_NE(recovered.out.find(said), std::string::npos) << recovered.out;
        EXPECT_EQ(inspect({"verify", folder_ / "b.latent"}).status, 0);
    }
    // No tool uses fewer runs for it.
    const Outcome info = inspect({"info", "--json", write("a.latent", with_list(fewer))});
    EXPECT_EQ(json::parse(info.out)["runs"], 4) << info.out;
    EXPECT_EQ(open_runs({folder_ / "a.latent"})->runs().size(), 4u);
}

TEST_F(InspectTest, AnUnknownTransformCostsThePageThatItIsIn) {
    const synthetic::FileBytes sound = synthetic::make_file(make_short_job(), four_runs());
    const fs::path file = write("a.latent", synthetic::with_transform(sound, 1, 200));
    const auto lines = [](const std::string& text) { return std::ranges::count(text, '\n'); };
    const Outcome all = inspect({"cat", write("b.latent", sound.bytes)}), rest = inspect({"cat", file});
    EXPECT_EQ(rest.status, 3) << rest.err;
    EXPECT_NE(rest.err.find("unknown transform 200"), std::string::npos) << rest.err;
    EXPECT_LT(lines(rest.out), lines(all.out));
    EXPECT_GT(lines(rest.out), lines(all.out) / 2);
    const Outcome info = inspect({"info", "--json", file});
    EXPECT_EQ(info.status, 0) << info.out;
    EXPECT_EQ(json::parse(info.out)["runs"], 4);
    EXPECT_EQ(inspect({"verify", file}).status, 0);  // every stored byte is as it was written
    const Outcome deep = inspect({"verify", "--deep", file});
    EXPECT_EQ(deep.status, 4);
    EXPECT_NE(deep.out.find("run 1 at byte"), std::string::npos) << deep.out;
    EXPECT_NE(deep.out.find("unknown transform 200"), std::string::npos) << deep.out;
}

TEST_F(InspectTest, InfoListsTheDamageThatItMeets) {
    const synthetic::FileBytes sound = synthetic::make_file(make_short_job(), four_runs());
    for (const std::size_t into : {std::size_t{100}, std::size_t{2000}}) {  // of run 1: its header; its pages
        Bytes bytes = sound.bytes;
        bytes[sound.run_ends[0] + into] ^= std::byte{1};
        const Outcome outcome = inspect({"info", "--json", write("a.latent", bytes)});
        EXPECT_EQ(outcome.status, 3);
        EXPECT_EQ(json::parse(outcome.out)["damage"].size(), 1u) << outcome.out;
    }
}

TEST_F(InspectTest, AFileMayHaveAnyName) {
    const fs::path file = write("\xff.latent", synthetic::make_file(make_short_job(), four_runs()).bytes);
    for (const std::string command : {"info", "verify"}) {
        const Outcome outcome = inspect({command, "--json", file});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_TRUE(json::accept(outcome.out)) << outcome.out;
    }
}

// What `cat` prints to a file.
Outcome cat_to_file(const std::string& arguments, const fs::path& file) {
    return testing::run({"/bin/sh", "-c", testing::tool("latent-inspect") + " cat " + arguments + " > " + file.string()});
}

TEST_F(InspectTest, ANumPyArrayHoldsTheNumbersThatTheTextHolds) {
    const fs::path file = write("a.latent", synthetic::make_file(make_short_job(), four_runs()).bytes), npy = folder_ / "a.npy";
    const std::string selection = file.string() + " --region 0.2,0.1,0.6,0.8 --samples 100:9000 --limit 1500";
    const Outcome written = cat_to_file(selection + " --format npy --columns y,u,class,sample,share", npy);
    ASSERT_EQ(written.status, 0) << written.err;
    const std::string bytes = testing::read_text(npy);
    ASSERT_TRUE(bytes.starts_with("\x93NUMPY\x03"));
    EXPECT_NE(bytes.find("{'descr': [('y', '<f4'), ('u', '<f8'), ('class', '|u1'), ('sample', '<u8'), ('share', '<f4'), ], "
                         "'fortran_order': False, 'shape': (1500,)}"),
              std::string::npos)
        << bytes.substr(0, 300);
    constexpr std::size_t kRow = 4 + 8 + 1 + 8 + 4, kHeader = 8192;
    ASSERT_EQ(bytes.size(), kHeader + 1500 * kRow);
    ASSERT_EQ(cat_to_file(selection, folder_ / "a.csv").status, 0);
    std::istringstream lines(testing::read_text(folder_ / "a.csv"));
    std::string line;
    std::getline(lines, line);
    for (std::size_t row = 0; row < 1500; ++row) {
        ASSERT_TRUE(std::getline(lines, line));
        std::vector<std::string> fields;
        std::istringstream words(line);
        for (std::string word; std::getline(words, word, ',');) fields.push_back(word);
        const auto* at = reinterpret_cast<const std::byte*>(bytes.data()) + kHeader + row * kRow;
        ASSERT_EQ(load_le<float>(at), std::stof(fields[6]));
        ASSERT_EQ(load_le<double>(at + 4), std::stod(fields[2]));
        ASSERT_EQ(load_le<std::uint8_t>(at + 12), fields[1] == "light" ? 1 : 0);
        ASSERT_EQ(load_le<std::uint64_t>(at + 13), std::stoull(fields[0]));
        ASSERT_EQ(load_le<float>(at + 21), std::stof(fields[4]));
    }
}

TEST_F(InspectTest, ANumPyArrayOfSpectraEndsInZerosWhereARecordHasFewerPairs) {
    const Job job = make_short_job(RecordKind::kSpectral);
    const fs::path file = write("a.latent", synthetic::make_file(job, four_runs()).bytes), npy = folder_ / "a.npy";
    ASSERT_EQ(cat_to_file(file.string() + " --format npy --columns lambda_nm,power", npy).status, 0);
    const std::string bytes = testing::read_text(npy);
    const std::size_t row_bytes = 2 * sizeof(float) * job.batch;
    ASSERT_EQ((bytes.size() - 8192) % row_bytes, 0u);
    ASSERT_EQ(cat_to_file(file.string() + " --format json", folder_ / "a.json").status, 0);
    std::istringstream lines(testing::read_text(folder_ / "a.json"));
    std::size_t row = 0, shorter = 0;
    for (std::string line; std::getline(lines, line); ++row) {
        const json record = json::parse(line);
        const auto* at = reinterpret_cast<const std::byte*>(bytes.data()) + 8192 + row * row_bytes;
        for (const char* column : {"lambda_nm", "power"}) {
            const std::size_t n = record[column].size();
            for (std::size_t i = 0; i < job.batch; ++i, at += sizeof(float)) {
                ASSERT_EQ(load_le<float>(at), i < n ? record[column][i].get<float>() : 0.0f);
            }
            shorter += n < job.batch ? 1 : 0;
        }
    }
    EXPECT_EQ(row, (bytes.size() - 8192) / row_bytes);
    EXPECT_GT(shorter, 0u);
}

TEST_F(InspectTest, NumPyArraysNeedAFileAndKnownColumns) {
    const fs::path file = write("a.latent", synthetic::make_file(make_short_job(), four_runs()).bytes);
    const std::string to_pipe =
        "{ " + testing::tool("latent-inspect") + " cat --format npy " + file.string() + "; echo ends with $? >&2; }";
    const Outcome pipe = testing::run({"/bin/sh", "-c", to_pipe + " | cat"});
    EXPECT_NE(pipe.err.find("ends with 2"), std::string::npos) << pipe.err;
    EXPECT_TRUE(pipe.out.empty());
    EXPECT_NE(pipe.err.find("FILE.npy"), std::string::npos) << pipe.err;
    const Outcome unknown = cat_to_file(file.string() + " --format npy --columns y,power", folder_ / "a.npy");
    EXPECT_EQ(unknown.status, 2) << unknown.err;
    EXPECT_NE(unknown.err.find("'power' is not a column"), std::string::npos) << unknown.err;
    EXPECT_EQ(inspect({"cat", "--columns", "y", file}).status, 2);
}

TEST_F(InspectTest, NumbersThatAreNoneAndNamesOfAnotherKindAreWrongUsage) {
    const fs::path file = write("a.latent", synthetic::make_file(make_short_job(), four_runs()).bytes);
    EXPECT_EQ(inspect({"cat", file, "--limit", "-1"}).status, 2);
    for (const char* region : {"0,0,2,2", "-1,0,1,1", "0.5,0,0.5,1", "0,0.6,1,0.4", "0,nan,1,1", "0,0,1", "0,0,1,1,1", "a,b,c,d"}) {
        EXPECT_EQ(inspect({"cat", file, std::string("--region=") + region}).status, 2) << region;
    }
    EXPECT_EQ(inspect({"cat", file, "--region", "0,0,1,1"}).out, inspect({"cat", file}).out);
    for (const char* option : {"--records", "--first", "--seed", "--run-samples", "--run-bytes", "--every", "--checkpoint"}) {
        EXPECT_EQ(inspect({"gen", "-o", folder_ / "b.latent", option, "-1"}).status, 2) << option;
    }
    EXPECT_EQ(inspect({"gen", "-o", folder_ / "b.txt"}).status, 2);
    EXPECT_EQ(inspect({"gen", "-o", folder_ / ".latent"}).status, 2);
    EXPECT_EQ(inspect({"gen", "-o", folder_ / "b.latent", "--run-samples", "1025"}).status, 2);
    EXPECT_EQ(inspect({"recover", file, "-o", folder_ / "b.txt"}).status, 2);
    EXPECT_EQ(folder_.names(), std::vector<std::string>{"a.latent"});
}

TEST_F(InspectTest, WhatCannotBeLookedAtSaysWhy) {
    fs::create_symlink("a.latent", folder_ / "b.latent");
    fs::create_symlink("b.latent", folder_ / "a.latent");
    for (const std::string command : {"info", "verify", "cat"}) {
        const Outcome loop = inspect({command, folder_ / "a.latent"}),
                      endless = inspect({command, folder_ / std::string(300, 'x')});
        EXPECT_EQ(loop.status, 1);
        EXPECT_TRUE(loop.err.ends_with("a.latent: a symbolic link that leads back to itself\n")) << loop.err;
        EXPECT_EQ(endless.status, 1);
        EXPECT_TRUE(endless.err.ends_with("cannot open: File name too long\n")) << endless.err;
    }
}

TEST_F(InspectTest, OneBadFileDoesNotKeepTheOthersFromBeingLookedAt) {
    const synthetic::FileBytes sound = synthetic::make_file(make_short_job(), four_runs());
    const fs::path good = write("good.latent", sound.bytes);
    const fs::path cut = write("cut.latent", ByteSpan(sound.bytes).first(sound.run_ends[2]));
    const fs::path text = folder_ / "text.latent";
    std::ofstream(text) << "nothing of the kind";
    for (const auto& [command, status] : {std::pair("info", 1), std::pair("verify", 4)}) {
        const Outcome outcome = inspect({command, text, folder_ / "nowhere.latent", cut, good, "--json"});
        EXPECT_EQ(outcome.status, status) << outcome.err;
        const json reports = json::parse(outcome.out);
        ASSERT_EQ(reports.size(), 4u);
        EXPECT_TRUE(reports[0].contains("error"));
        EXPECT_TRUE(reports[1].contains("error"));
        EXPECT_EQ(reports[2]["finished"], false);
        EXPECT_EQ(reports[3]["file"], good.string());
        EXPECT_EQ(json::parse(inspect({command, good, "--json"}).out), reports[3]);
    }
    EXPECT_EQ(inspect({"verify", text, good}).status, 1);
}

TEST_F(InspectTest, CatLeavesOutDamagedPagesAndSaysSo) {
    const synthetic::FileBytes sound = synthetic::make_file(make_short_job(), four_runs());
    const Outcome all = inspect({"cat", write("a.latent", sound.bytes)});
    Bytes broken = sound.bytes;
    broken[sound.run_ends[0] + 3000] ^= std::byte{1};
    const Outcome outcome = inspect({"cat", write("b.latent", broken)});
    EXPECT_EQ(outcome.status, 3);
    EXPECT_NE(outcome.err.find("b.latent: left out: "), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("checksum mismatch"), std::string::npos) << outcome.err;
    EXPECT_LT(outcome.out.size(), all.out.size());
    const std::string last = all.out.substr(all.out.rfind('\n', all.out.size() - 2));
    EXPECT_TRUE(outcome.out.ends_with(last));  // runs behind the damage are still there
}

TEST_F(InspectTest, RecoverSavesExactlyTheRunsThatAreSoundAndListsTheRest) {
    const Job job = make_short_job();
    const synthetic::FileBytes sound = synthetic::make_file(job, four_runs());
    for (std::size_t broken_run = 0; broken_run < 4; ++broken_run) {
        for (const std::size_t into : {std::size_t{100}, std::size_t{2000}}) {  // its header; its pages
            Bytes bytes = sound.bytes;
            const std::size_t at = (broken_run == 0 ? sound.header_size : sound.run_ends[broken_run - 1]) + into;
            std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), 512, std::byte{0});
            const fs::path input = write("a.latent", bytes), output = folder_ / "b.latent";
            const Outcome outcome = inspect({"recover", input, "-o", output, "--json", "--force"});
            EXPECT_EQ(outcome.status, 3) << outcome.err;
            const json ledger = json::parse(outcome.out);
            const SampleRange lost = four_runs()[broken_run].ranges().front();
            EXPECT_EQ(ledger["lost_samples"], (json{{lost.first, lost.end}})) << ledger.dump();
            EXPECT_EQ(ledger["damage"].size(), 1u);
            const auto saved = open_runs({output});
            ASSERT_TRUE(saved);
            EXPECT_EQ(saved->runs().size(), 3u);
            EXPECT_FALSE(saved->coverage().intersects(lost));
            EXPECT_EQ(inspect({"verify", "--deep", output}).status, 0);
            EXPECT_EQ(inspect({"recover", output, "-o", folder_ / "c.latent", "--force"}).status, 0);  // nothing more to lose
            EXPECT_EQ(read_text(folder_ / "c.latent"), read_text(output));
        }
    }
}

TEST_F(InspectTest, WhereNothingCanBeRecoveredThereIsNoOutput) {
    const synthetic::FileBytes sound = synthetic::make_file(make_short_job(), std::vector{Coverage(SampleRange{0, 1000})});
    Bytes broken = sound.bytes;
    broken[sound.header_size + 2000] ^= std::byte{1};
    const ByteSpan cut = ByteSpan(sound.bytes).first(sound.run_ends[0] - 1);
    for (const fs::path& input : {write("broken.latent", broken), write("cut.latent", cut), write("a.latent.part.0", cut)}) {
        const Outcome outcome = inspect({"recover", input, "-o", folder_ / "b.latent"});
        EXPECT_EQ(outcome.status, 1) << input;
        EXPECT_TRUE(outcome.err.ends_with("; nothing could be recovered\n")) << outcome.err;
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
        EXPECT_FALSE(fs::exists(folder_ / "b.latent"));
    }
    const fs::path empty = write("empty.latent", synthetic::make_file(make_short_job(), {}).bytes);  // it has nothing to lose
    EXPECT_EQ(inspect({"recover", empty, "-o", folder_ / "b.latent"}).status, 0);
}

TEST_F(InspectTest, APipeIsRefusedAtOnce) {
    ASSERT_EQ(::mkfifo((folder_ / "pipe").c_str(), 0600), 0);  // nobody writes to it: reading it would wait for ever
    for (const std::string command : {"info", "verify", "cat"}) {
        const Outcome outcome = inspect({command, folder_ / "pipe"});
        EXPECT_EQ(outcome.status, 1);
        EXPECT_TRUE(outcome.err.ends_with("pipe: not a regular file\n")) << outcome.err;
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    }
}

TEST_F(InspectTest, RecoverNeverTouchesItsInputOrAnOutputThatExists) {
    const fs::path file = write("a.latent", synthetic::make_file(make_short_job(), four_runs()).bytes);
    const std::string before = read_text(file);
    EXPECT_EQ(inspect({"recover", file, "-o", file}).status, 1);
    fs::create_hard_link(file, folder_ / "hard.latent");
    fs::create_symlink(file, folder_ / "soft.latent");
    for (const char* name : {"a.latent", "./a.latent", "hard.latent", "soft.latent"}) {
        const Outcome outcome = inspect({"recover", file, "-o", folder_ / name, "--force"});
        EXPECT_EQ(outcome.status, 1) << name;
        EXPECT_NE(outcome.err.find("is the input file"), std::string::npos) << outcome.err;
    }
    EXPECT_TRUE(fs::is_symlink(folder_ / "soft.latent"));
    std::ofstream(folder_ / "b.latent") << "precious";
    EXPECT_EQ(inspect({"recover", file, "-o", folder_ / "b.latent"}).status, 1);
    EXPECT_EQ(read_text(folder_ / "b.latent"), "precious");
    EXPECT_EQ(read_text(file), before);
}

TEST_F(InspectTest, RecoverFromAFailingDiskLeavesNoHalfOutput) {
    const fs::path file = write("a.latent", synthetic::make_file(make_short_job(), four_runs()).bytes);
    const std::vector<std::string> before = folder_.names();
    for (const char* call : {"create", "write", "copy", "sync", "link", "read"}) {
        int nth = 1;
        for (bool happened = true; happened && nth < 100; ++nth) {
            const std::string rule = std::string(call) + ":" + std::to_string(nth) + ":EIO";
            SCOPED_TRACE(rule);
            const FaultOutcome outcome = run_with_fault({tool("latent-inspect"), "recover", file, "-o", folder_ / "b.latent"},
                                                        {rule, folder_.path().string()});
            happened = outcome.happened;
            if (fs::exists(folder_ / "b.latent")) {
                EXPECT_FALSE(happened && std::string(call) == "read") << outcome.err;
                EXPECT_EQ(inspect({"verify", folder_ / "b.latent"}).status, 0);
            } else {
                EXPECT_EQ(outcome.status, 1);
                EXPECT_NE(outcome.err.find(".latent"), std::string::npos) << outcome.err;
                EXPECT_EQ(folder_.names(), before);
            }
            fs::remove(folder_ / "b.latent");
        }
        EXPECT_GT(nth, 2) << call;
    }
}

TEST_F(InspectTest, AReadErrorIsAnErrorNamingTheFileAndNeverDamage) {
    const fs::path file = write("a.latent", synthetic::make_file(make_short_job(), four_runs()).bytes);
    const std::vector<std::vector<std::string>> kinds = {
        {"verify"}, {"verify", "--quick"}, {"verify", "--deep"}, {"info"}, {"cat"}};
    for (const std::vector<std::string>& kind : kinds) {
        std::vector<std::string> command = {tool("latent-inspect")};
        command.insert(command.end(), kind.begin(), kind.end());
        command.push_back(file);
        int nth = 1;
        for (bool happened = true; happened; ++nth) {
            const std::string rule = "read:" + std::to_string(nth) + ":EIO";
            SCOPED_TRACE(kind.front() + " " + rule);
            const FaultOutcome outcome = run_with_fault(command, {rule, folder_.path().string()});
            happened = outcome.happened;
            EXPECT_EQ(outcome.status, happened ? 1 : 0) << outcome.out << outcome.err;
            if (happened) {
                EXPECT_NE(outcome.err.find("a.latent: cannot read"), std::string::npos) << outcome.err;
            }
        }
        EXPECT_GT(nth, 10);  // both headers, the footer, the runs
    }
}

TEST_F(InspectTest, RecoverToAFullDiskLeavesNoHalfOutput) {
    const latent::testing::SmallDisk disk(64 << 10);
    if (!disk.mounted()) GTEST_SKIP() << "mounting a tmpfs is not permitted here";
    const fs::path file = write("a.latent", synthetic::make_file(make_short_job(), four_runs()).bytes);
    const Outcome outcome = inspect({"recover", file, "-o", disk / "b.latent"});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_NE(outcome.err.find("b.latent: cannot write: No space left on device"), std::string::npos) << outcome.err;
    EXPECT_TRUE(disk.names().empty());
}

TEST_F(InspectTest, CatSaysWhenItsOutputIsFull) {
    const fs::path file = write("a.latent", synthetic::make_file(make_short_job(), four_runs()).bytes);
    const Outcome outcome = run({"/bin/sh", "-c", "exec \"$0\" cat \"$1\" > /dev/full", tool("latent-inspect"), file});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_NE(outcome.err.find("No space left on device"), std::string::npos) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
}

TEST_F(InspectTest, AReportThatCannotBeWrittenIsAFailureButCostsNoOutput) {
    const fs::path file = write("a.latent", synthetic::make_file(make_short_job(), four_runs()).bytes);
    const auto outcome_of = [&](const std::string& command, const std::string& where) {
        return run({"/bin/sh", "-c", "cd " + folder_.path().string() + "; " + tool(command) + where});
    };
    for (const std::string command : {"info a.latent", "verify --json a.latent", "--help"}) {
        const Outcome outcome = outcome_of("latent-inspect " + command, " > /dev/full");
        EXPECT_EQ(outcome.status, 1) << command;
        EXPECT_NE(outcome.err.find("standard output: cannot write"), std::string::npos) << outcome.err;
    }
    const std::vector<std::pair<std::string, std::string>> commands = {{"latent-merge a.latent --json -o ", "merged.latent"},
                                                                       {"latent-inspect recover a.latent -o ", "saved.latent"},
                                                                       {"latent-inspect gen --records 1000 -o ", "made.latent"},
                                                                       {"latent-develop a.latent --size 90 -o ", "a.exr"},
                                                                       {"latent-convert a.exr --json -o ", "a.png"}};
    for (const auto& [command, output] : commands) {
        for (const std::string where : {" > /dev/full", " >&-"}) {
            fs::remove(folder_ / output);
            const Outcome outcome = outcome_of(command + output, where);
            EXPECT_EQ(outcome.status, 3) << command;
            EXPECT_NE(outcome.err.find("only the report is lost, the output is kept\n"), std::string::npos) << outcome.err;
            EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
        }
        const std::string kept = read_text(folder_ / output);
        fs::remove(folder_ / output);
        EXPECT_EQ(outcome_of(command + output, "").status, 0);
        EXPECT_TRUE(kept == read_text(folder_ / output)) << output;
    }
}

TEST_F(InspectTest, ASignalEndsEveryToolAndLeavesNothing) {
    const std::string in = write("a.latent", synthetic::make_file(make_short_job(), four_runs()).bytes);
    for (const std::vector<std::string>& command : std::vector<std::vector<std::string>>{{"latent-merge", in},
                                                                                         {"latent-merge", in, "--compact"},
                                                                                         {"latent-inspect", "recover", in},
                                                                                         {"latent-develop", in, "--size", "300"}}) {
        for (const std::string file : {"", "create:1:EROFS,"}) {  // without a name, or with a hidden one
            std::vector<std::string> words = command;
            words[0] = tool(words[0]);
            words.insert(words.end(), {"-o", folder_ / (command[0] == "latent-develop" ? "b.exr" : "b.latent")});
            const auto outcome = latent::testing::run_with_fault(words, {file + "write:2:term", folder_.path().string()});
            EXPECT_TRUE(outcome.happened) << command[0];
            EXPECT_EQ(outcome.status, 128 + SIGTERM) << command[0] << outcome.err;
            EXPECT_EQ(outcome.err, "");
            EXPECT_EQ(folder_.names(), std::vector<std::string>{"a.latent"}) << command[0];
        }
    }
}

TEST_F(InspectTest, CatPrintsEveryRecordExactly) {
    Job job = make_short_job();
    job.extra = {{"depth", ColumnType::kF32}};
    const fs::path file = write("a.latent", synthetic::make_file(job, four_runs()).bytes);
    const Records records = synthetic::make_records(job, {0, 3 * kS + 500});
    std::multimap<std::uint64_t, std::size_t> rows;
    for (std::size_t i = 0; i < records.size(); ++i) rows.emplace(records.sample[i], i);

    const Outcome csv = inspect({"cat", file});
    ASSERT_EQ(csv.status, 0) << csv.err;
    std::istringstream lines(csv.out);
    std::string line;
    std::getline(lines, line);
    EXPECT_EQ(line, "sample,class,u,v,share,x,y,z,depth");
    while (std::getline(lines, line)) {
        std::replace(line.begin(), line.end(), ',', ' ');
        std::istringstream fields(line);
        std::uint64_t sample;
        std::string record_class, values[7];
        fields >> sample >> record_class;
        for (std::string& value : values) fields >> value;
        const auto [first, last] = rows.equal_range(sample);
        const auto same = std::find_if(first, last, [&](const auto& entry) {
            const std::size_t i = entry.second;
            return (record_class == "light") == (records.record_class[i] == RecordClass::kLight) &&
                   std::stod(values[0]) * 0x1p32 == records.u[i] && std::stod(values[1]) * 0x1p32 == records.v[i] &&
                   std::stof(values[2]) == records.share[i] && std::stof(values[3]) == records.x[i] &&
                   std::stof(values[4]) == records.y[i] && std::stof(values[5]) == records.z[i];
        });
        ASSERT_NE(same, last) << line;
        rows.erase(same);
    }
    EXPECT_TRUE(rows.empty());
}

TEST_F(InspectTest, CatSelectsSamplesRegionAndNumber) {
    const Job job = make_short_job(RecordKind::kSpectral);
    const fs::path file = write("a.latent", synthetic::make_file(job, four_runs()).bytes);
    const Records records = synthetic::make_records(job, {5000, 6000});
    const Outcome outcome = inspect({"cat", file, "--samples", "5000:6000", "--region", "0.25,0.5,1,1", "--format", "json"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    std::size_t expected = 0, seen = 0;
    for (std::size_t i = 0; i < records.size(); ++i) expected += records.u[i] >= 0x40000000u && records.v[i] >= 0x80000000u;
    std::istringstream lines(outcome.out);
    for (std::string line; std::getline(lines, line); ++seen) {
        const json record = json::parse(line);
        EXPECT_GE(record["u"].get<double>(), 0.25);
        EXPECT_GE(record["v"].get<double>(), 0.5);
        EXPECT_GE(record["sample"].get<std::uint64_t>(), 5000u);
        EXPECT_LT(record["sample"].get<std::uint64_t>(), 6000u);
        EXPECT_EQ(record["lambda_nm"].size(), record["power"].size());
    }
    EXPECT_EQ(seen, expected);
    const Outcome limited = inspect({"cat", file, "--limit", "7"});
    EXPECT_EQ(std::count(limited.out.begin(), limited.out.end(), '\n'), 8);
}

TEST_F(InspectTest, GenWritesTheSameFileWithAnyNumberOfThreads) {
    std::string expected;
    for (const char* threads : {"1", "2", "5"}) {
        const Outcome outcome =
            inspect({"gen", "-o", folder_ / "a.latent", "--records", "20k", "--kind", "spectral", "--wavelengths", "8", "--light",
                     "0.3", "--single", "0.2", "--run-samples", "4096", "--threads", threads, "--force"});
        ASSERT_EQ(outcome.status, 0) << outcome.err;
        if (expected.empty()) expected = read_text(folder_ / "a.latent");
        EXPECT_EQ(read_text(folder_ / "a.latent"), expected);
    }
    EXPECT_EQ(inspect({"verify", "--deep", folder_ / "a.latent"}).status, 0);
    EXPECT_EQ(inspect({"gen", "-o", folder_ / "a.latent", "--records", "20k", "--seed", "1"}).status, 1);  // another job
}

TEST_F(InspectTest, GenReachesSampleNumbersBeyondTwoToTheThirtyTwo) {
    const Outcome outcome =
        inspect({"gen", "-o", folder_ / "far.latent", "--first", "8589934592", "--records", "3000", "--every", "1000", "--json"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const auto far = open_runs({folder_ / "far.latent"});
    EXPECT_EQ(far->coverage(), Coverage(SampleRange{8589934592, 8589934592 + 3000000}));
    std::uint64_t records = 0;
    for (const SelectedRun& r : far->runs()) records += r.header.camera_records;
    EXPECT_EQ(records, 3000u);
}

TEST(Synthetic, ExpectedLuminanceIsTheSameForBothKinds) {
    SyntheticScene scene;
    scene.subject = Subject::kUniform;
    scene.kind = RecordKind::kSpectral;
    const Job job = synthetic_job(scene);
    const Grain grain = synthetic_grain(scene, job, {0, 1024});
    // P_i = L / (k p), so that the sum of P_i estimates the integral of L = 1 / 106.857 over the 470 nm of the band.
    double sum = 0;
    for (const float power : grain.records.power) sum += power;
    EXPECT_NEAR(sum / 1024, 470 / 106.856895, 0.01 * 470 / 106.856895);
}

TEST_F(InspectTest, HelpShowsWhatAnOptionTakesAndItsDefault) {
    const std::string help = inspect({"gen", "--help"}).out + inspect({"cat", "--help"}).out;
    for (const char* option :
         {"  -o,--output NAME.latent (required)\n", "  --kind xyz|spectral [xyz]  ", "  --wavelengths 1..1024 [28]  ",
          "  --first N [0]  ", "  --aspect W:H [1:1]  ", "  --random-positions  ", "  FILE ...  "})
        EXPECT_NE(help.find(option), std::string::npos) << option << "\n" << help;
}

TEST_F(InspectTest, EveryHelpTextFitsEightyColumns) {
    const std::string folder = latent::testing::tools_folder() + "/latent-";
    for (const std::string command : {"render", "merge", "develop", "convert", "inspect", "inspect info", "inspect verify",
                                      "inspect recover", "inspect cat", "inspect noise", "inspect gen"}) {
        const Outcome help = run({"/bin/sh", "-c", folder + command + " --help"});
        ASSERT_EQ(help.status, 0) << command;
        std::istringstream lines(help.out);
        for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 80u) << command << ": " << line;
    }
}

// The commands that a help text shows work as they stand, one after the other.
TEST_F(InspectTest, ExamplesInHelpTextsWorkWhenPasted) {
    for (const char* name : {"night-0.latent", "night-1.latent", "broken.latent", "other.latent"}) {
        const bool second = std::string(name) == "night-1.latent";
        const std::vector<Coverage> runs = {second ? Coverage(SampleRange{kS, 2 * kS}) : Coverage(SampleRange{0, kS})};
        write(name, synthetic::make_file(make_short_job(), runs).bytes);
    }
    fs::create_directories(folder_ / "parts");
    write("parts/0.latent", synthetic::make_file(make_short_job(), std::vector{Coverage(SampleRange{0, kS})}).bytes);
    write("parts/1.latent", synthetic::make_file(make_short_job(), std::vector{Coverage(SampleRange{kS, 2 * kS})}).bytes);
    int tried = 0;
    for (const std::string command : {"latent-merge", "latent-inspect info", "latent-inspect verify", "latent-inspect recover",
                                      "latent-inspect cat", "latent-inspect noise", "latent-inspect gen"}) {
        const std::string path = "PATH=" + latent::testing::tools_folder() + ":$PATH; cd " + folder_.path().string() + "; ";
        const Outcome help = run({"/bin/sh", "-c", path + command + " --help"});
        ASSERT_EQ(help.status, 0) << command;
        std::istringstream lines(help.out);
        for (std::string line; std::getline(lines, line);) {
            if (line.rfind("  latent-", 0) != 0) continue;
            std::string example = line.substr(2, line.find("   ", 2) - 2);
            // The same, but small.
            using Words = std::pair<std::string, std::string>;
            for (const auto& [large, small] : {Words{"1.07G", "10k"}, {"10M", "10k"}, {"1M", "10k"}, {"0:16777216", "0:8192"}}) {
                if (const std::size_t at = example.find(large); at != std::string::npos) example.replace(at, large.size(), small);
            }
            const Outcome outcome = run({"/bin/sh", "-c", path + example});
            EXPECT_EQ(outcome.status, 0) << example << "\n" << outcome.err;
            EXPECT_TRUE(!example.ends_with("--json") || json::accept(outcome.out)) << example;
            ++tried;
        }
    }
    EXPECT_GE(tried, 16);
}

}  // namespace
}  // namespace latent::inspect
