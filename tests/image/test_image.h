// tests/image/test_image.h: test pictures, a folder for each test, rows fed in pieces of every size.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include "base/file.h"
#include "image/row_writer.h"
#include "tests/faults/process.h"

namespace latent::image {

class FolderTest : public ::testing::Test {
 protected:
    testing::TemporaryFolder folder_;
    OutputFile output(const std::string& name) const { return std::move(*OutputFile::create(folder_ / name, false)); }
};

// Smooth with noise in the low bits: every filter and predictor has something to do.
inline std::uint32_t test_value(int x, int y, int c) {
    std::uint32_t h = static_cast<std::uint32_t>(x * 3 + c) * 2654435761u ^ static_cast<std::uint32_t>(y) * 2246822519u;
    h = (h ^ h >> 15) * 2654435769u;
    return static_cast<std::uint32_t>(x * 97 + y * 61 + c * 20000) + (h >> 25);
}

inline float test_float(int x, int y, int c) { return static_cast<float>(test_value(x, y, c)) * 1e-5f - 0.1f; }

// The rows of a test picture in `format`.
inline Bytes test_rows(const PixelFormat& format) {
    Bytes bytes(format.row_bytes() * static_cast<std::size_t>(format.height));
    std::size_t at = 0;
    for (int y = 0; y < format.height; ++y) {
        for (int i = 0; i < 3 * format.width; ++i) {
            const std::uint32_t value = test_value(i / 3, y, i % 3);
            const float number = test_float(i / 3, y, i % 3);
            const auto code8 = static_cast<std::uint8_t>(value >> 8);
            const auto code16 = static_cast<std::uint16_t>(value);
            const void* from = format.sample == SampleType::kU8    ? static_cast<const void*>(&code8)
                               : format.sample == SampleType::kU16 ? static_cast<const void*>(&code16)
                                                                   : &number;
            std::memcpy(bytes.data() + at, from, sample_bytes(format.sample));
            at += sample_bytes(format.sample);
        }
    }
    return bytes;
}

// Feeds all rows, `at_a_time` of them in each call, and names the file.
template <class Write>
Status feed(const Bytes& rows, std::size_t row_bytes, std::size_t at_a_time, const Write& write) {
    for (std::size_t at = 0; at < rows.size(); at += at_a_time * row_bytes) {
        if (Status s = write(ByteSpan(rows).subspan(at, std::min(at_a_time * row_bytes, rows.size() - at))); !s) return s;
    }
    return {};
}
inline Status write_all(RowWriter& writer, const Bytes& rows, std::size_t row_bytes, std::size_t at_a_time) {
    if (Status s = feed(rows, row_bytes, at_a_time, [&](ByteSpan some) { return writer.write_rows(some); }); !s) return s;
    if (Status s = writer.finish(); !s) return s;
    return writer.publish();
}

}  // namespace latent::image
