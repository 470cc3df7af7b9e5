// Laws of media whose density varies in space: tracking by tentative collisions has the means of the closed forms, what weights
// compare does not depend on chance, and a grid that is the same everywhere is a homogeneous medium.
#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "color/observer.h"
#include "render/medium/grid.h"
#include "render/medium/majorant_grid.h"
#include "render/sampling/halton_sampler.h"
#include "render/spectral/wavelength_density.h"
#include "tests/transport/numbers.h"
#include "tests/transport/picture_mean.h"
#include "tests/transport/pictures.h"

namespace latent::render::testing {
namespace {

using ::testing::HasSubstr;

// A grid with a value at every voxel.
std::shared_ptr<const VoxelGrid> grid_of(const std::array<std::uint32_t, 3>& size,
                                         const std::function<float(std::uint32_t, std::uint32_t, std::uint32_t)>& value) {
    VoxelGrid grid = VoxelGrid::of_size(size);
    for (std::uint32_t k = 0; k < size[2]; ++k) {
        for (std::uint32_t j = 0; j < size[1]; ++j) {
            for (std::uint32_t i = 0; i < size[0]; ++i) grid.set(i, j, k, value(i, j, k));
        }
    }
    return std::make_shared<const VoxelGrid>(std::move(grid));
}

Vec3f random_point(Numbers& u, float low, float high) {
    const auto one = [&] { return low + (high - low) * u(); };
    const float x = one(), y = one(), z = one();
    return {x, y, z};
}

TEST(VoxelGrid, IsLinearBetweenVoxelsAndZeroOutside) {
    const auto plane = [](float x, float y, float z) { return 1 + 0.5f * x + 0.25f * y + 0.125f * z; };
    const auto grid = grid_of({19, 9, 17}, [&](std::uint32_t i, std::uint32_t j, std::uint32_t k) {
        return plane(static_cast<float>(i), static_cast<float>(j), static_cast<float>(k));
    });
    Numbers u(1);
    for (int n = 0; n < 2000; ++n) {
        const Vec3f p{18 * u(), 8 * u(), 16 * u()};
        EXPECT_NEAR((*grid)(p), plane(p.x, p.y, p.z), 1e-4);
    }
    EXPECT_NEAR((*grid)({18.25f, 4, 4}), 0.75f * plane(18, 4, 4), 1e-4);  // falls to zero at the voxel that is not there
    EXPECT_NEAR((*grid)({4, -0.5f, 4}), 0.5f * plane(4, 0, 4), 1e-4);
    for (const Vec3f& p : {Vec3f{19, 4, 4}, Vec3f{-1, 4, 4}, Vec3f{4, 4, 1e30f}, Vec3f{-1e30f, 0, 0}}) EXPECT_EQ((*grid)(p), 0);
}

TEST(VoxelGrid, KeepsNoBrickOfZeros) {
    VoxelGrid grid = VoxelGrid::of_size({1000, 1000, 1000});
    grid.set(999, 500, 7, 3);
    grid.set(5, 5, 5, 0);
    EXPECT_EQ(grid.values.size(), std::size_t{VoxelGrid::kBrick});
    EXPECT_EQ(grid.at(999, 500, 7), 3);
    EXPECT_EQ(grid.at(998, 500, 7), 0);
    EXPECT_EQ(grid.at(-1, 500, 7), 0);
}

// Random values, sparse enough that some cells are empty.
std::shared_ptr<const VoxelGrid> speckled(const std::array<std::uint32_t, 3>& size) {
    std::mt19937 engine(5);
    return grid_of(size, [&](std::uint32_t, std::uint32_t, std::uint32_t) {
        const float x = static_cast<float>(engine() >> 8) * 0x1p-24f;
        return x < 0.7f ? 0 : x;
    });
}

TEST(MajorantGrid, CellsLieEndToEndAndBoundTheDensity) {
    const auto density = speckled({37, 18, 70});
    const auto voxel = [](const Vec3f& p) { return Vec3f{37 * p.x - 0.5f, 18 * p.y - 0.5f, 70 * p.z - 0.5f}; };
    const MajorantGrid majorants(
        MajorantGrid::size_for(density->size),
        [&](const Vec3f& low, const Vec3f& high) { return density->max_between(voxel(low), voxel(high)); },
        [&](const Vec3f& p) { return (*density)(voxel(p)); });
    Numbers u(2);
    int lines = 0;
    for (int n = 0; n < 2000; ++n) {
        const Vec3f from = random_point(u, -1, 2), to = random_point(u, 0, 1);
        Vec3f d = to - from;
        if (n % 7 == 0) d.x = 0;
        if (n % 5 == 0) d.y = 0;
        const float end = n % 2 == 0 ? 1e30f : 1;
        float at = -1;
        majorants.traverse(from, d, end, [&](float t0, float t1, const MajorantGrid::Cell& cell) {
            EXPECT_LT(t0, t1);
            EXPECT_TRUE(at < 0 || at == t0);
            for (int i = 0; i < 4; ++i) {
                const float t = t0 + (t1 - t0) * u();
                EXPECT_LE((*density)(voxel(from + d * t)), cell.max);
            }
            at = t1;
            return true;
        });
        if (at < 0) continue;
        ++lines;
        EXPECT_LE(at, end);
        const auto inside = [&](float t, float margin) {
            const Vec3f p = from + d * t;
            return std::min({p.x, p.y, p.z}) > -margin && std::max({p.x, p.y, p.z}) < 1 + margin;
        };
        EXPECT_TRUE(inside(at, 1e-5f));
        EXPECT_TRUE(at == end || !inside(at + 0.01f, 0));
    }
    EXPECT_GT(lines, 1000);
}

// A slab, 2 m thick and very wide, whose density grows from 0.5 to 2.5 along z: colours are absorbed very differently.
// Its spectra have another value at each wavelength, or three in all, one of which is zero.
enum class Variety { kMany, kFew };
class Slab : public ::testing::TestWithParam<Variety> {
 protected:
    static color::Spectrum line(double at_360, double at_830) {
        const auto many = [=](double nm) { return at_360 + (at_830 - at_360) * (nm - 360) / 470; };
        const auto few = [=](double nm) { return nm < 450 ? 0 : nm < 580 ? at_360 : at_830; };
        return GetParam() == Variety::kMany ? color::Spectrum::from_function(many, color::Outside::kZero)
                                            : color::Spectrum::from_function(few, color::Outside::kZero);
    }
    Slab() {
        WavelengthSampler(wavelength_density({}), 28).draw(123456789, spectra_.wavelengths);
        spectra_.start_sample();
    }
    static double density(double z) { return 0.5 + z; }
    static double column(double z0, double z1) { return 0.5 * (z1 - z0) + 0.5 * (z1 * z1 - z0 * z0); }

