// base/slot_file.h: records of one size that wait for a later use: the first few in memory, the rest in an unnamed file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "base/file.h"
#include "base/result.h"

namespace latent {

// Thread-safe, except that one key is used by one thread at a time.
class SlotFile {
 public:
    // The file, if one is needed, lies in `folder` and has no name. About `memory` bytes of records stay in memory.
    SlotFile(std::filesystem::path folder, std::size_t record_bytes, std::uint64_t memory);

    // Keeps `record` (of record_bytes) under `key`, which must be free.
    Status put(std::uint64_t key, ByteSpan record);
    // Copies the record of `key` into `record` and frees the key; false if there is none.
    Result<bool> take(std::uint64_t key, std::span<std::byte> record);

    std::uint64_t bytes_on_disk() const { return disk_high_water_; }

 private:
    std::filesystem::path folder_;
    std::size_t record_bytes_;
    std::uint64_t memory_slots_;
    std::mutex mutex_;
    std::unordered_map<std::uint64_t, std::uint64_t> slots_;  // key -> slot
    std::vector<std::uint64_t> free_;                         // slots that were used before, as a heap: lowest first
    std::uint64_t slot_count_ = 0;
    std::uint64_t disk_high_water_ = 0;
    std::vector<Bytes> memory_;  // slots 0 .. memory_slots_ - 1
    File file_;                  // the others
};

}  // namespace latent
