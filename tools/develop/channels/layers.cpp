#include "tools/develop/channels/layers.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "base/parse_switches.h"

namespace latent::develop {

namespace {

constexpr Switch<Layers> kNames[] = {
    {"variance", &Layers::variance}, {"weight", &Layers::weight}, {"count", &Layers::count},   {"noisy", &Layers::noisy},
    {"lights", &Layers::lights},     {"albedo", &Layers::albedo}, {"normal", &Layers::normal}, {"depth", &Layers::depth},
    {"position", &Layers::position}, {"id", &Layers::id}};

}  // namespace

Result<Layers> parse_layers(std::string_view text) {
    Layers layers;
    for (std::string_view rest = text;;) {
        const std::size_t comma = rest.find(',');
        const std::string_view name = rest.substr(0, comma);
        const auto known = std::ranges::find(kNames, name, &Switch<Layers>::first);
        if (known != std::end(kNames)) {
            layers.*known->second = true;
        } else if (name.empty()) {
            return usage_error("a layer without a name");
        } else if (std::ranges::find(layers.columns, name) == layers.columns.end()) {
            layers.columns.emplace_back(name);
        }
        if (comma == std::string_view::npos) return layers;
        rest.remove_prefix(comma + 1);
    }
}

std::uint64_t count_in_half(const sampledb::Coverage& coverage, int half) {
    std::uint64_t count = 0;
    for (const sampledb::SampleRange& range : coverage.ranges()) {
        std::uint64_t first = range.first, end = range.end;
        if (first % 2 == 1) count += half_of(first++) == half;
        if (first < end && end % 2 == 1) count += half_of(--end) == half;
        count += first < end ? (end - first) / 2 : 0;
    }
    return count;
}

std::vector<std::string> RowLayout::names(const std::vector<std::string>& channel_names) const {
    std::vector<std::string> all = channel_names;
    const auto add = [&](std::string_view layer) {
        for (const std::string& name : channel_names) all.push_back(fmt::format("{}.{}", layer, name));
    };
    if (layers.noisy) add("noisy");
    if (layers.variance) add("variance");
    if (layers.weight) all.emplace_back("weight");
    if (layers.count) all.emplace_back("count");
    if (layers.halves) add("half0"), add("half1");
    for (const std::string& light : lights) {
        add("light." + light);
        if (layers.halves) add("half0.light." + light), add("half1.light." + light);
    }
    const auto add_aov = [&](bool wanted, std::initializer_list<const char*> names) {
        if (wanted) all.insert(all.end(), names.begin(), names.end());
    };
    add_aov(layers.albedo, {"albedo.R", "albedo.G", "albedo.B"});
    add_aov(layers.normal, {"N.X", "N.Y", "N.Z"});
    add_aov(layers.depth, {"Z"});
    add_aov(layers.position, {"P.X", "P.Y", "P.Z"});
    add_aov(layers.id, {"id.object", "id.material"});
    for (std::string name : layers.columns) {
        while (std::ranges::find(all, name) != all.end()) name.insert(0, "extra.");
        all.push_back(std::move(name));
    }
    return all;
}

}  // namespace latent::develop
