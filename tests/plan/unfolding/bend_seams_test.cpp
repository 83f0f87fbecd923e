// SPDX-License-Identifier: GPL-3.0-or-later
// Tests pieces along places that bend too much, on surfaces whose radii are known.
#include "triskin/unfolding/bend_seams.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>

#include "triskin/base/error.hpp"
#include "triskin/pipeline/make_design.hpp"
#include "triskin/unfolding/unfolding.hpp"

namespace triskin::unfolding {
namespace {

template <class Place>
Mesh grid(int nu, int nv, Place place) {
  Mesh m;
  for (int v = 0; v <= nv; ++v) {
    for (int u = 0; u <= nu; ++u) m.vertices.push_back(place(u, v));
  }
  for (int v = 0; v < nv; ++v) {
    for (int u = 0; u < nu; ++u) {
      const int a = v * (nu + 1) + u, b = a + nu + 1;
      m.faces.push_back({a, a + 1, b + 1});
      m.faces.push_back({a, b + 1, b});
    }
  }
  return m;
}

void write_obj(const Mesh& mesh, const std::filesystem::path& file) {
  std::ofstream out(file);
  for (const Vec3& v : mesh.vertices) out << "v " << v.x() << " " << v.y() << " " << v.z() << "\n";
  for (const auto& f : mesh.faces) out << "f " << f[0] + 1 << " " << f[1] + 1 << " " << f[2] + 1 << "\n";
}

// Two plates of 100 mm, joined by a quarter of a cylinder, are a sheet of one piece that can be laid flat.
Mesh bent_sheet(double radius_mm) {
  const double bend = 0.5 * M_PI * radius_mm, length = 200.0 + bend;
  const int n = static_cast<int>(std::lround(length / 4.0));
  return grid(n, 30, [=](int u, int v) {
    const double s = length * u / n - 100.0, y = 4.0 * v;
    if (s <= 0.0) return Vec3(s, y, 0.0);
    if (s >= bend) return Vec3(radius_mm, y, -radius_mm - (s - bend));
    return Vec3(radius_mm * std::sin(s / radius_mm), y, -radius_mm * (1.0 - std::cos(s / radius_mm)));
  });
}

Mesh cap(double radius_mm) {
  return grid(24, 24,
              [=](int u, int v) { return Vec3(radius_mm * Vec3(u / 12.0 - 1.0, v / 12.0 - 1.0, 1.5).normalized()); });
}

TEST(BendSeams, radii_of_sphere_and_cylinder) {
  for (const double radius_mm : {60.0, 100.0, 150.0}) {
    const mesh::Surface sphere(cap(radius_mm)), sheet(bent_sheet(radius_mm));
    const auto on_sphere = bending_radii(sphere), on_sheet = bending_radii(sheet);
    EXPECT_NEAR(on_sphere[on_sphere.size() / 2 + 24], radius_mm, 0.05 * radius_mm);
    double least = 1e300;
    for (const double r : on_sheet) least = std::min(least, r);
    EXPECT_NEAR(least, radius_mm, 0.06 * radius_mm);
  }
}

TEST(BendSeams, a_bend_under_the_limit_becomes_a_piece_of_its_own) {
  const mesh::Surface sheet(bent_sheet(30.0));
  EXPECT_EQ(unfold(sheet).pieces.size(), 1U);
  UnfoldingOptions options;
  options.seams = seams_along_bends(sheet, 50.0);
  const Net net = unfold(sheet, options);
  ASSERT_EQ(net.pieces.size(), 3U);
  std::multiset<double> areas;  // The areas are plates of about 100 mm less the part near the bend, and the bend.
  for (const Piece& p : net.pieces) {
    double x = 0.0;
    for (const auto& t : p.flat)
      x += std::abs((t[1] - t[0]).x() * (t[2] - t[0]).y() - (t[1] - t[0]).y() * (t[2] - t[0]).x());
    areas.insert(0.5 * x);
  }
  const double bend = 0.5 * M_PI * 30.0 * 120.0;
  EXPECT_GT(*areas.begin(), bend * 0.8);
  EXPECT_LT(*areas.begin(), bend + 2 * 18.0 * 120.0);
}

TEST(BendSeams, nothing_is_cut_where_nothing_or_everything_bends) {
  EXPECT_TRUE(seams_along_bends(mesh::Surface(bent_sheet(100.0)), 50.0).empty());
  EXPECT_TRUE(seams_along_bends(mesh::Surface(cap(100.0)), 50.0).empty());
  EXPECT_TRUE(seams_along_bends(mesh::Surface(cap(40.0)), 80.0).empty());
  EXPECT_FALSE(seams_along_bends(mesh::Surface(bent_sheet(30.0)), 50.0).empty());
}

TEST(BendSeams, a_radius_that_is_none_is_an_error) {
  for (const double r : {0.0, -5.0, std::nan("")})
    EXPECT_THROW((void)seams_along_bends(mesh::Surface(cap(100.0)), r), InputError);
}

// The modules that the lattice grows keep the radius as well: by hand, the sagitta of 30 mm on 50 mm is 2.25 mm.
TEST(BendLimits, hold_for_the_modules_of_a_design) {
  // On a tube of 40 mm, a side across it needs 2.8 mm, and sides of which one lies along it need 2.1 mm.
  const Mesh half_tube = grid(24, 40, [](int u, int v) {
    const double angle = M_PI * (0.1 + 0.8 * u / 24.0);
    return Vec3(-40.0 * std::cos(angle), 5.0 * v, 40.0 * std::sin(angle));
  });
  const auto folder = std::filesystem::temp_directory_path() / ("bend_limits." + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  write_obj(half_tube, folder / "tube.obj");
  pipeline::DesignOptions options;
  options.iterations = 3'000;
  options.threads = 1;
  const auto deepest = [&](double radius_mm) {
    options.bend_radius_mm = radius_mm;
    const design::Design d = pipeline::make_design(folder / "tube.obj", options).design;
    EXPECT_FALSE(d.layout.modules.empty());
    double depth_mm = 0.0;
    for (const auto& m : d.layout.modules) depth_mm = std::max({depth_mm, m.edge_depth_mm, m.edge_lift_mm});
    EXPECT_DOUBLE_EQ(d.limits.depth_mm, radius_mm > 0.0 ? 112.5 / radius_mm : 4.5);
    return depth_mm;
  };
  EXPECT_GT(deepest(0.0), 2.25);
  EXPECT_LE(deepest(50.0), 2.25 + 1e-9);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace triskin::unfolding
