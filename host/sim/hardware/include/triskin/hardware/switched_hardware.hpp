// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <deque>
#include <vector>

#include "triskin/base/format_index.hpp"
#include "triskin/hardware/scene.hpp"
#include "triskin/hardware/switched_patch.hpp"
#include "triskin/layout/index.hpp"

namespace triskin::hardware {

/// The switched modules of a scene form one chain per patch, as assembled, with the faults and their times. With joints
/// between patches (Scene::border_joints) the modules of all patches form one SwitchedPatch with several controllers.
/// If the scene has strapped modules, there are no patches here. Not thread-safe.
class SwitchedHardware {
 public:
  /// Builds the chains as designed, with the faults of the scene.
  explicit SwitchedHardware(const Scene& scene);

  /// Returns false if the scene has strapped modules.
  [[nodiscard]] bool present() const { return !patches_.empty(); }
  /// Returns the modules of patch `patch` (0-based), with those that are joined to them. Throws std::out_of_range.
  [[nodiscard]] SwitchedPatch& patch(layout::PatchIndex patch) {
    return patches_.at(joined_ ? 0U : static_cast<std::size_t>(patch));
  }
  /// Returns the number that the controller of a patch has in patch(). Throws nothing.
  [[nodiscard]] int controller_of(layout::PatchIndex patch) const { return joined_ ? patch.value() : 0; }
  /// Returns the position of a module (id in the design) in patch(). Throws std::out_of_range.
  [[nodiscard]] layout::TableRow row_of(layout::ModuleId module) const {
    return row_.at(static_cast<std::size_t>(module));
  }

  /// Starts and ends the faults that are due at virtual time `now_us`.
  void advance(std::uint64_t now_us);
  /// Returns the virtual time of the next such event, or kForever.
  [[nodiscard]] std::uint64_t next_event_us() const { return next_ < events_.size() ? events_[next_].at_us : kForever; }

 private:
  struct Event {
    std::uint64_t at_us = 0;
    Fault fault;
    bool begins = true;
  };
  void add_patch(const Scene& scene, layout::PatchIndex patch);
  void add_joined_patches(const Scene& scene);
  void plug_second_cable(const design::Patch& designed, const std::vector<int>& rotations);
  void apply(const Fault& fault, bool begins);

  bool joined_ = false;
  std::deque<SwitchedPatch> patches_;
  std::vector<design::PortEnds> joints_;  // These are the joints of patches_.
  // Both are indexed by module: the index in patches_, and the row there.
  std::vector<int> patch_;
  std::vector<layout::TableRow> row_;
  std::vector<Event> events_;  // Events are sorted by time.
  std::size_t next_ = 0;
};

}  // namespace triskin::hardware
