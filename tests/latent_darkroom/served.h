// tests/latent_darkroom/served.h: latent-darkroom at work, with the samples of tests/print/samples.h.
#pragma once

#include <gtest/gtest.h>
#include <httplib.h>

#include <chrono>
#include <csignal>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "tests/print/samples.h"

namespace latent::testing {

using Json = nlohmann::json;

class Served : public Samples {
 protected:
    void SetUp() override {
        std::filesystem::create_directory(path("kept"));
        std::filesystem::remove(path("address"));
        start({});
    }
    void TearDown() override {
        if (child_) {
            child_->send(SIGTERM);
            EXPECT_EQ(child_->wait(), 0);
        }
        std::filesystem::remove_all(path("kept"));
    }
    void start(const std::vector<std::string>& options, const std::string& input = "a.latent") {
        child_ = std::make_unique<Child>(
            with({"/bin/sh", "-c", "out=$1; shift; exec \"$@\" > \"$out\"", "sh", path("address"), tool("latent-darkroom"),
                  path(input), "--recipes", path("kept"), "--json", "--memory", "512M"},
                 options));
        Json told;
        for (int waited = 0; !told.is_object(); ++waited) {
            ASSERT_LT(waited, 1500) << "it does not start";
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
            told = Json::parse(bytes_of("address"), nullptr, false);
        }
        port_ = told["port"];
        const std::string address = told["address"];
        base_ = address.substr(address.find('/', 7));
        client_ = std::make_unique<httplib::Client>("127.0.0.1", port_);
        client_->set_read_timeout(60);
    }
    Json get(const std::string& what) {
        const auto result = client_->Get(base_ + what);
        EXPECT_TRUE(result);
        return result ? Json::parse(result->body) : Json();
    }
    Json view_of(const Json& recipe) {
        const auto result = client_->Post(base_ + "api/views", recipe.dump(), "application/json");
        EXPECT_TRUE(result && result->status == 200) << (result ? result->body : "");
        return Json::parse(result->body);
    }
    int status_of(const std::string& what, const httplib::Headers& headers = {}) {
        const auto result = client_->Get(what, headers);
        return result ? result->status : -1;
    }

    std::unique_ptr<Child> child_;
    std::unique_ptr<httplib::Client> client_;
    int port_ = 0;
    std::string base_;
};

}  // namespace latent::testing
