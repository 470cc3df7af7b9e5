// render/load/gltf/value.h: values of a JSON document that know their place in it, so that every message names one.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "render/load/files/diagnostics.h"

namespace latent::render {

// A view: the document and the diagnostics outlive it. A value that is not there is one too: it has no members and no items.
class GltfValue {
 public:
    // `path`: "model.gltf: " and a JSON pointer [RFC6901].
    GltfValue(const nlohmann::json* json, std::string path, Diagnostics& diagnostics)
        : json_(json), path_(std::move(path)), diagnostics_(&diagnostics) {}

    bool exists() const { return json_ != nullptr; }
    GltfValue operator[](std::string_view key) const;  // of an object
    GltfValue operator[](std::size_t i) const;         // of an array
    std::size_t size() const { return json_ != nullptr && json_->is_array() ? json_->size() : 0; }
    std::vector<std::string> keys() const;
    // Of the member "extensions".
    GltfValue extension(std::string_view name) const { return (*this)["extensions"][name]; }

    // The value itself. Where it is not there: `fallback`; where it is something else or out of range, an error, and `fallback`.
    double number(double fallback, double low = -std::numeric_limits<double>::max(),
                  double high = std::numeric_limits<double>::max()) const;
    std::uint64_t count(std::uint64_t fallback) const;  // a non-negative integer below 2^53
    bool flag(bool fallback) const;
    std::string text(const std::string& fallback = "") const;
    template <std::size_t N>
    std::array<double, N> numbers(const std::array<double, N>& fallback) const {
        if (!exists()) return fallback;
        std::array<double, N> out = fallback;
        if (size() != N) {
            error("must be an array of " + std::to_string(N) + " numbers");
        } else {
            for (std::size_t i = 0; i < N; ++i) out[i] = (*this)[i].number(fallback[i]);
        }
        return out;
    }
    // An index into `of`, an array of the document. Nothing if it is not there or, with an error, out of range.
    std::optional<std::uint32_t> index(const GltfValue& of) const;

    void error(const std::string& message) const { diagnostics_->error(path_, message); }
    void warn(const std::string& message) const { diagnostics_->warn(path_, message); }
    const std::string& path() const { return path_; }

 private:
    const nlohmann::json* json_;
    std::string path_;
    Diagnostics* diagnostics_;
};

}  // namespace latent::render
