#include "image/exr_channels.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <half.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <iterator>
#include <set>

#include "base/bytes.h"
#include "image/spectral_channel.h"

namespace latent::image {
namespace {

using Entries = std::span<const exr_attr_chlist_entry_t>;

std::size_t bytes_of(const exr_attr_chlist_entry_t& entry) { return entry.pixel_type == EXR_PIXEL_HALF ? 2 : 4; }

Error unsupported(const exr_attr_chlist_entry_t& entry, const std::string& what) {
    return Error{ErrorCode::kUnsupported, fmt::format("channel {} {}", entry.name.str, what)};
}

Result<ExrChannel> channel_of(Entries entries, const exr_attr_chlist_entry_t& entry) {
    if (entry.pixel_type == EXR_PIXEL_UINT) return unsupported(entry, "holds integers; only half and float are supported");
    ExrChannel channel{0, entry.pixel_type == EXR_PIXEL_HALF};
    for (const exr_attr_chlist_entry_t* before = entries.data(); before != &entry; ++before) channel.offset += bytes_of(*before);
    return channel;
}

// Red, green and blue in some form, if they are there.
Status find_colour(Entries entries, const std::string& layer, ExrChannels& found) {
    const auto find = [&](const char* channel) {
        const std::string name = layer.empty() ? channel : layer + "." + channel;
        const auto at = std::ranges::find_if(entries, [&](const exr_attr_chlist_entry_t& e) { return name == e.name.str; });
        return at == entries.end() ? nullptr : &*at;
    };
    constexpr std::array<const char*, 3> kNames[] = {{"R", "G", "B"}, {"X", "Y", "Z"}, {"Y", "Y", "Y"}};
    for (const auto& names : kNames) {
        if (!std::ranges::all_of(names, [&](const char* name) { return find(name) != nullptr; })) continue;
        for (std::size_t plane = 0; plane < 3; ++plane) {
            const Result<ExrChannel> channel = channel_of(entries, *find(names[plane]));
            if (!channel) return channel.error();
            found.colour[plane] = *channel;
        }
        found.has_colour = true;
        found.xyz = names[0] == std::string_view("X");
        found.grey = names[0] == std::string_view("Y");
        return {};
    }
    return {};
}

// Channels of emitted light, by wavelength.
Status find_spectrum(Entries entries, ExrChannels& found) {
    std::vector<std::pair<double, const exr_attr_chlist_entry_t*>> emitted;
    for (const exr_attr_chlist_entry_t& entry : entries) {
        if (const std::optional<double> nm = emitted_wavelength_nm(entry.name.str)) emitted.emplace_back(*nm, &entry);
    }
    std::ranges::sort(emitted);
    for (const auto& [nm, entry] : emitted) {
        if (!found.emitted_nm.empty() && nm == found.emitted_nm.back())
            return unsupported(*entry, "has the same wavelength as another channel");
        const Result<ExrChannel> channel = channel_of(entries, *entry);
        if (!channel) return channel.error();
        found.emitted.push_back(*channel);
        found.emitted_nm.push_back(nm);
    }
    return {};
}

// Layers with red, green and blue, or grey.
std::set<std::string> layers_of(Entries entries) {
    std::set<std::string> layers;
    for (const exr_attr_chlist_entry_t& entry : entries) {
        const std::string_view name = entry.name.str;
        const std::size_t dot = name.rfind('.');
        if (dot == std::string_view::npos || dot == 0) continue;
        ExrChannels found;
        if (find_colour(entries, std::string(name.substr(0, dot)), found) && found.has_colour)
            layers.insert(std::string(name.substr(0, dot)));
    }
    return layers;
}

Error no_picture(Entries entries, const std::string& layer) {
    if (std::ranges::any_of(entries, [](const auto& entry) { return is_reflectance(entry.name.str); }))
        return Error{ErrorCode::kUnsupported,
                     "holds spectra of reflectance (channels T.<wavelength>nm), not of light; light them in a renderer first"};
    constexpr std::size_t kEnough = 12;
    if (const std::set<std::string> layers = layers_of(entries); !layers.empty()) {
        const std::vector<std::string> some(layers.begin(), std::next(layers.begin(), std::min(kEnough, layers.size())));
        if (!layer.empty()) return usage_error(fmt::format("no layer {}; the file has {}", layer, fmt::join(some, ", ")));
        return usage_error(fmt::format("its colours are in layers; choose one with --layer: {}", fmt::join(some, ", ")));
    }
    if (!layer.empty()) return usage_error(fmt::format("no layer {}; the file has none", layer));
    std::string names;
    for (std::size_t i = 0; i < std::min(entries.size(), kEnough); ++i)
        names += fmt::format("{}{}", names.empty() ? "" : ", ", entries[i].name.str);
    if (entries.size() > kEnough) names += fmt::format(" and {} more", entries.size() - kEnough);
    return Error{ErrorCode::kUnsupported, "no channels R, G, B or X, Y, Z; the file has " + names};
}

}  // namespace

Result<ExrChannels> find_exr_channels(const std::filesystem::path& path, Entries entries, const ExrChoice& choice) {
    ExrChannels found;
    if (Status s = find_colour(entries, choice.layer, found); !s) return s.error().at(path.string());
    if (choice.spectrum && choice.layer.empty()) {
        if (Status s = find_spectrum(entries, found); !s) return s.error().at(path.string());
    }
    if (!found.has_colour && found.emitted.empty()) return no_picture(entries, choice.layer).at(path.string());
    for (const exr_attr_chlist_entry_t& entry : entries) {
        found.pixel_bytes += bytes_of(entry);
        if (entry.x_sampling != 1 || entry.y_sampling != 1)
            return unsupported(entry, "is subsampled; convert it to full size first").at(path.string());
    }
    return found;
}

void load_channel(const std::byte* from, bool half, std::span<float> out) {
    if (half) {
        for (std::size_t i = 0; i < out.size(); ++i) out[i] = imath_half_to_float(load_le<imath_half_bits_t>(from + 2 * i));
    } else if (std::endian::native == std::endian::little) {
        std::memcpy(out.data(), from, out.size_bytes());
    } else {
        for (std::size_t i = 0; i < out.size(); ++i) out[i] = load_le<float>(from + 4 * i);
    }
}

}  // namespace latent::image
