#include "render/load/gltf/schema.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/near_names.h"

namespace latent::render {

namespace {

using Holds = GltfMember::Holds;

constexpr GltfMember any(std::string_view name) { return {name}; }
constexpr GltfMember text(std::string_view name) { return {name, Holds::kText}; }
constexpr GltfMember flag(std::string_view name) { return {name, Holds::kFlag}; }
constexpr GltfMember number(std::string_view name) { return {name, Holds::kNumber}; }
constexpr GltfMember count(std::string_view name) { return {name, Holds::kCount}; }
constexpr GltfMember numbers(std::string_view name, std::uint32_t size) { return {name, Holds::kNumbers, false, size}; }
constexpr GltfMember counts(std::string_view name) { return {name, Holds::kCounts}; }
constexpr GltfMember texts(std::string_view name) { return {name, Holds::kTexts}; }
constexpr GltfMember object(std::string_view name, const GltfObjectType& type) { return {name, Holds::kObject, false, 0, &type}; }
constexpr GltfMember objects(std::string_view name, const GltfObjectType& type) { return {name, Holds::kObjects, false, 0, &type}; }
constexpr GltfMember required(GltfMember member) {
    member.required = true;
    return member;
}

constexpr GltfObjectType kUnread{{}, true};

// Textures and materials.
constexpr GltfMember kTransformMembers[] = {numbers("offset", 2), number("rotation"), numbers("scale", 2), count("texCoord")};
constexpr GltfObjectType kTransform{kTransformMembers};
constexpr GltfMember kInfoExtensionMembers[] = {object("KHR_texture_transform", kTransform)};
constexpr GltfObjectType kInfoExtensions{kInfoExtensionMembers, true};
constexpr GltfMember kInfoMembers[] = {required(count("index")), count("texCoord"), object("extensions", kInfoExtensions)};
constexpr GltfObjectType kInfo{kInfoMembers};
constexpr GltfMember kNormalMembers[] = {required(count("index")), count("texCoord"), number("scale"),
                                         object("extensions", kInfoExtensions)};
constexpr GltfObjectType kNormal{kNormalMembers};

constexpr GltfMember kClearcoatMembers[] = {number("clearcoatFactor"), number("clearcoatRoughnessFactor"),
                                            object("clearcoatTexture", kInfo), object("clearcoatRoughnessTexture", kInfo),
                                            any("clearcoatNormalTexture")};
constexpr GltfObjectType kClearcoat{kClearcoatMembers};
constexpr GltfMember kStrengthMembers[] = {number("emissiveStrength")};
constexpr GltfObjectType kStrength{kStrengthMembers};
constexpr GltfMember kIorMembers[] = {number("ior")};
constexpr GltfObjectType kIor{kIorMembers};
constexpr GltfMember kSheenMembers[] = {numbers("sheenColorFactor", 3), number("sheenRoughnessFactor"),
                                        object("sheenColorTexture", kInfo), object("sheenRoughnessTexture", kInfo)};
constexpr GltfObjectType kSheen{kSheenMembers};
constexpr GltfMember kSpecularMembers[] = {number("specularFactor"), numbers("specularColorFactor", 3), any("specularTexture"),
                                           any("specularColorTexture")};
constexpr GltfObjectType kSpecular{kSpecularMembers};
constexpr GltfMember kTransmissionMembers[] = {number("transmissionFactor"), any("transmissionTexture")};
constexpr GltfObjectType kTransmission{kTransmissionMembers};
constexpr GltfMember kVolumeMembers[] = {number("thicknessFactor"), any("thicknessTexture"), number("attenuationDistance"),
                                         numbers("attenuationColor", 3)};
constexpr GltfObjectType kVolume{kVolumeMembers};
constexpr GltfObjectType kUnlit{};
constexpr GltfMember kMaterialExtensionMembers[] = {object("KHR_materials_clearcoat", kClearcoat),
                                                    object("KHR_materials_emissive_strength", kStrength),
                                                    object("KHR_materials_ior", kIor),
                                                    object("KHR_materials_sheen", kSheen),
                                                    object("KHR_materials_specular", kSpecular),
                                                    object("KHR_materials_transmission", kTransmission),
                                                    object("KHR_materials_unlit", kUnlit),
                                                    object("KHR_materials_volume", kVolume)};
constexpr GltfObjectType kMaterialExtensions{kMaterialExtensionMembers, true};
constexpr GltfMember kPbrMembers[] = {numbers("baseColorFactor", 4), object("baseColorTexture", kInfo), number("metallicFactor"),
                                      number("roughnessFactor"), object("metallicRoughnessTexture", kInfo)};
constexpr GltfObjectType kPbr{kPbrMembers};
constexpr GltfMember kMaterialMembers[] = {text("name"),
                                           object("pbrMetallicRoughness", kPbr),
                                           object("normalTexture", kNormal),
                                           any("occlusionTexture"),
                                           object("emissiveTexture", kInfo),
                                           numbers("emissiveFactor", 3),
                                           text("alphaMode"),
                                           number("alphaCutoff"),
                                           flag("doubleSided"),
                                           object("extensions", kMaterialExtensions)};
constexpr GltfObjectType kMaterial{kMaterialMembers};
constexpr GltfMember kTextureMembers[] = {any("name"), count("sampler"), count("source")};
constexpr GltfObjectType kTexture{kTextureMembers};
constexpr GltfMember kSamplerMembers[] = {any("name"), any("magFilter"), any("minFilter"), count("wrapS"), count("wrapT")};
constexpr GltfObjectType kSampler{kSamplerMembers};
constexpr GltfMember kImageMembers[] = {any("name"), text("uri"), any("mimeType"), count("bufferView")};
constexpr GltfObjectType kImage{kImageMembers};

// Buffers and meshes.
constexpr GltfMember kSparseIndicesMembers[] = {required(count("bufferView")), count("byteOffset"),
                                                required(count("componentType"))};
constexpr GltfObjectType kSparseIndices{kSparseIndicesMembers};
constexpr GltfMember kSparseValuesMembers[] = {required(count("bufferView")), count("byteOffset")};
constexpr GltfObjectType kSparseValues{kSparseValuesMembers};
constexpr GltfMember kSparseMembers[] = {required(count("count")), required(object("indices", kSparseIndices)),
                                         required(object("values", kSparseValues))};
constexpr GltfObjectType kSparse{kSparseMembers};
constexpr GltfMember kAccessorMembers[] = {
    any("name"),        count("bufferView"),      count("byteOffset"),    required(count("componentType")),
    flag("normalized"), required(count("count")), required(text("type")), any("max"),
    any("min"),         object("sparse", kSparse)};
constexpr GltfObjectType kAccessor{kAccessorMembers};
constexpr GltfMember kBufferMembers[] = {any("name"), text("uri"), required(count("byteLength"))};
constexpr GltfObjectType kBuffer{kBufferMembers};
constexpr GltfMember kViewMembers[] = {
    any("name"), required(count("buffer")), count("byteOffset"), required(count("byteLength")), count("byteStride"), any("target")};
constexpr GltfObjectType kView{kViewMembers};
constexpr GltfMember kAttributeMembers[] = {count("POSITION"), count("NORMAL"), any("TANGENT"),  count("TEXCOORD_0"),
                                            any("COLOR_0"),    any("JOINTS_0"), any("WEIGHTS_0")};
constexpr GltfObjectType kAttributes{kAttributeMembers};
constexpr GltfMember kPrimitiveMembers[] = {required(object("attributes", kAttributes)), count("indices"), count("material"),
                                            count("mode"), any("targets")};
constexpr GltfObjectType kPrimitive{kPrimitiveMembers};
constexpr GltfMember kMeshMembers[] = {any("name"), required(objects("primitives", kPrimitive)), any("weights")};
constexpr GltfObjectType kMesh{kMeshMembers};

// Cameras, lights and nodes.
constexpr GltfMember kPerspectiveMembers[] = {number("aspectRatio"), required(number("yfov")), any("zfar"), any("znear")};
constexpr GltfObjectType kPerspective{kPerspectiveMembers};
constexpr GltfMember kOrthographicMembers[] = {required(number("xmag")), required(number("ymag")), any("zfar"), any("znear")};
constexpr GltfObjectType kOrthographic{kOrthographicMembers};
constexpr GltfMember kCameraMembers[] = {any("name"), required(text("type")), object("perspective", kPerspective),
                                         object("orthographic", kOrthographic)};
constexpr GltfObjectType kCamera{kCameraMembers};
constexpr GltfMember kSpotMembers[] = {number("innerConeAngle"), number("outerConeAngle")};
constexpr GltfObjectType kSpot{kSpotMembers};
constexpr GltfMember kLightMembers[] = {text("name"),           numbers("color", 3), number("intensity"),
                                        required(text("type")), any("range"),        object("spot", kSpot)};
constexpr GltfObjectType kLight{kLightMembers};
constexpr GltfMember kLightsMembers[] = {required(objects("lights", kLight))};
constexpr GltfObjectType kLights{kLightsMembers};
constexpr GltfMember kRootExtensionMembers[] = {object("KHR_lights_punctual", kLights)};
constexpr GltfObjectType kRootExtensions{kRootExtensionMembers, true};
constexpr GltfMember kPlacedLightMembers[] = {required(count("light"))};
constexpr GltfObjectType kPlacedLight{kPlacedLightMembers};
constexpr GltfMember kNodeExtensionMembers[] = {object("KHR_lights_punctual", kPlacedLight)};
constexpr GltfObjectType kNodeExtensions{kNodeExtensionMembers, true};
constexpr GltfMember kNodeMembers[] = {any("name"),
                                       count("camera"),
                                       counts("children"),
                                       any("skin"),
                                       numbers("matrix", 16),
                                       count("mesh"),
                                       numbers("rotation", 4),
                                       numbers("scale", 3),
                                       numbers("translation", 3),
                                       any("weights"),
                                       object("extensions", kNodeExtensions)};
constexpr GltfObjectType kNode{kNodeMembers};
constexpr GltfMember kSceneMembers[] = {any("name"), counts("nodes")};
constexpr GltfObjectType kScene{kSceneMembers};

constexpr GltfMember kAssetMembers[] = {any("copyright"), any("generator"), required(text("version")), any("minVersion")};
constexpr GltfObjectType kAsset{kAssetMembers};
constexpr GltfMember kRootMembers[] = {required(object("asset", kAsset)), texts("extensionsUsed"),
                                       texts("extensionsRequired"),       objects("accessors", kAccessor),
                                       objects("animations", kUnread),    objects("buffers", kBuffer),
                                       objects("bufferViews", kView),     objects("cameras", kCamera),
                                       objects("images", kImage),         objects("materials", kMaterial),
                                       objects("meshes", kMesh),          objects("nodes", kNode),
                                       objects("samplers", kSampler),     count("scene"),
                                       objects("scenes", kScene),         objects("skins", kUnread),
                                       objects("textures", kTexture),     object("extensions", kRootExtensions)};
constexpr GltfObjectType kRoot{kRootMembers};

// Where the items are of another kind altogether, the first of them is named.
template <class Check>
bool each(const GltfValue& value, std::string_view what, const Check& check) {
    if (!value.is_array()) return value.error(fmt::format("must be an array of {}", what)), false;
    for (std::size_t i = 0; i < value.size(); ++i) {
        if (!check(value[i])) return false;
    }
    return true;
}
bool is_text(const GltfValue& value) { return value.is_text() || (value.error("must be a string"), false); }
bool is_number(const GltfValue& value) { return value.is_number() || (value.error("must be a finite number"), false); }
bool is_count(const GltfValue& value) { return value.is_count() || (value.error("must be a non-negative integer"), false); }

bool check_object(const GltfValue& value, const GltfObjectType& type);

bool check_objects(const GltfValue& value, const GltfObjectType& type) {
    const auto is_object = [](const GltfValue& item) { return item.is_object() || (item.error("must be an object"), false); };
    if (!each(value, "objects", is_object)) return false;
    bool good = true;
    for (std::size_t i = 0; i < value.size(); ++i) good = check_object(value[i], type) && good;
    return good;
}

bool check_member(const GltfValue& value, const GltfMember& member) {
    switch (member.holds) {
        case Holds::kAnything:
            return true;
        case Holds::kText:
            return is_text(value);
        case Holds::kFlag:
            return value.is_flag() || (value.error("must be true or false"), false);
        case Holds::kNumber:
            return is_number(value);
        case Holds::kCount:
            return is_count(value);
        case Holds::kNumbers:
            if (value.is_array() && value.size() == member.size) return each(value, "numbers", is_number);
            return value.error(fmt::format("must be an array of {} numbers", member.size)), false;
        case Holds::kCounts:
            return each(value, "indices", is_count);
        case Holds::kTexts:
            return each(value, "strings", is_text);
        case Holds::kObject:
            return check_object(value, *member.type);
        case Holds::kObjects:
            return check_objects(value, *member.type);
    }
    return true;
}

// "baseColourFactor": near to a name that the type knows. Names that begin with '_' are the application's own.
void warn_of_unknown(const GltfValue& value, std::string_view name, const GltfObjectType& type) {
    std::vector<std::string> names;
    for (const GltfMember& member : type.members) names.emplace_back(member.name);
    const std::string near = near_names(name, names);
    value.warn_of_kind(
        fmt::format("{}{}", name, static_cast<const void*>(&type)),
        fmt::format("is not part of glTF 2.0, and is ignored{}", near.empty() ? "" : fmt::format("; did you mean {}?", near)));
}

// TEXCOORD_1 is what TEXCOORD_0 is.
std::string first_of_set(const std::string& name) {
    const std::size_t digits = name.find_last_not_of("0123456789") + 1;
    return digits > 1 && digits < name.size() && name[digits - 1] == '_' ? name.substr(0, digits) + "0" : name;
}

bool check_object(const GltfValue& value, const GltfObjectType& type) {
    if (!value.is_object()) return value.error("must be an object"), false;
    bool good = true;
    for (const std::string& name : value.keys()) {
        const auto member = std::ranges::find(type.members, first_of_set(name), &GltfMember::name);
        if (member != type.members.end()) {
            good = check_member(value[name], *member) && good;
        } else if (!type.is_open && name != "extras" && name != "extensions" && !name.starts_with('_')) {
            warn_of_unknown(value[name], name, type);
        }
    }
    std::vector<std::string_view> missing;
    for (const GltfMember& member : type.members) {
        if (member.required && !value[member.name].exists()) missing.push_back(member.name);
    }
    if (!missing.empty()) value.error(fmt::format("has no {}", fmt::join(missing, ", ")));
    return good && missing.empty();
}

}  // namespace

bool check_gltf(const GltfValue& root) { return check_object(root, kRoot); }

}  // namespace latent::render
