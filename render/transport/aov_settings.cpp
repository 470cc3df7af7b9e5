#include "render/transport/aov_settings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <utility>

namespace latent::render {

namespace {

constexpr std::pair<std::string_view, bool AovSettings::*> kNames[] = {{"albedo", &AovSettings::albedo},
                                                                       {"normal", &AovSettings::normal},
                                                                       {"depth", &AovSettings::depth},
                                                                       {"position", &AovSettings::position},
                                                                       {"id", &AovSettings::id}};

}  // namespace

Result<AovSettings> parse_aovs(std::string_view text) {
    AovSettings aovs;
    for (std::string_view rest = text;;) {
        const std::size_t comma = rest.find(',');
        const std::string_view name = rest.substr(0, comma);
        bool found = false;
        for (const auto& [known, member] : kNames) {
            if (name == known) aovs.*member = found = true;
        }
        if (!found) return Error{ErrorCode::kUsage, fmt::format("'{}' is not an AOV (try albedo,normal,depth,position,id)", name)};
        if (comma == std::string_view::npos) return aovs;
        rest.remove_prefix(comma + 1);
    }
}

std::string to_text(const AovSettings& aovs) {
    std::vector<std::string_view> chosen;
    for (const auto& [name, member] : kNames) {
        if (aovs.*member) chosen.push_back(name);
    }
    return fmt::format("{}", fmt::join(chosen, ","));
}

std::vector<sampledb::ExtraColumnSpec> aov_columns(const AovSettings& aovs) {
    std::vector<sampledb::ExtraColumnSpec> columns;
    const auto add = [&](bool wanted, sampledb::ColumnType type, std::initializer_list<const char*> names) {
        for (const char* name : names) {
            if (wanted) columns.push_back({name, type});
        }
    };
    using sampledb::ColumnType;
    add(aovs.albedo, ColumnType::kF32, {"albedo.x", "albedo.y", "albedo.z"});
    add(aovs.normal, ColumnType::kF32, {"normal.x", "normal.y", "normal.z"});
    add(aovs.depth, ColumnType::kF32, {"depth"});
    add(aovs.position, ColumnType::kF32, {"position.x", "position.y", "position.z"});
    add(aovs.id, ColumnType::kU32, {"object", "material"});
    return columns;
}

}  // namespace latent::render
