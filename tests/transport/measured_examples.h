// tests/transport/measured_examples.h: tables as of a measurement, of a metal that is known in closed form.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "base/bytes.h"
#include "render/bsdf/fresnel.h"
#include "render/bsdf/microfacet.h"
#include "render/sampling/bilinear_warp.h"
#include "render/scene/measured_brdf.h"

namespace latent::render::testing {

// The direction at a place of the square.
inline Vec3f direction_at(double x, double y) {
    const double theta = x * x * std::numbers::pi / 2, phi = (2 * y - 1) * std::numbers::pi;
    return Vec3f(Vec3d{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)});
}

struct MeasuredMetal {
    float alpha_x = 0.4f, alpha_y = 0.4f;
    float eta = 0.3f, k = 3;
    float tilt = 0.2f;                                    // by which its reflectance rises and falls from 595 nm to the ends
    std::uint32_t side = 48, directions = 10, turns = 1;  // of the tables, and theta and phi of the lattice
};

// f cos = F D G2 / (4 cos_camera): spectra are F G2 / G1, and sigma is cos_camera / G1.
inline MeasuredBrdf measured(const MeasuredMetal& metal) {
    const Microfacets facets = Microfacets::of_alpha(metal.alpha_x, metal.alpha_y);
    MeasuredBrdf out;
    const std::uint32_t n = metal.side;
    const float pi = std::numbers::pi_v<float>;
    for (std::uint32_t i = 0; i < metal.directions; ++i)  // 90 degrees are no direction to look along
        out.theta.push_back(pi / 2 * std::min(static_cast<float>(i) / static_cast<float>(metal.directions - 1), 0.98f));
    for (std::uint32_t i = 0; i < metal.turns; ++i)
        out.phi.push_back(metal.turns == 1 ? 0 : pi * (2 * static_cast<float>(i) / static_cast<float>(metal.turns - 1) - 1));
    out.lambda_nm = {360, 595, 830};
    const auto each_point = [n](auto&& f) {
        for (std::uint32_t y = 0; y < n; ++y) {
            for (std::uint32_t x = 0; x < n; ++x) f(static_cast<double>(x) / (n - 1), static_cast<double>(y) / (n - 1));
        }
    };
    out.ndf = out.sigma = out.vndf = out.luminance = out.spectra = {n, n, {}};
    each_point([&](double x, double y) {
        const Vec3f w = direction_at(std::min(x, 0.999), y);
        out.ndf.values.push_back(facets.density(direction_at(x, y)));
        out.sigma.values.push_back(w.z / facets.masking(w));
    });
    for (const float phi : out.phi) {
        for (const float theta : out.theta) {
            const Vec3f w = direction_at(std::sqrt(static_cast<double>(theta / pi) * 2), static_cast<double>(phi / (2 * pi)) + 0.5);
            const std::size_t first = out.vndf.values.size();
            each_point([&](double x, double y) {
                const Vec3f m = direction_at(x, y);
                const float area = 2 * pi * pi * static_cast<float>(x) * std::sqrt(m.x * m.x + m.y * m.y);
                out.vndf.values.push_back(dot(w, m) > 0 ? facets.visible_density(w, m) * area : 0);
            });
            const BilinearWarp warp(std::span(out.vndf.values).subspan(first), n, n);
            each_point([&](double x, double y) {
                const Vec2f place = warp.sample({}, static_cast<float>(x), static_cast<float>(y));
                const Vec3f m = direction_at(static_cast<double>(place.x), static_cast<double>(place.y)),
                            wi = m * (2 * dot(w, m)) - w;
                const float f = fresnel_conductor(std::abs(dot(w, m)), metal.eta, metal.k),
                            reflected = wi.z > 0 ? f * facets.masking_shadowing(w, wi) / facets.masking(w) : 0;
                out.luminance.values.push_back(reflected);
                for (const float share : {1 - metal.tilt, 1.0f, 1 + metal.tilt}) out.spectra.values.push_back(reflected * share);
            });
        }
    }
    return out;
}

// As a file of the RGL database.
class MeasuredFile {
 public:
    explicit MeasuredFile(const MeasuredBrdf& b) {
        const auto size = [](std::size_t n) { return static_cast<std::uint64_t>(n); };
        const std::uint64_t phi = size(b.phi.size()), theta = size(b.theta.size()), lambdas = size(b.lambda_nm.size());
        const auto side = [](const SquareTable& t) { return std::pair<std::uint64_t, std::uint64_t>(t.height, t.width); };
        const auto [vy, vx] = side(b.vndf);
        const auto [ly, lx] = side(b.luminance);
        const auto [sy, sx] = side(b.spectra);
        add("description", {4}, Bytes(4, std::byte{'m'}));
        add("jacobian", {1}, Bytes{std::byte{1}});
        add("phi_i", {phi}, b.phi);
        add("theta_i", {theta}, b.theta);
        add("wavelengths", {lambdas}, b.lambda_nm);
        add("ndf", {b.ndf.height, b.ndf.width}, b.ndf.values);
        add("sigma", {b.sigma.height, b.sigma.width}, b.sigma.values);
        add("vndf", {phi, theta, vy, vx}, b.vndf.values);
        add("luminance", {phi, theta, ly, lx}, b.luminance.values);
        std::vector<float> spectra(b.spectra.values.size());
        const std::size_t points = static_cast<std::size_t>(sy * sx), all = points * b.lambda_nm.size();
        for (std::size_t i = 0; i < spectra.size(); ++i)  // one wavelength after the other
            spectra[i] = b.spectra.values[i / all * all + i % points * b.lambda_nm.size() + i % all / points];
        add("spectra", {phi, theta, lambdas, sy, sx}, spectra);
    }

    // Replaces a field.
    void add(const std::string& name, const std::vector<std::uint64_t>& shape, const Bytes& values, std::uint8_t type = 1) {
        std::erase_if(fields_, [&](const Field& f) { return f.name == name; });
        fields_.push_back({name, shape, values, type});
    }
    void add(const std::string& name, const std::vector<std::uint64_t>& shape, const std::vector<float>& values) {
        Bytes bytes(values.size() * sizeof(float));
        for (std::size_t i = 0; i < values.size(); ++i) store_le(bytes.data() + i * sizeof(float), values[i]);
        add(name, shape, bytes, 10);
    }
    void remove(const std::string& name) {
        std::erase_if(fields_, [&](const Field& f) { return f.name == name; });
    }
    Bytes bytes() const {
        Bytes out;
        const auto put = [&out](auto value) {
            out.resize(out.size() + sizeof value);
            store_le(out.data() + out.size() - sizeof value, value);
        };
        for (const char c : {'t', 'e', 'n', 's', 'o', 'r', '_', 'f', 'i', 'l', 'e', '\0', '\1', '\0'}) put(c);
        put(static_cast<std::uint32_t>(fields_.size()));
        std::uint64_t offset = out.size();
        for (const Field& f : fields_) offset += 13 + f.name.size() + 8 * f.shape.size();
        for (const Field& f : fields_) {
            put(static_cast<std::uint16_t>(f.name.size()));
            for (const char c : f.name) put(c);
            put(static_cast<std::uint16_t>(f.shape.size()));
            put(f.type);
            put(offset);
            for (const std::uint64_t extent : f.shape) put(extent);
            offset += f.values.size();
        }
        for (const Field& f : fields_) out.insert(out.end(), f.values.begin(), f.values.end());
        return out;
    }

 private:
    struct Field {
        std::string name;
        std::vector<std::uint64_t> shape;
        Bytes values;
        std::uint8_t type;
    };
    std::vector<Field> fields_;
};

}  // namespace latent::render::testing
