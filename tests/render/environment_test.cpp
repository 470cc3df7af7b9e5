// Environment images: what the EXR says its primaries are counts, and how the sky is spread over them.
#include <gmock/gmock.h>

#include <numbers>

#include "color/rgb_space.h"
#include "render/math/equal_area.h"
#include "tests/render/scenes.h"

namespace latent::render {
namespace {

using testing::Folder;
using ::testing::HasSubstr;
using testing::write_exr;

Result<LoadedScene> load_sky(const Folder& folder) {
    return load_scene(
        folder.write("room.pbrt", "WorldBegin\nLightSource \"infinite\" \"string filename\" \"sky.exr\" \"float scale\" 2\n"));
}

TEST(Environment, RowsComeFromTheTopAsLinearSrgb) {
    const Folder folder;
    const std::vector<float> pixels{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
    write_exr(folder / "sky.exr", 2, 2, pixels, {});
    const Result<LoadedScene> scene = load_sky(folder);
    ASSERT_TRUE(scene) << scene.error().message;
    const LightDescription& light = scene->description.lights[0];
    ASSERT_TRUE(light.image);
    EXPECT_EQ(light.image->width, 2u);
    EXPECT_EQ(light.image->rgb, pixels);
    EXPECT_EQ(light.scale, 2);
}

TEST(Environment, OtherPrimariesBecomeSrgbAndWhatIsNegativeThereIsTold) {
    const Folder folder;
    const color::RgbSpace wide = color::RgbSpace::parse("rec2020").value();
    const color::Primaries& p = wide.primaries;
    image::ExrTags tags;
    tags.chromaticities = std::array<float, 8>{
        static_cast<float>(p.red.x),  static_cast<float>(p.red.y),  static_cast<float>(p.green.x), static_cast<float>(p.green.y),
        static_cast<float>(p.blue.x), static_cast<float>(p.blue.y), static_cast<float>(p.white.x), static_cast<float>(p.white.y)};
    write_exr(folder / "sky.exr", 1, 1, {0.5f, 0.4f, 0.3f}, tags);
    const Result<LoadedScene> scene = load_sky(folder);
    ASSERT_TRUE(scene) << scene.error().message;
    const std::array<double, 3> expected =
        color::RgbSpace::srgb().rgb_from_xyz * (wide.xyz_from_rgb * std::array<double, 3>{0.5, 0.4, 0.3});
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(scene->description.lights[0].image->rgb[c], expected[c], 1e-5);

    write_exr(folder / "sky.exr", 1, 1, {0, 1, 0}, tags);  // a green outside of sRGB
    const Result<LoadedScene> green = load_sky(folder);
    ASSERT_TRUE(green);
    ASSERT_EQ(green->warnings.size(), 1u);
    EXPECT_THAT(green->warnings[0], HasSubstr("count as 0"));
}

TEST(Environment, DevelopedPicturesAreXyz) {
    const Folder folder;
    image::ExrTags tags;
    tags.chromaticities = std::array<float, 8>{1, 0, 0, 1, 0, 0, 1 / 3.0f, 1 / 3.0f};
    write_exr(folder / "sky.exr", 1, 1, {0.9505f, 1, 1.089f}, tags);
    const Result<LoadedScene> scene = load_sky(folder);
    ASSERT_TRUE(scene) << scene.error().message;
    for (const float value : scene->description.lights[0].image->rgb) EXPECT_NEAR(value, 1, 1e-3);

    tags.chromaticities = std::array<float, 8>{0.6f, 0.3f, 0.6f, 0.3f, 0.6f, 0.3f, 0.3f, 0.3f};
    write_exr(folder / "sky.exr", 1, 1, {1, 1, 1}, tags);
    EXPECT_THAT(load_sky(folder).error().message, HasSubstr("primaries lie on a line"));
}

TEST(Environment, LongitudeAndLatitudeBecomeTheEqualAreaMapOfTheSameSky) {
    const Folder folder;
    constexpr int kHeight = 64;
    std::vector<float> pixels;  // smooth: x, y, z of the direction, each plus 1
    double flux[3] = {0, 0, 0};
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < 2 * kHeight; ++x) {
            const double theta = std::numbers::pi * (y + 0.5) / kHeight, phi = std::numbers::pi * (x + 0.5) / kHeight;
            const double d[3] = {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
            for (int c = 0; c < 3; ++c) {
                pixels.push_back(static_cast<float>(1 + d[c]));
                flux[c] += (1 + d[c]) * std::sin(theta) * std::pow(std::numbers::pi / kHeight, 2);
            }
        }
    }
    write_exr(folder / "sky.exr", 2 * kHeight, kHeight, pixels, {});
    const Result<LoadedScene> scene = load_sky(folder);
    ASSERT_TRUE(scene) << scene.error().message;
    const ImageDescription& image = *scene->description.lights[0].image;
    ASSERT_EQ(image.width, image.height);
    EXPECT_GE(image.width, static_cast<std::uint32_t>(kHeight));
    double sum[3] = {0, 0, 0};
    for (std::uint32_t y = 0; y < image.height; ++y) {
        for (std::uint32_t x = 0; x < image.width; ++x) {
            const Vec3f d = sphere_from_square({(static_cast<float>(x) + 0.5f) / static_cast<float>(image.width),
                                                (static_cast<float>(y) + 0.5f) / static_cast<float>(image.height)});
            const float* rgb = &image.rgb[3 * (std::size_t{y} * image.width + x)];
            EXPECT_NEAR(rgb[0], 1 + d.x, 0.05);
            EXPECT_NEAR(rgb[1], 1 + d.y, 0.05);
            EXPECT_NEAR(rgb[2], 1 + d.z, 0.05);
            for (int c = 0; c < 3; ++c) sum[c] += static_cast<double>(rgb[c]) * 4 * std::numbers::pi / image.width / image.height;
        }
    }
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c] / flux[c], 1, 2e-3);
}

TEST(Environment, OtherShapesAreRefused) {
    const Folder folder;
    write_exr(folder / "sky.exr", 3, 1, std::vector<float>(9, 1), {});
    const Result<LoadedScene> scene = load_sky(folder);
    ASSERT_FALSE(scene);
    EXPECT_THAT(scene.error().message, HasSubstr("room.pbrt:2:1: "));
    EXPECT_THAT(scene.error().message, HasSubstr("3 x 1 is neither square"));
}

}  // namespace
}  // namespace latent::render
