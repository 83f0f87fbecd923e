// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.hpp"

#include <memory>
#include <utility>

#include "app/cli/src/program.hpp"

namespace triskin::cli {

BenchSubject::BenchSubject(const std::string& name, const std::string& summary, BenchRows rows) {
  const auto set_up = [rows = std::move(rows)](CLI::App& app) -> Run {
    auto options = std::make_shared<BenchOptions>();
    app.add_flag("--quick", options->quick, "ends within 50 s");
    app.add_option("--data", options->data, "folder with parts/ and blender/ (real covers and their nets)")
        ->envname("TRISKIN_DATA");
    return [rows, options](Output& output) {
      nlohmann::json measured = rows(*options, output);
      if (!output.json()) {
        for (const auto& row : measured) output.say(row.dump());
      }
      output.result = {{"rows", std::move(measured)}};
      return 0;
    };
  };
  Registration(Command{name, summary, "triskin-bench " + name + " --quick --json", set_up});
}

}  // namespace triskin::cli

int main(int argc, char** argv) {
  return triskin::cli::run_program("triskin-bench: speed against error, one subject at a time", argc, argv);
}
