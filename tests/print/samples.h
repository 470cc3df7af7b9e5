// tests/print/samples.h: a small render that has everything to decide about: lights, wavelengths, layers.
#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "tests/faults/process.h"

namespace latent::testing {

class Samples : public ::testing::Test {
 protected:
    static void SetUpTestSuite() {
        folder_ = new TemporaryFolder;
        std::ofstream(path("scene.pbrt")) << R"(Film "rgb" "integer xresolution" 300 "integer yresolution" 200
LookAt 0 0 -3  0 0 0  0 1 0
Camera "perspective" "float fov" 40
WorldBegin
LightSource "infinite" "string name" "sky" "rgb L" [ 0.3 0.4 0.6 ]
LightSource "point" "string name" "lamp" "rgb I" [ 9 6 3 ] "point3 from" [ 2 2 -2 ]
Material "diffuse" "rgb reflectance" [ 0.2 0.6 0.3 ]
Shape "sphere" "float radius" 0.8
)";
        const Outcome rendered = run({tool("latent-render"), path("scene.pbrt"), "-o", path("a.latent"), "--samples", "0:131072",
                                      "--run-samples", "32768", "--light-groups", "--quiet"});
        ASSERT_EQ(rendered.status, 0) << rendered.err;
    }
    static void TearDownTestSuite() {
        delete folder_;
        folder_ = nullptr;
    }

    static std::string path(const std::string& name) { return (*folder_ / name).string(); }
    static std::string write(const std::string& name, const std::string& text) {
        std::ofstream(path(name), std::ios::binary) << text;
        return path(name);
    }
    static std::string bytes_of(const std::string& name) {
        std::ifstream file(path(name), std::ios::binary);
        return {std::istreambuf_iterator<char>(file), {}};
    }
    static std::vector<std::string> with(std::vector<std::string> a, const std::vector<std::string>& b) {
        a.insert(a.end(), b.begin(), b.end());
        return a;
    }
    // Names of files in `options` are in full.
    static Outcome use(const std::string& program, const std::string& input, std::vector<std::string> options) {
        options.insert(options.begin(), {tool(program), path(input), "--quiet", "--force"});
        return run(options);
    }
    static void make(const std::string& program, const std::string& input, const std::vector<std::string>& options) {
        const Outcome outcome = use(program, input, options);
        ASSERT_EQ(outcome.status, 0) << outcome.err;
    }

    static inline TemporaryFolder* folder_ = nullptr;
};

}  // namespace latent::testing
