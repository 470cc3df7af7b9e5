#include "color/blue_noise.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "color/quantise_row.h"

namespace latent::color {
namespace {

constexpr int kSize = kBlueNoiseSize, kPlaces = kSize * kSize;
constexpr int kReach = 9;  // where a dot's energy has fallen below one

// Dots on a torus, and the energy that they give to each place: a Gaussian of 1.5 places.
class Dots {
 public:
    Dots() : energy_(kPlaces), set_(kPlaces) {
        for (int dy = -kReach; dy <= kReach; ++dy) {
            for (int dx = -kReach; dx <= kReach; ++dx)
                kernel_.push_back(std::llround(0x1p24 * std::exp(-(dx * dx + dy * dy) / (2 * 1.5 * 1.5))));
        }
    }

    void put(int place) { change(place, true, 1); }
    void take(int place) { change(place, false, -1); }
    // The dot among most others, and the place farthest from all dots; the first of equals.
    int tightest_cluster() const {
        return extreme(true, [](std::int64_t a, std::int64_t b) { return a > b; });
    }
    int largest_void() const {
        return extreme(false, [](std::int64_t a, std::int64_t b) { return a < b; });
    }

 private:
    void change(int place, bool is_set, int sign) {
        set_[static_cast<std::size_t>(place)] = is_set;
        const int x = place % kSize, y = place / kSize;
        auto weight = kernel_.begin();
        for (int dy = -kReach; dy <= kReach; ++dy) {
            for (int dx = -kReach; dx <= kReach; ++dx) {
                const int at = ((y + dy + kSize) % kSize) * kSize + (x + dx + kSize) % kSize;
                energy_[static_cast<std::size_t>(at)] += sign * *weight++;
            }
        }
    }
    template <class Better>
    int extreme(bool among, const Better& better) const {
        int best = -1;
        for (int i = 0; i < kPlaces; ++i) {
            const auto at = static_cast<std::size_t>(i);
            if (set_[at] == among && (best < 0 || better(energy_[at], energy_[static_cast<std::size_t>(best)]))) best = i;
        }
        return best;
    }

    std::vector<std::int64_t> kernel_, energy_;
    std::vector<char> set_;
};

std::array<BlueNoiseRow, kSize> ordered_by_void_and_cluster() {
    std::vector<int> places(kPlaces);
    std::iota(places.begin(), places.end(), 0);
    std::ranges::sort(places, {}, [](int place) { return mixed_bits(static_cast<std::uint32_t>(place)); });  // one to one
    constexpr int kFirst = kPlaces / 10;
    Dots pattern;
    for (int i = 0; i < kFirst; ++i) pattern.put(places[static_cast<std::size_t>(i)]);
    for (;;) {  // spread evenly
        const int cluster = pattern.tightest_cluster();
        pattern.take(cluster);
        const int hole = pattern.largest_void();
        pattern.put(hole);
        if (hole == cluster) break;
    }
    std::array<BlueNoiseRow, kSize> rows;
    const auto give = [&](int place, int rank) {
        BlueNoiseRow& row = rows[static_cast<std::size_t>(place / kSize)];
        const auto x = static_cast<std::size_t>(place % kSize);
        row[x] = row[x + kSize] = (static_cast<float>(rank) + 0.5F) / kPlaces;
    };
    Dots shrinking = pattern;
    for (int rank = kFirst - 1; rank >= 0; --rank) {
        const int place = shrinking.tightest_cluster();
        shrinking.take(place);
        give(place, rank);
    }
    for (int rank = kFirst; rank < kPlaces; ++rank) {
        const int place = pattern.largest_void();
        pattern.put(place);
        give(place, rank);
    }
    return rows;
}

}  // namespace

const std::array<BlueNoiseRow, kSize>& blue_noise() {
    static const std::array<BlueNoiseRow, kSize> rows = ordered_by_void_and_cluster();
    return rows;
}

}  // namespace latent::color
