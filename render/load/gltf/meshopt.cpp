#include "render/load/gltf/meshopt.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <span>
#include <type_traits>
#include <vector>

#include "base/bytes.h"

namespace latent::render {

namespace {

using std::uint32_t, std::uint8_t;

Error bad_stream(const std::string& what) { return {ErrorCode::kCorrupt, "its compressed data: " + what}; }

// Bytes in their order. After the last one, zeros, and is_short.
class PackedBytes {
 public:
    explicit PackedBytes(std::string_view bytes) : bytes_(bytes) {}
    uint8_t byte() {
        if (at_ < bytes_.size()) return static_cast<uint8_t>(bytes_[at_++]);
        is_short_ = true;
        return 0;
    }
    // Unsigned LEB128 of up to five bytes.
    uint32_t varint() {
        uint32_t out = 0;
        for (int shift = 0; shift < 35; shift += 7) {
            const uint8_t b = byte();
            out |= (b & 127u) << shift;
            if (b < 128) return out;
        }
        is_short_ = true;  // no sixth byte can follow
        return out;
    }
    bool is_short() const { return is_short_; }
    bool is_at_end() const { return !is_short_ && at_ == bytes_.size(); }

 private:
    std::string_view bytes_;
    std::size_t at_ = 0;
    bool is_short_ = false;
};

template <class T>
T from_zigzag(T v) {
    return static_cast<T>((v & 1) != 0 ? ~(v >> 1) : v >> 1);
}

// Attributes: bytes of items less those of the item before, in groups of 16.
constexpr std::size_t kGroup = 16, kMaxBlock = 256;

// A delta of `bits` each; those with all bits set follow as bytes.
void unpack_group(PackedBytes& in, unsigned bits, std::span<uint8_t, kGroup> out) {
    if (bits == 0) {
        std::ranges::fill(out, uint8_t{0});
        return;
    }
    const unsigned per_byte = 8 / bits, all_set = (1u << bits) - 1;
    for (std::size_t i = 0; i < kGroup; i += per_byte) {
        const unsigned b = in.byte();
        for (unsigned k = 0; k < per_byte; ++k)
            out[i + k] = static_cast<uint8_t>(b >> (bits == 1 ? k : 8 - bits * (k + 1)) & all_set);
    }
    if (bits == 8) return;
    for (uint8_t& delta : out) delta = delta == all_set ? in.byte() : delta;
}

// Those of one byte of `count` items.
void unpack_column(PackedBytes& in, unsigned control, bool is_v1, std::size_t count, std::span<uint8_t, kMaxBlock> out) {
    constexpr std::array<unsigned, 4> kOld{0, 2, 4, 8}, kFine{0, 1, 2, 4}, kCoarse{1, 2, 4, 8};
    if (is_v1 && control >= 2) {
        for (std::size_t i = 0; i < count; ++i) out[i] = control == 3 ? in.byte() : uint8_t{0};
        return;
    }
    const std::size_t groups = (count + kGroup - 1) / kGroup;
    std::array<uint8_t, kMaxBlock / kGroup / 4> headers{};
    for (std::size_t i = 0; i < (groups + 3) / 4; ++i) headers[i] = in.byte();
    const std::array<unsigned, 4>& bits = !is_v1 ? kOld : control == 0 ? kFine : kCoarse;
    for (std::size_t g = 0; g < groups; ++g)
        unpack_group(in, bits[headers[g / 4] >> (g % 4 * 2) & 3], out.subspan(g * kGroup).first<kGroup>());
}

template <class T>
T join(const uint8_t* bytes) {
    T out = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) out = static_cast<T>(out | T{bytes[i]} << (8 * i));
    return out;
}
template <class T>
void split(T v, uint8_t* bytes) {
    for (std::size_t i = 0; i < sizeof(T); ++i) bytes[i] = static_cast<uint8_t>(v >> (8 * i));
}

// From the four bytes before, and what was stored of these.
void add_deltas(unsigned mode, const uint8_t* delta, uint8_t* item) {
    if (mode % 16 == 0) {
        for (int i = 0; i < 4; ++i) item[i] = static_cast<uint8_t>(item[i] + from_zigzag(delta[i]));
    } else if (mode % 16 == 1) {
        for (int i = 0; i < 4; i += 2)
            split(static_cast<std::uint16_t>(join<std::uint16_t>(item + i) + from_zigzag(join<std::uint16_t>(delta + i))),
                  item + i);
    } else {
        split(join<uint32_t>(item) ^ std::rotr(join<uint32_t>(delta), static_cast<int>(mode / 16)), item);
    }
}

Result<std::string> unpack_attributes(std::string_view packed, std::size_t count, std::size_t stride) {
    const bool is_v1 = packed[0] == '\xa1';
    if (!is_v1 && packed[0] != '\xa0') return bad_stream("no attributes, or of an unknown version");
    const std::size_t channels = stride / 4, last = stride + (is_v1 ? channels : 0),
                      tail = std::max<std::size_t>(last, is_v1 ? 24 : 32);
    const std::size_t block = std::min((8192 / stride) & ~std::size_t{15}, kMaxBlock);
    if (packed.size() < 1 + tail) return bad_stream("truncated");
    // At least this much for each block: its headers.
    const std::string_view data = packed.substr(1, packed.size() - 1 - tail), end = packed.substr(packed.size() - last);
    if (count / block > data.size() / (is_v1 ? channels : stride)) return bad_stream("truncated");
    std::array<uint8_t, 256> item;
    std::array<unsigned, 64> modes{};
    for (std::size_t k = 0; k < stride; ++k) item[k] = static_cast<uint8_t>(end[k]);
    for (std::size_t c = 0; is_v1 && c < channels; ++c) {
        modes[c] = static_cast<uint8_t>(end[stride + c]);
        if (modes[c] > 1 && modes[c] % 16 != 2) return bad_stream("an unknown mode of deltas");
    }
    std::string out;
    out.reserve(count * stride);
    PackedBytes in(data);
    std::vector<std::array<uint8_t, kMaxBlock>> columns(stride);
    for (std::size_t begin = 0; begin < count; begin += block) {
        const std::size_t items = std::min(block, count - begin);
        std::array<uint8_t, 64> controls{};
        for (std::size_t c = 0; is_v1 && c < channels; ++c) controls[c] = in.byte();
        for (std::size_t k = 0; k < stride; ++k) unpack_column(in, controls[k / 4] >> (k % 4 * 2) & 3, is_v1, items, columns[k]);
        if (in.is_short()) return bad_stream("truncated");
        for (std::size_t i = 0; i < items; ++i) {
            for (std::size_t c = 0; c < channels; ++c) {
                const uint8_t delta[] = {columns[4 * c][i], columns[4 * c + 1][i], columns[4 * c + 2][i], columns[4 * c + 3][i]};
                add_deltas(modes[c], delta, &item[4 * c]);
            }
            for (std::size_t k = 0; k < stride; ++k) out.push_back(static_cast<char>(item[k]));
        }
    }
    if (!in.is_at_end()) return bad_stream("it goes on behind its end");
    return out;
}

// The last 16 of these, newest first.
template <class T>
class Recent {
 public:
    void push(const T& x) { entries_[count_++ % 16] = x; }
    // Nothing was written there: `is_missing`.
    T at(unsigned age, bool& is_missing) const {
        is_missing |= age >= std::min<std::size_t>(count_, 16);
        return entries_[(count_ + 15 - age) % 16];
    }

