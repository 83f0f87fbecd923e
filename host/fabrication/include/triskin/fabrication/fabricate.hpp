// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "triskin/base/names.hpp"
#include "triskin/design/design.hpp"
#include "triskin/fabrication/flat_island.hpp"
#include "triskin/fabrication/nesting.hpp"

namespace triskin::fabrication {

/// Each product is one kind of file that fabricate() can write.
enum class Product {
  kDxf,  ///< a drawing for each island
  /// a board for each island, its project and net list; of the module footprint, symbol and net list; the nets of
  /// the patch controller
  kKicad,
  kParts,   ///< parts.csv
  kSolids,  ///< modules, carrier and mould as STL and 3MF
  kStep,    ///< cover and modules as an assembly
  kSheets,  ///< all islands laid on sheets of material, a drawing for each sheet, and a list of what lies where
};
/// The command line uses these names.
inline constexpr NameTable kProductNames{
    std::array<std::pair<Product, std::string_view>, 6>{{{Product::kDxf, "dxf"},
                                                         {Product::kKicad, "kicad"},
                                                         {Product::kParts, "parts"},
                                                         {Product::kSolids, "solids"},
                                                         {Product::kStep, "step"},
                                                         {Product::kSheets, "sheets"}}}};

struct FabricationOptions {
  std::set<Product> products;  ///< An empty set selects all products.
  double corner_relief_mm = kCornerRelief_mm;
  double elastic_mm = 2.0;  ///< 0.1 … 20: thickness of the elastic layer
  double wall_mm = 2.0;     ///< 0.1 … 20: thickness of carrier and mould
  SheetOptions sheet{};     ///< sheets that the islands are cut from
};

/// Lists what was written, and what a person has to know about it.
struct FabricationReport {
  std::vector<std::string> files;  ///< Paths are relative to the folder and sorted.
  int islands = 0;
  double carrier_error_mm = 0.0, mould_error_mm = 0.0;   ///< Layer::error_mm
  int carrier_folded_faces = 0, mould_folded_faces = 0;  ///< Layer::folded_faces
  std::vector<double> sheet_fill;                        ///< Nesting::fill
  std::vector<std::string> left_out;                     ///< one sentence each
};

/// Writes the files of a design into a folder that does not exist yet or is empty: all or none. Where all products were
/// wanted, a STEP assembly is left out without triskin-cad, and sheets where an island does not fit one, each with a
/// sentence. Errors: InputError for a
/// folder with files in it or that cannot be made, for options out of range, and as the products say. Cost: linear but
/// for STEP.
FabricationReport fabricate(const design::Design& design, const std::filesystem::path& folder,
                            const FabricationOptions& options);

}  // namespace triskin::fabrication
