// SPDX-License-Identifier: GPL-3.0-or-later
#include "edge_nodes.hpp"

#include <BRepAdaptor_Curve.hxx>
#include <BRep_Tool.hxx>
#include <GCPnts_TangentialDeflection.hxx>
#include <TopExp.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Vertex.hxx>
#include <limits>

namespace triskin::cad_reader {

EdgeNodes::EdgeNodes(const TopoDS_Shape& body, std::vector<Vec3>& points) : points_(points) {
  TopExp::MapShapes(body, TopAbs_EDGE, edges_);
  TopExp::MapShapes(body, TopAbs_VERTEX, vertices_);
  nodes_.resize(static_cast<std::size_t>(edges_.Extent()) + 1);
  parameters_.resize(nodes_.size());
  vertex_nodes_.assign(static_cast<std::size_t>(vertices_.Extent()) + 1, -1);
}

int EdgeNodes::new_node(const Vec3& place) {
  points_.push_back(place);
  return static_cast<int>(points_.size()) - 1;
}

int EdgeNodes::vertex_node(const TopoDS_Shape& vertex, const Vec3& place) {
  if (vertex.IsNull()) return new_node(place);
  int& node = vertex_nodes_[static_cast<std::size_t>(vertices_.FindIndex(vertex))];
  if (node < 0) node = new_node(place);
  return node;
}

std::vector<int> EdgeNodes::along(const TopoDS_Edge& edge, const std::vector<Vec3>& places) {
  const TopoDS_Edge forward = TopoDS::Edge(edge.Oriented(TopAbs_FORWARD));
  std::vector<int>& known = nodes_[static_cast<std::size_t>(edges_.FindIndex(edge))];
  if (known.empty()) {
    const int first = vertex_node(TopExp::FirstVertex(forward), places.front());
    const int last = vertex_node(TopExp::LastVertex(forward), places.back());
    const bool is_point = BRep_Tool::Degenerated(edge);
    for (std::size_t k = 0; k < places.size(); ++k) {
      const bool is_end = k + 1 == places.size();
      known.push_back(k == 0 || is_point ? first : is_end ? last : new_node(places[k]));
    }
  }
  if (known.size() == places.size()) return known;
  std::vector<int> nearest;
  for (const Vec3& place : places) {
    nearest.push_back(*std::min_element(known.begin(), known.end(), [&](int a, int b) {
      return (points_[static_cast<std::size_t>(a)] - place).squaredNorm() <
             (points_[static_cast<std::size_t>(b)] - place).squaredNorm();
    }));
  }
  return nearest;
}

void EdgeNodes::note_parameters(const TopoDS_Edge& edge, std::vector<double> parameters) {
  std::vector<double>& known = parameters_[static_cast<std::size_t>(edges_.FindIndex(edge))];
  if (known.empty()) known = std::move(parameters);
}

std::vector<double> EdgeNodes::parameters(const TopoDS_Edge& edge, double deflection_mm) {
  std::vector<double>& known = parameters_[static_cast<std::size_t>(edges_.FindIndex(edge))];
  if (!known.empty()) return known;
  double first = 0.0, last = 0.0;
  BRep_Tool::Range(edge, first, last);
  if (BRep_Tool::Degenerated(edge)) {
    known = {first, last};
    return known;
  }
  const BRepAdaptor_Curve curve(edge);
  const GCPnts_TangentialDeflection steps(curve, first, last, kStepAngle_rad, deflection_mm, 3);
  for (int k = 1; k <= steps.NbPoints(); ++k) known.push_back(steps.Parameter(k));
  return known;
}

std::vector<Vec3> EdgeNodes::places(const TopoDS_Edge& edge, const std::vector<double>& parameters) {
  std::vector<Vec3> out;
  if (BRep_Tool::Degenerated(edge)) {
    const TopoDS_Vertex vertex = TopExp::FirstVertex(edge);
    const gp_Pnt p = BRep_Tool::Pnt(vertex);
    out.assign(parameters.size(), Vec3(p.X(), p.Y(), p.Z()));
    return out;
  }
  const BRepAdaptor_Curve curve(edge);
  for (const double t : parameters) {
    const gp_Pnt p = curve.Value(t);
    out.emplace_back(p.X(), p.Y(), p.Z());
  }
  return out;
}

}  // namespace triskin::cad_reader
