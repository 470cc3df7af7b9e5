// Buffer views in the compression of meshoptimizer: whatever an encoder chooses, what is unpacked is what was packed.
#include "render/load/gltf/meshopt.h"

#include <gmock/gmock.h>

#include <array>
#include <bit>
#include <cmath>
#include <random>

#include "base/bytes.h"
#include "render/scene/content_hash.h"
#include "tests/render/models.h"
#include "tests/render/scenes.h"

namespace latent::render {
namespace {

using testing::as_glb;
using testing::Folder;
using testing::GltfFile;
using ::testing::HasSubstr;
using Json = nlohmann::json;

std::uint32_t zigzag(std::uint32_t delta, unsigned bits = 32) {
    const std::uint32_t all = bits == 32 ? ~0u : (1u << bits) - 1;
    return ((delta << 1) ^ ((delta >> (bits - 1) & 1) != 0 ? ~0u : 0)) & all;
}
void put_varint(std::string& out, std::uint32_t v) {
    for (; v > 127; v >>= 7) out += static_cast<char>((v & 127) | 128);
    out += static_cast<char>(v);
}

// An encoder that draws all of its choices.
class Encoder {
 public:
    explicit Encoder(std::uint32_t seed) : random_(seed) {}
    std::uint32_t below(std::uint32_t n) { return random_() % n; }

    std::string attributes(const std::string& items, std::size_t stride, bool is_v1) {
        const std::size_t count = items.size() / stride, channels = stride / 4,
                          most = std::min((8192 / stride) & ~std::size_t{15}, std::size_t{256});
        std::string out(1, is_v1 ? '\xa1' : '\xa0'), baseline, modes;
        for (std::size_t k = 0; k < stride; ++k) baseline += static_cast<char>(below(256));
        for (std::size_t c = 0; c < channels; ++c)
            modes += static_cast<char>(!is_v1 ? 0 : below(3) == 2 ? below(16) * 16 + 2 : below(2));
        const std::string all = baseline + items;
        const auto byte = [&](std::size_t item, std::size_t k) { return static_cast<std::uint8_t>(all[item * stride + k]); };
        // What is stored of byte k of an item: of a delta of one, two or four bytes.
        const auto stored = [&](std::size_t item, std::size_t k) -> std::uint8_t {
            const unsigned mode = static_cast<std::uint8_t>(modes[k / 4]);
            const std::size_t size = mode % 16 == 0 ? 1 : mode % 16 == 1 ? 2 : 4, first = k / size * size;
            std::uint32_t now = 0, before = 0;
            for (std::size_t i = 0; i < size; ++i) {
                now |= std::uint32_t{byte(item + 1, first + i)} << (8 * i);
                before |= std::uint32_t{byte(item, first + i)} << (8 * i);
            }
            const std::uint32_t delta = size == 4 ? std::rotl(now ^ before, static_cast<int>(mode / 16))
                                                  : zigzag(now - before, static_cast<unsigned>(8 * size));
            return static_cast<std::uint8_t>(delta >> (8 * (k - first)));
        };
        for (std::size_t begin = 0; begin < count; begin += most) {
            const std::size_t n = std::min(most, count - begin), groups = (n + 15) / 16;
            std::string controls(is_v1 ? channels : 0, '\0'), columns;
            for (std::size_t k = 0; k < stride; ++k) {
                bool is_zero = true;
                for (std::size_t i = 0; i < n; ++i) is_zero &= stored(begin + i, k) == 0;
                const unsigned control = !is_v1 ? 0 : is_zero && below(2) == 0 ? 2 : std::array{0u, 1u, 3u}[below(3)];
                if (is_v1) controls[k / 4] = static_cast<char>(controls[k / 4] | control << (k % 4 * 2));
                if (is_v1 && control == 2) continue;
                std::string headers((groups + 3) / 4, '\0'), data;
                for (std::size_t g = 0; g < groups; ++g) {
                    std::array<std::uint8_t, 16> deltas{};
                    for (std::size_t i = 0; i < 16 && g * 16 + i < n; ++i) deltas[i] = stored(begin + g * 16 + i, k);
                    const bool none = deltas == std::array<std::uint8_t, 16>{};
                    unsigned code = below(4);
                    const auto bits_of = [&](unsigned c) {
                        return !is_v1         ? std::array{0u, 2u, 4u, 8u}[c]
                               : control == 0 ? std::array{0u, 1u, 2u, 4u}[c]
                                              : std::array{1u, 2u, 4u, 8u}[c];
                    };
                    while (bits_of(code) == 0 && !none) code = below(4);
                    headers[g / 4] = static_cast<char>(headers[g / 4] | code << (g % 4 * 2));
                    data += group(deltas, bits_of(code));
                }
                if (is_v1 && control == 3) {
                    for (std::size_t i = 0; i < n; ++i) columns += static_cast<char>(stored(begin + i, k));
                } else {
                    columns += headers + data;
                }
            }
            out += controls + columns;
        }
        const std::string tail = baseline + (is_v1 ? modes : "");
        out.append(tail.size() < (is_v1 ? 24u : 32u) ? (is_v1 ? 24u : 32u) - tail.size() : 0, '\0');
        return out + tail;
    }

