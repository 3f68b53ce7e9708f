#pragma once
// Whether a sanitizer slows this build: long searches are cut short then. GCC says so by a macro, Clang by a feature.

namespace terrane::test {

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define TERRANE_UNDER_ADDRESS_SANITIZER
#endif
#if __has_feature(thread_sanitizer)
#define TERRANE_UNDER_THREAD_SANITIZER
#endif
#endif
#if defined(__SANITIZE_ADDRESS__)
#define TERRANE_UNDER_ADDRESS_SANITIZER
#endif
#if defined(__SANITIZE_THREAD__)
#define TERRANE_UNDER_THREAD_SANITIZER
#endif

#if defined(TERRANE_UNDER_ADDRESS_SANITIZER)
inline constexpr bool kAddressSanitizer = true;
#else
inline constexpr bool kAddressSanitizer = false;
#endif
#if defined(TERRANE_UNDER_THREAD_SANITIZER)
inline constexpr bool kThreadSanitizer = true;
#else
inline constexpr bool kThreadSanitizer = false;
#endif
inline constexpr bool kSanitized = kAddressSanitizer || kThreadSanitizer;

#undef TERRANE_UNDER_ADDRESS_SANITIZER
#undef TERRANE_UNDER_THREAD_SANITIZER

}  // namespace terrane::test
