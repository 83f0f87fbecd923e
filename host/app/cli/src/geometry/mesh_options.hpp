// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <CLI/CLI.hpp>
#include <map>
#include <optional>
#include <string>

#include "command.hpp"
#include "triskin/mesh/mesh_io.hpp"

namespace triskin::cli {

/// Adds --unit mm|cm|m|in|inch to every command that reads a mesh.
struct UnitOption {
  std::optional<mesh::LengthUnit> unit;

  void add_to(CLI::App& app) {
    static const std::map<std::string, mesh::LengthUnit> kUnits{{"mm", mesh::LengthUnit::kMillimetre},
                                                                {"cm", mesh::LengthUnit::kCentimetre},
                                                                {"m", mesh::LengthUnit::kMetre},
                                                                {"in", mesh::LengthUnit::kInch},
                                                                {"inch", mesh::LengthUnit::kInch}};
    app.add_option("--unit", unit, "unit of the file's numbers, whatever the file says: mm, cm, m or in")
        ->transform(one_of(kUnits));
  }
};

/// Adds --object NAME to a command that reads a mesh.
inline void add_object_option(CLI::App& app, std::string& object) {
  app.add_option("--object", object, "use only this object; an unknown name lists the available ones");
}

}  // namespace triskin::cli
