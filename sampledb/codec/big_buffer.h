// sampledb/codec/big_buffer.h: memory for large arrays that are written before they are read, kept from one use to the next.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <span>
#include <type_traits>

namespace latent::sampledb {

// Neither cleared nor copied when it grows, and in large pages where the system has them: touching it costs a fault per 2 MiB.
template <class T>
class BigBuffer {
    static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

 public:
    T* data() const { return data_.get(); }
    T& operator[](std::size_t i) const { return data_.get()[i]; }

    // Makes room for `count` values, and a quarter more so that it seldom grows. What was there is gone if it had to grow.
    void reserve(std::size_t count) {
        if (count <= capacity_) return;
        capacity_ = count + count / 4;
        const std::size_t bytes = (capacity_ * sizeof(T) + kLargePage - 1) / kLargePage * kLargePage;
        data_.reset();
        data_.reset(static_cast<T*>(std::aligned_alloc(kLargePage, bytes)));
        if (!data_) throw std::bad_alloc();
        ::madvise(data_.get(), bytes, MADV_HUGEPAGE);  // a hint: any answer will do
    }

 private:
    static constexpr std::size_t kLargePage = std::size_t{2} << 20;
    struct Free {
        void operator()(T* memory) const { std::free(memory); }
    };

    std::unique_ptr<T, Free> data_;
    std::size_t capacity_ = 0;
};

}  // namespace latent::sampledb
