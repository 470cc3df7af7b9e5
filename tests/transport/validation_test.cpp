// Whole pictures against pbrt-v4's, in block means (refs/README.md): the short form of bench/validate. Agreement is a statement
// about errors: each difference is measured in its own combined standard error, and an error of 2 % in the picture must be seen.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "tests/faults/process.h"
#include "tests/support/paths.h"
#include "tests/transport/pictures.h"

namespace latent::render::testing {
namespace {

// With 15 degrees of freedom in our errors z is a little wider than normal: of 192 values the largest stays below 4.9 but once in a
// thousand pictures, and the mean of 64 squares lies in 0.55 .. 1.65 (Student's t: mean 1.15, standard deviation 0.23).
bool agrees(const Verdict& v, bool by_blocks) {
    const bool blocks = v.worst_z < 4.9 && v.mean_z2 > 0.5 && v.mean_z2 < 1.75;
    return (blocks || !by_blocks) && (std::abs(v.whole_relative) < 0.003 || std::abs(v.whole_z) < 3.5);
}

// Without noise, a block of plain sky differs from pbrt-v4's by 0.019 %: what no standard error says is assumed to be half of that.
constexpr double kSystematic = 1e-4;

void expect_agreement(Estimate ours, const Estimate& reference, bool by_blocks) {
    for (std::size_t b = 0; b < ours.mean.xyz.size(); ++b) {
        for (std::size_t c = 0; c < 3; ++c)
            ours.error.xyz[b][c] = std::hypot(ours.error.xyz[b][c], kSystematic * reference.mean.xyz[b][c]);
    }
    for (std::size_t c = 0; c < 3; ++c) {
        const Verdict v = compare(ours, reference, c);
        const std::string what = fmt::format("{}: worst z {:.2f}, mean z^2 {:.2f}, whole {:+.3f} % ({:.1f} standard errors)",
                                             "XYZ"[c], v.worst_z, v.mean_z2, 100 * v.whole_relative, v.whole_z);
        EXPECT_TRUE(agrees(v, by_blocks)) << what;
        EXPECT_LT(v.whole_error, 0.004) << "too noisy to see an error of 2 %";
        fmt::print("    {}\n", what);
    }
}

struct SceneCase {
    const char* scene;
    IntegratorKind kind;
    Connections connections;
    std::uint64_t samples;  // of each seed
    bool by_blocks =
        true;  // else the whole picture alone: caustics that a path finds by chance make errors of blocks too uncertain
};

// A file of scenes/. The forest's trees are made for it, elsewhere.
Scene scene_to_compare(const std::string& name) {
    if (name != "forest") return scene_named(name + ".pbrt");
    const std::string scenes = latent::testing::in_tree("scenes/");
    const latent::testing::TemporaryFolder folder;
    const latent::testing::Outcome made = latent::testing::run({scenes + "make_forest", folder.path().string()});
    if (made.status != 0) throw std::runtime_error(made.err);
    std::filesystem::copy(scenes + "forest.pbrt", folder / "forest.pbrt");
    return scene_of(load_scene(folder / "forest.pbrt"));
}

class Validation : public ::testing::TestWithParam<SceneCase> {};

TEST_P(Validation, BlockMeansAreThoseOfTheReference) {
    const SceneCase& c = GetParam();
    const Scene scene = scene_to_compare(c.scene);
    const Estimate reference = read_reference(latent::testing::in_tree(std::string("tests/transport/refs/") + c.scene + ".csv"));
    const Estimate ours = picture_of(scene, {.kind = c.kind, .connections = c.connections}, c.samples);
    expect_agreement(ours, reference, c.by_blocks);

    // The same picture, 2 % brighter, is refused: in every channel, by the blocks or by the whole.
    Estimate wrong = ours;
    for (auto& xyz : wrong.mean.xyz) {
        for (double& v : xyz) v *= 1.02;
    }
    for (std::size_t channel = 0; channel < 3; ++channel)
        EXPECT_FALSE(agrees(compare(wrong, reference, channel), c.by_blocks)) << "XYZ"[channel];
}

INSTANTIATE_TEST_SUITE_P(Scenes, Validation,
                         ::testing::Values(SceneCase{"cornell", IntegratorKind::kPath, Connections::kOne, 262144, false},
                                           SceneCase{"cornell", IntegratorKind::kBdpt, Connections::kOne, 196608},
                                           SceneCase{"sodium", IntegratorKind::kPath, Connections::kOne, 65536},
                                           SceneCase{"sodium", IntegratorKind::kBdpt, Connections::kAll, 49152},
                                           SceneCase{"conductors", IntegratorKind::kPath, Connections::kOne, 32768},
                                           SceneCase{"forest", IntegratorKind::kBdpt, Connections::kOne, 16384},
                                           SceneCase{"fog", IntegratorKind::kBdpt, Connections::kOne, 32768}),
                         [](const auto& instance) {
                             const SceneCase& c = instance.param;
                             return std::string(c.scene) + (c.kind == IntegratorKind::kPath      ? "_path"
                                                            : c.connections == Connections::kOne ? "_bdpt_one"
                                                                                                 : "_bdpt_all");
                         });

}  // namespace
}  // namespace latent::render::testing
