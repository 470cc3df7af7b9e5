// image/in_order.h: pieces are made by many threads and taken one by one in their order.
#pragma once

#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <cstddef>
#include <memory>
#include <utility>

#include "base/result.h"

namespace latent::image {

// For i = 0 .. count-1: `make(i)` on any thread, then `take(i, piece)` on one thread at a time, in the order of i. At most two
// pieces per thread exist at once. The first error ends it: later pieces are not taken.
template <class Make, class Take>
Status make_in_order(std::size_t count, const Make& make, const Take& take) {
    using Piece = decltype(make(std::size_t{0}));  // Result<T>
    struct Item {
        std::size_t index;
        Piece piece;
    };
    Status status;
    std::size_t next = 0;
    const std::size_t live = 2 * static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
    tbb::parallel_pipeline(live,
                           tbb::make_filter<void, std::size_t>(tbb::filter_mode::serial_in_order, [&](tbb::flow_control& flow) {
                               if (next == count) flow.stop();
                               return next == count ? count : next++;
                           }) & tbb::make_filter<std::size_t, Item*>(tbb::filter_mode::parallel, [&](std::size_t i) {
                               return new Item{i, make(i)};
                           }) & tbb::make_filter<Item*, void>(tbb::filter_mode::serial_in_order, [&](Item* made) {
                               const std::unique_ptr<Item> item(made);
                               if (!status) return;
                               if (!item->piece) {
                                   status = item->piece.error();
                               } else {
                                   status = take(item->index, std::move(*item->piece));
                               }
                           }));
    return status;
}

}  // namespace latent::image
