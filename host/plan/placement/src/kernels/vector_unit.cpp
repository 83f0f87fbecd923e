// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernels/vector_unit.hpp"

#include <algorithm>
#include <cstdlib>
#include <string_view>

namespace triskin::placement {
namespace {

VectorUnit widest() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl"))
    return VectorUnit::kAvx512;
  if (__builtin_cpu_supports("avx2")) return VectorUnit::kAvx2;
#endif
  return VectorUnit::kPlain;
}

VectorUnit asked_for() {
  const char* name = std::getenv("TRISKIN_VECTOR_UNIT");
  if (name == nullptr || std::string_view(name) == "avx512") return VectorUnit::kAvx512;
  return std::string_view(name) == "avx2" ? VectorUnit::kAvx2 : VectorUnit::kPlain;
}

}  // namespace

VectorUnit vector_unit() {
  static const VectorUnit kUnit = std::min(widest(), asked_for());
  return kUnit;
}

}  // namespace triskin::placement
