#include "base/slot_file.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

namespace latent {
namespace {

TEST(SlotFile, GivesBackWhatWasPutWhetherItWaitedInMemoryOrInTheFile) {
    SlotFile slots(std::filesystem::temp_directory_path(), 100, 1000);
    std::map<std::uint64_t, Bytes> kept;
    std::mt19937 random(3);
    for (int i = 0; i < 5000; ++i) {
        const std::uint64_t key = random() % 50;
        Bytes record(100);
        const Result<bool> taken = slots.take(key, record);
        ASSERT_TRUE(taken);
        ASSERT_EQ(*taken, kept.contains(key));
        if (*taken) {
            EXPECT_EQ(record, kept[key]);
            kept.erase(key);
        } else {
            for (std::byte& b : record) b = static_cast<std::byte>(random());
            ASSERT_TRUE(slots.put(key, record));
            kept[key] = record;
        }
    }
    EXPECT_GT(slots.bytes_on_disk(), 0u);
    EXPECT_LE(slots.bytes_on_disk(), 40u * 100u) << "slots that were freed are used again";
}

TEST(SlotFile, RecordsMayBeEmpty) {
    SlotFile slots(std::filesystem::temp_directory_path(), 0, 1000);
    ASSERT_TRUE(slots.put(1, {}));
    EXPECT_TRUE(slots.take(1, {}).value());
    EXPECT_FALSE(slots.take(1, {}).value());
}

TEST(SlotFile, NeedsNoFileWhileEverythingFitsInMemory) {
    SlotFile slots("/nowhere", 8, 80);
    Bytes record(8);
    for (std::uint64_t key = 0; key < 10; ++key) ASSERT_TRUE(slots.put(key, record));
    EXPECT_EQ(slots.bytes_on_disk(), 0u);
    EXPECT_FALSE(slots.put(10, record));
}

}  // namespace
}  // namespace latent
