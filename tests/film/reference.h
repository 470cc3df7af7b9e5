// tests/film/reference.h: what an independent implementation of the model (Python, double precision) computes, in reference.json:
// 8 pairs of film and print material, 4 slides, with and without couplers and trim. `about` in the file explains its fields.
#pragma once

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "color/film/material.h"
#include "tests/support/paths.h"

namespace latent::film {

inline const nlohmann::json& reference() {
    static const nlohmann::json all = nlohmann::json::parse(std::ifstream(testing::in_tree("tests/film/reference.json")));
    return all["materials"];
}

// One of its entries: "kodak_portra_400 > kodak_portra_endura (plain)".
struct ReferencePair {
    std::string film, paper;  // "": a slide
    bool plain;

    explicit ReferencePair(std::string_view key) : plain(key.ends_with(" (plain)")) {
        if (plain) key.remove_suffix(8);
        const std::size_t arrow = key.find(" > ");
        film = key.substr(0, arrow);
        if (arrow != std::string_view::npos) paper = key.substr(arrow + 3);
    }
};

}  // namespace latent::film
