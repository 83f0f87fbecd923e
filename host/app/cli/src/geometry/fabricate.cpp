// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/fabrication/fabricate.hpp"

#include <fmt/format.h>

#include <memory>

#include "command.hpp"
#include "number_list.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/error.hpp"

namespace triskin::cli::fabricate_command {
namespace {

struct Options {
  std::string design, folder, sheet_mm;
  std::vector<std::string> only;
  fabrication::FabricationOptions fabrication;
};

void say_layer(const char* name, double error_mm, int folded_faces, Output& output) {
  output.say(fmt::format("{}: keeps its distance from the surface within {:.2f} mm", name, error_mm));
  if (folded_faces > 0)
    output.say(
        fmt::format("{}: folds over itself at {}, where the surface is bent more tightly than the layer is thick; mend "
                    "it in a CAD program, or make the layer thinner",
                    name, counted(folded_faces, "face")));
}

void say_sheets(const std::vector<double>& fill, Output& output) {
  for (std::size_t k = 0; k < fill.size(); ++k)
    output.say(fmt::format("sheet {}: {:.0f} % of its used length is islands", k + 1, 100.0 * fill[k]));
}

void read_sheet_size(const std::string& text, fabrication::SheetOptions& sheet) {
  const std::vector<double> size = numbers_of(text);
  if (size.size() != 2) throw InputError(fmt::format("--sheet-mm {}: wanted width,length in mm", text));
  sheet.width_mm = size[0];
  sheet.length_mm = size[1];
}

nlohmann::json json_of(const fabrication::FabricationReport& report) {
  return {{"files", report.files},
          {"islands", report.islands},
          {"carrier_error_mm", report.carrier_error_mm},
          {"carrier_folded_faces", report.carrier_folded_faces},
          {"mould_error_mm", report.mould_error_mm},
          {"mould_folded_faces", report.mould_folded_faces},
          {"sheet_fill", report.sheet_fill},
          {"advice", report.advice},
          {"left_out", report.left_out}};
}

int run(Options options, Output& output) {
  if (!options.sheet_mm.empty()) read_sheet_size(options.sheet_mm, options.fabrication.sheet);
  for (const std::string& name : options.only)
    options.fabrication.products.insert(fabrication::kProductNames.value(name).value());
  const auto report =
      fabrication::fabricate(design::read_intact_design(options.design), options.folder, options.fabrication);
  output.result = json_of(report);
  output.result["folder"] = options.folder;
  output.say(fmt::format("{}: {} for {}", options.folder, counted(report.files.size(), "file"),
                         counted(report.islands, "island")));
  const auto& products = options.fabrication.products;
  if (products.empty() || products.contains(fabrication::Product::kSolids)) {
    say_layer("carrier", report.carrier_error_mm, report.carrier_folded_faces, output);
    say_layer("mould", report.mould_error_mm, report.mould_folded_faces, output);
  }
  if (products.empty() || products.contains(fabrication::Product::kKicad))
    output.say("the boards are a proposal: none was built");
  say_sheets(report.sheet_fill, output);
  for (const std::string& sentence : report.advice) output.say(sentence);
  for (const std::string& sentence : report.left_out) output.say(sentence);
  const bool is_whole = report.left_out.empty() && report.carrier_folded_faces == 0 && report.mould_folded_faces == 0;
  return is_whole ? 0 : 1;
}

const Registration kFabricate{{
    "fabricate",
    "write what a board house and a workshop need: drawings, boards, parts list, solids, STEP assembly, sheets, panels",
    "triskin fabricate forearm.design.json -o forearm.fabrication",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      app.add_option("DESIGN", options->design, "design file")->required();
      app.add_option("-o,--output", options->folder, "folder that does not exist yet, or is empty")->required();
      std::vector<std::string> names;
      for (const auto& [product, name] : fabrication::kProductNames.rows()) names.emplace_back(name);
      app.add_option("--only", options->only, "write these alone, as dxf,parts")
          ->delimiter(',')
          ->check(CLI::IsMember(names));
      app.add_option("--corner-relief-mm", options->fabrication.corner_relief_mm,
                     "cut along each side from every corner, unless the design cuts more")
          ->check(CLI::Range(0.1, fabrication::kMaxCornerRelief_mm))
          ->capture_default_str();
      app.add_option("--elastic-mm", options->fabrication.elastic_mm,
                     "thickness of the elastic layer that the mould leaves free")
          ->check(CLI::Range(0.1, 20.0))
          ->capture_default_str();
      app.add_option("--wall-mm", options->fabrication.wall_mm, "thickness of carrier and mould")
          ->check(CLI::Range(0.1, 20.0))
          ->capture_default_str();
      app.add_option("--sheet-mm", options->sheet_mm,
                     "width,length of the sheets that islands are cut from (300,400 unless given)");
      app.add_option("--gap-mm", options->fabrication.sheet.gap_mm, "gap between islands on a sheet, and at its edge")
          ->check(CLI::Range(0.0, 20.0))
          ->capture_default_str();
      return [options](Output& output) { return run(*options, output); };
    },
    Group::kDesign,
}};

}  // namespace
}  // namespace triskin::cli::fabricate_command
