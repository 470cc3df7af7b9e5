// render/load/files/unread.h: what the formats of scenes have and Latent does not read: said at loading, and by --list-features.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace latent::render {

enum class SceneLanguage { kPbrtV4, kPbrtV3, kGltf, kObj };

struct UnreadFeatures {
    SceneLanguage language;
    std::string_view kind;     // what they are: "extensions"; in pbrt, the directive of these parameters, or "Shape type"
    std::string_view names;    // with spaces between them; empty: the kind itself
    std::string_view why;      // or what happens, or what to do instead; it may follow a colon
    bool is_harmless = false;  // no sample depends on them
    bool is_usual = false;     // nearly every file has them, so they are said by --list-features alone
};

std::span<const UnreadFeatures> unread_features();
// Null if there is no such feature, or if it is read.
const UnreadFeatures* find_unread(SceneLanguage language, std::string_view kind, std::string_view name);
// ": occlusion is computed", or nothing.
std::string why_unread(SceneLanguage language, std::string_view kind, std::string_view name);

}  // namespace latent::render
