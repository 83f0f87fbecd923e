// SPDX-License-Identifier: GPL-3.0-or-later
#include "face_facts.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <gp_Cone.hxx>
#include <gp_Cylinder.hxx>
#include <gp_Sphere.hxx>
#include <gp_Torus.hxx>
#include <numbers>

namespace triskin::cad_reader {
namespace {

// Two halves of a hole state the same axis to the precision of the file's numbers.
constexpr double kSameAxis_mm = 0.01, kSameDirection = 1e-6, kSameRadius_mm = 0.01;
// Slots and keyways take a little of a hole's wall.
constexpr double kWholeTurn_rad = 0.9 * 2.0 * std::numbers::pi;

struct HollowWall {
  std::size_t face = 0;
  Vec3 origin, axis;
  double radius_mm = 0.0;  // The radius is that at the reference plane.
  double widest_mm = 0.0;
  double turn_rad = 0.0;
};

Vec3 vector_of(const gp_XYZ& v) {
  return {v.X(), v.Y(), v.Z()};
}

double radius_at(const ExactFace& face, double v) {
  if (face.surface.GetType() == GeomAbs_Cylinder) return face.surface.Cylinder().Radius();
  const gp_Cone cone = face.surface.Cone();
  return std::abs(cone.RefRadius() + v * std::sin(cone.SemiAngle()));
}

bool is_hollow(const ExactFace& face, const HollowWall& wall) {
  const BRepAdaptor_Surface& s = face.surface;
  gp_Pnt p;
  gp_Vec du, dv;
  s.D1(0.5 * (s.FirstUParameter() + s.LastUParameter()), 0.5 * (s.FirstVParameter() + s.LastVParameter()), p, du, dv);
  Vec3 normal = vector_of(du.Crossed(dv).XYZ());
  if (face.face.Orientation() == TopAbs_REVERSED) normal = -normal;
  const Vec3 out = vector_of(p.XYZ()) - wall.origin;
  return normal.dot(out - out.dot(wall.axis) * wall.axis) < 0.0;
}

std::vector<HollowWall> hollow_walls(const std::vector<ExactFace>& faces) {
  std::vector<HollowWall> walls;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const BRepAdaptor_Surface& s = faces[f].surface;
    if (s.GetType() != GeomAbs_Cylinder && s.GetType() != GeomAbs_Cone) continue;
    const gp_Ax3 frame = s.GetType() == GeomAbs_Cylinder ? s.Cylinder().Position() : s.Cone().Position();
    HollowWall wall{f, vector_of(frame.Location().XYZ()), vector_of(frame.Direction().XYZ()), 0.0, 0.0, 0.0};
    wall.radius_mm = radius_at(faces[f], 0.0);
    wall.widest_mm = std::max(radius_at(faces[f], s.FirstVParameter()), radius_at(faces[f], s.LastVParameter()));
    wall.turn_rad = s.LastUParameter() - s.FirstUParameter();
    if (is_hollow(faces[f], wall)) walls.push_back(wall);
  }
  return walls;
}

bool is_same_hole(const HollowWall& a, const HollowWall& b) {
  const Vec3 apart = b.origin - a.origin;
  return a.axis.cross(b.axis).norm() < kSameDirection && std::abs(a.radius_mm - b.radius_mm) < kSameRadius_mm &&
         (apart - apart.dot(a.axis) * a.axis).norm() < kSameAxis_mm;
}

}  // namespace

cad::SurfaceKind kind_of(const ExactFace& face) {
  switch (face.surface.GetType()) {
    case GeomAbs_Plane:
      return cad::SurfaceKind::kPlane;
    case GeomAbs_Cylinder:
      return cad::SurfaceKind::kCylinder;
    case GeomAbs_Cone:
      return cad::SurfaceKind::kCone;
    case GeomAbs_Sphere:
      return cad::SurfaceKind::kSphere;
    case GeomAbs_Torus:
      return cad::SurfaceKind::kTorus;
    case GeomAbs_BezierSurface:
    case GeomAbs_BSplineSurface:
      return cad::SurfaceKind::kBSpline;
    case GeomAbs_SurfaceOfExtrusion:
      return cad::SurfaceKind::kExtrusion;
    case GeomAbs_SurfaceOfRevolution:
      return cad::SurfaceKind::kRevolution;
    case GeomAbs_OffsetSurface:
      return cad::SurfaceKind::kOffset;
    default:
      return cad::SurfaceKind::kOther;
  }
}

double radius_of(const ExactFace& face) {
  switch (face.surface.GetType()) {
    case GeomAbs_Cylinder:
      return face.surface.Cylinder().Radius();
    case GeomAbs_Sphere:
      return face.surface.Sphere().Radius();
    case GeomAbs_Torus:
      return face.surface.Torus().MinorRadius();
    default:
      return 0.0;
  }
}

std::vector<double> hole_diameters(const std::vector<ExactFace>& faces) {
  std::vector<double> diameters(faces.size(), 0.0);
  const std::vector<HollowWall> walls = hollow_walls(faces);
  for (const HollowWall& wall : walls) {
    double turn_rad = 0.0;
    for (const HollowWall& other : walls) {
      if (is_same_hole(wall, other)) turn_rad += other.turn_rad;
    }
    if (turn_rad >= kWholeTurn_rad) diameters[wall.face] = 2.0 * wall.widest_mm;
  }
  return diameters;
}

}  // namespace triskin::cad_reader
