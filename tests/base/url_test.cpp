#include "base/url.h"

#include <gtest/gtest.h>

namespace latent {
namespace {

TEST(ShownName, OfAUrlLeavesOutWhatMayBeSecret) {
    EXPECT_EQ(shown_name("https://me:word@host:80/a%20b/c.latent?X-Signature=1@2/3#x"), "https://host:80/a%20b/c.latent?...");
    EXPECT_EQ(shown_name("https://me:word@host?X-Signature=1@2/3"), "https://host?...");
    EXPECT_EQ(shown_name("https://host/c.latent#secret?"), "https://host/c.latent");
    EXPECT_EQ(shown_name("https://host/a@b.latent"), "https://host/a@b.latent");
    EXPECT_EQ(shown_name("http://host"), "http://host");
    EXPECT_EQ(shown_name("HTTPS://me:word@host/a?secret"), "HTTPS://host/a?...");
    EXPECT_EQ(shown_name("http:/me:word@host/a?secret"), "http:/host/a?...");  // a slip of the pen
}

TEST(ShownName, OfAFileIsItsPath) {
    for (const char* path : {"a.latent", "/tmp/what?.latent", "./http://me:word@host/a.latent?b", ""})
        EXPECT_EQ(shown_name(path), path);
}

}  // namespace
}  // namespace latent
