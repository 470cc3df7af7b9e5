#include "tools/darkroom/server/server.h"

#include <fmt/format.h>
#include <httplib.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <mutex>
#include <utility>

#include "base/file.h"
#include "base/hash.h"
#include "base/json.h"
#include "base/parse.h"
#include "color/catalogue.h"
#include "color/film/material.h"
#include "color/light_name.h"
#include "tools/convert/convert.h"
#include "tools/convert/looks.h"
#include "tools/darkroom/engine/decisions.h"
#include "tools/darkroom/server/bitmap.h"
#include "tools/darkroom/server/commands.h"
#include "tools/darkroom/server/folder.h"
#include "tools/darkroom/server/page.h"
#include "tools/darkroom/server/prints.h"

namespace latent::darkroom {

namespace {

using Json = nlohmann::ordered_json;
using httplib::Request;
using httplib::Response;

constexpr std::size_t kThreads = 64;         // connections at a time
constexpr time_t kPatience = 2;              // seconds that one may say nothing
constexpr std::size_t kLongestBody = 65536;  // a recipe, and what goes with it
constexpr int kLargestTile = 2048;           // pixels a side
constexpr std::uint64_t kMostBins = 470;     // a spectrum's, from 360 to 830 nm

constexpr const char* kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; connect-src 'self'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

// "127.0.0.1:8080", "localhost": this machine by any port, for ssh -L may choose another. No other name, which may come to mean
// this machine while its page is open.
bool is_loopback(const std::string& host) {
    const std::size_t colon = host.rfind(':');
    const std::string name = host.substr(0, colon);
    const bool has_port = colon != std::string::npos;
    return (name == "127.0.0.1" || name == "localhost") && (!has_port || parse_count(host.substr(colon + 1)));
}

int status_of(const Error& error) {
    switch (error.code) {
        case ErrorCode::kUsage:
            return 400;
        case ErrorCode::kNotFound:
            return 404;
        case ErrorCode::kExists:
            return 409;
        case ErrorCode::kStopped:
            return 410;
        default:
            return 500;
    }
}

void fail(Response& response, int status, const std::string& message) {
    response.status = status;
    response.set_content(json_text(Json{{"error", message}}) + "\n", "application/json");
}

void answer(Response& response, const Result<Json>& json) {
    if (!json) return fail(response, status_of(json.error()), json.error().message);
    response.set_content(json_text(*json) + "\n", "application/json");
}

const char* name_of(PrintState state) {
    constexpr const char* kNames[] = {"waiting", "running", "done", "failed", "cancelled"};
    return kNames[static_cast<std::size_t>(state)];
}

// Views that were asked for: the last ones, by a number made of the recipe.
class Views {
 public:
    std::string keep(const Recipe& recipe) {
        const std::string text = recipe.dump(-1, ' ', true);
        const std::string id = fmt::format("{:016x}", hash64(std::as_bytes(std::span(text))));
        const std::scoped_lock lock(mutex_);
        std::erase(order_, id);
        order_.push_back(id);
        views_[id] = recipe;
        constexpr std::size_t kKept = 256;
        if (order_.size() > kKept) {
            views_.erase(order_.front());
            order_.erase(order_.begin());
        }
        return id;
    }
    Result<Recipe> find(const std::string& id) const {
        const std::scoped_lock lock(mutex_);
        const auto found = views_.find(id);
        if (found == views_.end()) return Error{ErrorCode::kNotFound, "no such view; post its recipe again"};
        return found->second;
    }

 private:
    mutable std::mutex mutex_;
    std::map<std::string, Recipe> views_;
    std::vector<std::string> order_;  // oldest first
};

// The last turn of each page: what pages asked for in earlier turns is given up.
class Turns {
 public:
    // Whether a request with &tab=NAME&turn=N is outdated; one without is never given up.
    Stopped stopped(const Request& request) {
        const Result<std::uint64_t> asked = parse_count(request.get_param_value("turn"));
        const std::string tab = request.get_param_value("tab").substr(0, 32);
        if (tab.empty() || !asked) return {};
        const std::scoped_lock lock(mutex_);
        constexpr std::size_t kTabs = 64;
        auto last = std::ranges::find(tabs_, tab, &Tab::first);
        if (last == tabs_.end()) {
            if (tabs_.size() == kTabs) tabs_.erase(tabs_.begin());
            last = tabs_.emplace(tabs_.end(), tab, std::make_shared<std::atomic<std::uint64_t>>());
        }
        const auto turn = last->second;
        if (*asked > *turn) *turn = *asked;
        return [turn, asked = *asked] { return *turn > asked; };
    }

