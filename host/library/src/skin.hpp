// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <condition_variable>
#include <deque>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "triskin/design/design.hpp"
#include "triskin/jobs/touch_map.hpp"
#include "triskin/link/link.hpp"
#include "triskin/session/bus.hpp"
#include "triskin/session/stream.hpp"
#include "triskin/simlink/open_link.hpp"
#include "triskin/triskin.h"

namespace triskin::library {

/// What is opened: one design on one link. A file that names many covers is to become many of these.
struct Source {
  design::Design design;
  device::LinkOptions link;
};
/// Reads what `file` names. Throws InputError.
[[nodiscard]] Source read_source(const std::string& file, const triskin_options& options);

/// A skin: its design, its link, and the samples that wait. What the C functions do, with exceptions.
class Skin {
 public:
  /// Opens the link. Throws InputError, DeviceError.
  Skin(Source source, const triskin_options& options);
  ~Skin();
  Skin(const Skin&) = delete;
  Skin& operator=(const Skin&) = delete;

  [[nodiscard]] const design::Design& design() const { return design_; }
  /// Begins the stream. Throws InputError, DeviceError as device::Stream.
  void start();
  /// Takes samples. Throws what ended the stream, when nothing waits.
  std::size_t read(double timeout_s, triskin_sample* samples, std::size_t capacity);
  /// Ends the stream.
  void stop();
  /// Time of the link, s since 1970.
  [[nodiscard]] double now_s() const;
  [[nodiscard]] triskin_counts counts();
  /// Throws DeviceError when no sample came.
  void tare();
  [[nodiscard]] std::array<double, layout::kTaxelsPerModule> change_counts(int module);
  /// The report of a verification, and whether there is a finding. Throws InputError while a stream runs.
  std::pair<std::string, bool> verify();

 private:
  void receive();
  void pass(std::uint64_t until_us);
  void add(const device::ModuleFrame& frame);
  void publish();
  void drop_old(double newest_s);
  [[nodiscard]] double unix_s(std::uint64_t link_us) const;
  void join();

  const design::Design design_;
  const device::StreamOptions stream_options_;
  const double queue_s_;
  const std::unique_ptr<device::Link> link_;
  const bool virtual_time_;  // time passes only when somebody waits
  device::Bus bus_;
  std::unique_ptr<device::Stream> stream_;
  double unix_start_s_;
  std::uint64_t link_start_us_ = 0;
  std::vector<triskin_sample> fresh_;  // of this slice; the receiving thread alone
  std::thread thread_;

  std::mutex mutex_;  // of what follows
  std::condition_variable came_;
  device::TouchMap touches_;
  std::deque<triskin_sample> waiting_;
  triskin_counts counts_{};
  std::exception_ptr failure_;
  bool running_ = false, ending_ = false;
  bool started_ = false;  // once at least; the caller's thread alone
};

}  // namespace triskin::library
