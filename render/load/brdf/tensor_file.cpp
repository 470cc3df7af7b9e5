#include "render/load/brdf/tensor_file.h"

#include <fmt/format.h>

#include <array>
#include <string_view>
#include <utility>

#include "base/bytes.h"
#include "base/printable.h"

namespace latent::render {

namespace {

constexpr std::string_view kMagic{"tensor_file\0", 12};
constexpr std::uint32_t kMaxFields = 1024;
constexpr std::array<std::uint8_t, 12> kTypeSize = {0, 1, 1, 2, 2, 4, 4, 8, 8, 2, 4, 8};

Error cut_short() { return {ErrorCode::kTruncated, "the file is truncated"}; }

std::string text_of(std::span<const std::byte> bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

// The next field.
Result<std::pair<std::string, Tensor>> read_field(ByteReader& reader, std::span<const std::byte> file) {
    std::string name = text_of(reader.take(reader.get<std::uint16_t>()));
    const auto dimensions = reader.get<std::uint16_t>();
    const auto type = reader.get<std::uint8_t>();
    const auto offset = reader.get<std::uint64_t>();
    if (!reader.ok()) return cut_short();
    if (type == 0 || type >= kTypeSize.size())
        return Error{ErrorCode::kCorrupt, fmt::format("{}: unknown type {}", printable_line(name), type)};
    Tensor tensor{.type = static_cast<TensorType>(type)};
    std::uint64_t size = kTypeSize[type];
    bool fits = true;
    for (std::uint16_t d = 0; d < dimensions; ++d) {
        const auto extent = reader.get<std::uint64_t>();
        if (!reader.ok()) return cut_short();
        tensor.shape.push_back(extent);
        fits = fits && (extent == 0 || size <= file.size() / extent);
        if (fits) size *= extent;
    }
    if (!fits || size > file.size() || offset > file.size() - size)
        return Error{ErrorCode::kTruncated, fmt::format("{}: its values lie outside of the file", printable_line(name))};
    tensor.bytes = file.subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(size));
    return std::pair{std::move(name), std::move(tensor)};
}

}  // namespace

std::vector<float> Tensor::floats() const {
    std::vector<float> out(bytes.size() / sizeof(float));
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = load_le<float>(bytes.data() + i * sizeof(float));
    return out;
}

Result<std::map<std::string, Tensor>> read_tensors(std::span<const std::byte> file) {
    ByteReader reader(file);
    if (text_of(reader.take(kMagic.size())) != kMagic) return Error{ErrorCode::kForeign, "not a .bsdf file of the RGL database"};
    const auto major = reader.get<std::uint8_t>(), minor = reader.get<std::uint8_t>();
    const auto count = reader.get<std::uint32_t>();
    if (!reader.ok()) return cut_short();
    if (major != 1 || minor != 0)
        return Error{ErrorCode::kUnsupported, fmt::format("version {}.{} of tensor files is not supported", major, minor)};
    if (count > kMaxFields) return Error{ErrorCode::kCorrupt, fmt::format("has {} fields, more than {}", count, kMaxFields)};
    std::map<std::string, Tensor> fields;
    for (std::uint32_t n = 0; n < count; ++n) {
        auto field = read_field(reader, file);
        if (!field) return field.error();
        if (fields.contains(field->first)) return Error{ErrorCode::kCorrupt, printable_line(field->first) + ": is there twice"};
        fields.insert(std::move(*field));
    }
    return fields;
}

}  // namespace latent::render
