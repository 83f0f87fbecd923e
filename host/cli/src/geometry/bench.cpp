// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.hpp"

#include <fmt/format.h>

#include <map>
#include <memory>

#include "triskin/cli/command.hpp"
#include "triskin/host/error.hpp"

namespace triskin::cli {
namespace {

std::map<std::string, BenchRows>& subjects() {
  static std::map<std::string, BenchRows> all;
  return all;
}

int run(const std::string& subject, const BenchOptions& options, Output& output) {
  const auto found = subjects().find(subject);
  if (found == subjects().end()) {
    std::string known;
    for (const auto& [name, rows] : subjects()) known += (known.empty() ? "" : ", ") + name;
    throw InputError(fmt::format("bench {}: no such subject; there are: {}", subject, known));
  }
  nlohmann::json rows = found->second(options, output);
  if (!output.json()) {
    for (const auto& row : rows) output.say(row.dump());
  }
  output.result = {{"rows", std::move(rows)}};
  return 0;
}

const Registration kBench{{
    "bench",
    "speed against error for one subject",
    "triskin bench placement --quick --json",
    [](CLI::App& app) -> Run {
      auto subject = std::make_shared<std::string>();
      auto options = std::make_shared<BenchOptions>();
      app.add_option("WHAT", *subject, "subject: placement, …")->required();
      app.add_flag("--quick", options->quick, "ends within 50 s");
      app.add_option("--data", options->data, "folder with parts/ and blender/ (real covers and their nets)")
          ->envname("TRISKIN_DATA");
      return [subject, options](Output& output) { return run(*subject, *options, output); };
    },
}};

}  // namespace

BenchSubject::BenchSubject(const std::string& name, BenchRows rows) {
  subjects()[name] = std::move(rows);
}

}  // namespace triskin::cli
