#include "render/load/gltf/gltf.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "render/load/gltf/accessors.h"
#include "render/load/gltf/animation.h"
#include "render/load/gltf/lights.h"
#include "render/load/gltf/materials.h"
#include "render/load/gltf/meshes.h"

namespace latent::render {

namespace {

constexpr std::uint64_t kMaxVertices = 1 << 30;  // in all primitives: a small file can name large ones many times

Affined rotation(const std::array<double, 4>& q) {  // x y z w, of unit length
    const double x = q[0], y = q[1], z = q[2], w = q[3];
    return {{1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)},
            {2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)},
            {2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)},
            {}};
}

Affined local_transform(const GltfValue& node, const GltfNodePose& pose) {
    if (node["matrix"].exists() && !pose.is_placed()) {
        const std::array<double, 16> m =
            node["matrix"].numbers(std::array<double, 16>{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1});
        if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1) node["matrix"].error("must be affine");
        for (const char* name : {"translation", "rotation", "scale"}) {
            if (node[name].exists()) node[name].warn("is ignored, since the node has a matrix");
        }
        return {{m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}, {m[12], m[13], m[14]}};
    }
    const std::array<double, 3> t = pose.translation.value_or(node["translation"].numbers(std::array<double, 3>{})),
                                s = pose.scale.value_or(node["scale"].numbers(std::array<double, 3>{1, 1, 1}));
    std::array<double, 4> q = pose.rotation.value_or(node["rotation"].numbers(std::array<double, 4>{0, 0, 0, 1}));
    const double size = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    if (!(size > 0) || !std::isfinite(size)) node["rotation"].error("is not a rotation");
    for (double& x : q) x /= size > 0 ? size : 1;
    const Affined r = rotation(q);
    return {r.x * s[0], r.y * s[1], r.z * s[2], {t[0], t[1], t[2]}};
}

bool is_finite(const Affined& m) {
    return std::max({max_abs(m.x), max_abs(m.y), max_abs(m.z), max_abs(m.t)}) < static_cast<double>(kInfinity);
}

std::string name_of(const GltfValue& value) { return value["name"].is_text() ? value["name"].text() : ""; }

// The first of `count` that is called what is wanted, or the one with that number from 1; the first of all if nothing is wanted.
template <class IsCalled>
std::optional<std::size_t> choose(std::size_t count, const std::string& wanted, const IsCalled& is_called) {
    for (std::size_t i = 0; i < count; ++i) {
        if (wanted.empty() || is_called(i)) return i;
    }
    for (std::size_t i = 0; i < count; ++i) {
        if (wanted == fmt::format("{}", i + 1)) return i;
    }
    return std::nullopt;
}

class GltfLoader {
 public:
    GltfLoader(const GltfDocument& document, const ModelColors& colors, const ModelOptions& options)
        : document_(document), colors_(colors), options_(options) {}

    Model load() {
        find_variant();
        read_materials();
        match_emission_of_blender();
        for (std::uint32_t i = 0; i < root()["meshes"].size(); ++i) meshes_.push_back({.index = i});
        world_from_node_.resize(root()["nodes"].size());
        find_animation();
        poses_.resize(root()["nodes"].size());
        const bool is_played = options_.time || options_.shutter || !options_.animation.empty();
        if (is_played && model_.has_animation) {
            const double time = options_.time.value_or(0);
            const double opens = time + (options_.shutter ? (*options_.shutter)[0] : 0);
            poses_ = poses_at(document_, animation_, opens);
            if (options_.shutter) read_motion(opens, time + (*options_.shutter)[1]);
        }
        walk_nodes();
        choose_camera();
        for (Placement& p : placements_) pose(p);
        // Meshes in the order of the nodes that place them; those that several nodes place become objects.
        for (const Placement& p : placements_) ++meshes_[p.mesh].uses;
        for (const Placement& p : placements_) place(p);
        model_.has_idle_cameras = !model_.has_camera && root()["cameras"].size() > 0;
        model_.is_object = root()["cameras"].size() == 0;
        if (model_.has_idle_cameras)
            root()["cameras"].warn("no node of the scene has a camera; one that shows the whole model is added");
        if (model_.has_animation && !is_played)
            root()["animations"].warn(fmt::format(
                "animations are ignored: the model is in its rest pose; --time SECONDS shows a moment of the first, or of "
                "that which --animation names: {}",
                fmt::join(model_.animations, ", ")));
        if (model_.animations.size() > 1 && is_played && options_.animation.empty())
            root()["animations"].warn(fmt::format("the first is shown; --animation chooses another by number or name: {}",
                                                  fmt::join(model_.animations, ", ")));
        return std::move(model_);
    }

