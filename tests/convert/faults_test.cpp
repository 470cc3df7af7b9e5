// Disks that fail while a print is written: exit 1, the file is named, nothing is left of it.
#include <map>

#include "tests/convert/test_picture.h"

namespace latent::convert {
namespace {

class PrintFaults : public PrintTest {
 protected:
    void SetUp() override { write_picture(folder_ / "a.exr", {300, 280, {}, 64}); }

    // Whatever a print has left; the picture and prints called "good" stay.
    void remove_outputs() const {
        for (const std::string& name : folder_.names()) {
            if (name.starts_with('o')) std::filesystem::remove_all(folder_ / name);
        }
    }

    std::vector<std::string> command(const std::string& output) const {
        return {testing::tool("latent-convert"), at("a.exr"), "-o", at(output), "--pyramid", "--threads", "2"};
    }
};

// Each call of a kind fails in turn, until the last one has had its turn.
TEST_F(PrintFaults, WhicheverWriteFailsTheFileIsNamedAndNothingIsLeft) {
    for (const std::string output : {"o.png", "o.tif", "o.jpg", "o.exr", "o.dzi"}) {
        for (const std::string fault : {"write:#:ENOSPC", "create:#:EACCES", "link:#:EROFS"}) {
            int met = 0;
            for (int n = 1; n <= 200; n += fault[0] == 'w' ? 1 + n / 3 : 1 + n / 2) {
                std::string rule = fault;
                rule.replace(rule.find('#'), 1, std::to_string(n));
                SCOPED_TRACE(output + " " + rule);
                const testing::FaultOutcome outcome = testing::run_with_fault(command(output), {rule, folder_.path().string()});
                if (!outcome.happened) break;
                if (outcome.status == 0) {  // a file without a name could not be had, so it got one
                    remove_outputs();
                    EXPECT_EQ(fault[0], 'c');
                    continue;
                }
                ++met;
                EXPECT_EQ(outcome.status, 1);
                EXPECT_NE(outcome.err.find(at("o")), std::string::npos) << outcome.err;
                EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
                ASSERT_EQ(folder_.names(), std::vector<std::string>{"a.exr"});
            }
            EXPECT_TRUE(met > 0 || fault[0] == 'c') << output << " " << fault;
            remove_outputs();
        }
    }
}

TEST_F(PrintFaults, OutputsThatHaveTheirNamesAlreadyAreNamed) {
    const std::vector<std::string> print = {
        testing::tool("latent-convert"), at("a.exr"), "-o", at("o1.jpg"), "-o", at("o2.png"), "-o", at("o3.tif")};
    const testing::FaultOutcome outcome = testing::run_with_fault(print, {"link:3:EIO", folder_.path().string()});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_TRUE(outcome.err.find(at("o3.tif")) < outcome.err.find("complete and in place: " + at("o1.jpg") + ", " + at("o2.png")))
        << outcome.err;
    EXPECT_EQ(folder_.names(), (std::vector<std::string>{"a.exr", "o1.jpg", "o2.png"}));
    EXPECT_EQ(image::decode_png(folder_ / "o2.png").pixels.size(), 300u * 280 * 3);
}

// The file has its name when its folder fails: it says that it is complete.
TEST_F(PrintFaults, AFolderThatCannotBeSyncedCostsNoOutput) {
    const std::vector<std::string> print = {testing::tool("latent-convert"), at("a.exr"), "-o", at("o.png")};
    const testing::FaultOutcome outcome = testing::run_with_fault(print, {"sync:2:EIO", folder_.path().string()});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_NE(outcome.err.find(at("o.png") + ": complete and in place, but "), std::string::npos) << outcome.err;
    EXPECT_EQ(folder_.names(), (std::vector<std::string>{"a.exr", "o.png"}));
}

// SIGTERM comes with a call, with and without files that have no name.
TEST_F(PrintFaults, ASignalLeavesNothingOrAllOutputs) {
    const std::vector<std::string> print = {testing::tool("latent-convert"), at("a.exr"), "-o", at("o.dzi"), "-o", at("o.png")};
    for (const std::string rule : {"write:1:term", "write:9:term", "create:6:term", "create:3:EROFS,write:9:term"}) {
        const testing::FaultOutcome outcome = testing::run_with_fault(print, {rule, folder_.path().string()});
        EXPECT_TRUE(outcome.happened) << rule;
        EXPECT_EQ(outcome.status, 128 + SIGTERM) << rule << outcome.err;
        EXPECT_EQ(outcome.err, "");
        EXPECT_EQ(folder_.names(), std::vector<std::string>{"a.exr"}) << rule;
    }
    // While they get their names, one after another, the signal waits.
    for (const std::string rule : {"link:1:term", "link:2:term", "link:4:term"}) {
        const testing::FaultOutcome outcome = testing::run_with_fault(print, {rule, folder_.path().string()});
        EXPECT_TRUE(outcome.happened) << rule;
        EXPECT_EQ(folder_.names(), (std::vector<std::string>{"a.exr", "o.dzi", "o.html", "o.png", "o_files"})) << rule;
        remove_outputs();
    }
}

// SIGKILL with every call that makes, names or removes something: what has the output's name is whole, the old or the new one, and
// the next print with --force replaces or removes all that is left.
TEST_F(PrintFaults, WhereverAPrintIsKilledTheNextOneLeavesNothingOfIt) {
    write_picture(folder_ / "a.exr", {40, 30});
    const auto contents = [&] {
        std::map<std::string, std::string> files;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_.path())) {
            const std::string name = std::filesystem::relative(entry.path(), folder_.path());
            if (name != "a.exr" && entry.is_regular_file()) files[name] = testing::read_text(entry.path());
        }
        return files;
    };
    for (const std::string output : {"o.dzi", "o.png"}) {
        const std::vector<std::string> print = {testing::tool("latent-convert"), at("a.exr"), "-o", at(output), "--threads", "2"};
        const auto with = [&](const std::vector<std::string>& more) {
            std::vector<std::string> command = print;
            command.insert(command.end(), more.begin(), more.end());
            return command;
        };
        ASSERT_EQ(testing::run(print).status, 0);
        const auto wanted = contents();
        ASSERT_EQ(wanted.contains("o_files/6/0_0.jpg"), output == "o.dzi");
        int killed = 0;
        for (const bool force : {false, true}) {
            for (const std::string call : {"create", "mkdir", "link", "unlink", "lock"}) {
                for (const std::string way : {":kill", ":kill-after"}) {
                    if (call != "link" && way != ":kill") continue;
                    for (int n = 1; n <= 100; n += call == "link" || n < 4 ? 1 : 3) {
                        const std::string rule = call + ":" + std::to_string(n) + way;
                        SCOPED_TRACE(output + (force ? " --force " : " ") + rule);
                        remove_outputs();
                        std::map<std::string, std::string> old;
                        if (force) {
                            ASSERT_EQ(testing::run(with({"--sensitivity", "9"})).status, 0);
                            old = contents();
                        }
                        const std::vector<std::string> command =
                            with(force ? std::vector<std::string>{"--force"} : std::vector<std::string>{});
                        const testing::FaultOutcome outcome = testing::run_with_fault(command, {rule, folder_.path().string()});
                        if (outcome.status != 128 + SIGKILL) {
                            EXPECT_FALSE(outcome.happened && way == ":kill");
                            EXPECT_EQ(outcome.status, 0) << outcome.err;
                            break;
                        }
                        ++killed;
                        auto left = contents();
                        std::erase_if(left, [](const auto& file) { return file.first[0] == '.'; });
                        if (left.contains(output)) {
                            EXPECT_TRUE(left == wanted || left == old);
                        }
                        const testing::Outcome again = testing::run(with({"--force"}));
                        EXPECT_EQ(again.status, 0) << again.err;
                        EXPECT_TRUE(contents() == wanted);
                        for (const std::string& name : folder_.names()) EXPECT_NE(name[0], '.') << name;
                    }
                }
            }
        }
        EXPECT_GT(killed, output == "o.dzi" ? 40 : 5);
        remove_outputs();
    }
}