    static constexpr double kFrom = 0.1, kTo = 1.7;
    SpectrumLibrary library_;
    std::uint32_t sigma_t_ = library_.add(line(3, 0.1), Lookup::kNearestNm);
    std::uint32_t sigma_s_ = library_.add(line(2, 0.02), Lookup::kNearestNm);
    // 21 voxels along z, two across: the outer ones on the faces of the box.
    GridVolume volume_{.density = {grid_of({2, 2, 21}, [](std::uint32_t, std::uint32_t,
                                                          std::uint32_t k) { return 0.5f + 0.1f * static_cast<float>(k); }),
                                   Affined({0.0005, 0, 0}, {0, 0.0005, 0}, {0, 0, 10}, {0.5, 0.5, 0})}};
    // The box of the medium is 2000 x 2000 x 2 of its units.
    Affined medium_from_unit_{{2000, 0, 0}, {0, 2000, 0}, {0, 0, 2}, {-1000, -1000, 0}};
    GridMedium fog_{PhaseFunction{}, medium_from_unit_, medium_from_unit_.inverse().value(), sigma_t_, sigma_s_, kNone, volume_};
    SampledSpectra spectra_{library_};
    HaltonSampler sampler_{{}, 1, {}};
    SampleState sample_{{sampler_, 0}, spectra_, 0, Random(77)};
    Segment segment_{{0, 0, static_cast<float>(kFrom)}, {0, 0, 0.5f}, static_cast<float>(kTo - kFrom)};
};

// A mean of `count` values and its error; five of these are exceeded once in two million times.
struct Sums {
    double sum = 0, squares = 0;
    void add(double x) { sum += x, squares += x * x; }
    void expect(double expected, int count) const {
        const double mean = sum / count;
        EXPECT_NEAR(mean, expected, 5 * std::sqrt(std::max(0.0, squares / count - mean * mean) / count) + 2e-6);
    }
};

TEST_P(Slab, RatioTrackingHasTheMeanOfTheTransmittance) {
    const SampledSpectrum& sigma_t = spectra_[sigma_t_];
    constexpr int kCount = 200'000;
    std::array<Sums, 28> sums;
    std::optional<MediumStep> first;
    for (int n = 0; n < kCount; ++n) {
        SampledSpectrum value(1.0f);
        const MediumStep step = fog_.multiply_transmittance(segment_, sample_, value);
        if (!first) first = step;
        ASSERT_EQ(step.transmittance, first->transmittance);  // what weights see is no estimate
        ASSERT_EQ(step.column, first->column);
        for (std::uint32_t i = 0; i < 28; ++i) sums[i].add(static_cast<double>(value[i]));
    }
    EXPECT_NEAR(first->column, column(kFrom, kTo), 0.01 * column(kFrom, kTo));
    for (std::uint32_t i = 0; i < 28; ++i) sums[i].expect(std::exp(-static_cast<double>(sigma_t[i]) * column(kFrom, kTo)), kCount);
}

// Means of the weights: T of what passes; of what is scattered the integral of sigma_s T over the slab, and of t sigma_s T.
TEST_P(Slab, WeightsAddUpToTransmittanceAndScattering) {
    const SampledSpectrum &sigma_t = spectra_[sigma_t_], &sigma_s = spectra_[sigma_s_];
    constexpr int kCount = 300'000;
    std::array<Sums, 28> passed, scattered, first_moment;
    Numbers u(13);
    for (int n = 0; n < kCount; ++n) {
        SampledSpectrum value(1.0f);
        const Uniform channel = u(), x = u();
        const MediumStep step = fog_.sample_step(segment_, channel, x, sample_, value, nullptr);
        for (std::uint32_t i = 0; i < 28; ++i) {
            const double v = static_cast<double>(value[i]);
            passed[i].add(step.scattered ? 0 : v);
            scattered[i].add(step.scattered ? v : 0);
            first_moment[i].add(step.scattered ? v * static_cast<double>(step.t) : 0);
        }
    }
    for (std::uint32_t i = 0; i < 28; ++i) {
        const double t = static_cast<double>(sigma_t[i]), s = static_cast<double>(sigma_s[i]);
        constexpr int kSteps = 4000;
        double sum = 0, moment = 0;
        for (int j = 0; j < kSteps; ++j) {
            const double z = kFrom + (kTo - kFrom) * (j + 0.5) / kSteps;
            const double in = s * density(z) * std::exp(-t * column(kFrom, z)) * (kTo - kFrom) / kSteps;
            sum += in;
            moment += in * (z - kFrom);
        }
        passed[i].expect(std::exp(-t * column(kFrom, kTo)), kCount);
        scattered[i].expect(sum, kCount);
        first_moment[i].expect(moment, kCount);
    }
}

// So that a weight is the same whichever end a path was begun at.
TEST_P(Slab, DensitiesForWeightsAreTheSameBothWays) {
    Segment back{segment_.o + normalize(segment_.d) * segment_.length, -segment_.d, segment_.length};
    SampledSpectrum value(1.0f);
    const MediumStep there = fog_.scatter_at(segment_, segment_.length, sample_, value),
                     here = fog_.multiply_transmittance(back, sample_, value);
    EXPECT_NEAR(here.transmittance, there.transmittance, 1e-5f);
    EXPECT_NEAR(fog_.scattering_over_transmittance(back.o, here.column, sample_) * here.transmittance, there.density,
                1e-5f * there.density);
}

INSTANTIATE_TEST_SUITE_P(Spectra, Slab, ::testing::Values(Variety::kMany, Variety::kFew),
                         [](const auto& spectra) { return spectra.param == Variety::kMany ? "Many" : "Few"; });

// A room with a lamp, and something in its middle.
std::string room(const std::string& inside) {
    return "LookAt 0 -3 .8  0 0 .2  0 0 1\nCamera \"perspective\" \"float fov\" 50 \"float lensradius\" .2 \"float focaldistance\" "
           "3\n"
           "Integrator \"volpath\" \"integer maxdepth\" 8\nWorldBegin\n"
           "LightSource \"infinite\" \"rgb L\" [.2 .3 .6]\nLightSource \"point\" \"point3 from\" [1 -1 1.5] \"float power\" 40\n"
           "AttributeBegin\nTranslate -.6 -.3 2\nAreaLightSource \"diffuse\" \"blackbody L\" 3000 \"float scale\" 12\n"
           "Shape \"sphere\" \"float radius\" .3\nAttributeEnd\n"
           "Material \"diffuse\" \"rgb reflectance\" [.5 .4 .3]\n"
           "Shape \"trianglemesh\" \"point3 P\" [-4 -4 -.8  4 -4 -.8  4 4 -.8  -4 4 -.8] \"integer indices\" [0 1 2 0 2 3]\n" +
           inside;
}
std::string ball_of(const std::string& medium) {
    return medium +
           "AttributeBegin\nMediumInterface \"m\" \"\"\nMaterial \"interface\"\nShape \"sphere\" \"float radius\" "
           ".7\nAttributeEnd\n";
}

std::string repeated(const std::string& text, int count) {
    std::string out;
    for (int n = 0; n < count; ++n) out += text;
    return out;
}
// A grid of 6 x 7 x 8 voxels, larger than the ball by more than half a voxel.
const std::string kGrid = "\"integer nx\" 6 \"integer ny\" 7 \"integer nz\" 8 \"point3 p0\" [-1 -1 -1] \"point3 p1\" [1 1 1] ";

TEST(GridMedium, AUniformGridIsAHomogeneousMedium) {
    constexpr const char* kSpectra =
        " \"spectrum sigma_s\" [360 2.5 830 1] \"spectrum sigma_a\" [360 0.1 830 0.6] \"float g\" 0.4\n";
    const Scene homogeneous =
        scene_from(room(ball_of(std::string("MakeNamedMedium \"m\" \"string type\" \"homogeneous\"") + kSpectra)));
    const Scene grid = scene_from(room(ball_of("MakeNamedMedium \"m\" \"string type\" \"uniformgrid\" " + kGrid +
                                               "\"float density\" [" + repeated("1 ", 6 * 7 * 8) + "]" + kSpectra)));
    const Estimate expected = picture_of(homogeneous, {.kind = IntegratorKind::kPath}, 4096);
    expect_equal(picture_of(grid, {.kind = IntegratorKind::kPath}, 4096), expected);
    expect_equal(picture_of(grid, {.kind = IntegratorKind::kBdpt}, 4096), expected);
}

TEST(GridMedium, AUniformGridOfColoursIsAHomogeneousMedium) {
    const std::string scale = "\"float scale\" 2 \"float g\" -0.3\n";
    const Scene homogeneous =
        scene_from(room(ball_of("MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"rgb sigma_s\" [0.5 1 2] "
                                "\"rgb sigma_a\" [0.4 0.1 0.02] " +
                                scale)));
    const Scene grid = scene_from(room(ball_of("MakeNamedMedium \"m\" \"string type\" \"rgbgrid\" " + kGrid + "\"rgb sigma_s\" [" +
                                               repeated("0.5 1 2 ", 6 * 7 * 8) + "] \"rgb sigma_a\" [" +
                                               repeated("0.4 0.1 0.02 ", 6 * 7 * 8) + "] " + scale)));
    expect_equal(picture_of(grid, {.kind = IntegratorKind::kPath}, 4096),
                 picture_of(homogeneous, {.kind = IntegratorKind::kPath}, 4096));
}

// One voxel among thin ones: rays would take a step for each of its mean free paths.
TEST(GridMedium, AVoxelTooDenseToBeTrackedIsRefused) {
    const auto build = [](const std::string& voxel) {
        const Scene scene = scene_from(room(ball_of("MakeNamedMedium \"m\" \"string type\" \"rgbgrid\" " + kGrid +
                                                    "\"rgb sigma_s\" [" + repeated("0.5 1 2 ", 6 * 7 * 8 - 1) + voxel + "]\n")));
        return World::build(scene.description, "sse4.2");
    };
    EXPECT_TRUE(build("0.5 1e4 2"));
    const auto refused = build("0.5 1e9 2");
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("medium \"m\": a cell of its grid is"));
}

// Matter that scatters half and emits what it absorbs of Le: where one sees nothing else, one sees Le.
TEST(GridMedium, InsideEmissiveMatterOneSeesItsRadiance) {
    const auto inside = [](const std::string& medium) {
        return "MakeNamedMedium \"m\" " + medium +
               "\nMediumInterface \"m\" \"m\"\nLookAt 0 0 0  0 0 1  0 1 0\nCamera \"perspective\"\nIntegrator \"volpath\" "
               "\"integer maxdepth\" 200\nWorldBegin\n";
    };
    const std::string grid =
        "\"integer nx\" 2 \"integer ny\" 2 \"integer nz\" 2 \"point3 p0\" [-100 -100 -100] \"point3 p1\" [100 100 100] ";
    const std::string half = "\"spectrum sigma_s\" [360 .5 830 .9] \"spectrum sigma_a\" [360 .5 830 .9] ";
    const color::Spectrum blackbody = color::Spectrum::blackbody(4000).value();
    double luminance_sum = 0;
    for (int nm = 360; nm <= 830; ++nm) luminance_sum += blackbody(nm) * color::Observer::cie1931().at(nm)[1];
    const std::string ones = "\"string type\" \"uniformgrid\" " + half + grid + "\"float density\" [" + repeated("1 ", 8) + "] ";
    struct Case {
        std::string medium;
        double y;
    };
    for (const Case& c :
         {Case{"\"string type\" \"homogeneous\" " + half + "\"blackbody Le\" 3000 \"float Lescale\" 3", 3},
          Case{ones + "\"rgb Le\" [1 1 1] \"float Lescale\" [" + repeated("2 ", 8) + "]", 2},
          Case{ones + "\"float temperature\" [" + repeated("500 ", 8) +
                   "] \"float temperatureoffset\" 100 \"float temperaturescale\" 10 ",
               luminance_sum},
          Case{"\"string type\" \"rgbgrid\" " + grid + "\"rgb sigma_a\" [" + repeated(".5 .6 .7 ", 8) + "] \"rgb sigma_s\" [" +
                   repeated(".5 .6 .7 ", 8) + "] \"rgb Le\" [" + repeated("1 1 1 ", 8) + "] \"float Lescale\" .02",
               0.02 * 106.856895}}) {
        SCOPED_TRACE(c.medium);
        const Scene scene = scene_from(inside(c.medium));
        for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt}) {
            const Mean mean = mean_of_picture(scene, {.kind = kind, .max_depth = 0}, 4000);
            EXPECT_NEAR(mean.xyz[1], c.y, 5 * mean.error[1] + 1e-3 * c.y);
            EXPECT_LT(mean.error[1], 0.02 * c.y);
        }
    }
}

