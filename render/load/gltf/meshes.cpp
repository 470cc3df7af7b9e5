#include "render/load/gltf/meshes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "render/load/gltf/accessors.h"
#include "render/load/gltf/draco.h"
#include "render/load/gltf/extensions.h"

namespace latent::render {

namespace {

enum Mode : std::uint64_t { kTriangles = 4, kStrip = 5, kFan = 6 };

// Three indices per triangle, of vertices that are taken in order.
std::vector<std::uint32_t> triangles_of(std::vector<std::uint32_t> order, std::uint64_t mode) {
    if (mode == kTriangles || order.size() < 3) return order;
    std::vector<std::uint32_t> out;
    for (std::size_t i = 2; i < order.size(); ++i) {
        if (mode == kFan) {
            out.insert(out.end(), {order[i - 1], order[i], order[0]});
        } else if (i % 2 == 0) {
            out.insert(out.end(), {order[i - 2], order[i - 1], order[i]});
        } else {
            out.insert(out.end(), {order[i - 2], order[i], order[i - 1]});
        }
    }
    return out;
}

// Leaves out vertices that no triangle uses: primitives of one mesh often share all of theirs.
void keep_used_vertices(LoadedMesh& mesh) {
    std::vector<std::uint32_t> moved(mesh.positions.size(), kNone);
    for (const std::uint32_t i : mesh.indices) moved[i] = 0;
    std::uint32_t used = 0;
    for (std::uint32_t& to : moved) {
        if (to != kNone) to = used++;
    }
    if (used == moved.size()) return;
    const auto keep = [&](auto& values) {
        if (values.empty()) return;
        for (std::size_t i = 0; i < moved.size(); ++i) {
            if (moved[i] != kNone) values[moved[i]] = values[i];
        }
        values.resize(used);
    };
    keep(mesh.positions);
    mesh.positions.shrink_to_fit();
    keep(mesh.normals);
    keep(mesh.tangents);
    keep(mesh.bitangents);
    keep(mesh.uvs);
    for (std::vector<Vec2f>& set : mesh.more_uvs) keep(set);
    keep(mesh.colors);
    for (std::uint32_t& i : mesh.indices) i = moved[i];
}

// What a primitive says of its vertices: lists of numbers in accessors, or in the compression of Draco.
class PrimitiveAttributes {
 public:
    // Nothing, with an error, if what is compressed cannot be read.
    static std::optional<PrimitiveAttributes> of(const GltfDocument& document, const GltfValue& primitive) {
        PrimitiveAttributes out(document, primitive);
        if (!out.draco_.exists()) return out;
        const std::optional<std::string> packed = buffer_view(document, out.draco_["bufferView"]);
        if (!packed) return std::nullopt;
        Result<DracoMesh> unpacked = unpack_draco(*packed);
        if (!unpacked) {
            out.draco_["bufferView"].error(unpacked.error().message);
            return std::nullopt;
        }
        out.unpacked_ = std::move(*unpacked);
        return out;
    }

    GltfValue operator[](const std::string& name) const { return named_[name]; }
    bool are_packed(const std::string& name) const { return unpacked_ && draco_["attributes"][name].exists(); }
    std::size_t components(const std::string& name) const { return components_of(document_, named_[name]); }
    // As read_floats; only positions must be finite.
    std::optional<std::vector<float>> read(const std::string& name, std::size_t components) const {
        const Finite finite = name == "POSITION" ? Finite::kRequired : Finite::kDesired;
        if (!are_packed(name)) return read_floats(document_, named_[name], components, finite);
        const GltfValue id = draco_["attributes"][name], accessors = document_.root()["accessors"];
        const std::optional<std::uint32_t> accessor = named_[name].index(accessors);
        if (!accessor) return std::nullopt;
        const auto found = unpacked_->attributes.find(static_cast<std::uint32_t>(id.count(0)));
        if (found == unpacked_->attributes.end() || found->second.components != components) {
            id.error(found == unpacked_->attributes.end()
                         ? "the compressed mesh has no such attribute"
                         : fmt::format("has {} numbers per item; {} needs {}", found->second.components, name, components));
            return std::nullopt;
        }
        std::vector<float> out = found->second.values;
        const float scale = accessors[*accessor]["normalized"].flag(false) ? found->second.largest : 1;
        for (float& x : out) x = scale != 1 ? std::max(x / scale, -1.0f) : x;
        if (!make_finite(out, components, finite, id)) return std::nullopt;
        return out;
    }
    // The divisor of integers that are not normalized; else 1.
    float largest(const std::string& name) const { return largest_integer(document_, named_[name]); }
    // Three of each triangle, if they are compressed, too.
    const std::vector<std::uint32_t>* packed_indices() const { return unpacked_ ? &unpacked_->indices : nullptr; }

