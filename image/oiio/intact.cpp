#include "image/oiio/intact.h"

#include <fmt/format.h>
#include <tiffio.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
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

// The marker that comes next, behind bytes that fill; none at the end of the file.
std::optional<unsigned char> next_marker(std::ifstream& in) {
    char c = 0;
    while (in.get(c) && c == '\xFF') {
    }
    if (!in) return std::nullopt;
    return static_cast<unsigned char>(c);
}

// Behind the start: segments with a length, up to the first scan; the end of the picture comes somewhere after that.
Status check_jpeg(std::ifstream& in) {
    constexpr unsigned char kScan = 0xDA, kEnd = 0xD9;
    for (std::optional<unsigned char> marker; marker != kScan;) {
        const int next = in.peek();
        if (next != 0xFF && next != std::ifstream::traits_type::eof()) return {};  // which readers may understand, or refuse
        marker = next_marker(in);
        if (!marker) return cut_off();
        if (marker == 1 || (*marker >= 0xD0 && *marker <= 0xD8)) continue;  // without a length
        std::array<char, 4> length{};
        if (!in.read(&length[2], 2)) return cut_off();
        in.ignore(static_cast<std::streamsize>(std::max(big_endian(length.data()), 2u)) - 2);
    }
    std::vector<char> block(kBlock);
    for (bool behind_marker = false; in;) {
        in.read(block.data(), static_cast<std::streamsize>(block.size()));
        const std::string_view bytes(block.data(), static_cast<std::size_t>(in.gcount()));
        if (bytes.empty()) break;
        if (behind_marker && static_cast<unsigned char>(bytes[0]) == kEnd) return {};
        if (bytes.find("\xFF\xD9") != std::string_view::npos) return {};
        behind_marker = bytes.back() == '\xFF';
    }
    return cut_off();
}

int ignore_message(TIFF*, void*, const char*, const char*, va_list) { return 1; }

// Where the strips or tiles of all pictures in the file lie.
Status check_tiff(const std::string& path) {
    struct Close {
        void operator()(TIFF* tiff) const { TIFFClose(tiff); }
        void operator()(TIFFOpenOptions* options) const { TIFFOpenOptionsFree(options); }
    };
    const std::unique_ptr<TIFFOpenOptions, Close> options(TIFFOpenOptionsAlloc());
    TIFFOpenOptionsSetErrorHandlerExtR(options.get(), ignore_message, nullptr);
    TIFFOpenOptionsSetWarningHandlerExtR(options.get(), ignore_message, nullptr);
    const std::unique_ptr<TIFF, Close> tiff(TIFFOpenExt(path.c_str(), "r", options.get()));
    std::error_code error;
    const std::uint64_t bytes = std::filesystem::file_size(path, error);
    if (tiff == nullptr || error) return {};  // which readers refuse
    while (true) {
        const std::uint32_t pieces = TIFFIsTiled(tiff.get()) ? TIFFNumberOfTiles(tiff.get()) : TIFFNumberOfStrips(tiff.get());
        if (pieces > bytes) return cut_off();
        for (std::uint32_t i = 0; i < pieces; ++i) {
            const std::uint64_t begin = TIFFGetStrileOffset(tiff.get(), i), size = TIFFGetStrileByteCount(tiff.get(), i);
            if (begin > bytes || size > bytes - begin) return cut_off();
        }
        if (TIFFLastDirectory(tiff.get()) != 0) return {};
        if (TIFFReadDirectory(tiff.get()) == 0) return cut_off();
    }
}

}  // namespace

Status check_intact(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    std::array<char, 8> front{};
    in.read(front.data(), front.size());
    const std::string_view bytes(front.data(), front.size());
    if (bytes == std::string_view("\x89PNG\r\n\x1a\n")) return check_png(in);
    if (bytes.starts_with("II") || bytes.starts_with("MM")) return check_tiff(path);
    if (!bytes.starts_with("\xFF\xD8\xFF")) return {};
    in.clear();
    in.seekg(2);
    return check_jpeg(in);
}

}  // namespace latent::image