 private:
    std::array<T, 16> entries_{};
    std::size_t count_ = 0;
};

struct RecentEdge {
    uint32_t a = 0, b = 0;
};

// What a triangle is made of, in terms of those before.
class Triangles {
 public:
    Triangles(std::string_view codes, std::string_view data, std::string_view table) : codes_(codes), data_(data), table_(table) {}
    // False: invalid.
    bool unpack(std::vector<uint32_t>& out) {
        for (const char c : codes_) {
            const auto code = static_cast<uint8_t>(c);
            const std::array<uint32_t, 3> t = code < 0xf0 ? beside_edge(code >> 4, code & 15) : of_corners(code & 15);
            out.insert(out.end(), t.begin(), t.end());
        }
        return !is_missing_ && data_.is_at_end();
    }

 private:
    uint32_t explicit_index() { return last_ += from_zigzag(data_.varint()); }

    std::array<uint32_t, 3> beside_edge(unsigned age, unsigned third) {
        const RecentEdge e = edges_.at(age, is_missing_);
        uint32_t c = 0;
        if (third == 0) {
            c = next_++;
        } else if (third < 13) {
            c = vertices_.at(third, is_missing_);
        } else if (third < 15) {
            c = last_ = third == 13 ? last_ - 1 : last_ + 1;
        } else {
            c = explicit_index();
        }
        edges_.push({c, e.b});
        edges_.push({e.a, c});
        if (third == 0 || third >= 13) vertices_.push(c);
        return {e.a, e.b, c};
    }

