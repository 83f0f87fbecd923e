// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "support/strip_design.hpp"
#include "triskin/deploy/flash.hpp"
#include "triskin/diagnose/verify.hpp"
#include "triskin/hardware/sim_link.hpp"
#include "triskin/session/bus.hpp"

namespace triskin::test {

using test::strip;

/// Serves tests that begin with the table of another design.
inline deploy::FlashOptions taking_over() {
  deploy::FlashOptions options;
  options.take_over = true;
  return options;
}

/// Simulates a strip on an in-process link; `restart` power-cycles everything with other faults and the same flash
/// files.
class Fixture {
 public:
  explicit Fixture(int modules, int per_patch = 16, std::vector<hardware::Fault> faults = {}) {
    hardware::Scene scene;
    scene.design = strip(modules, per_patch);
    scene.faults = std::move(faults);
    link_ = std::make_unique<hardware::SimLink>(std::move(scene));
    bus_ = std::make_unique<session::Bus>(*link_);
  }
  [[nodiscard]] const design::Design& design() const { return link_->skin().scene().design; }
  [[nodiscard]] session::Bus& bus() { return *bus_; }
  [[nodiscard]] hardware::VirtualSkin& skin() { return link_->skin(); }
  deploy::FlashResult flash(const deploy::FlashOptions& options = taking_over()) {
    return deploy::flash(*bus_, design(), options);
  }
  diagnose::VerifyResult verify(bool touch = true) {
    diagnose::VerifyOptions options;
    options.touch = touch;
    options.actuator = link_.get();
    return diagnose::verify(*bus_, design(), options);
  }

 private:
  std::unique_ptr<hardware::SimLink> link_;
  std::unique_ptr<session::Bus> bus_;
};

inline hardware::Fault fault(hardware::FaultKind kind, int module, int other = -1) {
  hardware::Fault f;
  f.kind = kind;
  f.module = layout::ModuleId{module};
  f.other = layout::ModuleId{other};
  return f;
}

}  // namespace triskin::test
