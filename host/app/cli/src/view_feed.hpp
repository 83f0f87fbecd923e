// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "triskin/skin/live_skin.hpp"
#include "triskin/view/latest_samples.hpp"
#include "triskin/view/server.hpp"

namespace triskin::cli {

/// Passes commands of pages to the threads of the links; each thread gets all of them. Thread-safe; if there are too
/// many, the oldest are dropped.
class CommandQueue {
 public:
  /// Serves `readers` threads, 1 or more.
  explicit CommandQueue(std::size_t readers) : commands_(readers) {}
  static constexpr std::size_t kMaxWaiting = 64;
  void push(const view::Command& command);
  /// Returns the oldest command that `reader`, 0-based, has not received, or nothing.
  [[nodiscard]] std::optional<view::Command> pop(int reader);

 private:
  std::mutex mutex_;
  std::vector<std::deque<view::Command>> commands_;
};

/// The page shows these things beside the samples.
struct ShownSkin {
  const design::Design& design;                     ///< All covers as the page shows them.
  const std::vector<design::CoverOffset>& offsets;  ///< The ids of the modules of each cover of the robot file.
  /// Of each bus, of each of its covers: it gives forces. Empty unless the calibration of all is complete.
  std::vector<std::vector<design::SkinCalibration>> calibrations{};
};

/// Reads the streams of all buses of a skin into `live` until the process is asked to end, all buses in parallel.
/// `link` is the skin's name on the page. The page shows when a link fails, and the link is opened again every second.
/// Virtual time follows the wall clock. Throws InputError when a link cannot be used at all.
skin::LiveTotals feed(skin::LiveSkin& skin, const std::string& link, const session::StreamOptions& stream,
                      const ShownSkin& shown, view::LatestSamples& live, CommandQueue& commands);

}  // namespace triskin::cli
