#include "render/load/gltf/extensions.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "render/load/files/unread.h"

namespace latent::render {

std::span<const std::string_view> known_extensions() {
    static constexpr std::string_view kKnown[] = {"EXT_mesh_gpu_instancing",
                                                  "EXT_meshopt_compression",
                                                  "EXT_texture_webp",
                                                  "KHR_draco_mesh_compression",
                                                  "KHR_lights_punctual",
                                                  "KHR_materials_anisotropy",
                                                  "KHR_materials_clearcoat",
                                                  "KHR_materials_diffuse_transmission",
                                                  "KHR_materials_dispersion",
                                                  "KHR_materials_emissive_strength",
                                                  "KHR_materials_ior",
                                                  "KHR_materials_iridescence",
                                                  "KHR_materials_pbrSpecularGlossiness",
                                                  "KHR_materials_sheen",
                                                  "KHR_materials_specular",
                                                  "KHR_materials_transmission",
                                                  "KHR_materials_unlit",
                                                  "KHR_materials_variants",
                                                  "KHR_materials_volume",
                                                  "KHR_mesh_quantization",
                                                  "KHR_meshopt_compression",
                                                  "KHR_texture_transform"};
    return kKnown;
}

bool is_known_extension(std::string_view name) {
    const UnreadFeatures* const unread = find_unread(SceneLanguage::kGltf, "extensions", name);
    return std::ranges::count(known_extensions(), name) > 0 || (unread != nullptr && unread->is_harmless);
}

std::string unsupported_extension(std::string_view name) {
    return fmt::format("is not supported, and is ignored{}", why_unread(SceneLanguage::kGltf, "extensions", name));
}

bool check_extensions(const GltfValue& root) {
    const GltfValue required = root["extensionsRequired"], used = root["extensionsUsed"];
    std::vector<std::string> refused;
    for (std::size_t i = 0; i < required.size(); ++i) {
        const std::string name = required[i].text();
        if (is_known_extension(name)) continue;
        required[i].error(fmt::format("{} is not supported", name));
        refused.push_back(name);
    }
    for (std::size_t i = 0; i < used.size(); ++i) {
        const std::string name = used[i].text();
        if (!is_known_extension(name)) {
            if (std::ranges::count(refused, name) == 0) used[i].warn(fmt::format("{} {}", name, unsupported_extension(name)));
        } else if (const std::string why = why_unread(SceneLanguage::kGltf, "extensions", name); !why.empty()) {
            used[i].note(fmt::format("{} is ignored{}", name, why));
        }
    }
    return refused.empty();
}

}  // namespace latent::render
