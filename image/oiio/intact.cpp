#include "image/oiio/intact.h"

#include <fmt/format.h>
#include <tiffio.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdarg>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "image/plausible_size.h"

namespace latent::image {

namespace {

constexpr std::size_t kBlock = std::size_t{1} << 18;

Status cut_off() { return Error{ErrorCode::kCorrupt, "the file is cut off"}; }
Status cut_off(std::uint64_t bytes, std::uint64_t of) {
    return Error{ErrorCode::kCorrupt, fmt::format("the file is cut off: {} of {} bytes", bytes, of)};
}
Status damaged(std::string_view why) { return Error{ErrorCode::kCorrupt, fmt::format("the file is damaged: {}", why)}; }

std::uint32_t big_endian(const char* bytes) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes[i]);
    return value;
}

// The chunk at byte 8, which says what the others hold. What it may say: [PNG 11.2.1], and libpng's own limit of a side.
Status check_png_header(std::string_view type, std::string_view data) {
    constexpr std::uint32_t kMaxSide = 1'000'000;
    constexpr std::string_view kDepths[] = {{"\1\2\4\10\20"}, "", "\10\20", "\1\2\4\10", "\10\20", "", "\10\20"};  // by colour type
    if (type != "IHDR" || data.size() != 13) return damaged("the chunk at byte 8 is not a PNG header");
    const std::uint32_t width = big_endian(data.data()), height = big_endian(data.data() + 4);
    const auto depth = static_cast<unsigned char>(data[8]), color = static_cast<unsigned char>(data[9]);
    if (width == 0 || height == 0 || width > kMaxSide || height > kMaxSide)
        return damaged(fmt::format("the PNG header at byte 8 says {} x {} pixels; a side has 1 to {}", width, height, kMaxSide));
    if (color >= std::size(kDepths) || kDepths[color].find(data[8]) == std::string_view::npos)
        return damaged(
            fmt::format("the PNG header at byte 8 says {} bits of colour type {}, which PNG does not have", depth, color));
    if (data[10] != 0 || data[11] != 0 || static_cast<unsigned char>(data[12]) > 1)
        return damaged(fmt::format("the PNG header at byte 8 says compression {}, filter {}, interlace {}, which PNG does not have",
                                   static_cast<unsigned char>(data[10]), static_cast<unsigned char>(data[11]),
                                   static_cast<unsigned char>(data[12])));
    return {};
}

// Behind the signature: chunks of length, type, data and a checksum of type and data. Those that a picture can do without may be
// damaged.
Status check_png(std::ifstream& in) {
    std::vector<char> block(kBlock);
    std::array<char, 8> head{};
    bool needs_palette = false, has_palette = false, has_pixels = false;
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
            return damaged(fmt::format("wrong checksum of the chunk at byte {}", begin));
        if (begin == head.size()) {
            constexpr char kPalette = 3;
            const std::string_view header(block.data(), std::min<std::uint64_t>(size, block.size()));
            if (Status s = check_png_header(type, header); !s) return s;
            needs_palette = header[9] == kPalette;
        }
        has_palette = has_palette || type == "PLTE";
        has_pixels = has_pixels || type == "IDAT";
        if (has_pixels && needs_palette && !has_palette) return damaged("there is no palette");
        if (type == "IEND") return has_pixels ? Status{} : damaged("there are no pixels in it");
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
        const bool is_frame = *marker >= 0xC0 && *marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
        if (const int bits = in.peek(); is_frame && (bits == 12 || bits == 16))
            return Error{ErrorCode::kUnsupported,
                         fmt::format("its samples have {} bits; convert it to a PNG or TIFF, or to a JPEG of 8", bits)};
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

// "RIFF", the size of what follows, "WEBP", and a chunk of pixels or of what is beside them.
Status check_webp(std::ifstream& in, std::uint64_t bytes) {
    std::array<char, 16> front{};
    if (!in.read(front.data(), front.size())) return cut_off();
    const std::string_view text(front.data(), front.size());
    std::uint64_t size = 8;
    for (std::size_t i = 0; i < 4; ++i) size += std::uint64_t{static_cast<unsigned char>(front[4 + i])} << (8 * i);
    if (text.substr(8, 4) != "WEBP") return damaged("it begins as WebP does, but byte 8 is not \"WEBP\"");
    if (bytes < size) return cut_off(bytes, size);
    const std::string_view chunk = text.substr(12);
    if (chunk != "VP8 " && chunk != "VP8L" && chunk != "VP8X") return damaged("the chunk at byte 12 is none of WebP's");
    return {};
}

// PFM, and PGM and PPM of bytes: "PF", width, height, and the scale or largest value, each behind white space, and one more of
// that.
Status check_pnm(std::ifstream& in, std::uint64_t bytes) {
    std::string text(kBlock, '\0');
    in.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(in.gcount()));
    const bool is_float = text[1] == 'F' || text[1] == 'f';
    std::array<double, 3> numbers{};
    std::size_t at = 2;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        constexpr std::string_view kSpace = " \t\r\n";
        for (at = text.find_first_not_of(kSpace, at); at < text.size() && text[at] == '#';)
            at = text.find_first_not_of(kSpace, text.find('\n', at));
        if (at >= text.size()) return cut_off();
        const bool has_plus = text[at] == '+';
        const auto [end, failed] = std::from_chars(text.data() + at + (has_plus ? 1 : 0), text.data() + text.size(), numbers[i]);
        const bool is_side = i < 2 && numbers[i] >= 1 && numbers[i] < 0x1p31 && numbers[i] == std::floor(numbers[i]);
        const bool is_range =
            i == 2 && (is_float ? numbers[i] != 0 && std::isfinite(numbers[i]) : numbers[i] >= 1 && numbers[i] < 65536);
        if (failed != std::errc{} || !(is_side || is_range)) {
            const char* const what = i == 0 ? "width" : i == 1 ? "height" : is_float ? "scale" : "largest value";
            return damaged(fmt::format("its header gives no {} at byte {}", what, at));
        }
        at = static_cast<std::size_t>(end - text.data());
    }
    const bool is_colour = text[1] == 'F' || text[1] == '6';
    const double depth = is_float           ? 4
                         : numbers[2] > 255 ? 2
                                            : 1,
                 size = static_cast<double>(at) + 1 + numbers[0] * numbers[1] * depth * (is_colour ? 3 : 1);
    const bool is_huge = !is_plausible_size(static_cast<std::uint64_t>(numbers[0]), static_cast<std::uint64_t>(numbers[1]), bytes);
    if (is_huge || static_cast<double>(bytes) >= size) return {};  // what is huge, the reader refuses
    return cut_off(bytes, static_cast<std::uint64_t>(size));
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
        std::uint16_t bits = 0;
        if (TIFFGetField(tiff.get(), TIFFTAG_BITSPERSAMPLE, &bits) == 0)  // OpenImageIO takes it for eight
            return Error{ErrorCode::kUnsupported,
                         "it does not say how many bits a sample has (BitsPerSample), which means 1; convert it to a PNG"};
        std::uint16_t colors = 0;
        TIFFGetField(tiff.get(), TIFFTAG_PHOTOMETRIC, &colors);
        if (colors == PHOTOMETRIC_CIELAB || colors == PHOTOMETRIC_ICCLAB || colors == PHOTOMETRIC_ITULAB)
            return Error{ErrorCode::kUnsupported,
                         "its colours are L*a*b*; convert it to RGB"};  // OpenImageIO takes them for R, G, B
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