 private:
    struct Placement {
        std::uint32_t node, mesh;  // mesh: index into meshes_
        Affined world_from_node;
        std::optional<Affined> end{};  // that it becomes until the shutter closes
    };
    // /meshes/N in a pose. The first ones, in their order, have the weights of the mesh; then those of nodes with a pose of their
    // own.
    struct Mesh {
        std::uint32_t index;
        std::size_t uses = 0;
        bool is_read = false;
        GltfPose pose{};
        std::vector<GltfPrimitive> primitives{};
        std::uint32_t object = kNone;
    };

    GltfValue root() const { return document_.root(); }

    void read_motion(double opens, double closes) {
        last_poses_ = poses_at(document_, animation_, closes);
        for (const std::uint32_t node : uneven_nodes(document_, animation_, opens, closes))
            root()["nodes"][node].warn_of_kind(
                "uneven",
                "is blurred along a straight line and by less than half a turn while the shutter is open, but moves otherwise; a "
                "shorter --shutter comes nearer to that");
    }

    // Entry i is /materials/i, the last one the default material.
    void read_materials() {
        const GltfValue materials = root()["materials"];
        const std::vector<VertexColors> vertex_colors = find_vertex_colors();
        GltfTextures textures(document_, colors_, model_.scene.textures);
        struct Mixture {
            std::uint32_t material;
            MaterialDescription second;
            FloatInput share;
        };
        std::vector<Mixture> mixtures;
        for (std::size_t i = 0; i <= materials.size(); ++i) {
            GltfMaterial material = read_material(materials[i], vertex_colors[i], colors_, textures);
            Used used{.needs = std::move(material.needs), .alpha = material.alpha};
            if (material.emission) {
                used.area_light = static_cast<std::uint32_t>(model_.scene.area_lights.size());
                model_.scene.area_lights.push_back(std::move(*material.emission));
                model_.radiances.push_back(material.radiance);
            }
            if (material.inside) {
                used.inside = static_cast<std::uint32_t>(model_.scene.media.size());
                model_.scene.media.push_back(std::move(*material.inside));
            }
            model_.scene.materials.push_back(std::move(material.surface));
            if (material.second)
                mixtures.push_back({static_cast<std::uint32_t>(i), std::move(*material.second), material.second_share});
            used_.push_back(std::move(used));
        }
        model_.embedded = textures.take_embedded();
        // The two parts of a mixture follow all others.
        for (Mixture& mixture : mixtures) {
            std::vector<MaterialDescription>& all = model_.scene.materials;
            const auto first = static_cast<std::uint32_t>(all.size());
            MaterialDescription whole{.type = "mix",
                                      .name = all[mixture.material].name,
                                      .numbers = {{"amount", mixture.share}},
                                      .mixed = {first, first + 1}};
            all.push_back(std::exchange(all[mixture.material], std::move(whole)));
            all.push_back(std::move(mixture.second));
        }
    }
    // Blender writes lamps in lumens, 683 for each watt, and emission in watts.
    void match_emission_of_blender() {
        constexpr double kLumensPerWatt = 683;
        const GltfValue generator = root()["asset"]["generator"], lights = root().extension("KHR_lights_punctual")["lights"];
        const bool is_blender = generator.is_text() && generator.text().find("Blender I/O") != std::string::npos;
        if (!is_blender || lights.size() == 0) return;
        model_.sky_scale = kLumensPerWatt;
        if (model_.scene.area_lights.empty()) return;
        for (AreaLightDescription& light : model_.scene.area_lights) light.scale *= kLumensPerWatt;
        for (double& radiance : model_.radiances) radiance *= kLumensPerWatt;
        model_.notes.push_back(fmt::format(
            "was written by Blender, which writes lamps in lumens and emission in watts: emission is multiplied by {:.0f}",
            kLumensPerWatt));
    }
    void find_animation() {
        model_.animations = animation_names(document_);
        const GltfValue animations = root()["animations"];
        const auto is_called = [&](std::size_t i) { return name_of(animations[i]) == options_.animation; };
        const std::optional<std::size_t> chosen = choose(animations.size(), options_.animation, is_called);
        model_.has_animation = chosen.has_value();
        animation_ = chosen.value_or(0);
    }

