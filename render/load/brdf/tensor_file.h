// render/load/brdf/tensor_file.h: files of named arrays, as in the RGL database of measured materials.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"

namespace latent::render {

// All numbers are little-endian:
//   "tensor_file\0", version u8 u8 = 1 0, number of fields u32
//   each field: length of its name u16, name, number of dimensions u16, type u8, offset of its values u64, size u64 of each
//   dimension

enum class TensorType : std::uint8_t {
    kUint8 = 1,
    kInt8,
    kUint16,
    kInt16,
    kUint32,
    kInt32,
    kUint64,
    kInt64,
    kFloat16,
    kFloat32,
    kFloat64
};

// An array within the bytes of its file; the last index varies first.
struct Tensor {
    TensorType type = TensorType::kUint8;
    std::vector<std::uint64_t> shape{};
    std::span<const std::byte> bytes{};  // as many as type and shape say, not aligned

    std::vector<float> floats() const;  // its type must be kFloat32
};

// All of them lie within the file. Errors: kForeign, kTruncated, kCorrupt, kUnsupported.
Result<std::map<std::string, Tensor>> read_tensors(std::span<const std::byte> file);

}  // namespace latent::render
