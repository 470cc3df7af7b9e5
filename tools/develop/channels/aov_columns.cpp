#include "tools/develop/channels/aov_columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "base/bytes.h"

namespace latent::develop {

namespace {

// In single precision, which is that of pictures.
float value_of(const sampledb::ExtraColumn& column, std::size_t row) {
    const std::byte* const at = column.values.data() + row * sampledb::width(column.type);
    using sampledb::ColumnType;
    switch (column.type) {
        case ColumnType::kU8:
            return static_cast<float>(load_le<std::uint8_t>(at));
        case ColumnType::kU16:
            return static_cast<float>(load_le<std::uint16_t>(at));
        case ColumnType::kU32:
            return static_cast<float>(load_le<std::uint32_t>(at));
        case ColumnType::kU64:
            return static_cast<float>(load_le<std::uint64_t>(at));
        case ColumnType::kF32:
            return load_le<float>(at);
        case ColumnType::kF64:
            return static_cast<float>(load_le<double>(at));
    }
    return 0;
}

Error unknown_layer(const sampledb::Job& job, const std::string& name) {
    std::string columns;
    for (const sampledb::ExtraColumnSpec& column : job.extra) columns += (columns.empty() ? "" : ", ") + column.name;
    return usage_error(fmt::format("--layers {}: no layer and no column of the files, which have {}", name,
                                   columns.empty() ? "none of their own" : columns));
}

}  // namespace

Result<AovColumns> AovColumns::find(const sampledb::Job& job, const Layers& layers) {
    AovColumns columns;
    Status status;
    const auto place = [&](bool wanted, const char* layer, const char* name, Place& to) {
        if (!wanted || !status) return;
        const auto found = std::ranges::find(job.extra, name, &sampledb::ExtraColumnSpec::name);
        if (found == job.extra.end()) {
            status = usage_error(
                fmt::format("--layers {0}: the files have no column {1}; render the scene with --aov {0}", layer, name));
        } else {
            columns.columns_.set(to = static_cast<Place>(found - job.extra.begin()));
        }
    };
    const auto place_vector = [&](bool wanted, const char* layer, std::array<Place, 3>& to) {
        for (std::size_t i = 0; i < 3; ++i) place(wanted, layer, fmt::format("{}.{}", layer, "xyz"[i]).c_str(), to[i]);
    };
    place_vector(layers.albedo, "albedo", columns.albedo_);
    place_vector(layers.normal, "normal", columns.normal_);
    place(layers.depth, "depth", "depth", columns.depth_);
    place_vector(layers.position, "position", columns.position_);
    place(layers.id, "id", "object", columns.object_);
    place(layers.id, "id", "material", columns.material_);
    if (!status) return status.error();
    for (const std::string& name : layers.columns) {
        const auto found = std::ranges::find(job.extra, name, &sampledb::ExtraColumnSpec::name);
        if (found == job.extra.end()) return unknown_layer(job, name);
        columns.others_.push_back(static_cast<Place>(found - job.extra.begin()));
        columns.columns_.set(columns.others_.back());
    }
    return columns;
}

void AovColumns::fill(const sampledb::Page& page, std::size_t row, float share, const RowLayout& layout, float* out) const {
    const auto value = [&](Place column) { return value_of(page.extra[column], row); };
    // False: not a number, or nothing.
    const auto fill_vector = [&](const std::array<Place, 3>& columns, float* to) {
        const std::array<float, 3> v = {value(columns[0]), value(columns[1]), value(columns[2])};
        if (!std::ranges::all_of(v, [](float x) { return std::isfinite(x); })) return false;
        for (std::size_t i = 0; i < 3; ++i) to[i] = share * v[i];
        return v != std::array<float, 3>{};
    };
    const Layers& layers = layout.layers;
    if (layers.albedo) fill_vector(albedo_, out + layout.albedo());
    if (layers.normal) fill_vector(normal_, out + layout.normal());
    if (layers.position && fill_vector(position_, out + layout.position())) out[layout.position() + 3] = share;
    if (layers.depth) {
        const float depth = value(depth_);
        if (std::isfinite(depth)) out[layout.depth()] = share * depth, out[layout.depth() + 1] = share;
    }
    for (std::size_t i = 0; i < others_.size(); ++i) {
        const float x = value(others_[i]);
        if (std::isfinite(x)) out[layout.column(i)] = share * x, out[layout.column(i) + 1] = share;
    }
    if (layers.id) {
        float* const chosen = out + layout.chosen();
        chosen[0] = 1, chosen[1] = value(object_), chosen[2] = value(material_);
    }
}

}  // namespace latent::develop