    void find_variant() {
        const GltfValue variants = root().extension("KHR_materials_variants")["variants"];
        for (std::uint32_t i = 0; i < variants.size(); ++i) {
            model_.variants.push_back(variants[i]["name"].text());
            if (!variant_ && model_.variants.back() == options_.variant) variant_ = i;
        }
        model_.has_variant = variant_.has_value();
    }
    // Its own, or that of the variant.
    std::uint32_t material_of(const GltfValue& primitive) const {
        const GltfValue mappings = primitive.extension("KHR_materials_variants")["mappings"], materials = root()["materials"];
        for (std::size_t i = 0; variant_ && i < mappings.size(); ++i) {
            const GltfValue variants = mappings[i]["variants"];
            for (std::size_t k = 0; k < variants.size(); ++k) {
                if (variants[k].count(0) == *variant_) return mappings[i]["material"].index(materials).value_or(kNone);
            }
        }
        return primitive["material"].index(materials).value_or(kNone);
    }
    // For each material, the most colours that a primitive with it has. Primitives that have fewer are white there.
    std::vector<VertexColors> find_vertex_colors() const {
        const GltfValue meshes = root()["meshes"], materials = root()["materials"];
        std::vector<VertexColors> out(materials.size() + 1);
        for (std::size_t m = 0; m < meshes.size(); ++m) {
            for (std::size_t p = 0; p < meshes[m]["primitives"].size(); ++p) {
                const GltfValue primitive = meshes[m]["primitives"][p], color = primitive["attributes"]["COLOR_0"];
                if (!color.exists()) continue;
                const std::size_t material = std::min<std::size_t>(material_of(primitive), materials.size());
                out[material] =
                    std::max(out[material], components_of(document_, color) == 4 ? VertexColors::kRgba : VertexColors::kRgb);
            }
        }
        return out;
    }
    std::uint32_t index_of(std::uint32_t material) const {
        return material == kNone ? static_cast<std::uint32_t>(used_.size() - 1) : material;
    }

