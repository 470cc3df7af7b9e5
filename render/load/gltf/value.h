// render/load/gltf/value.h: values of a JSON document that know their place in it, so that every message names one.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
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
    bool is_array() const { return exists() && json_->is_array(); }
    bool is_object() const { return exists() && json_->is_object(); }
    bool is_text() const { return exists() && json_->is_string(); }
    bool is_flag() const { return exists() && json_->is_boolean(); }
    bool is_number() const { return exists() && json_->is_number(); }
    bool is_count() const;                             // a non-negative integer below 2^53
    GltfValue operator[](std::string_view key) const;  // a member of an object; null is not there
    GltfValue operator[](std::size_t i) const;         // an element of an array
    std::size_t size() const { return json_ != nullptr && json_->is_array() ? json_->size() : 0; }
    std::vector<std::string> keys() const;
    // A member of the member "extensions".
    GltfValue extension(std::string_view name) const { return (*this)["extensions"][name]; }

    // The value itself. Where it is not there: `fallback`; where it is something else or out of range, an error, and `fallback`.
    double number(double fallback, double low = -std::numeric_limits<double>::max(),
                  double high = std::numeric_limits<double>::max()) const;
    std::uint64_t count(std::uint64_t fallback) const;
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
    // A number, or some, of which those out of range are clamped, with a warning that ends in `advice`. kNoLimit: for factors
    // that glTF does not bound from above; the largest number that a scene may have.
    static constexpr double kNoLimit = 1e30;
    double factor(double fallback, double low, double high, std::string_view advice = "") const {
        return factors(std::array{fallback}, low, high, advice)[0];
    }
    template <std::size_t N>
    std::array<double, N> factors(const std::array<double, N>& fallback, double low, double high,
                                  std::string_view advice = "") const {
        std::array<double, N> out = N == 1 ? std::array<double, N>{number(fallback[0])} : numbers(fallback);
        clamp(out, low, high, advice);
        return out;
    }
    // An index into `of`, an array of the document. Nothing if it is not there or, with an error, out of range.
    std::optional<std::uint32_t> index(const GltfValue& of) const;

    void error(const std::string& message) const { diagnostics_->error(place(), message); }
    void warn(const std::string& message) const { diagnostics_->warn(place(), message); }
    void note(const std::string& message) const { diagnostics_->note(place(), message); }
    // One line for this and all others of its kind.
    void warn_of_kind(const std::string& kind, const std::string& message) const {
        diagnostics_->warn_of_kind(kind, place(), message);
    }
    void note_of_kind(const std::string& kind, const std::string& message) const {
        diagnostics_->note_of_kind(kind, place(), message);
    }
    // A note or a warning of that kind: `message`, and why.
    void say_of_unread(const std::string& kind, const std::string& message, const UnreadFeatures& unread) const {
        diagnostics_->say_of_unread(kind, place(), message, unread);
    }
    const std::string& path() const { return path_; }

 private:
    void clamp(std::span<double> values, double low, double high, std::string_view advice) const;
    // "model.gltf: /nodes/3", or "model.gltf" of the whole document.
    std::string place() const { return path_.ends_with(": ") ? path_.substr(0, path_.size() - 2) : path_; }

    const nlohmann::json* json_;
    std::string path_;
    Diagnostics* diagnostics_;
};

}  // namespace latent::render
