// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/mechanics/contact.hpp"

#include <fmt/format.h>

#include <cmath>

#include "bonded_layer.hpp"
#include "logarithmic.hpp"
#include "triskin/base/error.hpp"
#include "triskin/mechanics/contact_table.hpp"
#include "winkler.hpp"

namespace triskin::mechanics {

void check(const Indenter& indenter) {
  if (!std::isfinite(indenter.radius_mm) || indenter.radius_mm <= 0.0)
    throw InputError(fmt::format("indenter: its radius is {} mm; give a positive number", indenter.radius_mm));
}

void check_force(double force) {
  if (!std::isfinite(force) || force <= 0.0)
    throw InputError(fmt::format("contact: the force is {}; give a positive number in N, of a line in N/mm", force));
}

void check_indentation(const Layer& layer, double indentation_mm) {
  if (indentation_mm < layer.thickness_mm * (1.0 - 1e-9)) return;
  throw InputError(
      fmt::format("contact: the indenter would reach the base of the layer, which is {} mm thick; lower the force, or "
                  "give a thicker or stiffer layer (a linear layer is trusted to about a third of its thickness)",
                  layer.thickness_mm));
}

Contact press(Level level, const Layer& layer, const Indenter& indenter, double force) {
  switch (level) {
    case Level::kWinkler:
      return press_winkler(layer, indenter, force);
    case Level::kLogarithmic:
      return press_logarithmic(layer, indenter, force);
    case Level::kTable:
      check(layer);
      return ContactTable(layer).press(indenter, force);
    case Level::kFft:
      break;
  }
  return press_bonded(layer, indenter, force);
}

}  // namespace triskin::mechanics
