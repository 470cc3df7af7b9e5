#include "render/load/gltf/value.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/size.h"

namespace latent::render {

GltfValue GltfValue::operator[](std::string_view key) const {
    std::string path = path_ + "/" + std::string(key);
    if (json_ == nullptr || !json_->is_object()) return {nullptr, std::move(path), *diagnostics_};
    const auto found = json_->find(key);
    return {found == json_->end() || found->is_null() ? nullptr : &*found, std::move(path), *diagnostics_};
}

GltfValue GltfValue::operator[](std::size_t i) const {
    return {i < size() ? &(*json_)[i] : nullptr, path_ + "/" + std::to_string(i), *diagnostics_};
}

std::vector<std::string> GltfValue::keys() const {
    std::vector<std::string> keys;
    if (json_ != nullptr && json_->is_object()) {
        for (const auto& [key, value] : json_->items()) keys.push_back(key);
    }
    return keys;
}

double GltfValue::number(double fallback, double low, double high) const {
    if (!exists()) return fallback;
    const double x = json_->is_number() ? json_->get<double>() : std::nan("");
    if (x >= low && x <= high) return x;
    const bool bounded = low > -std::numeric_limits<double>::max() || high < std::numeric_limits<double>::max();
    if (!json_->is_number() || !bounded) {
        error("must be a finite number");
    } else if (high < std::numeric_limits<double>::max()) {
        error(fmt::format("must be a number from {} to {}", low, high));
    } else {
        error(fmt::format("must be a number of at least {}", low));
    }
    return fallback;
}

void GltfValue::clamp(std::span<double> values, double low, double high, std::string_view advice) const {
    const double rounding = 1e-6 * std::max(std::abs(low), high < kNoLimit ? high : 0);  // for exporters that count in float
    const auto wrong = std::ranges::find_if(values, [&](double x) { return x < low - rounding || x > high + rounding; });
    if (wrong != values.end()) {
        const std::string range = high < kNoLimit ? fmt::format("from {} to {}", low, high)
                                  : *wrong > high ? fmt::format("at most {}", high)
                                                  : fmt::format("at least {}", low);
        warn_of_kind("range of " + path_.substr(path_.rfind('/')),
                     fmt::format("{} is clamped: must be {}{}", *wrong, range, advice));
    }
    for (double& x : values) x = std::clamp(x, low, high);
}

bool GltfValue::is_count() const {
    const double x = is_number() ? json_->get<double>() : -1;
    return x >= 0 && x < 0x1p53 && x == std::floor(x);
}

std::uint64_t GltfValue::count(std::uint64_t fallback) const {
    if (!exists()) return fallback;
    if (is_count()) return static_cast<std::uint64_t>(json_->get<double>());
    error("must be a non-negative integer");
    return fallback;
}

bool GltfValue::flag(bool fallback) const {
    if (!exists()) return fallback;
    if (json_->is_boolean()) return json_->get<bool>();
    error("must be true or false");
    return fallback;
}

std::string GltfValue::text(const std::string& fallback) const {
    if (!exists()) return fallback;
    if (json_->is_string()) return json_->get<std::string>();
    error("must be a string");
    return fallback;
}

std::optional<std::uint32_t> GltfValue::index(const GltfValue& of) const {
    if (!exists()) return std::nullopt;
    const double x = json_->is_number() ? json_->get<double>() : -1;
    if (x >= 0 && x < static_cast<double>(of.size()) && x == std::floor(x)) return static_cast<std::uint32_t>(x);
    error(fmt::format("is not an index into {}, which has {}", of.path().substr(of.path().rfind('/')), counted(of.size(), "item")));
    return std::nullopt;
}

}  // namespace latent::render
