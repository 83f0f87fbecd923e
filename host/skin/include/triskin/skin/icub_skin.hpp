// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "triskin/connect/open_link.hpp"
#include "triskin/session/icub_stream.hpp"
#include "triskin/skin/live_skin.hpp"

namespace triskin::device {

/// A skin that speaks the protocol of the iCub, as MTB4 skin boards do, and so needs no design. Threads: one.
class IcubSkin {
 public:
  using Triangles = std::map<std::pair<int, int>, wire::IcubTaxels>;

  /// Opens the link and looks for boards. `design`: for simulated links, as open_link has it. Throws as open_link and
  /// IcubStream.
  IcubSkin(const LinkOptions& link, const design::Design* design);
  /// The link that was opened.
  [[nodiscard]] Link& link() { return *link_; }
  /// Time of the link, µs.
  [[nodiscard]] std::uint64_t now_us() const { return link_->now_us(); }
  /// Boards that answer, and what arrived of their frames.
  [[nodiscard]] const IcubStream& stream() const { return stream_; }
  /// Latest values of each triangle, by board and triangle.
  [[nodiscard]] const Triangles& triangles() const { return triangles_; }
  /// Receives as LiveBus::run does. Throws Unreachable.
  void run(const LiveRun& run);

 private:
  std::unique_ptr<Link> link_;
  Bus bus_;
  Triangles triangles_;
  IcubStream stream_;
};

}  // namespace triskin::device
