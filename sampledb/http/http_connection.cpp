#include "sampledb/http/http_connection.h"

#include <curl/curl.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <chrono>
#include <optional>
#include <string_view>
#include <thread>

#include "base/url.h"
#include "sampledb/http/certificates.h"

namespace latent::sampledb {

namespace {

constexpr int kMostTries = 64;       // of one range, even if each brings some bytes
constexpr double kLongestWait = 30;  // seconds, whatever the server asks for
constexpr long kMostRedirections = 10;

// "bytes 0-4095/1000000"
struct ContentRange {
    std::uint64_t first = 0, file_size = 0;
};
std::optional<ContentRange> parse_content_range(std::string_view text) {
    ContentRange range;
    const auto number = [&](std::string_view before, std::uint64_t& value) {
        if (!text.starts_with(before)) return false;
        text.remove_prefix(before.size());
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        if (error != std::errc()) return false;
        text.remove_prefix(static_cast<std::size_t>(end - text.data()));
        return true;
    };
    std::uint64_t last = 0;
    if (text.starts_with("bytes */")) return number("bytes */", range.file_size) ? std::optional(range) : std::nullopt;
    const bool whole = number("bytes ", range.first) && number("-", last) && number("/", range.file_size);
    return whole && range.first <= last && last < range.file_size ? std::optional(range) : std::nullopt;
}

bool is_passing(long status) { return status >= 500 || status == 408 || status == 429; }

// What another attempt would not mend.
bool is_final(CURLcode code) {
    return code == CURLE_URL_MALFORMAT || code == CURLE_UNSUPPORTED_PROTOCOL || code == CURLE_TOO_MANY_REDIRECTS ||
           code == CURLE_PEER_FAILED_VERIFICATION || code == CURLE_SSL_CERTPROBLEM || code == CURLE_LOGIN_DENIED;
}

void wait(double seconds, const std::atomic<bool>& stop) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (!stop && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(std::chrono::milliseconds(20));
}

}  // namespace

struct HttpConnection::Handle {
    CURL* curl = nullptr;
    char message[CURL_ERROR_SIZE] = "";

    Handle() {
        static const CURLcode once = curl_global_init(CURL_GLOBAL_DEFAULT);
        if (once == CURLE_OK) curl = curl_easy_init();
    }
    Handle(const Handle&) = delete;
    Handle& operator=(const Handle&) = delete;
    ~Handle() {
        if (curl != nullptr) curl_easy_cleanup(curl);
    }
};

// What came of one request, beside its bytes.
struct HttpConnection::Answer {
    CURL* curl;
    std::uint64_t offset, size;  // asked for
    Bytes& into;
    const std::atomic<bool>& stop;
    CURLcode code = CURLE_OK;
    long status = 0;
    double retry_after = 0;
    std::optional<ContentRange> range{};
    bool unfit = false;  // the bytes are not those that were asked for

