#include "render/load/obj/obj.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>
#include <span>
#include <unordered_map>

#include "base/size.h"
#include "render/load/files/unread.h"
#include "render/load/model/values.h"
#include "render/load/obj/mtl.h"
#include "render/load/obj/polygon.h"
#include "render/load/obj/statements.h"

namespace latent::render {

namespace {

constexpr std::size_t kMaxErrors = 20;  // after these a file is given up

// What "v", "vt" and "vn" say, in the whole file.
struct Vertices {
    std::vector<Vec3d> positions{};
    std::vector<std::array<float, 4>> colors{};  // linear, one for each position, or empty
    std::vector<Vec2f> uvs{};
    std::vector<Vec3f> normals{};
};

// Indices of a corner of a face, from 0; kNone where it has none.
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
    std::uint32_t smooth;  // the smoothing group of faces without normals; 0: they are flat
    auto operator<=>(const PartKey&) const = default;
};
struct PartMesh {
    LoadedMesh mesh{};
    std::vector<std::uint32_t> v{};  // which position each vertex of the mesh has
    std::unordered_map<Corner, std::uint32_t, CornerHash> vertices{};
};

float linear_of_srgb(double x) {
    x = std::clamp(x, 0.0, 1.0);
    return static_cast<float>(x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4));
}

// All vertices first, since faces may refer to those that follow.
Vertices read_vertices(std::string_view text, const std::string& name, Diagnostics& diagnostics) {
    Vertices out;
    Statements s(text, name, diagnostics);
    const std::size_t before = diagnostics.errors().size();
    std::vector<std::array<double, 3>> colors;
    double brightest = 0;
    while (s.next() && diagnostics.errors().size() < before + kMaxErrors) {
        const std::string_view key = s.keyword();
        const std::size_t numbers = s.words().size() - 1;
        if (key == "v" && s.has_numbers(3)) {
            out.positions.emplace_back(s.number(1), s.number(2), s.number(3));
            if (numbers < 6) continue;  // a fourth number is a weight of curves
            const std::size_t first = numbers == 7 ? 5 : 4;
            colors.resize(out.positions.size(), {1, 1, 1});
            for (std::size_t c = 0; c < 3; ++c) {
                colors.back()[c] = s.number_or_zero(first + c);
                brightest = std::max(brightest, colors.back()[c]);
            }
        } else if (key == "vn" && s.has_numbers(3)) {
            const Vec3d n(s.number(1), s.number(2), s.number(3));
            const double size = length(n);
            out.normals.push_back(size > 0 ? Vec3f(n / size) : Vec3f{});
        } else if (key == "vt" && s.has_numbers(1)) {
            out.uvs.push_back({static_cast<float>(s.number(1)), numbers > 1 ? static_cast<float>(s.number(2)) : 0});
        }
    }
    if (colors.empty()) return out;
    colors.resize(out.positions.size(), {1, 1, 1});
    const double unit = brightest > 1 ? 255 : 1;
    for (const std::array<double, 3>& c : colors)
        out.colors.push_back({linear_of_srgb(c[0] / unit), linear_of_srgb(c[1] / unit), linear_of_srgb(c[2] / unit), 1});
    return out;
}

class ObjReader {
 public:
    ObjReader(std::string_view text, const std::string& name, SceneFiles& files, const ModelColors& colors,
              Diagnostics& diagnostics)
        : statements_(text, name, diagnostics),
          diagnostics_(diagnostics),
          all_(read_vertices(text, name, diagnostics)),
          mtl_{files, colors, diagnostics, model_.scene.textures, !all_.colors.empty()} {
        // The material of faces whose own is missing: colours of vertices if there are any, or grey.
        const double grey = all_.colors.empty() ? 0.5 : 1;
        model_.scene.materials.push_back({});
        model_.scene.materials[0].spectra["reflectance"] =
            ModelValues(colors, model_.scene.textures).color(std::nullopt, {grey, grey, grey}, !all_.colors.empty());
        carried_.emplace_back();
    }

    Model read() {
        const std::size_t before = diagnostics_.errors().size();
        if (before > 0) return {};  // errors in vertices
        while (statements_.next() && diagnostics_.errors().size() < before + kMaxErrors) read_statement();
        for (const auto& [what, count] : ignored_) tell_of_ignored(what, count);
        for (const PartKey& key : order_) {
            PartMesh& part = parts_[key];
            LoadedShape shape;
            shape.shape.material = key.material;
            shape.shape.area_light = carried_[key.material].area_light;
            shape.shape.alpha = carried_[key.material].alpha;
            for (std::size_t i = 0; key.smooth != 0 && i < part.v.size(); ++i) {
                const Vec3d& n = smooth_normals_[smooth_key(key.smooth, part.v[i])];
                part.mesh.normals.push_back(length(n) > 0 ? Vec3f(normalize(n)) : Vec3f{});
            }
            shape.mesh = std::move(part.mesh);
            model_.shapes.push_back(std::move(shape));
        }
        return std::move(model_);
    }

