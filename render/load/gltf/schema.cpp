#include "render/load/gltf/schema.h"

namespace latent::render {

namespace {

using Holds = GltfMember::Holds;

constexpr GltfMember any(std::string_view name) { return {name}; }
constexpr GltfMember unread(std::string_view name, std::string_view kind = "members") {
    return {name, Holds::kUnread, false, 0, nullptr, kind};
}
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
                                            object("clearcoatNormalTexture", kNormal)};
constexpr GltfObjectType kClearcoat{kClearcoatMembers};
constexpr GltfMember kIridescenceMembers[] = {
    number("iridescenceFactor"),           object("iridescenceTexture", kInfo),   number("iridescenceIor"),
    number("iridescenceThicknessMinimum"), number("iridescenceThicknessMaximum"), object("iridescenceThicknessTexture", kInfo)};
constexpr GltfObjectType kIridescence{kIridescenceMembers};
constexpr GltfMember kAnisotropyMembers[] = {number("anisotropyStrength"), number("anisotropyRotation"),
                                             object("anisotropyTexture", kInfo)};
constexpr GltfObjectType kAnisotropy{kAnisotropyMembers};
constexpr GltfMember kStrengthMembers[] = {number("emissiveStrength")};
constexpr GltfObjectType kStrength{kStrengthMembers};
constexpr GltfMember kIorMembers[] = {number("ior")};
constexpr GltfObjectType kIor{kIorMembers};
constexpr GltfMember kSheenMembers[] = {numbers("sheenColorFactor", 3), number("sheenRoughnessFactor"),
                                        object("sheenColorTexture", kInfo), object("sheenRoughnessTexture", kInfo)};
constexpr GltfObjectType kSheen{kSheenMembers};
constexpr GltfMember kSpecularMembers[] = {number("specularFactor"), numbers("specularColorFactor", 3),
                                           object("specularTexture", kInfo), object("specularColorTexture", kInfo)};
constexpr GltfObjectType kSpecular{kSpecularMembers};
constexpr GltfMember kTransmissionMembers[] = {number("transmissionFactor"), object("transmissionTexture", kInfo)};
constexpr GltfObjectType kTransmission{kTransmissionMembers};
constexpr GltfMember kVolumeMembers[] = {number("thicknessFactor"), unread("thicknessTexture"), number("attenuationDistance"),
                                         numbers("attenuationColor", 3)};
constexpr GltfObjectType kVolume{kVolumeMembers};
constexpr GltfObjectType kUnlit{};
constexpr GltfMember kDispersionMembers[] = {number("dispersion")};
constexpr GltfObjectType kDispersion{kDispersionMembers};
constexpr GltfMember kDiffuseTransmissionMembers[] = {
    number("diffuseTransmissionFactor"), object("diffuseTransmissionTexture", kInfo), numbers("diffuseTransmissionColorFactor", 3),
    object("diffuseTransmissionColorTexture", kInfo)};
constexpr GltfObjectType kDiffuseTransmission{kDiffuseTransmissionMembers};
constexpr GltfMember kGlossinessMembers[] = {numbers("diffuseFactor", 4), object("diffuseTexture", kInfo),
                                             numbers("specularFactor", 3), number("glossinessFactor"),
                                             object("specularGlossinessTexture", kInfo)};
constexpr GltfObjectType kGlossiness{kGlossinessMembers};
constexpr GltfMember kMaterialExtensionMembers[] = {object("KHR_materials_anisotropy", kAnisotropy),
                                                    object("KHR_materials_clearcoat", kClearcoat),
                                                    object("KHR_materials_diffuse_transmission", kDiffuseTransmission),
                                                    object("KHR_materials_dispersion", kDispersion),
                                                    object("KHR_materials_pbrSpecularGlossiness", kGlossiness),
                                                    object("KHR_materials_emissive_strength", kStrength),
                                                    object("KHR_materials_ior", kIor),
                                                    object("KHR_materials_iridescence", kIridescence),
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
                                           unread("occlusionTexture"),
                                           object("emissiveTexture", kInfo),
                                           numbers("emissiveFactor", 3),
                                           text("alphaMode"),
                                           number("alphaCutoff"),
                                           flag("doubleSided"),
                                           object("extensions", kMaterialExtensions)};
constexpr GltfObjectType kMaterial{kMaterialMembers};
constexpr GltfMember kWebpMembers[] = {required(count("source"))};
constexpr GltfObjectType kWebp{kWebpMembers};
constexpr GltfMember kTextureExtensionMembers[] = {object("EXT_texture_webp", kWebp)};
constexpr GltfObjectType kTextureExtensions{kTextureExtensionMembers, true};
constexpr GltfMember kTextureMembers[] = {any("name"), count("sampler"), count("source"), object("extensions", kTextureExtensions)};
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
constexpr GltfMember kMeshoptMembers[] = {required(count("buffer")),
                                          count("byteOffset"),
                                          required(count("byteLength")),
                                          required(count("byteStride")),
                                          required(count("count")),
                                          required(text("mode")),
                                          text("filter")};
constexpr GltfObjectType kMeshopt{kMeshoptMembers};
constexpr GltfMember kViewExtensionMembers[] = {object("EXT_meshopt_compression", kMeshopt),
                                                object("KHR_meshopt_compression", kMeshopt)};
constexpr GltfObjectType kViewExtensions{kViewExtensionMembers, true};
constexpr GltfMember kViewMembers[] = {any("name"),
                                       required(count("buffer")),
                                       count("byteOffset"),
                                       required(count("byteLength")),
                                       count("byteStride"),
                                       any("target"),
                                       object("extensions", kViewExtensions)};
constexpr GltfObjectType kView{kViewMembers};
constexpr GltfMember kAttributeMembers[] = {count("POSITION"), count("NORMAL"),   count("TANGENT"), count("TEXCOORD_0"),
                                            count("COLOR_0"),  unread("COLOR_1"), any("JOINTS_0"),  any("WEIGHTS_0")};
constexpr GltfObjectType kAttributes{kAttributeMembers};
constexpr GltfMember kTargetMembers[] = {count("POSITION"), count("NORMAL"), count("TANGENT"),
                                         unread("TEXCOORD_0", "morph targets"), unread("COLOR_0", "morph targets")};
constexpr GltfObjectType kTarget{kTargetMembers};
constexpr GltfMember kMappingMembers[] = {any("name"), required(count("material")), required(counts("variants"))};
constexpr GltfObjectType kMapping{kMappingMembers};
constexpr GltfMember kMappingsMembers[] = {required(objects("mappings", kMapping))};
constexpr GltfObjectType kMappings{kMappingsMembers};
constexpr GltfMember kDracoMembers[] = {required(count("bufferView")), required(object("attributes", kAttributes))};
constexpr GltfObjectType kDraco{kDracoMembers};
constexpr GltfMember kPrimitiveExtensionMembers[] = {object("KHR_draco_mesh_compression", kDraco),
                                                     object("KHR_materials_variants", kMappings)};
constexpr GltfObjectType kPrimitiveExtensions{kPrimitiveExtensionMembers, true};
constexpr GltfMember kPrimitiveMembers[] = {
    required(object("attributes", kAttributes)), count("indices"), count("material"), count("mode"), objects("targets", kTarget),
    object("extensions", kPrimitiveExtensions)};
constexpr GltfObjectType kPrimitive{kPrimitiveMembers};
constexpr GltfMember kMeshMembers[] = {any("name"), required(objects("primitives", kPrimitive)), any("weights")};
constexpr GltfObjectType kMesh{kMeshMembers};

// Cameras, lights and nodes.
constexpr GltfMember kPerspectiveMembers[] = {number("aspectRatio"), required(number("yfov")), unread("zfar"), unread("znear")};
constexpr GltfObjectType kPerspective{kPerspectiveMembers};
constexpr GltfMember kOrthographicMembers[] = {required(number("xmag")), required(number("ymag")), unread("zfar"), unread("znear")};
constexpr GltfObjectType kOrthographic{kOrthographicMembers};
constexpr GltfMember kCameraMembers[] = {any("name"), required(text("type")), object("perspective", kPerspective),
                                         object("orthographic", kOrthographic)};
constexpr GltfObjectType kCamera{kCameraMembers};
constexpr GltfMember kSpotMembers[] = {number("innerConeAngle"), number("outerConeAngle")};
constexpr GltfObjectType kSpot{kSpotMembers};
constexpr GltfMember kLightMembers[] = {text("name"),           numbers("color", 3), number("intensity"),
                                        required(text("type")), unread("range"),     object("spot", kSpot)};
constexpr GltfObjectType kLight{kLightMembers};
constexpr GltfMember kLightsMembers[] = {required(objects("lights", kLight))};
constexpr GltfObjectType kLights{kLightsMembers};
constexpr GltfMember kVariantMembers[] = {required(text("name"))};
constexpr GltfObjectType kVariant{kVariantMembers};
constexpr GltfMember kVariantsMembers[] = {required(objects("variants", kVariant))};
constexpr GltfObjectType kVariants{kVariantsMembers};
constexpr GltfMember kRootExtensionMembers[] = {object("KHR_lights_punctual", kLights),
                                                object("KHR_materials_variants", kVariants)};
constexpr GltfObjectType kRootExtensions{kRootExtensionMembers, true};
constexpr GltfMember kPlacedLightMembers[] = {required(count("light"))};
constexpr GltfObjectType kPlacedLight{kPlacedLightMembers};
constexpr GltfMember kInstanceAttributeMembers[] = {count("TRANSLATION"), count("ROTATION"), count("SCALE")};
constexpr GltfObjectType kInstanceAttributes{kInstanceAttributeMembers};
constexpr GltfMember kInstancingMembers[] = {required(object("attributes", kInstanceAttributes))};
constexpr GltfObjectType kInstancing{kInstancingMembers};
constexpr GltfMember kNodeExtensionMembers[] = {object("EXT_mesh_gpu_instancing", kInstancing),
                                                object("KHR_lights_punctual", kPlacedLight)};
constexpr GltfObjectType kNodeExtensions{kNodeExtensionMembers, true};
constexpr GltfMember kNodeMembers[] = {any("name"),
                                       count("camera"),
                                       counts("children"),
                                       count("skin"),
                                       numbers("matrix", 16),
                                       count("mesh"),
                                       numbers("rotation", 4),
                                       numbers("scale", 3),
                                       numbers("translation", 3),
                                       any("weights"),
                                       object("extensions", kNodeExtensions)};
constexpr GltfObjectType kNode{kNodeMembers};
constexpr GltfMember kSkinMembers[] = {any("name"), count("inverseBindMatrices"), any("skeleton"), required(counts("joints"))};
constexpr GltfObjectType kSkin{kSkinMembers};
constexpr GltfMember kSceneMembers[] = {any("name"), counts("nodes")};
constexpr GltfObjectType kScene{kSceneMembers};

constexpr GltfMember kAssetMembers[] = {any("copyright"), any("generator"), required(text("version")), text("minVersion")};
constexpr GltfObjectType kAsset{kAssetMembers};
constexpr GltfMember kRootMembers[] = {required(object("asset", kAsset)), texts("extensionsUsed"),
                                       texts("extensionsRequired"),       objects("accessors", kAccessor),
                                       objects("animations", kUnread),    objects("buffers", kBuffer),
                                       objects("bufferViews", kView),     objects("cameras", kCamera),
                                       objects("images", kImage),         objects("materials", kMaterial),
                                       objects("meshes", kMesh),          objects("nodes", kNode),
                                       objects("samplers", kSampler),     count("scene"),
                                       objects("scenes", kScene),         objects("skins", kSkin),
                                       objects("textures", kTexture),     object("extensions", kRootExtensions)};
constexpr GltfObjectType kRoot{kRootMembers};

}  // namespace

const GltfObjectType& gltf_document() { return kRoot; }

}  // namespace latent::render
