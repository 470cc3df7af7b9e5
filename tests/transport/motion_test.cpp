// What moves while the shutter is open: how maps vary with time, and what that does to pictures. docs/scenes.md, "Motion".
#include "render/math/motion.h"

#include "tests/render/rays.h"
#include "tests/transport/numbers.h"
#include "tests/transport/one_picture.h"
#include "tests/transport/world_builder.h"

namespace latent::render::testing {
namespace {

Affined times(const Affined& a, double s) { return {a.x * s, a.y * s, a.z * s, a.t}; }

Affined rotation(double degrees, const Vec3d& axis) {
    const double s = std::sin(degrees * std::numbers::pi / 180), c = std::cos(degrees * std::numbers::pi / 180);
    const auto image = [&](const Vec3d& v) { return axis * dot(axis, v) * (1 - c) + v * c + cross(axis, v) * s; };
    return {image({1, 0, 0}), image({0, 1, 0}), image({0, 0, 1}), {}};
}

double distance(const Affined& a, const Affined& b) {
    return std::max({max_abs(a.x - b.x), max_abs(a.y - b.y), max_abs(a.z - b.z), max_abs(a.t - b.t)});
}

TEST(Motion, ATurnIsEvenAndStaysRigid) {
    const Vec3d axis = normalize(Vec3d{1, -2, 0.5});
    for (const double degrees : {0.0, 1e-7, 3.0, 90.0, 179.0}) {
        const Affined start = rotation(25, {0, 0, 1});
        const Motion motion(start, rotation(degrees, axis) * start);
        for (double s = 0; s <= 1; s += 0.125) {
            EXPECT_LT(distance(motion.at(s), rotation(s * degrees, axis) * start), 1e-12) << degrees << " " << s;
        }
    }
}

TEST(Motion, TheShorterWayRoundIsTaken) {
    const Motion motion({}, rotation(270, {0, 1, 0}));
    EXPECT_LT(distance(motion.at(0.5), rotation(-45, {0, 1, 0})), 1e-12);
}

TEST(Motion, BothEndsAreExactAndNothingMovesBeyond) {
    const Affined start({1, 2, 0.5}, {-0.3, 1.5, 2}, {2, 0.1, -1}, {4, 5, 6}), end = rotation(80, {1, 0, 0}) * start;
    const Motion motion(start, end, {7, 8, 9});
    EXPECT_EQ(motion.at(0), start);
    EXPECT_EQ(motion.at(-3), start);
    EXPECT_EQ(motion.at(1), end);
    EXPECT_EQ(motion.at(2), end);
    EXPECT_LT(distance(motion.at(1e-9), start), 1e-7);
    EXPECT_LT(distance(motion.at(1 - 1e-9), end), 1e-7);
}

// Whatever it is made of: sheared, stretched, mirrored.
TEST(Motion, AMapThatDoesNotChangeStays) {
    const Affined map({1, 2, 0.5}, {-0.3, 1.5, 2}, {2, 0.1, -1}, {4, 5, 6});
    for (const Affined& m : {map, times(map, -1), times(map, 1e-6), times(map, 1e6)}) {
        const Motion motion(m, m);
        EXPECT_LT(distance(motion.at(0.3), m), 1e-13 * length(m.x) + 1e-14);
        EXPECT_FALSE(motion.turns());
    }
}

TEST(Motion, AMirroredMapTurnsLikeItsLikeness) {
    const Affined mirror({-1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {}), turn = rotation(60, {0, 0, 1});
    EXPECT_LT(distance(Motion(mirror, turn * mirror).at(0.5), rotation(30, {0, 0, 1}) * mirror), 1e-12);
}

TEST(Motion, TheCentreMovesAlongAStraightLine) {
    const Vec3d center{3, -1, 2};
    const Affined start = rotation(10, {1, 0, 0});
    Affined end = rotation(100, {0, 0, 1});
    end.t = {1, 1, 1};
    const Motion motion(start, end, center);
    for (double s = 0; s <= 1; s += 0.25) {
        const Vec3d line = start.point(center) * (1 - s) + end.point(center) * s;
        EXPECT_LT(max_abs(motion.at(s).point(center) - line), 1e-12);
    }
}

// |p'' | by differences, which err by the fourth derivative.
TEST(Motion, NoPointStraysFurtherThanItsBend) {
    Numbers number(5);
    const auto vector = [&] { return Vec3d(number() - 0.5f, number() - 0.5f, number() - 0.5f) * 4; };
    for (int i = 0; i < 200; ++i) {
        Affined start(vector(), vector(), vector(), vector());
        Affined end = rotation(170 * static_cast<double>(number()), normalize(vector())) * start;
        end.x = end.x * 1.7;
        const Motion motion(start, end, vector());
        const Vec3d p = vector();
        constexpr double kStep = 1e-3;
        for (double s = 0.05; s < 1; s += 0.1) {
            const Vec3d second =
                (motion.at(s - kStep).point(p) + motion.at(s + kStep).point(p) - motion.at(s).point(p) * 2) * (1 / (kStep * kStep));
            EXPECT_LE(length(second), motion.bend(p) * 1.001 + 1e-5);
        }
    }
}

// A square of side 0.5 that shines, seen by parallel rays on a film from -1 to 1.
struct SquareScene {
    std::string options{}, camera{}, square{};  // directives before the film's, for the camera and for the square
    std::string text() const {
        return options + "Film \"rgb\" \"integer xresolution\" 64 \"integer yresolution\" 64\n" + camera +
               "\nWorldBegin\nAttributeBegin\n" + square +
               "\nReverseOrientation\nAreaLightSource \"diffuse\"\nShape \"trianglemesh\" \"point3 P\" [-.25 -.25 0  .25 -.25 0  "
               ".25 "
               ".25 0  -.25 .25 0] \"integer indices\" [0 1 2 0 2 3]\nAttributeEnd\n";
    }
};
const std::string kLook = "LookAt 0 0 -2  0 0 0  0 1 0\n", kCamera = "Camera \"orthographic\" ";

// The luminance of the picture in every sample.
std::vector<double> samples_of(const Scene& scene, const IntegratorSettings& settings, std::uint64_t count,
                               std::vector<Vec2f>* film = nullptr) {
    const std::unique_ptr<Integrator> integrator = scene.integrator(settings);
    std::vector<double> out;
    sampledb::Records r;
    RadianceFaults faults;
    for (std::uint64_t n = 0; n < count; ++n) {
        r.clear();
        integrator->trace(n, r, faults);
        out.push_back(0);
        for (const float y : r.y) out.back() += static_cast<double>(y);
        if (film != nullptr) film->push_back({static_cast<float>(r.u[0]) * 0x1p-32f, static_cast<float>(r.v[0]) * 0x1p-32f});
    }
    EXPECT_EQ(faults.total(), 0u);
    return out;
}
const IntegratorSettings kPathSettings{.max_depth = 1, .record = sampledb::RecordKind::kXyz, .seed = 3};

// Share of the time in which |x - c(t)| < 0.25 as the centre c goes from `from` to `to`.
double covered(double x, double from, double to) {
    const double low = std::min(from, to), high = std::max(from, to);
    return std::max(0.0, std::min(high, x + 0.25) - std::max(low, x - 0.25)) / (high - low);
}

struct Way {
    const char *name, *options, *camera;  // camera: parameters
    double from, to;                      // of the square's centre in the picture
};
const Way kWays[] = {{"all of it", "", "", -0.5, 0.5},
                     {"a quarter", "", "\"float shutteropen\" .25 \"float shutterclose\" .5", -0.25, 0},
                     {"other times", "TransformTimes 1 5\n", "\"float shutteropen\" 2 \"float shutterclose\" 3", -0.25, 0},
                     {"before and after", "TransformTimes 0 1\n", "\"float shutteropen\" -1 \"float shutterclose\" 1", -0.5, 0.5}};

// Counts in 32 columns of the film, beside the binomial distribution's expectations: chi-square of 32 degrees of freedom is above
// 66 once in 2000 times, and well spread samples stay below.
void expect_coverage(const Way& way, const Scene& scene, bool shines = true) {
    constexpr int kColumns = 32;
    std::vector<Vec2f> film;
    const std::vector<double> y = samples_of(scene, kPathSettings, 100'000, &film);
    double chi_square = 0;
    for (int column = 0; column < kColumns; ++column) {
        int in_rows = 0, seen = 0;
        for (std::size_t n = 0; n < y.size(); ++n) {
            if (static_cast<int>(film[n].x * kColumns) != column || std::abs(film[n].y - 0.5f) >= 0.12f) continue;
            ++in_rows;
            seen += (y[n] > 0) == shines ? 1 : 0;
        }
        double p = 0;
        for (int i = 0; i < 200; ++i) {
            const double x = -1 + 2 * (column + (i + 0.5) / 200) / kColumns;
            const bool resting = way.name == kWays[3].name;  // half of the time
            p += (resting ? 0.5 * (std::abs(x - way.from) < 0.25) + 0.5 * covered(x, way.from, way.to)
                          : covered(x, way.from, way.to)) /
                 200;
        }
        if (p == 0 || p == 1) {
            EXPECT_EQ(seen, p == 0 ? 0 : in_rows) << column;
        } else {
            chi_square += (seen - in_rows * p) * (seen - in_rows * p) / (in_rows * p * (1 - p));
        }
    }
    EXPECT_LT(chi_square, 66);
}

TEST(CameraMotion, ASquareIsSeenForTheShareOfTimeInWhichItIsThere) {
    for (const Way& way : kWays) {
        SCOPED_TRACE(way.name);
        // The camera goes from 0.5 to -0.5.
        const std::string move = "ActiveTransform StartTime\nTranslate -.5 0 0\nActiveTransform EndTime\nTranslate .5 0 0\n";
        expect_coverage(way, scene_from(SquareScene{way.options, kLook + move + kCamera + way.camera}.text()));
    }
}

TEST(CameraMotion, NoMotionIsTheStaticSceneToTheBit) {
    const std::string room =
        "WorldBegin\nLightSource \"infinite\" \"rgb L\" [.3 .4 .5]\nMaterial \"diffuse\"\nShape \"sphere\" \"float radius\" 1\n";
    const std::string lens = "Camera \"perspective\" \"float fov\" 50 \"float lensradius\" .1 \"float focaldistance\" 3";
    const Scene still = scene_from("LookAt 0 0 -4  0 0 0  0 1 0\n" + lens + "\n" + room);
    const Scene moved = scene_from(
        "TransformTimes 0.5 0.75\nActiveTransform StartTime\nLookAt 0 0 -4  0 0 0  0 1 0\nActiveTransform EndTime\nLookAt 0 0 -4  "
        "0 0 "
        "0  0 1 0\n" +
        lens + " \"float shutteropen\" 0.2 \"float shutterclose\" .9\n" + room);
    EXPECT_FALSE(moved.description.camera.end);
    for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt}) {
        const IntegratorSettings settings{.kind = kind, .record = sampledb::RecordKind::kXyz, .seed = 1};
        EXPECT_EQ(samples_of(still, settings, 2000), samples_of(moved, settings, 2000));
    }
}

// A scene with a lens, so that light subpaths splat and meet the lens; what is far from the start of the camera is nearer the end.
std::string room_seen_by(const std::string& camera) {
    return "Film \"rgb\" \"integer xresolution\" 32 \"integer yresolution\" 32\nIntegrator \"bdpt\" \"integer maxdepth\" 3\n" +
           camera +
           "WorldBegin\nAttributeBegin\nTranslate 0 2 0\nRotate 90 1 0 0\nAreaLightSource \"diffuse\" \"float scale\" 5\nShape "
           "\"trianglemesh\" \"point3 P\" [-.6 -.6 0  .6 -.6 0  .6 .6 0  -.6 .6 0] \"integer indices\" [0 1 2 0 2 "
           "3]\nAttributeEnd\n"
           "Material \"diffuse\" \"rgb reflectance\" [.7 .5 .3]\nShape \"trianglemesh\" \"point3 P\" [-2 0 -2  2 0 -2  2 0 2  -2 0 "
           "2] "
           "\"integer indices\" [0 1 2 0 2 3]\nShape \"trianglemesh\" \"point3 P\" [-2 0 2  2 0 2  2 2.5 2  -2 2.5 2] \"integer "
           "indices\" [0 1 2 0 2 3]\nMaterial \"conductor\" \"float roughness\" .2\nAttributeBegin\nTranslate .3 .5 0\nShape "
           "\"sphere\" "
           "\"float radius\" .5\nAttributeEnd\n";
}
const std::string kDolly =
    "ActiveTransform StartTime\nLookAt -1 1 -3  0 .6 0  0 1 0\nActiveTransform EndTime\nLookAt 1.2 1.4 -2  .2 .5 0  .3 1 0\n"
    "ActiveTransform All\nCamera \"perspective\" \"float fov\" 45 \"float lensradius\" 0.2 \"float focaldistance\" 3\n";

TEST(CameraMotion, PathAndBdptMakeOnePicture) { expect_agreement(scene_from(room_seen_by(kDolly)), 8192); }

// A shutter that is open for no time at all sees the camera where it then is.
TEST(CameraMotion, AMomentIsAPictureFromThere) {
    const std::string at = " \"float shutteropen\" .5 \"float shutterclose\" .5\n",
                      lens = "Camera \"perspective\" \"float fov\" 40";
    const Scene moment =
        scene_from(room_seen_by("ActiveTransform StartTime\nLookAt -1 1 -3  -1 1 0  0 1 0\nActiveTransform "
                                "EndTime\nRotate 40 0 0 1\nLookAt 1 1 -3  1 1 0  0 1 0\n" +
                                lens + at));
    const Scene still = scene_from(room_seen_by("Rotate 20 0 0 1\nLookAt 0 1 -3  0 1 0  0 1 0\n" + lens + "\n"));
    for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt}) {
        const IntegratorSettings settings{.kind = kind, .max_depth = 0, .record = sampledb::RecordKind::kXyz, .seed = 1};
        const std::vector<double> a = samples_of(moment, settings, 5000), b = samples_of(still, settings, 5000);
        int others = 0;  // another way at an edge
        for (std::size_t n = 0; n < a.size(); ++n) others += std::abs(a[n] - b[n]) > 1e-3 * b[n] ? 1 : 0;
        EXPECT_LE(others, 10);
    }
}

