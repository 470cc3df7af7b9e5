// tests/render/models.h: glTF files, written on the spot.
#pragma once

#include <cmath>
#include <cstring>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>

#include "base/bytes.h"

namespace latent::render::testing {

// JSON and the one buffer that it refers to. Every list of numbers has a buffer view and an accessor of its own.
struct GltfFile {
    nlohmann::json json = {{"asset", {{"version", "2.0"}}}};
    std::string binary{};

    // The index of the new accessor.
    std::size_t add_floats(std::initializer_list<double> values, const char* type, std::size_t stride = 0) {
        const std::size_t at = binary.size(), components = static_cast<std::size_t>(type[3] - '0');
        for (const double x : values) append(static_cast<float>(x));
        nlohmann::json view = {{"buffer", 0}, {"byteOffset", at}, {"byteLength", binary.size() - at}};
        if (stride > 0) view["byteStride"] = stride;
        return add(view, {{"componentType", 5126}, {"type", type}, {"count", values.size() / components}});
    }
    // Of one byte (5121), two (5123) or a float (5126), as a fraction of the largest.
    std::size_t add_fractions(std::initializer_list<double> values, const char* type, int component) {
        const std::size_t at = binary.size(), components = static_cast<std::size_t>(type[3] - '0'),
                          bytes = component == 5121   ? 1
                                  : component == 5123 ? 2
                                                      : 4,
                          stride = (components * bytes + 3) / 4 * 4;
        std::size_t i = 0;
        for (const double x : values) {
            if (component == 5121) append(static_cast<std::uint8_t>(std::lround(x * 255)));
            if (component == 5123) append(static_cast<std::uint16_t>(std::lround(x * 65535)));
            if (component == 5126) append(static_cast<float>(x));
            if (++i % components == 0) binary.resize(binary.size() + stride - components * bytes);
        }
        return add({{"buffer", 0}, {"byteOffset", at}, {"byteLength", binary.size() - at}, {"byteStride", stride}},
                   {{"componentType", component}, {"type", type}, {"count", values.size() / components}, {"normalized", true}});
    }
    std::size_t add_indices(std::initializer_list<std::uint32_t> values, int type = 5125) {
        const std::size_t at = binary.size();
        for (const std::uint32_t x : values) {
            if (type == 5121) append(static_cast<std::uint8_t>(x));
            if (type == 5123) append(static_cast<std::uint16_t>(x));
            if (type == 5125) append(x);
        }
        const nlohmann::json view = {{"buffer", 0}, {"byteOffset", at}, {"byteLength", binary.size() - at}};
        binary.resize((binary.size() + 3) / 4 * 4);
        return add(view, {{"componentType", type}, {"type", "SCALAR"}, {"count", values.size()}});
    }
    // The index of the new buffer view.
    std::size_t add_bytes(const std::string& bytes) {
        json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", bytes.size()}});
        binary += bytes;
        return json["bufferViews"].size() - 1;
    }

 private:
    template <class T>
    void append(T x) {
        char bytes[sizeof(T)];
        store_le(reinterpret_cast<std::byte*>(bytes), x);
        binary.append(bytes, sizeof(T));
    }
    std::size_t add(const nlohmann::json& view, nlohmann::json accessor) {
        accessor["bufferView"] = json["bufferViews"].size();
        json["bufferViews"].push_back(view);
        json["accessors"].push_back(accessor);
        json["buffers"] = {{{"byteLength", binary.size()}}};
        return json["accessors"].size() - 1;
    }
};

inline std::string as_glb(const GltfFile& file) {
    nlohmann::json json = file.json;
    if (!json.contains("buffers") || !json["buffers"][0].contains("uri")) json["buffers"] = {{{"byteLength", file.binary.size()}}};
    std::string text = json.dump(), binary = file.binary;
    text.resize((text.size() + 3) / 4 * 4, ' ');
    binary.resize((binary.size() + 3) / 4 * 4);
    Bytes out;
    ByteWriter writer(out);
    const auto put = [&](const std::string& bytes) { writer.put(std::as_bytes(std::span(bytes))); };
    writer.put(std::uint32_t{0x46546C67});
    writer.put(std::uint32_t{2});
    writer.put(static_cast<std::uint32_t>(12 + 8 + text.size() + 8 + binary.size()));
    writer.put(static_cast<std::uint32_t>(text.size()));
    writer.put(std::uint32_t{0x4E4F534A});
    put(text);
    writer.put(static_cast<std::uint32_t>(binary.size()));
    writer.put(std::uint32_t{0x004E4942});
    put(binary);
    return {reinterpret_cast<const char*>(out.data()), out.size()};
}

inline std::string base64(const std::string& bytes) {
    constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t bits = 0;
        for (std::size_t k = 0; k < 3; ++k)
            bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0);
        for (std::size_t k = 0; k < 4; ++k) out += i + k <= bytes.size() ? kDigits[bits >> (18 - 6 * k) & 63] : '=';
    }
    return out;
}

}  // namespace latent::render::testing
