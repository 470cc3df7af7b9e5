#include "base/printable.h"

#include <gtest/gtest.h>

namespace latent {
namespace {

TEST(Printable, WordsOfAnyLanguageStayAsTheyAre) {
    for (const char* text : {"", "room.pbrt:1:1: \"a\\b\"", "two\nlines", "pr\u00fcfen", "\u5149", "\U0001F332"})
        EXPECT_EQ(printable(text), text);
}

TEST(Printable, WhatCouldSteerATerminalIsWrittenInDigits) {
    EXPECT_EQ(printable("\x1b[2J"), "\\x1b[2J");
    EXPECT_EQ(printable("a\rb\tc\x7f"), "a\\x0db\\x09c\\x7f");
    EXPECT_EQ(printable("\xc2\x9b!"), "\\xc2\\x9b!");                           // CSI in two bytes
    EXPECT_EQ(printable("\xff\xe5\x85"), "\\xff\\xe5\\x85");                    // no UTF-8, a character cut short
    EXPECT_EQ(printable("\xc0\xaf\xed\xa0\x80"), "\\xc0\\xaf\\xed\\xa0\\x80");  // overlong, a surrogate
    EXPECT_EQ(printable(std::string_view("a\0b", 3)), "a\\x00b");
}

TEST(Printable, ALineBreakInANameIsNoLineBreak) {
    EXPECT_EQ(printable("a\nb"), "a\nb");
    EXPECT_EQ(printable_line("a\nb\x1b"), "a\\x0ab\\x1b");
}

}  // namespace
}  // namespace latent