// A black square before a white sky: as the shape itself, in two other kinds, and as an object that was modelled elsewhere.
const std::string kSquare =
    "Shape \"trianglemesh\" \"point3 P\" [-.25 -.25 0  .25 -.25 0  .25 .25 0  -.25 .25 0] \"integer indices\" [0 1 2 "
    "0 2 3]\n";
struct Shown {
    const char* name;
    std::string before, after;  // the directives that move it
};
const Shown kShown[] = {
    {"mesh", "", kSquare},
    {"patch", "", "Shape \"bilinearmesh\" \"point3 P\" [-.25 -.25 0  .25 -.25 .01  -.25 .25 0  .25 .25 0]\n"},
    {"object", "ObjectBegin \"o\"\nTranslate 100 0 0\n" + kSquare + "ObjectEnd\n", "Translate -100 0 0\nObjectInstance \"o\"\n"},
};
std::string black_square(const Shown& shown, const Way& way, const std::string& move) {
    return std::string(way.options) + "Film \"rgb\" \"integer xresolution\" 64 \"integer yresolution\" 64\n" + kLook + kCamera +
           way.camera + "\nWorldBegin\nLightSource \"infinite\"\nMaterial \"diffuse\" \"rgb reflectance\" [0 0 0]\n" +
           shown.before + move + shown.after;
}
const std::string kMove =
    "ActiveTransform StartTime\nTranslate -.5 0 0\nActiveTransform EndTime\nTranslate .5 0 0\nActiveTransform All\n";

