// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <string>
#include <utility>

#include "triskin/hardware/sim_link.hpp"

namespace triskin::scenario {

/// The tap reports every frame of the simulated controllers before it is used.
class TappedLink final : public link::Link {
 public:
  using OnFrame = std::function<void(const wire::CanFrame&, std::uint64_t at_us)>;
  TappedLink(hardware::Scene scene, const std::filesystem::path& folder, OnFrame on_frame)
      : link_(std::move(scene), folder), on_frame_(std::move(on_frame)) {}

  void send(const wire::CanFrame& frame) override { link_.send(frame); }
  std::optional<wire::CanFrame> receive(std::uint64_t until_us) override {
    auto frame = link_.receive(until_us);
    if (frame && on_frame_) on_frame_(*frame, link_.now_us());
    return frame;
  }
  [[nodiscard]] std::uint64_t now_us() const override { return link_.now_us(); }
  [[nodiscard]] bool fd() const override { return link_.fd(); }
  [[nodiscard]] std::uint64_t answer_us() const override { return link_.answer_us(); }
  [[nodiscard]] std::string name() const override { return link_.name(); }
  [[nodiscard]] std::uint64_t sample_ns(std::uint8_t node) const override { return link_.sample_ns(node); }
  [[nodiscard]] hardware::VirtualSkin& skin() { return link_.skin(); }

 private:
  hardware::SimLink link_;
  OnFrame on_frame_;
};

}  // namespace triskin::scenario
