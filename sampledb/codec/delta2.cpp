#include "sampledb/codec/delta2.h"

#include <array>
#include <bit>
#include <cstddef>

#include "sampledb/codec/four_by_four.h"
#include "sampledb/codec/zigzag.h"

namespace latent::sampledb {

void to_delta2(std::span<const float> values, std::span<const std::uint16_t> pairs, unsigned step, std::span<std::uint32_t> words) {
    std::size_t at = 0;
    for (const std::uint16_t n : pairs) {
        std::uint32_t before = 0, slope = 0;
        for (std::uint16_t i = 0; i < n; ++i, ++at) {
            const std::uint32_t bits = std::bit_cast<std::uint32_t>(values[at]);
            words[at] = i == 0 ? bits >> step : zigzag(bits - before - slope, step);
            slope = i == 0 ? 0 : bits - before;
            before = bits;
        }
    }
}

namespace {

namespace hn = hwy::HWY_NAMESPACE;

// The values of records from their second differences: those of four records of equal length at once, one record in each lane.
class Sums {
 public:
    Sums(std::span<const std::uint32_t> words, unsigned step, std::span<float> values)
        : words_(words.data()), step_(step), values_(values.data()) {}

    // The next record, of n values.
    void add(std::size_t n) {
        if (n < 4) {
            add_up_one(at_, n);
        } else {
            if (n != length_) finish();
            length_ = n;
            starts_[count_++] = at_;
            if (count_ == 4) add_up_four();
        }
        at_ += n;
    }
    // Those that are fewer than four.
    void finish() {
        for (std::size_t i = 0; i < count_; ++i) add_up_one(starts_[i], length_);
        count_ = 0;
    }

 private:
    void add_up_one(std::size_t at, std::size_t n, std::size_t i = 0, std::uint32_t bits = 0, std::uint32_t slope = 0) const {
        for (; i < n; ++i) {
            slope = i == 0 ? 0 : slope + unzigzag(words_[at + i], step_);
            bits = i == 0 ? words_[at] << step_ : bits + slope;
            values_[at + i] = std::bit_cast<float>(bits);
        }
    }

    void add_up_four() {
        const four::Tag tag;
        const int step = static_cast<int>(step_);
        Four bits = hn::Zero(tag), slope = hn::Zero(tag);
        const auto next = [&](Four& coded) {
            const Four sign = hn::Sub(hn::Zero(tag), hn::And(coded, hn::Set(tag, 1)));
            slope = hn::Add(slope, hn::ShiftLeftSame(hn::Xor(hn::ShiftRight<1>(coded), sign), step));
            coded = bits = hn::Add(bits, slope);
        };
        std::size_t i = 0;
        for (; i + 4 <= length_; i += 4) {
            const auto words = [&](std::size_t record) { return load(words_ + starts_[record] + i); };
            FourByFour at = FourByFour{words(0), words(1), words(2), words(3)}.transposed();
            if (i == 0) {
                at.a = bits = hn::ShiftLeftSame(at.a, step);
            } else {
                next(at.a);
            }
            next(at.b), next(at.c), next(at.d);
            at = at.transposed();
            const auto values = [&](std::size_t record) { return values_ + starts_[record] + i; };
            store(at.a, values(0)), store(at.b, values(1)), store(at.c, values(2)), store(at.d, values(3));
        }
        std::array<std::uint32_t, 4> before, difference;
        store(bits, before.data());
        store(slope, difference.data());
        for (std::size_t r = 0; r < 4 && i < length_; ++r) add_up_one(starts_[r], length_, i, before[r], difference[r]);
        count_ = 0;
    }

    const std::uint32_t* words_;
    unsigned step_;
    float* values_;
    std::size_t at_ = 0;
    std::size_t length_ = 0, count_ = 0;  // records that wait
    std::array<std::size_t, 4> starts_{};
};

}  // namespace

void from_delta2(std::span<const std::uint32_t> words, std::span<const std::uint16_t> pairs, unsigned step,
                 std::span<float> values) {
    Sums sums(words, step, values);
    for (const std::uint16_t n : pairs) sums.add(n);
    sums.finish();
}

}  // namespace latent::sampledb
