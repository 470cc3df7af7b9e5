// render/load/gltf/accessors.h: numbers out of a glTF file's buffers, whatever their type and layout [glTF2 3.6].
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "render/load/gltf/document.h"

namespace latent::render {

// The largest of its integers, if they are not normalized; of other numbers, 1.
float largest_integer(const GltfDocument& document, const GltfValue& index);
// Whether a number that is not finite is an error. Else its item counts as 0, with a warning.
enum class Finite : bool { kDesired, kRequired };

// `index` holds an index into /accessors, of items of `components` numbers each: all of them, one item after another, normalised
// integers as fractions of their range. Nothing, with an error at the accessor, if it is of another kind, leaves its buffer, or
// holds what is not finite. Takes no more memory than the buffers hold numbers.
std::optional<std::vector<float>> read_floats(const GltfDocument& document, const GltfValue& index, std::size_t components,
                                              Finite finite = Finite::kRequired);
// Whether all numbers are finite, or count as 0 now. Else an error at `place`.
bool make_finite(std::vector<float>& numbers, std::size_t components, Finite finite, const GltfValue& place);
// How many numbers each item of /accessors/N has; 0 if it is not there, or of an unknown type.
std::size_t components_of(const GltfDocument& document, const GltfValue& index);
// As read_floats, of single unsigned integers.
std::optional<std::vector<std::uint32_t>> read_indices(const GltfDocument& document, const GltfValue& index);

// The bytes of /bufferViews/N, whose index `index` holds. Nothing if it is not there or, with an error, leaves its buffer.
std::optional<std::string> buffer_view(const GltfDocument& document, const GltfValue& index);

}  // namespace latent::render
