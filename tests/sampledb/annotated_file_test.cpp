// The annotated file of docs/format.md is a file.
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "sampledb/read/file_reader.h"
#include "tests/faults/process.h"
#include "tests/support/paths.h"

namespace latent::sampledb {
namespace {

namespace fs = std::filesystem;

const fs::path kPage = latent::testing::in_tree("docs/format.md");

std::size_t hexadecimal(const std::string& digits) { return std::stoull(digits, nullptr, 16); }

// The block ```NAME of the page.
std::string block_of_the_page(const std::string& name) {
    const std::string page = testing::read_text(kPage), begin = "\n```" + name + "\n";
    const std::size_t at = page.find(begin) + begin.size();
    return page.substr(at, page.find("\n```\n", at) + 1 - at);
}

// The bytes that an annotated file spells out: "OFFSET  BYTES  meaning", or "OFFSET  ... WHAT up to OFFSET".
Bytes bytes_of_the_dump(const std::string& dump) {
    Bytes file;
    std::size_t run = 0, footer = 0;
    std::istringstream lines(dump);
    std::string line;
    std::getline(lines, line);  // the heading
    while (std::getline(lines, line)) {
        EXPECT_EQ(hexadecimal(line.substr(0, 6)), file.size()) << line;
        if (line.find(" run: ") != std::string::npos) run = file.size();
        if (line.find(" footer: ") != std::string::npos) footer = file.size();
        if (line.substr(8, 3) != "...") {
            std::istringstream tokens(line.substr(8, 23));
            for (std::string token; tokens >> token;) file.push_back(static_cast<std::byte>(hexadecimal(token)));
            continue;
        }
        const std::size_t size = hexadecimal(line.substr(line.size() - 6)) - file.size();
        const auto copy_from = [&](std::size_t at) {
            for (std::size_t i = 0; i < size; ++i) file.push_back(file[at + i]);
        };
        if (line.find("zero") != std::string::npos) {
            file.resize(file.size() + size);
        } else if (line.find("the same again") != std::string::npos) {
            copy_from(0);
        } else if (line.find("entry of run 0") != std::string::npos) {
            copy_from(run + 8);
        } else {
            EXPECT_NE(line.find("of the footer again"), std::string::npos) << line;
            copy_from(footer);
        }
    }
    return file;
}

TEST(Specification, ItsAnnotatedFileIsTheOneThatTheWriterInPythonWrites) {
    const testing::TemporaryFolder folder;
    const fs::path path = folder / "smallest.latent";
    ASSERT_EQ(testing::run_python("tests/sampledb/write_latent.py", {"smallest", path.string()}).status, 0);
    const std::string dump = block_of_the_page("dump");
    EXPECT_EQ(testing::run_python("tests/sampledb/annotate_latent.py", {path.string()}).out, dump);

    const Bytes bytes = bytes_of_the_dump(dump);
    const std::string file = testing::read_text(path);
    EXPECT_TRUE(std::ranges::equal(bytes, std::as_bytes(std::span(file))));
    const Result<FileContents> contents = read_file(MemorySource(bytes, "dump"), VerifyLevel::kFull);
    ASSERT_TRUE(contents) << contents.error().message;
    EXPECT_TRUE(contents->finished);
    EXPECT_TRUE(contents->damage.empty());
    EXPECT_EQ(contents->runs.size(), 1u);
}

}  // namespace
}  // namespace latent::sampledb
