// SPDX-License-Identifier: GPL-3.0-or-later
// The file keeps the front of the layouts found, and each of them can be taken without a search.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"
#include "triskin/check/design_rules.hpp"
#include "triskin/mesh/mesh_io.hpp"
#include "triskin/pipeline/make_design.hpp"

namespace triskin::pipeline {
namespace {

namespace fs = std::filesystem;

// Half of a dome is too curved for one island.
design::Mesh dome() {
  design::Mesh mesh;
  constexpr int kRings = 10, kAround = 32;
  for (int r = 0; r <= kRings; ++r) {
    for (int k = 0; k < kAround; ++k) {
      const double slope = 0.15 + 1.25 * r / kRings, turn = 2.0 * M_PI * k / kAround;
      mesh.vertices.emplace_back(80 * std::sin(slope) * std::cos(turn), 80 * std::sin(slope) * std::sin(turn),
                                 80 * std::cos(slope));
    }
  }
  for (int r = 0; r < kRings; ++r) {
    for (int k = 0; k < kAround; ++k) {
      const int a = r * kAround + k, b = r * kAround + (k + 1) % kAround;
      mesh.faces.push_back({a, a + kAround, b});
      mesh.faces.push_back({b, a + kAround, b + kAround});
    }
  }
  return mesh;
}

class Alternatives : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("alternatives." + std::to_string(::getpid()));
    fs::create_directories(folder_);
    mesh::write_obj(folder_ / "dome.obj", dome());
  }
  void TearDown() override { fs::remove_all(folder_); }
  [[nodiscard]] static std::size_t violations(const fs::path& file) {
    const check::DesignReport report = check::check_design(file);
    for (const check::Violation& v : report.violations) ADD_FAILURE() << v.rule << ": " << v.where << ": " << v.text;
    return report.violations.size();
  }
  fs::path folder_;
};

TEST_F(Alternatives, are_a_front_from_which_another_layout_is_taken) {
  DesignOptions options;
  options.iterations = 120;
  options.time_limit_s = 100.0;
  const design::Design d = make_design(folder_ / "dome.obj", options).design;
  ASSERT_GE(d.alternatives.size(), 2U);
  for (std::size_t k = 1; k < d.alternatives.size(); ++k) {
    EXPECT_LT(d.alternatives[k].layout.modules.size(), d.alternatives[k - 1].layout.modules.size());
    EXPECT_LT(d.alternatives[k].price, d.alternatives[k - 1].price);
  }
  // The best value is taken, and its price is that of the actual wiring.
  ASSERT_GE(d.taken, 0);
  const auto value = [](const design::Alternative& a) {
    return static_cast<double>(a.layout.modules.size()) - a.price;
  };
  const design::Alternative& taken = d.alternatives[static_cast<std::size_t>(d.taken)];
  for (const design::Alternative& a : d.alternatives) EXPECT_LE(value(a), value(taken) + 1e-9);
  EXPECT_EQ(taken.layout.modules.size(), d.layout.modules.size());
  const design::Price price;
  EXPECT_NEAR(taken.price,
              price.controller * static_cast<double>(d.patches.size()) +
                  price.jumper * static_cast<double>(d.layout.jumpers.size()) + price.island * d.layout.islands,
              1e-9);
  design::write_design(folder_ / "a.json", d);
  EXPECT_EQ(violations(folder_ / "a.json"), 0U);
  // Each alternative can be taken from the file.
  design::Design read = design::read_intact_design(folder_ / "a.json");
  // A pricing that ran out of time leaves such values.
  for (design::Alternative& a : read.alternatives) a.jumpers += 5;
  for (int k = 0; k < static_cast<int>(read.alternatives.size()); ++k) {
    const design::Design other = take_alternative(read, k);
    EXPECT_EQ(other.layout.modules.size(), d.alternatives[static_cast<std::size_t>(k)].layout.modules.size());
    EXPECT_EQ(other.taken, k);
    const design::Alternative& stated = other.alternatives[static_cast<std::size_t>(k)];
    EXPECT_EQ(stated.jumpers, static_cast<int>(other.layout.jumpers.size()));
    EXPECT_NEAR(stated.price, other.price.of(stated.patches, stated.jumpers, other.layout.islands), 1e-9);
    EXPECT_LE(other.patches.size(), static_cast<std::size_t>(d.alternatives[static_cast<std::size_t>(k)].patches));
    design::write_design(folder_ / "b.json", other);
    EXPECT_EQ(violations(folder_ / "b.json"), 0U);
    if (k != d.taken) continue;
    EXPECT_EQ(other.design_id, d.design_id);
  }
  EXPECT_THROW((void)take_alternative(read, static_cast<int>(read.alternatives.size())), InputError);
}

}  // namespace
}  // namespace triskin::pipeline
