// tools/develop/channels/batch_response.h: what an observer makes of the powers of a whole batch of wavelengths.
// Equations: docs/developing.md, "From spectra to channels" and "The ratio estimator".
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/result.h"
#include "color/observer.h"
#include "sampledb/data/job.h"

namespace latent::develop {

// sum over i of P_i f(lambda_i), f an observer's curves, for whole batches lambda_i = Q^-1((xi + i) / k). Q^-1 and f are piecewise
// linear, so between the knots of all k of them the sum is linear in xi: one row of the table for each such interval. Exact,
// without an inversion per record.
class BatchResponse {
 public:
    BatchResponse() = default;
    BatchResponse(const sampledb::WavelengthDensity& density, int k, const color::Observer& observer);

    // Bytes that a table would take; large batches are better served pair by pair.
    static std::uint64_t bytes(const sampledb::WavelengthDensity& density, int k, const color::Observer& observer);
    bool empty() const { return rows_.empty(); }
    // X, Y, Z of the k powers at `power`.
    void xyz(std::uint32_t xi, const float* power, float* out) const;

 private:
    struct Row {
        std::uint32_t first_xi;  // rows are sorted; a row ends where the next begins
        double begin, scale;     // t = (xi - begin) scale runs from 0 to 1 over the row
    };
    static constexpr std::size_t kGroupFloats = 24;

    int k_ = 0;
    std::vector<Row> rows_;
    std::vector<std::uint32_t> guide_;  // row of each 1024th of the range of xi
    std::vector<float> table_;          // per row and four wavelengths: value at the begin and step of X, Y, Z, four each
};

// sum over i of f(lambda_i) / (k p(lambda_i)), over the integral of f: what a batch would show of a radiance of 1 at every
// wavelength, where 1 is right. Its mean over xi is 1. As linear between the same knots.
class BatchWhite {
 public:
    BatchWhite() = default;
    // Errors: kUsage: wavelengths are not drawn from a density; a curve that is negative or zero has no bounded ratio.
    static Result<BatchWhite> make(const sampledb::WavelengthDensity& density, int k, const color::Observer& observer);

    std::array<float, 3> operator()(std::uint32_t xi) const;

 private:
    struct Row {
        std::uint32_t first_xi;
        double begin, scale;  // BatchResponse::Row's
        std::array<double, 3> low, step;
    };
    std::vector<Row> rows_;
};

}  // namespace latent::develop
