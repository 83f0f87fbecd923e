// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/mechanics/inverse_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include "triskin/base/error.hpp"
#include "triskin/base/json_cause.hpp"
#include "triskin/base/text_file.hpp"

namespace triskin::mechanics {
namespace {

using nlohmann::json;

// A value of the file and the path to it, for messages.
class Place {
 public:
  Place(const json& value, std::string name) : value_(value), name_(std::move(name)) {}
  [[nodiscard]] bool has(const char* key) const { return value_.is_object() && value_.contains(key); }
  [[nodiscard]] Place at(const char* key) const {
    if (!has(key)) throw InputError(fmt::format("{}: has no \"{}\"", name_, key));
    return {value_.at(key), fmt::format("{}, {}", name_, key)};
  }
  [[nodiscard]] Place at(std::size_t k) const { return {value_.at(k), fmt::format("{} {}", name_, k)}; }
  [[nodiscard]] std::size_t size() const {
    if (!value_.is_array()) throw InputError(fmt::format("{}: is no list", name_));
    return value_.size();
  }
  [[nodiscard]] double number() const {
    if (!value_.is_number()) throw InputError(fmt::format("{}: is no number", name_));
    return value_.get<double>();
  }
  // Returns NaN for null.
  [[nodiscard]] double number_or_nan() const {
    return value_.is_null() ? std::numeric_limits<double>::quiet_NaN() : number();
  }
  [[nodiscard]] int integer() const {
    if (!value_.is_number_integer()) throw InputError(fmt::format("{}: is no whole number", name_));
    return value_.get<int>();
  }
  [[nodiscard]] const json& value() const { return value_; }
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  const json& value_;
  std::string name_;
};

std::optional<double> optional_number(const Place& place, const char* key) {
  if (!place.has(key) || place.value().at(key).is_null()) return std::nullopt;
  return place.at(key).number();
}

std::vector<std::vector<Eigen::Vector2d>> read_modules(const Place& file) {
  std::vector<std::vector<Eigen::Vector2d>> modules;
  const Place list = file.at("modules");
  for (std::size_t m = 0; m < list.size(); ++m) {
    const Place taxels = list.at(m).at("taxels_mm");
    auto& module = modules.emplace_back();
    for (std::size_t t = 0; t < taxels.size(); ++t) {
      const Place taxel = taxels.at(t);
      if (taxel.size() != 2) throw InputError(fmt::format("{}: a position is [x, y] in mm", taxel.name()));
      module.emplace_back(taxel.at(std::size_t{0}).number(), taxel.at(std::size_t{1}).number());
    }
  }
  return modules;
}

std::vector<int> temperature_pads(const Place& place) {
  if (!place.has("temperature_pads")) return {6, 10};
  std::vector<int> pads;
  const Place list = place.at("temperature_pads");
  for (std::size_t k = 0; k < list.size(); ++k) pads.push_back(list.at(k).integer());
  return pads;
}

std::vector<TaxelObservation> read_taxels(const Place& place,
                                          const std::vector<std::vector<Eigen::Vector2d>>& modules) {
  const Place rows = place.at("dC_over_C0");
  const auto pads = temperature_pads(place);
  if (rows.size() != modules.size())
    throw InputError(fmt::format("{}: has {} rows for {} modules", rows.name(), rows.size(), modules.size()));
  std::vector<TaxelObservation> taxels;
  for (std::size_t m = 0; m < modules.size(); ++m) {
    const Place row = rows.at(m);
    if (row.size() != modules[m].size())
      throw InputError(fmt::format("{}: has {} values for {} taxels", row.name(), row.size(), modules[m].size()));
    for (std::size_t t = 0; t < modules[m].size(); ++t) {
      if (std::find(pads.begin(), pads.end(), static_cast<int>(t)) != pads.end()) continue;
      taxels.push_back({modules[m][t], row.at(t).number_or_nan()});
    }
  }
  return taxels;
}

InverseCase read_case(const Place& file, const Place& place, const std::vector<std::vector<Eigen::Vector2d>>& modules) {
  InverseCase one;
  if (place.has("id")) one.id = place.value().at("id");
  const Place material = place.at("material");
  one.layer = {material.at("h_mm").number(), material.at("nu").number(), material.at("E_kpa").number()};
  one.taxels = read_taxels(place, modules);
  one.options.disc_diameter_mm = optional_number(file, "taxel_disc_diameter_mm").value_or(4.0);
  one.options.noise_dc_over_c = optional_number(place, "noise_dC_over_C0");
  if (!one.options.noise_dc_over_c) one.options.noise_dc_over_c = optional_number(file, "noise_dC_over_C0");
  // A noise of 0 states that there is none, which the scatter shows as well.
  if (one.options.noise_dc_over_c == 0.0) one.options.noise_dc_over_c.reset();
  one.options.tip_radius_mm = optional_number(place, "R_mm");
  if (place.has("contacts") && !place.value().at("contacts").is_null())
    one.options.contacts = place.at("contacts").integer();
  return one;
}

// The JSON library would silently drop one of two equal keys in an object, so they are an error here.
json parse_once(const std::string& text, const std::string& name) {
  std::vector<std::set<std::string>> open;
  return json::parse(text, [&](int, json::parse_event_t event, json& value) {
    if (event == json::parse_event_t::object_start) open.emplace_back();
    if (event == json::parse_event_t::object_end) open.pop_back();
    if (event == json::parse_event_t::key && !open.back().insert(value.get<std::string>()).second)
      throw InputError(
          fmt::format("{}: key \"{}\" stands twice in one object; leave one out", name, value.get<std::string>()));
    return true;
  });
}

}  // namespace

std::vector<InverseCase> read_inverse_cases(const std::filesystem::path& path) {
  json root;
  try {
    root = parse_once(read_text(path), path.string());
  } catch (const json::exception& error) {
    throw InputError(fmt::format("{}: is no JSON: {}", path.string(), json_cause(error.what())));
  }
  const Place file(root, path.string());
  const auto modules = read_modules(file);
  const Place list = file.at("cases");
  std::vector<InverseCase> cases;
  for (std::size_t k = 0; k < list.size(); ++k) {
    cases.push_back(read_case(file, list.at(k), modules));
    if (cases.back().id.is_null()) cases.back().id = k;
  }
  return cases;
}

std::vector<InverseResult> solve_inverse_cases(const std::vector<InverseCase>& cases) {
  std::map<double, std::unique_ptr<ContactTable>> tables;
  std::vector<InverseResult> results;
  for (const InverseCase& one : cases) {
    auto& shared = tables[one.layer.poisson];
    if (shared == nullptr) shared = std::make_unique<ContactTable>(one.layer);
    const ContactTable table(one.layer, *shared);
    results.push_back(find_contacts(table, one.taxels, one.options));
  }
  return results;
}

}  // namespace triskin::mechanics
