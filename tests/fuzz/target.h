// tests/fuzz/target.h: functions that take any bytes, and must end orderly whatever these are: without a crash, an undefined
// operation, a leak or an exception. fuzz_files_test and fuzz_scenes_test replay seeds and mutants of them; scripts/fuzz looks for
// more with libFuzzer.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/bytes.h"

namespace latent::fuzz {

struct Target {
    const char* name;
    bool (*run)(ByteSpan);  // whether they are what the target reads
    // Makes the checksums of a mutant right again, so that what is behind them is reached; null if there are none.
    void (*mend)(Bytes&);
    bool is_text;
    int mutants;                         // that the tests make of all seeds
    std::vector<Bytes> (*made_seeds)();  // beside those in seeds/NAME; null: none
};

// frames.cpp
Target header();
Target footer();
Target run();
Target page();
// files.cpp
Target file();
Target part();
// http_answers.cpp
Target http();
// c_api.cpp
Target arguments();
// recipes.cpp
Target recipe();
// pictures.cpp
Target exr();
Target icc();
// scenes.cpp
Target pbrt();
Target gltf();
Target obj();
Target ply();
// scene_files.cpp
Target picture();
Target spectrum();
Target measured();
// volumes.cpp
Target nanovdb();
// texts.cpp
Target csv();
Target expressions();

// Of a test program.
std::vector<Target> all_targets();

// A law of a target that does not hold ends the process.
void require(bool holds, const char* law);

// The bytes as a file of that name, in a folder of this process.
std::filesystem::path as_file(const std::string& name, ByteSpan bytes);

inline std::string_view text_of(ByteSpan bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

}  // namespace latent::fuzz
