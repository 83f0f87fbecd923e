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
  kDxf,  ///< Each island gets a drawing.
  /// Each island gets a board with its project and net list; the module gets footprint, symbol and net list, and the
  /// patch controller its nets.
  kKicad,
  kParts,   ///< parts.csv
  kSolids,  ///< modules, carrier and mould as STL and 3MF
  kStep,    ///< cover and modules as an assembly
  kSheets,  ///< All islands lie on sheets of material; each sheet has a drawing, and a list gives every place.
  /// Each sheet is a panel to be ordered: one archive for the board house (Gerber, Excellon), one for the assembly
  /// house (bill of materials, positions).
  kOrder,
};
/// The command line uses these names.
inline constexpr NameTable kProductNames{
    std::array<std::pair<Product, std::string_view>, 7>{{{Product::kDxf, "dxf"},
                                                         {Product::kKicad, "kicad"},
                                                         {Product::kParts, "parts"},
                                                         {Product::kSolids, "solids"},
                                                         {Product::kStep, "step"},
                                                         {Product::kSheets, "sheets"},
                                                         {Product::kOrder, "order"}}}};

struct FabricationOptions {
  std::set<Product> products;  ///< An empty set selects all products.
  double corner_relief_mm = kCornerRelief_mm;
  double elastic_mm = 2.0;  ///< 0.1 … 20: thickness of the elastic layer
  double wall_mm = 2.0;     ///< 0.1 … 20: thickness of carrier and mould
  SheetOptions sheet{};     ///< The islands are cut from such sheets.
};

/// Lists what was written, and what a person has to know about it.
struct FabricationReport {
  std::vector<std::string> files;  ///< Paths are relative to the folder and sorted.
  int islands = 0;
  double carrier_error_mm = 0.0, mould_error_mm = 0.0;   ///< Layer::error_mm
  int carrier_folded_faces = 0, mould_folded_faces = 0;  ///< Layer::folded_faces
  std::vector<double> sheet_fill;                        ///< The values are those of Nesting::fill.
  std::vector<std::string> left_out;                     ///< one sentence each
  std::vector<std::string> advice;                       ///< one sentence each; nothing is missing
};

/// Writes the files of a design into a folder that does not exist yet or is empty; after an error no file
/// remains. If all products were requested, the report explains why a product is left out: the STEP assembly
/// without triskin-cad, boards and panels if a joint is bent too sharply for them or corners are cut too far, sheets
/// and panels if an island does not fit one. Errors: InputError for a folder that has files in it or cannot be made,
/// for options out of range, and as the products say. Cost: linear except for STEP.
FabricationReport fabricate(const design::Design& design, const std::filesystem::path& folder,
                            const FabricationOptions& options);

}  // namespace triskin::fabrication
