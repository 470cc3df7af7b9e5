#include "render/load/brdf/tensor_file.h"

#include <fmt/format.h>

#include <array>
#include <string_view>
#include <utility>

#include "base/bytes.h"

namespace latent::render {

namespace {

constexpr std::string_view kMagic{"tensor_file\0", 12};
constexpr std::uint32_t kMaxFields = 1024;
constexpr std::array<std::uint8_t, 12> kTypeSize = {0, 1, 1, 2, 2, 4, 4, 8, 8, 2, 4, 8};

Error truncated() { return {ErrorCode::kTruncated, "the file is truncated"}; }

// Bytes one after another.
class Cursor {
 public:
    explicit Cursor(std::span<const std::byte> bytes) : left_(bytes) {}
    // False: there are fewer.
    bool take(std::size_t count, std::span<const std::byte>& out) {
        if (count > left_.size()) return false;
        out = left_.first(count);
        left_ = left_.subspan(count);
        return true;
    }
    template <class T>
    bool read(T& out) {
        std::span<const std::byte> bytes;
        if (!take(sizeof(T), bytes)) return false;
        out = load_le<T>(bytes.data());
        return true;
    }

 private:
    std::span<const std::byte> left_;
};

std::string text_of(std::span<const std::byte> bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

// The next field, number `n`.
Result<std::pair<std::string, Tensor>> read_field(Cursor& cursor, std::uint32_t n, std::span<const std::byte> file) {
    std::uint16_t name_size = 0, dimensions = 0;
    std::uint8_t type = 0;
    std::uint64_t offset = 0;
    std::span<const std::byte> name;
    if (!cursor.read(name_size) || !cursor.take(name_size, name) || !cursor.read(dimensions) || !cursor.read(type) ||
        !cursor.read(offset))
        return truncated();
    if (type == 0 || type >= kTypeSize.size())
        return Error{ErrorCode::kCorrupt, fmt::format("field {} has the unknown type {}", n, type)};
    Tensor tensor{.type = static_cast<TensorType>(type)};
    std::uint64_t size = kTypeSize[type];
    bool fits = true;
    for (std::uint16_t d = 0; d < dimensions; ++d) {
        std::uint64_t extent = 0;
        if (!cursor.read(extent)) return truncated();
        tensor.shape.push_back(extent);
        fits = fits && (extent == 0 || size <= file.size() / extent);
        if (fits) size *= extent;
    }
    if (!fits || size > file.size() || offset > file.size() - size)
        return Error{ErrorCode::kTruncated, fmt::format("the values of field {} lie outside of the file", n)};
    tensor.bytes = file.subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(size));
    return std::pair{text_of(name), std::move(tensor)};
}

}  // namespace

std::vector<float> Tensor::floats() const {
    std::vector<float> out(bytes.size() / sizeof(float));
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = load_le<float>(bytes.data() + i * sizeof(float));
    return out;
}

Result<std::map<std::string, Tensor>> read_tensors(std::span<const std::byte> file) {
    Cursor cursor(file);
    std::span<const std::byte> magic;
    if (!cursor.take(kMagic.size(), magic) || text_of(magic) != kMagic) return Error{ErrorCode::kForeign, "not a tensor file"};
    std::uint8_t major = 0, minor = 0;
    std::uint32_t count = 0;
    if (!cursor.read(major) || !cursor.read(minor) || !cursor.read(count)) return truncated();
    if (major != 1 || minor != 0)
        return Error{ErrorCode::kUnsupported, fmt::format("version {}.{} of tensor files is not supported", major, minor)};
    if (count > kMaxFields) return Error{ErrorCode::kCorrupt, fmt::format("it has {} fields", count)};
    std::map<std::string, Tensor> fields;
    for (std::uint32_t n = 0; n < count; ++n) {
        auto field = read_field(cursor, n, file);
        if (!field) return field.error();
        if (!fields.insert(std::move(*field)).second)
            return Error{ErrorCode::kCorrupt, fmt::format("field {} has the name of an earlier one", n)};
    }
    return fields;
}

}  // namespace latent::render
