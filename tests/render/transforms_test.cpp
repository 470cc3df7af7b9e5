// Transformations follow pbrt-v4: left-handed, each directive multiplies from the right, Transform lists columns.
#include "tests/render/scenes.h"

namespace latent::render {
namespace {

using testing::in_world;
using testing::load;
using testing::load_world;

// The image of `p` under the directives.
Vec3d image(const std::string& directives, const std::string& p) {
    const Result<LoadedScene> scene = load_world(directives + "\nShape \"trianglemesh\" \"point3 P\" [ " + p + " 1 0 0 0 1 0 ]\n");
    EXPECT_TRUE(scene) << (scene ? "" : scene.error().message);
    return scene ? Vec3d(in_world(scene->description).shapes[0].mesh->positions[0]) : Vec3d{};
}

void expect_near(const Vec3d& a, const Vec3d& b) { EXPECT_LT(max_abs(a - b), 1e-6) << a.x << " " << a.y << " " << a.z; }

TEST(Transforms, EachDirectiveDoesWhatPbrtDoes) {
    expect_near(image("Translate 1 2 3", "1 1 1"), {2, 3, 4});
    expect_near(image("Scale 2 3 4", "1 1 1"), {2, 3, 4});
    expect_near(image("Rotate 90 0 0 1", "1 0 0"), {0, 1, 0});
    expect_near(image("Rotate 90 1 0 0", "0 1 0"), {0, 0, 1});
    expect_near(image("Rotate 90 0 2 0", "0 0 1"), {1, 0, 0});
    expect_near(image("Transform [ 0 1 0 0  -1 0 0 0  0 0 1 0  5 6 7 1 ]", "1 0 0"), {5, 7, 7});
    expect_near(image("Translate 9 9 9\nIdentity", "1 2 3"), {1, 2, 3});
    // Later directives act first on the shape.
    expect_near(image("Translate 10 0 0\nScale 2 2 2", "1 1 1"), {12, 2, 2});
    expect_near(image("Scale 2 2 2\nConcatTransform [ 1 0 0 0 0 1 0 0 0 0 1 0 10 0 0 1 ]", "1 1 1"), {22, 2, 2});
    expect_near(image("Scale 2 2 2\nTransform [ 1 0 0 0 0 1 0 0 0 0 1 0 10 0 0 1 ]", "1 1 1"), {11, 1, 1});
}

TEST(Transforms, NamedCoordinateSystemsAreWhatTheyWere) {
    expect_near(image("Translate 1 2 3\nCoordinateSystem \"here\"\nScale 5 5 5\nCoordSysTransform \"here\"", "1 1 1"), {2, 3, 4});
    expect_near(image("Translate 1 2 3\nCoordSysTransform \"world\"", "1 1 1"), {1, 1, 1});
    const Result<LoadedScene> scene = load(
        "LookAt 0 0 5  0 0 0  0 1 0\nCamera \"perspective\"\nWorldBegin\nCoordSysTransform \"camera\"\n"
        "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ]\n");
    ASSERT_TRUE(scene) << scene.error().message;
    expect_near(Vec3d(in_world(scene->description).shapes[0].mesh->positions[0]), {0, 0, 5});  // the camera's own place
}

// "pbrt is left-handed: LookAt down -z with y up puts world +x on the left of the image", film x grows to the right.
TEST(Transforms, LookAtPutsWorldXOnTheLeft) {
    const Result<LoadedScene> scene = load("LookAt 0 0 3.9  0 0 0  0 1 0\nCamera \"perspective\"\nWorldBegin\n");
    const Affined camera = in_world(scene->description).camera.world_from_camera;
    expect_near(camera.x, {-1, 0, 0});  // right in the image
    expect_near(camera.y, {0, 1, 0});
    expect_near(camera.z, {0, 0, -1});
    expect_near(camera.t, {0, 0, 3.9});
}

TEST(Transforms, ScaleBeforeLookAtMirrorsTheImage) {
    const Result<LoadedScene> scene = load("Scale -1 1 1\nLookAt 0 0 3.9  0 0 0  0 1 0\nCamera \"perspective\"\nWorldBegin\n");
    expect_near(scene->description.camera.world_from_camera.x, {1, 0, 0});
}

TEST(Transforms, InversesUndoAndNormalsStayPerpendicular) {
    const Affined m = Affined({1, 2, 0.5}, {-0.3, 1.5, 2}, {2, 0.1, -1}, {4, 5, 6});
    const Affined back = m.inverse().value() * m;
    expect_near(back.x, {1, 0, 0});
    expect_near(back.y, {0, 1, 0});
    expect_near(back.z, {0, 0, 1});
    expect_near(back.t, {0, 0, 0});
    for (const Affined& a : {m, m * Affined({-1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0})}) {
        const Vec3d u(1, 2, 3), v(-2, 1, 0.5), n = cross(u, v);
        EXPECT_NEAR(dot(a.normal(n), a.vector(u)), 0, 1e-12);
        EXPECT_NEAR(dot(a.normal(n), a.vector(v)), 0, 1e-12);
        EXPECT_GT(dot(a.normal(n), a.vector(n)), 0);  // stays on its side, mirrored or not
    }
}

TEST(Transforms, FramesAreOrthonormalForEveryNormal) {
    for (int i = 0; i < 1000; ++i) {
        const float z = -1 + 2 * (static_cast<float>(i) + 0.5f) / 1000, phi = 2.4f * static_cast<float>(i),
                    r = std::sqrt(1 - z * z);
        const Vec3f n = normalize(Vec3f(r * std::cos(phi), r * std::sin(phi), z));
        for (const Frame& f : {Frame::from_z(n), Frame::from_z_x(n, Vec3f(0.3f, 1, -0.2f)), Frame::from_z_x(n, n)}) {
            EXPECT_NEAR(dot(f.x, f.y), 0, 1e-6);
            EXPECT_NEAR(dot(f.y, f.z), 0, 1e-6);
            EXPECT_NEAR(dot(f.z, f.x), 0, 1e-6);
            EXPECT_NEAR(length(f.x), 1, 1e-6);
            EXPECT_NEAR(dot(cross(f.x, f.y), f.z), 1, 1e-6);
        }
    }
}

}  // namespace
}  // namespace latent::render
