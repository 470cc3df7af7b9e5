// sampledb/read/damage.h: what is wrong with a file, by its bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "sampledb/data/unreadable.h"

namespace latent::sampledb {

struct Damage {
    std::uint64_t offset, size;  // bytes that hold no readable run
    std::string reason;          // "run 3: checksum mismatch, samples 65536:131072 lost"
    bool loss = true;            // false: nothing is lost by it
    std::uint64_t places = 1;    // that this entry stands for
};

// Adds to a list that stays short, however much is damaged: behind kMaxDamage entries one more stands for all others.
inline constexpr std::size_t kMaxDamage = 1000;
void add_damage(std::vector<Damage>& list, Damage damage);

}  // namespace latent::sampledb
