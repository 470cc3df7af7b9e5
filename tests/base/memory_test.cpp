#include "base/memory.h"

#include <gtest/gtest.h>

#include <fstream>
#include <limits>

#include "tests/faults/process.h"

namespace latent {
namespace {

constexpr std::uint64_t kNone = std::numeric_limits<std::uint64_t>::max();

class ControlGroups : public ::testing::Test {
 protected:
    void limit(const std::string& file, const std::string& text) const {
        const std::filesystem::path path = folder_.path() / file;
        std::filesystem::create_directories(path.parent_path());
        std::ofstream(path) << text << '\n';
    }
    std::uint64_t limit_of(const std::string& memberships) const { return control_group_limit(memberships, folder_.path()); }

 private:
    testing::TemporaryFolder folder_;
};

TEST_F(ControlGroups, TheLowestLimitOfAllThatContainAProcessHolds) {
    limit("a/memory.max", "3000");
    limit("a/b/memory.max", "max");
    limit("a/b/c/memory.max", "5000");
    limit("d/memory.max", "max");
    EXPECT_EQ(limit_of("0::/a/b/c\n"), 3000u);
    EXPECT_EQ(limit_of("0::/a/b\n"), 3000u);
    EXPECT_EQ(limit_of("0::/d\n"), kNone);
    EXPECT_EQ(limit_of("0::/\n"), kNone);
}

TEST_F(ControlGroups, OfVersion1AreThoseOfTheMemoryController) {
    limit("memory/job/step/memory.limit_in_bytes", "4000");
    limit("memory/memory.limit_in_bytes", "9223372036854771712");
    limit("cpu/job/memory.limit_in_bytes", "7");
    EXPECT_EQ(limit_of("5:cpu:/job\n4:hugetlb,memory:/job/step\n1:name=systemd:/x:y\n0::/\n"), 4000u);
    EXPECT_EQ(limit_of("4:memory:/another\n"), 9223372036854771712u);
}

TEST_F(ControlGroups, OfAnotherNamespaceOnlyTheOutermostIsSeen) {
    limit("memory.max", "6000");
    EXPECT_EQ(limit_of("0::/../outside\n"), 6000u);
    EXPECT_EQ(limit_of(""), kNone);
}

TEST(DefaultMemory, IsAtMostHalfOfWhatIsUsableAndAtMostAGibibyte) {
    for (const std::uint64_t usable : {std::uint64_t{200} << 20, std::uint64_t{3} << 30, std::uint64_t{1} << 40}) {
        EXPECT_LE(default_memory(usable), usable / 2);
        EXPECT_LE(default_memory(usable), std::uint64_t{1} << 30);
    }
    EXPECT_EQ(default_memory(std::uint64_t{2} << 30), std::uint64_t{1} << 30);
}

TEST(UsableMemory, IsThere) { EXPECT_GT(usable_memory(), std::uint64_t{1} << 20); }

}  // namespace
}  // namespace latent
