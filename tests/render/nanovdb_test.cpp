// NanoVDB files, written by the library that defines them: every value is read back where it belongs, and what is damaged, cut off
// or of another kind is refused with one line.
#include "render/load/volume/nanovdb.h"

#include <gmock/gmock.h>

#define NANOVDB_USE_ZIP
#include <nanovdb/util/GridBuilder.h>
#include <nanovdb/util/IO.h>

#include <random>
#include <sstream>
#include <type_traits>

#include "tests/render/scenes.h"

namespace latent::render {
namespace {

using testing::Folder;
using ::testing::HasSubstr;

std::span<const std::byte> bytes_of(const std::string& text) { return std::as_bytes(std::span(text)); }

// Blobs far apart, with a tile that is the same everywhere, on both sides of zero. (The library cannot quantise equal values.)
template <class BuildT = float>
nanovdb::GridHandle<> blobs(const std::string& name = "density", nanovdb::GridClass grid_class = nanovdb::GridClass::FogVolume) {
    nanovdb::GridBuilder<float, BuildT> builder(0.0f, grid_class);
    auto accessor = builder.getAccessor();
    std::mt19937 engine(3);
    for (int n = 0; n < 3000; ++n) {
        const int i = static_cast<int>(engine() % 20), j = static_cast<int>(engine() % 30), k = static_cast<int>(engine() % 9);
        accessor.setValue(n % 3 == 0 ? nanovdb::Coord(i - 40, j - 7, k) : nanovdb::Coord(i + 170, j, k - 100),
                          1 + static_cast<float>(engine() % 1000) * 0.01f);
    }
    for (int i = 0; i < 16; ++i) {
        for (int j = 0; j < 16; ++j) {
            for (int k = 0; k < 16; ++k) {
                const float value = std::is_same_v<BuildT, float> ? 5.0f : 5.0f + 0.1f * static_cast<float>(k % 8);
                accessor.setValue(nanovdb::Coord(64 + i, 64 + j, -32 + k), value);
            }
        }
    }
    return builder.getHandle(0.25, nanovdb::Vec3d(10, -20, 30), name);
}
std::string file_of(const nanovdb::GridHandle<>& grid, nanovdb::io::Codec codec = nanovdb::io::Codec::NONE) {
    // The library writes behind the end first, which a stream in memory must have room for.
    std::ostringstream out(std::string(2 * grid.size() + 4096, '\0'));
    nanovdb::io::writeGrid(out, grid, codec);
    return out.str().substr(0, static_cast<std::size_t>(out.tellp()));
}
std::string refusal(const std::string& file, const std::string& name = "density") {
    const Result<LoadedVolume> volume = read_nanovdb(bytes_of(file), name);
    return volume ? "" : volume.error().message;
}

template <class BuildT>
void expect_read_back(const nanovdb::GridHandle<>& handle, nanovdb::io::Codec codec) {
    const auto* grid = handle.template grid<BuildT>();
    ASSERT_NE(grid, nullptr);
    const std::string file = file_of(handle, codec);
    const Result<LoadedVolume> volume = read_nanovdb(bytes_of(file), "density");
    ASSERT_TRUE(volume) << volume.error().message;
    const nanovdb::CoordBBox box = grid->indexBBox();
    const auto accessor = grid->getAccessor();
    std::uint64_t differences = 0;
    for (auto it = box.begin(); it; ++it) {
        const nanovdb::Vec3d world = grid->indexToWorld((*it).asVec3d());
        const Vec3d at = volume->grid_from_medium.point({world[0], world[1], world[2]});
        differences += volume->grid->at(static_cast<std::int32_t>(std::lround(at.x)), static_cast<std::int32_t>(std::lround(at.y)),
                                        static_cast<std::int32_t>(std::lround(at.z))) != accessor.getValue(*it);
    }
    EXPECT_EQ(differences, 0u);
    EXPECT_EQ(volume->low, Vec3d(grid->worldBBox().min()[0], grid->worldBBox().min()[1], grid->worldBBox().min()[2]));
    EXPECT_EQ(volume->high, Vec3d(grid->worldBBox().max()[0], grid->worldBBox().max()[1], grid->worldBBox().max()[2]));
}

TEST(NanoVdb, EveryVoxelIsReadBack) {
    expect_read_back<float>(blobs(), nanovdb::io::Codec::NONE);
    expect_read_back<float>(blobs(), nanovdb::io::Codec::ZIP);
}

TEST(NanoVdb, QuantisedValuesAreReadAsTheLibraryReadsThem) {
    expect_read_back<nanovdb::Fp8>(blobs<nanovdb::Fp8>(), nanovdb::io::Codec::NONE);
    expect_read_back<nanovdb::Fp16>(blobs<nanovdb::Fp16>(), nanovdb::io::Codec::NONE);
    expect_read_back<nanovdb::Fp4>(blobs<nanovdb::Fp4>(), nanovdb::io::Codec::ZIP);
}

TEST(NanoVdb, AGridIsFoundByItsName) {
    std::string file = file_of(blobs("smoke")) + file_of(blobs("density"), nanovdb::io::Codec::ZIP);
    EXPECT_EQ(refusal(file), "");
    EXPECT_EQ(refusal(file, "smoke"), "");
    EXPECT_EQ(refusal(file, "fire"), "has no grid \"fire\" (it has smoke, density)");
}

TEST(NanoVdb, OtherFilesAndGridsAreRefused) {
    EXPECT_EQ(refusal(""), "not a NanoVDB file");
    EXPECT_EQ(refusal("ply\nformat ascii 1.0\n"), "not a NanoVDB file");
    EXPECT_THAT(refusal(file_of(blobs("density", nanovdb::GridClass::LevelSet))), HasSubstr("not a fog volume"));
    std::string old = file_of(blobs());
    old[11] = 1;  // the top bits of the version
    EXPECT_THAT(refusal(old), HasSubstr("but only 32 is read"));
    nanovdb::GridBuilder<double> doubles(0, nanovdb::GridClass::FogVolume);
    doubles.getAccessor().setValue(nanovdb::Coord(1, 2, 3), 1.0);
    EXPECT_THAT(refusal(file_of(doubles.getHandle(1, nanovdb::Vec3d(0), "density"))), HasSubstr("values must be float"));
    nanovdb::GridBuilder<float> thick(1, nanovdb::GridClass::FogVolume);
    thick.getAccessor().setValue(nanovdb::Coord(1, 2, 3), 2.0f);
    EXPECT_THAT(refusal(file_of(thick.getHandle(1, nanovdb::Vec3d(0), "density"))), HasSubstr("the background is not 0"));
    nanovdb::GridBuilder<float> wide(0, nanovdb::GridClass::FogVolume);
    wide.getAccessor().setValue(nanovdb::Coord(-1000000, 2, 3), 2.0f);
    wide.getAccessor().setValue(nanovdb::Coord(1000000, 2, 3), 2.0f);
    EXPECT_THAT(refusal(file_of(wide.getHandle(1, nanovdb::Vec3d(0), "density"))), HasSubstr("wider than 2^20 voxels"));
    nanovdb::GridBuilder<float> infinite(0, nanovdb::GridClass::FogVolume);
    infinite.getAccessor().setValue(nanovdb::Coord(1, 2, 3), std::numeric_limits<float>::infinity());
    EXPECT_THAT(refusal(file_of(infinite.getHandle(1, nanovdb::Vec3d(0), "density"))), HasSubstr("not finite"));
}

TEST(NanoVdb, AFileCutAnywhereIsRefused) {
    for (const nanovdb::io::Codec codec : {nanovdb::io::Codec::NONE, nanovdb::io::Codec::ZIP}) {
        const std::string file = file_of(blobs(), codec);
        for (std::size_t cut = 0; cut < file.size(); cut += cut < 300 ? 1 : 9973)
            EXPECT_NE(refusal(file.substr(0, cut)), "") << cut;
    }
}

// A bit turned anywhere in the heads and nodes: read or refused, but never a crash, and no value that is not finite.
TEST(NanoVdb, DamageIsRefusedOrReadAsOtherValues) {
    const std::string file = file_of(blobs());
    std::mt19937 engine(8);
    int refused = 0;
    for (int n = 0; n < 400; ++n) {
        std::string damaged = file;
        const std::size_t range = n % 2 == 0 ? 2000 : file.size();  // heads, root; all
        for (int bits = 0; bits < 1 + n % 3; ++bits) damaged[engine() % range] ^= static_cast<char>(1u << engine() % 8);
        const Result<LoadedVolume> volume = read_nanovdb(bytes_of(damaged), "density");
        refused += !volume;
        if (!volume) continue;
        for (const float value : volume->grid->values) ASSERT_TRUE(std::isfinite(value));
    }
    EXPECT_GT(refused, 20);
}

TEST(NanoVdb, ASceneNamesItsGrids) {
    const Folder folder;
    std::ofstream(folder / "smoke.nvdb", std::ios::binary) << file_of(blobs()) << file_of(blobs("temperature"));
    std::ofstream(folder / "bad.nvdb", std::ios::binary) << file_of(blobs()).substr(0, 5000);
    const auto scene = [&](const std::string& parameters) {
        return load_scene(folder.write("scene.pbrt",
                                       "Camera \"perspective\"\nWorldBegin\nLightSource \"point\"\n"
                                       "MakeNamedMedium \"m\" \"string type\" \"nanovdb\" " +
                                           parameters +
                                           "\nMediumInterface \"m\" \"\"\nMaterial \"interface\"\nShape \"sphere\"\n"));
    };
    const Result<LoadedScene> smoke =
        scene("\"string filename\" \"smoke.nvdb\" \"float Lescale\" 2 \"float temperaturescale\" 300");
    ASSERT_TRUE(smoke) << smoke.error().message;
    const auto* volume = std::get_if<GridVolume>(&smoke->description.media.at(0).volume);
    ASSERT_NE(volume, nullptr);
    EXPECT_NE(volume->density.grid, nullptr);
    EXPECT_NE(volume->temperature.grid, nullptr);
    EXPECT_EQ(volume->temperature_scale, 300);
    EXPECT_EQ(smoke->description.media[0].Le_scale, 2);
    const auto message = [&](const std::string& parameters) {
        const Result<LoadedScene> loaded = scene(parameters);
        return loaded ? std::string() : loaded.error().message;
    };
    EXPECT_THAT(message("\"string filename\" \"bad.nvdb\""), HasSubstr("bad.nvdb: NanoVDB: the file is truncated"));
    EXPECT_THAT(message("\"string filename\" \"no.nvdb\""), HasSubstr("no.nvdb"));
    EXPECT_THAT(message(""), HasSubstr("filename: is required"));
    EXPECT_THAT(message("\"string filename\" \"smoke.nvdb\" \"string gridname\" \"fog\""),
                HasSubstr("smoke.nvdb: has no grid \"fog\" (it has density, temperature)"));
}

}  // namespace
}  // namespace latent::render
