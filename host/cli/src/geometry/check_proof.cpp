// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <memory>

#include "triskin/check/placement_proof.hpp"
#include "triskin/cli/command.hpp"

namespace triskin::cli::check_proof_command {
namespace {

int run(const std::string& log, const std::string& polygon, Output& output) {
  const check::ProofReport r = check::check_placement_proof(log, polygon);
  output.result = {{"accepted", r.accepted},       {"reason", r.reason}, {"modules", r.modules},
                   {"upper_bound", r.upper_bound}, {"cells", r.cells},   {"regions", r.regions},
                   {"seconds", r.seconds}};
  if (r.accepted) {
    output.say(fmt::format("accepted: {} modules lie inside and no placement holds more than {}; {} cells, {:.3f} s",
                           r.modules, r.upper_bound, r.cells, r.seconds));
  } else {
    output.say("rejected: " + r.reason);
  }
  return r.accepted ? 0 : 1;
}

const Registration kCheckProof{{
    "check-proof",
    "accept or reject a placement proof in interval arithmetic, with none of the solver's code",
    "triskin place outline.geojson --proof outline.proof.json && triskin check-proof outline.proof.json "
    "outline.geojson",
    [](CLI::App& app) -> Run {
      auto log = std::make_shared<std::string>();
      auto polygon = std::make_shared<std::string>();
      app.add_option("FILE", *log, "what place --proof wrote")->required();
      app.add_option("POLYGON", *polygon, "the polygon that was placed, GeoJSON or WKT in mm")->required();
      return [log, polygon](Output& output) { return run(*log, *polygon, output); };
    },
}};

}  // namespace
}  // namespace triskin::cli::check_proof_command
