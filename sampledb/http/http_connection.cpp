#include "sampledb/http/http_connection.h"

#include <curl/curl.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <string_view>
#include <thread>

#include "base/stopwatch.h"
#include "base/url.h"
#include "sampledb/http/certificates.h"

namespace latent::sampledb {

namespace {

constexpr int kMaxAnswers = 64;      // for one range, even if each brings some bytes
constexpr double kLongestWait = 10;  // seconds between two tries, whatever the server asks for
constexpr double kSlowest = 1024;    // bytes per second, which a connection may lag behind for a time
constexpr long kMaxRedirections = 10;

// What another try would not mend.
bool is_final(CURLcode code) {
    return code == CURLE_URL_MALFORMAT || code == CURLE_UNSUPPORTED_PROTOCOL || code == CURLE_TOO_MANY_REDIRECTS ||
           code == CURLE_PEER_FAILED_VERIFICATION || code == CURLE_SSL_CERTPROBLEM || code == CURLE_LOGIN_DENIED;
}

// A request on its way, for the functions that libcurl calls.
struct Request {
    RangeAnswer answer;
    const Stopwatch& since_first_try;
    double seconds;  // on that watch: when time is up if no byte comes
    const std::atomic<bool>& stop;

    bool is_late() const { return since_first_try.seconds() > seconds + static_cast<double>(answer.received()) / kSlowest; }

    static std::size_t take_header(char* text, std::size_t, std::size_t size, void* self) {
        return static_cast<Request*>(self)->answer.take_header({text, size}) ? size : 0;
    }
    static std::size_t take_bytes(char* bytes, std::size_t, std::size_t size, void* self) {
        return static_cast<Request*>(self)->answer.take_bytes({reinterpret_cast<const std::byte*>(bytes), size}) ? size : 0;
    }
    static int is_to_end(void* self, curl_off_t, curl_off_t, curl_off_t, curl_off_t) {
        const auto& request = *static_cast<Request*>(self);
        return request.stop || request.is_late() ? 1 : 0;
    }
};

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

    void set(CURLoption option, auto value) { curl_easy_setopt(curl, option, value); }

    CURLcode perform(const std::string& url, const std::string& range, Request& request) {
        const bool is_https = url.size() > 4 && (url[4] == 's' || url[4] == 'S');
        set(CURLOPT_URL, url.c_str());
        set(CURLOPT_REDIR_PROTOCOLS_STR, is_https ? "https" : "http,https");
        set(CURLOPT_RANGE, range.c_str());
        set(CURLOPT_HEADERDATA, &request);
        set(CURLOPT_WRITEDATA, &request);
        set(CURLOPT_XFERINFODATA, &request);
        message[0] = '\0';
        return curl_easy_perform(curl);
    }