    std::string indices(const std::vector<std::uint32_t>& list) {
        std::string out = "\xd1";
        std::array<std::uint32_t, 2> last{};
        for (const std::uint32_t i : list) {
            const std::uint32_t which = below(2), v = zigzag(i - last[which]);
            put_varint(out, v << 1 | which);
            last[which] = i;
        }
        return out + std::string(4, '\0');
    }

    // Of each triangle, one of the codes that say it.
    std::string triangles(const std::vector<std::uint32_t>& list) {
        const std::string table("\x00\x01\x10\x12\x20\x35\x54\x02\x0e\xe0\x11\x00\x00\x00\x00\x00", 16);
        std::string codes, data;
        std::vector<std::array<std::uint32_t, 2>> edges;
        std::vector<std::uint32_t> vertices;
        std::uint32_t next = 0, last = 0;
        const auto recent = [](const auto& all, std::size_t age) { return all[all.size() - 1 - age]; };
        const auto vertex = [&](unsigned age, std::uint32_t v) {
            return age < std::min<std::size_t>(vertices.size(), 16) && recent(vertices, age) == v;
        };
        const auto put_explicit = [&](std::uint32_t v) { put_varint(data, zigzag(v - last)), last = v; };
        for (std::size_t t = 0; t < list.size(); t += 3) {
            const std::uint32_t a = list[t], b = list[t + 1], c = list[t + 2];
            unsigned code = 255;
            for (unsigned x = 0; x < 15 && x < edges.size() && below(8) > 0; ++x) {
                if (recent(edges, x) != std::array{a, b}) continue;
                unsigned third = 15;
                if (c == next && below(4) > 0) third = 0;
                for (unsigned y = 1; y < 13 && third == 15; ++y) third = vertex(y, c) ? y : 15;
                if (third == 15 && c == last - 1 && below(4) > 0) third = 13;
                if (third == 15 && c == last + 1 && below(4) > 0) third = 14;
                if (third == 0) ++next;
                if (third == 13 || third == 14) last = c;
                if (third == 15) put_explicit(c);
                edges.push_back({c, b}), edges.push_back({a, c});
                if (third == 0 || third > 12) vertices.push_back(c);
                code = x * 16 + third;
                break;
            }
            if (code == 255) {
                std::uint32_t then = next;
                const bool fresh = a == then && below(4) > 0;
                then += fresh;
                const auto corner = [&](std::uint32_t v) -> unsigned {
                    if (v == then && below(4) > 0) return then++, 0;
                    for (unsigned age = 0; age < 14; ++age) {
                        if (vertex(age, v)) return age + 1;
                    }
                    return 15;
                };
                const unsigned z = corner(b), w = corner(c), both = z * 16 + w;
                const std::size_t entry = table.substr(0, 14).find(static_cast<char>(both));
                if (fresh && entry != table.npos) {
                    code = static_cast<unsigned>(0xf0 + entry);
                } else if (both != 0) {  // 0 would start `next` again
                    code = fresh ? 254 : 255;
                    data += static_cast<char>(both);
                }
                if (both == 0 && code == 255) {
                    data += '\xff', put_explicit(a), put_explicit(b), put_explicit(c);
                    then = next;
                    vertices.insert(vertices.end(), {a, b, c});
                } else {
                    if (!fresh) put_explicit(a);
                    vertices.push_back(a);
                    for (const auto& [v, which] : {std::pair{b, z}, std::pair{c, w}}) {
                        if (which == 15) put_explicit(v);
                        if (which == 0 || which == 15) vertices.push_back(v);
                    }
                }
                next = then;
                edges.push_back({b, a}), edges.push_back({c, b}), edges.push_back({a, c});
            }
            codes += static_cast<char>(code);
        }
        return "\xe1" + codes + data + table;
    }

