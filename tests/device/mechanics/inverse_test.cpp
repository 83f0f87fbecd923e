// SPDX-License-Identifier: GPL-3.0-or-later
// Finds contacts from taxels: the open observations, and noisy draws whose truth is known.
#include "triskin/mechanics/inverse.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/LU>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <string>

#include "device/mechanics/src/bonded_layer.hpp"
#include "inverse_study.hpp"
#include "support/places.hpp"
#include "triskin/base/error.hpp"
#include "triskin/mechanics/inverse_file.hpp"
#include "triskin/mechanics/taxel.hpp"

namespace triskin::mechanics {
namespace {

std::filesystem::path observations_file() {
  const char* named = std::getenv("TRISKIN_DATA");
  const std::filesystem::path folder = named != nullptr ? named : test::configured_data_folder();
  return folder / "mechanics" / "open_inverse.json";
}

// Makes taxels of a triangular lattice, as dense as on a module.
std::vector<Eigen::Vector2d> lattice() {
  std::vector<Eigen::Vector2d> taxels;
  for (int row = 0; row < 9; ++row) {
    for (int k = 0; k < 9; ++k) taxels.emplace_back(6.5 * k + 3.25 * (row % 2), 5.63 * row);
  }
  return taxels;
}

ContactEstimate tip(double x, double y, double force, double radius) {
  ContactEstimate contact;
  contact.position_mm = {x, y};
  contact.force_n = force;
  contact.tip_radius_mm = radius;
  return contact;
}

std::vector<TaxelObservation> observed(const std::vector<Eigen::Vector2d>& taxels, const std::vector<double>& values) {
  std::vector<TaxelObservation> list;
  for (std::size_t t = 0; t < taxels.size(); ++t) list.push_back({taxels[t], values[t]});
  return list;
}

const Layer kFabric{2.0, 0.1, 30.0};

class Inverse : public testing::Test {
 protected:
  // The table takes most of a second to make, so all tests share it.
  static inline const ContactTable table{kFabric};
};

// Compares the forward model of the fit with the exact contact and its own quadrature.
TEST_F(Inverse, PredictionIsTheExactContact) {
  const Contact exact = press_bonded(kFabric, {Shape::kSphere, 12.0}, 0.4);
  const std::vector<Eigen::Vector2d> taxels = {{0, 0}, {2, 1}, {-3, 2}, {5, 0}, {0, 9}};
  const std::vector<ContactEstimate> contacts = {tip(0.0, 0.0, 0.4, 12.0)};
  const auto predicted = predict_taxels(table, taxels, contacts);
  const double peak = taxel_dc_over_c(kFabric, exact, 0.0);
  for (std::size_t t = 0; t < taxels.size(); ++t)
    EXPECT_NEAR(predicted[t], taxel_dc_over_c(kFabric, exact, taxels[t].norm()), 4e-3 * peak);
}

TEST_F(Inverse, OpenCasesWithoutNoise) {
  if (!std::filesystem::exists(observations_file()))
    GTEST_SKIP() << "left out without data: " << observations_file() << " does not exist (TRISKIN_SHARED_DATA)";
  const auto truth = nlohmann::json::parse(std::ifstream(observations_file())).at("truth");
  for (const bool knows_count : {true, false}) {
    auto cases = read_inverse_cases(observations_file());
    for (InverseCase& one : cases) {
      if (!knows_count) one.options.contacts.reset();
    }
    const auto results = solve_inverse_cases(cases);
    ASSERT_EQ(results.size(), truth.size());
    for (std::size_t k = 0; k < results.size(); ++k) {
      const auto& contacts = truth[k].at("contacts");
      ASSERT_EQ(results[k].contacts.size(), contacts.size());
      for (const auto& t : contacts) {
        const Eigen::Vector2d place(t["position_mm"][0], t["position_mm"][1]);
        const auto found =
            std::min_element(results[k].contacts.begin(), results[k].contacts.end(), [&](const auto& a, const auto& b) {
              return (a.position_mm - place).norm() < (b.position_mm - place).norm();
            });
        EXPECT_LT((found->position_mm - place).norm(), 0.5) << truth[k]["id"];
        EXPECT_NEAR(found->force_n / t["force_n"].get<double>(), 1.0, 0.05) << truth[k]["id"];
      }
    }
  }
}

struct Scatter {
  int draws = 0, miscounted = 0, within = 0;
  double squares = 0.0;
  [[nodiscard]] double coverage() const { return within / (3.0 * (draws - miscounted)); }
  [[nodiscard]] double mean_square() const { return squares / (3.0 * (draws - miscounted)); }
};

// Draws one contact with noise and returns errors of x, y and force over their stated deviations.
Scatter scatter_of(const ContactTable& table, const ContactEstimate& truth, int draws) {
  std::mt19937_64 engine(7);
  std::normal_distribution<double> noise(0.0, 0.01);
  const auto taxels = lattice();
  const std::vector<ContactEstimate> contacts = {truth};
  const auto exact = predict_taxels(table, taxels, contacts);
  Scatter scatter;
  for (scatter.draws = 0; scatter.draws < draws; ++scatter.draws) {
    auto values = exact;
    for (double& v : values) v += noise(engine);
    const InverseResult result = find_contacts(table, observed(taxels, values), {.noise_dc_over_c = 0.01});
    if (result.contacts.size() != 1U) {
      ++scatter.miscounted;
      continue;
    }
    const ContactEstimate& c = result.contacts[0];
    const Eigen::Vector2d offset = c.position_mm - truth.position_mm;
    const Eigen::Array3d error(offset.x(), offset.y(), c.force_n - truth.force_n);
    const Eigen::Array3d deviation(c.position_sd_mm.x(), c.position_sd_mm.y(), c.force_sd_n);
    scatter.within += static_cast<int>(((error / deviation).abs() < 1.96).count());
    scatter.squares += (error / deviation).square().sum();
  }
  return scatter;
}

// Three taxels are pressed, and place, force and radius trade off along a bent ridge, so that the curvature at the best
// fit gives too little. A true deviation makes the mean square 1 and covers 95 %.
TEST_F(Inverse, StatedDeviationsAreTrue) {
  const Scatter scatter = scatter_of(table, tip(27.3, 21.8, 0.5, 15.0), 50);
  // The test for one more contact accepts noise once in a thousand draws.
  EXPECT_EQ(scatter.miscounted, 0);
  EXPECT_GT(scatter.coverage(), 0.90);
  EXPECT_GT(scatter.mean_square(), 0.6);
  EXPECT_LT(scatter.mean_square(), 1.5);
}

// If many taxels are pressed the posterior is normal, and the bound of Cramér and Rao is reached.
TEST_F(Inverse, WideContactReachesTheCramerRaoBound) {
  const Scatter scatter = scatter_of(table, tip(26.0, 21.0, 1.4, 43.0), 50);
  EXPECT_EQ(scatter.miscounted, 0);
  EXPECT_GT(scatter.coverage(), 0.90);
  EXPECT_GT(scatter.mean_square(), 0.6);
  EXPECT_LT(scatter.mean_square(), 1.5);
}

// A signal of 0.03 at the end of the skin, three deviations of the noise, would need a huge force beside the skin; no
// search may begin there (one did, and ended as two contacts).
TEST_F(Inverse, NoiseAtTheEdgeOfTheSkinDoesNotMislead) {
  const auto taxels = lattice();
  const std::vector<ContactEstimate> contacts = {tip(27.3, 21.8, 0.5, 15.0)};
  auto values = predict_taxels(table, taxels, contacts);
  values[8] += 0.03;
  values[72] += 0.03;
  const InverseResult result = find_contacts(table, observed(taxels, values), {.noise_dc_over_c = 0.01});
  ASSERT_EQ(result.contacts.size(), 1U);
  EXPECT_LT((result.contacts[0].position_mm - contacts[0].position_mm).norm(), 0.5);
  const InverseResult told = find_contacts(table, observed(taxels, values), {.noise_dc_over_c = 0.01, .contacts = 1});
  ASSERT_EQ(told.contacts.size(), 1U);
  EXPECT_LT((told.contacts[0].position_mm - contacts[0].position_mm).norm(), 0.5);
}

TEST_F(Inverse, StudyCoversTheTruth) {
  const InverseStudy study = study_inverse(10, 3);
  ASSERT_EQ(study.rows.size(), 2U);
  int covered = 0, values = 0;
  for (const StudyRow& row : study.rows) {
    EXPECT_EQ(row.draws, 5);
    EXPECT_LE(row.wrong_counts, 1) << row.contacts;
    EXPECT_EQ(row.estimates, row.contacts * (row.draws - row.wrong_counts));
    covered += static_cast<int>(std::lround(row.covered * 3 * row.estimates));
    values += 3 * row.estimates;
  }
  EXPECT_GT(covered, 0.85 * values);
  EXPECT_NE(study_text(study).find("| 2 | 5 |"), std::string::npos);
  EXPECT_THROW((void)study_inverse(1, 3), InputError);
}

TEST_F(Inverse, CountsTwoContactsAndNone) {
  const auto taxels = lattice();
  const std::vector<ContactEstimate> contacts = {tip(15.0, 15.0, 0.3, 8.0), tip(38.0, 30.0, 0.15, 8.0)};
  std::mt19937_64 engine(3);
  std::normal_distribution<double> noise(0.0, 0.005);
  auto values = predict_taxels(table, taxels, contacts);
  for (double& v : values) v += noise(engine);
  const InverseOptions options{.noise_dc_over_c = 0.005};
  const InverseResult two = find_contacts(table, observed(taxels, values), options);
  ASSERT_EQ(two.contacts.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    const ContactEstimate& c = two.contacts[k];
    // The noise of one draw may move a contact by what the estimate itself states, and that must be little.
    EXPECT_LT((c.position_mm - contacts[k].position_mm).cwiseQuotient(c.position_sd_mm).norm(), 3.0) << k;
    EXPECT_LT(c.position_sd_mm.norm(), 1.5) << k;
  }
  for (double& v : values) v = noise(engine);
  EXPECT_TRUE(find_contacts(table, observed(taxels, values), options).contacts.empty());
  EXPECT_TRUE(find_contacts(table, {}, {}).contacts.empty());
}

// One pressed taxel cannot separate place, force and radius, so the deviations must be wide.
TEST_F(Inverse, SinglePressedTaxelHasWideDeviations) {
  const std::vector<Eigen::Vector2d> taxels = {{0, 0}, {12, 0}, {-12, 0}, {0, 12}, {0, -12}};
  const std::vector<ContactEstimate> contacts = {tip(1.0, 0.5, 0.05, 3.0)};
  const auto values = predict_taxels(table, taxels, contacts);
  const InverseResult result = find_contacts(table, observed(taxels, values), {.noise_dc_over_c = 0.01});
  ASSERT_EQ(result.contacts.size(), 1U);
  const ContactEstimate& c = result.contacts[0];
  EXPECT_GT(c.position_sd_mm.x(), 0.5);
  EXPECT_GT(c.force_sd_n / c.force_n, 0.2);
}

// One of the pressed taxels is dead. Exact values show that they are exact and give the place; with a stated noise of
// 0.01 the same values leave a wide posterior, whose mean is the estimate.
TEST_F(Inverse, DeadTaxelsAreLeftOut) {
  const auto taxels = lattice();
  const std::vector<ContactEstimate> contacts = {tip(20.0, 20.0, 0.5, 15.0)};
  auto values = predict_taxels(table, taxels, contacts);
  values[30] = std::nan("");
  const InverseResult exact = find_contacts(table, observed(taxels, values), {});
  ASSERT_EQ(exact.contacts.size(), 1U);
  EXPECT_LT((exact.contacts[0].position_mm - contacts[0].position_mm).norm(), 0.3);
  EXPECT_NEAR(exact.contacts[0].force_n, 0.5, 0.02);
  const InverseResult noisy = find_contacts(table, observed(taxels, values), {.noise_dc_over_c = 0.01});
  ASSERT_EQ(noisy.contacts.size(), 1U);
  const ContactEstimate& c = noisy.contacts[0];
  EXPECT_LT((c.position_mm - contacts[0].position_mm).norm(), 1.96 * c.position_sd_mm.norm());
  EXPECT_LT(std::abs(c.force_n - 0.5), 1.96 * c.force_sd_n);
}

void expect_refused(const std::string& text, const char* words) {
  const auto path = std::filesystem::temp_directory_path() / ("inverse." + std::to_string(::getpid()) + ".json");
  std::ofstream(path) << text;
  try {
    (void)read_inverse_cases(path);
    ADD_FAILURE() << "taken: " << text;
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr(words));
    EXPECT_THAT(error.what(), testing::HasSubstr(path.string()));
  }
  std::filesystem::remove(path);
}

TEST(InverseFile, SaysWhatIsWrongAndWhere) {
  const std::string modules = R"({"modules":[{"taxels_mm":[[0,0],[1,2]]}],"cases":)";
  expect_refused("{", "no JSON: line 1, column 2");
  expect_refused("[]", "has no \"modules\"");
  expect_refused(R"({"modules":[{"taxels_mm":[[0]]}]})", "a position is [x, y]");
  expect_refused(modules + "5}", "cases: is no list");
  expect_refused(modules + "[{}]}", "cases 0: has no \"material\"");
  expect_refused(modules + R"([{"material":{"h_mm":2,"nu":0.1,"E_kpa":"soft"}}]})", "E_kpa: is no number");
  expect_refused(modules + R"([{"material":{"h_mm":2,"nu":0.1,"E_kpa":30},"dC_over_C0":[]}]})", "0 rows for 1 modules");
  expect_refused(modules + R"([{"material":{"h_mm":2,"nu":0.1,"E_kpa":30},"dC_over_C0":[[1]]}]})",
                 "1 values for 2 taxels");
  expect_refused(modules + R"([{"material":{"h_mm":2,"nu":0.1,"E_kpa":30},"dC_over_C0":[[1,"x"]]}]})",
                 "1: is no number");
}

TEST(InverseFile, RefusesOptionsOutOfRange) {
  const ContactTable table(kFabric);
  EXPECT_THROW((void)find_contacts(table, {}, {.noise_dc_over_c = -1.0}), InputError);
  EXPECT_THROW((void)find_contacts(table, {}, {.contacts = 99}), InputError);
  EXPECT_THROW((void)find_contacts(table, {}, {.tip_radius_mm = 0.0}), InputError);
}

}  // namespace
}  // namespace triskin::mechanics
