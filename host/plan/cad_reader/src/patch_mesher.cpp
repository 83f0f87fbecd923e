// SPDX-License-Identifier: GPL-3.0-or-later
#include "patch_mesher.hpp"

#include <BRepTools_WireExplorer.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_Curve.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Wire.hxx>
#include <algorithm>
#include <cmath>

#include "ring_triangulation.hpp"

namespace triskin::cad_reader {
namespace {

struct RingNode {
  Vec2 uv;
  int node;
};
using Ring = std::vector<RingNode>;

// A wire in the parameters of the face, in its direction around the face.
class RingBuilder {
 public:
  RingBuilder(const BodyMesh& mesh, int face, EdgeNodes& nodes, double deflection_mm)
      : face_(mesh.faces[static_cast<std::size_t>(face)]), nodes_(nodes), deflection_mm_(deflection_mm) {}

  Ring build(const TopoDS_Wire& wire) {
    Ring ring;
    const TopoDS_Face face = TopoDS::Face(face_.face.Oriented(TopAbs_FORWARD));
    for (BRepTools_WireExplorer it(wire, face); it.More(); it.Next()) append(it.Current(), face, ring);
    if (ring.size() > 1 && is_same(ring.front(), ring.back())) ring.pop_back();
    return ring;
  }

 private:
  void append(const TopoDS_Edge& edge, const TopoDS_Face& face, Ring& ring) {
    double first = 0.0, last = 0.0;
    const Handle(Geom2d_Curve) curve = BRep_Tool::CurveOnSurface(edge, face, first, last);
    if (curve.IsNull()) return;
    const std::vector<double> parameters = nodes_.parameters(edge, deflection_mm_);
    const std::vector<int> along = nodes_.along(edge, EdgeNodes::places(edge, parameters));
    Ring part;
    for (std::size_t k = 0; k < along.size(); ++k) {
      const gp_Pnt2d p = curve->Value(parameters[std::min(k, parameters.size() - 1)]);
      part.push_back({{p.X(), p.Y()}, along[k]});
    }
    if (edge.Orientation() == TopAbs_REVERSED) std::reverse(part.begin(), part.end());
    if (!ring.empty()) bring_near(ring.back().uv, part);
    for (const RingNode& node : part) {
      if (ring.empty() || !is_same(ring.back(), node)) ring.push_back(node);
    }
  }
  // Curves of neighbouring edges may be whole periods apart.
  void bring_near(const Vec2& end, Ring& part) const {
    const auto shift = [&](bool is_periodic, double period, Eigen::Index axis) {
      if (!is_periodic) return;
      const double turns = std::round((end[axis] - part.front().uv[axis]) / period);
      for (RingNode& node : part) node.uv[axis] += turns * period;
    };
    const BRepAdaptor_Surface& s = face_.surface;
    shift(s.IsUPeriodic(), s.IsUPeriodic() ? s.UPeriod() : 1.0, 0);
    shift(s.IsVPeriodic(), s.IsVPeriodic() ? s.VPeriod() : 1.0, 1);
  }
  static bool is_same(const RingNode& a, const RingNode& b) {
    return a.node == b.node && (a.uv - b.uv).norm() <= 1e-9 * (1.0 + a.uv.norm());
  }

  const ExactFace& face_;
  EdgeNodes& nodes_;
  double deflection_mm_;
};

// Lengths in u and v differ, but Delaunay triangles need a common measure.
Vec2 scale_of(const ExactFace& face, const std::vector<Ring>& rings) {
  Vec2 sum = Vec2::Zero();
  for (const Ring& ring : rings) {
    for (const RingNode& node : ring) {
      gp_Pnt p;
      gp_Vec du, dv;
      face.surface.D1(node.uv.x(), node.uv.y(), p, du, dv);
      sum += Vec2(du.Magnitude(), dv.Magnitude());
    }
  }
  const double least = 1e-9 * (1.0 + sum.sum());
  return {std::max(sum.x(), least), std::max(sum.y(), least)};
}

std::vector<Ring> rings_of(const BodyMesh& mesh, int face, EdgeNodes& nodes, double deflection_mm) {
  std::vector<Ring> rings;
  RingBuilder builder(mesh, face, nodes, deflection_mm);
  const TopoDS_Face& exact = mesh.faces[static_cast<std::size_t>(face)].face;
  for (TopExp_Explorer it(exact.Oriented(TopAbs_FORWARD), TopAbs_WIRE); it.More(); it.Next()) {
    rings.push_back(builder.build(TopoDS::Wire(it.Current())));
    if (rings.back().size() < 3) rings.pop_back();
  }
  return rings;
}

}  // namespace

bool mesh_patch(BodyMesh& mesh, int face, EdgeNodes& nodes, double deflection_mm) {
  const std::vector<Ring> rings = rings_of(mesh, face, nodes, deflection_mm);
  if (rings.empty()) return false;
  const ExactFace& exact = mesh.faces[static_cast<std::size_t>(face)];
  const Vec2 scale = scale_of(exact, rings);
  std::vector<RingNode> all;
  std::vector<std::vector<Vec2>> flat;
  for (const Ring& ring : rings) {
    flat.emplace_back();
    for (const RingNode& node : ring) {
      flat.back().push_back(node.uv.cwiseProduct(scale));
      all.push_back(node);
    }
  }
  const auto triangles = triangulate_rings(flat);
  if (!triangles || triangles->empty()) return false;
  const bool is_reversed = exact.face.Orientation() == TopAbs_REVERSED;
  for (const auto& corners : *triangles) {
    Triangle t;
    t.face = face;
    for (std::size_t k = 0; k < 3; ++k) {
      const RingNode& node = all[static_cast<std::size_t>(corners[is_reversed ? 2 - k : k])];
      t.corners[k] = node.node;
      t.uv[k] = node.uv;
    }
    mesh.triangles.push_back(t);
  }
  return true;
}

}  // namespace triskin::cad_reader
