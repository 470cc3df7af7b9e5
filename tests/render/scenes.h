// tests/render/scenes.h: scenes written on the spot, for tests.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "render/load_scene.h"

namespace latent::render::testing {

// A folder of its own for the running test, gone with it.
class Folder {
 public:
    Folder() : path_(std::filesystem::path(::testing::TempDir()) / name()) {
        std::filesystem::remove_all(path_);
        std::filesystem::create_directories(path_);
    }
    ~Folder() { std::filesystem::remove_all(path_); }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;

    std::filesystem::path write(const std::string& file, const std::string& text) const {
        std::ofstream(path_ / file, std::ios::binary) << text;
        return path_ / file;
    }
    const std::filesystem::path& path() const { return path_; }

 private:
    static std::string name() {
        const ::testing::TestInfo* test = ::testing::UnitTest::GetInstance()->current_test_info();
        return std::string("latent-") + test->test_suite_name() + "-" + test->name() + "-" + std::to_string(::getpid());
    }
    std::filesystem::path path_;
};

// Loads `text` as room.pbrt.
inline Result<LoadedScene> load(const std::string& text) {
    const Folder folder;
    return load_scene(folder.write("room.pbrt", text));
}
// The same with WorldBegin in front.
inline Result<LoadedScene> load_world(const std::string& text) { return load("WorldBegin\n" + text); }

// The message of a scene that is refused; empty, and a failure, if it is not.
inline std::string refusal(const std::string& text) {
    const Result<LoadedScene> scene = load(text);
    if (!scene) return scene.error().message;
    ADD_FAILURE() << "was accepted:\n" << text;
    return "";
}

}  // namespace latent::render::testing
