// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <deque>
#include <mutex>
#include <optional>

#include "triskin/design/design.hpp"
#include "triskin/simlink/open_link.hpp"
#include "triskin/view/live_skin.hpp"
#include "triskin/view/server.hpp"

namespace triskin::cli {

/// Commands of pages on their way to the thread of the link. Thread-safe; of too many the oldest are dropped.
class CommandQueue {
 public:
  static constexpr std::size_t kMost = 64;
  void push(const view::Command& command);
  /// The oldest one; empty: there is none.
  [[nodiscard]] std::optional<view::Command> pop();

 private:
  std::mutex mutex_;
  std::deque<view::Command> commands_;
};

/// Samples of a design's stream that arrived and that were lost, over all times the link was open.
struct FeedTotals {
  std::uint64_t frames = 0, lost = 0;
};

/// Reads the stream of a link into `live` until the process is asked to end. A link that fails is stated on the page
/// and opened again every second. Virtual time is held to the clock on the wall. Throws InputError when the link cannot
/// be used at all.
FeedTotals feed(const device::LinkOptions& options, const design::Design& design, view::LiveSkin& live,
                CommandQueue& commands);

}  // namespace triskin::cli
