// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <BRepAdaptor_Surface.hxx>
#include <Eigen/Core>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <array>
#include <set>
#include <string>
#include <vector>

namespace triskin::cad_reader {

using Vec2 = Eigen::Vector2d;  ///< They are the parameters u and v of a surface.
using Vec3 = Eigen::Vector3d;  ///< They are in mm.

/// Largest turn of the surface over one step of the kernel's mesher.
inline constexpr double kStepAngle_rad = 0.2;

/// A triangle of one face, counter-clockwise seen from outside.
struct Triangle {
  std::array<int, 3> corners{};  ///< They index BodyMesh::points.
  std::array<Vec2, 3> uv;        ///< They are the positions of the corners on the surface of the face.
  int face = 0;                  ///< It indexes BodyMesh::faces.
};

/// An exact face and what was measured of its triangles.
struct ExactFace {
  TopoDS_Face face;
  BRepAdaptor_Surface surface;
  std::vector<double>
      singular_v;  ///< These sides of the parameters are one point (a pole, a tip), where u means nothing.
  std::vector<double> singular_u;
  double area_mm2 = 0.0;  ///< It is that of the exact face.
  double perimeter_mm = 0.0;
  double deviation_mm = 0.0;  ///< It is the largest distance found between triangles and surface.
  double mesh_area_mm2 = 0.0;
  Vec3 worst_mm = Vec3::Zero();  ///< The deviation was found here.
  std::string fault;             ///< It is empty for a sound face.
  bool is_badly_meshed = false;  ///< The fault is one of its triangles, not of the file's edges.
};

/// Triangles of a body. Faces share the corners on their common edges.
struct BodyMesh {
  std::vector<Vec3> points;
  std::vector<Triangle> triangles;
  std::vector<ExactFace> faces;
  /// They are sides of triangles on edges of one face, lesser corner first.
  std::set<std::pair<int, int>> free_sides;
  int free_edges = 0;
  int open_edges = 0;
};

/// Faces of a body with their exact areas, without triangles. Cost: linear.
[[nodiscard]] std::vector<ExactFace> exact_faces(const TopoDS_Shape& body);

/// Meshes a body so that no triangle is farther than `max_deviation_mm` from the surface of its face, as far as that
/// can be had: other step widths, then triangles of our own in the parameters of a face, where the kernel gives none or
/// wrong ones. What is not right in the end has ExactFace::fault.
[[nodiscard]] BodyMesh mesh_body(const TopoDS_Shape& body, double max_deviation_mm);

/// Sum of the areas of the triangles, by face, and the sides without a neighbour. Called by mesh_body().
void measure(BodyMesh& mesh, double max_deviation_mm);

}  // namespace triskin::cad_reader