 private:
    static std::string group(const std::array<std::uint8_t, 16>& deltas, unsigned bits) {
        if (bits == 0) return "";
        std::string out, more;
        const unsigned per = 8 / bits, most = (1u << bits) - 1;
        for (std::size_t i = 0; i < 16; i += per) {
            unsigned b = 0;
            for (unsigned k = 0; k < per; ++k) {
                const unsigned small = bits == 8 ? deltas[i + k] : std::min<unsigned>(deltas[i + k], most);
                b |= small << (bits == 1 ? k : 8 - bits * (k + 1));
                if (bits < 8 && small == most) more += static_cast<char>(deltas[i + k]);
            }
            out += static_cast<char>(b);
        }
        return out + more;
    }
    std::mt19937 random_;
};

std::string unpacked(const std::string& packed, const MeshoptView& view) {
    const Result<std::string> out = unpack_meshopt(packed, view);
    return out ? *out : out.error().message;
}

std::string bytes_of(const std::vector<std::uint32_t>& list, std::size_t size) {
    std::string out;
    for (const std::uint32_t v : list) {
        for (std::size_t k = 0; k < size; ++k) out += static_cast<char>(v >> (8 * k));
    }
    return out;
}

// Items that change little, so that all widths of deltas occur, at lengths about those of groups and blocks.
TEST(Meshopt, AttributesAreWhatWasPacked) {
    Encoder encoder(1);
    for (const std::size_t stride : {4u, 8u, 12u, 20u, 64u, 256u}) {
        for (const std::size_t count : {1u, 15u, 16u, 17u, 255u, 256u, 300u, 513u}) {
            for (const bool is_v1 : {false, true}) {
                SCOPED_TRACE(::testing::Message() << stride << " x " << count << (is_v1 ? ", version 1" : ""));
                std::string items(stride * count, '\0');
                for (std::size_t i = 0; i < items.size(); ++i) {
                    const std::uint32_t size = i % stride % 4 == 3 ? 1 : 1 + 300 / (1 + encoder.below(300));
                    items[i] =
                        static_cast<char>((i < stride ? 0 : static_cast<unsigned char>(items[i - stride])) + encoder.below(size));
                }
                const std::string packed = encoder.attributes(items, stride, is_v1);
                ASSERT_EQ(unpacked(packed, {.mode = "ATTRIBUTES", .count = count, .stride = stride}), items);
            }
        }
    }
}

TEST(Meshopt, IndicesAreWhatWasPacked) {
    Encoder encoder(2);
    std::vector<std::uint32_t> list{0, 0x3fffffff, 5};
    for (int i = 0; i < 2000; ++i) list.push_back(encoder.below(i % 7 == 0 ? 1 << 20 : 40));
    EXPECT_EQ(unpacked(encoder.indices(list), {.mode = "INDICES", .count = list.size(), .stride = 4}), bytes_of(list, 4));
    const std::vector<std::uint32_t> small{7, 65535, 0, 1};
    EXPECT_EQ(unpacked(encoder.indices(small), {.mode = "INDICES", .count = 4, .stride = 2}), bytes_of(small, 2));
}

// A grid, a fan, and triangles that share nothing.
TEST(Meshopt, TrianglesAreWhatWasPacked) {
    for (std::uint32_t seed = 0; seed < 8; ++seed) {
        Encoder encoder(seed);
        std::vector<std::uint32_t> list;
        for (std::uint32_t y = 0; y < 12; ++y) {
            for (std::uint32_t x = 0; x < 12; ++x) {
                const std::uint32_t i = y * 13 + x;
                list.insert(list.end(), {i, i + 1, i + 13, i + 13, i + 1, i + 14});
            }
        }
        for (std::uint32_t i = 0; i < 40; ++i) list.insert(list.end(), {170, 171 + i, 172 + i});
        for (int i = 0; i < 200; ++i) list.push_back(encoder.below(1 << 24));
        list.resize(list.size() / 3 * 3);
        // Edges are found as the one before left them: (c, b) and (a, c).
        for (std::uint32_t i = 1000; i < 1040; ++i)
            list.insert(list.end(), {i + 1, i, i + 2, i + 2, i, i + 3, i + 1, i + 2, i + 5});
        ASSERT_EQ(unpacked(encoder.triangles(list), {.mode = "TRIANGLES", .count = list.size(), .stride = 4}), bytes_of(list, 4));
    }
}

// The example of the specification: 16 deltas in 4 bits, of which two are bytes.
TEST(Meshopt, ReadsTheExampleOfItsSpecification) {
    std::string packed = "\xa0";
    packed += '\x02';
    for (const int b : {0x17, 0x5f, 0xf0, 0xbc, 0x77, 0xa9, 0x21, 0x00, 0x34, 0xb5}) packed += static_cast<char>(b);
    packed += std::string(3, '\0') + std::string(32, '\0');
    const std::string out = unpacked(packed, {.mode = "ATTRIBUTES", .count = 16, .stride = 4});
    ASSERT_EQ(out.size(), 64u);
    int sum = 0, i = 0;
    for (const int delta : {-1, -4, -3, 26, -91, 0, -6, 6, -4, -4, 5, -5, 1, -1, 0, 0}) {
        sum += delta;
        EXPECT_EQ(static_cast<std::int8_t>(out[static_cast<std::size_t>(4 * i++)]), static_cast<std::int8_t>(sum));
    }
}

template <class T>
std::string item_of(std::initializer_list<int> values) {
    std::string out(sizeof(T) * values.size(), '\0');
    std::size_t i = 0;
    for (const int v : values) store_le(reinterpret_cast<std::byte*>(out.data()) + sizeof(T) * i++, static_cast<T>(v));
    return out;
}
template <class T>
T number_of(const std::string& bytes, std::size_t i) {
    return load_le<T>(reinterpret_cast<const std::byte*>(bytes.data()) + sizeof(T) * i);
}

TEST(Meshopt, FiltersGiveBackVectorsRotationsFloatsAndColours) {
    Encoder encoder(3);
    const auto filtered = [&](const std::string& item, const char* filter) {
        const std::string packed = encoder.attributes(item, item.size(), false);
        return unpacked(packed, {.mode = "ATTRIBUTES", .filter = filter, .count = 1, .stride = item.size()});
    };
    for (const int bits : {4, 8, 10, 16}) {
        const int one = (1 << (bits - 1)) - 1;
        for (int i = 0; i < 200; ++i) {
            // A point of the square, of which the vector is known.
            const int x = static_cast<int>(encoder.below(2u * one + 1)) - one,
                      y = static_cast<int>(encoder.below(2u * one + 1)) - one;
            double u = double{1} * x / one, v = double{1} * y / one;
            const double z = 1 - std::abs(u) - std::abs(v);
            if (z < 0) {
                const double folded = (1 - std::abs(v)) * (u < 0 ? -1 : 1);
                v = (1 - std::abs(u)) * (v < 0 ? -1 : 1);
                u = folded;
            }
            const double size = std::sqrt(u * u + v * v + z * z);
            const std::string out = filtered(item_of<std::int16_t>({x, y, one, -77}), "OCTAHEDRAL");
            ASSERT_NEAR(number_of<std::int16_t>(out, 0), u / size * 32767, 1);
            ASSERT_NEAR(number_of<std::int16_t>(out, 1), v / size * 32767, 1);
            ASSERT_NEAR(number_of<std::int16_t>(out, 2), z / size * 32767, 1);
            ASSERT_EQ(number_of<std::int16_t>(out, 3), -77);
        }
    }
    EXPECT_EQ(filtered(item_of<std::int8_t>({0, 0, 127, 5}), "OCTAHEDRAL"), item_of<std::int8_t>({0, 0, 127, 5}));
    EXPECT_EQ(filtered(item_of<std::int8_t>({-7, 0, 7, 0}), "OCTAHEDRAL"), item_of<std::int8_t>({-127, 0, 0, 0}));
    // Half a turn about (1, 1, 0): x is the largest; then y, z, w, times sqrt(2), of 12 bits.
    for (std::size_t largest = 0; largest < 4; ++largest) {
        const std::string out =
            filtered(item_of<std::int16_t>({2047 / 2, 0, -2047 / 4, static_cast<int>(2044 | largest)}), "QUATERNION");
        const double a = 1023 / 2047.0 / std::sqrt(2), c = -511 / 2047.0 / std::sqrt(2);
        EXPECT_NEAR(number_of<std::int16_t>(out, (largest + 1) % 4), a * 32767, 1);
        EXPECT_EQ(number_of<std::int16_t>(out, (largest + 2) % 4), 0);
        EXPECT_NEAR(number_of<std::int16_t>(out, (largest + 3) % 4), c * 32767, 1);
        EXPECT_NEAR(number_of<std::int16_t>(out, largest), std::sqrt(1 - a * a - c * c) * 32767, 1);
    }
    for (const auto& [e, m] : {std::pair{0, 5}, std::pair{-3, -12345}, std::pair{100, 1}, std::pair{-100, -(1 << 23)}}) {
        const auto bits =
            static_cast<std::int32_t>(static_cast<std::uint32_t>(e) << 24 | (static_cast<std::uint32_t>(m) & 0xFFFFFF));
        EXPECT_EQ(number_of<float>(filtered(item_of<std::int32_t>({bits}), "EXPONENTIAL"), 0),
                  std::ldexp(static_cast<float>(m), e));
    }
    // 8 bits: Co = (r - b) / 2, Cg = (2 g - r - b) / 4.
    EXPECT_EQ(filtered(item_of<std::uint8_t>({100, 30, -20, 0x80 | 0x7f}), "COLOR"), item_of<std::uint8_t>({150, 80, 90, 255}));
    EXPECT_EQ(filtered(item_of<std::uint16_t>({255, 0, 0, 0x80}), "COLOR"), item_of<std::uint16_t>({65535, 65535, 65535, 0}));
}

// Any byte may be wrong and any end missing: an error of one line, or as many bytes as the view has.
TEST(Meshopt, HostileDataAreRefusedOrHaveTheirSize) {
    Encoder encoder(4);
    std::string items(40 * 12, 'x');
    for (char& c : items) c = static_cast<char>(encoder.below(9));
    std::vector<std::uint32_t> list;
    for (std::uint32_t i = 0; i < 60; ++i) list.insert(list.end(), {i, i + 1, i + 2});
    const std::vector<std::pair<std::string, MeshoptView>> all = {
        {encoder.attributes(items, 12, false), {.mode = "ATTRIBUTES", .count = 40, .stride = 12}},
        {encoder.attributes(items, 8, true), {.mode = "ATTRIBUTES", .filter = "QUATERNION", .count = 60, .stride = 8}},
        {encoder.attributes(items, 4, true), {.mode = "ATTRIBUTES", .filter = "COLOR", .count = 120, .stride = 4}},
        {encoder.attributes(items, 4, false), {.mode = "ATTRIBUTES", .filter = "OCTAHEDRAL", .count = 120, .stride = 4}},
        {encoder.triangles(list), {.mode = "TRIANGLES", .count = 180, .stride = 2}},
        {encoder.indices(list), {.mode = "INDICES", .count = 180, .stride = 2}}};
    const auto check = [](const std::string& packed, const MeshoptView& view) {
        const Result<std::string> out = unpack_meshopt(packed, view);
        if (out) {
            EXPECT_EQ(out->size(), view.count * view.stride);
        } else {
            EXPECT_THAT(out.error().message, ::testing::Not(HasSubstr("\n")));
        }
    };
    for (const auto& [packed, view] : all) {
        for (std::size_t end = 0; end < packed.size(); ++end)
            EXPECT_FALSE(unpack_meshopt(std::string_view(packed).substr(0, end), view)) << view.mode << " " << end;
        EXPECT_FALSE(unpack_meshopt(packed + "\x01", view)) << view.mode;
        for (std::size_t i = 0; i < packed.size(); ++i) {
            for (const int wrong : {0, 1, 0x5a, 0x80, 0xff}) {
                std::string damaged = packed;
                damaged[i] = static_cast<char>(wrong);
                check(damaged, view);
            }
        }
        for (const std::uint64_t count : {std::uint64_t{0}, std::uint64_t{3}, std::uint64_t{1} << 20, std::uint64_t{1} << 40}) {
            MeshoptView other = view;
            other.count = count;
            check(packed, other);
        }
    }
}

// A file whose views are compressed is the one that they hold; the buffer that stands in for them has no bytes.
class CompressedGltf : public ::testing::Test {
 protected:
    GltfFile plain() const {
        GltfFile file;
        const Json position = file.add_floats({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0.5}, "VEC3"),
                   indices = file.add_indices({0, 1, 2, 2, 0, 3}, 5123);
        file.json["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", position}}}, {"indices", indices}}}}}};
        file.json["nodes"] = {{{"mesh", 0}}};
        file.json["scenes"] = {{{"nodes", {0}}}};
        return file;
    }
    GltfFile compressed(const std::string& extension) const {
        GltfFile file = plain();
        Encoder encoder(5);
        const std::string positions = file.binary.substr(0, 48),
                          bytes = encoder.attributes(positions, 12, extension == "KHR_meshopt_compression"),
                          indices = encoder.triangles({0, 1, 2, 2, 0, 3});
        file.binary = bytes + indices;
        Json &first = file.json["bufferViews"][0], &second = file.json["bufferViews"][1];
        first["extensions"][extension] = {
            {"buffer", 0}, {"byteLength", bytes.size()}, {"byteStride", 12}, {"count", 4}, {"mode", "ATTRIBUTES"}};
        second["extensions"][extension] = {
            {"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", indices.size()}, {"byteStride", 2},
            {"count", 6},  {"mode", "TRIANGLES"}};
        first["buffer"] = second["buffer"] = 1;
        file.json["buffers"] = {{{"byteLength", file.binary.size()}},
                                {{"byteLength", 60}, {"extensions", {{extension, {{"fallback", true}}}}}}};
        file.json["extensionsRequired"] = file.json["extensionsUsed"] = Json::array({extension});
        return file;
    }
    Result<LoadedScene> load(const GltfFile& file) const {
        GltfFile whole = file;
        whole.json["buffers"][0]["byteLength"] = whole.binary.size();
        // as_glb writes one buffer; this one has two.
        whole.json["buffers"][0]["uri"] = "data:application/octet-stream;base64," + testing::base64(whole.binary);
        return load_scene(folder_.write("a.gltf", whole.json.dump()), false, color::RgbSpectra::kSmooth, {.stage = false});
    }
    Folder folder_;
};

