// sampledb/data/limits.h: the most that a file holds: checked before anything of that size is allocated. docs/format.md.
#pragma once

#include <cstddef>
#include <cstdint>

namespace latent::sampledb {

inline constexpr std::uint64_t kMaxHeaderSize = std::uint64_t{1} << 20;
inline constexpr std::uint64_t kMaxRunsPerFile = std::uint64_t{1} << 20;
inline constexpr std::uint64_t kMaxPagesPerRun = std::uint64_t{1} << 20;
inline constexpr std::uint64_t kMaxIntervalsPerRun = std::uint64_t{1} << 16;
inline constexpr std::uint64_t kMaxRecordsPerPage = 6144;                     // in any job; max_page_records says it for one
inline constexpr std::uint64_t kMaxPairsPerPage = 3072 * 28;                  // in all its records
inline constexpr std::uint64_t kMaxExtraPerPage = 6144 * 128;                 // bytes of its extra columns
inline constexpr std::uint64_t kMaxDecodedPage = std::uint64_t{2} << 20;      // for all its columns
inline constexpr std::uint64_t kMaxStoredOverhead = std::uint64_t{64} << 10;  // a stored page is at most this larger than decoded
inline constexpr std::size_t kMaxProvenanceSize = std::size_t{512} << 10;
inline constexpr std::size_t kMaxExtraColumns = 128;
inline constexpr std::size_t kFewExtraColumns = 16;  // what readers before version 0.2 take
inline constexpr std::size_t kMaxNameSize = 64;      // UTF-8 bytes of an extra column's name

}  // namespace latent::sampledb
