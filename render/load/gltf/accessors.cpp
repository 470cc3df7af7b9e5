#include "render/load/gltf/accessors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "base/bytes.h"

namespace latent::render {

namespace {

enum class Component : std::uint32_t { kInt8 = 5120, kUint8, kInt16, kUint16, kUint32 = 5125, kFloat32 };
constexpr std::uint64_t kMaxZeros = 1 << 24;  // items of an accessor that has no buffer view, so all but some are 0

std::size_t size_of(Component c) {
    switch (c) {
        case Component::kInt8:
        case Component::kUint8:
            return 1;
        case Component::kInt16:
        case Component::kUint16:
            return 2;
        case Component::kUint32:
        case Component::kFloat32:
            return 4;
    }
    return 0;  // no such type
}

std::size_t components_of(const std::string& type) {
    return type == "SCALAR" ? 1 : type == "VEC2" ? 2 : type == "VEC3" ? 3 : type == "VEC4" ? 4 : type == "MAT4" ? 16 : 0;
}

// `count` items of `item` bytes, `stride` apart.
struct Items {
    const std::byte* first = nullptr;
    std::size_t stride = 0;
};

// The part of /bufferViews/N that `count` items take, which begins `offset` bytes into it. Nothing, with an error at `accessor`.
std::optional<Items> items_of(const GltfDocument& document, const GltfValue& accessor, const GltfValue& view_index,
                              std::uint64_t offset, std::uint64_t count, std::size_t item) {
    const std::optional<std::uint32_t> v = view_index.index(document.root()["bufferViews"]);
    if (!v) return std::nullopt;
    const GltfValue view = document.root()["bufferViews"][*v];
    const std::optional<std::uint32_t> b = view["buffer"].index(document.root()["buffers"]);
    if (!b) return std::nullopt;
    const std::string* unpacked = document.unpacked_view(*v);
    if (unpacked != nullptr ? unpacked->empty() : document.buffer(*b) == nullptr) return std::nullopt;  // an error already
    const std::string& bytes = unpacked != nullptr ? *unpacked : *document.buffer(*b);
    const std::uint64_t begin = unpacked != nullptr ? 0 : view["byteOffset"].count(0), length = view["byteLength"].count(0),
                        stride = view["byteStride"].count(item);
    if (begin > bytes.size() || length > bytes.size() - begin) {
        view.error(fmt::format("ends at byte {} of a buffer of {} bytes", begin + length, bytes.size()));
        return std::nullopt;
    }
    if (stride < item || stride > 252) {
        view["byteStride"].error(fmt::format("is {}; its items have {} bytes", stride, item));
        return std::nullopt;
    }
    if (count > 0 && (offset > length || length - offset < item || (length - offset - item) / stride < count - 1)) {
        accessor.error(fmt::format("its {} items exceed the {} bytes of its buffer view", count, length));
        return std::nullopt;
    }
    return Items{reinterpret_cast<const std::byte*>(bytes.data()) + begin + offset, static_cast<std::size_t>(stride)};
}

template <class Number>
float as_float(const std::byte* at, bool normalized) {
    const Number x = load_le<Number>(at);
    if (!normalized || std::is_floating_point_v<Number>) return static_cast<float>(x);
    return std::max(static_cast<float>(x) / static_cast<float>(std::numeric_limits<Number>::max()), -1.0f);
}

float float_at(const std::byte* at, Component type, bool normalized) {
    switch (type) {
        case Component::kInt8:
            return as_float<std::int8_t>(at, normalized);
        case Component::kUint8:
            return as_float<std::uint8_t>(at, normalized);
        case Component::kInt16:
            return as_float<std::int16_t>(at, normalized);
        case Component::kUint16:
            return as_float<std::uint16_t>(at, normalized);
        case Component::kUint32:
            return as_float<std::uint32_t>(at, normalized);
        case Component::kFloat32:
            return as_float<float>(at, normalized);
    }
    return 0;
}

std::uint32_t index_at(const std::byte* at, Component type) {
    return type == Component::kUint8    ? load_le<std::uint8_t>(at)
           : type == Component::kUint16 ? load_le<std::uint16_t>(at)
                                        : load_le<std::uint32_t>(at);
}

bool is_unsigned(Component c) { return c == Component::kUint8 || c == Component::kUint16 || c == Component::kUint32; }

// What an accessor says of itself.
struct Accessor {
    GltfValue value;
    Component type;
    std::uint64_t count;
    std::size_t components;

