// Every target on its seeds, on bytes that once broke something, and on mutants of both: always the same ones.
// With --seeds FOLDER, the program writes the seeds, for scripts/fuzz to begin with.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <iostream>

#include "tests/faults/process.h"
#include "tests/fuzz/mutate.h"
#include "tests/fuzz/target.h"
#include "tests/support/paths.h"

namespace latent::fuzz {

void PrintTo(const Target& target, std::ostream* out) { *out << target.name; }

namespace {

namespace fs = std::filesystem;

Bytes bytes_of(const fs::path& file) {
    const std::string text = testing::read_text(file);
    Bytes bytes(text.size());
    std::memcpy(bytes.data(), text.data(), text.size());
    return bytes;
}

struct Seed {
    std::string name;
    Bytes bytes;
};

std::vector<Seed> seeds_of(const Target& target) {
    std::vector<Seed> seeds;
    std::vector<Bytes> made;
    if (target.made_seeds != nullptr) made = target.made_seeds();
    for (Bytes& bytes : made) seeds.push_back({"made " + std::to_string(seeds.size()), std::move(bytes)});
    std::vector<fs::path> files;
    const fs::path folder = fs::path(testing::in_tree("tests/fuzz/seeds")) / target.name;
    if (fs::exists(folder)) files.assign(fs::directory_iterator(folder), {});
    if (std::string_view(target.name) == "pbrt") {
        for (const char* scene : {"cornell", "conductors", "fog", "sodium"})
            files.emplace_back(testing::in_tree("scenes/" + std::string(scene) + ".pbrt"));
    }
    std::ranges::sort(files);
    for (const fs::path& path : files) seeds.push_back({path.filename().string(), bytes_of(path)});
    return seeds;
}

class Fuzz : public ::testing::TestWithParam<Target> {};

TEST_P(Fuzz, AnyBytesEndOrderly) {
    const Target& target = GetParam();
    const std::vector<Seed> seeds = seeds_of(target);
    ASSERT_FALSE(seeds.empty());
    // Seeds lead far into a target, but for bytes that once broke it.
    for (const Seed& seed : seeds) EXPECT_TRUE(target.run(seed.bytes) || seed.name.starts_with("once-broken")) << seed.name;
    EXPECT_FALSE(target.run({}));
    for (int i = 0; i < target.mutants; ++i) {
        const auto number = static_cast<std::uint64_t>(i);
        Bytes bytes = mutated(seeds[number % seeds.size()].bytes, number, target.is_text);
        if (target.mend != nullptr && number % 8 != 0) target.mend(bytes);
        SCOPED_TRACE(i);
        (void)target.run(bytes);
    }
}

INSTANTIATE_TEST_SUITE_P(Targets, Fuzz, ::testing::ValuesIn(all_targets()),
                         [](const auto& with) { return std::string(with.param.name); });

int write_seeds(const fs::path& folder) {
    for (const Target& target : all_targets()) {
        fs::create_directories(folder / target.name);
        int number = 0;
        for (const auto& [name, bytes] : seeds_of(target)) {
            std::ofstream out(folder / target.name / ("seed" + std::to_string(number++)), std::ios::binary);
            out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
            if (!out.flush()) return 1;
        }
        std::cout << target.name << '\n';
    }
    return 0;
}

}  // namespace
}  // namespace latent::fuzz

int main(int argc, char** argv) {
    if (argc == 3 && std::string_view(argv[1]) == "--seeds") return latent::fuzz::write_seeds(argv[2]);
    ::testing::InitGoogleTest(&argc, argv);
    return RUN_ALL_TESTS();
}
