// What a web server answers when it is asked for a range of a file: the lines of its header up to an empty one, then bytes.
#include <algorithm>
#include <cstring>
#include <limits>

#include "sampledb/http/range_answer.h"
#include "tests/fuzz/target.h"

namespace latent::fuzz {

namespace {

using namespace sampledb;

constexpr std::uint64_t kOffset = 1000, kSize = 100;

// The first byte chooses whether the file was opened before. Then, as often as there is another header: its lines and the bytes
// behind.
bool run_http(ByteSpan input) {
    if (input.empty()) return false;
    const RemoteVersion opened{2000, "Thu, 01 Jan 1970 00:00:00 GMT"};
    const bool is_open = (std::to_integer<int>(input[0]) & 1) != 0;
    std::string_view text = text_of(input.subspan(1));
    Bytes got;
    RangeAnswer answer(is_open ? kOffset : 0, kSize, is_open ? &opened : nullptr, got);
    bool goes_on = true;
    while (goes_on && !text.empty()) {
        for (bool in_header = true; goes_on && in_header && !text.empty();) {
            const std::size_t size = std::min(text.find('\n'), text.size() - 1) + 1;
            goes_on = answer.take_header(text.substr(0, size));
            in_header = text.substr(0, size).find_first_not_of("\r\n") != text.npos;
            text.remove_prefix(size);
        }
        const std::size_t size = std::min(text.find("HTTP/"), text.size());
        for (std::size_t begin = 0; goes_on && begin < size; begin += 37) {
            const std::string_view piece = text.substr(begin, std::min<std::size_t>(37, size - begin));
            goes_on = answer.take_bytes({reinterpret_cast<const std::byte*>(piece.data()), piece.size()});
        }
        text.remove_prefix(size);
    }
    require(got.size() <= kSize, "no more bytes are taken than were asked for");
    if (answer.version()) {
        require(answer.version()->size <= std::numeric_limits<std::int64_t>::max(), "sizes are those of files");
        require(got.empty() || (is_open ? kOffset : 0) + got.size() <= answer.version()->size, "bytes are those of the file");
    }
    if (!answer.verdict(goes_on)) return false;
    return (answer.status() == 206 || answer.status() == 416) && answer.version();
}

std::vector<Bytes> http_seeds() {
    const std::string bytes(kSize, 'x');
    const std::string texts[] = {
        "0HTTP/1.1 206 Partial Content\r\nLast-Modified: Thu, 01 Jan 1970 00:00:00 GMT\r\nContent-Range: bytes 0-99/2000\r\n\r\n" +
            bytes,
        "1HTTP/1.1 206 Partial Content\r\nContent-Range: bytes 1000-1099/2000\r\nContent-Encoding: identity\r\n\r\n" + bytes,
        "1HTTP/1.1 206\r\ncontent-range:bytes 1000-1049/3000\r\n\r\n" + bytes.substr(50),
        "1HTTP/1.1 302 Found\r\nLocation: /a\r\nContent-Range: bytes 5-6/7\r\n\r\nHTTP/1.1 100 Continue\r\n\r\nHTTP/1.1 206 x\r\n"
        "Content-Range: bytes 1000-1099/2000\r\n\r\n" +
            bytes,
        "0HTTP/1.1 416 x\r\nContent-Range: bytes */0\r\n\r\n"};
    std::vector<Bytes> seeds;
    for (const std::string& text : texts) {
        const auto* begin = reinterpret_cast<const std::byte*>(text.data());
        seeds.emplace_back(begin, begin + text.size());
    }
    return seeds;
}

}  // namespace

Target http() { return {"http", run_http, nullptr, true, 10000, http_seeds}; }

}  // namespace latent::fuzz
