// tests/support/sanitizers.h: whether the tests run under a sanitizer that takes memory of its own and replaces the allocator.
#pragma once

namespace latent::testing {

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define LATENT_SANITIZED
#endif
#elif defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define LATENT_SANITIZED
#endif

#ifdef LATENT_SANITIZED
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

}  // namespace latent::testing
