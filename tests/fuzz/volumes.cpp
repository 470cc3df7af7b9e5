// Grids of NanoVDB. The smallest has 300 kB, most of them zero: so an input is a choice of a grid, and changes of its file.
#include <nanovdb/util/GridBuilder.h>
#include <nanovdb/util/IO.h>
#include <zlib.h>

#include <cmath>
#include <cstring>
#include <sstream>

#include "base/bytes.h"
#include "render/load/volume/nanovdb.h"
#include "tests/fuzz/target.h"

namespace latent::fuzz {

namespace {

// The first byte chooses type (bits 0 and 1) and compression (bit 2) of the grid; then come changes. If fewer than 12 bytes are
// left, the first two are where the file is cut, in units of 8 bytes.
constexpr std::size_t kChange = 12;  // where, u32, and what, u64

template <class BuildT>
Bytes file_of() {
    nanovdb::GridBuilder<float, BuildT> builder(0.0f, nanovdb::GridClass::FogVolume);
    auto accessor = builder.getAccessor();
    for (int i = 0; i < 24; ++i) accessor.setValue(nanovdb::Coord(i - 3, i % 7, 5 * i % 9), 1 + 0.1f * static_cast<float>(i));
    for (int i = 0; i < 8 * 8 * 8; ++i)  // a leaf that is full
        accessor.setValue(nanovdb::Coord(64 + i / 64, 64 + i / 8 % 8, i % 8), 5 + 0.1f * static_cast<float>(i % 8));
    const nanovdb::GridHandle<> grid = builder.getHandle(0.25, nanovdb::Vec3d(10, -20, 30), "density");
    std::ostringstream out(std::string(2 * grid.size() + 4096, '\0'));  // the library writes behind the end first
    nanovdb::io::writeGrid(out, grid, nanovdb::io::Codec::NONE);
    const std::string text = out.str().substr(0, static_cast<std::size_t>(out.tellp()));
    Bytes bytes(text.size());
    std::memcpy(bytes.data(), text.data(), text.size());
    return bytes;
}

const Bytes& grid_file(std::size_t choice) {
    static const std::vector<Bytes> files = {file_of<float>(), file_of<nanovdb::Fp4>(), file_of<nanovdb::Fp8>(),
                                             file_of<nanovdb::Fp16>()};
    return files[choice % files.size()];
}

// Where the grid begins, behind the heads of the file.
constexpr std::size_t kGrid = sizeof(nanovdb::io::Header) + sizeof(nanovdb::io::MetaData) + sizeof "density";

void zip(Bytes& file) {
    uLongf size = compressBound(file.size() - kGrid);
    Bytes packed(kGrid + 8 + size);
    std::memcpy(packed.data(), file.data(), kGrid);
    compress2(reinterpret_cast<Bytef*>(packed.data() + kGrid + 8), &size, reinterpret_cast<const Bytef*>(file.data() + kGrid),
              file.size() - kGrid, 1);
    const std::uint64_t stored = size;
    std::memcpy(packed.data() + kGrid, &stored, sizeof stored);
    nanovdb::io::MetaData meta;
    std::memcpy(&meta, packed.data() + sizeof(nanovdb::io::Header), sizeof meta);
    meta.codec = nanovdb::io::Codec::ZIP;
    meta.fileSize = stored + 8;
    std::memcpy(packed.data() + sizeof(nanovdb::io::Header), &meta, sizeof meta);
    packed.resize(kGrid + 8 + size);
    file = std::move(packed);
}

Bytes changed_file(ByteSpan bytes) {
    const auto choice = std::to_integer<std::size_t>(bytes[0]);
    Bytes file = grid_file(choice);
    ByteSpan rest = bytes.subspan(1);
    for (; rest.size() >= kChange; rest = rest.subspan(kChange)) {
        const auto place = load_le<std::uint32_t>(rest.data());
        // Half of them where the heads of file, grid, tree and root are.
        const std::size_t room = place < 0x80000000u ? kGrid + 1024 : file.size() - 8;
        std::memcpy(file.data() + place % room, rest.data() + 4, 8);
    }
    if ((choice & 4) != 0) zip(file);
    if (rest.size() >= 2) file.resize(std::min<std::size_t>(file.size(), std::size_t{8} * load_le<std::uint16_t>(rest.data())));
    return file;
}

bool run_nanovdb(ByteSpan bytes) {
    if (bytes.empty()) return false;
    const Bytes file = changed_file(bytes);
    const Result<render::LoadedVolume> volume = render::read_nanovdb(file, "density");
    if (!volume) return false;
    const render::VoxelGrid& grid = *volume->grid;
    for (const float value : grid.values) require(std::isfinite(value), "values are finite");
    require(grid.values.empty() || std::isfinite(grid.min_value()), "the least value is finite");
    for (const render::Vec3f p : {render::Vec3f{0, 0, 0}, {3.5f, 2.25f, 4}, {-1e9f, 1e9f, 1e30f}})
        require(std::isfinite(grid(p)), "values between voxels are finite");
    require(std::isfinite(grid.max_between({0, 0, 0}, {9, 9, 9})), "the greatest value is finite");
    return true;
}

std::vector<Bytes> nanovdb_seeds() {
    std::vector<Bytes> seeds;
    for (unsigned char choice = 0; choice < 8; ++choice) {
        seeds.push_back({std::byte{choice}});
        seeds.emplace_back(1 + 2 * kChange);  // one value, and one byte of a head as it is
        seeds.back()[0] = std::byte{choice};
        seeds.back()[4] = std::byte{0xC0};
        seeds.back()[1 + kChange + 3] = std::byte{0xC0};
    }
    return seeds;
}

}  // namespace

Target nanovdb() { return {"nanovdb", run_nanovdb, nullptr, false, 600, nanovdb_seeds}; }

}  // namespace latent::fuzz
