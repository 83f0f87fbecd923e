// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/mechanics/contact.hpp"

namespace triskin::mechanics {

/// Computes the exact contact of an indenter on the bonded layer: dual integral equations of the layer's kernel, solved
/// as a Fredholm equation (round indenters) or by Chebyshev polynomials (line). It agrees with the grid of
/// layer_patch.hpp, which takes any body; the tests show by how much. Error below 1e-6 for contact radii of 0.02 … 60
/// thicknesses. Throws InputError as press() does, when the contact is wider than 60 thicknesses, and when a sphere
/// would sink to its equator. Cost: 5 … 50 ms. Thread-safe. Source: Jaffar, Int. J. Mech. Sci. 31 (1989) 229; Hayes
/// et al., J. Biomech. 5 (1972) 541; Lebedev and Ufliand 1958.
[[nodiscard]] Contact press_bonded(const Layer& layer, const Indenter& indenter, double force);

}  // namespace triskin::mechanics
