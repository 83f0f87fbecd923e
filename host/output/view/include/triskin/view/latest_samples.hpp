// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "triskin/base/format_index.hpp"
#include "triskin/design/mesh.hpp"
#include "triskin/layout/index.hpp"
#include "triskin/layout/module.hpp"
#include "triskin/wire/module_state.hpp"

namespace triskin::view {

/// The values of a module's sample are relative to its rest values.
struct PressureSample {
  wire::ModuleState state = wire::ModuleState::kUnknown;
  std::uint16_t valid = 0;  ///< Bit t belongs to taxel t.
  /// Pressure gives values above 0; invalid taxels have 0.
  std::array<double, layout::kTaxelsPerModule> below_rest_counts{};
};

/// Holds the latest sample of every module. Some threads add samples; others encode what a reader has not received yet.
/// Memory is fixed: a slow reader skips samples instead of making a queue grow. Thread-safe.
class LatestSamples {
 public:
  /// A frame has this many bytes before its records, and each record this many (docs/view.md).
  static constexpr std::size_t kHeaderBytes = 16, kRecordBytes = 32;
  /// The first two bytes of a frame are its kind and the version of its layout. A track has contacts as a second kind.
  static constexpr std::uint8_t kFrameKind = 1, kContactsKind = 2, kFrameVersion = 1;

  /// The status line of the page shows the state of the link.
  struct Health {
    std::string link;     ///< The text has the syntax of --link.
    bool live = false;    ///< True means that samples arrive at present.
    std::string trouble;  ///< The sentence includes the remedy; it is empty if all is well.
    std::uint64_t frames = 0, lost = 0;
  };

  /// A place where something presses the skin, in the frame of the displayed design.
  struct Contact {
    std::vector<int> taxels;  ///< The numbers are 12 · module + taxel; the strongest comes first.
    design::Vec3 position_mm{0, 0, 0};
    double position_sd_mm = 0.0;
    double force_n = 0.0, force_sd_n = 0.0;  ///< NaN means not calibrated.
    double area_mm2 = 0.0;
    double change_counts = 0.0;  ///< The changes of its taxels add up to this value.
  };

  /// `modules` is the number of modules of the design.
  explicit LatestSamples(std::size_t modules) : modules_(modules) {}

  /// Adds a sample of module `module`; one that the design lacks is ignored. `wall_time_us` is the time when it was
  /// taken, µs since 1970.
  void add(layout::SkinModule module, const PressureSample& sample, std::int64_t wall_time_us);
  /// Sets the state of the link.
  void set_health(Health health);
  [[nodiscard]] Health health() const;

  /// Contacts are found and sent at this interval, because a person reads no faster.
  static constexpr std::chrono::milliseconds kContactsEvery{100};
  /// Replaces the contacts of one group of modules, for example of a cover's part on one bus. Nothing in place of
  /// nothing counts as no change.
  void set_contacts(int group, std::vector<Contact> contacts);
  /// Returns the contacts of all groups, the strongest first, if they were set after number `seen`, which becomes the
  /// newest number.
  [[nodiscard]] std::optional<std::vector<Contact>> contacts_since(std::uint64_t& seen) const;

  /// Returns the modules that changed after sample number `seen` as one binary frame of the page; `seen` becomes the
  /// number of the newest sample. Empty if none changed. Cost: O(modules).
  [[nodiscard]] std::string frame_since(std::uint64_t& seen) const;

 private:
  struct Module {
    std::uint64_t number = 0;  // The module's latest sample has this number; 0 means that none arrived.
    std::int64_t wall_time_us = 0;
    std::uint16_t valid = 0;
    wire::ModuleState state = wire::ModuleState::kUnknown;
    std::array<std::int16_t, layout::kTaxelsPerModule> change{};
  };

  mutable std::mutex mutex_;
  std::vector<Module> modules_;
  std::uint64_t newest_ = 0;
  Health health_;
  std::map<int, std::vector<Contact>> contacts_;  // The key is the group.
  std::uint64_t contacts_number_ = 0;
};

}  // namespace triskin::view