TEST(ObjectMotion, ASquareCoversForTheShareOfTimeInWhichItIsThere) {
    for (const Shown& shown : kShown) {
        for (const Way& way : kWays) {
            SCOPED_TRACE(std::string(shown.name) + ", " + way.name);
            expect_coverage(way, scene_from(black_square(shown, way, kMove)), false);
        }
    }
}

TEST(ObjectMotion, ACameraThatPassesAnObjectSeesItPassTheOtherWay) {
    const std::string sky = "LightSource \"infinite\"\nMaterial \"diffuse\" \"rgb reflectance\" [0 0 0]\n";
    const std::string lens = "Camera \"perspective\" \"float fov\" 50 \"float lensradius\" 0.05 \"float focaldistance\" 2\n";
    const std::string to =
        "ActiveTransform StartTime\nTranslate -.5 0 0\nActiveTransform EndTime\nTranslate .4 .2 .3\nActiveTransform All\n";
    for (const Shown& shown : kShown) {
        SCOPED_TRACE(shown.name);
        const Scene object = scene_from(kLook + lens + "WorldBegin\n" + sky + shown.before + to + shown.after);
        const Scene camera = scene_from(kLook + to + lens + "WorldBegin\n" + sky + shown.before + shown.after);
        for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt}) {
            const IntegratorSettings settings{.kind = kind, .record = sampledb::RecordKind::kXyz, .seed = 3};
            const std::vector<double> a = samples_of(object, settings, 20'000), b = samples_of(camera, settings, 20'000);
            int unequal = 0, black = 0;
            for (std::size_t n = 0; n < a.size(); ++n) {
                unequal += (a[n] > 0) != (b[n] > 0) ? 1 : 0;
                black += a[n] == 0 ? 1 : 0;
            }
            EXPECT_LE(unequal, 4);  // at an edge
            EXPECT_GT(black, 500);
        }
    }
}

