#include "base/in_order.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>

#include "base/parallel.h"

namespace latent {
namespace {

constexpr std::size_t kCount = 500;

// Some pieces take longer than all others that may exist beside them.
void dawdle(std::size_t i) {
    if (i % 17 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));
}

TEST(InOrder, PiecesAreTakenOneByOneInOrderAndFewExistAtOnce) {
    const Threads threads(4);
    std::atomic<std::size_t> begun{0};
    std::atomic<int> taking{0};
    std::size_t taken = 0;
    Status status;
    threads.run([&] {
        const std::size_t live = pieces_at_once();
        EXPECT_EQ(live, 8u);
        status = make_in_order(
            kCount,
            [&](std::size_t i) -> Result<std::size_t> {
                EXPECT_LT(begun++, kCount);
                dawdle(i);
                return 3 * i;
            },
            [&](std::size_t i, std::size_t piece) -> Status {
                EXPECT_EQ(taking++, 0);
                EXPECT_EQ(i, taken++);
                EXPECT_EQ(piece, 3 * i);
                EXPECT_LE(begun, i + live);
                dawdle(i + 1);
                --taking;
                return {};
            });
    });
    EXPECT_TRUE(status);
    EXPECT_EQ(taken, kCount);
}

TEST(InOrder, TheFirstErrorInOrderEndsItWhoeverMeetsIt) {
    const Threads threads(4);
    enum class Fault { kMakeReturns, kMakeThrows, kTakeReturns, kTakeThrows };
    for (const Fault fault : {Fault::kMakeReturns, Fault::kMakeThrows, Fault::kTakeReturns, Fault::kTakeThrows}) {
        const bool of_make = fault == Fault::kMakeReturns || fault == Fault::kMakeThrows;
        std::size_t taken = 0;
        Status status;
        const auto fail = [&]() -> Error {
            if (fault == Fault::kMakeThrows || fault == Fault::kTakeThrows) throw std::runtime_error("piece 100");
            return {ErrorCode::kIo, "piece 100"};
        };
        threads.run([&] {
            status = make_in_order(
                kCount,
                [&](std::size_t i) -> Result<int> {
                    dawdle(i);
                    if (of_make && i == 100) return fail();
                    return 0;
                },
                [&](std::size_t i, int) -> Status {
                    if (!of_make && i == 100) return fail();
                    ++taken;
                    return {};
                });
        });
        ASSERT_FALSE(status);
        EXPECT_NE(status.error().message.find("piece 100"), std::string::npos) << status.error().message;
        EXPECT_EQ(taken, 100u);
    }
}

}  // namespace
}  // namespace latent
