// render/spectral/arena.h: room for the values of one sample in every wavelength, used again by the next sample.
#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <type_traits>
#include <vector>

#include "render/spectral/sampled_spectrum.h"

namespace latent::render {

// Grows to what the largest sample needs. Not for several threads at once.
class SpectrumArena {
 public:
    // Not initialised; stays where it is until clear().
    SampledSpectrum& allocate() { return *allocate(1); }
    // A copy of `value` in the room of one sample.
    template <class T>
    const T& store(const T& value) {
        static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);
        constexpr std::size_t count = (sizeof(T) + sizeof(SampledSpectrum) - 1) / sizeof(SampledSpectrum);
        static_assert(count <= kBlock && alignof(T) <= alignof(SampledSpectrum));
        return *new (allocate(count)) T(value);
    }
    void clear() { used_ = 0; }

 private:
    static constexpr std::size_t kBlock = 64;

    // One behind the other.
    SampledSpectrum* allocate(std::size_t count) {
        if (used_ % kBlock + count > kBlock) used_ += kBlock - used_ % kBlock;
        if (used_ == blocks_.size() * kBlock) blocks_.push_back(std::make_unique_for_overwrite<SampledSpectrum[]>(kBlock));
        SampledSpectrum* first = &blocks_[used_ / kBlock][used_ % kBlock];
        used_ += count;
        return first;
    }

    std::vector<std::unique_ptr<SampledSpectrum[]>> blocks_;
    std::size_t used_ = 0;
};

}  // namespace latent::render
