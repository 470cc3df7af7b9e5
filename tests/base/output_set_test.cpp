#include "base/output_set.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <functional>

#include "tests/faults/process.h"

namespace latent {
namespace {

namespace fs = std::filesystem;

class OutputSetTest : public ::testing::Test {
 protected:
    testing::TemporaryFolder folder_;

    std::vector<OutputSet::Item> items() const { return {{folder_ / "tiles", true}, {folder_ / "page"}, {folder_ / "index"}}; }
    // A set whose items all hold `text`.
    Result<OutputSet> make(const std::string& text, bool replace) const {
        Result<OutputSet> set = OutputSet::create(items(), replace);
        if (!set) return set;
        fs::create_directory(set->place(0));
        for (const fs::path& file : {set->place(0) / "tile", set->place(1), set->place(2)}) std::ofstream(file) << text;
        return set;
    }
    Status publish(const std::string& text, bool replace) const {
        Result<OutputSet> set = make(text, replace);
        return set ? set->publish() : Status(set.error());
    }
    void expect_whole(const std::string& text) const {
        EXPECT_EQ(folder_.names(), (std::vector<std::string>{"index", "page", "tiles"}));
        expect_text(text);
    }
    void expect_text(const std::string& text) const {
        for (const fs::path& file : {folder_ / "tiles/tile", folder_ / "page", folder_ / "index"})
            EXPECT_EQ(testing::read_text(file), text) << file;
    }
    // In a child that is killed at the end of `work`.
    static void killed_after(const std::function<void()>& work) {
        const pid_t child = ::fork();
        if (child == 0) {
            work();
            ::raise(SIGKILL);
        }
        ASSERT_EQ(::waitpid(child, nullptr, 0), child);
    }
};

TEST_F(OutputSetTest, NothingHasANameBeforeAllHave) {
    {
        const Result<OutputSet> abandoned = make("never", false);
        ASSERT_TRUE(abandoned);
        EXPECT_EQ(folder_.names().size(), 1u);
        EXPECT_TRUE(folder_.names()[0].starts_with(".tiles."));
    }
    EXPECT_TRUE(folder_.names().empty());
    ASSERT_TRUE(publish("old", false));
    expect_whole("old");
    const Status refused = publish("new", false);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kExists);
    expect_whole("old");
    ASSERT_TRUE(publish("new", true));
    expect_whole("new");
}

TEST_F(OutputSetTest, ANameThatIsTakenMeanwhileCostsTheWholeSetAndNothingElse) {
    for (const char* taken : {"tiles", "page", "index"}) {
        SCOPED_TRACE(taken);
        {
            Result<OutputSet> set = make("new", false);
            ASSERT_TRUE(set);
            std::ofstream(folder_ / taken) << "somebody's";
            const Status refused = set->publish();
            ASSERT_FALSE(refused);
            EXPECT_EQ(refused.error().code, ErrorCode::kExists);
            EXPECT_NE(refused.error().message.find(taken), std::string::npos);
        }
        EXPECT_EQ(folder_.names(), std::vector<std::string>{taken});
        EXPECT_EQ(testing::read_text(folder_ / taken), "somebody's");
        fs::remove(folder_ / taken);
    }
    fs::create_directory(folder_ / "page");
    EXPECT_EQ(make("new", true).error().code, ErrorCode::kExists) << "a folder is no file that could be replaced";
}

TEST_F(OutputSetTest, WhatAKilledOneLeftIsRemovedByTheNextButNotWhatALivingOneHas) {
    killed_after([&] { static const Result<OutputSet> set = make("dead", false); });
    ASSERT_EQ(folder_.names().size(), 1u);
    fs::create_directory(folder_ / ".tiles.b.0123456789abcdef.tmp");  // of another set, "tiles.b"
    {
        Result<OutputSet> living = make("living", false);
        ASSERT_TRUE(living);
        EXPECT_EQ(folder_.names().size(), 2u);
        {
            const Result<OutputSet> another = make("another", false);
            ASSERT_TRUE(another);
            EXPECT_EQ(folder_.names().size(), 3u);
        }
        ASSERT_TRUE(living->publish());
    }
    fs::remove(folder_ / ".tiles.b.0123456789abcdef.tmp");
    expect_whole("living");
}

// Each rename fails once, as on a disk that breaks: the old set is whole again.
TEST_F(OutputSetTest, WhatCannotBeNamedLeavesTheOldSet) {
    ASSERT_TRUE(publish("old", false));
    for (std::size_t lost = 0; lost < 3; ++lost) {
        Result<OutputSet> set = make("new", true);
        ASSERT_TRUE(set);
        fs::remove_all(set->place(lost));
        EXPECT_EQ(set->publish().error().code, ErrorCode::kNotFound) << lost;
        expect_text("old");
    }
    expect_whole("old");
}

}  // namespace
}  // namespace latent
