// sampledb/data/pixel_lattice.h: the order in which samples visit the pixels of a picture, and where in its pixel each lies.
// docs/format.md, "Samplers".
#pragma once

#include <cstdint>

#include "sampledb/data/film_position.h"
#include "sampledb/data/page.h"

namespace latent::sampledb {

// Divides by one number again and again: by its reciprocal, where a double is exact enough.
class Divisor {
 public:
    explicit Divisor(std::uint64_t divisor) : divisor_(divisor), reciprocal_(1 / static_cast<double>(divisor)) {}
    struct Parts {
        std::uint64_t quotient, rest;
    };
    Parts operator()(std::uint64_t n) const {
        if (n >= std::uint64_t{1} << 52) return {n / divisor_, n % divisor_};
        return exact(n, static_cast<std::uint64_t>(static_cast<double>(n) * reciprocal_));
    }
    // a b mod the divisor, which is at most 2^40, as both are. What product and multiple lack of 64 bits cancels.
    std::uint64_t product(std::uint64_t a, std::uint64_t b) const {
        return exact(a * b, static_cast<std::uint64_t>(static_cast<double>(a) * (static_cast<double>(b) * reciprocal_))).rest;
    }

 private:
    // With a quotient that is right to within one.
    Parts exact(std::uint64_t n, std::uint64_t quotient) const {
        const std::uint64_t rest = n - quotient * divisor_;
        if (static_cast<std::int64_t>(rest) < 0) return {quotient - 1, rest + divisor_};
        return rest < divisor_ ? Parts{quotient, rest} : Parts{quotient + 1, rest - divisor_};
    }

    std::uint64_t divisor_;
    double reciprocal_;
};

// Every W H samples visit each of the W x H pixels once, in the order of a rank-1 lattice that fills the film evenly from the first
// sample on. The samples of one pixel are a (0,2)-sequence in it.
class PixelLattice {
 public:
    // spec.sampler is kPixels.
    explicit PixelLattice(const PositionSamplerSpec& spec);

    // Column and row of the pixel, and how many samples it has had before.
    struct Place {
        std::uint32_t x, y;
        std::uint64_t pass;
    };
    Place place(std::uint64_t sample) const;
    std::uint64_t sample(const Place& place) const;  // mod 2^64
    FilmPosition position(const Place& place) const;

    // The pixels that touch a square of the film.
    struct Block {
        std::uint32_t x, y, width, height;
        // The places in it from the pass `first` on have the numbers 0, 1, ...: row by row, pass by pass.
        std::uint64_t number(const Place& place, std::uint64_t first) const {
            return ((place.pass - first) * height + (place.y - y)) * width + (place.x - x);
        }
        Place place(std::uint64_t number, std::uint64_t first) const {
            const std::uint64_t row = number / width;
            return {x + static_cast<std::uint32_t>(number % width), y + static_cast<std::uint32_t>(row % height),
                    first + row / height};
        }
        bool holds(const Place& place) const { return place.x - x < width && place.y - y < height; }
    };
    Block block(const FilmNode& node) const;

 private:
    std::uint32_t width_, height_;
    std::uint64_t pixels_;
    Divisor by_pixels_, by_width_;
    std::uint64_t first_ = 0;            // the pixel of sample 0
    std::uint64_t step_ = 0, back_ = 0;  // from one sample to the next pixel, and its inverse mod W H
    std::uint64_t key_;
};

}  // namespace latent::sampledb
