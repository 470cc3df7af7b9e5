#include "render/load/files/unread.h"

#include <algorithm>

namespace latent::render {

namespace {

using enum SceneLanguage;
constexpr std::string_view kSame = "it does not change the picture", kSpp = "set the number of samples with --spp or --samples",
                           kNamed = "-o names the samples, latent-develop writes the picture",
                           kWhole = "samples cover the whole film; latent-develop --crop takes a part",
                           kOther = "it belongs to another integrator", kLost = "pbrt-v4 has no such surface",
                           kCoat = "the coat reflects what its index says",
                           kExposure = "set the exposure with latent-convert --sensitivity";

constexpr UnreadFeatures kUnreadFeatures[] = {
    // Types of pbrt are errors, and so are parameters and options that are not here.
    {kPbrtV4, "Camera type", "realistic", "use \"perspective\" with \"lensradius\" and \"focaldistance\""},
    {kPbrtV4, "Integrator type", "ambientocclusion function lightpath randomwalk", "choose one with --integrator"},
    {kPbrtV4, "Texture type", "ptex", "convert it to pictures, for \"imagemap\""},
    {kPbrtV4, "Sampler", "", kSpp, true},
    {kPbrtV4, "PixelFilter", "", "choose a filter with latent-develop --filter", true},
    {kPbrtV4, "Accelerator", "", kSame, true},
    {kPbrtV4, "Film", "filename savefp16", kNamed, true},
    {kPbrtV4, "Film", "pixelbounds cropwindow", kWhole, true},
    {kPbrtV4, "Film", "sensor", "choose one with latent-develop --observer", true},
    {kPbrtV4, "Film", "iso", kExposure, true},
    {kPbrtV4, "Film", "maxcomponentvalue whitebalance nbuckets lambdamin lambdamax", "it is decided when samples become pixels",
     true},
    {kPbrtV4, "Film", "diagonal coordinatesystem", kSame, true},
    {kPbrtV4, "Integrator", "regularize", "reflections are not blurred"},
    {kPbrtV4, "Integrator", "lightsampler visualizestrategies visualizeweights", kSame, true},
    {kPbrtV4, "Integrator",
     "samplelights samplebsdf bootstrapsamples chains mutationsperpixel largestepprobability sigma photonsperiteration radius seed "
     "cossample maxdistance function filename skipbad imagefilename",
     kOther, true},
    {kPbrtV4, "Shape", "faceIndices", "only Ptex textures use it", true},
    {kPbrtV4, "Shape", "edgelength", "there is no displacement", true},
    {kPbrtV4, "Shape", "splitdepth", "curves are not split", true},
    {kPbrtV4, "Shape", "scheme", "Loop's is the only one", true},
    {kPbrtV4, "Option", "displacementedgescale msereferenceimage msereferenceout pixelstats rendercoordsys seed wavefront", kSame,
     true},
    {kPbrtV4, "Option", "disabletexturefiltering", "textures are filtered"},

    {kPbrtV3, "Shape type", "heightfield nurbs", "convert it to a mesh"},
    {kPbrtV3, "Texture type", "uv", "pbrt-v4 has no such texture"},
    {kPbrtV3, "Material type", "fourier", "pbrt-v4 has no such material"},
    {kPbrtV3, "Film", "scale", kExposure, true},
    {kPbrtV3, "Integrator", "rrthreshold lightsamplestrategy strategy", kSame, true},
    {kPbrtV3, "Integrator", "numiterations imagewritefrequency", kOther, true},
    {kPbrtV3, "Integrator", "pixelbounds", kWhole, true},
    {kPbrtV3, "LightSource", "samples nsamples", kSpp, true},
    {kPbrtV3, "AreaLightSource", "samples nsamples", kSpp, true},
    {kPbrtV3, "Shape", "nsamples", kSpp, true},
    {kPbrtV3, "Shape", "discarddegenerateUVs", kSame, true},
    {kPbrtV3, "Shape", "shadowalpha", "shadows have the alpha of the shape"},
    {kPbrtV3, "Texture", "aamode", "textures are filtered", true},
    {kPbrtV3, "matte", "sigma", "the surface is Lambert's"},
    {kPbrtV3, "plastic", "Ks", kCoat},
    {kPbrtV3, "substrate", "Ks", kCoat},
    {kPbrtV3, "uber", "Ks", kCoat},
    {kPbrtV3, "uber", "Kr Kt", kLost},
    {kPbrtV3, "glass", "Kr Kt", "glass has no colour of its own"},
    {kPbrtV3, "metal", "Kr", kLost},
    {kPbrtV3, "translucent", "Ks", "translucent surfaces are matt"},
    {kPbrtV3, "subsurface", "Kr Kt", kLost},
    {kPbrtV3, "disney", "sheentint speculartint flatness difftrans scatterdistance", "latent:principled has no such part"},

    // An extension that a file requires is an error, unless it is harmless; so is one that is not here.
    {kGltf, "extensions", "EXT_texture_avif GOOGLE_texture_basis KHR_texture_basisu MSFT_texture_dds",
     "the other picture of the texture is used, if it has one"},
    {kGltf, "extensions",
     "ADOBE_materials_thin_transparency MSFT_packing_normalRoughnessMetallic MSFT_packing_occlusionRoughnessMetallic "
     "NV_materials_mdl VRMC_materials_mtoon",
     "what the material has beside it is used"},
    {kGltf, "extensions", "ADOBE_materials_clearcoat_specular ADOBE_materials_clearcoat_tint",
     "clear coats have an index of 1.5 and no colour"},
    {kGltf, "extensions", "KHR_materials_volume_scatter", "what is inside absorbs light, and does not scatter it"},
    {kGltf, "extensions", "KHR_materials_common KHR_techniques_webgl", "materials of glTF 1.0 are not shown"},
    {kGltf, "extensions", "KHR_gaussian_splatting KHR_spz_gaussian_splats_compression", "splats are points, which are not drawn"},
    {kGltf, "extensions", "CESIUM_primitive_outline EXT_mesh_primitive_edge_visibility", "edges are not drawn"},
    {kGltf, "extensions", "CESIUM_RTC", "the model stays where its own coordinates put it"},
    {kGltf, "extensions", "EXT_lights_ies", "lamps shine alike in all directions"},
    {kGltf, "extensions", "EXT_lights_image_based", "its sky is not shown; use --sky"},
    {kGltf, "extensions", "KHR_animation_pointer", "materials, lamps and cameras do not change with time"},
    {kGltf, "extensions", "KHR_node_visibility", "hidden nodes are shown, too"},
    {kGltf, "extensions", "MSFT_lod", "the model is shown in full detail", true},
    {kGltf, "extensions",
     "EXT_instance_features EXT_mesh_features EXT_mesh_manifold EXT_structural_metadata FB_ngon_encoding KHR_audio_emitter "
     "KHR_interactivity KHR_node_hoverability KHR_node_selectability KHR_physics_rigid_bodies KHR_xmp KHR_xmp_json_ld",
     kSame, true},
    {kGltf, "members", "COLOR_1", "glTF 2.0 has a use for COLOR_0 alone", true},
    {kGltf, "members", "occlusionTexture", "occlusion is computed", true},
    {kGltf, "members", "range", "lamps fade with the inverse square of the distance"},
    {kGltf, "members", "thicknessTexture", "light takes its way through the shape", true},
    {kGltf, "members", "znear zfar", "nothing is cut off near the camera or far away", true, true},
    {kGltf, "morph targets", "COLOR_0 TEXCOORD_0", "only positions, normals and tangents move"},

    {kObj, "statements", "p l", "points and lines are not drawn"},
    {kObj, "statements", "bmat bsp bzp cdc cdp con cstype ctech curv curv2 deg end hole parm res scrv sp step stech surf trim vp",
     "free-form curves and surfaces are not drawn"},
    {kObj, "statements", "bevel c_interp d_interp lod", "they are about how a program shows the model", true},
    {kObj, "statements", "shadow_obj trace_obj", "the model itself casts its shadows"},
    {kObj, "statements", "call csh", "no other file or program is run"},
    {kObj, "statements", "maplib usemap", "maps come with materials"},
    {kObj, "materials", "Ka map_Ka", "light from all around is computed", true, true},
    {kObj, "materials", "Kt", "a colour of transparency is Tf"},
    {kObj, "materials", "aniso anisor", "reflections are blurred alike in all directions"},
    {kObj, "materials", "bump disp", "heights have no unit"},
    {kObj, "materials", "decal", "it has no colour of its own"},
    {kObj, "materials", "map_refl refl", "what a surface mirrors is computed"},
    {kObj, "materials", "sharpness", "it is that of refl", true},
    {kObj, "materials", "map_aat", "pixels are always filtered", true},
    {kObj, "colours", "spectral xyz", "they are black"},
    {kObj, "options of maps", "-boost -cc -mm -t", "the picture is used as it is"},
    {kObj, "options of maps", "-blendu -blendv -colorspace -texres -type", "the picture is used as any other", true},
};

bool has_word(std::string_view words, std::string_view word) {
    if (word.empty() || words.empty()) return words == word;
    for (std::size_t begin = 0; begin < words.size();) {
        const std::size_t end = std::min(words.find(' ', begin), words.size());
        if (words.substr(begin, end - begin) == word) return true;
        begin = end + 1;
    }
    return false;
}

}  // namespace

std::span<const UnreadFeatures> unread_features() { return kUnreadFeatures; }

const UnreadFeatures* find_unread(SceneLanguage language, std::string_view kind, std::string_view name) {
    const auto found = std::ranges::find_if(kUnreadFeatures, [&](const UnreadFeatures& of) {
        return of.language == language && of.kind == kind && has_word(of.names, name);
    });
    return found != std::end(kUnreadFeatures) ? &*found : nullptr;
}

std::string why_unread(SceneLanguage language, std::string_view kind, std::string_view name) {
    const UnreadFeatures* const found = find_unread(language, kind, name);
    return found != nullptr ? ": " + std::string(found->why) : "";
}

}  // namespace latent::render
