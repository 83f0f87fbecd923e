// SPDX-License-Identifier: GPL-3.0-or-later
// Copies of a generated and of six real covers — turned, mirrored, in metres, renumbered, divided, meshed anew —
// must give the same number of modules within 3 %. All costs are 0: with a price, layouts of nearly the same value
// differ by more modules than that, because one island more or less pays for some. On LH and LUA one module is more
// than 3 %: copies with the same triangles must give the same number there, those with other triangles may miss by one
// (LUA meshed anew gave 29 of 30). The steps are so many that the search has nearly ended: with 800 RUF meshed anew
// gave 59 of 61, with 1,500 61 of 62; with 500 LT divided gave 210 of 203.
#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <filesystem>
#include <map>
#include <random>

#include "shapes.hpp"
#include "support/covers.hpp"
#include "triskin/mesh/extract.hpp"
#include "triskin/mesh/mesh_io.hpp"

namespace triskin::lattice {
namespace {

namespace fs = std::filesystem;

Mesh turned(Mesh m) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  for (Vec3& v : m.vertices) v = turn * v + Vec3(500, -20, 7);
  return m;
}

Mesh mirrored(Mesh m) {
  for (Vec3& v : m.vertices) v.x() = -v.x();
  for (auto& f : m.faces) std::swap(f[1], f[2]);
  return m;
}

// The mesh is written in metres and read with the unit, as a user would do.
Mesh in_metres(Mesh m) {
  for (Vec3& v : m.vertices) v /= 1000.0;
  const fs::path file = fs::temp_directory_path() / ("copies." + std::to_string(::getpid()) + ".obj");
  mesh::write_obj(file, m);
  Mesh read = mesh::read_mesh(file, mesh::LengthUnit::kMetre).mesh;
  fs::remove(file);
  return read;
}

Mesh numbered_anew(const Mesh& m) {
  constexpr unsigned kSeed = 5;
  std::mt19937 random(kSeed);
  std::vector<int> to(m.vertices.size());
  for (std::size_t k = 0; k < to.size(); ++k) to[k] = static_cast<int>(k);
  std::ranges::shuffle(to, random);
  Mesh out{std::vector<Vec3>(m.vertices.size()), m.faces};
  for (std::size_t k = 0; k < to.size(); ++k) out.vertices[at(to[k])] = m.vertices[k];
  for (auto& f : out.faces) {
    for (int& v : f) v = to[at(v)];
    std::ranges::rotate(f, f.begin() + 1);
  }
  std::ranges::shuffle(out.faces, random);
  return out;
}

// Makes isotropic triangles of 6 mm; the border stays.
Mesh meshed_anew(const Mesh& m) {
  using Cgal = CGAL::Surface_mesh<CGAL::Simple_cartesian<double>::Point_3>;
  Cgal mesh;
  std::vector<Cgal::Vertex_index> vertex;
  for (const Vec3& v : m.vertices) vertex.push_back(mesh.add_vertex({v.x(), v.y(), v.z()}));
  for (const auto& f : m.faces) mesh.add_face(vertex[at(f[0])], vertex[at(f[1])], vertex[at(f[2])]);
  std::vector<Cgal::Edge_index> border;
  for (const auto e : mesh.edges()) {
    if (mesh.is_border(e)) border.push_back(e);
  }
  namespace pmp = CGAL::Polygon_mesh_processing;
  pmp::split_long_edges(border, 6.0, mesh);
  pmp::isotropic_remeshing(mesh.faces(), 6.0, mesh,
                           CGAL::parameters::number_of_iterations(3).protect_constraints(true));
  mesh.collect_garbage();
  Mesh out;
  for (const auto v : mesh.vertices())
    out.vertices.emplace_back(mesh.point(v).x(), mesh.point(v).y(), mesh.point(v).z());
  for (const auto f : mesh.faces()) {
    std::array<int, 3> face{};
    std::size_t k = 0;
    for (const auto v : mesh.vertices_around_face(mesh.halfedge(f))) face[k++] = static_cast<int>(v.idx());
    out.faces.push_back(face);
  }
  return out;
}

class Copies : public testing::TestWithParam<std::pair<test::CoverName, int>> {};

TEST_P(Copies, give_the_same_count_within_three_percent) {
  const auto& [part, steps] = GetParam();
  const auto file = test::cover_file(part);
  if (!file) GTEST_SKIP() << test::no_data();
  const Mesh original = mesh::read_mesh(file->path()).mesh;
  const auto count = [iterations = steps](const Mesh& m) {
    SurfaceLatticeOptions options = effort(iterations);
    options.price = {.controller = 0.0, .jumper = 0.0, .island = 0.0};
    return grow_lattice(mesh::Surface(mesh::extract(m).surface), {}, options).modules.size();
  };
  const std::size_t expected = count(original);
  const std::map<std::string, Mesh> copies{
      {"turned", turned(original)},       {"mirrored", mirrored(original)},
      {"in metres", in_metres(original)}, {"numbered anew", numbered_anew(original)},
      {"divided", divided(original)},     {"meshed anew", meshed_anew(original)}};
  for (const auto& [name, mesh] : copies) {
    const std::size_t found = count(mesh);
    std::printf("%s, %s: %zu of %zu\n", part.name.c_str(), name.c_str(), found, expected);
    const double allowed = 0.03 * static_cast<double>(expected);
    const bool other_triangles = name == "divided" || name == "meshed anew";
    EXPECT_NEAR(static_cast<double>(found), static_cast<double>(expected),
                other_triangles ? std::max(1.0, allowed) : allowed)
        << name;
  }
}
std::string name_of(const testing::TestParamInfo<std::pair<test::CoverName, int>>& p) {
  return test::case_name(p.param.first.name);
}

INSTANTIATE_TEST_SUITE_P(Generated, Copies,
                         testing::Values(std::pair{test::CoverName{"hip", {.size_mm = 130.0, .faces = 400}}, 600}),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Covers, Copies,
                         testing::Values(std::pair{test::CoverName{"LH_hipwing_v1"}, 800},
                                         std::pair{test::CoverName{"LUA_upperarm_half_v1"}, 1500},
                                         std::pair{test::CoverName{"RUF_forearm_v2"}, 1500},
                                         std::pair{test::CoverName{"HIP_v1"}, 2000},
                                         std::pair{test::CoverName{"UT_torso_v1"}, 800},
                                         std::pair{test::CoverName{"LT_root_v2"}, 1500}),
                         name_of);

}  // namespace
}  // namespace triskin::lattice
