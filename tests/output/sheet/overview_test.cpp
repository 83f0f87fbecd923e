// SPDX-License-Identifier: GPL-3.0-or-later
// The overview must draw a surface of few faces shape by shape, and one of many faces as a picture in each view.
#include <gtest/gtest.h>

#include <cmath>

#include "support/strip_design.hpp"
#include "triskin/sheet/sheet.hpp"

namespace triskin::test {
namespace {

// Puts the strip on a wavy rectangle of 2 · cells² faces.
design::Design on_waves(int cells) {
  design::Design d = strip(6);
  d.surface.vertices.clear();
  d.surface.faces.clear();
  const auto at = [=](int i, int j) { return j * (cells + 1) + i; };
  for (int j = 0; j <= cells; ++j) {
    for (int i = 0; i <= cells; ++i) {
      const double x = 100.0 * i / cells, y = 60.0 * j / cells;
      d.surface.vertices.emplace_back(x, y, -5.0 + 2.0 * std::sin(x / 10.0));
    }
  }
  for (int j = 0; j < cells; ++j) {
    for (int i = 0; i < cells; ++i) {
      d.surface.faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      d.surface.faces.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return d;
}

std::size_t count(const std::string& text, const std::string& word) {
  std::size_t n = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++n;
  return n;
}

TEST(Overview, few_faces_are_shapes_and_many_are_a_picture_in_each_view) {
  if (!sheet::can_draw()) GTEST_SKIP() << "built without Cairo";
  const std::string few = sheet::svg(on_waves(4), sheet::Paper::kA4);
  const std::string more = sheet::svg(on_waves(10), sheet::Paper::kA4);
  const std::string many = sheet::svg(on_waves(60), sheet::Paper::kA4);
  EXPECT_EQ(count(few, "<image"), 0U);
  EXPECT_EQ(count(more, "<path"), count(few, "<path") + 6U * (200 - 32));
  EXPECT_EQ(count(many, "<image"), 6U);
  EXPECT_EQ(count(many, "<path"), count(few, "<path") - 6U * 32);
  EXPECT_LT(many.size(), more.size());  // There are 7,200 faces against 200.
  EXPECT_LT(sheet::pdf(on_waves(60), sheet::Paper::kA4).size(), 300'000U);
}

}  // namespace
}  // namespace triskin::test
