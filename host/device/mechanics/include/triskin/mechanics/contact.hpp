// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <string_view>
#include <vector>

#include "triskin/mechanics/layer.hpp"

namespace triskin::mechanics {

enum class Shape {
  kSphere,      ///< The gap is R − √(R² − r²).
  kParaboloid,  ///< The gap is r² / 2R.
  kFlatPunch,   ///< The punch is circular and has a sharp edge.
  kLine,        ///< The cylinder lies on the layer, as the parabola x² / 2R in plane strain.
};

/// A rigid body that a force presses on the layer without friction.
struct Indenter {
  Shape shape = Shape::kSphere;
  double radius_mm = 5.0;  ///< The radius is that of curvature, or that of the punch.
};

/// Throws InputError unless the radius is positive and finite.
void check(const Indenter& indenter);

/// Describes what a contact does to the layer. `distance_mm` is from the axis, or from the line; at least 0.
/// Thread-safe.
class ContactField {
 public:
  ContactField() = default;
  ContactField(const ContactField&) = delete;
  ContactField& operator=(const ContactField&) = delete;
  virtual ~ContactField() = default;
  /// Returns the normal displacement of the surface into the layer, mm. It is slightly negative where the layer bulges.
  [[nodiscard]] virtual double displacement_mm(double distance_mm) const = 0;
  /// Returns the normal pressure on the rigid base, kPa.
  [[nodiscard]] virtual double base_pressure_kpa(double distance_mm) const = 0;
};

struct Contact {
  double force = 0.0;              ///< The unit is N, and for a line N/mm.
  double indentation_mm = 0.0;     ///< The indenter moved this far after it first touched.
  double contact_radius_mm = 0.0;  ///< A line has its half width here.
  /// The pressure is that in the centre, since that of a flat punch is infinite at its edge.
  double peak_pressure_kpa = 0.0;
  bool is_line = false;
  std::shared_ptr<const ContactField> field;
};

/// The models are ordered from fast to exact. docs/measurements/mechanics.md has their error and cost.
enum class Level { kWinkler, kLogarithmic, kTable, kFft };

/// Presses `indenter` on `layer` with `force` (N; of a line N/mm) and returns the contact by `level`:
/// winkler.hpp, logarithmic.hpp, contact_table.hpp or bonded_layer.hpp. kTable builds its table first, which takes as
/// long as some forty exact contacts; keep a ContactTable for more than one look-up.
/// Throws InputError when the layer, the indenter or the force is out of range, and when the indentation reaches the
/// thickness of the layer, where the capacitance would be infinite. Thread-safe.
[[nodiscard]] Contact press(Level level, const Layer& layer, const Indenter& indenter, double force);

/// Throws InputError unless `force` is positive and finite.
void check_force(double force);

/// Throws InputError when `indentation_mm` reaches the thickness of the layer; the message states the limit and what to
/// change.
void check_indentation(const Layer& layer, double indentation_mm);

}  // namespace triskin::mechanics
