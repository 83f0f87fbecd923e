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

#include "triskin/session/sample_account.hpp"
#include "triskin/skin/live_skin.hpp"

namespace triskin::device {

/// A sample that waits to be read.
struct QueuedSample {
  int module = 0;              ///< counted over all covers
  std::uint64_t unix_ns = 0;   ///< when the controller took it, ns since 1970
  std::uint32_t error_us = 0;  ///< bound of the error of that time; LinkTime::kUnbounded: not known yet
  wire::TaxelFrame frame;
};

/// Receives the samples of a skin while the program does something else: a thread for each bus receives them, and they
/// wait to be read. On a simulation in this process there is no thread: virtual time passes while somebody waits. Use
/// it from one thread at a time.
class SampleQueue {
 public:
  /// `skin` outlives it and is open. `first_modules`: number of the first module of each cover, indexed by cover of the
  /// site; `modules`: of all covers. `keep_s`: older samples that nobody reads are dropped.
  SampleQueue(LiveSkin& skin, std::vector<int> first_modules, std::size_t modules, double keep_s, bool virtual_time);
  /// Ends the streams.
  ~SampleQueue();
  SampleQueue(const SampleQueue&) = delete;
  SampleQueue& operator=(const SampleQueue&) = delete;

  /// Begins the streams of all buses, or of none; without effect while they run. Throws as LiveBus::start.
  void start(const StreamOptions& options);
  /// True while streams run.
  [[nodiscard]] bool runs() const;
  /// True once start() has succeeded.
  [[nodiscard]] bool started() const { return started_; }
  /// Takes at most `capacity` samples, oldest first; waits at most `timeout_s` for the first one. Throws what ended the
  /// streams, when nothing waits.
  [[nodiscard]] std::vector<QueuedSample> read(double timeout_s, std::size_t capacity);
  /// Ends the streams; waiting samples can still be read.
  void stop();
  /// Samples of all streams until now.
  [[nodiscard]] SampleCounts counts();
  /// Samples that were dropped because nobody read them.
  [[nodiscard]] std::uint64_t dropped();
  /// Takes new rest values on all covers while the streams run; takes at most Tare::kLimit_us. Throws DeviceError when
  /// no valid sample arrived, and what ended the streams.
  void tare();
  /// Pressure of each taxel of a module by its latest sample, counts below rest; 0 where nothing is known.
  [[nodiscard]] std::array<double, layout::kTaxelsPerModule> change_counts(int module);

 private:
  enum class TareStep { kNone, kAsked, kRunning, kNoSample, kEnded };
  void start_bus(LiveBus& bus, const StreamOptions& options);
  void take(std::size_t bus, const LiveSample& sample);
  void receive(std::size_t bus);
  void pass(std::size_t bus, std::uint64_t slice_us);
  void pass_all(std::uint64_t slice_us);
  void publish(std::size_t bus);
  void drop_old(std::uint64_t newest_ns);
  void join();
  [[nodiscard]] bool tare_runs() const;

  LiveSkin& skin_;
  const std::vector<int> first_modules_;
  const std::uint64_t keep_ns_;
  const bool virtual_time_;
  std::vector<std::vector<QueuedSample>> fresh_;  // Samples of this slice, indexed by bus; used by its thread alone.
  std::vector<std::thread> threads_;

  std::mutex mutex_;  // Guards the members below.
  std::condition_variable came_;
  std::vector<std::array<double, layout::kTaxelsPerModule>> change_counts_;  // Indexed by module.
  std::deque<QueuedSample> waiting_;
  std::vector<SampleCounts> by_bus_;
  std::vector<TareStep> tare_;  // Indexed by bus.
  std::uint64_t dropped_ = 0;
  std::exception_ptr failure_;
  bool running_ = false, ending_ = false;
  bool started_ = false;  // Used only by the caller's thread.
};

}  // namespace triskin::device
