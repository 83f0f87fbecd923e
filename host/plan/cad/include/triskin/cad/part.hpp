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

/// Reads parts as mechanical designers deliver them: bodies of exact faces in STEP or IGES files (docs/cad.md).
namespace triskin::cad {

/// Tells which kind of exact surface lies under a face.
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
/// Output and options use these names.
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

/// Tells on which side of the wall a face lies.
enum class FaceSide : std::uint8_t {
  kOutward,    ///< Most of the space in front of it is free, or it is the outer sheet of a thin wall.
  kInward,     ///< It faces the part itself, or is the inner sheet of a thin wall.
  kUndecided,  ///< Both sheets of its wall look alike.
};
/// Output uses these names.
inline constexpr NameTable kFaceSideNames{std::array<std::pair<FaceSide, std::string_view>, 3>{
    {{FaceSide::kOutward, "outward"}, {FaceSide::kInward, "inward"}, {FaceSide::kUndecided, "undecided"}}}};

/// One face of the boundary representation. Its BrepFaceIndex is its place in Part::faces.
struct Face {
  std::string name;    ///< The UTF-8 name from the file may contain any character and is often empty.
  std::string colour;  ///< The colour "#rrggbb" of the face, or else of its body; empty without a colour.
  std::string entity;  ///< The entity is "#17" of a STEP file or "D17" of an IGES file; empty when unknown.
  SurfaceKind kind = SurfaceKind::kOther;
  FaceSide side = FaceSide::kUndecided;
  int body = 0;            ///< The index refers to Part::bodies.
  double area_mm2 = 0.0;   ///< The area is that of the exact face, not of its triangles.
  double radius_mm = 0.0;  ///< Cylinders, spheres and the tubes of tori have a radius; other kinds have 0.
  /// Diameter of the round hole that this face bounds (cylinder or cone all round, seen from its hollow side); 0 if it
  /// bounds none.
  double hole_diameter_mm = 0.0;
  design::Vec3 place_mm{0, 0, 0};  ///< This point of the face's mesh lies near its middle.
  design::Vec3 normal{0, 0, 0};    ///< The mean outward normal has unit length, and is zero for a closed face.
  double deviation_mm = 0.0;       ///< The largest distance found between its triangles and the exact surface.
  bool is_hidden = false;          ///< Its author switched it off (alone, or its body, layer or component).
  std::string fault;               ///< The reason why the mesh of the face cannot be trusted; empty if it is sound.
};

/// A solid, or connected faces that do not close. Its faces are consecutive in Part::faces.
struct Body {
  std::string name{};  ///< The file calls the product by this name.
  std::string path{};  ///< The path joins the names of the assemblies that contain the body and its own name by '/'.
  std::string colour{};
  bool is_solid = false;
  design::BrepFaceIndex first_face{0};
  int face_count = 0;
  int free_edges = 0;  ///< In the file these edges have a single face: they are the border of an open surface.
  /// These sides of triangles have no neighbour but lie on no free edge: they are leaks of the mesh.
  int open_edges = 0;
  double area_mm2 = 0.0;
};

/// The content of a CAD file, and its mesh.
struct Part {
  std::string format;        ///< Examples are "STEP AP214" and "IGES".
  std::string unit;          ///< The file calls its unit so ("millimetre"); empty if it has none.
  double unit_mm = 1.0;      ///< One unit of the file's numbers was read as this length.
  bool unit_given = false;   ///< True means that the caller gave the unit.
  std::vector<Body> bodies;  ///< Bodies keep the order of the file.
  std::vector<Face> faces;
  design::Mesh mesh;  ///< Lengths are in mm; corners are shared along the edges of one body, never between bodies.
  std::vector<design::BrepFaceIndex> face_of_triangle;  ///< Each face of `mesh` has its face of the part.
  double deviation_mm = 0.0;          ///< No face of the mesh deviates more than this from its exact surface.
  std::vector<std::string> warnings;  ///< Each warning is one sentence; nothing is missing because of it.
  /// Each fault is one sentence about something of the file that is missing in `mesh` or wrong.
  std::vector<std::string> faults;
};

/// Returns the extent of the mesh along the axes in mm; zero without triangles. Cost: linear.
[[nodiscard]] design::Vec3 size_of(const Part& part);

}  // namespace triskin::cad
