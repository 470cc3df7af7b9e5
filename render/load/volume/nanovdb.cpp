#include "render/load/volume/nanovdb.h"

#include <fmt/format.h>
#include <nanovdb/NanoVDB.h>
#include <nanovdb/util/IO.h>
#include <zlib.h>

#include <cmath>
#include <cstring>
#include <limits>

namespace latent::render {

namespace {

constexpr std::uint32_t kVersion = 32;
constexpr std::uint64_t kMaxBricks = std::uint64_t{1} << 25;  // bricks of the index over the box: 128 MiB

Error corrupt(const std::string& what) { return {ErrorCode::kCorrupt, "NanoVDB: " + what}; }
Error truncated() { return {ErrorCode::kTruncated, "NanoVDB: the file is truncated"}; }

// Bytes one after another.
class Cursor {
 public:
    explicit Cursor(std::span<const std::byte> bytes) : left_(bytes) {}
    bool is_at_end() const { return left_.empty(); }
    // False: there are fewer.
    template <class T>
    bool read(T& out) {
        if (left_.size() < sizeof(T)) return false;
        std::memcpy(&out, left_.data(), sizeof(T));
        left_ = left_.subspan(sizeof(T));
        return true;
    }
    bool take(std::uint64_t count, std::span<const std::byte>& out) {
        if (count > left_.size()) return false;
        out = left_.first(count);
        left_ = left_.subspan(count);
        return true;
    }

 private:
    std::span<const std::byte> left_;
};

// The memory of a grid, aligned as its nodes are.
class GridBytes {
 public:
    explicit GridBytes(std::uint64_t size)
        : size_(size), blocks_(static_cast<std::size_t>((size + sizeof(Block) - 1) / sizeof(Block))) {}
    std::byte* data() { return reinterpret_cast<std::byte*>(blocks_.data()); }
    std::uint64_t size() const { return size_; }
    // A node; null if it does not lie within the grid.
    template <class T>
    const T* at(std::uint64_t offset, std::uint64_t count = 1) const {
        if (offset % alignof(T) != 0 || offset > size_ || count > (size_ - offset) / sizeof(T)) return nullptr;
        return reinterpret_cast<const T*>(reinterpret_cast<const std::byte*>(blocks_.data()) + offset);
    }

 private:
    struct alignas(NANOVDB_DATA_ALIGNMENT) Block {
        std::byte bytes[NANOVDB_DATA_ALIGNMENT];
    };
    std::uint64_t size_;
    std::vector<Block> blocks_;
};

// The tree of one grid, node by node, as voxels.
template <class BuildT>
class TreeReader {
    using Leaf = nanovdb::LeafData<BuildT, nanovdb::Coord, nanovdb::Mask, 3>;
    using Lower = typename nanovdb::NanoLower<BuildT>::DataType;
    using Upper = typename nanovdb::NanoUpper<BuildT>::DataType;
    using Root = typename nanovdb::NanoRoot<BuildT>::DataType;

 public:
    TreeReader(const GridBytes& bytes, VoxelGrid& out, std::array<std::int64_t, 3>& origin)
        : bytes_(bytes), out_(out), origin_(origin) {}

    Status read() {
        constexpr std::uint64_t kTree = sizeof(nanovdb::GridData);
        const auto* tree = bytes_.at<nanovdb::TreeData<3>>(kTree);
        if (tree == nullptr) return truncated();
        const std::uint64_t offset = kTree + tree->mNodeOffset[3];
        const auto* root = bytes_.at<Root>(offset);
        if (root == nullptr) return corrupt("its root lies outside of the file");
        if (!(root->mBackground == 0)) return {Error{ErrorCode::kUnsupported, "NanoVDB: the background is not 0"}};
        const auto* tiles = bytes_.at<typename Root::Tile>(offset + sizeof(Root), root->mTableSize);
        if (tiles == nullptr) return corrupt("its root has more tiles than the file holds");
        if (Status s = make_room(root->mBBox[0], root->mBBox[1]); !s) return s;
        for (std::uint32_t i = 0; i < root->mTableSize; ++i) {
            const auto at = tiles[i].origin();
            const Place place{at[0], at[1], at[2]};
            Status s = tiles[i].child == 0 ? fill(place, 4096, tiles[i].value)
                                           : read_upper(offset + static_cast<std::uint64_t>(tiles[i].child), place);
            if (!s) return s;
        }
        return {};
    }

