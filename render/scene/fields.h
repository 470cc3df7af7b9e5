// render/scene/fields.h: every field of every struct of a description, listed once. What goes through a whole scene, such as its
// content hash, goes through these lists.
#pragma once

#include <array>
#include <concepts>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <type_traits>
#include <variant>
#include <vector>

#include "render/scene/description.h"

namespace latent::render {

// each_field(x, visit) calls for every field of x exactly one of
//   visit(a, b ...)                     a field that shapes the picture
//   visit.label(a, b ...)               one that does not: names, places in files
//   visit.template index<T>(i, j ...)   an index into the scene's table of T, or kNone
// A scene's hash is made of the places of the fields in these calls, so new fields go behind the others: then scenes that do not
// use them keep their hash. Each list begins by naming all fields of the struct, so a new field does not compile until it is named
// here as well. Then put it into one of the three calls. A new struct needs a list of its own. Numbers, enums, strings, spectra,
// hashes, arrays, vectors, maps, optional, variant and shared_ptr need nothing more. Data that stay in a file while the scene is
// rendered count by the Hash128 of the file's bytes, in a field beside the name, and the name is a label.
template <class T, class U>
concept Of = std::same_as<std::remove_const_t<T>, U>;

template <class Visit>
void each_field(Of<CameraDescription> auto& camera, Visit&& visit) {
    auto& [kind, world_from_camera, end, x0, x1, y0, y1, lens_radius, focal_distance, focal_slope, mapping, medium, location] =
        camera;
    visit(kind, world_from_camera, end, x0, x1, y0, y1, lens_radius, focal_distance, focal_slope, mapping);
    visit.template index<MediumDescription>(medium);
    visit.label(location);
}

template <class Visit>
void each_field(Of<FloatInput> auto& input, Visit&& visit) {
    auto& [value, texture] = input;
    visit(value);
    visit.template index<TextureDescription>(texture);
}

template <class Visit>
void each_field(Of<SpectrumInput> auto& input, Visit&& visit) {
    auto& [value, texture] = input;
    visit(value);
    visit.template index<TextureDescription>(texture);
}

template <class Visit>
void each_field(Of<MappingDescription> auto& mapping, Visit&& visit) {
    auto& [kind, uv_set, s, t, delta_u, delta_v, v1, v2, texture_from_world] = mapping;
    visit(kind, uv_set, s, t, delta_u, delta_v, v1, v2, texture_from_world);
}

template <class Visit>
void each_field(Of<PictureDescription> auto& picture, Visit&& visit) {
    auto& [path, name, content, wrap, filter, max_anisotropy, is_srgb, gamma, scale, invert, channel] = picture;
    visit(content, wrap, filter, max_anisotropy, is_srgb, gamma, scale, invert, channel);
    visit.label(path, name);
}

template <class Visit>
void each_field(Of<TextureDescription> auto& texture, Visit&& visit) {
    auto& [kind, is_spectrum, role, numbers, spectra, amount, mapping, picture, tint, by_vertex_color, is_solid, direction, octaves,
           roughness, scale, variation, location] = texture;
    visit(kind, is_spectrum, role, numbers, spectra, amount, mapping, picture, tint, by_vertex_color, is_solid, direction, octaves,
          roughness, scale, variation);
    visit.label(location);
}

template <class Visit>
void each_field(Of<MaterialDescription> auto& material, Visit&& visit) {
    auto& [type, name, numbers, spectra, options, remap_roughness, measured, displacement, normal_map, normal_scale,
           normals_follow_v, coat_normal_map, coat_normal_scale, mixed, location] = material;
    visit(type, numbers, spectra, options, remap_roughness, measured, displacement, normal_scale, normals_follow_v,
          coat_normal_scale);
    visit.template index<TextureDescription>(normal_map, coat_normal_map);
    visit.template index<MaterialDescription>(mixed[0], mixed[1]);
    visit.label(name, location);
}

template <class Visit>
void each_field(Of<SquareTable> auto& square, Visit&& visit) {
    auto& [width, height, values] = square;
    visit(width, height, values);
}

template <class Visit>
void each_field(Of<MeasuredBrdf> auto& brdf, Visit&& visit) {
    auto& [content, phi, theta, lambda_nm, ndf, sigma, vndf, luminance, spectra] = brdf;
    visit(content);  // all others follow from the file
    visit.label(phi, theta, lambda_nm, ndf, sigma, vndf, luminance, spectra);
}

template <class Visit>
void each_field(Of<MediumDescription> auto& medium, Visit&& visit) {
    auto& [name, sigma_a, sigma_s, scale, g, Le, Le_scale, volume, summed, world_from_medium, low, high, location] = medium;
    visit(sigma_a, sigma_s, scale, g, Le, Le_scale, volume, world_from_medium, low, high);
    visit.template index<MediumDescription>(summed[0], summed[1]);
    visit.label(name, location);
}

template <class Visit>
void each_field(Of<UniformVolume> auto&, Visit&&) {}

template <class Visit>
void each_field(Of<GridVolume> auto& volume, Visit&& visit) {
    auto& [density, temperature, temperature_offset, temperature_scale, Le_scale] = volume;
    visit(density, temperature, temperature_offset, temperature_scale, Le_scale);
}

template <class Visit>
void each_field(Of<PlacedGrid> auto& placed, Visit&& visit) {
    auto& [grid, grid_from_medium] = placed;
    visit(grid, grid_from_medium);
}

template <class Visit>
void each_field(Of<SpectralVolume> auto& volume, Visit&& visit) {
    auto& [sigma_a, sigma_s, Le] = volume;
    visit(sigma_a, sigma_s, Le);
}

template <class Visit>
void each_field(Of<SpectralVoxels> auto& voxels, Visit&& visit) {
    auto& [size, spectra, is_basis] = voxels;
    visit(size, spectra, is_basis);
}

template <class Visit>
void each_field(Of<CloudVolume> auto& volume, Visit&& visit) {
    auto& [density, wispiness, frequency] = volume;
    visit(density, wispiness, frequency);
}

template <class Visit>
void each_field(Of<VoxelGrid> auto& grid, Visit&& visit) {
    auto& [size, brick, values] = grid;
    visit(size, brick, values);
}

template <class Visit>
void each_field(Of<AreaLightDescription> auto& light, Visit&& visit) {
    auto& [spectrum, scale, power, two_sided, picture, mean_luminance, exponent, name, group, location] = light;
    visit(spectrum, scale, power, two_sided, mean_luminance, exponent, group);
    visit.template index<TextureDescription>(picture);
    visit.label(name, location);
}

template <class Visit>
void each_field(Of<ImageDescription> auto& image, Visit&& visit) {
    auto& [width, height, rgb] = image;
    visit(width, height, rgb);
}

template <class Visit>
void each_field(Of<LightDescription> auto& light, Visit&& visit) {
    auto& [kind, spectrum, scale, power, illuminance, world_from_light, from, to, cone_degrees, cone_delta_degrees, fov_degrees,
           image, portal, medium, name, group, location] = light;
    visit(kind, spectrum, scale, power, illuminance, world_from_light, from, to, cone_degrees, cone_delta_degrees, fov_degrees,
          image, portal, group);
    visit.template index<MediumDescription>(medium);
    visit.label(name, location);
}

template <class Visit>
void each_field(Of<MeshDescription> auto& mesh, Visit&& visit) {
    auto& [positions, normals, tangents, bitangents, uvs, more_uvs, colors, radii, indices] = mesh;
    visit(positions, normals, uvs, more_uvs, colors, radii, indices, tangents, bitangents);
}

template <class Visit>
void each_field(Of<ShapeDescription> auto& shape, Visit&& visit) {
    auto& [kind, mesh, to_world, radius, inner_radius, height, z_min, z_max, phi_max_degrees, flip_normal, ribbon, pairs, alpha,
           material, area_light, inside_medium, outside_medium, backdrop, location] = shape;
    visit(kind, mesh, to_world, radius, inner_radius, height, z_min, z_max, phi_max_degrees, flip_normal, ribbon, pairs, alpha);
    visit.template index<MaterialDescription>(material);
    visit.template index<AreaLightDescription>(area_light);
    visit.template index<MediumDescription>(inside_medium, outside_medium);
    visit(backdrop);
    visit.label(location);
}

template <class Visit>
void each_field(Of<ObjectDescription> auto& object, Visit&& visit) {
    auto& [name, origin, shapes] = object;
    visit(origin, shapes);
    visit.label(name);
}

template <class Visit>
void each_field(Of<InstanceDescription> auto& instance, Visit&& visit) {
    auto& [object, world_from_object, end, location] = instance;
    visit.template index<ObjectDescription>(object);
    visit(world_from_object, end);
    visit.label(location);
}

template <class Visit>
void each_field(Of<ShutterDescription> auto& shutter, Visit&& visit) {
    auto& [open, close] = shutter;
    visit(open, close);
}

// The tables are reached through the indices that refer to them. The film's aspect, the integrator and its depth count in the job
// id as they are used, whether the scene or the command line gave them.
template <class Visit>
void each_field(Of<SceneDescription> auto& scene, Visit&& visit) {
    auto& [files, film, origin, camera, shutter, rgb_spectra, integrator, max_depth, textures, materials, media, lights,
           area_lights, shapes, objects, instances] = scene;
    visit(origin, camera, lights, shapes, instances, rgb_spectra);
    if (has_motion(scene)) visit(shutter);  // without, it makes no difference
    visit.label(files, film, integrator, max_depth);
}

// What fields refer to by index.
auto tables(Of<SceneDescription> auto& scene) {
    return std::tie(scene.textures, scene.materials, scene.media, scene.area_lights, scene.objects);
}

// The table of T.
template <class T>
auto& table(Of<SceneDescription> auto& scene) {
    constexpr bool is_const = std::is_const_v<std::remove_reference_t<decltype(scene)>>;
    return std::get<std::conditional_t<is_const, const std::vector<T>, std::vector<T>>&>(tables(scene));
}

template <class T, class Visit>
void each_field(Vec2<T>& v, Visit&& visit) {
    visit(v.x, v.y);
}
template <class V, class Visit>
requires Of<V, Vec3f> || Of<V, Vec3d>
void each_field(V& v, Visit&& visit) { visit(v.x, v.y, v.z); }
template <class A, class Visit>
requires Of<A, Affinef> || Of<A, Affined>
void each_field(A& map, Visit&& visit) { visit(map.x, map.y, map.z, map.t); }

// A struct with a list of its own.
template <class T, class Visit>
concept Listed = requires(T& x, Visit& visit) {
    each_field(x, visit);
};

// Goes through everything in a description that shapes the picture, in order to change it. `Self`, which is derived from this, has
//   template <class T> void change_index(std::uint32_t& i)    as above
//   void change_number(T& x)                                   float or double; not those in long lists
// What is shared is shared between scenes too: it stays as it is, and holds no indices.
template <class Self>
class FieldWalk {
 public:
    template <class... T>
    void operator()(T&... x) {
        (go_into(x), ...);
    }
    template <class... T>
    void label(const T&...) {}
    template <class T, class... I>
    void index(I&... i) {
        (self().template change_index<T>(i), ...);
    }
    template <class T>
    void go_into(T& x) {
        if constexpr (std::is_floating_point_v<T>) {
            self().change_number(x);
        } else if constexpr (Listed<T, FieldWalk>) {
            each_field(x, *this);
        }
    }
    template <class T>
    void go_into(std::vector<T>& items) {
        if constexpr (Listed<T, FieldWalk>) {
            for (T& x : items) go_into(x);
        }
    }
    template <class T, std::size_t N>
    void go_into(std::array<T, N>& items) {
        for (T& x : items) go_into(x);
    }
    template <class T>
    void go_into(std::map<std::string, T, std::less<>>& items) {
        for (auto& [name, x] : items) go_into(x);
    }
    template <class T>
    void go_into(std::optional<T>& x) {
        if (x) go_into(*x);
    }
    template <class... T>
    void go_into(std::variant<T...>& x) {
        std::visit([this](auto& value) { this->go_into(value); }, x);
    }
    template <class T>
    void go_into(std::shared_ptr<const T>&) {}

 private:
    Self& self() { return static_cast<Self&>(*this); }
};

}  // namespace latent::render
