#include "image/oiio/intact.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <string_view>
#include <vector>

namespace latent::image {

namespace {

constexpr std::size_t kBlock = std::size_t{1} << 18;

Status cut_off() { return Error{ErrorCode::kCorrupt, "the file is cut off"}; }

std::uint32_t big_endian(const char* bytes) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes[i]);
    return value;
}

// Behind the signature: chunks of length, type, data and a checksum of type and data. Those that a picture can do without may be
// damaged.
Status check_png(std::ifstream& in) {
    std::vector<char> block(kBlock);
    std::array<char, 8> head{};
    for (std::uint64_t begin = head.size(); in.read(head.data(), head.size());) {
        const std::string_view type(&head[4], 4);
        uLong sum = crc32(0, reinterpret_cast<const Bytef*>(type.data()), 4);
        const std::uint64_t size = big_endian(head.data());
        for (std::uint64_t left = size; left > 0;) {
            const std::uint64_t part = std::min<std::uint64_t>(left, block.size());
            if (!in.read(block.data(), static_cast<std::streamsize>(part))) return cut_off();
            sum = crc32(sum, reinterpret_cast<const Bytef*>(block.data()), static_cast<uInt>(part));
            left -= part;
        }
        std::array<char, 4> stored{};
        if (!in.read(stored.data(), stored.size())) return cut_off();
        const bool is_critical = type[0] >= 'A' && type[0] <= 'Z';
        if (is_critical && big_endian(stored.data()) != sum)
            return Error{ErrorCode::kCorrupt, fmt::format("the file is damaged: wrong checksum of the chunk at byte {}", begin)};
        if (type == "IEND") return {};
        begin += head.size() + size + stored.size();
    }
    return cut_off();
}

// Behind the first marker: segments with a length, up to the first scan; the end of the picture comes somewhere after that.
Status check_jpeg(std::ifstream& in) {
    constexpr char kMarker = '\xFF', kScan = '\xDA', kEnd = '\xD9';
    std::array<char, 4> segment{};
    do {
        if (!in.read(segment.data(), segment.size())) return cut_off();
        if (segment[0] != kMarker) return {};  // which readers may understand, or refuse
        const std::uint32_t size = big_endian(segment.data()) & 0xFFFF;
        in.ignore(static_cast<std::streamsize>(std::max(size, 2u)) - 2);
    } while (segment[1] != kScan);
    std::vector<char> block(kBlock);
    for (char last = 0; in;) {
        in.read(block.data(), static_cast<std::streamsize>(block.size()));
        for (const char c : std::string_view(block.data(), static_cast<std::size_t>(in.gcount()))) {
            if (last == kMarker && c == kEnd) return {};
            last = c;
        }
    }
    return cut_off();
}

}  // namespace

Status check_intact(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    std::array<char, 8> front{};
    in.read(front.data(), front.size());
    const std::string_view bytes(front.data(), front.size());
    if (bytes == std::string_view("\x89PNG\r\n\x1a\n")) return check_png(in);
    if (!bytes.starts_with("\xFF\xD8\xFF")) return {};
    in.clear();
    in.seekg(2);
    return check_jpeg(in);
}

}  // namespace latent::image