    std::size_t item() const { return components * size_of(type); }
};

std::optional<Accessor> accessor_of(const GltfDocument& document, const GltfValue& index) {
    const std::optional<std::uint32_t> i = index.index(document.root()["accessors"]);
    if (!i) return std::nullopt;
    Accessor out{document.root()["accessors"][*i], {}, 0, 0};
    out.type = static_cast<Component>(out.value["componentType"].count(0));
    out.count = out.value["count"].count(0);
    out.components = components_of(out.value["type"].text());
    if (size_of(out.type) != 0 && out.components != 0) return out;
    out.value.error("its type or componentType is not that of a list of numbers or vectors");
    return std::nullopt;
}

// Puts the values of /accessors/N/sparse over those that are there.
template <class Number, class Read>
bool add_sparse(const GltfDocument& document, const Accessor& a, std::vector<Number>& out, const Read& read) {
    const GltfValue sparse = a.value["sparse"], indices = sparse["indices"], values = sparse["values"];
    if (!sparse.exists()) return true;
    const std::uint64_t count = sparse["count"].count(0);
    const auto type = static_cast<Component>(indices["componentType"].count(0));
    if (count > a.count || !is_unsigned(type)) {
        sparse.error("its count or the type of its indices is wrong");
        return false;
    }
    const std::optional<Items> at = items_of(document, indices, indices["bufferView"], indices["byteOffset"].count(0), count,
                                             size_of(type)),
                               from =
                                   items_of(document, values, values["bufferView"], values["byteOffset"].count(0), count, a.item());
    if (!at || !from) return false;
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t to = index_at(at->first + i * at->stride, type);
        if (to >= a.count) {
            indices.error(fmt::format("{} is out of range; there are {} items", to, a.count));
            return false;
        }
        for (std::size_t c = 0; c < a.components; ++c)
            out[to * a.components + c] = read(from->first + i * from->stride + c * size_of(a.type));
    }
    return true;
}

template <class Number, class Read>
std::optional<std::vector<Number>> read_all(const GltfDocument& document, const Accessor& a, const Read& read) {
    std::vector<Number> out;
    if (a.value["bufferView"].exists()) {
        const std::optional<Items> items =
            items_of(document, a.value, a.value["bufferView"], a.value["byteOffset"].count(0), a.count, a.item());
        if (!items) return std::nullopt;
        out.reserve(a.count * a.components);
        for (std::size_t i = 0; i < a.count; ++i) {
            for (std::size_t c = 0; c < a.components; ++c)
                out.push_back(read(items->first + i * items->stride + c * size_of(a.type)));
        }
    } else if (a.count <= kMaxZeros) {
        out.resize(a.count * a.components);
    } else {
        a.value.error(fmt::format("has {} items and no buffer view", a.count));
        return std::nullopt;
    }
    if (!add_sparse(document, a, out, read)) return std::nullopt;
    return out;
}

}  // namespace

std::size_t components_of(const GltfDocument& document, const GltfValue& index) {
    const std::optional<std::uint32_t> i = index.index(document.root()["accessors"]);
    return i ? components_of(document.root()["accessors"][*i]["type"].text()) : 0;
}

float largest_integer(const GltfDocument& document, const GltfValue& index) {
    const std::optional<std::uint32_t> i = index.index(document.root()["accessors"]);
    if (!i) return 1;
    const GltfValue accessor = document.root()["accessors"][*i];
    const auto type = static_cast<Component>(accessor["componentType"].count(0));
    if (accessor["normalized"].flag(false)) return 1;
    return type == Component::kUint8 ? 255 : type == Component::kUint16 ? 65535 : 1;
}

bool make_finite(std::vector<float>& numbers, std::size_t components, Finite finite, const GltfValue& place) {
    std::size_t replaced = 0;
    for (std::size_t i = 0; i < numbers.size(); i += components) {
        const std::span<float> item = std::span(numbers).subspan(i, components);
        if (std::ranges::all_of(item, [](float x) { return std::isfinite(x); })) continue;
        if (finite == Finite::kRequired) {
            place.error(fmt::format("item {} is not finite", i / components));
            return false;
        }
        std::ranges::fill(item, 0.0f);
        ++replaced;
    }
    if (replaced > 0) place.warn(fmt::format("{} of its items are not finite, and count as 0", replaced));
    return true;
}

std::optional<std::vector<float>> read_floats(const GltfDocument& document, const GltfValue& index, std::size_t components,
                                              Finite finite) {
    const std::optional<Accessor> a = accessor_of(document, index);
    if (!a) return std::nullopt;
    if (a->components != components) {
        a->value.error(fmt::format("has {} numbers per item; {} needs {}", a->components, index.path(), components));
        return std::nullopt;
    }
    const bool normalized = a->value["normalized"].flag(false);
    std::optional<std::vector<float>> out =
        read_all<float>(document, *a, [&](const std::byte* at) { return float_at(at, a->type, normalized); });
    if (out && !make_finite(*out, components, finite, a->value)) return std::nullopt;
    return out;
}

std::optional<std::string> buffer_view(const GltfDocument& document, const GltfValue& index) {
    const std::optional<std::uint32_t> v = index.index(document.root()["bufferViews"]);
    if (!v) return std::nullopt;
    const std::uint64_t length = document.root()["bufferViews"][*v]["byteLength"].count(0);
    const std::optional<Items> items = items_of(document, index, index, 0, length, 1);
    if (!items) return std::nullopt;
    return std::string(reinterpret_cast<const char*>(items->first), length);
}

std::optional<std::vector<std::uint32_t>> read_indices(const GltfDocument& document, const GltfValue& index) {
    const std::optional<Accessor> a = accessor_of(document, index);
    if (!a) return std::nullopt;
    if (a->components != 1 || !is_unsigned(a->type)) {
        a->value.error("indices must be single unsigned integers");
        return std::nullopt;
    }
    return read_all<std::uint32_t>(document, *a, [&](const std::byte* at) { return index_at(at, a->type); });
}

}  // namespace latent::render
