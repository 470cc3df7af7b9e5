// make_volume OUTPUT.nvdb: a NanoVDB grid "density" of 14 x 15 x 14 voxels of 0.1, for bench/features.
#include <fmt/core.h>
#include <nanovdb/util/GridBuilder.h>
#include <nanovdb/util/IO.h>

#include <exception>

int main(int argc, char** argv) {
    if (argc != 2) {
        fmt::print(stderr, "usage: make_volume OUTPUT.nvdb\n");
        return 2;
    }
    nanovdb::GridBuilder<float> builder(0.0f, nanovdb::GridClass::FogVolume);
    auto accessor = builder.getAccessor();
    for (int i = 0; i < 14; ++i) {
        for (int j = 0; j < 15; ++j) {
            for (int k = 0; k < 14; ++k)
                accessor.setValue(nanovdb::Coord(i, j, k),
                                  0.1f + 0.2f * static_cast<float>((i / 3 * 7 + j / 2 * 5 + k / 4 * 3) % 11));
        }
    }
    try {
        nanovdb::io::writeGrid(argv[1], builder.getHandle(0.1, nanovdb::Vec3d(-0.65, 0.05, -0.65), "density"));
    } catch (const std::exception& error) {
        fmt::print(stderr, "make_volume: {}\n", error.what());
        return 1;
    }
}
