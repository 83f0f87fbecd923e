// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>

#include "triskin/mechanics/contact.hpp"

namespace triskin::mechanics {

/// Tabulates exact contacts of one Poisson's ratio over the contact radius a / h. A sphere's gap inside its contact is
/// a sum of r², r⁴ and r⁶, and the solution at a fixed radius is linear in the gap; so one table serves all radii,
/// forces and moduli. Contacts that are 0.7 h or more apart may be superposed by adding their displacements.
///
/// The error against press_bonded() is below 0.5 % for contact radii of 0.03 … 40 thicknesses and a sphere that is
/// pressed in to no more than 0.8 of its radius (tests/device/mechanics). Cost: the table takes 0.3 … 1 s, when
/// a round contact or a line is first asked for; a look-up some 20 µs. Thread-safe.
class ContactTable {
 public:
  /// Throws InputError as check(layer).
  explicit ContactTable(const Layer& layer);
  /// Makes a table for another layer with the same Poisson's ratio, which shares the numbers of `other`. Throws
  /// InputError when the ratios differ.
  ContactTable(const Layer& layer, const ContactTable& other);
  ~ContactTable();
  ContactTable(const ContactTable&) = delete;
  ContactTable& operator=(const ContactTable&) = delete;

  [[nodiscard]] const Layer& layer() const;
  /// Returns the contact under `force` (N; of a line N/mm). Throws InputError as mechanics::press() and outside the
  /// table.
  [[nodiscard]] Contact press(const Indenter& indenter, double force) const;
  /// Returns the contact with a given contact radius; its force follows. Not for punches and lines. Throws InputError
  /// outside the table. Cost: some 10 µs.
  [[nodiscard]] Contact press_to_radius(const Indenter& indenter, double contact_radius_mm) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace triskin::mechanics
