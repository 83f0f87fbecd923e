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

using Vec2 = Eigen::Vector2d;  ///< The components are the parameters u and v of a surface.
using Vec3 = Eigen::Vector3d;

/// The surface may turn by at most this over one step of the kernel's mesher.
inline constexpr double kStepAngle_rad = 0.2;

/// A triangle belongs to one face and is counter-clockwise seen from outside.
struct Triangle {
  std::array<int, 3> corners{};  ///< The indices refer to BodyMesh::points.
  std::array<Vec2, 3> uv;        ///< The corners have these parameters on the surface of the face.
  int face = 0;                  ///< The index refers to BodyMesh::faces.
};

/// Holds an exact face and the measurements of its triangles.
struct ExactFace {
  TopoDS_Face face;
  BRepAdaptor_Surface surface;
  std::vector<double>
      singular_v;  ///< A true side of the parameters is a single point (a pole, a tip), where u has no meaning.
  std::vector<double> singular_u;
  double area_mm2 = 0.0;  ///< The area is that of the exact face.
  double perimeter_mm = 0.0;
  double deviation_mm = 0.0;  ///< This is the largest distance found between triangles and surface.
  double mesh_area_mm2 = 0.0;
  Vec3 worst_mm = Vec3::Zero();  ///< The deviation was found here.
  std::string fault;             ///< A sound face leaves this empty.
  bool is_badly_meshed = false;  ///< True means that the triangles cause the fault, not the file's edges.
};

/// Faces of the body share the corners on their common edges.
struct BodyMesh {
  std::vector<Vec3> points;
  std::vector<Triangle> triangles;
  std::vector<ExactFace> faces;
  /// These sides of triangles lie on edges of a single face; the lower corner comes first.
  std::set<std::pair<int, int>> free_sides;
  int free_edges = 0;
  int open_edges = 0;
};

/// Returns the faces of a body with their exact areas, without triangles. Cost: linear.
[[nodiscard]] std::vector<ExactFace> exact_faces(const TopoDS_Shape& body);

/// Meshes a body so that no triangle is farther than `max_deviation_mm` from the surface of its face, as far as
/// possible: tries other step widths, then triangles of our own in the parameters of a face, if the kernel gives none
/// or wrong ones. Remaining defects are in ExactFace::fault.
[[nodiscard]] BodyMesh mesh_body(const TopoDS_Shape& body, double max_deviation_mm);

/// Sums the areas of the triangles by face, and finds the sides without a neighbour. mesh_body() calls it.
void measure(BodyMesh& mesh, double max_deviation_mm);

}  // namespace triskin::cad_reader
