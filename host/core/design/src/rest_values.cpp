// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/design/rest_values.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "triskin/design/json_fields.hpp"

namespace triskin::design {

namespace {

constexpr double kMaxCounts = 65'535.0;  // The converter's results end at this value.

double counts_in(const JsonValue& v) {
  return number_in(v, 0.0, kMaxCounts);
}

double counts_or_null_in(const JsonValue& v) {
  return v.raw().is_null() ? std::numeric_limits<double>::quiet_NaN() : counts_in(v);
}

RestValues parse(const std::string& text, const std::string& name, std::size_t modules,
                 double (*counts_of)(const JsonValue&)) {
  const nlohmann::json document = parse_json(text, name);
  const JsonValue file(document, name);
  only_keys(file, {"format", "version", "rest_counts"}, "docs/calibration.md");
  const JsonValue counts = file["rest_counts"];
  counts.require_size(modules);
  RestValues rest(modules);
  for (std::size_t m = 0; m < modules; ++m) {
    counts.at(m).require_size(rest[m].size());
    for (std::size_t t = 0; t < rest[m].size(); ++t) rest[m][t] = counts_of(counts.at(m).at(t));
  }
  return rest;
}

}  // namespace

std::string rest_text(const RestValues& rest) {
  return nlohmann::json{{"format", "triskin-rest"}, {"version", 1}, {"rest_counts", rest}}.dump() + "\n";
}

RestValues parse_rest(const std::string& text, const std::string& name, std::size_t modules) {
  return parse(text, name, modules, counts_in);
}

// JSON has no NaN; the library writes null.
std::string settled_text(const RestValues& settled) {
  const bool any = std::ranges::any_of(settled, [](const auto& module) {
    return std::ranges::any_of(module, [](double counts) { return !std::isnan(counts); });
  });
  return any ? rest_text(settled) : "";
}

RestValues parse_settled(const std::string& text, const std::string& name, std::size_t modules) {
  return parse(text, name, modules, counts_or_null_in);
}

}  // namespace triskin::design