// Things of every kind; `map` puts each where it is. Maps are interpolated about the origin that a thing was modelled about, which
// is outside of some.
std::string things(const std::string& map, const std::string& ball, const std::string& alpha) {
    return "Texture \"c\" \"spectrum\" \"checkerboard\" \"float uscale\" 4 \"float vscale\" 4 \"rgb tex1\" [.2 .6 .3] \"rgb tex2\" "
           "[.7 .1 "
           ".1]\nTexture \"t\" \"float\" \"checkerboard\" \"float uscale\" 8 \"float vscale\" 8 \"float tex1\" 1 \"float tex2\" 0\n"
           "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [.2 .3 .4] \"rgb sigma_s\" [3 2 1]\n"
           "ObjectBegin \"o\"\nMaterial \"diffuse\" \"texture reflectance\" \"c\"\nTranslate 0 .5 0\nShape \"cylinder\" \"float "
           "radius\" .3 \"float zmin\" -.4 \"float zmax\" .4" +
           alpha + "\nMaterial " + ball +
           "\nTranslate 1 .2 -.2\nShape \"sphere\" \"float radius\" .4\nObjectEnd\nAttributeBegin\n" + map +
           "ObjectInstance \"o\"\nMaterial \"diffuse\"\nShape \"trianglemesh\" \"point3 P\" [-.6 .1 .2  .6 .1 .1  0 1 .3] \"normal "
           "N\" [0 "
           ".3 -1 .3 0 -1 0 0 -1]\nMaterial \"conductor\" \"float roughness\" .3\nShape \"disk\" \"float radius\" .3 \"float "
           "height\" "
           "-.6\nMaterial \"interface\"\nMediumInterface \"fog\" \"\"\nShape \"sphere\" \"float radius\" .5\nAttributeEnd\n";
}
// Holes are not here: a hash of a place decides about them, so they would be others.
std::string solid_things(const std::string& map) { return things(map, "\"dielectric\"", ""); }
std::string holed_things(const std::string& map) {
    return things(map, "\"conductor\" \"float roughness\" .4", " \"texture alpha\" \"t\"");
}
std::string room_before(const std::string& camera) {
    return room_seen_by(
        "LookAt 0 1.2 -3  0 .6 0  0 1 0\nCamera \"perspective\" \"float fov\" 50 \"float lensradius\" 0.1 \"float "
        "focaldistance\" 3" +
        camera + "\n");
}
const std::string kTumble =
    "ActiveTransform StartTime\nTranslate -.2 .2 0\nActiveTransform EndTime\nTranslate .3 .5 -.2\nRotate 60 1 2 1\nScale 1.3 1.3 "
    "1.3\nActiveTransform All\n";