// The header says how many bytes the largest level has, or a row of it. Others follow.
Status check_dds(std::ifstream& in, std::uint64_t size) {
    constexpr std::uint64_t kHeader = 128, kPitch = 8, kLinearSize = 0x80000;
    std::array<unsigned char, 24> header{};
    if (!in.read(reinterpret_cast<char*>(header.data()), header.size()) || size < kHeader) return cut_off();
    const auto number = [&](std::size_t at) {
        return header[at] | std::uint64_t{header[at + 1]} << 8 | std::uint64_t{header[at + 2]} << 16 |
               std::uint64_t{header[at + 3]} << 24;
    };
    const std::uint64_t flags = number(8), height = number(12), bytes = number(20);
    const std::uint64_t needed = kHeader + ((flags & kLinearSize) != 0 ? bytes : (flags & kPitch) != 0 ? bytes * height : 0);
    return size < needed ? cut_off(size, needed) : Status{};
}

Result<bool> checked(const Status& status) {
    if (!status) return status.error();
    return true;
}

}  // namespace

Result<bool> check_intact(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    std::array<char, 8> front{};
    in.read(front.data(), front.size());
    const std::string_view bytes(front.data(), front.size());
    std::error_code failed;
    const std::uintmax_t size = std::filesystem::file_size(path, failed);
    if (failed) return false;
    if (size == 0) return Error{ErrorCode::kCorrupt, "the file is empty"};
    if (bytes == std::string_view("\x89PNG\r\n\x1a\n")) return checked(check_png(in));
    if (bytes.starts_with("\x89PNG") && size < bytes.size()) return cut_off().error();
    if (bytes.starts_with("\x89PNG")) return damaged("its signature is not PNG's, as after a transfer in text mode").error();
    if (bytes.starts_with("II") || bytes.starts_with("MM")) return checked(check_tiff(path));
    if (bytes == "version ")
        return Error{ErrorCode::kForeign, "the file is a Git LFS pointer instead of the picture; fetch that with: git lfs pull"};
    in.clear();
    in.seekg(0);
    for (const std::string_view pnm : {"PF", "Pf", "P5", "P6"}) {
        if (bytes.starts_with(pnm)) return checked(check_pnm(in, size));
    }
    if (bytes.starts_with("DDS ")) return checked(check_dds(in, size));
    if (bytes.starts_with("RIFF")) return checked(check_webp(in, size));
    if (!bytes.starts_with("\xFF\xD8\xFF")) return false;
    in.seekg(2);
    return checked(check_jpeg(in));
}

}  // namespace latent::image