// The names are all of one print or all of the other, whichever is slow where.
TEST_F(PrintFaults, AReadErrorNamesTheInput) {
    for (const char* rule : {"read:1:EIO", "read:3:EIO", "read:9:EIO", "read:5+:EIO"}) {
        const testing::FaultOutcome outcome = testing::run_with_fault(command("o.png"), {rule, "a.exr"});
        EXPECT_TRUE(outcome.happened);
        EXPECT_EQ(outcome.status, 1);
        EXPECT_NE(outcome.err.find("a.exr"), std::string::npos) << outcome.err;
        EXPECT_NE(outcome.err.find("Input/output error"), std::string::npos) << outcome.err;
        EXPECT_EQ(folder_.names(), std::vector<std::string>{"a.exr"});
    }
}

TEST_F(PrintFaults, ShortTransfersAndInterruptionsChangeNothing) {
    for (const std::string output : {"o.png", "o.tif", "o.jpg", "o.exr", "o.dzi"}) {
        ASSERT_EQ(testing::run(command("good." + output)).status, 0);
        for (const std::string rule : {"write:1+:short", "write:1:EINTR", "read:1+:short"}) {
            const testing::FaultOutcome outcome = testing::run_with_fault(command(output), {rule, folder_.path().string()});
            EXPECT_EQ(outcome.status, 0) << rule << outcome.err;
            EXPECT_TRUE(outcome.happened);
            EXPECT_TRUE(testing::read_text(folder_ / output) == testing::read_text(folder_ / ("good." + output))) << output << rule;
            remove_outputs();
        }
    }
}

TEST_F(PrintFaults, AFullDiskIsReportedByEveryFormat) {
    const testing::SmallDisk disk(64 << 10);
    if (!disk.mounted()) GTEST_SKIP() << "mounting a tmpfs is not permitted here";
    for (const std::string output : {"o.png", "o.tif", "o.jpg", "o.exr", "o.dzi"}) {
        const testing::Outcome outcome =
            testing::run({testing::tool("latent-convert"), at("a.exr"), "-o", disk / output, "--quality", "100"});
        EXPECT_EQ(outcome.status, 1) << output;
        EXPECT_NE(outcome.err.find((disk / "o").string()), std::string::npos) << outcome.err;
        EXPECT_NE(outcome.err.find("No space left on device"), std::string::npos) << outcome.err;
        EXPECT_TRUE(disk.names().empty()) << output;
    }
}

}  // namespace
}  // namespace latent::convert
