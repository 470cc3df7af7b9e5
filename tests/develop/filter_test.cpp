#include "tools/develop/film/filter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "tools/develop/film/border.h"

namespace latent::develop {
namespace {

Filter filter(const char* text) {
    Result<Filter> f = Filter::parse(text);
    EXPECT_TRUE(f) << text << ": " << f.error().message;
    return *f;
}

double mitchell(double x, double b, double c) {
    x = std::abs(x);
    if (x < 1) return ((12 - 9 * b - 6 * c) * x * x * x + (-18 + 12 * b + 6 * c) * x * x + (6 - 2 * b)) / 6;
    if (x < 2) return ((-b - 6 * c) * x * x * x + (6 * b + 30 * c) * x * x + (-12 * b - 48 * c) * x + (8 * b + 24 * c)) / 6;
    return 0;
}
double quartic(double r, double s, double radius) {
    const double rho = r / radius;
    return rho < 1 ? (1 - rho) * (1 - rho) * (1 + 2 * rho + s * rho * rho) : 0;
}
double jinc(double x) { return x == 0 ? 1 : 2 * std::cyl_bessel_j(1, std::numbers::pi * x) / (std::numbers::pi * x); }

TEST(Filter, WeightsAreTheDefinitions) {
    const struct {
        const char* text;
        std::function<double(double, double)> definition;
    } filters[] = {
        {"quartic", [](double x, double y) { return quartic(std::hypot(x, y), -3, 1.5); }},
        {"quartic:-5,2", [](double x, double y) { return quartic(std::hypot(x, y), -5, 2); }},
        {"quartic:-6,3", [](double x, double y) { return quartic(std::hypot(x, y), -6, 3); }},
        {"quartic:-5.3,1.7", [](double x, double y) { return quartic(std::hypot(x, y), -5.3, 1.7); }},
        {"mitchell", [](double x, double y) { return mitchell(std::hypot(x, y), 1.0 / 3, 1.0 / 3); }},
        {"mitchell:0.2,0.4", [](double x, double y) { return mitchell(std::hypot(x, y), 0.2, 0.4); }},
        {"mitchell-separable", [](double x, double y) { return mitchell(x, 1.0 / 3, 1.0 / 3) * mitchell(y, 1.0 / 3, 1.0 / 3); }},
        {"gaussian", [](double x, double y) { return std::max(0.0, std::exp(-2 * (x * x + y * y)) - std::exp(-2 * 2.25)); }},
        {"gaussian:0.6,2.4",
         [](double x, double y) { return std::max(0.0, std::exp(-(x * x + y * y) / 0.72) - std::exp(-5.76 / 0.72)); }},
        {"lanczos",
         [](double x, double y) {
             const double r = std::hypot(x, y), edge = 3.2383154841662362;
             return r < edge ? jinc(r) * jinc(1.2196698912665045 * r / edge) : 0;
         }},
        {"box", [](double x, double y) { return x > -0.5 && x <= 0.5 && y > -0.5 && y <= 0.5 ? 1.0 : 0.0; }},
    };
    for (const auto& [text, definition] : filters) {
        SCOPED_TRACE(text);
        const Filter f = filter(text);
        const double reach = f.reach() + 0.25;
        for (double y = -reach; y <= reach; y += 0.0313) {
            for (double x = -reach; x <= reach; x += 0.0317) {  // tables are linear between 16384 steps; parameters are float32
                ASSERT_NEAR(f.weight(x, y), definition(x, y), 5e-7) << x << ' ' << y;
            }
        }
    }
}

TEST(Filter, NamesReadBackAsThemselves) {
    for (const char* text : {"quartic:-5,2", "quartic:-6.25,3", "mitchell:0.25,0.5", "mitchell-separable:0.333333,0.333333",
                             "gaussian:0.5,1.5", "lanczos", "box"}) {
        EXPECT_EQ(filter(text).name(), text);
    }
    EXPECT_EQ(Filter::standard().name(), "quartic:-3,1.5");
}

TEST(Filter, NoWeightOfTheStandardIsNegative) {
    for (const char* text : {"quartic", "quartic:-3,2", "quartic:-3,7.3", "quartic:0,2"}) {
        const Filter f = filter(text);
        EXPECT_FALSE(f.kernel().has_negative_lobes) << text;
        for (double r = 0; r <= f.reach() + 0.1; r += 1e-4) ASSERT_GE(f.weight(r, 0), 0) << text << " at " << r;
    }
    EXPECT_TRUE(filter("quartic:-3.01,1.5").kernel().has_negative_lobes);
}

TEST(Filter, RefusesWhatCannotBeNormalised) {
    for (const char* text :
         {"quartic:-9", "quartic:-12,3", "quartic:-5,0", "quartic:-5,0.6", "quartic:-5,9", "gaussian:0,2", "gaussian:0.5,-1",
          "sinc", "box:1", "quartic:nan", "quartic:-5,2,1", "quartic:", "quartic:x", "", "gaussian:0.5,0.5"}) {
        const Result<Filter> f = Filter::parse(text);
        ASSERT_FALSE(f) << text;
        EXPECT_EQ(f.error().code, ErrorCode::kUsage);
    }
    EXPECT_TRUE(filter("quartic:-7.5,2").warning());
    EXPECT_FALSE(filter("quartic:-7,2").warning());
}

// F(q) by brute force: the midpoint rule over all positions on the film, filters given by their definitions.
double light_share_by_midpoints(const std::function<double(double, double)>& w, int reach, int width, int height, int x, int y,
                                int steps) {
    double total = 0;
    for (int i = 0; i < steps; ++i) {
        for (int j = 0; j < steps; ++j) {
            const double s = (i + 0.5) / steps, t = (j + 0.5) / steps;  // the same place in every pixel
            double lattice = 0, here = 0;
            for (int py = -reach - 1; py <= reach + 1; ++py) {
                for (int px = -reach - 1; px <= reach + 1; ++px) {
                    const double weight = w(px + 0.5 - s, py + 0.5 - t);
                    lattice += weight;
                    // the record in pixel (x - px, y - py) sees pixel (x, y) at this distance
                    if (x - px >= 0 && x - px < width && y - py >= 0 && y - py < height) here += weight;
                }
            }
            total += here / lattice;
        }
    }
    return total / steps / steps;
}

TEST(BorderShare, AgreesWithQuadratureAtCornersEdgesAndOnTinyFilms) {
    const auto check = [](const char* text, const std::function<double(double, double)>& w) {
        SCOPED_TRACE(text);
        const Filter f = filter(text);
        for (const auto& [width, height] : {std::pair{9, 7}, {2, 3}, {1, 1}, {64, 1}}) {
            const BorderShare share(f, width, height);
            for (int y = 0; y < height; y += 2) {
                for (int x = 0; x < std::min(width, 5); ++x) {
                    EXPECT_NEAR(share.light_share(x, y), light_share_by_midpoints(w, f.reach(), width, height, x, y, 150), 2e-5)
                        << width << 'x' << height << " at " << x << ' ' << y;
                }
            }
        }
    };
    check("quartic", [](double x, double y) { return quartic(std::hypot(x, y), -3, 1.5); });
    check("quartic:-5,2", [](double x, double y) { return quartic(std::hypot(x, y), -5, 2); });
    check("gaussian", [](double x, double y) { return std::max(0.0, std::exp(-2 * (x * x + y * y)) - std::exp(-4.5)); });
    check("mitchell-separable", [](double x, double y) { return mitchell(x, 1.0 / 3, 1.0 / 3) * mitchell(y, 1.0 / 3, 1.0 / 3); });
}

TEST(BorderShare, SplatsOnTheFilmGiveWhatTheyDoNotLoseOverItsBorder) {
    // Summed over all pixels, F is the number of pixels less what falls outside; inside it is 1 exactly.
    for (const char* text : {"quartic", "lanczos", "mitchell", "box", "gaussian:0.8,3"}) {
        const Filter f = filter(text);
        const BorderShare share(f, 40, 30);
        EXPECT_EQ(share.light_share(20, 15), 1.0);
        const BorderShare one(f, 1, 1);
        if (std::string_view(text) == "box") {
            EXPECT_NEAR(share.light_share(0, 0), 1.0, 1e-12);
            EXPECT_NEAR(one.light_share(0, 0), 1.0, 1e-12);
        } else {
            EXPECT_LT(one.light_share(0, 0), 1.0);
        }
        // The integral of a radial filter, and of a box.
        EXPECT_NEAR(share.camera_share(20, 15), share.camera_share(10, 20), 0);
    }
    EXPECT_NEAR(BorderShare(filter("quartic:-5,2"), 99, 99).camera_share(50, 50), 8 * std::numbers::pi * (0.15 - 5.0 / 60), 1e-6);
    EXPECT_NEAR(BorderShare(filter("mitchell-separable"), 99, 99).camera_share(50, 50), 1.0, 1e-6);
}

}  // namespace
}  // namespace latent::develop