    static std::size_t take_header(char* text, std::size_t, std::size_t length, void* self) {
        auto& answer = *static_cast<Answer*>(self);
        std::string line(text, length);
        std::ranges::transform(line, line.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        constexpr std::string_view kRange = "content-range:";
        if (line.starts_with("http/")) answer.range.reset();  // another answer, after a redirection
        if (line.starts_with(kRange)) {
            const std::size_t value = line.find_first_not_of(" \t", kRange.size());
            if (value != std::string::npos) answer.range = parse_content_range(std::string_view(line).substr(value));
        }
        return length;
    }

    static std::size_t take_bytes(char* bytes, std::size_t, std::size_t count, void* self) {
        auto& answer = *static_cast<Answer*>(self);
        long status = 0;
        curl_easy_getinfo(answer.curl, CURLINFO_RESPONSE_CODE, &status);
        if (status / 100 != 2) return count;  // the page of an error
        answer.unfit = status != 206 || !answer.range || answer.range->first != answer.offset || count > answer.size;
        if (answer.unfit) return 0;
        const auto* from = reinterpret_cast<const std::byte*>(bytes);
        answer.into.insert(answer.into.end(), from, from + count);
        answer.size -= count;
        return count;
    }

    static int is_to_stop(void* self, curl_off_t, curl_off_t, curl_off_t, curl_off_t) {
        return static_cast<Answer*>(self)->stop ? 1 : 0;
    }
};

HttpConnection::HttpConnection(const Patience& patience) : handle_(std::make_unique<Handle>()), patience_(patience) {
    if (handle_->curl == nullptr) return;
    const auto set = [this](CURLoption option, auto value) { curl_easy_setopt(handle_->curl, option, value); };
    set(CURLOPT_NOSIGNAL, 1L);
    set(CURLOPT_ERRORBUFFER, handle_->message);
    set(CURLOPT_USERAGENT, "latent/" LATENT_VERSION);
    set(CURLOPT_PROTOCOLS_STR, "http,https");
    set(CURLOPT_REDIR_PROTOCOLS_STR, "http,https");
    if (const char* const file = certificate_file()) set(CURLOPT_CAINFO, file);
    set(CURLOPT_FOLLOWLOCATION, 1L);
    set(CURLOPT_MAXREDIRS, kMostRedirections);
    set(CURLOPT_HTTP_VERSION, long{CURL_HTTP_VERSION_1_1});
    set(CURLOPT_NETRC, long{CURL_NETRC_OPTIONAL});
    set(CURLOPT_CONNECTTIMEOUT, long{patience.connect_seconds});
    set(CURLOPT_LOW_SPEED_LIMIT, 1L);
    set(CURLOPT_LOW_SPEED_TIME, long{patience.stalled_seconds});
    set(CURLOPT_NOPROGRESS, 0L);
    set(CURLOPT_HEADERFUNCTION, &Answer::take_header);
    set(CURLOPT_WRITEFUNCTION, &Answer::take_bytes);
    set(CURLOPT_XFERINFOFUNCTION, &Answer::is_to_stop);
}

HttpConnection::~HttpConnection() = default;

HttpConnection::Answer HttpConnection::ask(const std::string& url, std::uint64_t offset, std::uint64_t size, Bytes& into,
                                           const std::atomic<bool>& stop) {
    Answer answer{.curl = handle_->curl, .offset = offset, .size = size, .into = into, .stop = stop};
    const std::string range = fmt::format("{}-{}", offset, offset + size - 1);
    const auto set = [this](CURLoption option, auto value) { curl_easy_setopt(handle_->curl, option, value); };
    set(CURLOPT_URL, url.c_str());
    set(CURLOPT_RANGE, range.c_str());
    set(CURLOPT_HEADERDATA, &answer);
    set(CURLOPT_WRITEDATA, &answer);
    set(CURLOPT_XFERINFODATA, &answer);
    handle_->message[0] = '\0';
    answer.code = curl_easy_perform(handle_->curl);
    curl_easy_getinfo(handle_->curl, CURLINFO_RESPONSE_CODE, &answer.status);
    curl_off_t seconds = 0;
    curl_easy_getinfo(handle_->curl, CURLINFO_RETRY_AFTER, &seconds);
    answer.retry_after = static_cast<double>(seconds);
    return answer;
}

Result<Fetched> HttpConnection::get(const std::string& url, std::uint64_t offset, std::uint64_t size,
                                    const std::atomic<bool>& stop) {
    const auto fail = [&](ErrorCode code, std::string_view what) {
        return Error{code, fmt::format("{}: {}", shown_name(url), what)};
    };
    if (handle_->curl == nullptr) return fail(ErrorCode::kNoMemory, "libcurl cannot be used: out of memory");
    Fetched got;
    double pause = patience_.first_wait;
    for (int tries = 0, all = 0;; pause *= 2) {
        const std::uint64_t before = got.bytes.size();
        const Answer answer = ask(url, offset + before, size - before, got.bytes, stop);
        const std::uint64_t here = got.bytes.size();
        if (stop) return fail(ErrorCode::kStopped, "given up");
        if (answer.range) {
            got.file_size = answer.range->file_size;
            if (here == size || (here > 0 && offset + here == got.file_size)) return got;
        }
        if (answer.unfit && answer.status == 200)
            return fail(ErrorCode::kIo, "the server sends only whole files; it must support range requests");
        if (answer.unfit) return fail(ErrorCode::kIo, "the server returned another range of bytes than the one requested");
        if (answer.status == 416) {
            if (answer.range && offset + before == 0) return got;  // an empty file
            return fail(ErrorCode::kTruncated, fmt::format("ends before byte {}", offset + before));
        }
        if (answer.status == 404 || answer.status == 410) return fail(ErrorCode::kNotFound, "there is no such file on the server");
        if (answer.status == 401 || answer.status == 403)
            return fail(ErrorCode::kIo, fmt::format("the server refuses access (status {})", answer.status));
        std::string what = handle_->message[0] != '\0' ? handle_->message : curl_easy_strerror(answer.code);
        if (is_final(answer.code)) return fail(ErrorCode::kIo, "cannot be read: " + what);
        if (answer.code == CURLE_OK) what = fmt::format("the server answers with status {}", answer.status);
        if (answer.code == CURLE_OK && answer.status / 100 != 2 && !is_passing(answer.status)) return fail(ErrorCode::kIo, what);
        if (here > before) tries = 0, pause = patience_.first_wait;
        if (++tries >= patience_.tries || ++all >= kMostTries)
            return fail(ErrorCode::kIo, fmt::format("cannot be read at byte {}: {} (tried {} times)", offset + here, what, tries));
        wait(std::min(std::max(pause, answer.retry_after), kLongestWait), stop);
    }
}

}  // namespace latent::sampledb
