// SPDX-License-Identifier: GPL-3.0-or-later
// Tests seams that a user asks for or forbids.
#include "triskin/unfolding/seams.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>

#include "triskin/base/error.hpp"
#include "triskin/placement/polygon_io.hpp"
#include "triskin/unfolding/unfolding.hpp"

namespace triskin::unfolding {
namespace {

namespace fs = std::filesystem;

std::size_t at(int k) {
  return static_cast<std::size_t>(k);
}

// The sheet has nu × nv cells; if wrapped, the last column is the first.
Mesh sheet(int nu, int nv, bool wrapped, const std::function<Vec3(double, double)>& map) {
  Mesh mesh;
  const int columns = wrapped ? nu : nu + 1;
  for (int v = 0; v <= nv; ++v) {
    for (int u = 0; u < columns; ++u)
      mesh.vertices.push_back(map(static_cast<double>(u) / nu, static_cast<double>(v) / nv));
  }
  for (int v = 0; v < nv; ++v) {
    for (int u = 0; u < nu; ++u) {
      const int a = v * columns + u, b = v * columns + (u + 1) % columns;
      mesh.faces.push_back({a, b, b + columns});
      mesh.faces.push_back({a, b + columns, a + columns});
    }
  }
  return mesh;
}
Mesh plane() {
  return sheet(10, 8, false, [](double u, double v) { return Vec3(100 * u, 80 * v, 0); });
}
Mesh dome(double radius) {
  return sheet(20, 20, false, [=](double u, double v) {
    const double x = 160 * (u - 0.5), y = 160 * (v - 0.5);
    return Vec3(x, y, std::sqrt(radius * radius - x * x - y * y));
  });
}

// Returns corner k of a face on the plane; nothing when the face is in another piece.
std::optional<std::pair<std::size_t, Vec2>> flat_corner(const Net& net, FaceIndex face, int k) {
  for (std::size_t p = 0; p < net.pieces.size(); ++p) {
    const auto found = std::ranges::find(net.pieces[p].faces, face);
    if (found != net.pieces[p].faces.end())
      return std::pair{p, net.pieces[p].flat[static_cast<std::size_t>(found - net.pieces[p].faces.begin())][at(k)]};
  }
  return std::nullopt;
}

// Returns true if both ends of the edge are at the same places of one piece, seen from either face.
bool is_joined(const mesh::Surface& s, const Net& net, const SurfaceEdge& edge) {
  const FaceIndex other = s.neighbours(edge.face)[at(edge.side)];
  const auto &f = s.mesh().faces[at(edge.face)], &g = s.mesh().faces[at(other)];
  bool same = true;
  for (const int k : {edge.side, (edge.side + 1) % 3}) {
    const auto there = static_cast<int>(std::ranges::find(g, f[at(k)]) - g.begin());
    const auto a = flat_corner(net, edge.face, k), b = flat_corner(net, other, there);
    same = same && a && b && a->first == b->first && (a->second - b->second).norm() < 1e-9;
  }
  return same;
}

std::string message_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(Seams, a_line_across_a_plane_makes_two_pieces) {
  const mesh::Surface s(plane());
  const auto edges = edges_along(s, {{{30, 0, 0}, {30, 80, 0}}}, "line");
  EXPECT_EQ(edges.size(), 8U);
  const Net net = unfold(s, {.seams = edges});
  ASSERT_EQ(net.pieces.size(), 2U);
  EXPECT_NEAR(placement::polygon_area(net.pieces[0].outline), 5600.0, 1e-6);
  EXPECT_NEAR(placement::polygon_area(net.pieces[1].outline), 2400.0, 1e-6);
}

TEST(Seams, a_tube_opens_where_it_is_asked_to) {
  const mesh::Surface s(sheet(24, 8, true, [](double u, double v) {
    return Vec3(50 * std::cos(2 * M_PI * u), 50 * std::sin(2 * M_PI * u), 120 * v);
  }));
  const auto edges = edges_along(s, {{{0, 50, 0}, {0, 50, 120}}}, "line");
  EXPECT_EQ(edges.size(), 8U);
  const Net net = unfold(s, {.seams = edges});
  ASSERT_EQ(net.pieces.size(), 1U);
  EXPECT_LT(net.pieces[0].max_edge_error_mm, 0.1);
  for (const SurfaceEdge& e : edges) EXPECT_FALSE(is_joined(s, net, e));
}

TEST(Seams, a_forbidden_line_is_not_cut) {
  const mesh::Surface s(dome(130.0));
  // The free division cuts here by itself:
  const Net free = unfold(s, {.edge_error_mm = 0.5});
  ASSERT_GT(free.pieces.size(), 1U);
  const auto edges = edges_along(s, {{{-80, 0, 65}, {80, 0, 65}}}, "line", 100.0);
  EXPECT_FALSE(std::ranges::all_of(edges, [&](const SurfaceEdge& e) { return is_joined(s, free, e); }));
  const Net net = unfold(s, {.edge_error_mm = 0.5, .uncut = edges});
  for (const SurfaceEdge& e : edges) EXPECT_TRUE(is_joined(s, net, e));
  for (const Piece& p : net.pieces) EXPECT_LE(p.max_edge_error_mm, 0.5);
}

TEST(Seams, what_cannot_be_is_said) {
  const mesh::Surface s(dome(115.0));
  std::vector<SurfaceEdge> all;
  for (FaceIndex f{0}; f < static_cast<int>(s.mesh().faces.size()); ++f) {
    for (int side = 0; side < 3; ++side) {
      if (s.neighbours(f)[at(side)] >= 0) all.push_back({f, side});
    }
  }
  EXPECT_NE(message_of([&] { (void)unfold(s, {.uncut = all}); }).find("must stay joined"), std::string::npos);
  const std::vector<SurfaceEdge> one{all.front()};
  EXPECT_NE(message_of([&] { (void)unfold(s, {.seams = one, .uncut = one}); }).find("asked for and forbidden"),
            std::string::npos);
}

TEST(Seams, lines_off_the_surface_are_named) {
  const mesh::Surface s(plane());
  EXPECT_NE(
      message_of([&] { (void)edges_along(s, {{{0, 0, 0}, {0, 0, 30}}}, "my.obj"); }).find("my.obj: line 1, point 2"),
      std::string::npos);
  EXPECT_NE(message_of([&] { (void)edges_along(s, {{{0, 0, 0}, {1, 1, 0}}}, "my.obj"); }).find("single vertex"),
            std::string::npos);
  Mesh two = plane();
  const auto count = static_cast<int>(two.vertices.size());
  for (int k = 0; k < count; ++k) two.vertices.emplace_back(two.vertices[at(k)] + Vec3(300, 0, 0));
  for (const auto f : std::vector(two.faces)) two.faces.push_back({f[0] + count, f[1] + count, f[2] + count});
  EXPECT_NE(message_of([&] {
              (void)edges_along(mesh::Surface(two), {{{0, 0, 0}, {300, 0, 0}}}, "my.obj");
            }).find("do not hang together"),
            std::string::npos);
}

TEST(Seams, files_are_read_and_bad_ones_named) {
  const fs::path file = fs::temp_directory_path() / ("seams." + std::to_string(::getpid()) + ".obj");
  const auto read = [&](const std::string& text, std::optional<mesh::LengthUnit> unit = {}) {
    std::ofstream(file) << text;
    return read_seams(file, unit);
  };
  const SeamLines lines =
      read("# two lines\nv 0 0 0\nv 0.01 0 0\nv 0 2e-2 0\nl 1 2\no x\nl -1 1/1 2\n", mesh::LengthUnit::kMetre);
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0], (std::vector<Vec3>{{0, 0, 0}, {10, 0, 0}}));
  EXPECT_EQ(lines[1], (std::vector<Vec3>{{0, 20, 0}, {0, 0, 0}, {10, 0, 0}}));
  const auto says = [&](const std::string& text, const std::string& part) {
    const std::string message = message_of([&] { (void)read(text); });
    EXPECT_NE(message.find(file.filename().string()), std::string::npos) << text;
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  says("", "no line in it");
  says("v 0 0 0\nv 1 0 0\n", "no line in it");
  says("v 0 0\nv 1 0 0\nl 1 2\n", ":1: a vertex needs three");
  says("v 0 0 nan\n", ":1: a vertex needs three");
  says("v 0 0 0\nv 1 0 0\nl 1 3\n", "vertex 3 does not exist");
  says("v 0 0 0\nv 1 0 0\nl 1 0\n", "vertex 0 does not exist");
  says("v 0 0 0\nl 1\n", "two points at least");
  says("v 0 0 0\nv 1 0 0\nl 1 b\n", "\"b\" is no vertex number");
  fs::remove(file);
  EXPECT_FALSE(message_of([&] { (void)read_seams(file); }).empty());
}

}  // namespace
}  // namespace triskin::unfolding
