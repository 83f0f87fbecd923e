// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "triskin/base/names.hpp"
#include "triskin/design/design.hpp"
#include "triskin/fabrication/flat_island.hpp"

namespace triskin::fabrication {

/// Each product is one kind of file that fabricate() can write.
enum class Product {
  kDxf,     ///< Every island gets its own drawing.
  kKicad,   ///< Every island gets a board with project and net list; the module gets footprint, symbol and net list.
  kParts,   ///< The list of parts is written to parts.csv.
  kSolids,  ///< Modules, carrier and mould are written as STL and 3MF.
  kStep,    ///< Cover and modules form one assembly.
};
/// The command line uses these names.
inline constexpr NameTable kProductNames{
    std::array<std::pair<Product, std::string_view>, 5>{{{Product::kDxf, "dxf"},
                                                         {Product::kKicad, "kicad"},
                                                         {Product::kParts, "parts"},
                                                         {Product::kSolids, "solids"},
                                                         {Product::kStep, "step"}}}};

struct FabricationOptions {
  std::set<Product> products;  ///< An empty set selects all products.
  double corner_relief_mm = kCornerRelief_mm;
  double elastic_mm = 2.0;  ///< The elastic layer has this thickness, 0.1 … 20.
  double wall_mm = 2.0;     ///< Carrier and mould have this thickness, 0.1 … 20.
};

/// Lists what was written, and what a person has to know about it.
struct FabricationReport {
  std::vector<std::string> files;  ///< Paths are relative to the folder and sorted.
  int islands = 0;
  double carrier_error_mm = 0.0, mould_error_mm = 0.0;   ///< The values are those of Layer::error_mm.
  int carrier_folded_faces = 0, mould_folded_faces = 0;  ///< The numbers are those of Layer::folded_faces.
  std::vector<std::string> left_out;                     ///< Each entry is one sentence.
};

/// Writes the files of a design into a folder that does not exist yet or is empty: all or none. A STEP assembly is left
/// out, with a sentence, if all products were wanted and triskin-cad is not installed. Errors: InputError for a folder
/// with files in it or that cannot be made, for options out of range, and as the products say. Cost: linear except for
/// STEP.
FabricationReport fabricate(const design::Design& design, const std::filesystem::path& folder,
                            const FabricationOptions& options);

}  // namespace triskin::fabrication
