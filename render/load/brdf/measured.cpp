#include "render/load/brdf/measured.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <utility>

#include "render/load/brdf/tensor_file.h"

namespace latent::render {

namespace {

constexpr std::uint64_t kMaxSide = 1 << 16;
constexpr float kTurn = 6.3f;  // a little more than 2 pi

Error faulty(const std::string& what) { return {ErrorCode::kCorrupt, what}; }

bool are_finite(const std::vector<float>& values) {
    return std::ranges::all_of(values, [](float x) { return std::isfinite(x); });
}

// Fields of one file by name.
class Fields {
 public:
    explicit Fields(const std::map<std::string, Tensor>& fields) : fields_(fields) {}

    // Ascending, from `low` to `high`.
    Status read_axis(const std::string& name, float low, float high, std::vector<float>& out) const {
        const Result<const Tensor*> field = find(name, TensorType::kFloat32, 1);
        if (!field) return field.error();
        out = (*field)->floats();
        if (out.empty()) return faulty(name + ": is empty");
        if (!are_finite(out)) return faulty(name + ": values are not finite");
        if (std::ranges::adjacent_find(out, std::greater_equal<>()) != out.end()) return faulty(name + ": not ascending");
        if (out.front() < low || out.back() > high) return faulty(fmt::format("{}: not within {} to {}", name, low, high));
        return {};
    }
    // A table for each index into axes of these lengths. Noise may be negative; what was measured is not.
    Status read_tables(const std::string& name, const std::vector<std::uint64_t>& axes, SquareTable& out) const {
        const Result<const Tensor*> field = find(name, TensorType::kFloat32, axes.size() + 2);
        if (!field) return field.error();
        const std::vector<std::uint64_t>& shape = (*field)->shape;
        if (!std::equal(axes.begin(), axes.end(), shape.begin())) return faulty(name + ": not a table for each direction");
        const std::uint64_t height = shape[axes.size()], width = shape[axes.size() + 1];
        if (height < 2 || width < 2 || height > kMaxSide || width > kMaxSide)
            return faulty(fmt::format("{}: tables of {} x {} values", name, width, height));
        out = {static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), (*field)->floats()};
        if (!are_finite(out.values)) return faulty(name + ": values are not finite");
        for (float& x : out.values) x = std::clamp(x, 0.0f, 1e30f);
        return {};
    }
    // Whether spectra are what remains after division by the facets' share.
    Status check_jacobian() const {
        const Result<const Tensor*> field = find("jacobian", TensorType::kUint8, 1);
        if (!field) return field.error();
        const auto bytes = (*field)->bytes;
        if (bytes.size() != 1) return faulty("jacobian: not one byte");
        if (bytes[0] != std::byte{1}) return Error{ErrorCode::kUnsupported, "jacobian: is not 1"};
        return {};
    }

 private:
    Result<const Tensor*> find(const std::string& name, TensorType type, std::size_t dimensions) const {
        const auto field = fields_.find(name);
        if (field == fields_.end()) return faulty("it has no field " + name);
        if (field->second.type != type || field->second.shape.size() != dimensions)
            return faulty(fmt::format("{}: not {} dimension{} of {}", name, dimensions, dimensions == 1 ? "" : "s",
                                      type == TensorType::kUint8 ? "uint8" : "float32"));
        return &field->second;
    }
    const std::map<std::string, Tensor>& fields_;
};

// In the file, tables of one wavelength follow each other.
void gather_wavelengths(SquareTable& spectra, std::size_t count) {
    const std::size_t points = std::size_t{spectra.width} * spectra.height, all = points * count;
    std::vector<float> tables(all);
    for (std::size_t first = 0; first < spectra.values.size(); first += all) {
        const auto values = spectra.values.begin() + static_cast<std::ptrdiff_t>(first);
        std::copy_n(values, all, tables.begin());
        for (std::size_t i = 0; i < all; ++i) values[static_cast<std::ptrdiff_t>(i)] = tables[i % count * points + i / count];
    }
}

}  // namespace

Result<std::shared_ptr<const MeasuredBrdf>> read_measured_brdf(std::span<const std::byte> file) {
    const auto tensors = read_tensors(file);
    if (!tensors) return tensors.error();
    const Fields fields(*tensors);
    auto brdf = std::make_shared<MeasuredBrdf>();
    brdf->content = hash128(file);
    if (Status s = fields.read_axis("phi_i", -kTurn, kTurn, brdf->phi); !s) return s.error();
    if (Status s = fields.read_axis("theta_i", 0, 1.6f, brdf->theta); !s) return s.error();
    if (Status s = fields.read_axis("wavelengths", 100, 1e4f, brdf->lambda_nm); !s) return s.error();
    const std::uint64_t phi = brdf->phi.size(), theta = brdf->theta.size(), lambda = brdf->lambda_nm.size();
    if (Status s = fields.check_jacobian(); !s) return s.error();
    if (Status s = fields.read_tables("ndf", {}, brdf->ndf); !s) return s.error();
    if (Status s = fields.read_tables("sigma", {}, brdf->sigma); !s) return s.error();
    if (Status s = fields.read_tables("vndf", {phi, theta}, brdf->vndf); !s) return s.error();
    if (Status s = fields.read_tables("luminance", {phi, theta}, brdf->luminance); !s) return s.error();
    if (Status s = fields.read_tables("spectra", {phi, theta, lambda}, brdf->spectra); !s) return s.error();
    gather_wavelengths(brdf->spectra, brdf->lambda_nm.size());
    const float turns = (brdf->phi.back() - brdf->phi.front()) / (2 * std::numbers::pi_v<float>);
    if (!brdf->is_isotropic() && (turns < 2.0f / 3 || turns > 2))  // as in pbrt-v4
        return Error{ErrorCode::kUnsupported, "phi_i: does not go all around"};
    return std::shared_ptr<const MeasuredBrdf>(std::move(brdf));
}

}  // namespace latent::render
