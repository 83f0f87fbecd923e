// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <map>
#include <optional>

#include "triskin/wire/can_frame.hpp"

namespace triskin::device {

/// Which of several wires leads to a node address, learned from what comes in by them. Not thread-safe.
class NodeMap {
 public:
  /// A frame has come in by `wire`: claims and answers name their node. Two wires that claim one address lead to none.
  void heard(const wire::CanFrame& frame, int wire);
  /// A frame goes out: a new look for controllers or a new address makes everything uncertain.
  void sent(const wire::CanFrame& frame);
  /// Empty: not known, or several.
  [[nodiscard]] std::optional<int> wire_of(std::uint8_t node) const;
  /// Node that a diagnostic request is for.
  [[nodiscard]] static std::optional<std::uint8_t> target_of(const wire::CanFrame& frame);

 private:
  static constexpr int kSeveral = -1;
  std::map<std::uint8_t, int> wires_;
};

}  // namespace triskin::device
