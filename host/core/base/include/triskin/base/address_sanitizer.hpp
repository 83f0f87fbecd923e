// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace triskin {

/// True in a build with the address sanitizer. Such a program reserves terabytes of addresses, so a limit of its
/// address space (RLIMIT_AS) would end it at once.
#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool kAddressSanitizer = true;
#elif defined(__has_feature)
inline constexpr bool kAddressSanitizer = __has_feature(address_sanitizer);
#else
inline constexpr bool kAddressSanitizer = false;
#endif

}  // namespace triskin
