// Files of another writer, tests/sampledb/write_latent.py, in the hands of the tools.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "tests/faults/process.h"

namespace latent::inspect {
namespace {

using testing::Outcome;
using testing::run;
using testing::tool;

// The lines of `cat --format json`.
std::vector<nlohmann::json> lines_of(const std::string& text) {
    std::vector<nlohmann::json> lines;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) lines.push_back(nlohmann::json::parse(line));
    return lines;
}

// Whether a value is the one that the writer gave as its bits. JSON has no infinity and no NaN, null stands for them; its
// parsers take -0 for 0.
bool is_value(const std::string& name, const nlohmann::json& value, const nlohmann::json& bits) {
    if (bits.is_array()) {
        return std::ranges::equal(value, bits,
                                  [&](const auto& one, const auto& its_bits) { return is_value(name, one, its_bits); });
    }
    static const std::set<std::string> kFloats = {"share", "x", "y", "z", "power", "lambda_nm", "depth"};
    if (value.is_null()) return kFloats.contains(name);
    if (name == "u" || name == "v") return value.get<double>() * 0x1p32 == bits.get<double>();
    if (name == "time") return std::bit_cast<std::uint64_t>(value.get<double>()) == bits.get<std::uint64_t>();
    if (kFloats.contains(name) && value == 0) return (bits.get<std::uint32_t>() & 0x7FFFFFFF) == 0;
    if (kFloats.contains(name)) return std::bit_cast<std::uint32_t>(value.get<float>()) == bits.get<std::uint32_t>();
    return value == bits;
}

class ForeignFile : public ::testing::TestWithParam<const char*> {
 protected:
    std::string in(const std::string& name) const { return (folder_ / name).string(); }
    void write(const std::string& name, std::vector<std::string> more) const {
        more.insert(more.begin(), {GetParam(), in(name), "--vary", "4"});
        const Outcome written = testing::run_python("tests/sampledb/write_latent.py", more);
        ASSERT_EQ(written.status, 0) << written.err;
    }
    static std::string succeed(const std::vector<std::string>& command) {
        const Outcome outcome = run(command);
        EXPECT_EQ(outcome.status, 0) << command[0] << ": " << outcome.err << outcome.out;
        return outcome.out;
    }

    testing::TemporaryFolder folder_;
};

TEST_P(ForeignFile, IsTakenByEveryTool) {
    write("all.latent", {"--records", in("records")});
    write("a.latent", {"--parts", "1"});
    write("b.latent", {"--parts", std::string(GetParam()) == "xyz" ? "0,3,2" : "0"});
    for (const char* level : {"--quick", "--deep"}) {
        for (const char* file : {"all.latent", "a.latent", "b.latent"})
            succeed({tool("latent-inspect"), "verify", level, in(file)});
    }
    succeed({tool("latent-merge"), in("a.latent"), in("b.latent"), "-o", in("merged.latent")});
    succeed({tool("latent-inspect"), "recover", in("all.latent"), "-o", in("recovered.latent")});

    const std::string text = succeed({tool("latent-inspect"), "cat", "--format", "json", in("all.latent")});
    EXPECT_TRUE(succeed({tool("latent-inspect"), "cat", "--format", "json", in("merged.latent")}) == text);
    EXPECT_TRUE(succeed({tool("latent-inspect"), "cat", "--format", "json", in("recovered.latent")}) == text);
    const std::vector<nlohmann::json> lines = lines_of(text), expected = lines_of(testing::read_text(folder_ / "records"));
    ASSERT_EQ(lines.size(), expected.size());
    for (std::size_t i = 0; i < lines.size(); ++i) {
        SCOPED_TRACE(lines[i].dump() + " for " + expected[i].dump());
        ASSERT_EQ(lines[i].size(), expected[i].size());
        for (const auto& [name, bits] : expected[i].items()) ASSERT_TRUE(is_value(name, lines[i].at(name), bits)) << name;
    }

    for (const char* file : {"all", "merged"}) {
        succeed({tool("latent-develop"), in(std::string(file) + ".latent"), "-o", in(std::string(file) + ".exr"), "--size", "48"});
    }
    EXPECT_TRUE(testing::read_text(folder_ / "all.exr") == testing::read_text(folder_ / "merged.exr"));
}

INSTANTIATE_TEST_SUITE_P(All, ForeignFile, ::testing::Values("xyz", "spectral", "explicit"),
                         [](const auto& kind) { return std::string(kind.param); });

}  // namespace
}  // namespace latent::inspect
