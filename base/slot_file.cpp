#include "base/slot_file.h"

#include <algorithm>
#include <cassert>
#include <functional>

namespace latent {

namespace {
constexpr std::uint64_t kMaxMemorySlots = 1 << 20;  // their places are made at once
}

SlotFile::SlotFile(std::filesystem::path folder, std::size_t record_bytes, std::uint64_t memory)
    : folder_(std::move(folder)),
      record_bytes_(record_bytes),
      memory_slots_(record_bytes == 0 ? 0 : std::min(memory / record_bytes, kMaxMemorySlots)),
      memory_(memory_slots_) {}

Status SlotFile::put(std::uint64_t key, ByteSpan record) {
    assert(record.size() == record_bytes_);
    std::uint64_t slot;
    {
        const std::lock_guard lock(mutex_);
        if (free_.empty()) {
            slot = slot_count_++;
        } else {
            std::pop_heap(free_.begin(), free_.end(), std::greater{});
            slot = free_.back();
            free_.pop_back();
        }
        if (slot >= memory_slots_) {
            if (!file_.is_open()) {
                Result<File> file = File::create_unnamed(folder_);
                if (!file) return file.error();
                file_ = std::move(*file);
            }
            disk_high_water_ = std::max(disk_high_water_, (slot - memory_slots_ + 1) * record_bytes_);
        }
        slots_[key] = slot;
    }
    if (slot >= memory_slots_) return file_.write_all((slot - memory_slots_) * record_bytes_, record);
    memory_[slot].assign(record.begin(), record.end());
    return {};
}

Result<bool> SlotFile::take(std::uint64_t key, std::span<std::byte> record) {
    assert(record.size() == record_bytes_);
    std::uint64_t slot;
    {
        const std::lock_guard lock(mutex_);
        const auto found = slots_.find(key);
        if (found == slots_.end()) return false;
        slot = found->second;
        slots_.erase(found);
    }
    if (slot >= memory_slots_) {
        if (Status s = file_.read_exact((slot - memory_slots_) * record_bytes_, record); !s) return s.error();
    } else {
        std::copy(memory_[slot].begin(), memory_[slot].end(), record.begin());
    }
    const std::lock_guard lock(mutex_);
    free_.push_back(slot);
    std::push_heap(free_.begin(), free_.end(), std::greater{});
    return true;
}

}  // namespace latent
