// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <vector>

#include "triskin/deploy/identify.hpp"

namespace triskin::device {

/// A controller whose address nobody shares.
struct FeelingBoard {
  wire::NodeClaim claim;
  BoardShape shape;
  std::vector<int> likely;  ///< Its shape fits these patches; with none it fits no patch.
  bool across = false;  ///< It reaches into the patches beside its own, so it samples the module at its cable alone.
};

/// Waits for touches, and says which controller felt them. Not thread-safe.
class TouchFinder {
 public:
  /// Lets every board sample: those without a table of a design get one of what they see. Takes up to 1.5 s. A board
  /// that cannot is said and never feels anything. `bus` and `design` outlive this. Throws as Controller does.
  TouchFinder(Bus& bus, const design::Design& design, std::vector<FeelingBoard> boards, const IdentifyOptions& options);

  /// Asks for a touch of `patch`; returns the number of the board that felt it. Empty: none did in time. Boards that
  /// were found before are not considered.
  std::optional<std::size_t> find(int patch);

 private:
  struct Probe {
    FeelingBoard board;
    bool samples = false, found = false;
    wire::LiveTaxels rest;
  };
  void let_sample(Probe& probe);
  void settle();
  void take_rest();
  [[nodiscard]] double strength(const Probe& probe) const;
  std::optional<std::size_t> felt(bool& doubtful);
  std::optional<std::size_t> wait(std::uint64_t until_us);
  std::optional<std::size_t> press(TouchActuator& actuator, int patch);

  Bus& bus_;
  const design::Design& design_;
  const IdentifyOptions& options_;
  std::vector<Probe> probes_;
};

}  // namespace triskin::device
