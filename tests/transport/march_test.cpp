// Laws of the segments of a line: they follow one another from interface to interface, each in the medium behind the last one, and
// reach as far as the line does.
#include "render/medium/march.h"

#include <functional>

#include "tests/transport/picture_mean.h"
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
    const Ray ray{{0.1f, 0.2f, -5}, {0, 0, 1}};
    const Line line = world_->geometry().trace(ray, Stop::kFirstSolid);
    March march(line, ray, kFar, kNone);
    float from = 0;
    for (std::uint32_t i = 0; i < media_.size(); ++i) {
        SCOPED_TRACE(i);
        const Segment& s = march.segment();
        EXPECT_EQ(s.index, i);
        EXPECT_EQ(s.medium, media_[i]);
        EXPECT_NEAR(s.o.z + 5, from, 1e-5);
        EXPECT_NEAR(s.length, ends_[i] - from, 0.06);  // spheres are met off their axis
        from = s.o.z + 5 + s.length;
        EXPECT_EQ(march.next(), i + 1 < media_.size());
    }
    ASSERT_TRUE(line.hit);
    EXPECT_NEAR(line.hit->t, 15, 1e-5);
    const Ray away{{0.1f, 0.2f, 11}, {0, 0, 1}};  // from behind the wall
    const Line empty = world_->geometry().trace(away, Stop::kFirstSolid);
    EXPECT_FALSE(empty.hit);
    EXPECT_EQ(March(empty, away, kFar, kNone).segment().length, kFar);
}

// Whatever the ray's own unit is, and wherever between the surfaces the line ends.
TEST_F(Nested, ALineToAPointIsAsLongAsThePointIsFar) {
    for (const float end : {1.0f, 2.5f, 3.5f, 5.0f, 6.5f, 7.5f, 14.0f}) {
        SCOPED_TRACE(end);
        const Vec3f from{0.1f, 0.2f, -5}, to{-0.1f, 0.1f, -5 + end};
        const Ray ray = spawn_ray(Interaction{from, 0, {}}, Interaction{to, 0, {}});
        const Line line = world_->geometry().trace(ray, Stop::kAnySolid);
        EXPECT_EQ(line.passed, 1);
        float total = 0;
        March march(line, ray, length(to - from), kNone);
        do {
            EXPECT_EQ(march.segment().medium, media_[march.segment().index]);
            total += march.segment().length;
        } while (march.next());
        EXPECT_NEAR(total, length(to - from), 1e-5);
    }
}

// Boxes of media on a floor, beside one another and in one another, in a place where no coordinate is exact.
class Touching : public ::testing::Test {
 protected:
    static constexpr std::uint32_t kA = 0, kB = 1, kC = 2;

    static Vec3d at(double x, double y, double z) {
        static const Vec3d ex = normalize(Vec3d{3, 1, -2}), ez = normalize(cross(ex, Vec3d{1, 5, 2})), ey = cross(ez, ex);
        return Vec3d{12.3, -4.56, 7.89} + ex * x + ey * y + ez * z;
    }
    static std::string points(std::initializer_list<Vec3d> list) {
        std::string text;
        for (const Vec3d& p : list) text += fmt::format("{:.17g} {:.17g} {:.17g}  ", p.x, p.y, p.z);
        return text;
    }
    static std::string box(const char* inside, const char* outside, const Vec3d& l, const Vec3d& h) {
        return fmt::format(
            "MediumInterface \"{}\" \"{}\"\nShape \"trianglemesh\" \"point3 P\" [{}] \"integer indices\" [0 2 1 0 3 2  4 5 "
            "6 4 6 7  0 1 5 0 5 4  3 6 2 3 7 6  1 2 6 1 6 5  0 4 7 0 7 3]\n",
            inside, outside,
            points({at(l.x, l.y, l.z), at(l.x, l.y, h.z), at(h.x, l.y, h.z), at(h.x, l.y, l.z), at(l.x, h.y, l.z),
                    at(l.x, h.y, h.z), at(h.x, h.y, h.z), at(h.x, h.y, l.z)}));
    }
    const Scene scene_ = scene_from(
        "Camera \"perspective\"\nWorldBegin\nLightSource \"point\"\nMakeNamedMedium \"a\" \"string type\" \"homogeneous\"\n"
        "MakeNamedMedium \"b\" \"string type\" \"homogeneous\"\nMakeNamedMedium \"c\" \"string type\" \"homogeneous\"\n"
        "Material \"diffuse\"\nShape \"bilinearmesh\" \"point3 P\" [" +
        points({at(-9.1, 0, -8.3), at(8.7, 0, -8.3), at(-9.1, 0, 9.9), at(8.7, 0, 9.9)}) + "]\nMaterial \"interface\"\n" +
        box("a", "", {-1.1, 0, -1}, {0, 1.3, 1.2}) + box("b", "a", {-0.7, 0, -0.6}, {0, 1, 0.7}) +
        box("c", "", {0, 0, -1}, {1.7, 1.3, 1.2}));
    const std::unique_ptr<World> world_ = scene_.world();
};

