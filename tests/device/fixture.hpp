// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "support/strip_design.hpp"
#include "triskin/deploy/flash.hpp"
#include "triskin/diagnose/verify.hpp"
#include "triskin/scene/sim_link.hpp"
#include "triskin/session/bus.hpp"

namespace triskin::device {

using test::strip;

/// Serves tests that begin with the table of another design.
inline FlashOptions taking_over() {
  FlashOptions options;
  options.take_over = true;
  return options;
}

/// Simulates a strip on an in-process link; `restart` power-cycles everything with other faults and the same flash
/// files.
class Fixture {
 public:
  explicit Fixture(int modules, int per_patch = 16, std::vector<scene::Fault> faults = {}) {
    scene::Scene scene;
    scene.design = strip(modules, per_patch);
    scene.faults = std::move(faults);
    link_ = std::make_unique<SimLink>(std::move(scene));
    bus_ = std::make_unique<Bus>(*link_);
  }
  [[nodiscard]] const design::Design& design() const { return link_->skin().scene().design; }
  [[nodiscard]] Bus& bus() { return *bus_; }
  [[nodiscard]] scene::VirtualSkin& skin() { return link_->skin(); }
  FlashResult flash(const FlashOptions& options = taking_over()) { return device::flash(*bus_, design(), options); }
  VerifyResult verify(bool touch = true) {
    VerifyOptions options;
    options.touch = touch;
    options.actuator = link_.get();
    return device::verify(*bus_, design(), options);
  }

 private:
  std::unique_ptr<SimLink> link_;
  std::unique_ptr<Bus> bus_;
};

inline scene::Fault fault(scene::FaultKind kind, int module, int other = -1) {
  scene::Fault f;
  f.kind = kind;
  f.module = layout::ModuleId{module};
  f.other = layout::ModuleId{other};
  return f;
}

}  // namespace triskin::device