    // All nodes of the scene, parents first. Each has one parent at most, so none is reached twice.
    void walk_nodes() {
        const GltfValue nodes = root()["nodes"], scenes = root()["scenes"];
        struct Open {
            std::uint32_t node;
            Moving world_from_parent;
        };
        std::vector<Open> open;
        std::vector<bool> reached(nodes.size());
        const auto add = [&](const GltfValue& list, const Moving& world_from_parent) {
            for (std::size_t i = list.size(); i-- > 0;) {
                const std::optional<std::uint32_t> node = list[i].index(nodes);
                if (!node) continue;
                if (reached[*node]) {
                    list[i].error(fmt::format("node {} is reached twice; nodes must form a tree", *node));
                } else {
                    reached[*node] = true;
                    open.push_back({*node, world_from_parent});
                }
            }
        };
        if (scenes.size() > 0) {
            add(scenes[root()["scene"].index(scenes).value_or(0)]["nodes"], {});
        } else {
            if (nodes.size() == 0) return scenes.error("there is no scene");
            scenes.note("there is no scene; all nodes are shown");
            for (std::size_t i = 0; i < nodes.size(); ++i) {
                const GltfValue children = nodes[i]["children"];
                for (std::size_t j = 0; j < children.size(); ++j) {
                    if (const std::optional<std::uint32_t> child = children[j].index(nodes)) reached[*child] = true;
                }
            }
            for (std::size_t i = nodes.size(); i-- > 0;) {
                if (!reached[i]) open.push_back({static_cast<std::uint32_t>(i), {}});
            }
            reached.flip();  // the roots are, their children are not
        }
        while (!open.empty()) {
            const Open next = open.back();
            open.pop_back();
            const GltfValue node = nodes[next.node];
            const Affined m = next.world_from_parent.start * local_transform(node, poses_[next.node]);
            const Affined end =
                last_poses_.empty() ? m : next.world_from_parent.end * local_transform(node, last_poses_[next.node]);
            if (!is_finite(m) || !is_finite(end)) {
                node.error("its transformation exceeds the range of single precision");
                continue;
            }
            world_from_node_[next.node] = m;
            visit(node, next.node, {m, end});
            add(node["children"], {m, end});
        }
        if (root()["skins"].size() > 0) place_idle_nodes();
    }
    // Joints need not be in the scene.
    void place_idle_nodes() {
        const GltfValue nodes = root()["nodes"];
        std::vector<std::vector<std::uint32_t>> children(nodes.size());
        std::vector<bool> has_parent(nodes.size());
        for (std::uint32_t n = 0; n < nodes.size(); ++n) {
            if (world_from_node_[n]) continue;
            const GltfValue list = nodes[n]["children"];
            for (std::size_t i = 0; i < list.size(); ++i) {
                const std::optional<std::uint32_t> child = list[i].index(nodes);
                if (!child || world_from_node_[*child] || has_parent[*child]) continue;
                has_parent[*child] = true;
                children[n].push_back(*child);
            }
        }
        std::vector<std::uint32_t> open;
        const auto place = [&](std::uint32_t node, const Affined& world_from_parent) {
            const Affined m = world_from_parent * local_transform(nodes[node], poses_[node]);
            if (!is_finite(m)) return;
            world_from_node_[node] = m;
            open.push_back(node);
        };
        for (std::uint32_t n = 0; n < nodes.size(); ++n)
            if (!world_from_node_[n] && !has_parent[n]) place(n, {});
        while (!open.empty()) {
            const std::uint32_t parent = open.back();
            open.pop_back();
            for (const std::uint32_t child : children[parent]) place(child, *world_from_node_[parent]);
        }
    }

    // Where a node is when the shutter opens, and when it closes.
    struct Moving {
        Affined start{}, end{};

        bool moves() const { return !(start == end); }
        Moving operator*(const Affined& inner) const { return {start * inner, end * inner}; }
    };

    void visit(const GltfValue& node, std::uint32_t index, const Moving& moving) {
        const Affined& m = moving.start;
        const GltfValue light = node.extension("KHR_lights_punctual")["light"];
        const bool is_singular = !m.inverse();
        const bool has_mesh = node["mesh"].exists() && !node["skin"].exists();  // a skin is placed by its joints
        if (is_singular && (has_mesh || node["camera"].exists() || light.exists()))
            return node.warn("has a scale of 0, and is left out");
        if (const auto mesh = node["mesh"].index(root()["meshes"])) {
            if (const GltfValue instancing = node.extension("EXT_mesh_gpu_instancing"); instancing.exists()) {
                for (const Affined& instance : instances_of(instancing["attributes"])) {
                    if ((m * instance).inverse()) place_mesh(node, index, *mesh, moving * instance);
                }
            } else {
                place_mesh(node, index, *mesh, moving);
            }
        }
        if (const auto camera = node["camera"].index(root()["cameras"]))
            cameras_.push_back({node, root()["cameras"][*camera], moving});
        const GltfValue lights = root().extension("KHR_lights_punctual")["lights"];
        if (const auto i = light.index(lights)) {
            if (moving.moves()) still(node, "a light");
            model_.scene.lights.push_back(read_light(lights[*i], m, colors_));
        }
    }
    // What motion blur cannot show is where the shutter opens.
    static void still(const GltfValue& node, const std::string& what) {
        node.warn_of_kind("still " + what, what + " does not move while the shutter is open");
    }
    void place_mesh(const GltfValue& node, std::uint32_t index, std::uint32_t mesh, const Moving& moving) {
        Placement placed{index, mesh, moving.start};
        if (moving.moves()) placed.end = moving.end;
        if (placed.end && (!placed.end->inverse() || placed.end->swaps_handedness() != placed.world_from_node.swaps_handedness())) {
            still(node, "what is mirrored, or shrinks to nothing,");
            placed.end.reset();
        }
        placements_.push_back(placed);
    }

