// Columns that no program knows but by the header of the file: docs/format.md, "Registry".
#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <tuple>

#include "base/bytes.h"
#include "sampledb/data/limits.h"
#include "tests/inspect/inspect_test.h"

namespace latent::inspect {
namespace {

using namespace sampledb;
using nlohmann::json;
using testing::Outcome;
using testing::tool;

constexpr std::uint64_t kRun = synthetic::kShortRun;
constexpr SampleRange kPrinted{kRun / 4, 3 * kRun + 100};  // cuts the first run and the last one

// More columns than the first readers took, of all types in turn.
Job job_with_columns(RecordKind kind) {
    Job job = synthetic::make_short_job(kind);
    for (std::size_t i = 0; i < 2 * kFewExtraColumns; ++i)
        job.extra.push_back({"studio:" + std::to_string(i), static_cast<ColumnType>(1 + i % 6)});
    return job;
}

using Key = std::tuple<std::uint64_t, bool, double, double>;  // sample, of a light, position

std::multimap<Key, std::size_t> rows_of(const Records& records) {
    std::multimap<Key, std::size_t> rows;
    for (std::size_t i = 0; i < records.size(); ++i)
        rows.emplace(
            Key{records.sample[i], records.record_class[i] == RecordClass::kLight, records.u[i] * 0x1p-32, records.v[i] * 0x1p-32},
            i);
    return rows;
}

template <class T>
bool is_value(const json& printed, const std::byte* stored) {
    const T value = load_le<T>(stored);
    if constexpr (std::is_floating_point_v<T>) {
        return std::isfinite(value) ? printed.is_number() && printed.get<T>() == value : printed.is_null();
    } else {
        return printed.is_number_unsigned() && printed.get<T>() == value;
    }
}

bool is_value(const json& printed, const ExtraColumn& column, std::size_t row) {
    const std::byte* const at = &column.values[row * width(column.type)];
    switch (column.type) {
        case ColumnType::kU8:
            return is_value<std::uint8_t>(printed, at);
        case ColumnType::kU16:
            return is_value<std::uint16_t>(printed, at);
        case ColumnType::kU32:
            return is_value<std::uint32_t>(printed, at);
        case ColumnType::kU64:
            return is_value<std::uint64_t>(printed, at);
        case ColumnType::kF32:
            return is_value<float>(printed, at);
        case ColumnType::kF64:
            return is_value<double>(printed, at);
    }
    return false;
}

class ExtraColumnsTest : public InspectTest {
 protected:
    // The samples of kPrinted, as cat prints them, are those of `records`, each value of each extra column with them.
    void expect_printed(const std::string& file, const Records& records) const {
        SCOPED_TRACE(file);
        const Outcome outcome = inspect({"cat", folder_ / file, "--samples",
                                         std::to_string(kPrinted.first) + ":" + std::to_string(kPrinted.end), "--format", "json"});
        ASSERT_EQ(outcome.status, 0) << outcome.err;
        std::multimap<Key, std::size_t> rows = rows_of(records);
        std::istringstream lines(outcome.out);
        for (std::string line; std::getline(lines, line);) {
            const json record = json::parse(line);
            const auto [first, last] =
                rows.equal_range(Key{record["sample"], record["class"] == "light", record["u"], record["v"]});
            const auto same = std::find_if(first, last, [&](const auto& entry) {
                return std::ranges::all_of(
                    records.extra, [&](const ExtraColumn& column) { return is_value(record[column.name], column, entry.second); });
            });
            ASSERT_NE(same, last) << line;
            rows.erase(same);
        }
        EXPECT_TRUE(rows.empty());
    }
};

TEST_F(ExtraColumnsTest, ValuesStayWithTheirRecordsThroughMergeCompactSelectionAndCat) {
    const synthetic::Scene scene{.light_per_sample = 0.3, .split_shares = true};
    for (const RecordKind kind : {RecordKind::kXyz, RecordKind::kSpectral}) {
        const Job job = job_with_columns(kind);
        const Records records = synthetic::make_records(job, kPrinted, scene);
        write("a.latent", synthetic::make_file(job, synthetic::runs_between({0, kRun, 2 * kRun}), true, scene).bytes);
        write("b.latent",
              synthetic::make_file(job, synthetic::runs_between({2 * kRun, 3 * kRun, 3 * kRun + 500}), true, scene).bytes);
        const auto merge = [&](std::vector<std::string> options) {
            std::vector<std::string> command = {tool("latent-merge"), folder_ / "a.latent", folder_ / "b.latent", "--force", "-o"};
            command.insert(command.end(), options.begin(), options.end());
            return testing::run(command);
        };
        ASSERT_EQ(merge({folder_ / "merged.latent"}).status, 0);
        ASSERT_EQ(merge({folder_ / "compact.latent", "--compact"}).status, 0);
        const Outcome sound =
            inspect({"verify", "--strict", folder_ / "a.latent", folder_ / "merged.latent", folder_ / "compact.latent"});
        EXPECT_EQ(sound.status, 0) << sound.out << sound.err;
        expect_printed("merged.latent", records);
        expect_printed("compact.latent", records);
    }
}

}  // namespace
}  // namespace latent::inspect
