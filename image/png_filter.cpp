#include "image/png_filter.h"

#include <array>
#include <cstdlib>
#include <cstring>

// Compiled with vectorisation (image/CMakeLists.txt): every loop is over independent bytes, as the encoder knows all neighbours.
namespace latent::image {

namespace {

using U8 = unsigned char;

// a: left, b: above, c: above left.
struct Up {
    static U8 predict(int, int b, int) { return static_cast<U8>(b); }
};
struct Sub {
    static U8 predict(int a, int, int) { return static_cast<U8>(a); }
};
struct Average {
    static U8 predict(int a, int b, int) { return static_cast<U8>((a + b) >> 1); }
};
struct Paeth {
    static U8 predict(int a, int b, int c) {
        const int pa = std::abs(b - c), pb = std::abs(a - c), pc = std::abs(a + b - 2 * c);
        return static_cast<U8>(pa <= pb && pa <= pc ? a : pb <= pc ? b : c);
    }
};

template <class Filter>
void apply(const U8* row, const U8* above, std::size_t size, std::size_t pixel, U8* out) {
    for (std::size_t i = 0; i < pixel && i < size; ++i) out[i] = static_cast<U8>(row[i] - Filter::predict(0, above[i], 0));
    for (std::size_t i = pixel; i < size; ++i) {
        out[i] = static_cast<U8>(row[i] - Filter::predict(row[i - pixel], above[i], above[i - pixel]));
    }
}

std::size_t cost(const U8* bytes, std::size_t size) {
    std::size_t sum = 0;
    while (size > 0) {
        const std::size_t part = size < 4096 ? size : 4096;
        unsigned partial = 0;
        for (std::size_t i = 0; i < part; ++i) partial += static_cast<unsigned>(std::abs(static_cast<signed char>(bytes[i])));
        sum += partial;
        bytes += part;
        size -= part;
    }
    return sum;
}

}  // namespace

void filter_row(ByteSpan row, ByteSpan above, std::size_t pixel_bytes, std::byte* out) {
    const std::size_t size = row.size();
    thread_local std::vector<U8> buffer;
    buffer.assign(6 * size, 0);
    const U8* in = reinterpret_cast<const U8*>(row.data());
    const U8* up = above.empty() ? buffer.data() + 5 * size : reinterpret_cast<const U8*>(above.data());
    U8* filtered[4] = {buffer.data(), buffer.data() + size, buffer.data() + 2 * size, buffer.data() + 3 * size};
    apply<Sub>(in, up, size, pixel_bytes, filtered[0]);
    apply<Up>(in, up, size, pixel_bytes, filtered[1]);
    apply<Average>(in, up, size, pixel_bytes, filtered[2]);
    apply<Paeth>(in, up, size, pixel_bytes, filtered[3]);
    std::size_t best = 0, least = cost(in, size);
    const U8* chosen = in;
    for (std::size_t i = 0; i < 4; ++i) {
        const std::size_t c = cost(filtered[i], size);
        if (c >= least) continue;
        least = c;
        best = i + 1;
        chosen = filtered[i];
    }
    out[0] = std::byte(best);
    std::memcpy(out + 1, chosen, size);
}

}  // namespace latent::image
