// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <memory>

#include "command.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/check/placement_proof.hpp"

namespace triskin::cli::check_proof_command {
namespace {

struct Options {
  std::string log, polygon;
  check::ProofExpectation expected;
};

nlohmann::json json_of(const check::ProofReport& r) {
  return {{"accepted", r.accepted},
          {"reason", r.reason},
          {"modules", r.modules},
          {"upper_bound", r.upper_bound},
          {"tolerance_mm", r.tolerance_mm},
          {"rounding_mm", r.rounding_mm},
          {"shape", r.shape},
          {"gap_mm", r.gap_mm},
          {"corner_cut_mm", r.corner_cut_mm},
          {"weights", r.weights},
          {"outline", {{"hash", r.outline_hash}, {"area_mm2", r.outline_area_mm2}}},
          {"cells", r.cells},
          {"regions", r.regions},
          {"seconds", r.seconds}};
}

void say_accepted(const check::ProofReport& r, const Output& output) {
  output.say(
      fmt::format("accepted: {} {} inside, none standing over by more than {} mm (and {:.2g} mm for the "
                  "rounding of the placement), and no placement holds more than {} that do not stand over; {} cells, "
                  "{:.3f} s",
                  counted(r.modules, "module"), agreeing(r.modules, "lies", "lie"), r.tolerance_mm, r.rounding_mm,
                  r.upper_bound, r.cells, r.seconds));
  output.say(
      fmt::format("modules: {}, gap {:.12g} mm, corner cut {} mm, counted without weights; outline: {:.6g} cm², {}",
                  r.shape, r.gap_mm, r.corner_cut_mm, 0.01 * r.outline_area_mm2, r.outline_hash));
}

int run(const Options& options, Output& output) {
  const check::ProofReport r = check::check_placement_proof(options.log, options.polygon, options.expected);
  output.result = json_of(r);
  if (r.accepted)
    say_accepted(r, output);
  else
    output.say("rejected: " + r.reason);
  return r.accepted ? 0 : 1;
}

const Registration kCheckProof{{
    "check-proof",
    "accept or reject a placement proof in interval arithmetic, with none of the solver's code",
    "triskin place outline.geojson --proof outline.proof.json && triskin check-proof outline.proof.json "
    "outline.geojson",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      check::ProofExpectation& expected = options->expected;
      app.add_option("FILE", options->log, "what place --proof wrote")->required();
      app.add_option("POLYGON", options->polygon, "the polygon that was placed, GeoJSON or WKT in mm")->required();
      app.add_option("--expect-tolerance-mm", expected.tolerance_mm, "reject a proof of another tolerance");
      app.add_option("--expect-shape", expected.shape, "reject a proof of another module")
          ->check(CLI::IsMember({"triangle", "square", "hexagon"}));
      app.add_option("--expect-gap-mm", expected.gap_mm, "reject a proof of another gap");
      app.add_option("--expect-corner-cut-mm", expected.corner_cut_mm, "reject a proof of another corner cut");
      app.add_option("--expect-modules", expected.modules, "reject a proof of another number, or of an open bound");
      app.add_option("--expect-outline", expected.outline_hash, "reject a proof of an outline with another hash");
      return [options](Output& output) { return run(*options, output); };
    },
}};

}  // namespace
}  // namespace triskin::cli::check_proof_command