TEST_F(CompressedGltf, IsThePlainOne) {
    const Result<LoadedScene> expected = load(plain());
    ASSERT_TRUE(expected) << expected.error().message;
    for (const char* extension : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
        const Result<LoadedScene> scene = load(compressed(extension));
        ASSERT_TRUE(scene) << scene.error().message;
        EXPECT_THAT(scene->warnings, ::testing::IsEmpty());
        EXPECT_EQ(content_hash(scene->description), content_hash(expected->description));
    }
}

TEST_F(CompressedGltf, SaysWhichViewIsWrong) {
    const auto refused = [&](const Json::json_pointer& place, const Json& value) {
        GltfFile file = compressed("EXT_meshopt_compression");
        file.json[place] = value;
        const Result<LoadedScene> scene = load(file);
        return scene ? "" : scene.error().message;
    };
    const std::string first = "/bufferViews/0/extensions/EXT_meshopt_compression";
    EXPECT_THAT(refused(Json::json_pointer(first + "/mode"), "POINTS"), HasSubstr(first + ": its mode is \"POINTS\""));
    EXPECT_THAT(refused(Json::json_pointer(first + "/filter"), "OCTAHEDRAL"),
                HasSubstr(first + ": its filter is \"OCTAHEDRAL\", of items of 12 bytes"));
    EXPECT_THAT(refused(Json::json_pointer(first + "/byteLength"), 20), HasSubstr(first + ": its compressed data: truncated"));
    EXPECT_THAT(refused(Json::json_pointer(first + "/byteLength"), 2000), HasSubstr(first + ": ends at byte 2000 of a buffer of"));
    EXPECT_THAT(refused(Json::json_pointer(first + "/count"), 5),
                HasSubstr(first + ": 5 items of 12 bytes are not the 48 bytes of its view"));
    EXPECT_THAT(refused(Json::json_pointer(first + "/buffer"), 7), HasSubstr(first + "/buffer: "));
}

}  // namespace
}  // namespace latent::render
