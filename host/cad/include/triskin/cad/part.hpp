// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "triskin/base/names.hpp"
#include "triskin/design/mesh.hpp"

/// Parts as mechanical designers hand them over: bodies of exact faces in STEP or IGES files (docs/cad.md).
namespace triskin::cad {

/// Kind of the exact surface under a face.
enum class SurfaceKind : std::uint8_t {
  kPlane,
  kCylinder,
  kCone,
  kSphere,
  kTorus,
  kBSpline,
  kExtrusion,
  kRevolution,
  kOffset,
  kOther,
};
/// Names in output and options.
inline constexpr NameTable kSurfaceKindNames{
    std::array<std::pair<SurfaceKind, std::string_view>, 10>{{{SurfaceKind::kPlane, "plane"},
                                                              {SurfaceKind::kCylinder, "cylinder"},
                                                              {SurfaceKind::kCone, "cone"},
                                                              {SurfaceKind::kSphere, "sphere"},
                                                              {SurfaceKind::kTorus, "torus"},
                                                              {SurfaceKind::kBSpline, "bspline"},
                                                              {SurfaceKind::kExtrusion, "extrusion"},
                                                              {SurfaceKind::kRevolution, "revolution"},
                                                              {SurfaceKind::kOffset, "offset"},
                                                              {SurfaceKind::kOther, "other"}}}};

/// Side of the wall on which a face lies.
enum class FaceSide : std::uint8_t {
  kOutward,    ///< Most of what is in front of it is free, or it is the outer sheet of a thin wall.
  kInward,     ///< It looks at the part itself, or is the inner sheet of a thin wall.
  kUndecided,  ///< Both sheets of its wall look alike.
};
/// Names in output.
inline constexpr NameTable kFaceSideNames{std::array<std::pair<FaceSide, std::string_view>, 3>{
    {{FaceSide::kOutward, "outward"}, {FaceSide::kInward, "inward"}, {FaceSide::kUndecided, "undecided"}}}};

/// One face of a body. Its index is its place in Part::faces.
struct Face {
  std::string name;    ///< It is UTF-8 as the file has it, may hold any character and is often empty.
  std::string colour;  ///< It is the "#rrggbb" of the face, else of its body, and empty without a colour.
  std::string entity;  ///< It is "#17" of a STEP file or "D17" of an IGES file, and empty when unknown.
  SurfaceKind kind = SurfaceKind::kOther;
  FaceSide side = FaceSide::kUndecided;
  int body = 0;            ///< It indexes Part::bodies.
  double area_mm2 = 0.0;   ///< It is the area of the exact face.
  double radius_mm = 0.0;  ///< It belongs to a cylinder, a sphere or the tube of a torus, and is 0 for other kinds.
  /// Diameter of the round hole that this face bounds (cylinder or cone all round, seen from its hollow side); 0: none.
  double hole_diameter_mm = 0.0;
  design::Vec3 place_mm{0, 0, 0};  ///< It is a point of the face's mesh near its middle.
  design::Vec3 normal{0, 0, 0};    ///< It is the mean outward normal of unit length, and zero for a closed face.
  double deviation_mm = 0.0;       ///< It is the largest distance found between its triangles and the exact surface.
  std::string fault;               ///< It says why the face's mesh is not to be trusted and is empty if it is sound.
};

/// A solid, or faces that hang together without closing. Its faces follow each other in Part::faces.
struct Body {
  std::string name{};  ///< It is the name of the product in the file.
  std::string path{};  ///< The names of the assemblies that hold it and its own name are joined by '/'.
  std::string colour{};
  bool is_solid = false;
  int first_face = 0, face_count = 0;
  int free_edges = 0;  ///< They are edges of one face in the file, the border of an open surface.
  /// They are sides of triangles without a neighbour that lie on no free edge: leaks of the mesh.
  int open_edges = 0;
  double area_mm2 = 0.0;
};

/// What a CAD file holds, and its mesh.
struct Part {
  std::string format;        ///< It is "STEP AP214" and the like, or "IGES".
  std::string unit;          ///< It is the name in the file ("millimetre"), and empty if the file has none.
  double unit_mm = 1.0;      ///< One unit of the file's numbers was taken as this length.
  bool unit_given = false;   ///< The caller gave the unit.
  std::vector<Body> bodies;  ///< They stand in the order of the file.
  std::vector<Face> faces;
  design::Mesh mesh;  ///< It is in mm; corners are shared along the edges of one body, never between bodies.
  std::vector<int> face_of_triangle;  ///< Each face of `mesh` has its index in `faces`.
  double deviation_mm = 0.0;          ///< It is the largest of the faces.
  std::vector<std::string> warnings;  ///< Each is one sentence, and nothing is missing because of it.
  /// Each is one sentence about something of the file that is missing in `mesh` or wrong.
  std::vector<std::string> faults;
};

/// Extent of the mesh along the axes, mm; zero without triangles. Cost: linear.
[[nodiscard]] design::Vec3 size_of(const Part& part);

}  // namespace triskin::cad
