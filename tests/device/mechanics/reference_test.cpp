// SPDX-License-Identifier: GPL-3.0-or-later
// Compares contacts with numbers from other code: the open cases of the data folder.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "support/places.hpp"
#include "triskin/mechanics/contact.hpp"
#include "triskin/mechanics/contact_table.hpp"
#include "triskin/mechanics/taxel.hpp"

namespace triskin::mechanics {
namespace {

std::filesystem::path cases_file() {
  const char* named = std::getenv("TRISKIN_DATA");
  const std::filesystem::path folder = named != nullptr ? named : test::configured_data_folder();
  return folder / "mechanics" / "open_cases.json";
}

struct Case {
  std::string name;
  Indenter indenter;
  Layer layer;
  double force = 0.0;
  nlohmann::json truth;
};

struct Errors {
  double number = 0.0;  // The errors of indentation, radius and peak pressure are relative.
  double taxel = 0.0;   // The error is relative to the peak of dC/C.
  double field = 0.0;   // The errors of displacement and base pressure are relative to their values in the centre.
};

double value(const nlohmann::json& truth, const char* key) {
  return truth.at(key).at("v").get<double>();
}

double value(const nlohmann::json& truth, const char* key, std::size_t k) {
  return truth.at(key).at(k).at("v").get<double>();
}

std::vector<Case> read_cases() {
  std::vector<Case> cases;
  const auto file = nlohmann::json::parse(std::ifstream(cases_file()));
  const std::vector<std::pair<std::string, Shape>> shapes = {{"sphere", Shape::kSphere},
                                                             {"paraboloid", Shape::kParaboloid},
                                                             {"flat", Shape::kFlatPunch},
                                                             {"line", Shape::kLine}};
  for (const auto& c : file.at("cases")) {
    for (const auto& [key, shape] : shapes) {
      if (!c.contains(key)) continue;
      const double radius = c.contains("R_mm") ? c["R_mm"] : c["a_mm"];
      const double force = c.contains("F_n") ? c["F_n"] : c["force_per_length_n_per_mm"];
      cases.push_back({key + " " + c["id"].dump(), {shape, radius}, {c["h_mm"], c["nu"], c["E_kpa"]}, force, c[key]});
    }
  }
  return cases;
}

Errors errors_of(const Case& c, const Contact& contact) {
  Errors errors;
  const auto number = [&](const char* key, double v) {
    errors.number = std::max(errors.number, std::abs(v / value(c.truth, key) - 1.0));
  };
  number("indentation_mm", contact.indentation_mm);
  number("contact_radius_mm", contact.contact_radius_mm);
  number("peak_pressure_kpa", contact.peak_pressure_kpa);
  const std::vector<double> radii = {0, 1, 2, 3, 4, 6, 8, 10};
  for (std::size_t k = 0; k < radii.size(); ++k) {
    const auto share = [&](const char* key, double v) {
      return std::abs(v - value(c.truth, key, k)) / value(c.truth, key, 0);
    };
    errors.taxel = std::max(errors.taxel, share("taxel_dC_over_C0", taxel_dc_over_c(c.layer, contact, radii[k])));
    errors.field = std::max({errors.field, share("surface_displacement_mm", contact.field->displacement_mm(radii[k])),
                             share("base_pressure_kpa", contact.field->base_pressure_kpa(radii[k]))});
  }
  return errors;
}

class Reference : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(cases_file()))
      GTEST_SKIP() << "left out without data: " << cases_file() << " does not exist (TRISKIN_SHARED_DATA)";
  }
};

// The numbers are given to eight digits; the requirement is 0.5 % and 1 %.
TEST_F(Reference, ExactContactsAgreeToSixDigits) {
  const auto cases = read_cases();
  ASSERT_GE(cases.size(), 11U);
  for (const Case& c : cases) {
    const Errors errors = errors_of(c, press(Level::kFft, c.layer, c.indenter, c.force));
    EXPECT_LT(errors.number, 1e-6) << c.name;
    EXPECT_LT(errors.taxel, 1e-6) << c.name;
    EXPECT_LT(errors.field, 1e-6) << c.name;
  }
}

TEST_F(Reference, TableAgreesWithinOnePart) {
  std::map<double, std::unique_ptr<ContactTable>> tables;
  for (const Case& c : read_cases()) {
    auto& first = tables[c.layer.poisson];
    if (first == nullptr) first = std::make_unique<ContactTable>(c.layer);
    const ContactTable table(c.layer, *first);
    const Errors errors = errors_of(c, table.press(c.indenter, c.force));
    EXPECT_LT(errors.number, 1e-3) << c.name;
    EXPECT_LT(errors.taxel, 1e-3) << c.name;
    EXPECT_LT(errors.field, 1e-3) << c.name;
  }
}

// By the table of design/mechanics.md, Winkler's foundation at ν 0.3 and a/h above 1.5 is within a few percent, but at
// ν 0.45 it is not. A foundation that agreed there would be the reference under another name.
TEST_F(Reference, FoundationIsGoodForCompressibleLayersOnly) {
  for (const Case& c : read_cases()) {
    if (c.indenter.shape != Shape::kSphere) continue;
    const Errors errors = errors_of(c, press(Level::kWinkler, c.layer, c.indenter, c.force));
    if (c.layer.poisson < 0.4 && value(c.truth, "contact_radius_mm") > 2.0 * c.layer.thickness_mm) {
      EXPECT_LT(errors.taxel, 0.02) << c.name;
    }
    if (c.layer.poisson > 0.4) {
      EXPECT_GT(errors.taxel, 0.1) << c.name;
    }
  }
}

}  // namespace
}  // namespace triskin::mechanics
