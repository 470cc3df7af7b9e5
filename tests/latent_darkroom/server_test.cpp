// latent-darkroom as programs meet it: what it answers, and what it refuses.
#include <arpa/inet.h>
#include <fmt/format.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "tests/image/decode.h"
#include "tests/latent_darkroom/served.h"

namespace latent::testing {
namespace {

class DarkroomServer : public Served {};

TEST_F(DarkroomServer, TilesAreThePrintAndCommandsMakeIt) {
    const Json view =
        view_of({{"latent-recipe", 1}, {"develop", {{"size", 150}, {"light", {"lamp=2.5"}}}}, {"convert", {{"stops", 0.5}}}});
    const auto raw = client_->Get(base_ + "api/tile?width=150&area=0,0,150,100&format=raw&view=" + std::string(view["view"]));
    ASSERT_TRUE(raw);
    ASSERT_EQ(raw->status, 200) << raw->body;
    const std::string commands = view["commands"];
    const std::string folder = std::filesystem::path(tool("latent-print")).parent_path();
    const Outcome made = run({"/bin/sh", "-c", "cd " + path("kept") + " && PATH=" + folder + ":$PATH && " + commands});
    ASSERT_EQ(made.status, 0) << made.err;
    const image::Decoded print = image::decode_png(path("kept/print.png"));
    ASSERT_EQ(print.pixels.size(), raw->body.size());
    EXPECT_TRUE(std::equal(raw->body.begin(), raw->body.end(), print.pixels.begin(),
                           [](char a, std::byte b) { return static_cast<std::byte>(a) == b; }));
    const auto bitmap = client_->Get(base_ + "api/tile?width=150&area=0,0,150,100&view=" + std::string(view["view"]));
    ASSERT_TRUE(bitmap);
    EXPECT_EQ(bitmap->get_header_value("Content-Type"), "image/bmp");
    EXPECT_EQ(bitmap->body.size(), 14u + 124u + 452u * 100u);
    EXPECT_EQ(bitmap->body[138], raw->body[2]);  // blue first
}

TEST_F(DarkroomServer, PrintsAreThoseOfTheCommandLine) {
    const Json recipe{{"latent-recipe", 1}, {"develop", {{"size", 90}}}, {"convert", {{"sensitivity", 1.5}, {"bits", 16}}}};
    const Json order{{"name", "a b.tif"}, {"recipe", recipe}};
    ASSERT_EQ(client_->Post(base_ + "api/prints", order.dump(), "application/json")->status, 200);
    ASSERT_EQ(client_->Post(base_ + "api/prints", order.dump(), "application/json")->status, 200);
    Json jobs;
    do {
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
        jobs = get("api/prints");
    } while (jobs[1]["state"] == "waiting" || jobs[1]["state"] == "running");
    EXPECT_EQ(jobs[0]["state"], "done");
    EXPECT_EQ(jobs[1]["state"], "failed");
    EXPECT_NE(std::string(jobs[1]["message"]).find("already exists"), std::string::npos);
    const std::string file = write("r.json", recipe.dump());
    make("latent-print", "a.latent", {"--recipe", file, "-o", path("same.tif")});
    EXPECT_TRUE(bytes_of("kept/a b.tif") == bytes_of("same.tif"));
    const auto again = client_->Post(base_ + "api/prints", order.dump(), "application/json");
    EXPECT_EQ(again->status, 409);
    EXPECT_EQ(Json::parse(again->body)["error"], "a b.tif is there already: choose another name, or replace it");
}

TEST_F(DarkroomServer, ACancelledPrintLeavesNothing) {
    const Json order{{"name", "large.tif"}, {"recipe", {{"latent-recipe", 1}, {"develop", {{"size", 16000}}}}}};
    const auto made = client_->Post(base_ + "api/prints", order.dump(), "application/json");
    ASSERT_TRUE(made);
    while (get("api/prints")[0]["state"] == "waiting") std::this_thread::sleep_for(std::chrono::milliseconds(10));
    client_->Delete(base_ + "api/prints/1");
    EXPECT_EQ(get("api/prints")[0]["state"], "cancelled");
    // The next one waits until the first has ended.
    const Json next{{"name", "small.png"}, {"recipe", {{"latent-recipe", 1}, {"develop", {{"size", 30}}}}}};
    client_->Post(base_ + "api/prints", next.dump(), "application/json");
    while (get("api/prints")[1]["state"] != "done") std::this_thread::sleep_for(std::chrono::milliseconds(50));
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(path("kept"))) names.push_back(entry.path().filename());
    EXPECT_EQ(names, std::vector<std::string>{"small.png"});
}

TEST_F(DarkroomServer, WhatWasAskedForInAnEarlierTurnIsGivenUp) {
    const std::string view = view_of({{"latent-recipe", 1}})["view"];
    const auto tile = [&](const std::string& turn) { return base_ + "api/tile?width=150&area=0,0,1,1&view=" + view + turn; };
    EXPECT_EQ(status_of(tile("&tab=a&turn=2")), 200);
    EXPECT_EQ(status_of(tile("&tab=a&turn=1")), 410);
    EXPECT_EQ(status_of(tile("&tab=b&turn=1")), 200);
    EXPECT_EQ(status_of(tile("")), 200);
    EXPECT_EQ(client_->Post(base_ + "api/views?tab=a&turn=1", R"({"latent-recipe": 1})", "application/json")->status, 410);
    for (int i = 0; i < 100; ++i) EXPECT_EQ(status_of(tile("&turn=1&tab=" + std::to_string(i))), 200);
    EXPECT_EQ(get("api/samples"), (Json{{"samples", 131072}, {"runs", 4}}));
}

TEST_F(DarkroomServer, BodiesNeedNotNameTheirType) {
    const Json recipe{{"latent-recipe", 1}, {"convert", {{"stops", 1}}}};
    const std::string body = recipe.dump() + std::string(20000, ' ');
    const auto view = client_->Post(base_ + "api/views", body, "application/x-www-form-urlencoded");  // as curl calls it
    ASSERT_TRUE(view);
    EXPECT_EQ(view->status, 200) << view->body;
    EXPECT_EQ(client_->Put(base_ + "api/recipes/long", body, "application/x-www-form-urlencoded")->status, 200);
    EXPECT_EQ(get("api/recipes/long"), recipe);
}

TEST_F(DarkroomServer, ABrowserOpensOnADesktopUnlessToldNotTo) {
    std::filesystem::create_directory(path("bin"));
    write("bin/xdg-open",
          "#!/bin/sh\necho \"$1\" > " + path("opened.part") + "; mv " + path("opened.part") + " " + path("opened") + "\n");
    std::filesystem::permissions(path("bin/xdg-open"), std::filesystem::perms::owner_all);
    const Environment desktop{{"DISPLAY", ":77"}, {"PATH", path("bin") + ":/usr/bin:/bin"}};
    const std::string command = tool("latent-darkroom") + " " + path("a.latent") + " --port 0 ";
    const auto starts = [&](const std::string& line) {
        std::filesystem::remove(path("said"));
        Child child({"/bin/sh", "-c", line + " > " + path("said")}, desktop);
        while (bytes_of("said").find("Ctrl-C ends") == std::string::npos)
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
    };
    const auto opened = [&] { return std::filesystem::exists(path("opened")); };
    starts("exec " + command);  // into a file
    starts("exec script -qfec '" + command + "--no-open' /dev/null");
    EXPECT_FALSE(opened());
    {
        Child child({"/bin/sh", "-c", "exec script -qfec '" + command + "' /dev/null > " + path("said")}, desktop);
        while (!opened()) std::this_thread::sleep_for(std::chrono::milliseconds(20));
        const std::string address = bytes_of("opened");
        EXPECT_EQ(address.find("http://127.0.0.1:"), 0u);
        EXPECT_NE(bytes_of("said").find(address.substr(0, address.size() - 1)), std::string::npos);
    }
}

TEST_F(DarkroomServer, RecipesComeBackAsTheyWereSaved) {
    const Json recipe{{"latent-recipe", 1}, {"convert", {{"stops", -1.25}}}};
    for (const char* name : {"dusk", "%C3%A9t%C3%A9%20%3Cb%3E"}) {
        ASSERT_EQ(client_->Put(base_ + "api/recipes/" + name, recipe.dump(), "application/json")->status, 200);
        EXPECT_EQ(get(std::string("api/recipes/") + name), recipe);
    }
    EXPECT_EQ(get("api/recipes"), Json({"dusk", "\u00e9t\u00e9 <b>"}));
}

TEST_F(DarkroomServer, RecipesAreRenamedAndCopiedAndNoneIsLost) {
    const Json dusk{{"latent-recipe", 1}, {"convert", {{"stops", -1.25}}}}, noon{{"latent-recipe", 1}};
    const auto post = [&](const std::string& name, const Json& body) {
        return client_->Post(base_ + "api/recipes/" + name, body.dump(), "application/json")->status;
    };
    client_->Put(base_ + "api/recipes/dusk", dusk.dump(), "application/json");
    client_->Put(base_ + "api/recipes/noon", noon.dump(), "application/json");
    EXPECT_EQ(post("dusk", {{"rename", "noon"}}), 409);
    EXPECT_EQ(post("dusk", {{"rename", "dusk"}}), 409);
    EXPECT_EQ(post("dusk", {{"copy", "noon"}}), 409);
    EXPECT_EQ(post("dawn", {{"copy", "day"}}), 404);
    for (const Json& bad : {Json{{"rename", "../dusk"}}, Json{{"copy", ".dusk"}}, Json{{"copy", 1}}, Json::object(), Json()})
        EXPECT_EQ(post("dusk", bad), 400) << bad;
    EXPECT_EQ(get("api/recipes"), Json({"dusk", "noon"}));
    EXPECT_EQ(post("dusk", {{"copy", "dusk 2"}}), 200);
    EXPECT_EQ(post("dusk", {{"rename", "evening"}}), 200);
    EXPECT_EQ(get("api/recipes"), Json({"dusk 2", "evening", "noon"}));
    EXPECT_EQ(get("api/recipes/dusk%202"), dusk);
    EXPECT_EQ(get("api/recipes/evening"), dusk);
    EXPECT_EQ(get("api/recipes/noon"), noon);
}

TEST_F(DarkroomServer, OnlyItsOwnPagesAreAnswered) {
    const std::string state = base_ + "api/state", host = "127.0.0.1:" + std::to_string(port_);
    EXPECT_EQ(status_of(state), 200);
    EXPECT_EQ(status_of(state, {{"Host", "localhost:9"}, {"Origin", "http://localhost:9"}}), 200);  // ssh -L
    EXPECT_EQ(status_of(state, {{"Host", "example.com"}}), 403);
    EXPECT_EQ(status_of(state, {{"Host", "127.0.0.1.example.com"}}), 403);
    EXPECT_EQ(status_of(state, {{"Host", "localhost:1:2"}}), 403);
    EXPECT_EQ(status_of(state, {{"Host", host}, {"Origin", "http://example.com"}}), 403);
    EXPECT_EQ(status_of(state, {{"Host", host}, {"Origin", "null"}}), 403);
    for (const std::string& place : {std::string("/"), std::string("/api/state"), "/" + std::string(32, '0') + "/api/state",
                                     base_.substr(0, base_.size() - 2) + "/api/state", std::string("/page.js"),
                                     base_ + "../a.latent", base_ + "%2e%2e/a.latent", base_ + "api/nothing"})
        EXPECT_EQ(status_of(place), 404) << place;
    const auto page = client_->Get(base_);
    ASSERT_TRUE(page);
    EXPECT_EQ(page->status, 200);
    EXPECT_EQ(page->get_header_value("Content-Security-Policy").find("default-src 'none'"), 0u);
    EXPECT_FALSE(page->has_header("Access-Control-Allow-Origin"));
}

TEST_F(DarkroomServer, NothingIsWrittenElsewhereOrBadly) {
    const std::vector<std::string> before = folder_->names();
    const std::string recipe = R"({"latent-recipe": 1})";
    const auto put = [&](const std::string& name, const std::string& body) {
        const auto result = client_->Put(base_ + "api/recipes/" + name, body, "application/json");
        return result ? result->status : -1;
    };
    for (const char* name : {"../x", "%2e%2e%2fx", "..%2f..%2fx", "%2ftmp%2fx", ".hidden", "-o", "a%00b", "a%0ab", "a%5cb"})
        EXPECT_NE(put(name, recipe), 200) << name;
    EXPECT_EQ(put(std::string(97, 'a'), recipe), 400);
    for (const char* body :
         {"", "{", "[]", "null", "{\"latent-recipe\": 2}", "{\"latent-recipe\": 1, \"convert\": {\"stops\": {}}}",
          "{\"latent-recipe\": 1, \"other\": {}}", "\xff\xfe"})
        EXPECT_EQ(put("bad", body), 400) << body;
    EXPECT_EQ(put("bad", std::string(60001, ' ') + recipe), 400);
    EXPECT_EQ(put("bad", std::string(70000, ' ') + recipe), 413);
    EXPECT_NE(put("bad", std::string(50 << 20, ' ')), 200);
    client_ = std::make_unique<httplib::Client>("127.0.0.1", port_);  // whose connection may have ended with that
    const auto post = [&](const std::string& what, const std::string& body) {
        const auto result = client_->Post(base_ + what, body, "application/json");
        return result ? result->status : -1;
    };
    for (const char* body :
         {"", "{", "[1]", "{\"name\": \"x.png\"}", "{\"name\": 1, \"recipe\": {}}",
          "{\"name\": \"../x.png\", \"recipe\": {\"latent-recipe\": 1}}",
          "{\"name\": \"x.sh\", \"recipe\": {\"latent-recipe\": 1}}", "{\"name\": \"x\", \"recipe\": {\"latent-recipe\": 1}}",
          "{\"name\": \"x.png\", \"recipe\": {\"latent-recipe\": 3}}"})
        EXPECT_EQ(post("api/prints", body), 400) << body;
    for (const char* body : {"{", "{\"latent-recipe\": 1, \"develop\": {\"size\": \"x\"}}",
                             "{\"latent-recipe\": 1, \"develop\": {\"light\": [\"none=2\"]}}",
                             "{\"latent-recipe\": 1, \"convert\": {\"profile\": \"/etc/passwd\"}}"})
        EXPECT_EQ(post("api/views", body), 400) << body;
    const std::string id = view_of(Json::parse(recipe))["view"];
    for (const std::string& query :
         {std::string("area=0,0,9,9"), std::string("width=0&area=0,0,1,1"), std::string("width=99999999999&area=0,0,1,1"),
          std::string("width=300&area=0,0,301,1"), std::string("width=300&area=-1,0,1,1"), std::string("width=300&area=5,5,5,9"),
          std::string("width=8000&area=0,0,8000,1")})
        EXPECT_EQ(status_of(fmt::format("{}api/tile?view={}&{}", base_, id, query)), 400) << query;
    EXPECT_EQ(status_of(base_ + "api/tile?width=300&area=0,0,1,1&view=0000000000000000"), 404);
    EXPECT_EQ(status_of(base_ + "api/probe?view=" + id + "&width=300&x=300&y=0"), 400);
    EXPECT_EQ(folder_->names(), before);
    EXPECT_TRUE(std::filesystem::is_empty(path("kept")));
    EXPECT_EQ(status_of(base_ + "api/state"), 200);
}

TEST_F(DarkroomServer, SocketsThatSayNothingAndManyRequestsDoNotStopIt) {
    std::vector<int> sockets;
    for (int i = 0; i < 40; ++i) {
        const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
        sockaddr_in to{};
        to.sin_family = AF_INET;
        to.sin_port = htons(static_cast<std::uint16_t>(port_));
        to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        ASSERT_EQ(::connect(socket, reinterpret_cast<const sockaddr*>(&to), sizeof to), 0);
        ASSERT_EQ(::send(socket, "GET / HT", i % 2 == 0 ? 8 : 0, 0), i % 2 == 0 ? 8 : 0);
        sockets.push_back(socket);
    }
    EXPECT_EQ(status_of(base_ + "api/state"), 200);  // after their time is over
    for (const int socket : sockets) ::close(socket);
    client_->set_keep_alive(true);
    int answered = 0;
    for (int i = 0; i < 10000; ++i) answered += status_of(i % 2 == 0 ? base_ + "page.css" : "/wrong") == (i % 2 == 0 ? 200 : 404);
    EXPECT_EQ(answered, 10000);
}

TEST_F(DarkroomServer, EndsWithItsPrintsAtASignal) {
    const Json order{{"name", "large.tif"}, {"recipe", {{"latent-recipe", 1}, {"develop", {{"size", 16000}}}}}};
    ASSERT_TRUE(client_->Post(base_ + "api/prints", order.dump(), "application/json"));
    child_->send(SIGINT);
    EXPECT_EQ(child_->wait(), 0);
    child_ = nullptr;
    EXPECT_TRUE(std::filesystem::is_empty(path("kept")));
}

TEST_F(DarkroomServer, APortThatIsTakenIsSaid) {
    const Outcome second = run({tool("latent-darkroom"), path("a.latent"), "--port", std::to_string(port_)});
    EXPECT_EQ(second.status, 1);
    EXPECT_EQ(second.err, "latent-darkroom: --port " + std::to_string(port_) + ": cannot listen there; choose another, or none\n");
}

}  // namespace
}  // namespace latent::testing
