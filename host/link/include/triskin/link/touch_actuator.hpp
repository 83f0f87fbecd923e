// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace triskin::device {

class Link;

/// Presses modules of a skin on request. Simulated links come with one (touch_actuator_of); a bench robot that presses
/// real modules can be another. Threads: that of the link.
class TouchActuator {
 public:
  virtual ~TouchActuator() = default;
  /// Presses module `module` (id in the design) at its centre, wide enough for all of its taxels, or with the tip one
  /// taxel (0..11; −1: the whole module). Lifts the tip from where it was. Takes effect at the link's time of the
  /// call. Throws as Link::send does.
  virtual void press(int module, int taxel = -1) = 0;
  /// Lifts the tip; without effect when it is up. Throws as Link::send does.
  virtual void lift() = 0;
  /// Puts every taxel of a module (−1: of all) under the same pressure, kPa ≥ 0, as a bag or a foot of the module's
  /// shape does, beside what presses already; 0 takes it away. Takes effect at the link's time of the call. Throws as
  /// Link::send does.
  virtual void pressurize(int module, double kpa) = 0;
};

/// The actuator of a simulated link, owned by the link; null: the link leads to hardware, which somebody else presses.
[[nodiscard]] TouchActuator* touch_actuator_of(Link& link);

/// Actuator of one of several covers on a bus: an actuator of the whole bus counts the modules of all covers one after
/// the other, this one counts those of the cover.
class CoverTouchActuator final : public TouchActuator {
 public:
  /// `first_module`: number of the cover's module 0 on the bus. `whole` outlives this.
  CoverTouchActuator(TouchActuator& whole, int first_module) : whole_(whole), first_module_(first_module) {}
  void press(int module, int taxel) override { whole_.press(first_module_ + module, taxel); }
  void lift() override { whole_.lift(); }
  void pressurize(int module, double kpa) override {
    whole_.pressurize(module < 0 ? module : first_module_ + module, kpa);
  }

 private:
  TouchActuator& whole_;
  int first_module_;
};

}  // namespace triskin::device