 private:
    using Tab = std::pair<std::string, std::shared_ptr<std::atomic<std::uint64_t>>>;
    std::mutex mutex_;
    std::vector<Tab> tabs_;  // oldest first
};

Result<std::uint64_t> number(const Request& request, const char* name, std::uint64_t most) {
    const Result<std::uint64_t> value = parse_count(request.get_param_value(name));
    if (!value || *value > most) return usage_error(fmt::format("{}: a whole number up to {} is needed", name, most));
    return *value;
}

class HttpServer final : public Server {
 public:
    HttpServer(Engine& engine, const ServerOptions& options)
        : engine_(engine),
          inputs_(options.inputs),
          folder_(options.folder),
          prints_(options.print),
          token_(make_nonce() + make_nonce()) {
        http_.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
        http_.set_payload_max_length(kLongestBody);
        http_.set_read_timeout(kPatience);
        http_.set_keep_alive_timeout(kPatience);
        http_.set_keep_alive_max_count(1000);
        http_.set_tcp_nodelay(true);
        // Its default lets two servers listen at one port.
        http_.set_socket_options([](socket_t socket) {
            const int yes = 1;
            ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
        });
        http_.set_default_headers({{"Content-Security-Policy", kPolicy},
                                   {"X-Content-Type-Options", "nosniff"},
                                   {"Referrer-Policy", "no-referrer"},
                                   {"Cross-Origin-Resource-Policy", "same-origin"},
                                   {"Cross-Origin-Opener-Policy", "same-origin"},
                                   {"Cache-Control", "no-store"}});
        http_.set_pre_routing_handler([](const Request& request, Response& response) {
            using enum httplib::Server::HandlerResponse;
            const std::string host = request.get_header_value("Host");
            const bool foreign = request.has_header("Origin") && request.get_header_value("Origin") != "http://" + host;
            if (request.get_header_value_count("Host") == 1 && is_loopback(host) && !foreign) return Unhandled;
            fail(response, 403, "only for pages of this address");
            return Handled;
        });
        http_.set_exception_handler([](const Request&, Response& response, const std::exception_ptr&) {
            fail(response, 500, "out of memory, or a fault of the program");
        });
        add_page();
        add_views();
        add_folder();
    }

    std::string address() const override { return fmt::format("http://127.0.0.1:{}/{}/", port_, token_); }
    int port() const override { return port_; }
    void run() override { http_.listen_after_bind(); }
    void stop() override { http_.stop(); }

    Status bind(int port) {
        port_ = port == 0 ? http_.bind_to_any_port("127.0.0.1") : http_.bind_to_port("127.0.0.1", port) ? port : -1;
        if (port_ < 0) return Error{ErrorCode::kIo, fmt::format("--port {}: cannot listen there; choose another, or none", port)};
        return {};
    }

 private:
    std::string at(const std::string& path) const { return "/" + token_ + "/" + path; }

    // Read here, since the library refuses long bodies that say nothing of their type. None: the library answers.
    static std::optional<std::string> body_of(const httplib::ContentReader& reader) {
        std::string body;
        const bool whole = reader([&](const char* data, std::size_t size) {
            body.append(data, size);
            return true;
        });
        return whole ? std::optional(std::move(body)) : std::nullopt;
    }
    void post(const std::string& path, const std::function<Result<Json>(const Request&, const std::string& body)>& work) {
        http_.Post(at(path), [work](const Request& request, Response& response, const httplib::ContentReader& reader) {
            if (const std::optional<std::string> body = body_of(reader)) answer(response, work(request, *body));
        });
    }

    void add_page() {
        for (const PageFile& file : page_files()) {
            http_.Get(at(file.name), [file](const Request&, Response& response) {
                response.set_content(file.content.data(), file.content.size(), file.type);
            });
        }
        http_.Get(at("api/state"), [this](const Request&, Response& response) { answer(response, state()); });
        http_.Get(at("api/samples"), [this](const Request&, Response& response) {
            engine_.look_again();
            const auto runs = engine_.runs();
            answer(response, Json{{"samples", runs->coverage().size()}, {"runs", runs->runs().size()}});
        });
    }

