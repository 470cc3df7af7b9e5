// Parts of a print that get more light or less: their closed form, and the picture around them.
#include "tools/convert/dodge.h"

#include <gmock/gmock.h>

#include <cmath>

#include "tests/convert/test_picture.h"

namespace latent::convert {
namespace {

class DodgePrint : public PrintTest {
 protected:
    // In stops, of each pixel: what the print has more than that without.
    std::vector<double> stops_of(const std::string& input, const std::vector<std::string>& dodges,
                                 ConvertOptions options = {}) const {
        options.replace = true;
        const std::vector<float> before = light(input, "before.exr", options);
        for (const std::string& text : dodges) options.dodges.push_back(*parse_dodge(text));
        const std::vector<float> after = light(input, "after.exr", options);
        std::vector<double> stops;
        for (std::size_t i = 0; i < before.size(); ++i)
            stops.push_back(std::log2(static_cast<double>(after[i]) / static_cast<double>(before[i])));
        return stops;
    }
};

double brush(double distance, double radius) { return std::pow(std::max(0.0, 1 - std::pow(distance / radius, 2)), 2); }

TEST_F(DodgePrint, StopsFollowTheirClosedForm) {
    write_picture(folder_ / "a.exr", {});
    const std::vector<double> place = stops_of("a.exr", {"brush:1.5,0.2,0.25,0.5"});
    const std::vector<double> line = stops_of("a.exr", {"brush:-2,0.1,0.25,0.5,0.75,0.5"});
    const std::vector<double> slope = stops_of("a.exr", {"gradient:-1,0.5,0,0.5,0.4"});
    const std::vector<double> all =
        stops_of("a.exr", {"brush:1.5,0.2,0.25,0.5", "brush:-2,0.1,0.25,0.5,0.75,0.5", "gradient:-1,0.5,0,0.5,0.4"});
    for (std::size_t i = 0; i < place.size(); ++i) {
        const std::size_t pixel = i % 60000;
        const double x = static_cast<double>(pixel % 300) + 0.5, y = static_cast<double>(pixel / 300) + 0.5;
        ASSERT_NEAR(place[i], 1.5 * brush(std::hypot(x - 75, y - 100), 60), 1e-6);
        ASSERT_NEAR(line[i], -2 * brush(std::hypot(x - std::clamp(x, 75.0, 225.0), y - 100), 30), 1e-6);
        const double t = std::min(1.0, y / 80);
        ASSERT_NEAR(slope[i], -(1 - t * t * (3 - 2 * t)), 1e-6);
        ASSERT_NEAR(all[i], place[i] + line[i] + slope[i], 2e-6);
    }
}

TEST_F(DodgePrint, APartIsThatOfTheWholeWhateverItsTilesAndItsDataWindow) {
    ConvertOptions options;
    options.replace = true;
    options.dodges = {*parse_dodge("brush:1,0.3,0.1,0.2,0.9,0.4"), *parse_dodge("gradient:-1,0,0,1,1")};
    write_picture(folder_ / "a.exr", {});
    write_picture(folder_ / "part.exr", {.window = {33, 21, 133, 71}, .tile = 32});
    const std::vector<float> whole = light("a.exr", "whole.exr", options), part = light("part.exr", "of-part.exr", options);
    options.crop = image::Rect{33, 21, 133, 71};
    EXPECT_EQ(light("a.exr", "crop.exr", options), part);
    for (std::size_t y = 0; y < 50; ++y) {
        for (std::size_t x = 0; x < 100; ++x) ASSERT_EQ(part[y * 100 + x], whole[(y + 21) * 300 + x + 33]);
    }
}

TEST_F(DodgePrint, LeavesTheExposureOfTheWholePrintAndWhatIsFarAway) {
    write_picture(folder_ / "a.exr", {});
    ConvertOptions options;
    options.auto_exposure = true;
    const double sigma = *print("a.exr", "plain.png", options)->auto_sigma;
    options.dodges = {*parse_dodge("gradient:-5,0.5,0,0.5,1")};
    const Result<ConvertReport> dodged = print("a.exr", "dodged.png", options);
    EXPECT_EQ(*dodged->auto_sigma, sigma);
    EXPECT_EQ(dodged->dodged, 1u);
    const std::vector<double> stops = stops_of("a.exr", {"brush:3,0.01,5,5", "brush:1,0.02,0.5,0.5"});
    EXPECT_EQ(std::ranges::count_if(stops, [](double s) { return s != 0; }) % 3, 0);
    EXPECT_EQ(stops[0], 0);
}

TEST(Dodge, WhatIsNoneIsRefused) {
    for (const char* bad :
         {"", "x", "brush", "brush:", "brush:1", "brush:1,0,0,0", "brush:1,-1,0,0", "brush:50,1,0,0", "brush:1,0.1,0.5",
          "brush:1,0.1,0.5,99", "brush:nan,1,0,0", "gradient:1,0,0,0,0", "gradient:1,0,0,1", "gradient:1,0,0,1,1,1"})
        EXPECT_FALSE(parse_dodge(bad)) << bad;
    EXPECT_EQ(parse_dodge("brush:1,0.1,0,0,1,1")->line.size(), 2u);
}

}  // namespace
}  // namespace latent::convert
