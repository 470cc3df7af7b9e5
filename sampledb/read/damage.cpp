#include "sampledb/read/damage.h"

#include <fmt/format.h>

#include <algorithm>

namespace latent::sampledb {

void add_damage(std::vector<Damage>& list, Damage damage) {
    if (list.size() < kMaxDamage) return list.push_back(std::move(damage));
    if (list.size() == kMaxDamage) {
        list.push_back(std::move(damage));
    } else {
        Damage& others = list.back();
        const std::uint64_t end = std::max(others.offset + others.size, damage.offset + damage.size);
        others.offset = std::min(others.offset, damage.offset);
        others.size = end - others.offset;
        others.loss |= damage.loss;
        others.places += damage.places;
    }
    Damage& others = list.back();
    others.reason = fmt::format("{} more, in bytes {}..{}", others.places, others.offset, others.offset + others.size);
}

}  // namespace latent::sampledb