 private:
    PrimitiveAttributes(const GltfDocument& document, const GltfValue& primitive)
        : document_(document), named_(primitive["attributes"]), draco_(primitive.extension("KHR_draco_mesh_compression")) {}

    const GltfDocument& document_;
    GltfValue named_, draco_;
    std::optional<DracoMesh> unpacked_{};
};

// A list of positions without data is one of zeros in glTF, but what exporters mean by it is that the data are in an extension.
bool has_positions(const GltfDocument& document, const GltfValue& primitive) {
    const GltfValue position = primitive["attributes"]["POSITION"];
    const std::optional<std::uint32_t> i = position.index(document.root()["accessors"]);
    if (!i) return false;
    const GltfValue accessor = document.root()["accessors"][*i];
    if (accessor["bufferView"].exists() || accessor["sparse"].exists()) return true;
    std::vector<std::string> unknown = primitive["extensions"].keys();
    std::erase_if(unknown, is_known_extension);
    position.error(unknown.empty() ? "its accessor has no data"
                                   : fmt::format("its accessor has no data; {} is not supported", fmt::join(unknown, " and ")));
    return false;
}

// COLOR_0, RGB or RGBA.
std::vector<std::array<float, 4>> colors_of(std::vector<float> x, std::size_t components) {
    std::vector<std::array<float, 4>> out;
    for (std::size_t i = 0; i < x.size(); i += components) {
        std::array<float, 4> color{1, 1, 1, 1};
        for (std::size_t c = 0; c < components; ++c) color[c] = std::clamp(x[i + c], 0.0f, 1.0f);
        out.push_back(color);
    }
    return out;
}

// Adds what morph targets move. False: an error.
bool morph(const GltfDocument& document, const GltfValue& targets, const std::vector<double>& weights, LoadedMesh& mesh) {
    for (std::size_t t = 0; t < std::min(targets.size(), weights.size()); ++t) {
        if (weights[t] == 0) continue;
        const auto add = [&](const GltfValue& index, auto& values) {
            if (!index.exists() || values.empty()) return true;
            const std::optional<std::vector<float>> moved = read_floats(document, index, 3);
            if (!moved) return false;
            if (moved->size() != 3 * values.size()) {
                index.error(fmt::format("has {} items for {} vertices", moved->size() / 3, values.size()));
                return false;
            }
            using Value = std::remove_reference_t<decltype(values[0])>;
            for (std::size_t i = 0; i < values.size(); ++i)
                values[i] += Value(Vec3d((*moved)[3 * i], (*moved)[3 * i + 1], (*moved)[3 * i + 2]) * weights[t]);
            return true;
        };
        if (!add(targets[t]["POSITION"], mesh.positions) || !add(targets[t]["NORMAL"], mesh.normals) ||
            !add(targets[t]["TANGENT"], mesh.tangents))
            return false;
    }
    return true;
}

// Bends the mesh by its joints: each vertex by the mean of their maps. False: an error.
bool skin(const PrimitiveAttributes& attributes, const std::vector<Affined>& joints, LoadedMesh& mesh) {
    std::vector<Affined> map(mesh.positions.size(), {{}, {}, {}, {}});
    std::vector<double> sum(map.size());
    for (int set = 0; attributes["JOINTS_" + std::to_string(set)].is_count(); ++set) {
        const GltfValue which = attributes["JOINTS_" + std::to_string(set)], share = attributes["WEIGHTS_" + std::to_string(set)];
        if (!share.exists()) which.error("has no weights");
        const std::optional<std::vector<float>> j = attributes.read("JOINTS_" + std::to_string(set), 4),
                                                w = attributes.read("WEIGHTS_" + std::to_string(set), 4);
        if (!j || !w) return false;
        if (j->size() != 4 * map.size() || w->size() != j->size()) {
            which.error(fmt::format("has {} items, and its weights {}, for {} vertices", j->size() / 4, w->size() / 4, map.size()));
            return false;
        }
        for (std::size_t i = 0; i < j->size(); ++i) {
            const auto weight = static_cast<double>((*w)[i]);
            if (weight == 0) continue;
            const auto joint = static_cast<std::size_t>(std::max((*j)[i], 0.0f));
            if (joint >= joints.size()) {
                which.error(fmt::format("joint {} is out of range; the skin has {}", joint, joints.size()));
                return false;
            }
            Affined& m = map[i / 4];
            const Affined& by = joints[joint];
            m = {m.x + by.x * weight, m.y + by.y * weight, m.z + by.z * weight, m.t + by.t * weight};
            sum[i / 4] += weight;
        }
    }
    for (std::size_t i = 0; i < map.size(); ++i) {
        if (!(sum[i] > 0)) continue;  // it stays where it is
        const Affined m = {map[i].x / sum[i], map[i].y / sum[i], map[i].z / sum[i], map[i].t / sum[i]};
        mesh.positions[i] = m.point(mesh.positions[i]);
        if (!mesh.tangents.empty()) mesh.tangents[i] = Vec3f(m.vector(Vec3d(mesh.tangents[i])));
        if (!mesh.normals.empty() && m.inverse()) mesh.normals[i] = Vec3f(m.normal(Vec3d(mesh.normals[i])));
    }
    return true;
}

bool read_vertices(const GltfDocument& document, const GltfValue& primitive, const PrimitiveAttributes& attributes,
                   const GltfPose& pose, const VertexNeeds& needs, LoadedMesh& mesh) {
    const std::vector<std::uint32_t>& uv_sets = needs.uv_sets;
    const std::optional<std::vector<float>> p = attributes.read("POSITION", 3);
    if (!p) return false;
    for (std::size_t i = 0; i < p->size(); i += 3) mesh.positions.emplace_back((*p)[i], (*p)[i + 1], (*p)[i + 2]);
    const auto per_vertex = [&](const std::string& name, std::size_t components) -> std::vector<float> {
        if (!attributes[name].exists()) return {};
        std::optional<std::vector<float>> x = attributes.read(name, components);
        if (!x) return {};
        if (x->size() / components == mesh.positions.size()) return std::move(*x);
        attributes[name].error(fmt::format("has {} items for {} vertices", x->size() / components, mesh.positions.size()));
        return {};
    };
    const std::vector<float> n = per_vertex("NORMAL", 3);
    for (std::size_t i = 0; i < n.size(); i += 3) mesh.normals.emplace_back(n[i], n[i + 1], n[i + 2]);
    std::vector<float> t;  // x, y, z and the sign of v's direction; they mean nothing without normals
    if (needs.tangents && !n.empty()) t = per_vertex("TANGENT", 4);
    for (std::size_t i = 0; i < t.size(); i += 4) mesh.tangents.emplace_back(t[i], t[i + 1], t[i + 2]);
    if (!morph(document, primitive["targets"], pose.weights, mesh)) return false;
    if (!pose.joints.empty() && !skin(attributes, pose.joints, mesh)) return false;
    for (Vec3f& normal : mesh.normals) {
        const float size = length(normal);
        normal = size > 0 ? normal / size : Vec3f{};
    }
    for (std::size_t i = 0; i < mesh.tangents.size(); ++i)
        mesh.bitangents.push_back(cross(mesh.normals[i], mesh.tangents[i]) * t[4 * i + 3]);
    const auto coordinates = [&](std::uint32_t set) {
        const std::vector<float> uv = per_vertex("TEXCOORD_" + std::to_string(set), 2);
        std::vector<Vec2f> out;
        for (std::size_t i = 0; i < uv.size(); i += 2) out.push_back({uv[i], 1 - uv[i + 1]});
        return out;
    };
    mesh.uvs = coordinates(uv_sets.empty() ? 0 : uv_sets[0]);
    for (std::size_t i = 1; i < uv_sets.size(); ++i) {
        mesh.more_uvs.push_back(coordinates(uv_sets[i]));
        if (mesh.more_uvs.back().empty()) mesh.more_uvs.back().resize(mesh.positions.size());
    }
    for (std::size_t i = 0; i < uv_sets.size(); ++i) {
        const std::string name = "TEXCOORD_" + std::to_string(uv_sets[i]);
        if (attributes[name].exists()) continue;
        primitive["attributes"].warn_of_kind(
            "without " + name,
            fmt::format("has no {}, which textures of its material use; {}", name,
                        i == 0 ? "each triangle shows one half of their pictures" : "it shows one point of their pictures"));
    }
    const std::size_t components = std::clamp<std::size_t>(attributes.components("COLOR_0"), 3, 4);
    std::vector<float> colors = per_vertex("COLOR_0", components);
    const float largest = attributes.largest("COLOR_0");
    if (largest > 1) {
        attributes["COLOR_0"].warn_of_kind("COLOR_0", "is of integers that are not normalized; they are fractions of the largest");
        for (float& x : colors) x /= largest;
    }
    mesh.colors = colors_of(std::move(colors), components);
    return true;
}

}  // namespace

std::vector<GltfPrimitive> read_mesh(const GltfDocument& document, const GltfValue& mesh, const GltfPose& pose,
                                     const GltfMaterialLookup& materials) {
    std::vector<GltfPrimitive> out;
    const GltfValue primitives = mesh["primitives"];
    for (std::size_t i = 0; i < primitives.size(); ++i) {
        const GltfValue primitive = primitives[i];
        const std::uint64_t mode = primitive["mode"].count(kTriangles);
        if (mode < kTriangles) {
            primitive.warn_of_kind("points", "points and lines are ignored");
            continue;
        }
        if (mode > kFan || !primitive["attributes"]["POSITION"].exists()) {
            primitive.error(mode > kFan ? "its mode is unknown" : "has no POSITION");
            continue;
        }
        const std::optional<PrimitiveAttributes> attributes = PrimitiveAttributes::of(document, primitive);
        if (!attributes || !(attributes->are_packed("POSITION") || has_positions(document, primitive))) continue;
        GltfPrimitive read;
        read.material = materials.material_of(primitive);
        if (!read_vertices(document, primitive, *attributes, pose, materials.needs_of(read.material), read.mesh)) continue;
        std::vector<std::uint32_t> order;
        if (attributes->packed_indices() != nullptr) {
            order = *attributes->packed_indices();
        } else if (primitive["indices"].exists()) {
            std::optional<std::vector<std::uint32_t>> indices = read_indices(document, primitive["indices"]);
            if (!indices) continue;
            order = std::move(*indices);
        } else {
            order.resize(read.mesh.positions.size());
            std::iota(order.begin(), order.end(), 0u);
        }
        const auto wrong = std::ranges::find_if(order, [&](std::uint32_t v) { return v >= read.mesh.positions.size(); });
        if (wrong != order.end()) {
            primitive["indices"].error(
                fmt::format("index {} is out of range; there are {} vertices", *wrong, read.mesh.positions.size()));
            continue;
        }
        if (mode == kTriangles && order.size() % 3 != 0) {
            primitive.error(fmt::format("has {} indices, which is not a multiple of 3", order.size()));
            continue;
        }
        read.mesh.indices = attributes->packed_indices() != nullptr ? std::move(order) : triangles_of(std::move(order), mode);
        if (read.mesh.indices.size() < 3) continue;
        keep_used_vertices(read.mesh);
        out.push_back(std::move(read));
    }
    return out;
}

}  // namespace latent::render