// From where two boxes touch, or one stands on the floor, whatever medium it is said to begin in.
TEST_F(Touching, ALineBeginsInTheMediumThatItLeadsInto) {
    struct Case {
        Vec3d from, towards;
        std::uint32_t medium;
    };
    for (const Case& c : {Case{at(0, 0.5, 0.1), at(1, 0.7, 0.2), kC}, Case{at(0, 0.5, 0.1), at(-0.5, 0.7, 0.2), kB},
                          Case{at(-0.3, 0, 0.1), at(-0.2, 0.5, 0.2), kB}, Case{at(0.3, 0, 0.1), at(0.2, 0.5, 0.2), kC}}) {
        for (const std::uint32_t given : {kNone, kA, kB, kC}) {
            Vec3f start(c.from - scene_.description.origin);
            const Vec3f d(normalize(c.towards - c.from));
            EXPECT_EQ(medium_at_start(world_->geometry(), start, d, 0, given), c.medium);
            const Line line = world_->geometry().trace({start, d}, Stop::kNothing);  // meets none of those at its start
            ASSERT_FALSE(line.crossings.empty());
            EXPECT_GT(line.crossings.front().t, 0.1f);
            EXPECT_EQ(line.crossings.front().left, c.medium);
        }
    }
}

// Each scene beside the same one with its surfaces a little apart, in the right order.
TEST_F(Touching, MakeTheSamePictureAsThoseThatDoNot) {
    const auto sheet = [](const char* surface, const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
        return fmt::format("AttributeBegin\n{}Shape \"bilinearmesh\" \"point3 P\" [{}]\nAttributeEnd\n", surface,
                           points({a, b, c, d}));
    };
    const auto front = [&](const char* surface, double z) {
        return sheet(surface, at(-0.8, 0.1, z), at(0.8, 0.1, z), at(-0.8, 1, z), at(0.8, 1, z));
    };
    const auto medium = [](const char* inside, const char* outside, const Vec3d& low, const Vec3d& high) {
        return "AttributeBegin\nMaterial \"interface\"\n" + box(inside, outside, low, high) + "AttributeEnd\n";
    };
    const std::vector<std::function<std::string(double)>> scenes = {
        [&](double apart) {  // a lamp in the lid of a box on the floor
            return medium("fog", "", {-1, -apart, -1}, {1, 1.3 + apart, 1}) +
                   sheet("Material \"diffuse\"\n", at(-9, 0, -8), at(9, 0, -8), at(-9, 0, 10), at(9, 0, 10)) +
                   sheet("AreaLightSource \"diffuse\" \"float scale\" 2\nMediumInterface \"fog\" \"fog\"\n", at(-0.4, 1.3, -0.4),
                         at(0.4, 1.3, -0.4), at(-0.4, 1.3, 0.4), at(0.4, 1.3, 0.4));
        },
        [&](double apart) {  // a lamp between two boxes
            return medium("fog", "", {-1, 0, -1}, {-apart, 1.3, 1}) + medium("ink", "", {apart, 0, -1}, {1, 1.3, 1}) +
                   sheet("AreaLightSource \"diffuse\" \"float scale\" 2 \"bool twosided\" true\n", at(0, 0.3, -0.4),
                         at(0, 0.3, 0.4), at(0, 0.9, -0.4), at(0, 0.9, 0.4));
        },
        [&](double apart) {  // sheets before a box: one with holes, and one that light passes
            return medium("ink", "", {-1, 0, -1}, {1, 1.2, 1}) +
                   front("Material \"diffuse\" \"rgb reflectance\" [.2 .2 .2]\nAttribute \"shape\" \"float alpha\" .5\n",
                         -1 - apart);
        },
        [&](double apart) {
            return medium("ink", "", {-1, 0, -1}, {1, 1.2, 1}) +
                   front("Material \"diffusetransmission\" \"rgb reflectance\" [.3 .3 .3] \"rgb transmittance\" [.6 .6 .6]\n",
                         -1 - apart);
        },
        [&](double apart) {  // a block at the wall of the medium that it says it is in
            return medium("ink", "", {-1, 0, -1}, {1, 1.2, 1}) + "Material \"diffuse\" \"rgb reflectance\" [.8 .8 .8]\n" +
                   box("", "ink", {-0.8, 0.1, -1 + apart}, {0.8, 1.1, 0.5});
        },
        [&](double apart) {  // the same as a lamp
            return medium("ink", "", {-1, 0, -1}, {1, 1.2, 1}) + "Material \"diffuse\"\nAreaLightSource \"diffuse\"\n" +
                   box("", "ink", {-0.8, 0.1, -1 + apart}, {0.8, 1.1, 0.5});
        },
        [&](double apart) {  // the same of glass
            return medium("ink", "", {-1, 0, -1}, {1, 1.2, 1}) + "Material \"dielectric\" \"float roughness\" .2\n" +
                   box("", "ink", {-0.8, 0.1, -1 + apart}, {0.8, 1.1, 0.5});
        },
        [&](double apart) {  // two boxes, one of them in a hull with holes
            return medium("fog", "", {-1, 0, -1}, {1, 1.2, -apart}) + box("ink", "", {-1, 0, apart}, {1, 1.2, 1}) +
                   "\"float alpha\" .4\n";
        },
    };
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        const auto scene = [&](double apart) {
            return scene_from(
                fmt::format("Integrator \"volpath\" \"integer maxdepth\" 4\nLookAt {} {} {}\n", points({at(0, 0.8, -5)}),
                            points({at(0, 0.6, 0)}), points({at(0, 1, 0) - at(0, 0, 0)})) +
                "Camera \"perspective\" \"float fov\" 30\nWorldBegin\nLightSource \"infinite\" \"float scale\" .3\n"
                "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [.1 .1 .1] \"rgb sigma_s\" [.9 .8 .7]\n"
                "MakeNamedMedium \"ink\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [2 2 2] \"rgb sigma_s\" [.3 .2 .1]\n" +
                scenes[i](apart));
        };
        for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt}) {
            SCOPED_TRACE(fmt::format("scene {}, {}", i, kind == IntegratorKind::kPath ? "path" : "bdpt"));
            const Mean touching = mean_of_picture(scene(0), {.kind = kind, .seed = 1}, 30'000);
            const Mean apart = mean_of_picture(scene(0.0005), {.kind = kind, .seed = 1}, 30'000);
            for (std::size_t c = 0; c < 3; ++c) {
                EXPECT_NEAR(touching.xyz[c], apart.xyz[c], 0.005 * apart.xyz[c]);
                EXPECT_GT(apart.xyz[c], 0.001);
            }
        }
    }
}

}  // namespace
}  // namespace latent::render::testing
