// Loop's subdivision: the limit surface does not depend on how often triangles are divided first.
#include "render/load/mesh/loop_subdivision.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace latent::render {
namespace {

using ::testing::HasSubstr;

LoadedMesh icosahedron() {
    const double g = (1 + std::sqrt(5.0)) / 2;
    LoadedMesh mesh;
    mesh.positions = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                      {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
    mesh.indices = {0, 11, 5, 0, 5, 1, 0, 1, 7, 0, 7, 10, 0, 10, 11, 1, 5, 9, 5, 11, 4,  11, 10, 2,  10, 7, 6, 7, 1, 8,
                    3, 9,  4, 3, 4, 2, 3, 2, 6, 3, 6, 8,  3, 8,  9,  4, 9, 5, 2, 4,  11, 6,  2,  10, 8,  6, 7, 9, 8, 1};
    return mesh;
}
// A fan of n triangles in the plane about vertex 0, open: vertex 0 is at the boundary, with n + 1 neighbours; bent.
LoadedMesh fan(std::uint32_t n) {
    LoadedMesh mesh;
    mesh.positions = {{0, 0, 0.3}};
    for (std::uint32_t i = 0; i <= n; ++i) {
        const double angle = 3.0 * i / n;
        mesh.positions.emplace_back(std::cos(angle), std::sin(angle), 0.1 * i * i);
        if (i > 0) mesh.indices.insert(mesh.indices.end(), {0, i, i + 1});
    }
    return mesh;
}
LoadedMesh tetrahedron() {
    return {.positions = {{1, 1, 1}, {1, -1, -1.5}, {-1, 1, -1}, {-1, -1, 1}}, .indices = {0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2}};
}

// The mean of an icosahedron's vertex v and its 5 neighbours, whose sum is sqrt(5) v: v / 2 + 5 neighbours / 10.
TEST(LoopSubdivision, BringsAnIcosahedronToItsKnownLimit) {
    const LoadedMesh coarse = icosahedron();
    for (const std::uint32_t levels : {0u, 1u, 3u}) {
        const Result<LoadedMesh> fine = subdivide(coarse, levels);
        ASSERT_TRUE(fine) << fine.error().message;
        EXPECT_EQ(fine->indices.size(), coarse.indices.size() << (2 * levels));
        for (std::size_t v = 0; v < coarse.positions.size(); ++v) {
            const Vec3d expected = coarse.positions[v] * (0.5 + std::sqrt(5.0) / 10);
            EXPECT_LT(length(fine->positions[v] - expected), 1e-12);
            // Wound counterclockwise from outside, so the normals face inwards.
            EXPECT_LT(length(Vec3d(fine->normals[v]) + normalize(coarse.positions[v])), 1e-6);
        }
    }
}

TEST(LoopSubdivision, HasOneLimitWhateverTheLevels) {
    for (const LoadedMesh& coarse : {icosahedron(), tetrahedron(), fan(1), fan(2), fan(3), fan(4), fan(6)}) {
        SCOPED_TRACE(coarse.positions.size());
        const Result<LoadedMesh> reference = subdivide(coarse, 0);
        ASSERT_TRUE(reference);
        for (const std::uint32_t levels : {1u, 2u, 5u}) {
            const Result<LoadedMesh> fine = subdivide(coarse, levels);
            ASSERT_TRUE(fine);
            for (std::size_t v = 0; v < coarse.positions.size(); ++v)
                EXPECT_LT(length(fine->positions[v] - reference->positions[v]), 1e-12) << v;
        }
    }
}

// Normals are those of the fine triangles that they stand on.
TEST(LoopSubdivision, NormalsAreThoseOfFineTriangles) {
    for (const LoadedMesh& coarse : {icosahedron(), tetrahedron(), fan(1), fan(2), fan(3), fan(4), fan(6)}) {
        SCOPED_TRACE(coarse.positions.size());
        const Result<LoadedMesh> fine = subdivide(coarse, 6);
        ASSERT_TRUE(fine);
        double worst = 0;
        for (std::size_t i = 0; i < fine->indices.size(); i += 3) {
            const Vec3d &a = fine->positions[fine->indices[i]], &b = fine->positions[fine->indices[i + 1]],
                        &c = fine->positions[fine->indices[i + 2]];
            const Vec3d facet = normalize(cross(b - a, c - a));
            for (std::size_t j = 0; j < 3; ++j) worst = std::max(worst, length(Vec3d(fine->normals[fine->indices[i + j]]) + facet));
        }
        EXPECT_LT(worst, 0.15);
    }
}

TEST(LoopSubdivision, RefusesWhatIsNoSurface) {
    const auto refusal = [](std::vector<std::uint32_t> indices, std::uint32_t levels = 1) {
        LoadedMesh mesh;
        mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 2, 1}};
        mesh.indices = std::move(indices);
        const Result<LoadedMesh> fine = subdivide(mesh, levels);
        return fine ? std::string() : fine.error().message;
    };
    EXPECT_THAT(refusal({0, 1, 2, 0, 1, 3}), HasSubstr("the edge from vertex 0 to 1"));           // wound against each other
    EXPECT_THAT(refusal({0, 1, 2, 1, 0, 3, 0, 1, 4}), HasSubstr("the edge from vertex 0 to 1"));  // three of them
    EXPECT_THAT(refusal({0, 1, 1}), HasSubstr("vertex 1"));
    EXPECT_THAT(refusal({0, 1, 2, 0, 3, 4}), HasSubstr("vertex 0"));  // two fans that share a vertex
    EXPECT_EQ(refusal({0, 1, 2}, 14), "levels: 14 make 268435456 triangles; at most 16777216 are supported");
    EXPECT_EQ(refusal({0, 1, 2, 1, 3, 2, 1, 4, 3}, 13), "levels: 13 make 201326592 triangles; at most 16777216 are supported");
    EXPECT_THAT(refusal({0, 1, 2}, 0xFFFF), HasSubstr("levels: 65535 make"));
    EXPECT_EQ(refusal({0, 1, 2}), "");
}

}  // namespace
}  // namespace latent::render