    void add_views() {
        post("api/views", [this](const Request& request, const std::string& body) { return new_view(request, body); });
        http_.Get(at("api/tile"), [this](const Request& request, Response& response) {
            const Result<convert::CodeValues> tile = this->tile(request);
            if (!tile) return fail(response, status_of(tile.error()), tile.error().message);
            if (request.get_param_value("format") == "raw")
                response.set_content(reinterpret_cast<const char*>(tile->codes.data()), tile->codes.size(),
                                     "application/octet-stream");
            else
                response.set_content(bitmap_of(*tile), "image/bmp");
        });
        http_.Get(at("api/histogram"),
                  [this](const Request& request, Response& response) { answer(response, histogram(request)); });
        http_.Get(at("api/probe"), [this](const Request& request, Response& response) { answer(response, probe(request)); });
        http_.Get(at("api/spectrum"), [this](const Request& request, Response& response) { answer(response, spectrum(request)); });
        http_.Get(at("api/distance"), [this](const Request& request, Response& response) { answer(response, distance(request)); });
        http_.Get(at("api/noise"), [this](const Request& request, Response& response) { answer(response, noise(request)); });
    }

    void add_folder() {
        http_.Get(at("api/recipes"), [this](const Request&, Response& response) { answer(response, Json(folder_.recipes())); });
        http_.Get(at("api/recipes/(.+)"),
                  [this](const Request& request, Response& response) { answer(response, folder_.recipe(request.matches[1])); });
        http_.Put(at("api/recipes/(.+)"), [this](const Request& request, Response& response, const httplib::ContentReader& reader) {
            const std::optional<std::string> body = body_of(reader);
            if (!body) return;
            const Result<Recipe> recipe = parse_recipe(*body);
            const Status saved = recipe ? folder_.save(request.matches[1], *recipe, true) : Status(recipe.error());
            answer(response, saved ? Result<Json>(Json{{"saved", std::string(request.matches[1])}}) : saved.error());
        });
        post("api/recipes/(.+)", [this](const Request& request, const std::string& body) { return recipe_moved(request, body); });
        http_.Get(at("api/prints"), [this](const Request&, Response& response) {
            Json jobs = Json::array();
            for (const PrintJob& job : prints_.list())
                jobs.push_back({{"id", job.id},
                                {"name", job.name},
                                {"state", name_of(job.state)},
                                {"message", job.message},
                                {"done", job.done ? Json(*job.done) : Json()}});
            answer(response, jobs);
        });
        post("api/prints", [this](const Request&, const std::string& body) { return new_print(body); });
        http_.Delete(at("api/prints/(\\d{1,18})"), [this](const Request& request, Response& response) {
            prints_.cancel(*parse_count(std::string(request.matches[1])));
            answer(response, Json::object());
        });
    }

    Result<Json> state() const {
        const std::shared_ptr<const sampledb::RunSet> opened = engine_.runs();
        const sampledb::RunSet& runs = *opened;
        const develop::Size size = engine_.default_size();
        Json inputs = Json::array();
        for (const std::filesystem::path& input : inputs_) inputs.push_back(input.filename().string());
        Json observers = Json::array(), filters = Json::array();
        for (const color::CatalogueEntry& entry : color::observer_catalogue())
            observers.push_back({{"name", entry.name}, {"what", entry.what}});
        for (const color::CatalogueEntry& entry : color::lens_filter_catalogue()) filters.push_back(entry.name);
        Json stocks = Json::array(), papers = Json::array(), looks = Json::array();
        for (const film::Material& material : film::materials())
            (material.in_camera() ? stocks : papers).push_back({{"name", material.name}, {"what", material.title}});
        for (const convert::NamedLook& look : convert::looks())
            looks.push_back({{"name", look.name}, {"film", look.film}, {"what", look.what}});
        Json lights = Json::array(), light_groups = Json::array();
        for (const color::NamedLight& light : color::named_lights()) lights.push_back({{"name", light.name}, {"what", light.what}});
        for (const develop::LightGroup& group : engine_.light_groups())
            light_groups.push_back({{"name", group.name}, {"replaceable", group.spectrum.has_value()}});
        const bool spectral = runs.job().kind == sampledb::RecordKind::kSpectral;
        std::error_code ignored;  // then the folder as it was given
        Json state{{"version", LATENT_VERSION},
                   {"inputs", inputs},
                   {"width", size.width},
                   {"height", size.height},
                   {"aspect", {runs.job().aspect_width, runs.job().aspect_height}},
                   {"samples", runs.coverage().size()},
                   {"runs", runs.runs().size()},
                   {"spectral", spectral},
                   {"light_groups", light_groups},
                   {"lights", lights},
                   {"observers", spectral ? observers : Json::array()},
                   {"lens_filters", spectral ? filters : Json::array()},
                   {"films", spectral ? stocks : Json::array()},
                   {"papers", papers},
                   {"looks", looks},
                   {"profiles", folder_.profiles()},
                   {"f_number", nullptr},
                   {"shutter", engine_.knows_shutter()},
                   {"depth", engine_.knows_depth()},
                   {"folder", std::filesystem::absolute(folder_.path(), ignored).lexically_normal().string()},
                   {"recipes", folder_.recipes()}};
        if (const std::optional<double> f = engine_.f_number()) state["f_number"] = *f;
        return state;
    }

