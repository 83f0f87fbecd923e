// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "triskin/design/design.hpp"
#include "triskin/design/side_by_side.hpp"
#include "triskin/skin/live_skin.hpp"
#include "triskin/skin/sample_queue.hpp"
#include "triskin/triskin.h"

namespace triskin::library {

/// The library opens these covers: those of a robot on its buses, or the one of a design file.
struct Source {
  robot::Site site;
  design::Design design;  ///< All covers joined, or the design of a design file itself.
  /// Each cover has the numbers of its first module and patch in `design`.
  std::vector<design::CoverOffset> offsets;
  std::vector<std::string> covers;
  connect::LinkOptions link;
};
/// Reads a robot file or a design file. Throws InputError.
[[nodiscard]] Source read_source(const std::string& file, const triskin_options& options);

struct ModuleCalibration {
  std::array<double, layout::kTaxelsPerModule> counts_per_kpa{};  ///< Zero means that the value is unknown.
  double taxel_area_mm2 = 0.0;
  bool known = false;
};

/// This class does the work of the C functions and throws exceptions.
class Skin {
 public:
  /// Opens the links. Throws InputError, DeviceError.
  Skin(Source source, const triskin_options& options);
  Skin(const Skin&) = delete;
  Skin& operator=(const Skin&) = delete;

  [[nodiscard]] const Source& source() const { return source_; }
  /// Starts the streams of all buses, or of none. Throws InputError, and DeviceError as skin::LiveBus::start.
  void start() { queue_.start(stream_options_); }
  /// Removes samples from the queue. When it is empty, throws the exception that ended the stream.
  std::size_t read(double timeout_s, triskin_sample* samples, std::size_t capacity);
  void stop() { queue_.stop(); }
  /// Returns the time of the links, s since 1970.
  [[nodiscard]] double now_s() const;
  [[nodiscard]] triskin_counts counts();
  /// Throws DeviceError when no sample arrived.
  void tare();
  [[nodiscard]] std::array<double, layout::kTaxelsPerModule> change_counts(layout::SkinModule module) {
    return queue_.change_counts(module);
  }
  /// Returns the calibration, indexed by module. Throws InputError while a stream runs, DeviceError.
  [[nodiscard]] std::vector<ModuleCalibration> calibration();
  /// Returns the report of a verification, and whether there is a finding. Throws InputError while a stream runs.
  std::pair<std::string, bool> verify();

 private:
  void calibrate(skin::LiveBus& bus, const skin::LiveCover& cover, std::vector<ModuleCalibration>& modules);
  bool verify(skin::LiveBus& bus, std::string& report);

  const Source source_;
  const session::StreamOptions stream_options_;
  const bool virtual_time_;  // True means that time passes only while a caller waits.
  skin::LiveSkin live_;
  skin::SampleQueue queue_;
};

}  // namespace triskin::library
