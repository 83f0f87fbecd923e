// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "triskin/connect/open_link.hpp"
#include "triskin/session/icub_stream.hpp"
#include "triskin/skin/live_skin.hpp"

namespace triskin::skin {

/// A skin that uses the iCub protocol, as MTB4 skin boards do, and therefore needs no design. Threads: one.
class IcubSkin {
 public:
  using Triangles = std::map<std::pair<int, int>, wire::IcubTaxels>;

  /// Opens the link and searches for boards. `design` is for simulated links, as in open_link. Throws as open_link and
  /// IcubStream.
  IcubSkin(const connect::LinkOptions& link, const design::Design* design);
  /// Returns the link that was opened.
  [[nodiscard]] link::Link& link() { return *link_; }
  /// Returns the time of the link in µs.
  [[nodiscard]] std::uint64_t now_us() const { return link_->now_us(); }
  /// Returns the boards that answered, with the count of their frames.
  [[nodiscard]] const session::IcubStream& stream() const { return stream_; }
  /// Returns the latest values of each triangle, by board and triangle.
  [[nodiscard]] const Triangles& triangles() const { return triangles_; }
  /// Receives frames as LiveBus::run does. Throws Unreachable.
  void run(const LiveRun& run);

 private:
  std::unique_ptr<link::Link> link_;
  session::Bus bus_;
  Triangles triangles_;
  session::IcubStream stream_;
};

}  // namespace triskin::skin
