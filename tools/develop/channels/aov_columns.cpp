#include "tools/develop/channels/aov_columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "base/bytes.h"

namespace latent::develop {

namespace {

// Rows begin .. end-1 of a column, in single precision, which is that of pictures.
void read(const sampledb::ExtraColumn& column, std::size_t begin, std::size_t end, std::vector<float>& values) {
    values.resize(end - begin);
    const auto read_as = [&]<class T>(T) {
        const std::byte* at = column.values.data() + begin * sizeof(T);
        for (float& value : values) value = static_cast<float>(load_le<T>(at)), at += sizeof(T);
    };
    using sampledb::ColumnType;
    switch (column.type) {
        case ColumnType::kU8:
            return read_as(std::uint8_t{});
        case ColumnType::kU16:
            return read_as(std::uint16_t{});
        case ColumnType::kU32:
            return read_as(std::uint32_t{});
        case ColumnType::kU64:
            return read_as(std::uint64_t{});
        case ColumnType::kF32:
            return read_as(float{});
        case ColumnType::kF64:
            return read_as(double{});
    }
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

void AovColumns::fill(const sampledb::Page& page, std::size_t begin, std::size_t end, const RowLayout& layout, float* rows) const {
    if (page.record_class == sampledb::RecordClass::kLight) return;
    constexpr int kNone = -1;
    thread_local std::array<std::vector<float>, 3> v;
    const auto stride = static_cast<std::size_t>(layout.stride());
    const auto for_rows = [&](const auto& visit) {  // visit(i, row, share)
        for (std::size_t i = 0; i < end - begin; ++i) {
            float* const row = rows + i * stride;
            if (const float share = row[layout.share()]; share > 0) visit(i, row, share);
        }
    };
    // `hits`: the entry for the share of those that are not zero.
    const auto fill_vector = [&](const std::array<Place, 3>& columns, int entry, int hits) {
        for (std::size_t c = 0; c < 3; ++c) read(page.extra[columns[c]], begin, end, v[c]);
        for_rows([&](std::size_t i, float* row, float share) {
            if (!std::isfinite(v[0][i] * 0 + v[1][i] * 0 + v[2][i] * 0)) return;
            for (std::size_t c = 0; c < 3; ++c) row[entry + static_cast<int>(c)] = share * v[c][i];
            if (hits != kNone && (v[0][i] != 0 || v[1][i] != 0 || v[2][i] != 0)) row[hits] = share;
        });
    };
    const auto fill_number = [&](Place column, int entry) {
        read(page.extra[column], begin, end, v[0]);
        for_rows([&](std::size_t i, float* row, float share) {
            if (std::isfinite(v[0][i])) row[entry] = share * v[0][i], row[entry + 1] = share;
        });
    };
    const Layers& layers = layout.layers;
    if (layers.albedo) fill_vector(albedo_, layout.albedo(), kNone);
    if (layers.normal) fill_vector(normal_, layout.normal(), kNone);
    if (layers.position) fill_vector(position_, layout.position(), layout.position() + 3);
    if (layers.depth) fill_number(depth_, layout.depth());
    for (std::size_t i = 0; i < others_.size(); ++i) fill_number(others_[i], layout.column(i));
    if (!layers.id) return;
    read(page.extra[object_], begin, end, v[0]);
    read(page.extra[material_], begin, end, v[1]);
    for_rows([&](std::size_t i, float* row, float) {
        float* const chosen = row + layout.chosen();
        chosen[0] = 1, chosen[1] = v[0][i], chosen[2] = v[1][i];
    });
}

}  // namespace latent::develop
