// Laws of the walk along a line: its segments follow one another from interface to interface, each in the medium behind the last
// one, and reach as far as the line does.
#include "render/medium/march.h"

#include "tests/transport/world_builder.h"

namespace latent::render::testing {
namespace {

// Nested spheres about the origin, radii 3, 2 and 1, of media a, b and none; a wall at z = 10.
class Nested : public ::testing::Test {
 protected:
    static std::string medium(const std::string& name) {
        return "MakeNamedMedium \"" + name + "\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [1 1 1] \"rgb sigma_s\" [1 1 1]\n";
    }
    static std::string sphere(const std::string& inside, const std::string& outside, int radius) {
        return fmt::format("MediumInterface \"{}\" \"{}\"\nShape \"sphere\" \"float radius\" {}\n", inside, outside, radius);
    }
    const Scene scene_ =
        scene_from("Camera \"perspective\"\nWorldBegin\nLightSource \"point\"\n" + medium("a") + medium("b") +
                   "Material \"interface\"\n" + sphere("a", "", 3) + sphere("b", "a", 2) + sphere("", "b", 1) +
                   "MediumInterface \"\" \"\"\nMaterial \"diffuse\"\nTranslate 0 0 10\nShape \"disk\" \"float radius\" 20\n");
    const std::unique_ptr<World> world_ = scene_.world();
    const std::vector<std::uint32_t> media_ = {kNone, 0, 1, kNone, 1, 0, kNone};
    const std::vector<float> ends_ = {2, 3, 4, 6, 7, 8, 15};  // of the segments, from z = -5
};

TEST_F(Nested, SegmentsLieEndToEndUpToTheFirstSurface) {
    March march(world_->geometry(), {{0.1f, 0.2f, -5}, {0, 0, 1}}, kNone);
    float from = 0;
    for (std::uint32_t i = 0; i < media_.size(); ++i, march.cross()) {
        SCOPED_TRACE(i);
        const Segment& s = march.segment();
        EXPECT_EQ(s.index, i);
        EXPECT_EQ(s.medium, media_[i]);
        EXPECT_NEAR(s.o.z + 5, from, 1e-5);
        EXPECT_NEAR(s.length, ends_[i] - from, 0.06);  // spheres are met off their axis
        from = s.o.z + 5 + s.length;
        ASSERT_TRUE(march.hit());
        EXPECT_EQ(march.meets_interface(), i + 1 < media_.size());
    }
    EXPECT_FALSE(march.hit());  // behind the wall
    EXPECT_EQ(march.segment().length, kFar);
}

// Whatever the ray's own unit is, and wherever between the surfaces the line ends.
TEST_F(Nested, ALineToAPointIsAsLongAsThePointIsFar) {
    for (const float end : {1.0f, 2.5f, 3.5f, 5.0f, 6.5f, 7.5f, 14.0f}) {
        SCOPED_TRACE(end);
        const Vec3f from{0.1f, 0.2f, -5}, to{-0.1f, 0.1f, -5 + end};
        const Ray ray = spawn_ray(Interaction{from, 0, {}}, Interaction{to, 0, {}});
        float total = 0, passed = 1;
        for (March march(world_->geometry(), ray, length(to - from), kNone, passed);; march.cross()) {
            EXPECT_EQ(march.segment().medium, media_[march.segment().index]);
            total += march.segment().length;
            if (!march.hit()) break;
            ASSERT_TRUE(march.meets_interface());
        }
        EXPECT_NEAR(total, length(to - from), 1e-5);
        EXPECT_EQ(passed, 1);
    }
}

}  // namespace
}  // namespace latent::render::testing
