// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace triskin::placement {

/// Names the widest vector unit of this machine that a kernel is built for, or the narrower one that the environment
/// variable TRISKIN_VECTOR_UNIT (plain, avx2, avx512) asks for. All give the same answers. The variable is read once.
enum class VectorUnit { kPlain, kAvx2, kAvx512 };
[[nodiscard]] VectorUnit vector_unit();

/// Selects the build of a function (plain, AVX2, AVX-512) for vector_unit().
template <typename Function>
Function fastest(Function plain, [[maybe_unused]] Function avx2, [[maybe_unused]] Function avx512) {
  switch (vector_unit()) {
    case VectorUnit::kAvx512:
      return avx512;
    case VectorUnit::kAvx2:
      return avx2;
    case VectorUnit::kPlain:
      break;
  }
  return plain;
}

}  // namespace triskin::placement

/// Expands to DEFINE(plain, ), and for processors that may have them DEFINE(avx2, attribute) and DEFINE(avx512,
/// attribute): the builds of a kernel.
#if defined(__x86_64__)
#define TRISKIN_FOR_VECTOR_UNITS(DEFINE) \
  DEFINE(plain, )                        \
  DEFINE(avx2, [[gnu::target("avx2")]])  \
  DEFINE(avx512, [[gnu::target("avx512f,avx512dq,avx512vl")]])
#else
#define TRISKIN_FOR_VECTOR_UNITS(DEFINE) \
  DEFINE(plain, )                        \
  DEFINE(avx2, )                         \
  DEFINE(avx512, )
#endif
