// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/design/rest_values.hpp"

#include <nlohmann/json.hpp>

#include "triskin/design/json_value.hpp"

namespace triskin::design {

std::string rest_text(const RestValues& rest) {
  return nlohmann::json{{"format", "triskin-rest"}, {"version", 1}, {"rest_counts", rest}}.dump() + "\n";
}

RestValues parse_rest(const std::string& text, const std::string& name, std::size_t modules) {
  const nlohmann::json document = parse_json(text, name);
  const JsonValue counts = JsonValue(document, name, "")["rest_counts"];
  counts.require_size(modules);
  RestValues rest(modules);
  for (std::size_t m = 0; m < modules; ++m) {
    counts.at(m).require_size(rest[m].size());
    for (std::size_t t = 0; t < rest[m].size(); ++t) rest[m][t] = counts.at(m).at(t).number();
  }
  return rest;
}

}  // namespace triskin::design
