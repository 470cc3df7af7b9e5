#include "render/transport/aov_settings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/parse_switches.h"

namespace latent::render {

namespace {

constexpr Switch<AovSettings> kNames[] = {{"albedo", &AovSettings::albedo}, {"normal", &AovSettings::normal},
                                          {"depth", &AovSettings::depth},   {"position", &AovSettings::position},
                                          {"id", &AovSettings::id},         {"lens", &AovSettings::lens},
                                          {"time", &AovSettings::time}};

}  // namespace

Result<AovSettings> parse_aovs(std::string_view text) { return parse_switches(text, kNames, "an AOV"); }

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
    add(aovs.lens, ColumnType::kU8, {"lens.x", "lens.y"});
    add(aovs.time, ColumnType::kU8, {"shutter"});
    return columns;
}

}  // namespace latent::render
