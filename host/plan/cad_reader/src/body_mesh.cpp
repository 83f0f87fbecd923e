// SPDX-License-Identifier: GPL-3.0-or-later
#include "body_mesh.hpp"

#include <BRepBndLib.hxx>
#include <BRepGProp.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <Eigen/Dense>
#include <GProp_GProps.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numeric>

#include "edge_nodes.hpp"
#include "patch_mesher.hpp"
#include "refine.hpp"

namespace triskin::cad_reader {
namespace {

// Triangles within the deviation of a curved face lose at most this fraction of its area, beside a rim as wide as the
// deviation: a chord of 0.2 rad loses 0.17 %.
constexpr double kAreaFraction = 0.005;
// A plane without bounds has 8e98 mm² for the kernel; a part of 5 m has less than this.
constexpr double kUnbounded_mm2 = 1e9;
constexpr int kSideSteps = 4;
constexpr double kStill = 1e-9;
// The mesh follows the edges of the file; edges of public parts lie up to 0.1 mm beside their surfaces.
constexpr double kFaultInDeviations = 3.0;
// The step widths, in units of the deviation, are tried in turn while faces fail: a face may fail at one width at which
// its neighbours do not.
constexpr std::array<double, 5> kSteps{1.0, 0.4, 2.0, 4.0, 0.2};

// A side of the parameters is a single point if the surface does not move along it.
void find_singular_sides(ExactFace& face) {
  const BRepAdaptor_Surface& s = face.surface;
  const double u0 = s.FirstUParameter(), u1 = s.LastUParameter(), v0 = s.FirstVParameter(), v1 = s.LastVParameter();
  const double still_mm = kStill * std::max(1.0, face.perimeter_mm);
  const auto length = [&](double ua, double va, double ub, double vb) {
    double sum = 0.0;
    for (int k = 0; k < kSideSteps; ++k) {
      const double a = k / static_cast<double>(kSideSteps), b = (k + 1) / static_cast<double>(kSideSteps);
      sum += s.Value(ua + a * (ub - ua), va + a * (vb - va)).Distance(s.Value(ua + b * (ub - ua), va + b * (vb - va)));
    }
    return sum;
  };
  for (const double v : {v0, v1}) {
    if (length(u0, v, u1, v) < still_mm) face.singular_v.push_back(v);
  }
  for (const double u : {u0, u1}) {
    if (length(u, v0, u, v1) < still_mm) face.singular_u.push_back(u);
  }
}

double area_of(const BodyMesh& mesh, const Triangle& t) {
  const auto at = [&](std::size_t k) { return mesh.points[static_cast<std::size_t>(t.corners[k])]; };
  return 0.5 * (at(1) - at(0)).cross(at(2) - at(0)).norm();
}

// Copies the kernel's triangles of a body into one mesh.
class Taker {
 public:
  Taker(const TopoDS_Shape& body, BodyMesh& mesh) : mesh_(mesh), nodes_(body, mesh.points) {}

  void take(int face) {
    TopLoc_Location place;
    const TopoDS_Face& exact = mesh_.faces[static_cast<std::size_t>(face)].face;
    const Handle(Poly_Triangulation) triangles = BRep_Tool::Triangulation(exact, place);
    if (triangles.IsNull() || !triangles->HasUVNodes()) return;
    std::vector<int> node_of(static_cast<std::size_t>(triangles->NbNodes()) + 1, -1);
    const std::vector<Vec3> places = places_of(triangles, place);
    for (TopExp_Explorer it(exact, TopAbs_EDGE); it.More(); it.Next())
      take_edge(TopoDS::Edge(it.Current()), triangles, place, places, node_of);
    for (std::size_t n = 1; n < node_of.size(); ++n) {
      if (node_of[n] >= 0) continue;
      node_of[n] = static_cast<int>(mesh_.points.size());
      mesh_.points.push_back(places[n]);
    }
    add_triangles(face, triangles, node_of);
  }
  EdgeNodes& nodes() { return nodes_; }

