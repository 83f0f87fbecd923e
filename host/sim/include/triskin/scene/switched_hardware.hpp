// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <deque>
#include <vector>

#include "triskin/scene/scene.hpp"
#include "triskin/scene/switched_patch.hpp"

namespace triskin::scene {

/// The switched modules of a scene: one chain a patch, as assembled, and what breaks when. With joints between patches
/// (Scene::border_joints) the modules of all patches are one SwitchedPatch, with a controller each. Without patches
/// where the scene has strapped modules. Not thread-safe.
class SwitchedHardware {
 public:
  /// Builds the chains as designed, with the faults of the scene.
  explicit SwitchedHardware(const Scene& scene);

  /// False: the scene has strapped modules.
  [[nodiscard]] bool present() const { return !patches_.empty(); }
  /// Modules of patch `patch` (0-based), with those that are joined to them. Throws std::out_of_range.
  [[nodiscard]] SwitchedPatch& patch(int patch) { return patches_.at(joined_ ? 0U : static_cast<std::size_t>(patch)); }
  /// Number of the controller of a patch in patch(). Throws nothing.
  [[nodiscard]] int controller_of(int patch) const { return joined_ ? patch : 0; }
  /// Position of a module (id in the design) in patch(). Throws std::out_of_range.
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
  void add_joined_patches(const Scene& scene);
  void plug_second_cable(const design::Patch& designed, const std::vector<int>& rotations);
  void apply(const Fault& fault, bool begins);

  bool joined_ = false;
  std::deque<SwitchedPatch> patches_;
  std::vector<design::PortEnds> joints_;  // Joints of patches_.
  std::vector<int> patch_, row_;          // Indexed by module: index in patches_, and row there.
  std::vector<Event> events_;             // Sorted by time.
  std::size_t next_ = 0;
};

}  // namespace triskin::scene
