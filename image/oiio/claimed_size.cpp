#include "image/oiio/claimed_size.h"

#include <algorithm>
#include <fstream>
#include <string>
#include <string_view>

namespace latent::image {

namespace {

constexpr std::size_t kFront = std::size_t{1} << 20;

// A place in the front of a file; reading behind its end gives zeros, and ends.
class Front {
 public:
    explicit Front(std::string_view bytes) : left_(bytes) {}
    bool is_at_end() const { return left_.empty(); }
    std::size_t left() const { return left_.size(); }
    void skip(std::size_t count) { left_.remove_prefix(std::min(count, left_.size())); }
    std::size_t big_endian(std::size_t bytes) {
        std::size_t value = 0;
        for (; bytes > 0; --bytes) value = value << 8 | byte();
        return value;
    }
    std::uint32_t little_endian(unsigned bytes = 4) {
        std::uint32_t value = 0;
        for (unsigned shift = 0; shift < 8 * bytes; shift += 8) value |= static_cast<std::uint32_t>(byte()) << shift;
        return value;
    }
    // Up to a zero.
    std::string_view name() {
        const std::string_view text = left_.substr(0, left_.find('\0'));
        skip(text.size() + 1);
        return text;
    }

 private:
    std::size_t byte() {
        const std::size_t value = left_.empty() ? 0 : static_cast<unsigned char>(left_[0]);
        skip(1);
        return value;
    }
    std::string_view left_;
};

// The first frame header.
ClaimedSize jpeg_size(Front front) {
    front.skip(2);
    while (!front.is_at_end()) {
        if (front.big_endian(1) != 0xFF) continue;
        std::size_t marker = front.big_endian(1);
        while (marker == 0xFF) marker = front.big_endian(1);
        if (marker == 0 || marker == 1 || (marker >= 0xD0 && marker <= 0xD8)) continue;  // without a length
        const std::size_t length = front.big_endian(2);
        if (marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC) {
            front.skip(1);
            const std::size_t height = front.big_endian(2), width = front.big_endian(2);
            return {width, height};
        }
        front.skip(length - std::min<std::size_t>(length, 2));
    }
    return {};
}

// The canvas on which all frames are drawn.
ClaimedSize gif_size(Front front) {
    front.skip(6);
    const std::uint32_t width = front.little_endian(2), height = front.little_endian(2);
    return {width, height};
}

std::uint64_t span(std::uint32_t first, std::uint32_t last) {
    return static_cast<std::uint64_t>(
        std::max<std::int64_t>(std::int64_t{static_cast<std::int32_t>(last)} - static_cast<std::int32_t>(first) + 1, 0));
}

// The largest window or tile of all parts; `behind` bytes of the file follow the front.
ClaimedSize exr_size(Front front, std::uint64_t behind) {
    constexpr std::uint32_t kManyParts = 0x1000;
    front.skip(4);
    const int ends = (front.little_endian() & kManyParts) != 0 ? 2 : 1;  // empty names at the end of the headers
    ClaimedSize largest;
    const auto claim = [&](std::uint64_t width, std::uint64_t height) {
        if (static_cast<double>(width) * static_cast<double>(height) >
            static_cast<double>(largest.width) * static_cast<double>(largest.height))
            largest = {width, height};
    };
    for (int empty = 0; !front.is_at_end() && empty < ends;) {
        const std::string_view name = front.name();
        empty = name.empty() ? empty + 1 : 0;
        if (name.empty()) continue;
        const std::string_view type = front.name();
        const std::uint32_t size = front.little_endian();
        if (size > front.left() + behind) return {.attribute_overruns = true};
        Front value = front;
        front.skip(size);
        if (type == "box2i") {
            const std::uint32_t x0 = value.little_endian(), y0 = value.little_endian(), x1 = value.little_endian(),
                                y1 = value.little_endian();
            claim(span(x0, x1), span(y0, y1));
        } else if (type == "tiledesc") {
            const std::uint32_t width = value.little_endian(), height = value.little_endian();
            claim(width, height);
        }
    }
    return largest;
}

}  // namespace

ClaimedSize claimed_size(const std::filesystem::path& path, std::uint64_t file_bytes) {
    std::string bytes(static_cast<std::size_t>(std::min<std::uint64_t>(file_bytes, kFront)), '\0');
    std::ifstream in(path, std::ios::binary);
    in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(in.gcount(), 0)));
    if (bytes.starts_with("\xFF\xD8")) return jpeg_size(Front(bytes));
    if (bytes.starts_with("GIF8")) return gif_size(Front(bytes));
    if (bytes.starts_with("\x76\x2F\x31\x01")) return exr_size(Front(bytes), file_bytes - bytes.size());
    return {};
}

}  // namespace latent::image
