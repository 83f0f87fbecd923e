// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "triskin/layout/patch_image.hpp"
#include "triskin/wire/can_frame.hpp"

namespace triskin::fw {

/// The controller as an iCub host sees it: answers and obeys the commands of an MTB4 skin board. Kept in RAM, as there.
class IcubBoard {
 public:
  struct Reaction {
    std::optional<wire::CanFrame> reply;
    std::optional<bool> transmit;  ///< start or stop the stream
  };
  /// `frame` has an 11-bit identifier. `version` is major, minor, patch, build from the high byte down.
  [[nodiscard]] Reaction handle(const wire::CanFrame& frame, std::uint8_t node_address, std::uint32_t version);

  /// True when module 0..15 takes part in the stream.
  [[nodiscard]] bool enabled(std::size_t triangle) const { return (enabled_ >> triangle & 1) != 0; }
  /// 8-bit value of a taxel: what it has at rest, and the compensated change in converter counts, made smaller by the
  /// triangle's shift.
  [[nodiscard]] std::uint8_t value(std::size_t triangle, int change) const;
  /// Whether a sample at `now_us` is to be sent; keeps the mean period that the host asked for.
  [[nodiscard]] bool due(std::uint64_t now_us);

 private:
  static constexpr std::uint8_t kResting = 240, kShift = 6;
  void poll(const wire::CanFrame& frame, Reaction& reaction);
  void set_triangles(const wire::CanFrame& frame);

  std::uint8_t resting_ = kResting;
  std::array<std::uint8_t, layout::kMaxModules> shift_ = [] {
    std::array<std::uint8_t, layout::kMaxModules> all{};
    all.fill(kShift);
    return all;
  }();
  std::uint16_t enabled_ = 0xFFFF;
  std::uint64_t period_us_ = 0, next_us_ = 0;
};

}  // namespace triskin::fw
