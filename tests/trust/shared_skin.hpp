// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <vector>

#include "support/strip_design.hpp"
#include "triskin/deploy/flash.hpp"
#include "triskin/hardware/virtual_skin.hpp"
#include "triskin/link/link.hpp"
#include "triskin/session/bus.hpp"
#include "triskin/wire/taxel_frames.hpp"

namespace triskin::test {

/// This is the default time between two samples of a module, for a controller with 16 modules.
inline constexpr double kSequence_us = 36'900.0;

/// A sample is named by node address, row and number.
struct SampleName {
  int node = 0, row = 0;
  std::uint32_t number = 0;
  auto operator<=>(const SampleName&) const = default;
};

/// Simulates one bus with several computers on it, in virtual time, and counts every sample that leaves the bus.
class SharedSkin {
 public:
  explicit SharedSkin(hardware::Scene scene) : skin_(std::move(scene)) {
    skin_.on_frame([this](const wire::CanFrame& frame, std::uint64_t) { arrived(frame); });
  }
  class Client final : public link::Link {
   public:
    explicit Client(SharedSkin& hub) : hub_(hub) { hub_.clients_.insert(this); }
    ~Client() override { hub_.clients_.erase(this); }
    Client(const Client&) = delete;
    Client& operator=(const Client&) = delete;
    void send(const wire::CanFrame& frame) override {
      if (cut_) throw link::Unreachable("cut");
      hub_.skin_.send(frame);
    }
    std::optional<wire::CanFrame> receive(std::uint64_t until_us) override {
      if (cut_) throw link::Unreachable("cut");
      while (inbox_.empty() && hub_.skin_.now_us() < until_us) (void)hub_.skin_.run_until_frame(until_us);
      if (inbox_.empty()) return std::nullopt;
      const wire::CanFrame frame = inbox_.front();
      inbox_.pop_front();
      return frame;
    }
    [[nodiscard]] std::uint64_t now_us() const override { return hub_.skin_.now_us(); }
    [[nodiscard]] bool fd() const override { return true; }
    [[nodiscard]] std::uint64_t answer_us() const override { return 100'000; }
    [[nodiscard]] std::string name() const override { return "shared"; }
    [[nodiscard]] std::uint64_t sample_ns(std::uint8_t) const override {
      return wire::full_sample_ns(hub_.skin_.bit_rates());
    }
    [[nodiscard]] std::uint64_t thrown_away() const override { return thrown_away_; }
    /// Simulates that its program dies: no frame goes in or out any more.
    void cut() {
      cut_ = true;
      inbox_.clear();
    }
    /// Frames for which this returns true never arrive; with `count` they are counted as thrown away.
    std::function<bool(const wire::CanFrame&)> lose;
    bool count = false;

   private:
    friend class SharedSkin;
    SharedSkin& hub_;
    std::deque<wire::CanFrame> inbox_;
    bool cut_ = false;
    std::uint64_t thrown_away_ = 0;
  };

  [[nodiscard]] hardware::VirtualSkin& skin() { return skin_; }
  [[nodiscard]] const design::Design& design() const { return skin_.scene().design; }
  void flash() {
    Client client(*this);
    session::Bus bus(client);
    (void)deploy::flash(bus, design());
  }
  /// Returns the samples that left the bus since the last call of forget().
  [[nodiscard]] const std::set<SampleName>& on_bus() const { return on_bus_; }
  void forget() { on_bus_.clear(); }

 private:
  void arrived(const wire::CanFrame& frame) {
    if (const auto t = wire::decode_full(frame)) on_bus_.insert({t->node_address, t->module, t->sample});
    for (Client* c : clients_) {
      if (c->cut_) continue;
      if (c->lose && c->lose(frame)) {
        if (c->count) ++c->thrown_away_;
        continue;
      }
      c->inbox_.push_back(frame);
    }
  }
  hardware::VirtualSkin skin_;
  std::set<Client*> clients_;
  std::set<SampleName> on_bus_;
};

inline hardware::Scene strip_scene(int modules, int per_patch, std::uint64_t bit_rate = 0,
                                   std::uint64_t data_rate = 0) {
  hardware::Scene scene;
  scene.design = strip(modules, per_patch);
  scene.effects.bus_bit_rate = bit_rate;
  scene.effects.bus_data_bit_rate = data_rate;
  return scene;
}

}  // namespace triskin::test
