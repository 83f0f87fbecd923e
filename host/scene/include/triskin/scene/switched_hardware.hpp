// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <deque>
#include <vector>

#include "triskin/scene/scene.hpp"
#include "triskin/scene/switched_patch.hpp"

namespace triskin::scene {

/// The switched modules of a scene: one chain a patch, as assembled, and what breaks when. Without patches where the
/// scene has strapped modules. Not thread-safe.
class SwitchedHardware {
 public:
  /// Builds the chains as designed, with the faults of the scene.
  explicit SwitchedHardware(const Scene& scene);

  /// False: the scene has strapped modules.
  [[nodiscard]] bool present() const { return !patches_.empty(); }
  /// Chain of patch `patch` (0-based). Throws std::out_of_range.
  [[nodiscard]] SwitchedPatch& patch(int patch) { return patches_.at(static_cast<std::size_t>(patch)); }
  /// Position of a module (id in the design) in its patch. Throws std::out_of_range.
  [[nodiscard]] int row_of(int module) const { return row_.at(static_cast<std::size_t>(module)); }

  /// Begins and ends the faults that are due at virtual time `now_us`.
  void advance(std::uint64_t now_us);
  /// Virtual time of the next such event, kForever: none.
  [[nodiscard]] std::uint64_t next_event_us() const { return next_ < events_.size() ? events_[next_].at_us : kForever; }

 private:
  struct Event {
    std::uint64_t at_us = 0;
    Fault fault;
    bool begins = true;
  };
  void add_patch(const Scene& scene, int patch);
  void plug_second_cable(const design::Patch& designed, const std::vector<int>& rotations);
  void apply(const Fault& fault, bool begins);

  std::deque<SwitchedPatch> patches_;
  std::vector<design::PortEnds> joints_;
  std::vector<int> patch_, row_;  // by module
  std::vector<Event> events_;     // by time
  std::size_t next_ = 0;
};

}  // namespace triskin::scene
