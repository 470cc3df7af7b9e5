// Names and provenance that another program wrote: shown so that they cannot steer a terminal, copied without being understood.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "sampledb/format/footer.h"
#include "sampledb/read/file_reader.h"
#include "tests/inspect/inspect_test.h"

namespace latent::inspect {
namespace {

namespace fs = std::filesystem;
using namespace sampledb;
using namespace latent::testing;
using nlohmann::json;
using synthetic::make_short_job;

constexpr long kMaxKib = 100 << 10;  // 0.4 MB of provenance is no reason to take more

// A file of one run with these provenances.
Bytes file_with(const Job& job, const std::string& header, const std::string& footer) {
    const synthetic::FileBytes plain = synthetic::make_file(job, std::vector{Coverage(SampleRange{0, 100})}, false, {}, header);
    Bytes bytes = plain.bytes;
    const Bytes end = *encode_footer(synthetic::runs_of(plain), footer, bytes.size());
    bytes.insert(bytes.end(), end.begin(), end.end());
    return bytes;
}

bool is_plain(const std::string& text) {
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto c = static_cast<unsigned char>(text[i]);
        if ((c < 0x20 && c != '\n') || c == 0x7f) return false;
        if (c == 0xc2 && i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) < 0xa0) return false;
    }
    return true;
}