    Result<Json> new_view(const Request& request, const std::string& body) {
        const Result<Recipe> recipe = parse_recipe(body);
        if (!recipe) return recipe.error();
        Result<Recipe> resolved = engine_.resolve(*recipe, options_of(request));
        if (!resolved) return resolved.error();
        return Json{
            {"view", views_.keep(*resolved)}, {"recipe", *resolved}, {"commands", commands_for(*resolved, inputs_, "print")}};
    }

    ViewOptions options_of(const Request& request) {
        return {.mixed = request.get_param_value("mixed") == "1", .stopped = turns_.stopped(request)};
    }

    Result<develop::Size> size_of(const Request& request) {
        const Result<std::uint64_t> width = number(request, "width", develop::kMaxSide);
        if (!width) return width.error();
        return engine_.size_of_width(static_cast<std::uint32_t>(*width));
    }

    struct Asked {
        Recipe recipe;
        develop::Size size;
        ViewOptions options;
    };
    Result<Asked> asked(const Request& request) {
        Result<Recipe> recipe = views_.find(request.get_param_value("view"));
        if (!recipe) return recipe.error();
        const Result<develop::Size> size = size_of(request);
        if (!size) return size.error();
        return Asked{*std::move(recipe), *size, options_of(request)};
    }

    Result<convert::CodeValues> tile(const Request& request) {
        const Result<Asked> view = asked(request);
        if (!view) return view.error();
        const auto area = parse_crop(request.get_param_value("area"));
        if (!area) return usage_error("area: X0,Y0,X1,Y1 is needed, in pixels");
        const image::Rect pixels{(*area)[0], (*area)[1], (*area)[2], (*area)[3]};
        if (pixels.width() > kLargestTile || pixels.height() > kLargestTile)
            return usage_error(fmt::format("area: at most {0} x {0} pixels", kLargestTile));
        return engine_.view(view->recipe, view->size, pixels, view->options);
    }

    Result<Json> histogram(const Request& request) {
        const Result<Asked> view = asked(request);
        if (!view) return view.error();
        const Result<Histogram> histogram = engine_.histogram(view->recipe, view->size, view->options);
        if (!histogram) return histogram.error();
        return Json{{"red", histogram->counts[0]},
                    {"green", histogram->counts[1]},
                    {"blue", histogram->counts[2]},
                    {"pixels", histogram->pixels},
                    {"burnt", histogram->burnt},
                    {"black", histogram->black},
                    {"out_of_gamut", histogram->out_of_gamut}};
    }

    struct Place {
        int x = 0, y = 0;  // the pixel
    };
    static Result<Place> place(const Request& request, const develop::Size& size) {
        const Result<std::uint64_t> x = number(request, "x", size.width - 1), y = number(request, "y", size.height - 1);
        if (!x || !y) return x ? y.error() : x.error();
        return Place{static_cast<int>(*x), static_cast<int>(*y)};
    }

    Result<Json> probe(const Request& request) {
        const Result<Asked> view = asked(request);
        if (!view) return view.error();
        const Result<Place> at = place(request, view->size);
        if (!at) return at.error();
        const Result<Probe> probe = engine_.probe(view->recipe, view->size, at->x, at->y, view->options.stopped);
        if (!probe) return probe.error();
        Json json{{"observer", probe->observer.empty() ? "cie1931" : probe->observer},
                  {"values", probe->values},
                  {"standard_errors", probe->standard_errors},
                  {"rgb", probe->codes},
                  {"samples", probe->samples}};
        const double sum = probe->values[0] + probe->values[1] + probe->values[2];
        if (probe->observer.empty() && sum > 0) json["xy"] = {probe->values[0] / sum, probe->values[1] / sum};
        return json;
    }

