// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "support/strip_design.hpp"
#include "triskin/base/files.hpp"
#include "triskin/connect/open_link.hpp"
#include "triskin/deploy/flash.hpp"

namespace triskin::test {

/// Prepares a folder with a design of eight modules on two controllers, a scene of it, and simulated boards that hold
/// its tables.
class FlashedSim {
 public:
  /// `faults` is the value of that key of the scene. Converters are drawn, but with a gain of 1. With gaps, the numbers
  /// of the last three modules are 12 … 14.
  explicit FlashedSim(const std::string& faults = "[]", bool has_gaps = false)
      : folder_(std::filesystem::temp_directory_path() / ("library." + std::to_string(::getpid()))) {
    if (has_gaps) design_ = with_gaps(design_);
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    ::setenv("XDG_STATE_HOME", folder_.c_str(), 1);
    design::write_design(design_file(), design_);
    write_file_atomically(
        scene_file(), R"({"format":"triskin-scene","version":1,"design":"d.json","contacts":[)"
                      R"({"at_s":6,"module":)" +
                          std::string(has_gaps ? "12" : "5") +
                          R"(,"taxel":3,"force_n":1,"radius_mm":3}],"converters":{"gain":1},"faults":)" + faults + "}");
    const auto link = connect::open_link({.link = "sim", .scene = "", .own_interrupts = false}, &design_);
    session::Bus bus(*link);
    deploy::FlashOptions options;
    options.recognise = true;
    options.actuator = link::touch_actuator_of(*link);
    (void)deploy::flash(bus, design_, options);
  }
  ~FlashedSim() { std::filesystem::remove_all(folder_); }
  FlashedSim(const FlashedSim&) = delete;
  FlashedSim& operator=(const FlashedSim&) = delete;
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  [[nodiscard]] std::string design_file() const { return folder_ / "d.json"; }
  [[nodiscard]] std::string scene_file() const { return folder_ / "s.json"; }
  [[nodiscard]] const design::Design& design() const { return design_; }

 private:
  std::filesystem::path folder_;
  design::Design design_ = strip(8, 4);
};

}  // namespace triskin::test
