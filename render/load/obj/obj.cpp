#include "render/load/obj/obj.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <map>
#include <span>
#include <unordered_map>

#include "base/size.h"
#include "render/load/obj/mtl.h"
#include "render/load/obj/polygon.h"
#include "render/load/obj/statements.h"

namespace latent::render {

namespace {

constexpr std::size_t kMostErrors = 20;     // of one file: after these it is given up
constexpr std::size_t kMostCorners = 1000;  // of a face

// Of a corner of a face, from 0; kNone where it has none.
struct Corner {
    std::uint32_t v = kNone, vt = kNone, vn = kNone;
    bool operator==(const Corner&) const = default;
};
struct CornerHash {
    std::size_t operator()(const Corner& c) const {
        return (c.v * 0x9E3779B97F4A7C15u ^ c.vt * 0xC2B2AE3D27D4EB4Fu) * 0x165667B19E3779F9u ^ c.vn * 0x85EBCA77C2B2AE63u;
    }
};

// Faces of one material whose corners all have the same attributes become one mesh.
struct PartKey {
    std::uint32_t material;
    bool has_uvs, has_normals;
    auto operator<=>(const PartKey&) const = default;
};
struct PartMesh {
    LoadedMesh mesh{};
    std::unordered_map<Corner, std::uint32_t, CornerHash> vertices{};
};

class ObjReader {
 public:
    ObjReader(std::string_view text, const std::string& name, SceneFiles& files, const ModelColors& colors,
              Diagnostics& diagnostics)
        : statements_(text, name, diagnostics), files_(files), colors_(colors), diagnostics_(diagnostics) {
        model_.scene.materials.push_back(
            {.spectra = {{"reflectance", color::Spectrum::constant(0.5)}}});  // of faces before any usemtl
        carried_.emplace_back();
    }

    Model read() {
        const std::size_t before = diagnostics_.errors().size();
        while (statements_.next() && diagnostics_.errors().size() < before + kMostErrors) read_statement();
        for (const auto& [what, count] : ignored_)
            diagnostics_.warn(statements_.place(),
                              fmt::format("{} \"{}\" {} ignored", counted(count, "statement"), what, count == 1 ? "was" : "were"));
        for (const PartKey& part : order_) {
            LoadedShape shape;
            shape.shape.material = part.material;
            shape.shape.area_light = carried_[part.material].area_light;
            shape.shape.alpha = carried_[part.material].alpha;
            shape.mesh = std::move(parts_[part].mesh);
            model_.shapes.push_back(std::move(shape));
        }
        return std::move(model_);
    }

 private:
    void read_statement() {
        const std::string_view key = statements_.keyword();
        if (key == "v") {
            if (statements_.has_numbers(3))
                positions_.emplace_back(statements_.number(1), statements_.number(2), statements_.number(3));
        } else if (key == "vn") {
            if (statements_.has_numbers(3)) add_normal({statements_.number(1), statements_.number(2), statements_.number(3)});
        } else if (key == "vt") {
            const float v = statements_.words().size() > 2 ? static_cast<float>(statements_.number(2)) : 0;
            if (statements_.has_numbers(1)) uvs_.push_back({static_cast<float>(statements_.number(1)), v});
        } else if (key == "f" || key == "fo") {
            read_face();
        } else if (key == "usemtl") {
            use_material(statements_.rest());
        } else if (key == "mtllib") {
            read_libraries();
        } else if (key != "o" && key != "g" && key != "s" && key != "mg") {
            ++ignored_[std::string(key.substr(0, 40))];
        }
    }

    void add_normal(const Vec3d& n) {
        const double size = length(n);
        normals_.push_back(size > 0 ? Vec3f(n / size) : Vec3f{});
    }

    bool is_there(std::string_view name) const {
        std::error_code unknown;
        return std::filesystem::exists(files_.resolve(std::string(name)), unknown);
    }

    // The files of a statement: one whose name may have spaces, or else several.
    std::vector<std::string> libraries() const {
        const std::span<const std::string_view> names = std::span(statements_.words()).subspan(1);
        if (is_there(statements_.rest()) || !std::ranges::any_of(names, [&](std::string_view name) { return is_there(name); }))
            return {statements_.rest()};
        return {names.begin(), names.end()};
    }

    // The first file that defines a material counts.
    void read_libraries() {
        MtlMaterials read;
        for (const std::string& name : libraries()) {
            const Result<std::string> text = files_.include(files_.resolve(name));
            if (text) {
                MtlMaterials more;
                read_mtl(*text, files_.resolve(name).string(), files_, colors_, diagnostics_, more, model_.scene.textures);
                read.merge(more);
            } else {
                statements_.error(text.error().message);
                is_complete_ = false;
            }
        }
        for (auto& [name, material] : read) materials_.insert_or_assign(name, std::move(material));
    }