    // Each from the space of the mesh to that of the node.
    std::vector<Affined> instances_of(const GltfValue& attributes) const {
        std::vector<Affined> out;
        std::optional<std::size_t> count;
        const auto read = [&](const char* name, std::size_t components) -> std::vector<float> {
            if (!attributes[name].exists()) return {};
            std::optional<std::vector<float>> x = read_floats(document_, attributes[name], components);
            if (!x) return {};
            const std::size_t items = x->size() / components;
            if (count && *count != items) {
                attributes[name].error(fmt::format("has {} items, and others have {}", items, *count));
                return {};
            }
            count = items;
            return std::move(*x);
        };
        const std::vector<float> t = read("TRANSLATION", 3), r = read("ROTATION", 4), s = read("SCALE", 3);
        for (std::size_t i = 0; i < count.value_or(0); ++i) {
            Affined m;
            if (const float* q = r.empty() ? nullptr : &r[4 * i]; q != nullptr) {
                const double size =
                    std::sqrt(double{q[0]} * q[0] + double{q[1]} * q[1] + double{q[2]} * q[2] + double{q[3]} * q[3]);
                if (size > 0) m = rotation({q[0] / size, q[1] / size, q[2] / size, q[3] / size});
            }
            if (!s.empty()) m = {m.x * double{s[3 * i]}, m.y * double{s[3 * i + 1]}, m.z * double{s[3 * i + 2]}, {}};
            if (!t.empty()) m.t = {t[3 * i], t[3 * i + 1], t[3 * i + 2]};
            out.push_back(m);
        }
        return out;
    }

    // By its name or its node's, else by its number in the scene, from 1.
    void choose_camera() {
        for (std::size_t i = 0; i < cameras_.size(); ++i) {
            const std::string of_node = name_of(cameras_[i].node), of_camera = name_of(cameras_[i].camera);
            model_.cameras.push_back(fmt::format("{} {}", i + 1, of_node.empty() ? of_camera : of_node));
            if (of_camera.empty() && of_node.empty()) model_.cameras.back().pop_back();
        }
        const auto is_called = [&](std::size_t i) {
            return name_of(cameras_[i].node) == options_.camera || name_of(cameras_[i].camera) == options_.camera;
        };
        const std::optional<std::size_t> chosen = choose(cameras_.size(), options_.camera, is_called);
        if (cameras_.size() > 1 && options_.camera.empty())
            root()["cameras"].note(
                fmt::format("the first is used; --camera chooses another by number or name: {}", fmt::join(model_.cameras, ", ")));
        if (chosen) read_moving_camera(cameras_[*chosen].camera, cameras_[*chosen].moving);
    }
    void read_moving_camera(const GltfValue& camera, const Moving& moving) {
        if (moving.moves()) {
            read_camera(camera, moving.end, model_.scene);
            const Affined end = model_.scene.camera.world_from_camera;
            read_camera(camera, moving.start, model_.scene);
            model_.scene.camera.end = end;
        } else {
            read_camera(camera, moving.start, model_.scene);
        }
        model_.has_camera = true;
    }

