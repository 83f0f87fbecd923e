// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "triskin/base/format_index.hpp"
#include "triskin/design/design.hpp"
#include "triskin/design/rest_values.hpp"
#include "triskin/layout/index.hpp"
#include "triskin/layout/rest.hpp"
#include "triskin/layout/taxel_signal.hpp"
#include "triskin/session/module_sample.hpp"

namespace triskin::skin {

/// The position of a pressed taxel is in the mesh frame.
struct PressedTaxel {
  layout::ModuleId module;
  layout::TaxelIndex taxel;
  double change_counts = 0.0;  ///< The change is measured against the rest value.
  /// The centre of the taxel and its outward unit normal are given.
  design::Vec3 position_mm{0, 0, 0}, normal{0, 0, 0};
};

/// Returns how far the valid temperature pads of a module read below their rest values, on average; nothing if there is
/// none. The pads feel no finger, so this is warmth, and taken off every taxel. A rest value that is not known is NaN.
[[nodiscard]] std::optional<double> warming_counts(const wire::TaxelFrame& sample,
                                                   const std::array<double, layout::kTaxelsPerModule>& rest);

/// Keeps the rest value of every taxel and lists the pressed taxels. Rest values are given, or taken by tare(). Without
/// them, a taxel is expected to rest where the design says (layout::kRestCounts). If its first valid values are at most
/// kRestBand_counts below that, their median becomes its rest value, which then follows the readings upwards. Otherwise
/// the taxel counts as pressed from the start, against the design's value, until a reading enters the band and is used
/// like the first ones. The temperature pads do not feel a finger, so the change that they show since rest is
/// subtracted, as a running mean, from every taxel of their module; warming therefore never counts as pressure, however
/// long a contact lasts. Not thread-safe.
class TouchMap {
 public:
  static constexpr double kPressed_counts = layout::kPressed_counts;
  static constexpr double kRestBand_counts = layout::kRestBand_counts;
  static constexpr std::size_t kRestSamples = 3;
  /// `design` must outlive the map. `rest` has one entry per module, or is empty.
  explicit TouchMap(const design::Design& design, const design::RestValues& rest = {});
  /// Sets the rest values of the modules from `first_module` on; other modules keep theirs.
  void set_rest(const design::RestValues& rest, layout::ModuleId first_module);
  /// Updates the taxels with a sample; invalid values are ignored.
  void add(const session::ModuleSample& frame);
  /// Uses the median of the next three valid samples of each taxel as its rest value. Nothing may touch the skin.
  void tare();
  /// Returns true when every taxel that gave valid samples since tare() has its rest value.
  [[nodiscard]] bool tared() const;
  [[nodiscard]] design::RestValues rest() const;
  /// Returns the pressure on each taxel of a module in counts below rest; 0 where the rest value is not known.
  [[nodiscard]] std::array<double, layout::kTaxelsPerModule> change(layout::ModuleId module) const;
  /// Returns the taxels whose latest value is at least kPressed_counts below rest, strongest first.
  [[nodiscard]] std::vector<PressedTaxel> pressed() const;

 private:
  struct Taxel {
    std::array<double, kRestSamples> first{};  // The array collects valid samples for the tare.
    std::size_t seen = 0;  // This many samples are in `first`; kRestSamples means that `rest` is known.
    double rest = 0.0, now = 0.0;
    bool follows = false;  // The rest value follows only upwards, away from pressure.
    // True means that the taxel was pressed from the start; its rest value is known once a reading enters the band.
    bool awaited = false;
  };
  struct Module {
    std::array<Taxel, layout::kTaxelsPerModule> taxels{};
    std::optional<double> warming_counts;  // The temperature pads read this much below their rest values.
    bool by_design = true;                 // True means that the design's value is the reference for rest values.
  };
  static void take_pads(Module& module, const wire::TaxelFrame& sample);
  static void take(const Module& module, Taxel& taxel, double value);
  static void follow(Taxel& taxel, double value);
  [[nodiscard]] static bool may_rest(double value);
  static std::optional<double> collected(Taxel& taxel, double value);
  static void settle(const Module& module, Taxel& taxel, double median);

  const design::Design& design_;
  std::vector<design::ModuleWiring> wiring_;
  std::vector<Module> modules_;
};

}  // namespace triskin::skin