 private:
    void read_statement() {
        const std::string_view key = statements_.keyword();
        if (key == "v") {
            ++positions_;
        } else if (key == "vn") {
            ++normals_;
        } else if (key == "vt") {
            ++uvs_;
        } else if (key == "f" || key == "fo") {
            read_face();
        } else if (key == "usemtl") {
            use_material(statements_.rest());
        } else if (key == "mtllib") {
            read_libraries();
        } else if (key == "s") {
            read_smoothing_group();
        } else if (key != "o" && key != "g" && key != "mg") {
            ++ignored_[std::string(key.substr(0, 40))];
        }
    }

    void tell_of_ignored(const std::string& what, std::uint64_t count) {
        static constexpr UnreadFeatures kUnknown{SceneLanguage::kObj, "statements", "", "it is unknown"};
        const UnreadFeatures* const unread = find_unread(SceneLanguage::kObj, "statements", what);
        const std::string message =
            fmt::format("{} \"{}\" {} ignored", counted(count, "statement"), what, count == 1 ? "was" : "were");
        statements_.say_of_unread("statement " + what, message, unread != nullptr ? *unread : kUnknown);
    }

    // "s 1", "s on", "s off".
    void read_smoothing_group() {
        const std::string_view word = statements_.words().size() > 1 ? statements_.words()[1] : std::string_view("off");
        smooth_ = word == "on" ? 1 : 0;
        std::from_chars(word.data(), word.data() + word.size(), smooth_);
    }