// A cloud of speckles, turned and squeezed, that is met from within and without.
TEST(GridMedium, PathAndBdptAgreeOnACloud) {
    std::string density;
    const auto speckles = speckled({6, 5, 7});
    for (int k = 0; k < 7; ++k) {
        for (int j = 0; j < 5; ++j) {
            for (int i = 0; i < 6; ++i) density += fmt::format("{} ", speckles->at(i, j, k));
        }
    }
    const std::string medium =
        "AttributeBegin\nRotate 30 1 1 0\nScale 1 .8 1.2\nTranslate -.5 -.5 -.5\nMakeNamedMedium \"m\" \"string type\" "
        "\"uniformgrid\" "
        "\"integer nx\" 6 \"integer ny\" 5 \"integer nz\" 7 \"rgb sigma_s\" [10 12 15] \"rgb sigma_a\" [.5 .3 .1] \"float g\" .5 "
        "\"float density\" [" +
        density + "]\nAttributeEnd\n";
    const Scene scene = scene_from(room(ball_of(medium)));
    expect_path_and_bdpt_agree(scene, 4096, 4096);
}

// Also where the surfaces that bound it leave room around its box.
TEST(GridMedium, IsEmptyOutsideItsBox) {
    const std::string around =
        "\"point3 p0\" [-.3 -.3 -.3] \"point3 p1\" [.3 .3 .3] \"rgb sigma_s\" [2 3 4] \"rgb sigma_a\" [.5 .3 .1] ";
    for (const std::string& kind : {"\"cloud\" \"float density\" 4 " + around,
                                    "\"uniformgrid\" \"integer nx\" 2 \"integer ny\" 2 \"integer nz\" 2 \"float density\" [" +
                                        repeated("2 ", 8) + "] " + around}) {
        const Scene scene = scene_from(
            "LookAt 0 -3 .8  0 0 .2  0 0 1\nCamera \"perspective\" \"float fov\" 30\nIntegrator \"volpath\" \"integer maxdepth\" "
            "2\n"
            "WorldBegin\nLightSource \"point\" \"point3 from\" [.9 -.6 .5]\n" +
            ball_of("MakeNamedMedium \"m\" \"string type\" " + kind + "\n"));
        const Mean path = mean_of_picture(scene, {.kind = IntegratorKind::kPath, .seed = 1}, 40'000),
                   bdpt = mean_of_picture(scene, {.kind = IntegratorKind::kBdpt, .seed = 2}, 40'000);
        EXPECT_NEAR(path.xyz[1], bdpt.xyz[1], 4.5 * std::hypot(path.error[1], bdpt.error[1]));
        EXPECT_LT(path.error[1] + bdpt.error[1], 0.05 * bdpt.xyz[1]);
    }
}

TEST(CloudMedium, PathAndBdptAgreeOnACloudOfNoise) {
    const std::string medium =
        "AttributeBegin\nTranslate -.6 -.6 -.6\nRotate 90 1 0 0\nScale 1.2 1.2 -1.2\nMakeNamedMedium \"m\" \"string type\" "
        "\"cloud\" "
        "\"rgb sigma_s\" [4 5 6] \"rgb sigma_a\" [.5 .3 .1] \"float density\" 2 \"float frequency\" 3\nAttributeEnd\n";
    const Scene scene = scene_from(room(ball_of(medium)));
    expect_path_and_bdpt_agree(scene, 1500, 1500);
}

}  // namespace
}  // namespace latent::render::testing
