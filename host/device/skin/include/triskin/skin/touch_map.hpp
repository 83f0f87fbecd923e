// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "triskin/base/format_index.hpp"
#include "triskin/design/design.hpp"
#include "triskin/design/rest_values.hpp"
#include "triskin/layout/index.hpp"
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
/// them, the first valid values of a taxel say where it rests: it may be anywhere in the range, since an offset does
/// not cancel every electrode. Their median becomes its rest value, which then follows the readings upwards. What a
/// controller says of the rest (settle()) tells a finger that came later: a taxel that reads more than kRestBand_counts
/// below it counts as pressed from the start, until a reading enters the band and is used like the first ones. The
/// temperature pads do not feel a finger, so the change that they show since rest is subtracted, as a running mean,
/// from every taxel of their module; warming therefore never counts as pressure, however long a contact lasts. Not
/// thread-safe.
class TouchMap {
 public:
  static constexpr double kPressed_counts = layout::kPressed_counts;
  /// An untouched taxel may have moved down by this much, warmth taken off, since its offset was settled
  /// (docs/silicon.md, beliefs): 20 kPa, so a lighter touch at the start shows after its end only.
  static constexpr double kRestBand_counts = 200.0;
  static constexpr std::size_t kRestSamples = 3;
  /// `design` must outlive the map. Rest values have one entry per module, or are empty.
  explicit TouchMap(const design::Design& design, const design::KnownRest& rest = {});
  /// Sets the rest values of the modules from `first_module` on; other modules keep theirs.
  void set_rest(const design::RestValues& rest, layout::ModuleId first_module);
  /// Says what each taxel read when its offset was settled (session::settled_rest()); NaN: not known. It has one entry
  /// per module and no effect on modules with rest values.
  void settle(const design::RestValues& settled);
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
    double settled = std::numeric_limits<double>::quiet_NaN();  // what it read when its offset was settled
    bool follows = false;  // The rest value follows only upwards, away from pressure.
    // True means that the taxel was pressed from the start; its rest value is known once a reading enters the band.
    bool awaited = false;
  };
  struct Module {
    std::array<Taxel, layout::kTaxelsPerModule> taxels{};
    std::optional<double> warming_counts;  // The temperature pads read this much below their rest values.
    bool tared = false;                    // The rest values were given, or are the next values.
  };
  static void take_pads(Module& module, const wire::TaxelFrame& sample);
  static void take(const Module& module, Taxel& taxel, double value);
  static void follow(Taxel& taxel, double value);
  [[nodiscard]] static bool may_rest(const Taxel& taxel, double value);
  static std::optional<double> collected(Taxel& taxel, double value);
  static void take_first(const Module& module, Taxel& taxel, double median);

  const design::Design& design_;
  std::vector<design::ModuleWiring> wiring_;
  std::vector<Module> modules_;
};

}  // namespace triskin::skin