    // A node with a skin, or with weights, has a mesh of its own. What a skin holds is placed by its joints alone.
    void pose(Placement& p) {
        const GltfValue node = root()["nodes"][p.node];
        const std::optional<std::uint32_t> skin = node["skin"].index(root()["skins"]);
        const std::optional<std::vector<double>>& moved = poses_[p.node].weights;
        if (!last_poses_.empty() && last_poses_[p.node].weights != moved) still(node, "a mesh that changes its shape");
        if (skin && !last_poses_.empty()) still(node, "a mesh that joints bend");
        if (!skin && !moved && !node["weights"].is_array()) return;
        Mesh mesh{.index = p.mesh, .pose = {.weights = moved ? *moved : numbers(node["weights"])}};
        if (!moved && !node["weights"].is_array()) mesh.pose.weights = numbers(root()["meshes"][p.mesh]["weights"]);
        if (skin) {
            mesh.pose.joints = joints_of(root()["skins"][*skin]);
            p.world_from_node = {};
            p.end.reset();
        }
        p.mesh = static_cast<std::uint32_t>(meshes_.size());
        meshes_.push_back(std::move(mesh));
    }
    static std::vector<double> numbers(const GltfValue& list) {
        std::vector<double> out;
        for (std::size_t i = 0; i < list.size(); ++i) out.push_back(list[i].number(0, -1e6, 1e6));
        return out;
    }
    // Each from the space of the mesh, in the pose that it is bound to, to the world.
    std::vector<Affined> joints_of(const GltfValue& skin) const {
        const GltfValue joints = skin["joints"], inverse = skin["inverseBindMatrices"];
        std::optional<std::vector<float>> bind;
        if (inverse.exists()) bind = read_floats(document_, inverse, 16);
        if (bind && bind->size() < 16 * joints.size())
            inverse.error(fmt::format("has {} items for {} joints", bind->size() / 16, joints.size()));
        std::vector<Affined> out;
        for (std::size_t i = 0; i < joints.size(); ++i) {
            const std::optional<std::uint32_t> node = joints[i].index(root()["nodes"]);
            if (!node) continue;
            if (!world_from_node_[*node]) joints[i].warn_of_kind("joint", "is in no tree of nodes, and stays where it was bound");
            Affined m;
            if (bind && bind->size() >= 16 * (i + 1)) {
                const float* x = &(*bind)[16 * i];
                m = {{x[0], x[1], x[2]}, {x[4], x[5], x[6]}, {x[8], x[9], x[10]}, {x[12], x[13], x[14]}};
            }
            out.push_back(world_from_node_[*node] ? *world_from_node_[*node] * m : Affined());
        }
        return out;
    }

    void place(const Placement& p) {
        Mesh& mesh = meshes_[p.mesh];
        if (!mesh.is_read) read(mesh);
        const bool once = mesh.uses == 1 && !p.end;  // what moves is an object
        bool has_object = false;
        for (GltfPrimitive& primitive : mesh.primitives) {
            // Lights cannot be in objects.
            const bool emits = used_[index_of(primitive.material)].area_light != kNone;
            if (once || emits) {
                if (!once && !count(primitive, root()["nodes"][p.node])) return;
                if (p.end) still(root()["nodes"][p.node], "a surface that emits");
                LoadedShape shape = shape_of(primitive.material, once ? std::move(primitive.mesh) : LoadedMesh(primitive.mesh));
                transform(shape, p.world_from_node);
                if (!is_finite(shape)) root()["nodes"][p.node].error("its mesh exceeds the range of single precision");
                model_.shapes.push_back(std::move(shape));
            } else {
                has_object = true;
            }
        }
        if (!has_object) return;
        for (const Affined& map : {p.world_from_node, p.end.value_or(p.world_from_node)}) {
            const Affined inverse = map.inverse().value();
            if (std::max({max_abs(inverse.x), max_abs(inverse.y), max_abs(inverse.z)}) > 1e15)
                root()["nodes"][p.node].error("is too small to be traced in single precision");
        }
        if (mesh.object == kNone) {
            mesh.object = static_cast<std::uint32_t>(model_.objects.size());
            model_.scene.objects.emplace_back();
            std::vector<LoadedShape>& shapes = model_.objects.emplace_back();
            for (const GltfPrimitive& primitive : mesh.primitives) {
                if (used_[index_of(primitive.material)].area_light != kNone) continue;
                shapes.push_back(shape_of(primitive.material, LoadedMesh(primitive.mesh)));
                transform(shapes.back(), {});
            }
        }
        model_.scene.instances.push_back({.object = mesh.object, .world_from_object = p.world_from_node, .end = p.end});
    }

