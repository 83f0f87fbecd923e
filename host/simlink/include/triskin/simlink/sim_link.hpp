// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <deque>

#include "triskin/link/link.hpp"
#include "triskin/scene/virtual_skin.hpp"

namespace triskin::device {

/// The simulation in this process. Waiting advances virtual time; nothing depends on the wall clock. Threads: one.
class SimLink final : public Link, private Finger {
 public:
  /// Powers the skin of the scene; `state_folder` keeps the flash of its controllers, empty: memory. Throws as
  /// scene::VirtualSkin does.
  explicit SimLink(scene::Scene scene, const std::filesystem::path& state_folder = {});

  void send(const wire::CanFrame& frame) override;
  std::optional<wire::CanFrame> receive(std::uint64_t until_us) override;
  [[nodiscard]] std::uint64_t now_us() const override { return skin_.now_us(); }
  [[nodiscard]] bool fd() const override { return true; }
  [[nodiscard]] std::uint64_t answer_us() const override;
  [[nodiscard]] std::string name() const override { return "sim"; }
  [[nodiscard]] Finger* finger() override { return this; }
  [[nodiscard]] std::uint64_t sample_ns(std::uint8_t) const override { return wire::full_sample_ns(skin_.bit_rates()); }
  /// The simulated hardware, to change it while it runs.
  [[nodiscard]] scene::VirtualSkin& skin() { return skin_; }

 private:
  void press(int module, int taxel) override;
  void lift() override;
  void pressurize(int module, double kpa) override { skin_.pressurize(module, kpa); }

  scene::VirtualSkin skin_;
  std::deque<wire::CanFrame> inbox_;
  int touch_ = 0;
};

}  // namespace triskin::device
