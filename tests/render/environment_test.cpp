// Environment images: what the EXR says its primaries are counts, and only squares are taken.
#include <gmock/gmock.h>

#include "color/rgb_space.h"
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

TEST(Environment, OnlySquaresAreEqualAreaMaps) {
    const Folder folder;
    write_exr(folder / "sky.exr", 2, 1, {1, 1, 1, 1, 1, 1}, {});
    const Result<LoadedScene> scene = load_sky(folder);
    ASSERT_FALSE(scene);
    EXPECT_THAT(scene.error().message, HasSubstr("room.pbrt:2:1: "));
    EXPECT_THAT(scene.error().message, HasSubstr("2 x 1 is not square"));
}

}  // namespace
}  // namespace latent::render
