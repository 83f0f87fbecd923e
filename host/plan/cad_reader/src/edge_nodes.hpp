// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <map>
#include <vector>

#include "body_mesh.hpp"

namespace triskin::cad_reader {

/// Keeps the corners along the edges and at the vertices of a body, so that the faces at an edge find the same ones.
class EdgeNodes {
 public:
  /// `points` are those of the mesh, to which nodes are added.
  EdgeNodes(const TopoDS_Shape& body, std::vector<Vec3>& points);

  /// Returns nodes along an edge by the parameters of its curve, first to last. The first caller decides the
  /// parameters; a later one whose number differs gets the nearest node for each of its places.
  [[nodiscard]] std::vector<int> along(const TopoDS_Edge& edge, const std::vector<Vec3>& places);
  /// Returns the parameters of an edge as its first face divided it; without one they are made from its curvature.
  [[nodiscard]] std::vector<double> parameters(const TopoDS_Edge& edge, double deflection_mm);
  /// Notes the parameters that a face used.
  void note_parameters(const TopoDS_Edge& edge, std::vector<double> parameters);
  /// Returns the places of an edge at these parameters.
  [[nodiscard]] static std::vector<Vec3> places(const TopoDS_Edge& edge, const std::vector<double>& parameters);

 private:
  [[nodiscard]] int vertex_node(const TopoDS_Shape& vertex, const Vec3& place);
  [[nodiscard]] int new_node(const Vec3& place);

  std::vector<Vec3>& points_;
  TopTools_IndexedMapOfShape edges_, vertices_;
  std::vector<std::vector<int>> nodes_;
  std::vector<std::vector<double>> parameters_;
  std::vector<int> vertex_nodes_;
};

}  // namespace triskin::cad_reader
