// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace triskin::geometry {

/// The widest vector unit of this machine that a kernel is built for.
enum class VectorUnit { kPlain, kAvx2, kAvx512 };

inline VectorUnit vector_unit() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl")) return VectorUnit::kAvx512;
  if (__builtin_cpu_supports("avx2")) return VectorUnit::kAvx2;
#endif
  return VectorUnit::kPlain;
}

/// That of three builds of one function which suits this machine: plain, AVX2, AVX-512.
template <typename Function>
Function fastest(Function plain, [[maybe_unused]] Function avx2, [[maybe_unused]] Function avx512) {
  switch (vector_unit()) {
    case VectorUnit::kAvx512: return avx512;
    case VectorUnit::kAvx2: return avx2;
    case VectorUnit::kPlain: break;
  }
  return plain;
}

}  // namespace triskin::geometry

/// DEFINE(plain, ), and where the processor may have them DEFINE(avx2, attribute) and DEFINE(avx512, attribute): the builds of a kernel.
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
