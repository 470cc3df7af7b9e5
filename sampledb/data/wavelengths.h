// sampledb/data/wavelengths.h: the density that a job's wavelengths are drawn from, and its exact inversion. Format:
// docs/format.md.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"

namespace latent::sampledb {

// Cumulative distribution Q over wavelength, piecewise linear between integer knots, so that every reader on every processor gets
// the same wavelengths. lambda_i = Q^-1((xi + i) / k), i = 0..k-1, with xi a 32-bit fraction ([RBA09]: one offset
// shifts a whole stratified batch).
class WavelengthDensity {
 public:
    struct Knot {
        std::uint32_t lambda;      // wavelength in units of 2^-20 nm (360 nm .. 830 nm)
        std::uint64_t cumulative;  // Q in units of 2^-48; 0 at the first knot, 2^48 at the last, strictly increasing
        bool operator==(const Knot&) const = default;
    };

    WavelengthDensity() = default;  // none: records carry explicit wavelengths
    // Errors: kOutOfRange unless knots are 2..4096, strictly increasing in both fields, from Q = 0 to Q = 2^48.
    static Result<WavelengthDensity> from_knots(std::vector<Knot> knots);

    bool empty() const { return knots_.empty(); }
    std::span<const Knot> knots() const { return knots_; }
    bool operator==(const WavelengthDensity& other) const { return knots_ == other.knots_; }

    // The wavelengths [nm] of the batch (xi, k), ascending. Integer and exactly rounded double operations only: no libm. `segment`,
    // as long or empty: the knot before each, which the rounded wavelength may lie beyond.
    void batch(std::uint32_t xi, std::span<float> lambda_nm, std::span<std::uint16_t> segment = {}) const;
    // Wavelength i of that batch alone; the same bits as batch()[i].
    float wavelength(std::uint32_t xi, std::uint32_t i, std::uint32_t k) const;
    // p(lambda) [1/nm], the slope of Q: piecewise constant, that of the segment to the right at a knot; 0 outside the knots.
    float pdf_lambda(float lambda_nm) const;

 private:
    // Between two knots; all that an inversion needs in half a cache line.
    struct Segment {
        std::uint64_t begin, end;  // cumulative
        double lambda, slope;      // at its begin; d lambda / d Q; in the knots' units
        float lambda_nm_at(std::uint64_t q) const;
    };
    std::size_t segment_of(std::uint64_t q) const;

    std::vector<Knot> knots_;
    std::vector<Segment> segments_;     // behind each knot but the last
    std::vector<std::uint16_t> guide_;  // the segment that each of 4096 equal steps of Q begins in
};

}  // namespace latent::sampledb