    std::array<uint32_t, 3> of_corners(unsigned code) {
        const bool by_table = code < 14;
        const unsigned how = by_table ? static_cast<uint8_t>(table_[code]) : data_.byte();
        if (!by_table && how == 0) next_ = 0;
        const auto corner = [&](unsigned which) {
            return which == 0 ? next_++ : which == 15 ? explicit_index() : vertices_.at(which - 1, is_missing_);
        };
        const uint32_t a = code == 15 ? explicit_index() : next_++, b = corner(how >> 4), c = corner(how & 15);
        edges_.push({b, a});
        edges_.push({c, b});
        edges_.push({a, c});
        vertices_.push(a);
        for (const auto& [index, which] : {std::pair{b, how >> 4}, std::pair{c, how & 15}}) {
            if (which == 0 || which == 15) vertices_.push(index);
        }
        return {a, b, c};
    }

    std::string_view codes_;
    PackedBytes data_;
    std::string_view table_;
    Recent<RecentEdge> edges_;
    Recent<uint32_t> vertices_;
    uint32_t next_ = 0, last_ = 0;
    bool is_missing_ = false;
};

Result<std::vector<uint32_t>> unpack_triangles(std::string_view packed, std::size_t count) {
    if (packed[0] != '\xe1') return bad_stream("no triangles, or of an unknown version");
    if (count % 3 != 0) return bad_stream("triangles of a count that is not a multiple of 3");
    if (packed.size() < 1 + count / 3 + 16) return bad_stream("truncated");
    const std::string_view table = packed.substr(packed.size() - 16);
    for (std::size_t i = 0; i < table.size(); ++i) {
        const auto entry = static_cast<uint8_t>(table[i]);
        if (entry >> 4 == 15 || (entry & 15) == 15 || (i >= 14 && entry != 0)) return bad_stream("its table is wrong");
    }
    std::vector<uint32_t> out;
    out.reserve(count);
    const std::size_t begin = 1 + count / 3;
    if (!Triangles(packed.substr(1, count / 3), packed.substr(begin, packed.size() - 16 - begin), table).unpack(out))
        return bad_stream("its triangles do not follow from one another");
    return out;
}

Result<std::vector<uint32_t>> unpack_indices(std::string_view packed, std::size_t count) {
    if (packed[0] != '\xd1') return bad_stream("no indices, or of an unknown version");
    if (packed.size() < 1 + count + 4) return bad_stream("truncated");
    PackedBytes in(packed.substr(1, packed.size() - 5));
    std::vector<uint32_t> out;
    out.reserve(count);
    std::array<uint32_t, 2> last{};
    for (std::size_t i = 0; i < count; ++i) {
        const uint32_t v = in.varint();
        out.push_back(last[v & 1] += from_zigzag(v >> 1));
    }
    if (!in.is_at_end()) return bad_stream("it ends early, or goes on behind its end");
    return out;
}

Result<std::string> bytes_of(const Result<std::vector<uint32_t>>& indices, std::size_t stride) {
    if (!indices) return indices.error();
    std::string out;
    out.reserve(indices->size() * stride);
    for (const uint32_t i : *indices) {
        if (stride == 2 && i > 0xFFFF) return bad_stream(fmt::format("index {} has more than two bytes", i));
        for (std::size_t k = 0; k < stride; ++k) out.push_back(static_cast<char>(i >> (8 * k)));
    }
    return out;
}

// Filters, each of one item.
template <class T>
T component(const std::byte* at, std::size_t i) {
    return load_le<T>(at + i * sizeof(T));
}
template <class T>
void put(std::byte* at, std::size_t i, T x) {
    store_le(at + i * sizeof(T), x);
}
// The nearest of a type's numbers; 0 of no number.
template <class T>
T nearest(float x) {
    constexpr auto kMost = static_cast<float>(std::numeric_limits<T>::max()), kLeast = std::is_signed_v<T> ? -kMost : 0.0f;
    return static_cast<T>(x >= kLeast ? std::round(std::min(x, kMost)) : x < kLeast ? kLeast : 0.0f);
}

// Unit vectors, folded to a square.
template <class T>
void from_octahedron(std::byte* item) {
    const float one = component<T>(item, 2);
    float x = static_cast<float>(component<T>(item, 0)) / one, y = static_cast<float>(component<T>(item, 1)) / one;
    const float z = 1 - std::abs(x) - std::abs(y), below = std::min(z, 0.0f);
    x -= std::copysign(below, x);
    y -= std::copysign(below, y);
    const float scale = static_cast<float>(std::numeric_limits<T>::max()) / std::sqrt(x * x + y * y + z * z);
    put(item, 0, nearest<T>(x * scale));
    put(item, 1, nearest<T>(y * scale));
    put(item, 2, nearest<T>(z * scale));
}

// Rotations without their largest component.
void from_three(std::byte* item) {
    const auto last = component<std::int16_t>(item, 3);
    const float scale = std::sqrt(0.5f) / static_cast<float>(last | 3);
    const float x = component<std::int16_t>(item, 0) * scale, y = component<std::int16_t>(item, 1) * scale,
                z = component<std::int16_t>(item, 2) * scale, w = std::sqrt(std::max(0.0f, 1 - x * x - y * y - z * z));
    const auto largest = static_cast<std::size_t>(last & 3);
    const float in_order[] = {w, x, y, z};
    for (std::size_t i = 0; i < 4; ++i) put(item, (largest + i) % 4, nearest<std::int16_t>(in_order[i] * 32767));
}

// Floats as 2^e m.
void from_exponent(std::byte* item) {
    const auto v = component<std::int32_t>(item, 0);
    const std::int32_t e = v >> 24, m = static_cast<std::int32_t>(static_cast<uint32_t>(v) << 8) >> 8;
    put(item, 0, std::bit_cast<uint32_t>(std::ldexp(static_cast<float>(m), e)));
}

// Colours as luma and two differences.
template <class T>
void from_luma(std::byte* item) {
    const auto difference = [item](std::size_t i) {  // in two's complement
        constexpr int kSize = std::numeric_limits<T>::max() + 1;
        const int value = component<T>(item, i);
        return value < kSize / 2 ? value : value - kSize;
    };
    const unsigned alpha = component<T>(item, 3);
    const auto all = static_cast<int>(std::bit_floor(alpha) * 2) - 1;  // the largest number of K bits
    if (all <= 0) return;
    const int y = component<T>(item, 0), co = difference(1), cg = difference(2);
    const int a = static_cast<int>(alpha) & (all >> 1);
    const float scale = static_cast<float>(std::numeric_limits<T>::max()) / static_cast<float>(all);
    const int rgba[] = {y + co - cg, y + cg, y - co - cg, 2 * a | (a & 1)};
    for (std::size_t i = 0; i < 4; ++i) put(item, i, nearest<T>(static_cast<float>(rgba[i]) * scale));
}

using ItemFilter = void (*)(std::byte* item);
// A filter for items of `size` bytes, which change in place.
struct SizedFilter {
    ItemFilter filter = nullptr;
    std::size_t size = 0;
};
Result<SizedFilter> meshopt_filter(const std::string& name, std::size_t stride) {
    const bool is_small = stride == 4, is_either = is_small || stride == 8;
    if (name == "OCTAHEDRAL" && is_either)
        return SizedFilter{is_small ? from_octahedron<std::int8_t> : from_octahedron<std::int16_t>, stride};
    if (name == "QUATERNION" && stride == 8) return SizedFilter{from_three, 8};
    if (name == "EXPONENTIAL") return SizedFilter{from_exponent, 4};
    if (name == "COLOR" && is_either) return SizedFilter{is_small ? from_luma<uint8_t> : from_luma<std::uint16_t>, stride};
    if (name == "NONE") return SizedFilter{};
    return Error{ErrorCode::kUnsupported, fmt::format("its filter is \"{}\", of items of {} bytes", name, stride)};
}

}  // namespace

