// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <map>
#include <string>

namespace triskin::geometry {

/// Length of the unit that a COLLADA text states (`<unit meter="0.01"/>`), mm; 0 where it states none.
[[nodiscard]] double unit_of_dae_mm(const std::string& text);

/// Length of the unit of a 3MF file (attribute `unit` of its model; millimetre where it is left out, as the standard
/// says), mm; 0 where the file is no 3MF or names a unit that the standard has not.
[[nodiscard]] double unit_of_3mf_mm(const std::filesystem::path& path);

/// Names of the objects of a 3MF file by their id; those without a name are left out. Empty where it is no 3MF.
[[nodiscard]] std::map<std::string, std::string> names_in_3mf(const std::filesystem::path& path);

}  // namespace triskin::geometry