 private:
  static std::vector<Vec3> places_of(const Handle(Poly_Triangulation) & triangles, const TopLoc_Location& place) {
    std::vector<Vec3> places(static_cast<std::size_t>(triangles->NbNodes()) + 1);
    const gp_Trsf transform = place.Transformation();
    for (int n = 1; n <= triangles->NbNodes(); ++n) {
      const gp_Pnt p = triangles->Node(n).Transformed(transform);
      places[static_cast<std::size_t>(n)] = {p.X(), p.Y(), p.Z()};
    }
    return places;
  }
  void take_edge(const TopoDS_Edge& edge, const Handle(Poly_Triangulation) & triangles, const TopLoc_Location& place,
                 const std::vector<Vec3>& places, std::vector<int>& node_of) {
    const Handle(Poly_PolygonOnTriangulation) polygon = BRep_Tool::PolygonOnTriangulation(edge, triangles, place);
    if (polygon.IsNull()) return;
    std::vector<Vec3> along;
    std::vector<double> parameters;
    for (int k = 1; k <= polygon->NbNodes(); ++k) {
      along.push_back(places[static_cast<std::size_t>(polygon->Node(k))]);
      if (polygon->HasParameters()) parameters.push_back(polygon->Parameter(k));
    }
    if (!parameters.empty()) nodes_.note_parameters(edge, std::move(parameters));
    const std::vector<int> shared = nodes_.along(edge, along);
    for (int k = 1; k <= polygon->NbNodes(); ++k)
      node_of[static_cast<std::size_t>(polygon->Node(k))] = shared[static_cast<std::size_t>(k - 1)];
  }
  void add_triangles(int face, const Handle(Poly_Triangulation) & triangles, const std::vector<int>& node_of) {
    const bool is_reversed = mesh_.faces[static_cast<std::size_t>(face)].face.Orientation() == TopAbs_REVERSED;
    for (int i = 1; i <= triangles->NbTriangles(); ++i) {
      std::array<int, 3> n{};
      triangles->Triangle(i).Get(n[0], n[1], n[2]);
      if (is_reversed) std::swap(n[1], n[2]);
      Triangle t;
      t.face = face;
      for (std::size_t k = 0; k < 3; ++k) {
        const gp_Pnt2d uv = triangles->UVNode(n[k]);
        t.uv[k] = {uv.X(), uv.Y()};
        t.corners[k] = node_of[static_cast<std::size_t>(n[k])];
      }
      mesh_.triangles.push_back(t);
    }
  }

  BodyMesh& mesh_;
  EdgeNodes nodes_;
};

void drop_collapsed(BodyMesh& mesh) {
  std::erase_if(mesh.triangles, [](const Triangle& t) {
    return t.corners[0] == t.corners[1] || t.corners[1] == t.corners[2] || t.corners[2] == t.corners[0];
  });
}

// Edges that one face has once are the border of an open surface; a seam occurs twice in its face.
void note_free_edges(const TopoDS_Shape& body, EdgeNodes& nodes, double deflection_mm, BodyMesh& mesh) {
  TopTools_IndexedDataMapOfShapeListOfShape faces_of;
  TopExp::MapShapesAndAncestors(body, TopAbs_EDGE, TopAbs_FACE, faces_of);
  for (int e = 1; e <= faces_of.Extent(); ++e) {
    const TopoDS_Edge edge = TopoDS::Edge(faces_of.FindKey(e));
    if (faces_of.FindFromIndex(e).Extent() != 1 || BRep_Tool::Degenerated(edge)) continue;
    if (BRep_Tool::IsClosed(edge, TopoDS::Face(faces_of.FindFromIndex(e).First()))) continue;
    ++mesh.free_edges;
    const std::vector<double> parameters = nodes.parameters(edge, deflection_mm);
    const std::vector<int> along = nodes.along(edge, EdgeNodes::places(edge, parameters));
    for (std::size_t k = 1; k < along.size(); ++k) mesh.free_sides.insert(std::minmax(along[k - 1], along[k]));
  }
}

int count_open_edges(const BodyMesh& mesh) {
  std::map<std::pair<int, int>, int> uses;
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) ++uses[std::minmax(t.corners[k], t.corners[(k + 1) % 3])];
  }
  return static_cast<int>(std::ranges::count_if(
      uses, [&](const auto& use) { return use.second == 1 && !mesh.free_sides.contains(use.first); }));
}

