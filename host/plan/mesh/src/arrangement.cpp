// SPDX-License-Identifier: GPL-3.0-or-later
// Divides faces that cross along their common lines, with exact constructions; the others stay unchanged.
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>

#include <Eigen/Geometry>
#include <map>
#include <vector>

#include "triskin/base/index.hpp"
#include "triskin/mesh/extract_steps.hpp"

namespace triskin::mesh {
namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using Point3 = Kernel::Point_3;
using Point2 = Kernel::Point_2;
using Triangulation = CGAL::Constrained_Delaunay_triangulation_2<Kernel, CGAL::Default, CGAL::Exact_intersections_tag>;

class Arrangement {
 public:
  explicit Arrangement(const Mesh& mesh) : mesh_(mesh) { result_.vertices = mesh.vertices; }

  Mesh run(const std::vector<FacePair>& crossings) {
    for (const auto& [a, b] : crossings) {
      lines_[a];
      lines_[b];
    }
    for (const auto& [face, lines] : lines_) {
      for (const int v : mesh_.faces[at(face)]) vertex_.try_emplace(exact(mesh_.vertices[at(v)]), v);
    }
    for (const auto& [a, b] : crossings) intersect(a, b);
    for (FaceIndex f{0}; f < static_cast<int>(mesh_.faces.size()); ++f) {
      const auto lines = lines_.find(f);
      if (lines == lines_.end())
        result_.faces.push_back(mesh_.faces[at(f)]);
      else
        divide(f, lines->second);
    }
    return std::move(result_);
  }

 private:
  using Line = std::pair<Point3, Point3>;  // A point is stored as a line with two equal ends.

  static Point3 exact(const Vec3& p) { return {p.x(), p.y(), p.z()}; }
  [[nodiscard]] Kernel::Triangle_3 triangle(FaceIndex face) const {
    const auto& f = mesh_.faces[at(face)];
    return {exact(mesh_.vertices[at(f[0])]), exact(mesh_.vertices[at(f[1])]), exact(mesh_.vertices[at(f[2])])};
  }

  void intersect(FaceIndex a, FaceIndex b) {
    const auto common = CGAL::intersection(triangle(a), triangle(b));
    if (!common) return;
    std::vector<Point3> points;
    if (const auto* p = boost::get<Point3>(&*common)) points = {*p};
    if (const auto* s = boost::get<Kernel::Segment_3>(&*common)) points = {s->source(), s->target()};
    if (const auto* t = boost::get<Kernel::Triangle_3>(&*common)) points = {t->vertex(0), t->vertex(1), t->vertex(2)};
    if (const auto* many = boost::get<std::vector<Point3>>(&*common)) points = *many;
    const std::size_t n = points.size();
    for (std::size_t k = 0; k < (n > 2 ? n : 1); ++k) {
      const Line line{points[k], points[(k + 1) % n]};
      lines_[a].push_back(line);
      lines_[b].push_back(line);
    }
  }

  // The triangle is drawn on the plane of two axes on which it is largest; its own plane gives the third coordinate.
  void divide(FaceIndex face, const std::vector<Line>& lines) {
    const auto& f = mesh_.faces[at(face)];
    const Vec3 normal = (mesh_.vertices[at(f[1])] - mesh_.vertices[at(f[0])])
                            .cross(mesh_.vertices[at(f[2])] - mesh_.vertices[at(f[0])]);
    Eigen::Index axis = 0;
    normal.cwiseAbs().maxCoeff(&axis);
    const int up = static_cast<int>(axis), i = (up + 1) % 3, j = (up + 2) % 3;
    const auto flat = [&](const Point3& p) { return Point2(p[i], p[j]); };
    const Kernel::Triangle_3 t = triangle(face);
    const Kernel::Plane_3 plane = t.supporting_plane();
    const std::array<Kernel::FT, 3> slope{plane.a(), plane.b(), plane.c()};
    const auto raised = [&](const Point2& p) {
      const Kernel::FT h = -(slope[at(i)] * p.x() + slope[at(j)] * p.y() + plane.d()) / slope[at(up)];
      std::array<Kernel::FT, 3> c;
      c[at(up)] = h;
      c[at(i)] = p.x();
      c[at(j)] = p.y();
      return Point3(c[0], c[1], c[2]);
    };
    Triangulation cdt;
    for (int k = 0; k < 3; ++k) cdt.insert_constraint(flat(t.vertex(k)), flat(t.vertex(k + 1)));
    for (const auto& [from, to] : lines) {
      if (from == to)
        cdt.insert(flat(from));
      else
        cdt.insert_constraint(flat(from), flat(to));
    }
    const bool turned = normal[axis] < 0.0;
    for (const auto& part : cdt.finite_face_handles()) {
      std::array<int, 3> corners{};
      for (int k = 0; k < 3; ++k) corners[at(k)] = vertex_at(raised(part->vertex(k)->point()));
      if (turned) std::swap(corners[1], corners[2]);
      result_.faces.push_back(corners);
    }
  }

  int vertex_at(const Point3& p) {
    const auto [entry, is_new] = vertex_.try_emplace(p, static_cast<int>(result_.vertices.size()));
    if (is_new) result_.vertices.emplace_back(CGAL::to_double(p.x()), CGAL::to_double(p.y()), CGAL::to_double(p.z()));
    return entry->second;
  }

  const Mesh& mesh_;
  std::map<FaceIndex, std::vector<Line>> lines_;  // The key is a face, the value the lines that others draw on it.
  std::map<Point3, int> vertex_;
  Mesh result_;
};

}  // namespace

Mesh arranged(const Mesh& mesh, const std::vector<FacePair>& crossings) {
  return Arrangement(mesh).run(crossings);
}

}  // namespace triskin::mesh
