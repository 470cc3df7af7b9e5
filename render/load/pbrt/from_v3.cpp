#include "render/load/pbrt/from_v3.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <numbers>
#include <utility>

#include "render/load/files/unread.h"

namespace latent::render {

namespace {

Parameter* find(Directive& d, std::string_view name) {
    const auto found = std::ranges::find(d.parameters, name, &Parameter::name);
    return found == d.parameters.end() ? nullptr : &*found;
}

std::optional<Parameter> take(Directive& d, std::string_view name) {
    const auto found = std::ranges::find(d.parameters, name, &Parameter::name);
    if (found == d.parameters.end()) return std::nullopt;
    Parameter taken = std::move(*found);
    d.parameters.erase(found);
    return taken;
}

void rename(Directive& d, std::string_view from, const std::string& to) {
    if (Parameter* p = find(d, from)) p->name = to;
}

void set(Directive& d, const std::string& type, const std::string& name, std::vector<double> numbers) {
    take(d, name);
    d.parameters.push_back({.type = type, .name = name, .where = d.where, .numbers = std::move(numbers)});
}
void set_text(Directive& d, const std::string& type, const std::string& name, std::vector<std::string> strings) {
    take(d, name);
    d.parameters.push_back({.type = type, .name = name, .where = d.where, .strings = std::move(strings)});
}
void set_default(Directive& d, const std::string& type, const std::string& name, std::vector<double> numbers) {
    if (find(d, name) == nullptr) set(d, type, name, std::move(numbers));
}

// What a number is, or a colour that is grey.
std::optional<double> grey(const Parameter& p) {
    if (p.numbers.empty() || (p.type != "float" && p.type != "rgb")) return std::nullopt;
    if (std::ranges::any_of(p.numbers, [&](double x) { return x != p.numbers[0]; })) return std::nullopt;
    return p.numbers[0];
}
double mean(const Parameter& p) {
    double sum = 0;
    for (const double x : p.numbers) sum += x;
    return p.numbers.empty() ? 0 : sum / static_cast<double>(p.numbers.size());
}

// To sRGB's primaries [IEC61966-2-1].
void make_rgb(Parameter& p) {
    if (p.type != "xyz" || p.numbers.size() % 3 != 0) return;
    p.type = "rgb";
    for (std::size_t i = 0; i < p.numbers.size(); i += 3) {
        const double x = p.numbers[i], y = p.numbers[i + 1], z = p.numbers[i + 2];
        p.numbers[i] = 3.2404542 * x - 1.5371385 * y - 0.4985314 * z;
        p.numbers[i + 1] = -0.9692660 * x + 1.8760108 * y + 0.0415560 * z;
        p.numbers[i + 2] = 0.0556434 * x - 0.2040259 * y + 1.0572252 * z;
    }
}

// Quadrics that pbrt-v4 has given up become meshes: points by the turn about z, 0 to 1, and by v from 0 to 1 along them.
struct Quadric {
    double phi_max = 0;                                 // [rad]
    std::function<std::array<double, 3>(double)> at{};  // where v is, at phi = 0
};

double number(Directive& d, std::string_view name, double otherwise) {
    const std::optional<Parameter> p = take(d, name);
    return p && p->numbers.size() == 1 ? p->numbers[0] : otherwise;
}
std::array<double, 3> point(Directive& d, std::string_view name, const std::array<double, 3>& otherwise) {
    const std::optional<Parameter> p = take(d, name);
    return p && p->numbers.size() == 3 ? std::array{p->numbers[0], p->numbers[1], p->numbers[2]} : otherwise;
}

std::optional<Quadric> quadric_of(Directive& d) {
    const std::string& type = d.strings[0];
    if (type != "cone" && type != "paraboloid" && type != "hyperboloid") return std::nullopt;
    Quadric out{.phi_max = std::clamp(number(d, "phimax", 360), 0.0, 360.0) * std::numbers::pi / 180};
    const double radius = number(d, "radius", 1);
    if (type == "cone") {
        const double height = number(d, "height", 1);
        out.at = [=](double v) { return std::array{radius * (1 - v), 0.0, v * height}; };
    } else if (type == "paraboloid") {
        const double low = number(d, "zmin", 0), high = number(d, "zmax", 1);
        out.at = [=](double v) {
            const double z = low + v * (high - low);
            return std::array{radius * std::sqrt(std::max(z / high, 0.0)), 0.0, z};
        };
    } else {
        const std::array<double, 3> a = point(d, "p1", {0, 0, 0}), b = point(d, "p2", {1, 1, 1});
        out.at = [=](double v) { return std::array{a[0] + v * (b[0] - a[0]), a[1] + v * (b[1] - a[1]), a[2] + v * (b[2] - a[2])}; };
    }
    return out;
}

// As pbrt-v3 parametrises it; it faces along dp/du x dp/dv.
void make_mesh(Directive& d, const Quadric& quadric) {
    constexpr int kAround = 128, kAlong = 32;
    std::vector<double> p, n, uv, indices;
    for (int j = 0; j <= kAlong; ++j) {
        for (int i = 0; i <= kAround; ++i) {
            const double u = double{1} * i / kAround, v = double{1} * j / kAlong, c = std::cos(u * quadric.phi_max),
                         s = std::sin(u * quadric.phi_max);
            const std::array<double, 3> at = quadric.at(v);
            // Where the surface meets the axis, it turns about it all the same.
            const bool is_on_axis = at[0] == 0 && at[1] == 0;
            const double tx = is_on_axis ? 0 : -at[1], ty = is_on_axis ? 1 : at[0], h = 1e-4;
            const std::array<double, 3> next = quadric.at(std::min(v + h, 1.0)), last = quadric.at(std::max(v - h, 0.0));
            const double dx = next[0] - last[0], dy = next[1] - last[1], dz = next[2] - last[2];
            const double nx = ty * dz, ny = -tx * dz, nz = tx * dy - ty * dx, size = std::sqrt(nx * nx + ny * ny + nz * nz);
            p.insert(p.end(), {at[0] * c - at[1] * s, at[0] * s + at[1] * c, at[2]});
            n.insert(n.end(), {(nx * c - ny * s) / size, (nx * s + ny * c) / size, nz / size});
            uv.insert(uv.end(), {u, v});
            if (i == kAround || j == kAlong) continue;
            const double first = j * (kAround + 1) + i, above = first + kAround + 1;
            indices.insert(indices.end(), {first, first + 1, above + 1, first, above + 1, above});
        }
    }
    d.strings[0] = "trianglemesh";
    set(d, "point3", "P", std::move(p));
    set(d, "normal", "N", std::move(n));
    set(d, "point2", "uv", std::move(uv));
    set(d, "integer", "indices", std::move(indices));
}

// pbrt-v3 clamps colours of surfaces.
void make_reflectance(Directive& d, std::string_view from, const std::string& to) {
    Parameter* p = find(d, from);
    if (p == nullptr) return;
    p->name = to;
    if (p->type != "rgb") return;
    for (double& x : p->numbers) x = std::clamp(x, 0.0, 1.0);
}

}  // namespace

bool is_of_pbrt_v3(const Directive& d) {
    constexpr std::string_view kMaterials[] = {"disney", "fourier", "glass",     "kdsubsurface", "matte", "metal",
                                               "mirror", "plastic", "substrate", "translucent",  "uber"};
    const auto is = [&](std::string_view name, std::size_t i, std::initializer_list<std::string_view> types) {
        return d.name == name && d.strings.size() > i && std::ranges::count(types, d.strings[i]) > 0;
    };
    const auto is_old_material = [&](const Parameter& p) {
        return p.name == "type" && p.strings.size() == 1 && std::ranges::count(kMaterials, p.strings[0]) > 0;
    };
    return is("Film", 0, {"image"}) || is("Camera", 0, {"environment"}) || is("Texture", 1, {"color"}) ||
           (d.name == "Material" && std::ranges::count(kMaterials, d.strings[0]) > 0) ||
           (d.name == "MakeNamedMaterial" && std::ranges::any_of(d.parameters, is_old_material));
}

std::string FromPbrtV3::define(const std::string& kind, const std::string& name) {
    ++names_[{kind, name}].count;
    return current(kind, name);
}

std::string FromPbrtV3::current(const std::string& kind, const std::string& name) const {
    const auto known = names_.find({kind, name});
    return known == names_.end() || known->second.count < 2 ? name : fmt::format("{} ({})", name, known->second.count);
}

void FromPbrtV3::drop_unread(Directive& d) const {
    std::erase_if(d.parameters, [&](const Parameter& p) {
        const UnreadFeatures* const unread = find_unread(SceneLanguage::kPbrtV3, d.name, p.name);
        if (unread == nullptr) return false;
        diagnostics_.say_of_unread(d.name + p.name, diagnostics_.place(p.where), p.name + ": ignored", *unread);
        return true;
    });
}

void FromPbrtV3::drop(Directive& d, std::string_view material, std::initializer_list<std::string_view> names,
                      double harmless) const {
    for (const std::string_view name : names) {
        const std::optional<Parameter> p = take(d, name);
        if (p && grey(*p) != harmless)
            diagnostics_.warn(p->where, fmt::format("{}: ignored{}", name, why_unread(SceneLanguage::kPbrtV3, material, name)));
    }
}

std::vector<Directive> FromPbrtV3::translate(Directive d) {
    std::vector<Directive> out;
    if (!rewrite(d)) return out;
    const auto is = [&](const char* type) { return d.name == "Texture" && d.strings[1] == "spectrum" && d.strings[2] == type; };
    const bool is_grey = is("fbm") || is("wrinkled") || is("windy");
    out.push_back(std::move(d));
    if (!is_grey) return out;
    // Noise in pbrt-v4 is numbers alone; as a colour, it is a mixture of black and white. Both kinds have names of their own.
    Directive& noise = out.front();
    noise.strings[1] = "float";
    Directive mixed{.name = "Texture", .where = noise.where, .strings = {noise.strings[0], "spectrum", "mix"}};
    set(mixed, "rgb", "tex1", {0, 0, 0});
    set(mixed, "rgb", "tex2", {1, 1, 1});
    set_text(mixed, "texture", "amount", {noise.strings[0]});
    out.push_back(std::move(mixed));
    return out;
}

bool FromPbrtV3::rewrite(Directive& d) {
    if (d.name == "WorldEnd") return false;
    drop_unread(d);
    for (Parameter& p : d.parameters) {
        make_rgb(p);
        if (p.type != "texture") continue;
        for (std::string& name : p.strings) name = current("texture", name);
    }
    if (d.name == "AttributeBegin" || d.name == "ObjectBegin") opacities_.push_back(opacity_);
    if ((d.name == "AttributeEnd" || d.name == "ObjectEnd") && !opacities_.empty()) {
        opacity_ = opacities_.back();
        opacities_.pop_back();
    }
    // They keep only the transformation of the graphics state; pbrt-v4 keeps all of it.
    if (d.name == "TransformBegin") {
        d.name = "CoordinateSystem";
        d.strings = {fmt::format("TransformBegin {}", kept_transforms_++)};
    } else if (d.name == "TransformEnd" && kept_transforms_ > 0) {
        d.name = "CoordSysTransform";
        d.strings = {fmt::format("TransformBegin {}", --kept_transforms_)};
    }
    if (d.name == "Film") film(d);
    if (d.name == "Integrator") integrator(d);
    if (d.name == "Camera" && d.strings[0] == "environment") {
        d.strings[0] = "spherical";
        set_text(d, "string", "mapping", {"equirectangular"});
    }
    if (d.name == "LightSource" || d.name == "AreaLightSource") light(d);
    if (d.name == "Shape") shape(d);
    if (d.name == "Texture") texture(d);
    if (d.name == "ObjectBegin") d.strings[0] = define("object", d.strings[0]);
    if (d.name == "ObjectInstance") d.strings[0] = current("object", d.strings[0]);
    if (d.name == "MakeNamedMedium") {
        if (Parameter* type = find(d, "type"); type != nullptr && type->strings == std::vector<std::string>{"heterogeneous"})
            type->strings[0] = "uniformgrid";
    }
    if (d.name == "Material") opacity_ = material(d.strings[0], d);
    if (d.name == "MakeNamedMaterial") {
        d.strings[0] = define("material", d.strings[0]);
        std::string type = "matte";
        if (const std::optional<Parameter> given = take(d, "type"); given && given->strings.size() == 1) type = given->strings[0];
        names_[{"opacity", d.strings[0]}].opacity = material(type, d);
        set_text(d, "string", "type", {type});
    }
    if (d.name == "NamedMaterial") {
        d.strings[0] = current("material", d.strings[0]);
        const auto known = names_.find({"opacity", d.strings[0]});
        opacity_ = known != names_.end() ? known->second.opacity : std::nullopt;
    }
    return true;
}

void FromPbrtV3::film(Directive& d) const {
    if (d.strings[0] == "image") d.strings[0] = "rgb";
    rename(d, "maxsampleluminance", "maxcomponentvalue");
}

void FromPbrtV3::integrator(Directive& d) const {
    if (d.strings[0] != "directlighting" && d.strings[0] != "whitted") return;
    diagnostics_.warn(d.where,
                      fmt::format("Integrator \"{}\" is replaced by \"path\": surfaces light each other, too", d.strings[0]));
    d.strings[0] = "path";
}

void FromPbrtV3::light(Directive& d) const {
    if (d.strings[0] == "area") d.strings[0] = "diffuse";
    rename(d, "mapname", "filename");
    const bool has_picture = find(d, "filename") != nullptr;
    double total = 1;
    const auto multiply = [&](const Parameter& p) {
        if (!grey(p))
            diagnostics_.warn(p.where, fmt::format("{}: its mean counts, since pbrt-v4 has one factor for all colours", p.name));
        total *= mean(p);
    };
    if (const std::optional<Parameter> scale = take(d, "scale")) multiply(*scale);
    for (const char* name : {"L", "I"}) {
        Parameter* p = find(d, name);
        if (p == nullptr) continue;
        if (p->type == "blackbody" && p->numbers.size() == 2) {
            total *= p->numbers[1];
            p->numbers.pop_back();
        }
        // What a picture colours.
        if (has_picture && p->type == "rgb") multiply(*take(d, name));
    }
    if (total != 1) set(d, "float", "scale", {total});
}

void FromPbrtV3::shape(Directive& d) const {
    rename(d, "nlevels", "levels");
    if (const std::optional<Quadric> quadric = quadric_of(d)) make_mesh(d, *quadric);
    for (const char* name : {"uv", "st"}) {
        if (Parameter* p = find(d, name); p != nullptr && (p->type == "float" || p->type == "point2"))
            p->type = "point2", p->name = "uv";
    }
    if (opacity_ && find(d, "alpha") == nullptr) set(d, "float", "alpha", {*opacity_});
}

void FromPbrtV3::texture(Directive& d) {
    if (d.strings[1] == "color") d.strings[1] = "spectrum";
    if (d.strings[2] == "scale") scale_texture(d);
    if (d.strings[2] == "imagemap") {
        if (const std::optional<Parameter> p = take(d, "trilinear"); p && !p->flags.empty())
            set_text(d, "string", "filter", {p->flags[0] ? "trilinear" : "ewa"});
        if (find(d, "filter") == nullptr) set_text(d, "string", "filter", {"ewa"});
        if (const std::optional<Parameter> p = take(d, "gamma")) {
            const bool is_flag = !p->flags.empty();
            set_text(d, "string", "encoding",
                     {is_flag              ? (p->flags[0] ? "sRGB" : "linear")
                      : p->numbers.empty() ? "sRGB"
                                           : fmt::format("gamma {}", p->numbers[0])});
        }
    }
    // Its own inputs were those before.
    d.strings[0] = define("texture", d.strings[0]);
}

// One of the two factors is a number in pbrt-v4, or a texture of numbers.
void FromPbrtV3::scale_texture(Directive& d) const {
    std::optional<Parameter> a = take(d, "tex1"), b = take(d, "tex2");
    if (!a && !b) return;
    if (d.strings[1] == "float") {
        const Parameter one{.type = "float", .where = d.where, .numbers = {1}};
        Parameter first = a.value_or(one), second = b.value_or(one);
        first.name = "tex", second.name = "scale";
        d.parameters.push_back(std::move(first));
        d.parameters.push_back(std::move(second));
        return;
    }
    const auto is_number = [](const std::optional<Parameter>& p) { return !p || grey(*p).has_value(); };
    if (a && b && a->type == "rgb" && b->type == "rgb" && a->numbers.size() == b->numbers.size()) {
        for (std::size_t i = 0; i < a->numbers.size(); ++i) a->numbers[i] *= b->numbers[i];
        b.reset();
    }
    if (!is_number(b)) std::swap(a, b);
    if (!is_number(b))
        return diagnostics_.error(
            d.where, "Texture \"scale\": a texture times a colour is not supported: one of tex1 and tex2 must be grey");
    Parameter tex = a.value_or(Parameter{.type = "rgb", .where = d.where, .numbers = {1, 1, 1}});
    tex.name = "tex";
    if (tex.type == "float") tex.type = "rgb", tex.numbers.resize(3, tex.numbers.empty() ? 1 : tex.numbers[0]);
    d.parameters.push_back(std::move(tex));
    set(d, "float", "scale", {b ? grey(*b).value() : 1});
}

std::optional<double> FromPbrtV3::material(std::string& type, Directive& d) const {
    rename(d, "bumpmap", "displacement");
    std::optional<double> opacity;
    const auto coated = [&](double roughness, double body) {
        const std::optional<Parameter> mirror = take(d, "Ks");
        const bool is_coated = !mirror || grey(*mirror) != 0, is_whole = type != "substrate" && mirror && grey(*mirror) == 1;
        if (is_coated && !is_whole)
            diagnostics_.say_of_unread("Ks of " + type, diagnostics_.place(d.where), type + ": Ks does not count",
                                       *find_unread(SceneLanguage::kPbrtV3, type, "Ks"));
        make_reflectance(d, "Kd", "reflectance");
        set_default(d, "rgb", "reflectance", {body, body, body});
        type = is_coated ? "coateddiffuse" : "diffuse";
        const bool has_axes = find(d, "uroughness") != nullptr || find(d, "vroughness") != nullptr;
        if (is_coated && !has_axes) set_default(d, "float", "roughness", {roughness});
        if (is_coated) return;
        for (const char* name : {"roughness", "uroughness", "vroughness", "remaproughness", "eta", "index"}) take(d, name);
    };
    if (type == "glass" || type == "uber") {
        if (find(d, "eta") == nullptr) rename(d, "index", "eta");
        take(d, "index");
    }
    if (type.empty() || type == "none") {
        type = "interface";
    } else if (type == "matte") {
        type = "diffuse";
        drop(d, "matte", {"sigma"}, 0);
        make_reflectance(d, "Kd", "reflectance");
    } else if (type == "plastic") {
        coated(0.1, 0.25);
    } else if (type == "substrate") {
        coated(0.1, 0.5);
    } else if (type == "uber") {
        drop(d, "uber", {"Kr", "Kt"}, 0);
        if (const std::optional<Parameter> p = take(d, "opacity")) {
            if (p->type == "texture") diagnostics_.warn(p->where, "opacity: ignored: it is a texture");
            if (p->type != "texture" && mean(*p) < 1) opacity = std::clamp(mean(*p), 0.0, 1.0);
        }
        coated(0.1, 0.25);
    } else if (type == "glass") {
        type = "dielectric";
        drop(d, "glass", {"Kr", "Kt"}, 1);
    } else if (type == "metal") {
        type = "conductor";
        drop(d, "metal", {"Kr"}, 1);
        const bool has_axes = find(d, "uroughness") != nullptr || find(d, "vroughness") != nullptr;
        if (!has_axes) set_default(d, "float", "roughness", {0.01});
    } else if (type == "mirror") {
        type = "conductor";
        make_reflectance(d, "Kr", "reflectance");
        set_default(d, "rgb", "reflectance", {0.9, 0.9, 0.9});
        set(d, "float", "roughness", {0});
    } else if (type == "translucent") {
        type = "diffusetransmission";
        translucent(d);
    } else if (type == "mix") {
        mixture(d);
    } else if (type == "disney") {
        type = "latent:principled";
        disney(d);
    } else if (type == "kdsubsurface" || type == "subsurface") {
        if (type == "kdsubsurface") make_reflectance(d, "Kd", "reflectance");
        type = "subsurface";
        drop(d, "subsurface", {"Kr", "Kt"}, 1);
    } else if (type == "hair") {
        make_reflectance(d, "color", "reflectance");
    }
    return opacity;
}

void FromPbrtV3::translucent(Directive& d) const {
    const auto body = [&](const char* name) {
        Parameter p = take(d, name).value_or(Parameter{.type = "rgb", .where = d.where, .numbers = {0.5, 0.5, 0.5}});
        if (p.numbers.size() == 1) p.numbers.resize(3, p.numbers[0]);
        return p;
    };
    const Parameter back = body("reflect"), through = body("transmit");
    Parameter color = take(d, "Kd").value_or(Parameter{.type = "rgb", .where = d.where, .numbers = {0.25, 0.25, 0.25}});
    drop(d, "translucent", {"Ks"}, 0);
    for (const char* name : {"roughness", "remaproughness"}) take(d, name);
    const bool is_constant = color.numbers.size() == 3 && back.numbers.size() == 3 && through.numbers.size() == 3;
    for (const auto& [name, share] : {std::pair{"reflectance", &back}, std::pair{"transmittance", &through}}) {
        color.name = name;
        d.parameters.push_back(color);
        for (std::size_t i = 0; is_constant && i < 3; ++i)
            d.parameters.back().numbers[i] = std::clamp(color.numbers[i] * share->numbers[i], 0.0, 1.0);
    }
    if (is_constant) return;
    set(d, "float", "scale", {(mean(back) + mean(through)) / 2});
    if (!grey(back) || grey(back) != grey(through))
        diagnostics_.warn(d.where, "reflect, transmit: their mean counts, since Kd is no colour but a texture or a spectrum");
}

// The second material of pbrt-v3 is the first of pbrt-v4; the share stays that of the other one.
void FromPbrtV3::mixture(Directive& d) const {
    std::vector<std::string> materials;
    for (const char* name : {"namedmaterial2", "namedmaterial1"}) {
        const std::optional<Parameter> p = take(d, name);
        if (p && p->strings.size() == 1) materials.push_back(current("material", p->strings[0]));
    }
    set_text(d, "string", "materials", materials);
    Parameter* amount = find(d, "amount");
    if (amount == nullptr) return;
    const std::optional<double> share = grey(*amount);
    if (share) {
        set(d, "float", "amount", {std::clamp(*share, 0.0, 1.0)});
    } else {
        make_reflectance(d, "amount", "latent:amount");
    }
}

void FromPbrtV3::disney(Directive& d) const {
    make_reflectance(d, "color", "color");
    set_default(d, "rgb", "color", {0.5, 0.5, 0.5});
    const std::optional<Parameter> gloss = take(d, "clearcoatgloss");
    rename(d, "clearcoat", "coat");
    // alpha = 0.1 + (0.001 - 0.1) gloss, roughness its root.
    const double shine = gloss ? grey(*gloss).value_or(1) : 1;
    if (find(d, "coat") != nullptr)
        set(d, "float", "coatroughness", {std::sqrt(0.1 + (0.001 - 0.1) * std::clamp(shine, 0.0, 1.0))});
    rename(d, "spectrans", "transmission");
    rename(d, "anisotropic", "anisotropy");
    if (const std::optional<Parameter> sheen = take(d, "sheen")) {
        if (const std::optional<double> s = grey(*sheen); s && *s > 0) set(d, "rgb", "sheen", {*s, *s, *s});
        if (!grey(*sheen)) diagnostics_.warn(sheen->where, "sheen: ignored: it is a texture");
    }
    drop(d, "disney", {"sheentint", "speculartint", "flatness", "difftrans", "scatterdistance"}, 0);
}

}  // namespace latent::render
