// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

#include "triskin/layout/module.hpp"
#include "triskin/wire/module_state.hpp"

namespace triskin::view {

/// A sample of a module, against its rest values.
struct PressureSample {
  wire::ModuleState state = wire::ModuleState::kUnknown;
  std::uint16_t valid = 0;  ///< Bit t is that of taxel t.
  /// Pressure is above 0, and invalid taxels have 0.
  std::array<double, layout::kTaxelsPerModule> below_rest_counts{};
};

/// The latest sample of every module. Threads add samples, others encode what a reader has not got yet. Memory is
/// fixed: a slow reader skips samples, it never makes a queue grow. Thread-safe.
class LiveSkin {
 public:
  /// Bytes before the records of a frame, and of one record (docs/view_server.md).
  static constexpr std::size_t kHeaderBytes = 16, kRecordBytes = 32;
  /// First two bytes of a frame: what it is, and the version of its layout.
  static constexpr std::uint8_t kFrameKind = 1, kFrameVersion = 1;

  /// How the link fares, for the status line of the page.
  struct Health {
    std::string link;     ///< It has the syntax of --link.
    bool live = false;    ///< Samples arrive at present.
    std::string trouble;  ///< It is one sentence with the remedy, and empty if all is well.
    std::uint64_t frames = 0, lost = 0;
  };

  /// `modules`: number of modules of the design.
  explicit LiveSkin(std::size_t modules) : modules_(modules) {}

  /// Takes a sample of module `module`; one that the design lacks is ignored. `wall_time_us`: when it was taken, µs
  /// since 1970.
  void add(int module, const PressureSample& sample, std::int64_t wall_time_us);
  /// States how the link fares.
  void set_health(Health health);
  [[nodiscard]] Health health() const;

  /// Modules that changed after sample number `seen`, as one binary frame of the page; `seen` becomes the number of the
  /// newest sample. Empty: none changed. Cost: O(modules).
  [[nodiscard]] std::string frame_since(std::uint64_t& seen) const;

 private:
  struct Module {
    std::uint64_t number = 0;  // Number of its latest sample; 0: none arrived.
    std::int64_t wall_time_us = 0;
    std::uint16_t valid = 0;
    wire::ModuleState state = wire::ModuleState::kUnknown;
    std::array<std::int16_t, layout::kTaxelsPerModule> change{};
  };

  mutable std::mutex mutex_;
  std::vector<Module> modules_;
  std::uint64_t newest_ = 0;
  Health health_;
};

}  // namespace triskin::view