TEST(ObjectMotion, PathAndBdptMakeOnePicture) { expect_agreement(scene_from(room_before("") + holed_things(kTumble)), 16384); }

TEST(ObjectMotion, CameraAndObjectsMayBothMove) {
    expect_agreement(scene_from(room_seen_by(kDolly) + holed_things(kTumble)), 16384);
}

// What a tumble is at share s.
std::string tumbled(double s) {
    return fmt::format("Translate {0} {1} {2}\nRotate {3} 1 2 1\nScale {4} {4} {4}\n", -0.2 + 0.5 * s, 0.2 + 0.3 * s, -0.2 * s,
                       60 * s, 1 + 0.3 * s);
}

TEST(ObjectMotion, AMomentIsTheSceneAsItThenIs) {
    for (const double s : {0.25, 0.5, 0.9}) {
        SCOPED_TRACE(s);
        const Scene moment = scene_from(room_before(fmt::format(" \"float shutteropen\" {0} \"float shutterclose\" {0}", s)) +
                                        solid_things(kTumble));
        const Scene still = scene_from(room_before("") + solid_things(tumbled(s)));
        for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt}) {
            const IntegratorSettings settings{.kind = kind, .max_depth = 0, .record = sampledb::RecordKind::kXyz, .seed = 1};
            const std::vector<double> a = samples_of(moment, settings, 10'000), b = samples_of(still, settings, 10'000);
            int others = 0;  // another way at an edge, or by a choice
            for (std::size_t n = 0; n < a.size(); ++n) others += std::abs(a[n] - b[n]) > 1e-3 * b[n] ? 1 : 0;
            EXPECT_LE(others, 30);
        }
    }
}

