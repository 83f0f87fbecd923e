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
  kOutward,    ///< most of what is in front of it is free, or it is the outer sheet of a thin wall
  kInward,     ///< it looks at the part itself, or is the inner sheet of a thin wall
  kUndecided,  ///< both sheets of its wall look alike
};
/// Names in output.
inline constexpr NameTable kFaceSideNames{std::array<std::pair<FaceSide, std::string_view>, 3>{
    {{FaceSide::kOutward, "outward"}, {FaceSide::kInward, "inward"}, {FaceSide::kUndecided, "undecided"}}}};

/// One face of a body. Its index is its place in Part::faces.
struct Face {
  std::string name;    ///< UTF-8 as the file has it, may hold any character; often empty
  std::string colour;  ///< "#rrggbb" of the face, else of its body; empty: none
  std::string entity;  ///< "#17" of a STEP file, "D17" of an IGES file; empty: unknown
  SurfaceKind kind = SurfaceKind::kOther;
  FaceSide side = FaceSide::kUndecided;
  int body = 0;            ///< index in Part::bodies
  double area_mm2 = 0.0;   ///< area of the exact face
  double radius_mm = 0.0;  ///< cylinder, sphere, torus (of its tube); 0 for other kinds
  /// Diameter of the round hole that this face bounds (cylinder or cone all round, seen from its hollow side); 0: none.
  double hole_diameter_mm = 0.0;
  design::Vec3 place_mm{0, 0, 0};  ///< a point of the mesh of the face, near its middle
  design::Vec3 normal{0, 0, 0};    ///< mean outward normal, of unit length; zero for a closed face
  double deviation_mm = 0.0;       ///< largest distance found between its triangles and the exact surface
  std::string fault;               ///< why its mesh is not to be trusted; empty: it is sound
};

/// A solid, or faces that hang together without closing. Its faces follow each other in Part::faces.
struct Body {
  std::string name{};  ///< name of the product in the file
  std::string path{};  ///< names of the assemblies that hold it and its own name, joined by '/'
  std::string colour{};
  bool is_solid = false;
  int first_face = 0, face_count = 0;
  int free_edges = 0;  ///< edges of one face in the file: the border of an open surface
  int open_edges = 0;  ///< sides of triangles without a neighbour that are not on a free edge: leaks of the mesh
  double area_mm2 = 0.0;
};

/// What a CAD file holds, and its mesh.
struct Part {
  std::string format;        ///< "STEP AP214" and the like, or "IGES"
  std::string unit;          ///< name in the file ("millimetre"); empty: the file has none
  double unit_mm = 1.0;      ///< length of one unit of the file's numbers that was applied
  bool unit_given = false;   ///< the caller gave the unit
  std::vector<Body> bodies;  ///< same order as in the file
  std::vector<Face> faces;
  design::Mesh mesh;                  ///< mm; corners shared along edges of one body, never between bodies
  std::vector<int> face_of_triangle;  ///< index in `faces` for each face of `mesh`
  double deviation_mm = 0.0;          ///< largest of the faces
  std::vector<std::string> warnings;  ///< one sentence each: nothing is missing
  std::vector<std::string> faults;    ///< one sentence each: something of the file is missing in `mesh` or not right
};

/// Extent of the mesh along the axes, mm; zero without triangles. Cost: linear.
[[nodiscard]] design::Vec3 size_of(const Part& part);

}  // namespace triskin::cad
