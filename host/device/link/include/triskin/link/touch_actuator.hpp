// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/base/format_index.hpp"
#include "triskin/layout/index.hpp"
#include "triskin/layout/taxel_id.hpp"

namespace triskin::link {

class Link;

/// Presses modules of a skin on request. Simulated links have one (touch_actuator_of); a bench robot that presses real
/// modules can be another. Use it in the thread of the link.
class TouchActuator {
 public:
  virtual ~TouchActuator() = default;
  /// Presses a module (id in the design) at its centre, wide enough for all of its taxels. The tip is lifted from its
  /// former place. Takes effect at the link's time of the call. Throws as Link::send does.
  virtual void press(layout::ModuleId module) = 0;
  /// Presses one taxel with a tip, otherwise as above.
  virtual void press(layout::TaxelId taxel) = 0;
  /// Lifts the tip; it has no effect when the tip is up. Throws as Link::send does.
  virtual void lift() = 0;
  /// Puts every taxel of a module (−1: of all) under the same pressure, kPa ≥ 0, as a bag or a foot of the module's
  /// shape does, in addition to the tip; 0 removes it. Takes effect at the link's time of the call. Throws as
  /// Link::send does.
  virtual void pressurize(layout::ModuleId module, double kpa) = 0;
};

/// Returns the actuator of a simulated link, which the link owns; null if the link leads to hardware, where a person
/// has to press.
[[nodiscard]] TouchActuator* touch_actuator_of(Link& link);

/// This actuator belongs to one of several covers on a bus. An actuator of the whole bus numbers the modules of all
/// covers consecutively, whereas this one uses the numbers of its cover.
class CoverTouchActuator final : public TouchActuator {
 public:
  /// `first_module` is the number of the cover's module 0 on the bus. `whole` must outlive this object.
  CoverTouchActuator(TouchActuator& whole, int first_module) : whole_(whole), first_module_(first_module) {}
  void press(layout::ModuleId module) override { whole_.press(on_bus(module)); }
  void press(layout::TaxelId taxel) override { whole_.press({on_bus(taxel.module), taxel.taxel}); }
  void lift() override { whole_.lift(); }
  void pressurize(layout::ModuleId module, double kpa) override {
    whole_.pressurize(module < 0 ? module : on_bus(module), kpa);
  }

 private:
  [[nodiscard]] layout::ModuleId on_bus(layout::ModuleId module) const {
    return layout::ModuleId{first_module_ + module};
  }

  TouchActuator& whole_;
  int first_module_;
};

}  // namespace triskin::link
