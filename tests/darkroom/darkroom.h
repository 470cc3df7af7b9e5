// tests/darkroom/darkroom.h: scenes that are rendered, developed and read back, as users do it.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "color/observer.h"
#include "color/spectrum.h"
#include "tests/faults/process.h"

namespace latent::testing {

// The channels of an EXR.
struct Picture {
    int width = 0, height = 0;
    std::map<std::string, std::vector<float>> channels;
    float at(const std::string& channel, int x, int y) const {
        return channels.at(channel)[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
    }
};
Picture read_exr(const std::filesystem::path& path);

// Mean and standard error of a channel over the pixels x0 .. x1-1, y0 .. y1-1.
struct Mean {
    double value = 0, error = 0;
};
Mean mean_of(const Picture& picture, const std::string& channel, int x0, int y0, int x1, int y1);

class Darkroom : public ::testing::Test {
 protected:
    TemporaryFolder folder_;

    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    // NAME.latent of a scene's text.
    std::string render(const std::string& name, const std::string& scene, const std::vector<std::string>& options) const;
    // Expects status 0; what was printed goes to `outcome`.
    Picture develop(const std::string& file, const std::vector<std::string>& options, Outcome* outcome = nullptr) const;
};

// "spectrum NAME" [ ... ] of pbrt.
std::string spectrum_parameter(const std::string& name, const color::Spectrum& spectrum);

// A wall that fills the film of 6 x 4 units exactly, one unit square for each of 24 reflectances, and these lights.
std::string wall(const std::vector<color::Spectrum>& reflectances, const std::string& lights);

// A light so far away that all of the wall is lit alike, at right angles: radiance of a white wall is that of `spectrum`, with Y
// = 1.
std::string distant_light(const std::string& spectrum, double scale);

// What an observer sees of a patch under a light of Y = 1.
color::Xyz seen(const color::Spectrum& patch, const color::Spectrum& light, const color::Observer& observer);

}  // namespace latent::testing
