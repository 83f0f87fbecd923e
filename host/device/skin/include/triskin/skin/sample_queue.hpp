// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "triskin/base/format_index.hpp"
#include "triskin/layout/index.hpp"
#include "triskin/session/sample_account.hpp"
#include "triskin/skin/live_skin.hpp"

namespace triskin::skin {

/// The sample waits in the queue until a caller reads it.
struct QueuedSample {
  layout::SkinModule module;
  std::uint64_t unix_ns = 0;  ///< The controller took the sample at this time, in ns since 1970.
  /// The time has at most this error; LinkTime::kUnbounded means that it is not known yet.
  std::uint32_t error_us = 0;
  wire::TaxelFrame frame;
};

/// Receives the samples of a skin in the background: one thread for each bus receives them into a queue. With a
/// simulation in this process there is no thread; virtual time passes while a caller waits. Use it from one thread at a
/// time.
class SampleQueue {
 public:
  /// `skin` must be open and outlive the queue. `first_modules` has the number of the first module of each cover,
  /// indexed by cover of the site; `modules` is the total. Samples older than `keep_s` that nobody reads are dropped.
  SampleQueue(LiveSkin& skin, std::vector<layout::SkinModule> first_modules, std::size_t modules, double keep_s,
              bool virtual_time);
  /// Ends the streams.
  ~SampleQueue();
  SampleQueue(const SampleQueue&) = delete;
  SampleQueue& operator=(const SampleQueue&) = delete;

  /// Starts the streams of all buses, or of none if one fails. A call while they run has no effect. Throws as
  /// LiveBus::start.
  void start(const session::StreamOptions& options);
  /// Returns true while streams run.
  [[nodiscard]] bool runs() const;
  /// Returns true once start() has succeeded.
  [[nodiscard]] bool started() const { return started_; }
  /// Removes and returns at most `capacity` samples, oldest first; waits at most `timeout_s` for the first one. When
  /// the queue is empty, throws the exception that ended the streams.
  [[nodiscard]] std::vector<QueuedSample> read(double timeout_s, std::size_t capacity);
  /// Ends the streams; samples in the queue can still be read.
  void stop();
  /// Returns the counts of samples over all streams so far.
  [[nodiscard]] session::SampleCounts counts();
  /// Returns the number of samples that were dropped because nobody read them.
  [[nodiscard]] std::uint64_t dropped();
  /// Takes new rest values on all covers while the streams run; takes at most Tare::kLimit_us. Throws DeviceError when
  /// no valid sample arrived, and the exception that ended the streams.
  void tare();
  /// Returns the latest pressure on each taxel of a module in counts below rest; 0 where nothing is known.
  [[nodiscard]] std::array<double, layout::kTaxelsPerModule> change_counts(layout::SkinModule module);

 private:
  enum class TareStep { kNone, kAsked, kRunning, kNoSample, kEnded };
  void start_bus(LiveBus& bus, const session::StreamOptions& options);
  void take(std::size_t bus, const LiveSample& sample);
  void receive(std::size_t bus);
  void pass(std::size_t bus, std::uint64_t slice_us);
  void pass_all(std::uint64_t slice_us);
  void publish(std::size_t bus);
  void drop_old(std::uint64_t newest_ns);
  void join();
  [[nodiscard]] bool tare_runs() const;

  LiveSkin& skin_;
  const std::vector<layout::SkinModule> first_modules_;
  const std::uint64_t keep_ns_;
  const bool virtual_time_;
  // The samples of the present slice are indexed by bus; only the thread of the bus uses its entry.
  std::vector<std::vector<QueuedSample>> fresh_;
  std::vector<std::thread> threads_;

  std::mutex mutex_;  // The mutex guards the members below.
  std::condition_variable came_;
  std::vector<std::array<double, layout::kTaxelsPerModule>> change_counts_;
  std::deque<QueuedSample> waiting_;
  std::vector<session::SampleCounts> by_bus_;
  std::vector<TareStep> tare_;
  std::uint64_t dropped_ = 0;
  std::exception_ptr failure_;
  bool running_ = false, ending_ = false;
  bool started_ = false;  // Only the caller's thread uses this flag, so the mutex does not guard it.
};

}  // namespace triskin::skin
