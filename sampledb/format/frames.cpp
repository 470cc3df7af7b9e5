#include "sampledb/format/frames.h"

#include <fmt/format.h>

#include <algorithm>

namespace latent::sampledb {

bool begins_with(ByteSpan bytes, const Magic& magic) {
    return bytes.size() >= magic.size() && std::ranges::equal(bytes.first(magic.size()), bytes_of(magic));
}

bool all_zero(ByteSpan bytes) {
    return std::ranges::all_of(bytes, [](std::byte b) { return b == std::byte{0}; });
}

Status check_version(std::uint16_t major, std::uint64_t features, std::uint64_t known) {
    if (major != kMajor)
        return Error{ErrorCode::kUnsupported, fmt::format("format version {}; this program reads version {}", major, kMajor)};
    if ((features & ~known) != 0) {
        return Error{ErrorCode::kUnsupported,
                     fmt::format("uses features {:#x}, which this program does not support", features & ~known)};
    }
    return {};
}

void put_hash(ByteWriter& out, const Hash128& hash) {
    out.put(hash.low);
    out.put(hash.high);
}
Hash128 get_hash(ByteReader& in) {
    const std::uint64_t low = in.get<std::uint64_t>();
    return {low, in.get<std::uint64_t>()};
}

std::string get_text(ByteReader& in, std::size_t size) {
    const ByteSpan text = in.take(size);
    std::string result(text.size(), '\0');
    std::transform(text.begin(), text.end(), result.begin(), [](std::byte b) { return static_cast<char>(b); });
    return result;
}

}  // namespace latent::sampledb
