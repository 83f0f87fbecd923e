// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "triskin/logic/switched/topology.hpp"

namespace triskin::fw {
namespace {

constexpr std::uint8_t kMarker = 0x80;
constexpr int kTries = 3;  // A marginal chain clock flips a bit now and then.

// The pattern is neither constant nor periodic in a byte; the first bytes measure the length.
constexpr std::array<std::uint8_t, layout::kMaxModules + 3> kPattern{
    0xA6, 0x59, 0x3C, 0xD1, 0x8B, 0x62, 0x17, 0xE4, 0x9A, 0x35, 0xC8, 0x71, 0x2D, 0xB4, 0x4E, 0x93, 0x1F, 0xE8, 0x56};

constexpr std::uint8_t enable_bit(std::uint8_t port) {
  return static_cast<std::uint8_t>(0x10U << port);
}

}  // namespace

void ChainDriver::clear() {
  for (auto& c : child_) c.fill(kNoModule);
  config_.fill(kMarker);
  members_ = 0;
  length_ = 0;
}

bool ChainDriver::restart(std::uint8_t cable) {
  clear();
  port_.enable(0);
  port_.enable(static_cast<std::uint8_t>(1U << cable));
  // The chain is one register deep, so data come back eight bits later.
  refused_ = false;
  for (int k = 0; k < kTries; ++k) {
    const Answer answer = measure();
    refused_ = answer == Answer::kRefused;
    if (answer != Answer::kModule) continue;
    members_ = 1;
    order();
    return true;
  }
  return false;
}

void ChainDriver::silence() {
  clear();
  port_.enable(0);
}

// The order is the module's own register, then the segments of ports A, B, C.
std::size_t ChainDriver::order() {
  length_ = 0;
  if ((members_ & 1U) == 0) return 0;
  std::array<std::uint8_t, 2 * layout::kMaxModules + 2> stack{};
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0 && length_ < order_.size()) {
    const std::uint8_t m = stack[--depth];
    order_[length_++] = m;
    for (int p = layout::kPorts - 1; p >= 0; --p) {
      const std::uint8_t c = child_[m][static_cast<std::size_t>(p)];
      if (c != kNoModule && depth < stack.size()) stack[depth++] = c;
    }
  }
  return length_;
}

void ChainDriver::set_address(std::uint8_t module, LineAddress address) {
  config_[module] =
      static_cast<std::uint8_t>((config_[module] & 0xF0U) | (address.line & 3U) | ((address.address & 3U) << 2));
}

// Shifts the configuration in; returns true when the chain returned the same one, which it therefore held before.
bool ChainDriver::echo() {
  std::array<std::uint8_t, kNumbers> out{}, in{};
  for (std::size_t k = 0; k < length_; ++k) out[k] = config_[order_[length_ - 1 - k]];
  port_.exchange(Bytes(out.data(), length_), {in.data(), length_});
  return std::equal(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(length_), in.begin());
}

bool ChainDriver::write() {
  bool sure = false;
  (void)echo();
  for (int k = 0; k < kTries && !sure; ++k) sure = echo();
  if (!sure) return false;  // Data that did not arrive are never latched.
  port_.latch();
  order();
  return true;
}

bool ChainDriver::settle() {
  return measure() == Answer::kUnchanged && write();
}

bool ChainDriver::check() {
  return length_ > 0 && echo();
}

ChainDriver::Answer ChainDriver::measure() {
  std::array<std::uint8_t, kMaxBytes> in{};
  const std::size_t n = length_ + 3;
  for (int k = 0; k < kTries; ++k) {
    port_.exchange(Bytes(kPattern.data(), n), {in.data(), n});
    const auto all = [&](std::uint8_t value) {
      return std::all_of(in.begin(), in.begin() + static_cast<std::ptrdiff_t>(n), [&](auto b) { return b == value; });
    };
    const auto delayed = [&](std::size_t by) {
      for (std::size_t b = by; b < n; ++b) {
        if (in[b] != kPattern[b - by]) return false;
      }
      return true;
    };
    if (delayed(length_ + 1)) return Answer::kModule;
    if (delayed(length_)) return Answer::kUnchanged;
    if (all(0xFF)) return Answer::kRefused;
    if (all(0x00)) return Answer::kNothing;
  }
  return Answer::kLost;
}

ChainDriver::Answer ChainDriver::open(std::uint8_t module, std::uint8_t port, std::uint8_t child) {
  config_[module] = static_cast<std::uint8_t>(config_[module] | enable_bit(port));
  if (!write()) return Answer::kLost;
  const Answer answer = measure();
  if (answer == Answer::kModule) {
    child_[module][port] = child;
    config_[child] = kMarker;
    members_ |= 1U << child;
    order();
  }
  return answer;
}

bool ChainDriver::close(std::uint8_t module, std::uint8_t port) {
  config_[module] = static_cast<std::uint8_t>(config_[module] & ~enable_bit(port));
  // Nothing can be read back over a broken chain, so it writes first and checks when the chain is whole again.
  for (int k = 0; k < kTries; ++k) {
    (void)echo();
    port_.latch();
    if (!echo() && !echo()) continue;
    port_.latch();  // The verified data are latched, in case the first latch was disturbed.
    return true;
  }
  return false;
}

bool ChainDriver::shut(std::uint8_t module, std::uint8_t port) {
  config_[module] = static_cast<std::uint8_t>(config_[module] & ~enable_bit(port));
  if (!write()) return false;
  std::uint8_t& child = child_[module][port];
  if (child != kNoModule) members_ &= ~(1U << child);
  child = kNoModule;
  order();
  return echo() || echo();
}

void ChainDriver::attach(std::uint8_t module, std::uint8_t port, std::uint8_t child) {
  config_[module] = static_cast<std::uint8_t>(config_[module] | enable_bit(port));
  child_[module][port] = child;
  config_[child] = kMarker;
  members_ |= 1U << child;
}

}  // namespace triskin::fw
