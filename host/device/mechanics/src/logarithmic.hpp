// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/mechanics/contact.hpp"

namespace triskin::mechanics {

/// Computes the contact on a foundation whose columns stiffen as they are compressed, p = −K·ln(1 − u / h) with
/// the confined modulus K. Forces have a closed form, the indentation is a root. Round bodies reach the base at a
/// finite force. Throws as press(). Cost: some µs. Thread-safe. Source: Bei and Fregly, Med. Eng. Phys. 26 (2004) 777.
[[nodiscard]] Contact press_logarithmic(const Layer& layer, const Indenter& indenter, double force);

}  // namespace triskin::mechanics
