// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <vector>

#include "triskin/deploy/identify.hpp"

namespace triskin::deploy {

/// Only a controller whose address is not shared can be asked what it feels.
struct FeelingBoard {
  wire::NodeClaim claim;
  BoardShape shape;
  /// The board's shape fits these patches; an empty list means that it fits none.
  std::vector<layout::PatchIndex> likely;
  bool across = false;  ///< The board reaches into neighbouring patches, so it samples only the module at its cable.
};

/// Waits for touches and reports which controller felt them. Not thread-safe.
class TouchFinder {
 public:
  /// Makes every board sample; those without a table of a design get one for the chips that they see. Takes up to 1.5
  /// s. A board that cannot sample is reported and never feels a touch. `bus` and `design` must outlive the object.
  /// Throws as Controller does.
  TouchFinder(session::Bus& bus, const design::Design& design, std::vector<FeelingBoard> boards,
              const IdentifyOptions& options);

  /// Asks for a touch of `patch`; returns the index of the board that felt it, or nothing if none did in time. Boards
  /// that were already found are not considered.
  std::optional<std::size_t> find(layout::PatchIndex patch);

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
  std::optional<std::size_t> press(link::TouchActuator& actuator, layout::PatchIndex patch);

  session::Bus& bus_;
  const design::Design& design_;
  const IdentifyOptions& options_;
  std::vector<Probe> probes_;
};

}  // namespace triskin::deploy
