// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <deque>
#include <functional>
#include <optional>
#include <random>
#include <utility>

#include "triskin/hardware/sim_link.hpp"

namespace triskin::session {

/// Delays every frame to the host on a simulated link, in order: by a uniform jitter, and by the value of `more_us` for
/// the time at which it left the controller.
class JitteryLink final : public link::Link {
 public:
  JitteryLink(hardware::Scene scene, std::uint64_t jitter_us, unsigned seed)
      : inner_(std::move(scene)), jitter_us_(jitter_us), random_(seed) {}
  std::function<std::uint64_t(std::uint64_t)> more_us;
  [[nodiscard]] hardware::VirtualSkin& skin() { return inner_.skin(); }

  void send(const wire::CanFrame& frame) override { inner_.send(frame); }
  std::optional<wire::CanFrame> receive(std::uint64_t until_us) override {
    while (true) {
      if (!held_.empty() && held_.front().first <= now_us()) {
        const wire::CanFrame frame = held_.front().second;
        held_.pop_front();
        return frame;
      }
      const std::uint64_t next_us = held_.empty() ? until_us : std::min(until_us, held_.front().first);
      if (const auto frame = inner_.receive(next_us)) {
        const std::uint64_t late_us = jitter_us_ == 0 ? 0 : random_() % jitter_us_;
        last_us_ = std::max(last_us_, now_us() + late_us + (more_us ? more_us(now_us()) : 0));
        held_.emplace_back(last_us_, *frame);
      } else if (now_us() >= until_us && (held_.empty() || held_.front().first > until_us)) {
        return std::nullopt;
      }
    }
  }
  [[nodiscard]] std::uint64_t now_us() const override { return inner_.now_us(); }
  [[nodiscard]] bool fd() const override { return true; }
  [[nodiscard]] std::uint64_t answer_us() const override { return inner_.answer_us(); }
  [[nodiscard]] std::string name() const override { return "jittery"; }

 private:
  hardware::SimLink inner_;
  std::uint64_t jitter_us_;
  std::mt19937 random_;
  std::deque<std::pair<std::uint64_t, wire::CanFrame>> held_;
  std::uint64_t last_us_ = 0;
};

}  // namespace triskin::session