    Result<Json> spectrum(const Request& request) {
        const Result<Asked> view = asked(request);
        if (!view) return view.error();
        const Result<Place> at = place(request, view->size);
        if (!at) return at.error();
        const Result<std::uint64_t> bins = number(request, "bins", kMostBins);
        if (!bins || *bins == 0) return bins ? usage_error("bins: at least one is needed") : bins.error();
        const Result<ProbedSpectrum> spectrum =
            engine_.spectrum(view->recipe, view->size, at->x, at->y, static_cast<int>(*bins), view->options.stopped);
        if (!spectrum) return spectrum.error();
        return Json{{"from_nm", spectrum->from_nm},
                    {"to_nm", spectrum->to_nm},
                    {"values", spectrum->values},
                    {"standard_errors", spectrum->standard_errors},
                    {"samples", spectrum->samples}};
    }

    Result<Json> distance(const Request& request) {
        const Result<develop::Size> size = size_of(request);
        if (!size) return size.error();
        const Result<Place> at = place(request, *size);
        if (!at) return at.error();
        const Result<double> distance = engine_.distance(*size, at->x, at->y);
        if (!distance) return distance.error();
        return Json{{"distance", std::isinf(*distance) ? Json("infinity") : Json(*distance)}};
    }

    Result<Json> noise(const Request& request) {
        const Result<Asked> view = asked(request);
        if (!view) return view.error();
        const Result<develop::NoiseMap> map = engine_.noise(view->recipe, view->size, view->options.stopped);
        if (!map) return map.error();
        Json relative = Json::array();  // NaN becomes null
        for (std::size_t row = 0; row < map->rows(); ++row) {
            for (std::size_t column = 0; column < map->columns(); ++column) relative.push_back(map->relative(column, row));
        }
        const develop::Percentiles all = map->relative();
        return Json{{"side", develop::NoiseMap::kSide},
                    {"columns", map->columns()},
                    {"rows", map->rows()},
                    {"relative", relative},
                    {"median", all.median},
                    {"p95", all.p95}};
    }

    Result<Json> recipe_moved(const Request& request, const std::string& body) {
        const Json order = Json::parse(body, nullptr, false);
        const bool copies = order.is_object() && order.contains("copy");
        const Json to = order.is_object() ? order.value(copies ? "copy" : "rename", Json()) : Json();
        if (!to.is_string()) return usage_error("an object with the new name is needed, as copy or rename");
        const std::string name = request.matches[1];
        if (Status s = copies ? folder_.copy(name, to) : folder_.rename(name, to); !s) return s.error();
        return Json{{"saved", to}};
    }

    Result<Json> new_print(const std::string& body) {
        const Json order = Json::parse(body, nullptr, false);
        if (!order.is_object() || !order.contains("name") || !order["name"].is_string() || !order.contains("recipe"))
            return usage_error("an object with a name and a recipe is needed");
        const Result<Recipe> recipe = parse_recipe(order["recipe"].dump());
        if (!recipe) return recipe.error();
        const Result<std::filesystem::path> output = folder_.file(order["name"]);
        if (!output) return output.error();
        Result<Decisions> decisions = decide(*recipe);
        if (!decisions) return decisions.error();
        decisions->print.outputs = {*output};
        decisions->print.replace = order.value("replace", Json(false)) == Json(true);
        if (std::error_code ignored; !decisions->print.replace && std::filesystem::exists(*output, ignored))
            return Error{ErrorCode::kExists, output->filename().string() + " is there already: choose another name, or replace it"};
        if (Status s = convert::check(decisions->print); !s) return s.error();
        const Result<std::uint64_t> id = prints_.add(*output, *recipe, decisions->print.replace);
        if (!id) return id.error();
        return Json{{"id", *id}};
    }

    Engine& engine_;
    std::vector<std::filesystem::path> inputs_;
    Folder folder_;
    Prints prints_;
    Views views_;
    Turns turns_;
    std::string token_;
    int port_ = 0;
    httplib::Server http_;
};

}  // namespace

std::vector<std::string> print_command(const EngineOptions& options) {
    std::error_code ignored;
    const std::filesystem::path beside = std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path() / "latent-print";
    std::vector<std::string> command{beside.string()};
    for (const std::filesystem::path& input : options.inputs) command.push_back(input.string());
    if (options.skip_duplicates) command.emplace_back("--skip-duplicates");
    command.insert(command.end(), {"--memory", std::to_string(options.memory / 2), "--threads", std::to_string(options.threads)});
    return command;
}

Result<std::unique_ptr<Server>> Server::open(Engine& engine, const ServerOptions& options) {
    auto server = std::make_unique<HttpServer>(engine, options);
    if (Status s = server->bind(options.port); !s) return s.error();
    return server;
}

}  // namespace latent::darkroom
