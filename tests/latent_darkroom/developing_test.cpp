// Pictures that several wait for, or nobody any more.
#include "tools/darkroom/engine/developing.h"

#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <thread>

namespace latent::testing {
namespace {

using darkroom::Developing;
using darkroom::KeptPicture;

// Work that goes on until it may end, or is given up.
struct Piece {
    std::atomic<int> begun = 0;
    std::atomic<bool> may_end = false, given_up = false;

    Developing::Work work() {
        return [this](const Stopped& stopped) -> Developing::Made {
            ++begun;
            while (!may_end) {
                if (stopped()) {
                    given_up = true;
                    return latent::given_up();
                }
                std::this_thread::sleep_for(std::chrono::milliseconds(1));
            }
            return std::make_shared<const KeptPicture>();
        };
    }
    void wait_until_begun() const {
        while (begun == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
};

std::future<Developing::Made> ask(Developing& developing, const std::string& key, Piece& piece, const Stopped& stopped = {}) {
    return std::async(std::launch::async, [&, key, stopped] { return developing.wait_for(key, piece.work(), stopped); });
}

TEST(Developing, AllWhoAskForTheSameWaitForOnePiece) {
    Developing developing;
    Piece piece;
    auto first = ask(developing, "a", piece);
    piece.wait_until_begun();
    auto second = ask(developing, "a", piece);
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    piece.may_end = true;
    const Developing::Made one = first.get(), other = second.get();
    ASSERT_TRUE(one && other);
    EXPECT_EQ(piece.begun, 1);
    EXPECT_EQ(*one, *other);
}

TEST(Developing, WhatNobodyWaitsForMakesRoomForAnother) {
    Developing developing;
    Piece old, fresh;
    std::atomic<bool> superseded = false;
    auto first = ask(developing, "a", old, [&] { return superseded.load(); });
    old.wait_until_begun();
    fresh.may_end = true;
    auto second = ask(developing, "b", fresh);
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    EXPECT_EQ(fresh.begun, 0);  // one at a time
    superseded = true;
    EXPECT_EQ(first.get().error().code, ErrorCode::kStopped);
    EXPECT_TRUE(second.get());
    EXPECT_TRUE(old.given_up);
}

TEST(Developing, WhoComesBackForTheSameFindsItGoingOn) {
    Developing developing;
    Piece piece;
    std::atomic<bool> superseded = false;
    auto first = ask(developing, "a", piece, [&] { return superseded.load(); });
    piece.wait_until_begun();
    auto second = ask(developing, "a", piece);
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    superseded = true;
    EXPECT_FALSE(first.get());
    piece.may_end = true;
    EXPECT_TRUE(second.get());
    EXPECT_EQ(piece.begun, 1);
    EXPECT_FALSE(piece.given_up);
}

TEST(Developing, WhatWaitsInTheQueueIsNotBegunForNobody) {
    Developing developing;
    Piece running, queued;
    auto first = ask(developing, "a", running);
    running.wait_until_begun();
    EXPECT_FALSE(ask(developing, "b", queued, [] { return true; }).get());
    running.may_end = true;
    EXPECT_TRUE(first.get());
    Piece last;
    last.may_end = true;
    EXPECT_TRUE(ask(developing, "c", last).get());
    EXPECT_EQ(queued.begun, 0);
}

TEST(Developing, ItsEndDoesNotWaitForThePiece) {
    Piece piece;
    {
        Developing developing;
        EXPECT_FALSE(developing.wait_for("a", piece.work(), [&] { return piece.begun > 0; }));
    }
    EXPECT_TRUE(piece.given_up);
}

TEST(Developing, AnExceptionIsAnError) {
    Developing developing;
    const auto made = developing.wait_for("a", [](const Stopped&) -> Developing::Made { throw std::bad_alloc(); }, {});
    ASSERT_FALSE(made);
    EXPECT_EQ(made.error().code, ErrorCode::kNoMemory);
}

}  // namespace
}  // namespace latent::testing
