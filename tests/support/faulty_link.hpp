// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <optional>
#include <random>
#include <vector>

#include "triskin/link/link.hpp"

namespace triskin::test {

/// Loses, doubles, delays and so reorders frames in both directions, or is unplugged after a number of frames.
class FaultyLink final : public link::Link {
 public:
  struct Rates {  // Rates are in percent of the frames.
    unsigned drop = 0, duplicate = 0, reorder = 0, delay = 0;
  };
  FaultyLink(link::Link& inner, bool fd, Rates rates, unsigned seed)
      : inner_(inner), fd_(fd), rates_(rates), random_(seed) {}

  /// This many frames of both directions may still pass.
  std::optional<std::uint64_t> frames_left;
  /// Called after each frame that the host has sent, to act as another tester on the bus.
  std::function<void()> after_send;
  std::uint64_t frames = 0;
  /// reconnect() calls this: it throws until somebody has plugged the cable in.
  std::function<void(FaultyLink&)> on_reconnect;

  void send(const wire::CanFrame& frame) override {
    mangle(frame, out_);
    release(out_);
    if (after_send) after_send();
  }
  std::optional<wire::CanFrame> receive(std::uint64_t until_us) override {
    while (true) {
      release(out_);
      if (auto frame = take(in_)) return frame;
      if (now_us() >= until_us && in_.empty()) return inner_receive(until_us);
      if (now_us() >= until_us) return std::nullopt;
      std::uint64_t until = until_us;
      for (const auto* held : {&in_, &out_}) {
        for (const Held& h : *held) until = std::min(until, std::max(h.at_us, now_us() + 1));
      }
      if (const auto frame = inner_.receive(until)) mangle(*frame, in_);
    }
  }
  [[nodiscard]] std::uint64_t now_us() const override { return inner_.now_us(); }
  [[nodiscard]] bool fd() const override { return fd_; }
  [[nodiscard]] std::uint64_t answer_us() const override { return inner_.answer_us(); }
  [[nodiscard]] std::string name() const override { return "faulty"; }
  void reconnect() override {
    if (on_reconnect) on_reconnect(*this);
  }

 private:
  struct Held {
    std::uint64_t at_us;
    wire::CanFrame frame;
  };
  static constexpr std::uint64_t kReorder_us = 2'000, kDelay_us = 400'000;

  std::optional<wire::CanFrame> inner_receive(std::uint64_t until_us) {
    if (const auto frame = inner_.receive(until_us)) mangle(*frame, in_);
    return take(in_);
  }
  void mangle(const wire::CanFrame& frame, std::vector<Held>& to) {
    ++frames;
    if (frames_left && *frames_left == 0) return;
    if (frames_left) --*frames_left;
    unsigned dice = static_cast<unsigned>(random_() % 100);
    const auto hit = [&](unsigned percent) {
      const bool yes = dice < percent;
      dice = yes ? 100 : dice - percent;
      return yes;
    };
    if (hit(rates_.drop)) return;
    if (hit(rates_.duplicate)) to.push_back({now_us(), frame});
    std::uint64_t at_us = now_us();
    if (hit(rates_.reorder))
      at_us += random_() % kReorder_us;
    else if (hit(rates_.delay))
      at_us += random_() % kDelay_us;
    to.push_back({at_us, frame});
  }
  std::optional<wire::CanFrame> take(std::vector<Held>& from) {
    for (auto h = from.begin(); h != from.end(); ++h) {
      if (h->at_us > now_us()) continue;
      const wire::CanFrame frame = h->frame;
      from.erase(h);
      return frame;
    }
    return std::nullopt;
  }
  void release(std::vector<Held>& held) {
    while (const auto frame = take(held)) inner_.send(*frame);
  }

  link::Link& inner_;
  bool fd_;
  Rates rates_;
  std::mt19937 random_;
  std::vector<Held> in_, out_;
};

}  // namespace triskin::test
