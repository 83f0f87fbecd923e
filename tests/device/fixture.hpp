// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "triskin/device/bus.hpp"
#include "triskin/device/flash.hpp"
#include "triskin/device/sim_link.hpp"
#include "triskin/device/verify.hpp"

namespace triskin::device {

/// A strip of `count` modules as in tests/scene: line k / 4, address k % 4 within a patch.
inline model::Design strip(int count, int per_patch = 16) {
  using geometry::kHeight_mm;
  using geometry::Vec3;
  model::Design d;
  d.name = "strip";
  d.source_file = "strip.obj";
  d.surface.vertices = {{-1, -1, 0}, {1000, -1, 0}, {1000, 30, 0}, {-1, 30, 0}};
  d.surface.faces = {{0, 1, 2}, {0, 2, 3}};
  d.layout.islands = 1;
  d.layout.method = "surface";
  for (int k = 0; k < count; ++k) {
    const double x = 30.0 * (k / 2);
    const int next = k + 1 < count ? k + 1 : -1;
    geometry::PlacedModule m;
    m.tile = {k / 2, 0, k % 2 == 0};
    if (m.tile.up) {
      m.corner_mm = {Vec3{x, 0, 0}, Vec3{x + 30, 0, 0}, Vec3{x + 15, kHeight_mm, 0}};
      m.neighbour = {-1, next, k - 1};
    } else {
      m.corner_mm = {Vec3{x + 30, 0, 0}, Vec3{x + 45, kHeight_mm, 0}, Vec3{x + 15, kHeight_mm, 0}};
      m.neighbour = {next, -1, k - 1};
    }
    d.layout.modules.push_back(m);
  }
  for (int first = 0; first < count; first += per_patch) {
    geometry::Patch patch;
    patch.entry = first;
    for (int k = first; k < std::min(count, first + per_patch); ++k) {
      const int n = k - first;
      patch.modules.push_back({k, n == 0 ? -1 : k - 1, 2, n / 4, n % 4, n});
    }
    d.patches.push_back(patch);
  }
  d.design_id = model::design_id_of(d);
  return d;
}

/// A simulated strip on an in-process link; `restart` power-cycles everything with other faults and the same flash files.
class Bench {
 public:
  explicit Bench(int modules, int per_patch = 16, std::vector<scene::Fault> faults = {}) {
    scene::Scene scene;
    scene.design = strip(modules, per_patch);
    scene.faults = std::move(faults);
    link_ = std::make_unique<SimLink>(std::move(scene));
    bus_ = std::make_unique<Bus>(*link_);
  }
  [[nodiscard]] const model::Design& design() const { return link_->skin().scene().design; }
  [[nodiscard]] Bus& bus() { return *bus_; }
  [[nodiscard]] scene::VirtualSkin& skin() { return link_->skin(); }
  FlashResult flash(const FlashOptions& options = {}) { return device::flash(*bus_, design(), options); }
  VerifyResult verify(bool touch = true) {
    VerifyOptions options;
    options.touch = touch;
    return device::verify(*bus_, design(), options);
  }

 private:
  std::unique_ptr<SimLink> link_;
  std::unique_ptr<Bus> bus_;
};

inline scene::Fault fault(scene::FaultKind kind, int module, int other = -1) {
  scene::Fault f;
  f.kind = kind;
  f.module = module;
  f.other = other;
  return f;
}

}  // namespace triskin::device