    // Seconds; 0: the server does not ask for any.
    double wait_asked_for() const {
        curl_off_t seconds = 0;
        curl_easy_getinfo(curl, CURLINFO_RETRY_AFTER, &seconds);
        return static_cast<double>(seconds);
    }
};

HttpConnection::HttpConnection(const Patience& patience) : handle_(std::make_unique<Handle>()), patience_(patience) {
    if (handle_->curl == nullptr) return;
    Handle& handle = *handle_;
    handle.set(CURLOPT_NOSIGNAL, 1L);
    handle.set(CURLOPT_ERRORBUFFER, handle.message);
    handle.set(CURLOPT_USERAGENT, "latent/" LATENT_VERSION);
    handle.set(CURLOPT_PROTOCOLS_STR, "http,https");
    if (const char* const file = certificate_file()) handle.set(CURLOPT_CAINFO, file);
    handle.set(CURLOPT_FOLLOWLOCATION, 1L);
    handle.set(CURLOPT_MAXREDIRS, kMaxRedirections);
    handle.set(CURLOPT_HTTP_VERSION, long{CURL_HTTP_VERSION_1_1});
    handle.set(CURLOPT_NETRC, long{CURL_NETRC_OPTIONAL});
    handle.set(CURLOPT_CONNECTTIMEOUT, long{patience.connect_seconds});
    handle.set(CURLOPT_LOW_SPEED_LIMIT, 1L);
    handle.set(CURLOPT_LOW_SPEED_TIME, long{patience.stalled_seconds});
    handle.set(CURLOPT_NOPROGRESS, 0L);
    handle.set(CURLOPT_HEADERFUNCTION, &Request::take_header);
    handle.set(CURLOPT_WRITEFUNCTION, &Request::take_bytes);
    handle.set(CURLOPT_XFERINFOFUNCTION, &Request::is_to_end);
}

HttpConnection::~HttpConnection() = default;

Result<Fetched> HttpConnection::get(const std::string& url, std::uint64_t offset, std::uint64_t size, const RemoteVersion* known,
                                    const std::atomic<bool>& stop) {
    const auto fail = [&](const Error& error) { return error.at(shown_name(url)); };
    if (handle_->curl == nullptr) return fail({ErrorCode::kNoMemory, "libcurl cannot be used: out of memory"});
    Fetched got;
    got.bytes.reserve(size);
    const Stopwatch watch;
    double pause = patience_.first_wait;
    for (int tries = 1, answers = 1;; ++tries, ++answers, pause *= 2) {
        const std::uint64_t before = got.bytes.size(), from = offset + before;
        Request request{.answer = RangeAnswer(from, size - before, known, got.bytes),
                        .since_first_try = watch,
                        .seconds = patience_.lag_seconds - lag_ + static_cast<double>(before) / kSlowest,
                        .stop = stop};
        const CURLcode code = handle_->perform(url, fmt::format("{}-{}", from, offset + size - 1), request);
        if (stop) return fail({ErrorCode::kStopped, "given up"});
        const RangeAnswer& answer = request.answer;
        if (Status s = answer.verdict(code == CURLE_OK); !s) return fail(s.error());
        if (answer.version()) {
            got.version = *answer.version();
            if (known == nullptr) known = &got.version;
            size = std::min(size, got.version.size - std::min(offset, got.version.size));
            if (got.bytes.size() >= size) {
                lag_ = std::max(0.0, lag_ + watch.seconds() - static_cast<double>(size) / kSlowest);
                return got;
            }
        }

        std::string what = handle_->message[0] != '\0' ? handle_->message : curl_easy_strerror(code);
        if (code == CURLE_OK)
            what = fmt::format("the server sent only {} of the {} bytes requested", answer.received(), size - before);
        if (code == CURLE_OUT_OF_MEMORY) what = "a line of the answer is too long, or memory has run out";
        if (answer.status() >= 400) what = fmt::format("the server answers with status {}", answer.status());
        if (code == CURLE_ABORTED_BY_CALLBACK)
            what = fmt::format("the server is too slow: the connection has fallen {:.0f} s behind 1 KiB/s",
                               lag_ + watch.seconds() - static_cast<double>(got.bytes.size()) / kSlowest);
        if (is_final(code)) return fail({ErrorCode::kIo, "cannot be read: " + what});
        if (got.bytes.size() > before) tries = 0, pause = patience_.first_wait;
        const bool is_last = tries >= patience_.tries || answers >= kMaxAnswers;
        const double wait = is_last ? 0 : std::min(std::max(pause, handle_->wait_asked_for()), kLongestWait);
        for (const Stopwatch waited; !stop && waited.seconds() < wait && !request.is_late();)
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        if (is_last || request.is_late()) {
            return fail({ErrorCode::kIo, fmt::format("cannot be read at byte {}: {} (tried {})", offset + got.bytes.size(), what,
                                                     answers == 1 ? "once" : fmt::format("{} times", answers))});
        }
    }
}

}  // namespace latent::sampledb
