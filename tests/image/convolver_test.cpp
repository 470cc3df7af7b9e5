// Fourier transforms against their definition, and light that spreads against plain sums.
#include "image/convolver.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>

#include "base/simd_dispatch.h"
#include "image/fourier.h"
#include "image/kernel.h"

namespace latent::image {
namespace {

std::vector<float> random_plane(std::size_t count, unsigned seed) {
    std::mt19937 generator(seed);
    std::uniform_real_distribution<float> uniform(0, 1);
    std::vector<float> plane(count);
    for (float& v : plane) v = uniform(generator);
    return plane;
}

TEST(Fourier, IsTheSumOfItsDefinitionAndComesBack) {
    for (const int size : {16, 32}) {
        const SquareFourier fourier(size);
        const auto n = static_cast<std::size_t>(size);
        const std::vector<float> a = random_plane(n * n, 1), b = random_plane(n * n, 2);
        std::vector<float> re = a, im = b;
        fourier.forward(re.data(), im.data());
        for (std::size_t row = 0; row < n; row += 3) {
            for (std::size_t column = 0; column < n; column += 5) {
                const int v = fourier.frequency(static_cast<int>(row)), u = fourier.frequency(static_cast<int>(column));
                std::complex<double> sum;
                for (std::size_t y = 0; y < n; ++y) {
                    for (std::size_t x = 0; x < n; ++x) {
                        const double turns = static_cast<double>((static_cast<int>(y) * v + static_cast<int>(x) * u) % size) / size;
                        sum += std::complex<double>(a[y * n + x], b[y * n + x]) * std::polar(1.0, -2 * std::numbers::pi * turns);
                    }
                }
                EXPECT_NEAR(re[row * n + column], sum.real(), 1e-6 * size * size);
                EXPECT_NEAR(im[row * n + column], sum.imag(), 1e-6 * size * size);
                EXPECT_EQ((fourier.frequency(SquareFourier::negative(static_cast<int>(column))) + u) % size, 0);
            }
        }
        fourier.inverse(re.data(), im.data());
        for (std::size_t i = 0; i < n * n; ++i) {
            ASSERT_NEAR(re[i], a[i] * static_cast<float>(size * size), 1e-6 * size * size);
            ASSERT_NEAR(im[i], b[i] * static_cast<float>(size * size), 1e-6 * size * size);
        }
    }
}

TEST(Fourier, IsTheSameWithEveryInstructionSet) {
    const SquareFourier fourier(64);
    const std::vector<float> a = random_plane(64 * 64, 1), b = random_plane(64 * 64, 2);
    std::vector<float> expected_re, expected_im;
    const std::int64_t all = simd_targets() & HWY_TARGETS;
    for (std::int64_t left = all; left != 0; left &= left - 1) {
        use_simd_targets(left & -left);
        std::vector<float> re = a, im = b;
        fourier.forward(re.data(), im.data());
        if (expected_re.empty()) {
            expected_re = re;
            expected_im = im;
        }
        EXPECT_EQ(re, expected_re);
        EXPECT_EQ(im, expected_im);
    }
    use_simd_targets(simd_targets());
}

// Another one for each channel; adds up to less than 1.
Kernel symmetric_kernel(int radius) {
    Kernel kernel(radius);
    const int side = 2 * radius + 1;
    for (std::size_t c = 0; c < 3; ++c) {
        const std::vector<float> random = random_plane(static_cast<std::size_t>(side * side), static_cast<unsigned>(c + 5));
        for (int y = -radius; y <= radius; ++y) {
            for (int x = -radius; x <= radius; ++x) {
                const int i = (y + radius) * side + x + radius, j = side * side - 1 - i;
                kernel.set(c, x, y,
                           (random[static_cast<std::size_t>(i)] + random[static_cast<std::size_t>(j)]) * 0.3F /
                               static_cast<float>(side * side));
            }
        }
    }
    return kernel;
}

// All of a picture, tile by tile.
std::vector<float> spread(const Convolver& convolver, std::size_t channel, const std::vector<float>& light) {
    const Rect& picture = convolver.picture();
    const auto size = static_cast<std::size_t>(convolver.size());
    std::vector<float> out(picture.pixels());
    const auto index = [&](int x, int y) {
        return static_cast<std::size_t>(y - picture.y0) * static_cast<std::size_t>(picture.width()) +
               static_cast<std::size_t>(x - picture.x0);
    };
    for (int y0 = picture.y0; y0 < picture.y1; y0 += convolver.step()) {
        for (int x0 = picture.x0; x0 < picture.x1; x0 += convolver.step()) {
            const Rect seen{x0 - convolver.margin(), y0 - convolver.margin(), x0 - convolver.margin() + convolver.size(),
                            y0 - convolver.margin() + convolver.size()};
            Convolver::Planes planes;
            for (auto& plane : planes) plane.assign(size * size, 0.0F);
            const Rect there = intersect(seen, picture);
            for (int y = there.y0; y < there.y1; ++y) {
                for (int x = there.x0; x < there.x1; ++x)
                    planes[channel][static_cast<std::size_t>(y - seen.y0) * size + static_cast<std::size_t>(x - seen.x0)] =
                        Convolver::usable(light[index(x, y)]);
            }
            const Rect tile = intersect(picture, {x0, y0, x0 + convolver.step(), y0 + convolver.step()});
            convolver.spread(planes, [&](std::size_t c, const float* gained) {
                if (c != channel) return;
                for (int y = tile.y0; y < tile.y1; ++y)
                    convolver.join(
                        c, tile.x0, y, {&light[index(tile.x0, y)], static_cast<std::size_t>(tile.width())},
                        gained + static_cast<std::size_t>(y - seen.y0) * size + static_cast<std::size_t>(tile.x0 - seen.x0),
                        &out[index(tile.x0, y)]);
            });
        }
    }
    return out;
}

TEST(Convolver, GivesEachPixelWhatItsNeighboursSendAndKeepsWhatWouldLeave) {
    const Kernel kernel = symmetric_kernel(6);
    for (const Rect picture : {Rect{-7, 3, 60, 50}, Rect{0, 0, 5, 3}, Rect{0, 0, 300, 20}}) {
        const Convolver convolver(kernel, picture);
        const std::vector<float> light = random_plane(picture.pixels(), 9);
        for (std::size_t c = 0; c < 3; ++c) {
            const std::vector<float> out = spread(convolver, c, light);
            double before = 0, after = 0;
            for (int y = 0; y < picture.height(); ++y) {
                for (int x = 0; x < picture.width(); ++x) {
                    const auto at = [&](int px, int py) { return light[static_cast<std::size_t>(py * picture.width() + px)]; };
                    double kept = 1, gained = 0;
                    for (int dy = -6; dy <= 6; ++dy) {
                        for (int dx = -6; dx <= 6; ++dx) {
                            if ((dx == 0 && dy == 0) || x + dx < 0 || y + dy < 0 || x + dx >= picture.width() ||
                                y + dy >= picture.height())
                                continue;
                            const double weight = static_cast<double>(kernel.at(c, dx, dy));
                            kept -= weight;
                            gained += weight * static_cast<double>(at(x + dx, y + dy));
                        }
                    }
                    const float got = out[static_cast<std::size_t>(y * picture.width() + x)];
                    ASSERT_NEAR(static_cast<double>(got), kept * static_cast<double>(at(x, y)) + gained, 2e-6) << x << ", " << y;
                    before += static_cast<double>(at(x, y));
                    after += static_cast<double>(got);
                }
            }
            EXPECT_NEAR(after / before, 1, 1e-6);
        }
        for (const float v : spread(convolver, 1, std::vector<float>(picture.pixels(), 2.5F))) ASSERT_NEAR(v, 2.5F, 5e-6F);
    }
}

TEST(Convolver, LightThatIsNoNumberStaysWhereItIs) {
    const Rect picture{0, 0, 40, 40};
    const Convolver convolver(symmetric_kernel(4), picture);
    std::vector<float> light = random_plane(picture.pixels(), 3), zeroed = light;
    for (const auto& [at, value] : {std::pair{70, NAN}, {500, INFINITY}, {900, -INFINITY}, {1000, 2e30F}}) {
        light[static_cast<std::size_t>(at)] = value;
        zeroed[static_cast<std::size_t>(at)] = 0;
    }
    const std::vector<float> out = spread(convolver, 0, light), expected = spread(convolver, 0, zeroed);
    for (std::size_t i = 0; i < out.size(); ++i) {
        if (Convolver::usable(light[i]) == light[i]) {
            ASSERT_EQ(out[i], expected[i]);
        } else {
            ASSERT_EQ(std::bit_cast<std::uint32_t>(out[i]), std::bit_cast<std::uint32_t>(light[i]));
        }
    }
}

TEST(Kernel, InTurnIsBothOneAfterTheOther) {
    const Rect picture{0, 0, 50, 40};
    const Kernel first = symmetric_kernel(3), second = symmetric_kernel(5);
    std::vector<float> point(picture.pixels());
    point[20 * 50 + 25] = 1;
    const std::vector<float> expected = spread(Convolver(second, picture), 2, spread(Convolver(first, picture), 2, point));
    const std::vector<float> got = spread(Convolver(in_turn(first, second), picture), 2, point);
    for (std::size_t i = 0; i < got.size(); ++i) ASSERT_NEAR(got[i], expected[i], 1e-6F);
}

// In cells of any width: no light is lost, and each half of a wide pattern reaches its side.
TEST(Kernel, OfAPatternKeepsItsLightAndItsWidth) {
    Pattern pattern{64, std::vector<float>(64 * 64)};
    double variance = 0;
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) {
            const double dx = x - 32, dy = y - 32, light = std::abs(dx) < 20 && std::abs(dy) < 20 ? 1 / (39.0 * 39.0) : 0;
            pattern.light[static_cast<std::size_t>(y * 64 + x)] = static_cast<float>(light);
            variance += light * dx * dx;
        }
    }
    for (const double cell : {0.11, 0.37, 1.0, 1.9}) {
        Kernel kernel(80);
        add_pattern(pattern, cell, {1, 0.5F, 0}, kernel);
        double sum = 0, spread = 0;
        for (int y = -80; y <= 80; ++y) {
            for (int x = -80; x <= 80; ++x) {
                const double weight = static_cast<double>(kernel.at(0, x, y));
                ASSERT_EQ(kernel.at(1, x, y), 0.5F * kernel.at(0, x, y));
                ASSERT_EQ(kernel.at(2, x, y), 0);
                sum += weight;
                spread += weight * x * x;
            }
        }
        EXPECT_NEAR(sum, 1, 1e-5);
        // Widths add up: pattern, a cell, a pixel's light, and a pixel's view, sampled where the tent's second moment is at least
        // 1/6.
        EXPECT_NEAR(spread, (variance + 1.0 / 12) * cell * cell + 1.0 / 6, 0.1) << cell;
    }
}

}  // namespace
}  // namespace latent::image
