#include "render/load/gltf/extensions.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

namespace latent::render {

std::span<const std::string_view> known_extensions() {
    static constexpr std::string_view kKnown[] = {"EXT_instance_features",
                                                  "EXT_mesh_features",
                                                  "EXT_mesh_gpu_instancing",
                                                  "EXT_mesh_manifold",
                                                  "EXT_meshopt_compression",
                                                  "EXT_structural_metadata",
                                                  "EXT_texture_webp",
                                                  "FB_ngon_encoding",
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
                                                  "KHR_texture_transform",
                                                  "KHR_xmp",
                                                  "KHR_xmp_json_ld",
                                                  "MSFT_lod"};
    return kKnown;
}

bool is_known_extension(std::string_view name) { return std::ranges::count(known_extensions(), name) > 0; }

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
        if (!is_known_extension(name) && std::ranges::count(refused, name) == 0)
            used[i].warn(fmt::format("{} is not supported, and is ignored", name));
    }
    return refused.empty();
}

}  // namespace latent::render