TEST(ObjectMotion, NoMotionIsTheStaticSceneToTheBit) {
    const std::string same = "TransformBegin\n" + tumbled(0.3) +
                             "CoordinateSystem \"there\"\nTransformEnd\nActiveTransform StartTime\n" + tumbled(0.3) +
                             "ActiveTransform EndTime\n" + tumbled(0.3) + "ActiveTransform All\n";
    const Scene still = scene_from(room_before("") + holed_things(tumbled(0.3))),
                moved = scene_from(room_before(" \"float shutteropen\" 0.2 \"float shutterclose\" 1.2") + holed_things(same));
    EXPECT_FALSE(has_motion(moved.description));
    for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt}) {
        const IntegratorSettings settings{.kind = kind, .max_depth = 0, .record = sampledb::RecordKind::kXyz, .seed = 1};
        EXPECT_EQ(samples_of(still, settings, 2000), samples_of(moved, settings, 2000));
    }
}

// Long things that turn fast about a point far away are met at every time where they then are, and left without meeting them again.
TEST(ObjectMotion, RaysMeetWhatTurnsWhereItThenIs) {
    const auto stick = [](const std::string& map) {
        return "WorldBegin\nLightSource \"infinite\"\nObjectBegin \"o\"\nTranslate 4 0 0\nShape \"bilinearmesh\" \"point3 P\" [1 "
               "-.1 -1  3 "
               "-.1 -1  1 .1 1  3 .3 1]\nObjectEnd\nObjectBegin \"b\"\nTranslate 4 0 0\nScale 3 .1 .2\nShape "
               "\"sphere\"\nObjectEnd\n" +
               map + "ObjectInstance \"o\"\nObjectInstance \"b\"\n";
    };
    const Scene moving =
        scene_from(stick("ActiveTransform StartTime\nTranslate 3 0 0\nActiveTransform EndTime\nTranslate 3 1 0\nRotate "
                         "170 1 0 2\nActiveTransform All\n"));
    const auto turning = Geometry::build(moving.description, "sse4.2");
    ASSERT_TRUE(turning);
    Numbers number(11);
    const auto vector = [&](float size) { return Vec3f(number() - 0.5f, number() - 0.5f, number() - 0.5f) * (2 * size); };
    int hits = 0, unequal = 0, wrong_side = 0;
    for (int i = 0; i < 40; ++i) {
        const float time = number();
        const double s = static_cast<double>(time);
        const Scene there = scene_from(stick(fmt::format("Translate 3 {} 0\nRotate {} 1 0 2\n", s, 170 * s)));
        const auto still = Geometry::build(there.description, "sse4.2");
        ASSERT_TRUE(still);
        const Vec3f shift(there.description.origin - moving.description.origin);
        for (int j = 0; j < 500; ++j) {
            // Towards a place near what has been turned.
            const Vec3d place = there.description.instances[static_cast<std::size_t>(j % 2)].world_from_object.t;
            const Vec3f o = Vec3f(place) + vector(12);
            const Ray ray{o, normalize(Vec3f(place) + vector(1) - o), kInfinity, time};
            const auto a = first_hit(**turning, {ray.o + shift, ray.d, kInfinity, time}), b = first_hit(**still, ray);
            if (a.has_value() != b.has_value() || (a && std::abs(a->t - b->t) > 1e-3f)) ++unequal;
            if (!a) continue;
            ++hits;
            EXPECT_EQ(share_passed(**turning, {ray.o + shift, ray.d, a->t * 1.001f, time}), 0);
            EXPECT_EQ(share_passed(**turning, {ray.o + shift, ray.d, a->t * 1.001f, time}), 0);
            // Of the ellipsoid, whose outside is empty and whose inside has no way out.
            if (moving.description.objects[moving.description.instances[a->on.instance].object].shapes[0].kind !=
                ShapeKind::kSphere)
                continue;
            const auto out = first_hit(**turning, spawn_ray(a->interaction(), a->ng).at_time(time));
            const auto in = first_hit(**turning, spawn_ray(a->interaction(), -a->ng).at_time(time));
            wrong_side += (out && out->on.instance == a->on.instance) || !in ? 1 : 0;
        }
    }
    EXPECT_GT(hits, 500);
    EXPECT_LE(unequal, 3);  // at an edge
    EXPECT_EQ(wrong_side, 0);
}

TEST(ObjectMotion, WhatCannotMoveIsRefused) {
    const std::string move = "WorldBegin\nActiveTransform EndTime\nTranslate 1 0 0\nActiveTransform All\n";
    EXPECT_NE(refusal(move + "AreaLightSource \"diffuse\"\nShape \"sphere\"").find("an area light cannot move"), std::string::npos);
    EXPECT_NE(refusal(move + "ObjectBegin \"o\"\nShape \"sphere\"\nObjectEnd").find("inside ObjectBegin cannot move"),
              std::string::npos);
    EXPECT_NE(refusal(move + "Scale 0 1 1\nShape \"sphere\"").find("is singular"), std::string::npos);
    EXPECT_NE(refusal("WorldBegin\nActiveTransform EndTime\nScale -1 1 1\nShape \"sphere\"").find("mirrored at only one"),
              std::string::npos);
}

}  // namespace
}  // namespace latent::render::testing