 private:
    using Place = std::array<std::int64_t, 3>;

    // Bricks for a box of voxels; they lie where leaves do.
    Status make_room(const nanovdb::Coord& low, const nanovdb::Coord& high) {
        std::array<std::uint32_t, 3> size;
        std::uint64_t bricks = 1;
        for (int a = 0; a < 3; ++a) {
            origin_[a] = std::int64_t{low[a]} & ~std::int64_t{7};
            const std::int64_t voxels = std::int64_t{high[a]} + 1 - origin_[a];
            if (high[a] < low[a]) return corrupt("it has no active voxels");
            if (voxels > (1 << 20)) return {Error{ErrorCode::kUnsupported, "NanoVDB: the grid is wider than 2^20 voxels"}};
            size[a] = static_cast<std::uint32_t>(voxels);
            bricks *= VoxelGrid::bricks_along(size[a]);
        }
        if (bricks > kMaxBricks)
            return {Error{ErrorCode::kUnsupported,
                          fmt::format("NanoVDB: the box of {} x {} x {} voxels is too large", size[0], size[1], size[2])}};
        out_ = VoxelGrid::of_size(size);
        return {};
    }

    // Each node of a tree has one parent: more visits than nodes fit into the file are a knot.
    template <class Node>
    const Node* node_at(std::uint64_t offset, std::uint64_t& visits) {
        return ++visits > bytes_.size() / sizeof(Node) ? nullptr : bytes_.at<Node>(offset);
    }
    template <class Node, std::int64_t kLog2, class Child>
    Status read_inner(std::uint64_t offset, const Place& place, std::uint64_t& visits, std::int64_t child_edge, Child child) {
        const Node* node = node_at<Node>(offset, visits);
        if (node == nullptr) return corrupt("a node lies outside of the file");
        constexpr std::int64_t kMask = (1 << kLog2) - 1;
        for (std::uint32_t n = 0; n < 1u << (3 * kLog2); ++n) {
            const Place at{place[0] + (n >> (2 * kLog2)) * child_edge, place[1] + ((n >> kLog2) & kMask) * child_edge,
                           place[2] + (n & kMask) * child_edge};
            Status s = node->isChild(n) ? child(offset + static_cast<std::uint64_t>(node->mTable[n].child), at)
                                        : fill(at, child_edge, node->mTable[n].value);
            if (!s) return s;
        }
        return {};
    }
    Status read_upper(std::uint64_t offset, const Place& place) {
        return read_inner<Upper, 5>(offset, place, uppers_, 128,
                                    [this](std::uint64_t at, const Place& child) { return read_lower(at, child); });
    }
    Status read_lower(std::uint64_t offset, const Place& place) {
        return read_inner<Lower, 4>(offset, place, lowers_, 8,
                                    [this](std::uint64_t at, const Place& child) { return read_leaf(at, child); });
    }
    Status read_leaf(std::uint64_t offset, const Place& place) {
        const Leaf* leaf = node_at<Leaf>(offset, leaves_);
        if (leaf == nullptr) return corrupt("a leaf lies outside of the file");
        const std::optional<Place> at = inside(place);
        if (!at) return {};
        float values[VoxelGrid::kBrick];
        bool is_empty = true;
        for (std::uint32_t n = 0; n < VoxelGrid::kBrick; ++n) {  // z first there, x first here
            const float value = leaf->getValue((n & 7) << 6 | (n & 56) | n >> 6);
            if (!std::isfinite(value)) return not_finite();
            values[n] = value;
            is_empty &= value == 0;
        }
        if (is_empty) return {};
        std::memcpy(out_.make_brick(static_cast<std::uint32_t>((*at)[0]), static_cast<std::uint32_t>((*at)[1]),
                                    static_cast<std::uint32_t>((*at)[2])),
                    values, sizeof(values));
        return {};
    }
    // A tile: the same value in a whole cube.
    Status fill(const Place& place, std::int64_t edge, float value) {
        if (!std::isfinite(value)) return not_finite();
        if (value == 0) return {};
        std::array<std::int64_t, 3> first, last;
        std::int64_t bricks = 1;
        for (int a = 0; a < 3; ++a) {
            first[a] = std::max<std::int64_t>(place[a] - origin_[a], 0);
            last[a] = std::min<std::int64_t>(place[a] - origin_[a] + edge, out_.size[a]);
            bricks *= std::max<std::int64_t>(last[a] - first[a] + 7, 0) / 8;
        }
        // No two tiles fill the same place.
        filled_ += static_cast<std::uint64_t>(bricks);
        if (filled_ > out_.brick.size()) return corrupt("tiles lie over each other");
        for (std::int64_t k = first[2]; k < last[2]; k += 8) {
            for (std::int64_t j = first[1]; j < last[1]; j += 8) {
                for (std::int64_t i = first[0]; i < last[0]; i += 8) {
                    out_.fill_brick(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j), static_cast<std::uint32_t>(k),
                                    value);
                }
            }
        }
        return {};
    }
    // From the grid's origin on, if it is in the box of active voxels.
    std::optional<Place> inside(const Place& place) const {
        Place at;
        for (int a = 0; a < 3; ++a) {
            at[a] = place[a] - origin_[a];
            if (at[a] < 0 || at[a] >= std::int64_t{out_.size[a]}) return std::nullopt;
        }
        return at;
    }
    static Status not_finite() { return corrupt("a value is not finite"); }