    bool is_there(std::string_view name) const {
        std::error_code unknown;
        return std::filesystem::exists(mtl_.files.resolve(std::string(name)), unknown);
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
            const Result<std::string> text = mtl_.files.include(mtl_.files.resolve(name));
            MtlMaterials more;
            if (!text && text.error().code == ErrorCode::kOutOfRange) {
                statements_.error(text.error().message);  // so would be the rest
                break;
            }
            if (!text) {
                statements_.warn(fmt::format("mtllib: {}; its materials are grey", text.error().message));
                is_complete_ = false;
            } else if (!read_mtl(*text, name, mtl_, more)) {
                statements_.warn(fmt::format("mtllib: {}: {}; its materials are grey", name,
                                             is_utf16(*text)         ? kUtf16
                                             : is_lfs_pointer(*text) ? kLfsPointer
                                                                     : "is not an MTL file"));
                is_complete_ = false;
            }
            read.merge(more);
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
            if (is_complete_ && !name.empty())
                statements_.warn_of_kind("usemtl", fmt::format("usemtl: material \"{}\" is not defined; it is grey", name));
            material_ = 0;
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

    // "3", "-1" the last one so far; from 0. Nothing, with an error, if it is no number.
    std::optional<std::int64_t> index(std::string_view word, std::size_t so_far) {
        std::int64_t i = 0;
        const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), i);
        if (fault == std::errc{} && end == word.data() + word.size()) return i < 0 ? static_cast<std::int64_t>(so_far) + i : i - 1;
        statements_.error(fmt::format("f: \"{}\" is not an index", std::string(word.substr(0, 40))));
        return std::nullopt;
    }
    static bool is_within(std::int64_t i, std::size_t count) {
        return i >= 0 && static_cast<std::uint64_t>(i) < std::min<std::size_t>(count, kNone);
    }
    // The same of what a face can do without, with a warning.
    bool optional_index(std::string_view word, std::size_t so_far, std::size_t count, std::string_view what, std::uint32_t& out) {
        if (word.empty()) return true;
        const std::optional<std::int64_t> i = index(word, so_far);
        if (!i) return false;
        if (is_within(*i, count)) {
            out = static_cast<std::uint32_t>(*i);
        } else {
            statements_.warn_of_kind(std::string(what), fmt::format("f: {} {} is not there; the face is without", what,
                                                                    std::string(word.substr(0, 40))));
        }
        return true;
    }

    // v, v/vt, v//vn or v/vt/vn; a slash may follow the last. False: an error.
    bool corner(std::string_view word, Corner& out) {
        const std::size_t slash = word.find('/'), second = slash == word.npos ? slash : word.find('/', slash + 1);
        const std::optional<std::int64_t> v = index(word.substr(0, slash), positions_);
        if (!v) return false;
        if (!is_within(*v, all_.positions.size())) {
            statements_.error(fmt::format("f: vertex {} is out of range; there are {}",
                                          std::string(word.substr(0, slash).substr(0, 40)), all_.positions.size()));
            return false;
        }
        out.v = static_cast<std::uint32_t>(*v);
        if (slash == word.npos) return true;
        const std::string_view vt = word.substr(slash + 1, second == word.npos ? word.npos : second - slash - 1);
        if (!optional_index(vt, uvs_, all_.uvs.size(), "texture vertex", out.vt)) return false;
        return second == word.npos || optional_index(word.substr(second + 1), normals_, all_.normals.size(), "normal", out.vn);
    }

    void read_face() {
        const auto& words = statements_.words();
        if (words.size() < 4) return statements_.warn_of_kind("short", "f: has fewer than 3 corners, and is ignored");
        face_.clear();
        places_.clear();
        PartKey part{material_, true, true, 0};
        for (std::size_t i = 1; i < words.size(); ++i) {
            Corner c;
            if (!corner(words[i], c)) return;
            part.has_uvs &= c.vt != kNone;
            part.has_normals &= c.vn != kNone;
            face_.push_back(c);
            places_.push_back(all_.positions[c.v]);
        }
        corners_.clear();
        if (face_.size() == 3) {
            corners_ = {0, 1, 2};
        } else if (!triangulate(places_, corners_)) {
            return statements_.error(fmt::format("f: has {} corners; divide it into triangles when you export it", face_.size()));
        }
        if (!part.has_normals && smooth_ != 0) {
            part.smooth = smooth_;
            for (std::size_t i = 0; i < corners_.size(); i += 3) add_smooth_normal(&corners_[i]);
        }
        if (current_part_ != part) {
            const auto [entry, is_new] = parts_.try_emplace(part);
            if (is_new) order_.push_back(part);
            current_ = &entry->second;
            current_part_ = part;
        }
        for (const std::uint32_t i : corners_) current_->mesh.indices.push_back(vertex(part, face_[i]));
    }

    static std::uint64_t smooth_key(std::uint32_t group, std::uint32_t v) { return std::uint64_t{group} << 32 | v; }
    // Each corner of a triangle counts by its angle.
    void add_smooth_normal(const std::uint32_t* corners) {
        const Vec3d n = cross(places_[corners[1]] - places_[corners[0]], places_[corners[2]] - places_[corners[0]]);
        if (!(length(n) > 0)) return;
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3d &p = places_[corners[i]], a = places_[corners[(i + 1) % 3]] - p, b = places_[corners[(i + 2) % 3]] - p;
            smooth_normals_[smooth_key(smooth_, face_[corners[i]].v)] += normalize(n) * std::atan2(length(cross(a, b)), dot(a, b));
        }
    }

    // Its number in the part's mesh.
    std::uint32_t vertex(const PartKey& part, Corner c) {
        if (!part.has_uvs) c.vt = kNone;
        if (!part.has_normals) c.vn = kNone;
        LoadedMesh& mesh = current_->mesh;
        const auto [known, is_new] = current_->vertices.try_emplace(c, static_cast<std::uint32_t>(mesh.positions.size()));
        if (is_new) {
            mesh.positions.push_back(all_.positions[c.v]);
            if (!all_.colors.empty()) mesh.colors.push_back(all_.colors[c.v]);
            if (part.has_uvs) mesh.uvs.push_back(all_.uvs[c.vt]);
            if (part.has_normals) mesh.normals.push_back(all_.normals[c.vn]);
            if (part.smooth != 0) current_->v.push_back(c.v);
        }
        return known->second;
    }

    Statements statements_;
    Diagnostics& diagnostics_;
    Model model_;
    const Vertices all_;
    std::size_t positions_ = 0, uvs_ = 0, normals_ = 0;  // so far
    const MtlTarget mtl_;
    MtlMaterials materials_;
    std::map<std::string, std::uint32_t> used_;  // to the model's materials
    struct Carried {
        std::uint32_t area_light = kNone;
        FloatInput alpha = 1;
    };
    std::vector<Carried> carried_;  // what the shapes of each of these carry
    std::uint32_t material_ = 0, smooth_ = 0;
    std::map<PartKey, PartMesh> parts_;
    std::vector<PartKey> order_;  // as they were met
    PartMesh* current_ = nullptr;
    std::optional<PartKey> current_part_;
    std::unordered_map<std::uint64_t, Vec3d> smooth_normals_;  // by smoothing group and position, not of unit length
    std::map<std::string, std::uint64_t> ignored_;
    std::vector<Corner> face_;
    std::vector<Vec3d> places_;
    std::vector<std::uint32_t> corners_;
    bool is_complete_ = true;  // every mtllib was read
};

}  // namespace

Model read_obj(std::string_view text, const std::string& name, SceneFiles& files, const ModelColors& colors,
               Diagnostics& diagnostics) {
    return ObjReader(text, name, files, colors, diagnostics).read();
}

}  // namespace latent::render