    void read(Mesh& mesh) {
        mesh.is_read = true;
        const GltfValue value = root()["meshes"][mesh.index];
        if (mesh.pose.weights.empty()) mesh.pose.weights = numbers(value["weights"]);
        mesh.primitives =
            read_mesh(document_, value, mesh.pose,
                      {[this](const GltfValue& primitive) { return material_of(primitive); },
                       [this](std::uint32_t material) -> const VertexNeeds& { return used_[index_of(material)].needs; }});
        for (const GltfPrimitive& primitive : mesh.primitives) {
            if (!count(primitive, value)) return mesh.primitives.clear();
        }
    }
    // False, with one error, when all that was counted is too much.
    bool count(const GltfPrimitive& primitive, const GltfValue& value) {
        if (vertices_ > kMaxVertices) return false;
        vertices_ += primitive.mesh.positions.size();
        if (vertices_ > kMaxVertices) value.error(fmt::format("with this, the scene has more than {} vertices", kMaxVertices));
        return vertices_ <= kMaxVertices;
    }

    LoadedShape shape_of(std::uint32_t material, LoadedMesh mesh) const {
        const Used& used = used_[index_of(material)];
        LoadedShape out;
        out.shape.material = index_of(material);
        out.shape.area_light = used.area_light;
        out.shape.alpha = used.alpha;
        out.shape.inside_medium = used.inside;
        out.mesh = std::move(mesh);
        return out;
    }

    static void transform(LoadedShape& loaded, const Affined& m) {
        loaded.shape.flip_normal = m.swaps_handedness();
        for (Vec3d& p : loaded.mesh->positions) p = m.point(p);
        for (std::vector<Vec3f>* along : {&loaded.mesh->tangents, &loaded.mesh->bitangents}) {
            for (Vec3f& v : *along) v = Vec3f(m.vector(Vec3d(v)));
        }
        for (Vec3f& n : loaded.mesh->normals) {
            const Vec3d world = m.normal(Vec3d(n));
            const double size = length(world);
            n = size > 0 ? Vec3f(world / size) : Vec3f{};
        }
    }
    static bool is_finite(const LoadedShape& loaded) {
        return std::ranges::all_of(loaded.mesh->positions, [](const Vec3d& p) { return max_abs(Vec3f(p)) < kInfinity; });
    }
    static bool is_finite(const Affined& m) { return render::is_finite(m); }

    // What shapes of a material carry.
    struct Used {
        std::uint32_t area_light = kNone, inside = kNone;
        VertexNeeds needs{};
        FloatInput alpha = 1;
    };

    struct PlacedCamera {
        GltfValue node, camera;
        Moving moving;
    };

    const GltfDocument& document_;
    const ModelColors& colors_;
    const ModelOptions& options_;
    std::optional<std::uint32_t> variant_{};  // an index
    Model model_;
    std::vector<Used> used_;
    std::vector<Mesh> meshes_;
    std::size_t animation_ = 0;                            // the one that is shown
    std::vector<GltfNodePose> poses_;                      // each node's, at the moment that is shown, or the shutter opens
    std::vector<GltfNodePose> last_poses_;                 // where it closes; empty: it shows a moment
    std::vector<std::optional<Affined>> world_from_node_;  // for nodes in trees
    std::vector<Placement> placements_;
    std::vector<PlacedCamera> cameras_;  // those of the scene
    std::uint64_t vertices_ = 0;
};

}  // namespace

Result<Model> read_gltf(const std::string& bytes, const std::string& name, SceneFiles& files, const ModelColors& colors,
                        const ModelOptions& options, Diagnostics& diagnostics) {
    const Result<GltfDocument> document = GltfDocument::read(bytes, name, files, diagnostics);
    if (!document) return document.error();
    if (!document->is_sound()) return Model{};
    return GltfLoader(*document, colors, options).load();
}

}  // namespace latent::render