    void use_material(const std::string& name) {
        const auto known = used_.find(name);
        if (known != used_.end()) {
            material_ = known->second;
            return;
        }
        const auto found = materials_.find(name);
        if (found == materials_.end()) {
            if (is_complete_) statements_.error(fmt::format("usemtl: material \"{}\" is not defined", name));
            return;
        }
        material_ = static_cast<std::uint32_t>(model_.scene.materials.size());
        used_[name] = material_;
        model_.scene.materials.push_back(found->second.surface);
        carried_.push_back({.alpha = found->second.alpha});
        if (!found->second.emission) return;
        carried_.back().area_light = static_cast<std::uint32_t>(model_.scene.area_lights.size());
        model_.scene.area_lights.push_back(*found->second.emission);
        model_.radiances.push_back(found->second.radiance);
    }

    // "3", "-1" the last one so far; from 0.
    std::uint32_t index(std::string_view word, std::size_t count, std::string_view what) {
        std::int64_t i = 0;
        const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), i);
        if (fault != std::errc{} || end != word.data() + word.size()) {
            statements_.error(fmt::format("f: \"{}\" is not an index", std::string(word.substr(0, 40))));
            return kNone;
        }
        const std::int64_t at = i < 0 ? static_cast<std::int64_t>(count) + i : i - 1;
        if (at >= 0 && static_cast<std::uint64_t>(at) < std::min<std::size_t>(count, kNone)) return static_cast<std::uint32_t>(at);
        statements_.error(fmt::format("f: {} {} is out of range; there are {} so far", what, i, count));
        return kNone;
    }

    // v, v/vt, v//vn or v/vt/vn. False: an error.
    bool corner(std::string_view word, Corner& out) {
        const std::size_t slash = word.find('/'), second = slash == word.npos ? slash : word.find('/', slash + 1);
        out.v = index(word.substr(0, slash), positions_.size(), "vertex");
        if (out.v == kNone) return false;
        if (slash == word.npos) return true;
        const std::string_view vt = word.substr(slash + 1, second == word.npos ? word.npos : second - slash - 1);
        if (!vt.empty() && (out.vt = index(vt, uvs_.size(), "texture vertex")) == kNone) return false;
        if (second == word.npos) return true;
        return (out.vn = index(word.substr(second + 1), normals_.size(), "normal")) != kNone;
    }

    void read_face() {
        const auto& words = statements_.words();
        if (words.size() < 4) return statements_.error("f: must have at least 3 corners");
        if (words.size() > kMostCorners + 1)
            return statements_.error(
                fmt::format("f: has more than {} corners; divide it into triangles when you export it", kMostCorners));
        face_.clear();
        places_.clear();
        PartKey part{material_, true, true};
        for (std::size_t i = 1; i < words.size(); ++i) {
            Corner c;
            if (!corner(words[i], c)) return;
            part.has_uvs &= c.vt != kNone;
            part.has_normals &= c.vn != kNone;
            face_.push_back(c);
            places_.push_back(positions_[c.v]);
        }
        corners_.clear();
        if (face_.size() == 3) {
            corners_ = {0, 1, 2};
        } else {
            triangulate(places_, corners_);
        }
        if (current_part_ != part) {
            const auto [entry, is_new] = parts_.try_emplace(part);
            if (is_new) order_.push_back(part);
            current_ = &entry->second;
            current_part_ = part;
        }
        for (const std::uint32_t i : corners_) current_->mesh.indices.push_back(vertex(part, face_[i]));
    }

    // Its number in the part's mesh.
    std::uint32_t vertex(const PartKey& part, Corner c) {
        if (!part.has_uvs) c.vt = kNone;
        if (!part.has_normals) c.vn = kNone;
        LoadedMesh& mesh = current_->mesh;
        const auto [known, is_new] = current_->vertices.try_emplace(c, static_cast<std::uint32_t>(mesh.positions.size()));
        if (is_new) {
            mesh.positions.push_back(positions_[c.v]);
            if (part.has_uvs) mesh.uvs.push_back(uvs_[c.vt]);
            if (part.has_normals) mesh.normals.push_back(normals_[c.vn]);
        }
        return known->second;
    }

    Statements statements_;
    SceneFiles& files_;
    const ModelColors& colors_;
    Diagnostics& diagnostics_;
    Model model_;
    std::vector<Vec3d> positions_;
    std::vector<Vec3f> normals_;
    std::vector<Vec2f> uvs_;
    MtlMaterials materials_;
    std::map<std::string, std::uint32_t> used_;  // to the model's materials
    struct Carried {
        std::uint32_t area_light = kNone;
        FloatInput alpha = 1;
    };
    std::vector<Carried> carried_;  // of each of these, by its shapes
    std::uint32_t material_ = 0;
    std::map<PartKey, PartMesh> parts_;
    std::vector<PartKey> order_;  // as they were met
    PartMesh* current_ = nullptr;
    std::optional<PartKey> current_part_;
    std::map<std::string, std::uint64_t> ignored_;
    std::vector<Corner> face_;
    std::vector<Vec3d> places_;
    std::vector<std::uint32_t> corners_;
    bool is_complete_ = true;  // every mtllib was found
};

}  // namespace

Model read_obj(std::string_view text, const std::string& name, SceneFiles& files, const ModelColors& colors,
               Diagnostics& diagnostics) {
    return ObjReader(text, name, files, colors, diagnostics).read();
}

}  // namespace latent::render