    const GridBytes& bytes_;
    VoxelGrid& out_;
    std::array<std::int64_t, 3>& origin_;
    std::uint64_t uppers_ = 0, lowers_ = 0, leaves_ = 0, filled_ = 0;
};

// The memory of a grid as it lies in the file.
Result<GridBytes> unpack(std::span<const std::byte> stored, std::uint64_t size, nanovdb::io::Codec codec) {
    if (codec == nanovdb::io::Codec::BLOSC)
        return Error{ErrorCode::kUnsupported, "NanoVDB: compressed by Blosc; convert it to zip or no compression"};
    if (codec == nanovdb::io::Codec::NONE) {
        if (stored.size() != size) return corrupt("the sizes of the grid differ");
        GridBytes bytes(size);
        std::memcpy(bytes.data(), stored.data(), size);
        return bytes;
    }
    if (codec != nanovdb::io::Codec::ZIP) return corrupt("its compression is unknown");
    if (stored.size() < 8) return truncated();
    stored = stored.subspan(8);                                                           // the size of what follows
    if (size / 1032 > stored.size()) return corrupt("it cannot be as large as it says");  // deflate's best
    GridBytes bytes(size);
    uLongf count = size;
    if (uncompress(reinterpret_cast<Bytef*>(bytes.data()), &count, reinterpret_cast<const Bytef*>(stored.data()), stored.size()) !=
            Z_OK ||
        count != size) {
        return corrupt("its zip data are damaged");
    }
    return bytes;
}

Result<LoadedVolume> read_grid(const GridBytes& bytes) {
    const auto* head = bytes.at<nanovdb::GridData>(0);
    if (head == nullptr) return truncated();
    if (head->mMagic != NANOVDB_MAGIC_NUMBER || head->mVersion.getMajor() != kVersion) return corrupt("the grid's head is wrong");
    if (head->mGridClass != nanovdb::GridClass::FogVolume && head->mGridClass != nanovdb::GridClass::Unknown)
        return Error{ErrorCode::kUnsupported, "NanoVDB: the grid is not a fog volume"};

    VoxelGrid grid;
    std::array<std::int64_t, 3> origin{};
    const auto read_as = [&]<class T>(T) { return TreeReader<T>(bytes, grid, origin).read(); };
    Status status;
    switch (head->mGridType) {
        case nanovdb::GridType::Float:
            status = read_as(float{});
            break;
        case nanovdb::GridType::Fp4:
            status = read_as(nanovdb::Fp4{});
            break;
        case nanovdb::GridType::Fp8:
            status = read_as(nanovdb::Fp8{});
            break;
        case nanovdb::GridType::Fp16:
            status = read_as(nanovdb::Fp16{});
            break;
        default:
            return Error{ErrorCode::kUnsupported, "NanoVDB: values must be float, Fp4, Fp8 or Fp16"};
    }
    if (!status) return status.error();

    const double* m = head->mMap.mMatD;
    const double* t = head->mMap.mVecD;
    const Affined medium_from_index({m[0], m[3], m[6]}, {m[1], m[4], m[7]}, {m[2], m[5], m[8]}, {t[0], t[1], t[2]});
    const std::optional<Affined> index_from_medium = medium_from_index.inverse();
    const nanovdb::Vec3R &low = head->mWorldBBox.min(), &high = head->mWorldBBox.max();
    LoadedVolume volume{
        std::make_shared<const VoxelGrid>(std::move(grid)), {}, {low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
    const Vec3d size = volume.high - volume.low;
    if (!index_from_medium || !std::isfinite(length_squared(index_from_medium->t)) || !(size.x > 0 && size.y > 0 && size.z > 0) ||
        !std::isfinite(length_squared(volume.low) + length_squared(volume.high))) {
        return corrupt("its transformation or its box is not one");
    }
    volume.grid_from_medium = *index_from_medium;
    volume.grid_from_medium.t +=
        -Vec3d{static_cast<double>(origin[0]), static_cast<double>(origin[1]), static_cast<double>(origin[2])};
    return volume;
}

}  // namespace

Result<LoadedVolume> read_nanovdb(std::span<const std::byte> file, std::string_view name) {
    if constexpr (std::endian::native != std::endian::little)
        return Error{ErrorCode::kUnsupported, "NanoVDB: needs a little-endian processor"};
    Cursor cursor(file);
    std::string others;
    while (!cursor.is_at_end()) {
        nanovdb::io::Header header;
        if (!cursor.read(header) || header.magic != NANOVDB_MAGIC_NUMBER) {
            if (others.empty()) return Error{ErrorCode::kForeign, "not a NanoVDB file"};
            return truncated();
        }
        if (header.version.getMajor() != kVersion) {
            return Error{ErrorCode::kUnsupported,
                         fmt::format("NanoVDB: the file has version {}, but only {} is read", header.version.getMajor(), kVersion)};
        }
        std::vector<std::pair<nanovdb::io::MetaData, std::string>> grids;
        for (std::uint32_t i = 0; i < header.gridCount; ++i) {
            nanovdb::io::MetaData meta;
            std::span<const std::byte> text;
            if (!cursor.read(meta) || !cursor.take(meta.nameSize, text)) return truncated();
            const char* chars = reinterpret_cast<const char*>(text.data());
            grids.emplace_back(meta, std::string(chars, strnlen(chars, text.size())));
        }
        for (const auto& [meta, grid_name] : grids) {
            std::span<const std::byte> stored;
            if (!cursor.take(meta.fileSize, stored)) return truncated();
            others += (others.empty() ? "" : ", ") + grid_name;
            if (grid_name != name) continue;
            const Result<GridBytes> bytes = unpack(stored, meta.gridSize, meta.codec);
            if (!bytes) return bytes.error();
            return read_grid(*bytes);
        }
    }
    if (others.empty()) return Error{ErrorCode::kForeign, "not a NanoVDB file"};
    return Error{ErrorCode::kNotFound, fmt::format("has no grid \"{}\" (it has {})", name, others)};
}

}  // namespace latent::render