Result<std::string> unpack_meshopt(std::string_view packed, const MeshoptView& view) {
    const bool is_attributes = view.mode == "ATTRIBUTES";
    if (!is_attributes && view.mode != "TRIANGLES" && view.mode != "INDICES")
        return Error{ErrorCode::kUnsupported, fmt::format("its mode is \"{}\"", view.mode)};
    if (is_attributes ? view.stride % 4 != 0 || view.stride == 0 || view.stride > 256 : view.stride != 2 && view.stride != 4)
        return Error{ErrorCode::kUnsupported, fmt::format("its items have {} bytes", view.stride)};
    if (!is_attributes && view.filter != "NONE")
        return Error{ErrorCode::kUnsupported, fmt::format("its filter is \"{}\", and it holds no attributes", view.filter)};
    if (packed.empty()) return bad_stream("truncated");
    if (view.count > packed.size() * 1024) return bad_stream("truncated");
    if (view.mode == "TRIANGLES") return bytes_of(unpack_triangles(packed, view.count), view.stride);
    if (view.mode == "INDICES") return bytes_of(unpack_indices(packed, view.count), view.stride);
    const Result<SizedFilter> filter = meshopt_filter(view.filter, view.stride);
    if (!filter) return filter.error();
    Result<std::string> out = unpack_attributes(packed, view.count, view.stride);
    if (!out || filter->filter == nullptr) return out;
    for (std::size_t at = 0; at < out->size(); at += filter->size) filter->filter(reinterpret_cast<std::byte*>(out->data()) + at);
    return out;
}

}  // namespace latent::render
