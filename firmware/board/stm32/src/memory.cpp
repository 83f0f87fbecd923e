// SPDX-License-Identifier: Apache-2.0
// The small C library copies byte by byte, but frames and samples are copied all the time. These functions copy words
// if both sides are aligned.
#include <cstddef>
#include <cstdint>

extern "C" {

[[gnu::optimize("no-tree-loop-distribute-patterns")]] void* memcpy(void* to, const void* from, std::size_t bytes) {
  auto* out = static_cast<std::uint8_t*>(to);
  const auto* in = static_cast<const std::uint8_t*>(from);
  if (((reinterpret_cast<std::uintptr_t>(out) | reinterpret_cast<std::uintptr_t>(in)) & 3) == 0) {
    for (; bytes >= 4; bytes -= 4, out += 4, in += 4)
      *reinterpret_cast<std::uint32_t*>(out) = *reinterpret_cast<const std::uint32_t*>(in);
  }
  while (bytes-- != 0) *out++ = *in++;
  return to;
}

[[gnu::optimize("no-tree-loop-distribute-patterns")]] void* memset(void* to, int value, std::size_t bytes) {
  auto* out = static_cast<std::uint8_t*>(to);
  const std::uint32_t word = 0x01010101U * static_cast<std::uint8_t>(value);
  for (; bytes != 0 && (reinterpret_cast<std::uintptr_t>(out) & 3) != 0; --bytes)
    *out++ = static_cast<std::uint8_t>(value);
  for (; bytes >= 4; bytes -= 4, out += 4) *reinterpret_cast<std::uint32_t*>(out) = word;
  while (bytes-- != 0) *out++ = static_cast<std::uint8_t>(value);
  return to;
}
}
