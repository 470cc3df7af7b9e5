#include "base/json.h"

#include <gtest/gtest.h>

namespace latent {
namespace {

std::vector<std::string> elements(std::string_view array) {
    std::vector<std::string> found;
    for_each_element(array, [&](std::string_view element) { found.emplace_back(element); });
    return found;
}

TEST(Json, TextNeverHoldsACharacterThatSteersATerminal) {
    std::string every;
    for (unsigned c = 1; c < 256; ++c) every += static_cast<char>(c);
    every += "\xc2\x9b\xc2\x80\xc2\xa0\xc3\xa9";
    const std::string text = json_text(nlohmann::json{{every, every}});
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto c = static_cast<unsigned char>(text[i]);
        EXPECT_TRUE((c >= 0x20 && c != 0x7f) || c == '\n') << i;
        EXPECT_FALSE(c == 0xc2 && static_cast<unsigned char>(text[i + 1]) < 0xa0) << i;
    }
    const nlohmann::json back = nlohmann::json::parse(text);
    EXPECT_NE(back.begin().key().find("\xc2\x9b\xc2\x80\xc2\xa0\xc3\xa9"), std::string::npos);  // escaped, not lost
    EXPECT_NE(back.begin().key().find('\x7f'), std::string::npos);
}

TEST(Json, AnObjectOfTheDepthAllowedIsAcceptedAndOneLevelMoreIsNot) {
    for (const std::size_t depth : {1u, 5u, 32u}) {
        std::string text = R"({"a":)" + std::string(depth - 1, '[') + std::string(depth - 1, ']') + "}";
        if (depth == 1) text = "{}";
        EXPECT_TRUE(check_json_object(text, depth)) << text;
        if (depth > 1) {
            EXPECT_FALSE(check_json_object(text, depth - 1)) << text;
        }
    }
    EXPECT_EQ(check_json_object(R"({"a":)" + std::string(20'000'000, '['), 64).error().message,
              "is nested more than 64 levels deep");
}

TEST(Json, WhatIsNoObjectIsRefused) {
    for (const char* text : {"", " ", "[]", "1", "\"{}\"", "{", "{}}", "{\"a\":1,}", "{\"a\":1e999}", "{\"a\":\"\x01\"}",
                             "{\"a\":\"\xff\"}", "\xef\xbb\xbf{}", "{a:1}"}) {
        EXPECT_FALSE(check_json_object(text, 8)) << text;
    }
    EXPECT_TRUE(check_json_object(" \n{ \"a\" : [ 1 , { } ] }\t", 8));
}

TEST(Json, PartsOfATextAreFoundAsTheyStand) {
    const std::string text =
        R"( { "x" : "]},{\"parts\":[9]" , "parts" : [ {"a":[1,2]} ,"b,]\\" , 3.5e-1,[ ] , null ] , "end":true})";
    ASSERT_TRUE(check_json_object(text, 8));
    EXPECT_EQ(member_of(text, "x"), R"("]},{\"parts\":[9]")");
    EXPECT_EQ(member_of(text, "end"), "true");
    EXPECT_EQ(member_of(text, "a"), "");
    EXPECT_EQ(elements(member_of(text, "parts")),
              (std::vector<std::string>{R"({"a":[1,2]})", R"("b,]\\")", "3.5e-1", "[ ]", "null"}));
    EXPECT_TRUE(elements(member_of(text, "x")).empty());
    EXPECT_TRUE(elements(" [ ] ").empty());
    EXPECT_EQ(member_of("{}", "a"), "");
}

TEST(Json, AMemberThatIsAddedIsReadBack) {
    const nlohmann::json object = {{"a", 1}, {"b", {{"c", "}"}}}};
    const auto put = [](std::string& text) { text += R"({"e":[1]})"; };
    const nlohmann::json both = nlohmann::json::parse(with_member(json_text(object), "d", put));
    EXPECT_EQ(both, (nlohmann::json{{"a", 1}, {"b", {{"c", "}"}}}, {"d", {{"e", {1}}}}}));
}

}  // namespace
}  // namespace latent
