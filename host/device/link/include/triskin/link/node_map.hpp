// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <map>
#include <optional>

#include "triskin/wire/can_frame.hpp"

namespace triskin::link {

/// Maps node addresses to one of several wires, learned from received frames. Not thread-safe.
class NodeMap {
 public:
  /// Learns from a frame received on `wire` (>= 0), because claims and answers name their node. If two wires claim an
  /// address, it maps to none.
  void heard(const wire::CanFrame& frame, int wire);
  /// Learns from a frame that is sent, because a new discovery or an assigned address invalidates what is known.
  void sent(const wire::CanFrame& frame);
  /// Returns the wire that leads to node address `node`; empty if it is not known, or if several wires do.
  [[nodiscard]] std::optional<int> wire_of(std::uint8_t node) const;
  /// Returns the node address that a diagnostic request is sent to; empty for any other frame.
  [[nodiscard]] static std::optional<std::uint8_t> target_of(const wire::CanFrame& frame);

 private:
  static constexpr int kSeveral = -1;
  std::map<std::uint8_t, int> wires_;
};

}  // namespace triskin::link