class ForeignText : public InspectTest {
 protected:
    const std::string deep_ = R"({"a":)" + std::string(400'000, '[');
    Outcome merge(const fs::path& input) const {
        return run({tool("latent-merge"), input, "-o", folder_ / "merged.latent", "--force"});
    }
    json info_of(const fs::path& file) const { return json::parse(inspect({"info", "--json", file}).out); }
    json merged_info() const { return info_of(folder_ / "merged.latent"); }
};

TEST_F(ForeignText, ProvenanceThatIsNoJsonObjectOrTooDeepIsShownAsTextAndSaidSo) {
    const std::string deep_but_whole = R"({"a":)" + std::string(5000, '[') + std::string(5000, ']') + "}";
    for (const std::string& bad :
         {deep_, deep_but_whole, std::string("[1,2]"), std::string("no JSON"), std::string("{\"a\":\"\xff\"}")}) {
        const std::string start = bad.substr(0, 40);
        const fs::path file = write("a.latent", file_with(make_short_job(), bad, bad));
        const Outcome text = inspect({"info", file}), as_json = inspect({"info", "--json", file});
        for (const Outcome& outcome : {text, as_json}) {
            EXPECT_EQ(outcome.status, 0) << start;
            EXPECT_EQ(outcome.err, "") << start;
            EXPECT_LT(outcome.peak_rss_kib, kMaxKib) << start;
        }
        EXPECT_NE(text.out.find("the provenance in its header is "), std::string::npos) << start;
        EXPECT_NE(text.out.find("the provenance in its footer is "), std::string::npos) << start;
        EXPECT_TRUE(is_plain(text.out)) << start;
        const json info = json::parse(as_json.out);
        for (const char* member : {"origin", "parts"}) {
            ASSERT_TRUE(info[member].is_string()) << start;
            EXPECT_EQ(info[member].get<std::string>().substr(0, 4), bad.substr(0, 4));
        }
        const Outcome merged = merge(file);
        EXPECT_EQ(merged.status, 0) << merged.err;
        EXPECT_LT(merged.peak_rss_kib, kMaxKib) << start;
        EXPECT_EQ(merged_info()["parts"][0]["differences"].get<std::string>().substr(0, 4), bad.substr(0, 4));
    }
}

TEST_F(ForeignText, MergingCopiesProvenanceToTheLetterAndCountsEqualPartsOnce) {
    const std::string own = R"({ "z": 1.50, "a": "\u00e9" })";
    ASSERT_EQ(merge(write("a.latent", file_with(make_short_job(), own, ""))).status, 0);
    EXPECT_NE(read_text(folder_ / "merged.latent").find(R"({"parts":[{"provenance":)" + own + R"(,"samples":[[0,100]]}]})"),
              std::string::npos);
    const std::string parts = R"({"tool":"other","parts":[{"b":2}, {"a":[1,{}]},{"b":2}]})";
    ASSERT_EQ(merge(write("a.latent", file_with(make_short_job(), own, parts))).status, 0);
    EXPECT_NE(read_text(folder_ / "merged.latent").find(R"({"parts":[{"a":[1,{}]},{"b":2}]})"), std::string::npos);
}

TEST_F(ForeignText, HowAFileWasMadeIsToldInOnePlaceBeforeAndAfterMerging) {
    const std::string own = R"({"scene":"a","host":"x"})";
    const fs::path part = write("a.latent", file_with(make_short_job(), own, R"({"finished":{"cpu_seconds":7.25}})"));
    ASSERT_EQ(merge(part).status, 0);
    for (const json& info : {info_of(part), merged_info()}) {
        EXPECT_EQ(info["origin"], json::parse(R"({"scene":"a","host":"x","cpu_seconds":7.25})"));
        EXPECT_EQ(info["cpu_seconds"], 7.25);
    }
    EXPECT_EQ(info_of(part)["parts"], json::array());
    EXPECT_EQ(merged_info()["parts"], json::parse(R"([{"samples":[[0,100]],"differences":{}}])"));

    const std::string parts = R"({"parts":[{"provenance":{"scene":"a","host":"x","cpu_seconds":1.5},"samples":[[0,50]]},)"
                              R"({"provenance":{"cpu_seconds":2,"scene":"a","host":"y"},"samples":[[50,100]]}]})";
    const json info = info_of(write("a.latent", file_with(make_short_job(), "", parts)));
    EXPECT_EQ(info["origin"], json::parse(R"({"scene":"a"})"));
    EXPECT_EQ(info["parts"], json::parse(R"([{"samples":[[0,50]],"differences":{"host":"x","cpu_seconds":1.5}},)"
                                         R"({"samples":[[50,100]],"differences":{"cpu_seconds":2,"host":"y"}}])"));
    EXPECT_EQ(info["cpu_seconds"], 3.5);

    const auto cpu_time = [&](const char* origin) {
        return inspect({"info", write("a.latent", file_with(make_short_job(), origin, ""))}).out;
    };
    EXPECT_THAT(cpu_time(R"({"cpu_seconds":2})"), ::testing::HasSubstr("CPU time    2.0s\n"));
    EXPECT_THAT(cpu_time(R"({"cpu_seconds":2,"committed_before":7})"), ::testing::HasSubstr("2.0s since rendering was resumed\n"));
}

TEST_F(ForeignText, AProvenanceOfMorePartsThanAreKeptSaysThatItIsIncomplete) {
    std::string parts = R"({"parts":[)";
    for (int i = 0; i < 250'000; ++i) parts += (i > 0 ? ",{\"n\":" : "{\"n\":") + std::to_string(i) + "}";
    ASSERT_EQ(merge(write("a.latent", file_with(make_short_job(), "", parts + "]}"))).status, 0);
    const json merged = merged_info();
    EXPECT_GT(merged["parts"].size(), 100'000u);
    EXPECT_LT(merged["parts"].size(), 250'000u);
    EXPECT_EQ(merged["parts_complete"], false);
}

TEST_F(ForeignText, NothingThatAFileNamesSteersATerminal) {
    Job job = make_short_job();
    job.extra = {{"a\x1b[2J\n  samples     none", ColumnType::kU8}, {"b\xc2\x9b", ColumnType::kU8}, {"c\x7f\"", ColumnType::kF32}};
    const fs::path file = write("e\x1b[31m.latent", file_with(job, "{\"a\":\"\x7f\xc2\x9b\",\n  \"samples\":1}", "\x1b[2J\r"));
    for (const std::vector<std::string>& command : std::vector<std::vector<std::string>>{
             {"info"}, {"info", "--json"}, {"verify"}, {"verify", "--json"}, {"cat"}, {"cat", "--format", "json"}}) {
        std::vector<std::string> words = command;
        words.push_back(file);
        const Outcome outcome = inspect(words);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_TRUE(is_plain(outcome.out)) << outcome.out.substr(0, 2000);
        if (words[0] == "info" && words[1] != "--json") {
            EXPECT_EQ(outcome.out.find("\n  samples     none"), std::string::npos) << outcome.out;
        }
    }
    const json info = json::parse(inspect({"info", "--json", file}).out);
    EXPECT_EQ(info["extra_columns"][0], job.extra[0].name);
    EXPECT_EQ(info["origin"]["a"], "\x7f\xc2\x9b");
}

TEST_F(ForeignText, CatNamesEveryColumnSoThatItCanBeReadBack) {
    Job job = make_short_job();
    job.extra = {{"say \"hi\",\nthere\\", ColumnType::kU16}, {"x", ColumnType::kU8}, {"extra.x", ColumnType::kU8}};
    const fs::path file = write("a.latent", file_with(job, "", ""));
    std::istringstream lines(inspect({"cat", "--format", "json", file}).out);
    std::size_t records = 0;
    for (std::string line; std::getline(lines, line); ++records) {
        const json record = json::parse(line);
        EXPECT_TRUE(record.contains(job.extra[0].name)) << line;
        EXPECT_EQ(record.size(), 11u) << line;
        EXPECT_TRUE(record["extra.x"].is_number_unsigned()) << line;
        EXPECT_TRUE(record["extra.extra.x"].is_number_unsigned()) << line;
    }
    EXPECT_GE(records, 100u);
    const std::string csv = inspect({"cat", file, "--limit", "0"}).out;
    EXPECT_EQ(csv, "sample,class,u,v,share,x,y,z,\"say \"\"hi\"\",\\x0athere\\\",extra.x,extra.extra.x\n");
}

TEST_F(ForeignText, CatTakesTheJobThatItAdvisesToChoose) {
    fs::create_directory(folder_ / "parts");
    const Job one = make_short_job(), other = make_short_job(RecordKind::kXyz, 2);
    write("parts/a.latent", file_with(one, "", "")), write("parts/b.latent", file_with(other, "", ""));
    const Outcome refused = inspect({"cat", folder_ / "parts"});
    EXPECT_EQ(refused.status, 1);
    EXPECT_NE(refused.err.find("choose one with --job"), std::string::npos) << refused.err;
    const Outcome chosen = inspect({"cat", folder_ / "parts", "--job", to_hex(other.id)});
    EXPECT_EQ(chosen.status, 0) << chosen.err;
    EXPECT_EQ(chosen.out, inspect({"cat", folder_ / "parts/b.latent"}).out);
}

}  // namespace
}  // namespace latent::inspect