void judge(ExactFace& face, double max_deviation_mm) {
  std::array<char, 120> text{};
  const double allowed = kAreaFraction * face.area_mm2 + face.perimeter_mm * max_deviation_mm;
  face.is_badly_meshed = true;
  if (!(face.area_mm2 < kUnbounded_mm2)) {
    face.fault = "has no bounds";
    face.area_mm2 = 0.0;
  } else if (face.mesh_area_mm2 <= 0.0) {
    face.fault = "has no triangles";
  } else if (!(std::abs(face.mesh_area_mm2 - face.area_mm2) <= allowed)) {
    std::snprintf(text.data(), text.size(), "has %.4g mm² of triangles for %.4g mm²", face.mesh_area_mm2,
                  face.area_mm2);
    face.fault = text.data();
  } else {
    face.is_badly_meshed = false;
    face.fault.clear();
    if (face.deviation_mm <= kFaultInDeviations * max_deviation_mm) return;
    std::snprintf(text.data(), text.size(), "deviates by %.3g mm", face.deviation_mm);
    face.fault = text.data();
  }
}

std::vector<int> failed_faces(const BodyMesh& mesh) {
  std::vector<int> failed;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    if (mesh.faces[f].is_badly_meshed) failed.push_back(static_cast<int>(f));
  }
  return failed;
}

// Combines the kernel's triangles with our own for the faces in `patched`.
BodyMesh assemble(const TopoDS_Shape& body, const std::vector<ExactFace>& faces, const std::vector<int>& patched,
                  double deflection_mm, double max_deviation_mm) {
  BodyMesh mesh;
  mesh.faces = faces;
  Taker taker(body, mesh);
  for (int f = 0; f < static_cast<int>(faces.size()); ++f) {
    if (std::ranges::find(patched, f) == patched.end()) taker.take(f);
  }
  for (const int f : patched) {
    if (!mesh_patch(mesh, f, taker.nodes(), deflection_mm)) taker.take(f);
  }
  drop_collapsed(mesh);
  note_free_edges(body, taker.nodes(), deflection_mm, mesh);
  refine(mesh, max_deviation_mm);
  measure(mesh, max_deviation_mm);
  return mesh;
}

bool is_better(const BodyMesh& a, const BodyMesh& b) {
  const auto rank = [](const BodyMesh& m) { return std::pair(failed_faces(m).size(), m.open_edges); };
  return rank(a) < rank(b);
}

bool is_sound(const BodyMesh& mesh) {
  return failed_faces(mesh).empty() && mesh.open_edges == 0;
}

}  // namespace

std::vector<ExactFace> exact_faces(const TopoDS_Shape& body) {
  std::vector<ExactFace> faces;
  for (TopExp_Explorer it(body, TopAbs_FACE); it.More(); it.Next()) {
    ExactFace face;
    face.face = TopoDS::Face(it.Current());
    face.surface = BRepAdaptor_Surface(face.face);
    GProp_GProps area, length;
    BRepGProp::SurfaceProperties(face.face, area);
    BRepGProp::LinearProperties(face.face, length);
    face.area_mm2 = std::abs(area.Mass());
    face.perimeter_mm = length.Mass();
    if (face.surface.GetType() != GeomAbs_Plane) find_singular_sides(face);
    faces.push_back(face);
  }
  return faces;
}

void measure(BodyMesh& mesh, double max_deviation_mm) {
  for (ExactFace& face : mesh.faces) face.mesh_area_mm2 = 0.0;
  for (const Triangle& t : mesh.triangles)
    mesh.faces[static_cast<std::size_t>(t.face)].mesh_area_mm2 += area_of(mesh, t);
  for (ExactFace& face : mesh.faces) judge(face, max_deviation_mm);
  mesh.open_edges = count_open_edges(mesh);
}

BodyMesh mesh_body(const TopoDS_Shape& body, double max_deviation_mm) {
  const std::vector<ExactFace> faces = exact_faces(body);
  BodyMesh best;
  for (const double step : kSteps) {
    const double deflection_mm = step * max_deviation_mm;
    BRepTools::Clean(body);
    const BRepMesh_IncrementalMesh mesher(body, deflection_mm, Standard_False, kStepAngle_rad, Standard_False);
    BodyMesh mesh = assemble(body, faces, {}, deflection_mm, max_deviation_mm);
    if (!is_sound(mesh)) {
      BodyMesh patched = assemble(body, faces, failed_faces(mesh), deflection_mm, max_deviation_mm);
      if (is_better(patched, mesh)) mesh = std::move(patched);
    }
    if (best.faces.empty() || is_better(mesh, best)) best = std::move(mesh);
    if (is_sound(best)) break;
  }
  return best;
}

}  // namespace triskin::cad_reader
