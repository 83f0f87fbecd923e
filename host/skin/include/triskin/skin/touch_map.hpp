// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "triskin/design/design.hpp"
#include "triskin/design/rest_values.hpp"
#include "triskin/layout/rest.hpp"
#include "triskin/session/module_sample.hpp"

namespace triskin::device {

/// A taxel under pressure, in the mesh frame.
struct PressedTaxel {
  int module = 0, taxel = 0;                           ///< They are an id of the design and 0 … 11.
  double change_counts = 0.0;                          ///< It is the change against the rest value.
  design::Vec3 position_mm{0, 0, 0}, normal{0, 0, 0};  ///< They are the centre and the outward unit normal.
};

/// Knows the rest value of every taxel and lists the taxels under pressure. Rest values are those that were given, or
/// taken by tare(). Without them a taxel rests where a module rests by its design (layout::kRestCounts): if its first
/// valid values are at most kRestBand_counts below that, their median is its rest value, which then follows it upwards;
/// else it is under pressure from the start, against the middle of the design, until a value comes within the band and
/// is taken as the first would have been. What the pads that feel the temperature and no finger have changed since
/// rest is taken off every taxel of their module, so that warming is no pressure however long a contact lasts. Not
/// thread-safe.
class TouchMap {
 public:
  static constexpr double kPressed_counts = 200.0;
  static constexpr double kRestBand_counts = layout::kRestBand_counts;
  static constexpr std::size_t kRestSamples = 3;
  /// `design` outlives the map. `rest`: one entry a module, or empty.
  explicit TouchMap(const design::Design& design, const design::RestValues& rest = {});
  /// Gives the rest values of the modules from `first_module` on; the others stay as they are.
  void set_rest(const design::RestValues& rest, int first_module);
  /// Takes a sample; invalid values are ignored.
  void add(const ModuleSample& frame);
  /// Takes the median of the next three valid samples of each taxel as its rest value. Nothing may touch the skin.
  void tare();
  /// True when every taxel that gave valid samples since tare() has its rest value.
  [[nodiscard]] bool tared() const;
  /// Rest value of every taxel.
  [[nodiscard]] design::RestValues rest() const;
  /// Pressure of each taxel of a module: by how many counts it reads below rest; 0 where it is not known.
  [[nodiscard]] std::array<double, layout::kTaxelsPerModule> change(int module) const;
  /// Taxels whose latest value is below rest by kPressed_counts or more, strongest first.
  [[nodiscard]] std::vector<PressedTaxel> pressed() const;

 private:
  struct Taxel {
    std::array<double, kRestSamples> first{};  // Valid samples of the tare.
    std::size_t seen = 0;                      // Number of samples in `first`; kRestSamples: `rest` is known.
    double rest = 0.0, now = 0.0;
    bool follows = false;  // It follows upwards only, away from pressure.
    // The taxel was pressed from the start: its rest value is known once it comes back into the band.
    bool awaited = false;
  };
  struct Module {
    std::array<Taxel, layout::kTaxelsPerModule> taxels{};
    double warming_counts = 0.0;  // How far the temperature pads read below their rest values.
    bool by_design = true;        // The design is the reference for its rest values.
  };
  static void take_pads(Module& module, const wire::TaxelFrame& sample);
  static void take(const Module& module, Taxel& taxel, double value);
  [[nodiscard]] static bool may_rest(double value);
  static void settle(const Module& module, Taxel& taxel);

  const design::Design& design_;
  std::vector<design::ModuleWiring> wiring_;
  std::vector<Module> modules_;
};

}  // namespace triskin::device
