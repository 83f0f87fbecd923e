// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/design/rest_values.hpp"

#include <nlohmann/json.hpp>

#include "triskin/design/json_fields.hpp"

namespace triskin::design {

namespace {

constexpr double kMaxCounts = 65'535.0;  // The converter's results end at this value.

}  // namespace

std::string rest_text(const RestValues& rest) {
  return nlohmann::json{{"format", "triskin-rest"}, {"version", 1}, {"rest_counts", rest}}.dump() + "\n";
}

RestValues parse_rest(const std::string& text, const std::string& name, std::size_t modules) {
  const nlohmann::json document = parse_json(text, name);
  const JsonValue file(document, name);
  only_keys(file, {"format", "version", "rest_counts"}, "docs/calibration.md");
  const JsonValue counts = file["rest_counts"];
  counts.require_size(modules);
  RestValues rest(modules);
  for (std::size_t m = 0; m < modules; ++m) {
    counts.at(m).require_size(rest[m].size());
    for (std::size_t t = 0; t < rest[m].size(); ++t) rest[m][t] = number_in(counts.at(m).at(t), 0.0, kMaxCounts);
  }
  return rest;
}

}  // namespace triskin::design
