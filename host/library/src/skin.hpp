// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <condition_variable>
#include <deque>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "triskin/connect/open_link.hpp"
#include "triskin/design/design.hpp"
#include "triskin/design/side_by_side.hpp"
#include "triskin/link/link.hpp"
#include "triskin/robot/site.hpp"
#include "triskin/session/bus.hpp"
#include "triskin/session/stream.hpp"
#include "triskin/skin/touch_map.hpp"
#include "triskin/triskin.h"

namespace triskin::library {

/// What is opened: the covers of a robot on its buses, or the one of a design file.
struct Source {
  robot::Site site;
  design::Design design;                     ///< all covers as one; of a design file itself
  std::vector<design::CoverOffset> offsets;  ///< indexed by cover: first numbers of its modules and patches in `design`
  std::vector<std::string> covers;           ///< names of the covers
  device::LinkOptions link;
};
/// Reads what `file` names. Throws InputError.
[[nodiscard]] Source read_source(const std::string& file, const triskin_options& options);

/// What the counts of a module are worth.
struct ModuleCalibration {
  std::array<double, layout::kTaxelsPerModule> counts_per_kpa{};  ///< 0: not known
  double taxel_area_mm2 = 0.0;
  bool known = false;
};

/// One bus with what hangs on it. Threads: that of the bus, and nobody else while it runs.
class BusReader {
 public:
  using OnSample = std::function<void(const triskin_sample& sample, const device::ModuleSample& frame)>;
  /// Opens the link; `source` outlives it. Throws InputError, DeviceError.
  BusReader(const Source& source, std::size_t bus);
  /// Begins the stream; samples have module numbers of Source::design, and so has the frame that `on_sample` gets.
  /// Throws as device::Stream.
  void start(const device::StreamOptions& options, OnSample on_sample);
  [[nodiscard]] bool runs() const { return stream_ != nullptr; }
  /// Receives until that time of the link. Throws as device::Stream.
  void run_until(std::uint64_t until_us) { stream_->run_until(until_us); }
  /// Ends the stream; its account stays.
  void stop();
  /// Counts of the running stream, or of the last one.
  [[nodiscard]] device::SampleCounts counts() const { return stream_ ? stream_->report().total : counts_; }
  [[nodiscard]] std::uint64_t now_us() const { return link_->now_us(); }
  /// Time of the link, s since 1970.
  [[nodiscard]] double unix_s(std::uint64_t link_us) const;
  /// Verifies the covers one after the other, and appends what is found. True: nothing is.
  bool verify(std::string& report);
  /// Gives `touches`, of Source::design, the rest values that are kept for the covers on this bus.
  void set_rest(device::TouchMap& touches);
  /// The calibrations of the covers on this bus, by module of Source::design; others are left as they are.
  void calibrate(std::vector<ModuleCalibration>& modules);
  [[nodiscard]] std::string name() const { return bus_.name(); }

 private:
  void take(const device::ModuleSample& frame, const OnSample& on_sample) const;

  const Source& source_;
  const robot::BusConfig& site_;
  const std::unique_ptr<device::Link> link_;
  device::Bus bus_;
  double unix_start_s_;
  std::uint64_t link_start_us_ = 0;
  std::unique_ptr<device::Stream> stream_;
  device::SampleCounts counts_;
};

/// A skin: its covers, its buses, and the samples that wait. What the C functions do, with exceptions.
class Skin {
 public:
  /// Opens the links. Throws InputError, DeviceError.
  Skin(Source source, const triskin_options& options);
  ~Skin();
  Skin(const Skin&) = delete;
  Skin& operator=(const Skin&) = delete;

  [[nodiscard]] const Source& source() const { return source_; }
  /// Begins the streams of all buses, or of none. Throws InputError, DeviceError as device::Stream.
  void start();
  /// Takes samples. Throws what ended the stream, when nothing waits.
  std::size_t read(double timeout_s, triskin_sample* samples, std::size_t capacity);
  /// Ends the streams.
  void stop();
  /// Time of the links, s since 1970.
  [[nodiscard]] double now_s() const { return buses_.front()->unix_s(buses_.front()->now_us()); }
  [[nodiscard]] triskin_counts counts();
  /// Throws DeviceError when no sample came.
  void tare();
  [[nodiscard]] std::array<double, layout::kTaxelsPerModule> change_counts(int module);
  /// Indexed by module. Throws InputError while a stream runs, DeviceError.
  [[nodiscard]] std::vector<ModuleCalibration> calibration();
  /// The report of a verification, and whether there is a finding. Throws InputError while a stream runs.
  std::pair<std::string, bool> verify();

 private:
  void receive(std::size_t bus);
  void pass(std::size_t bus, std::uint64_t until_us);
  void pass_all(std::uint64_t slice_us);
  void publish(std::size_t bus);
  void drop_old(double newest_s);
  void join();
  [[nodiscard]] bool runs() const { return buses_.front()->runs(); }

  const Source source_;
  const device::StreamOptions stream_options_;
  const double queue_s_;
  const bool virtual_time_;  // Time passes only when somebody waits.
  std::vector<std::unique_ptr<BusReader>> buses_;
  // Indexed by bus: samples of this slice, used only by the bus's receiving thread.
  std::vector<std::vector<triskin_sample>> fresh_;
  std::vector<std::thread> threads_;

  std::mutex mutex_;  // Guards the members below.
  std::condition_variable came_;
  device::TouchMap touches_;
  std::deque<triskin_sample> waiting_;
  std::vector<device::SampleCounts> by_bus_;
  std::uint64_t lost_here_ = 0;
  std::exception_ptr failure_;
  bool running_ = false, ending_ = false;
  bool started_ = false;  // Used only by the caller's thread.
};

}  // namespace triskin::library
