// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "triskin/skin/live_skin.hpp"
#include "triskin/view/live_skin.hpp"
#include "triskin/view/server.hpp"

namespace triskin::cli {

/// Commands of pages on their way to the threads of the links; each thread gets all of them. Thread-safe; of too many
/// the oldest are dropped.
class CommandQueue {
 public:
  /// Serves `readers` threads, 1 or more.
  explicit CommandQueue(std::size_t readers) : commands_(readers) {}
  static constexpr std::size_t kMaxWaiting = 64;
  void push(const view::Command& command);
  /// The oldest one that `reader`, 0-based, has not taken; empty: there is none.
  [[nodiscard]] std::optional<view::Command> pop(int reader);

 private:
  std::mutex mutex_;
  std::vector<std::deque<view::Command>> commands_;
};

/// Reads the streams of all buses of a skin into `live` until the process is asked to end; buses side by side. `link`:
/// its name on the page. `offsets`: by cover of the robot file, ids of its modules on the page. A link that fails is
/// stated on the page and opened again every second. Virtual time is held to the clock on the wall. Throws InputError
/// when a link cannot be used at all.
device::LiveTotals feed(device::LiveSkin& skin, const std::string& link, const device::StreamOptions& stream,
                        const std::vector<design::CoverOffset>& offsets, view::LiveSkin& live, CommandQueue& commands);

}  // namespace triskin::cli
