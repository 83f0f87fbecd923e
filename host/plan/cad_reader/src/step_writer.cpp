// SPDX-License-Identifier: GPL-3.0-or-later
#include "step_writer.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <APIHeaderSection_MakeHeader.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepLib.hxx>
#include <BRep_Builder.hxx>
#include <Interface_Static.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <TCollection_ExtendedString.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopLoc_Location.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <algorithm>
#include <array>
#include <fstream>
#include <gp_Pln.hxx>
#include <map>
#include <sstream>
#include <stdexcept>

namespace triskin::cad_reader {
namespace {

// Builds the faces of one body with the edges and corners that they share.
class BodyBuilder {
 public:
  explicit BodyBuilder(const cad::StepBody& body) : body_(body) {
    for (const design::Vec3& v : body.vertices)
      vertices_.push_back(BRepBuilderAPI_MakeVertex(gp_Pnt(v.x(), v.y(), v.z())).Vertex());
  }

  TopoDS_Shape shape() {
    TopoDS_Shell shell;
    builder_.MakeShell(shell);
    for (const auto& face : body_.faces) builder_.Add(shell, face_of(face));
    if (!is_closed()) return shell;
    shell.Closed(true);
    TopoDS_Solid solid;
    builder_.MakeSolid(solid);
    builder_.Add(solid, shell);
    BRepLib::OrientClosedSolid(solid);
    return solid;
  }

 private:
  struct Shared {
    TopoDS_Edge edge;
    int uses = 0;
  };

  TopoDS_Edge edge_of(int from, int to) {
    Shared& shared = edges_[{std::min(from, to), std::max(from, to)}];
    const auto& low = vertices_[static_cast<std::size_t>(std::min(from, to))];
    const auto& high = vertices_[static_cast<std::size_t>(std::max(from, to))];
    if (shared.uses++ == 0) shared.edge = BRepBuilderAPI_MakeEdge(low, high).Edge();
    return from < to ? shared.edge : TopoDS::Edge(shared.edge.Reversed());
  }

  gp_Pln plane_of(const std::vector<int>& face) const {
    const auto at = [&](std::size_t k) { return body_.vertices[static_cast<std::size_t>(face[k])]; };
    design::Vec3 normal = design::Vec3::Zero();
    for (std::size_t k = 1; k + 1 < face.size(); ++k) normal += (at(k) - at(0)).cross(at(k + 1) - at(0));
    if (!(normal.norm() > 0.0)) throw std::runtime_error("a face of " + body_.name + " has no area");
    return {gp_Pnt(at(0).x(), at(0).y(), at(0).z()), gp_Dir(normal.x(), normal.y(), normal.z())};
  }

  TopoDS_Face face_of(const std::vector<int>& face) {
    BRepBuilderAPI_MakeWire wire;
    for (std::size_t k = 0; k < face.size(); ++k) wire.Add(edge_of(face[k], face[(k + 1) % face.size()]));
    BRepBuilderAPI_MakeFace made(plane_of(face), wire.Wire());
    if (!made.IsDone()) throw std::runtime_error("a face of " + body_.name + " cannot be built");
    return made.Face();
  }

  [[nodiscard]] bool is_closed() const {
    return std::ranges::all_of(edges_, [](const auto& edge) { return edge.second.uses == 2; });
  }

  const cad::StepBody& body_;
  BRep_Builder builder_;
  std::vector<TopoDS_Vertex> vertices_;
  std::map<std::array<int, 2>, Shared> edges_;
};

TCollection_ExtendedString wide(const std::string& text) {
  return {text.c_str(), true};
}

Handle(TDocStd_Document) document_of(const cad::StepAssembly& assembly) {
  Handle(TDocStd_Document) document = new TDocStd_Document("MDTV-XCAF");
  const auto shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  const auto colours = XCAFDoc_DocumentTool::ColorTool(document->Main());
  const TDF_Label root = shapes->NewShape();
  TDataStd_Name::Set(root, wide(assembly.name));
  for (const cad::StepBody& body : assembly.bodies) {
    const TDF_Label label = shapes->AddShape(BodyBuilder(body).shape(), false);
    TDataStd_Name::Set(label, wide(body.name));
    const auto& [red, green, blue] = body.colour;
    colours->SetColor(label, Quantity_Color(red / 255.0, green / 255.0, blue / 255.0, Quantity_TOC_sRGB),
                      XCAFDoc_ColorSurf);
    TDataStd_Name::Set(shapes->AddComponent(root, label, TopLoc_Location()), wide(body.name));
  }
  shapes->UpdateAssemblies();
  return document;
}

// The kernel writes only to files, so this file is in memory.
std::string written(STEPCAFControl_Writer& writer) {
  const int file = ::memfd_create("step", MFD_CLOEXEC);
  const std::string path = "/proc/self/fd/" + std::to_string(file);
  if (file < 0 || writer.Write(path.c_str()) != IFSelect_RetDone) throw std::runtime_error("the kernel wrote no file");
  std::ifstream in(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << in.rdbuf();
  ::close(file);
  return bytes.str();
}

}  // namespace

std::string step_of(const cad::StepAssembly& assembly, const StageSink& stage) {
  stage("building " + std::to_string(assembly.bodies.size()) + " bodies");
  const auto document = document_of(assembly);
  stage("translating them");
  STEPCAFControl_Writer writer;
  Interface_Static::SetCVal("write.step.schema", "AP214IS");
  Interface_Static::SetCVal("write.step.unit", "MM");
  writer.SetNameMode(true);
  writer.SetColorMode(true);
  if (!writer.Transfer(document, STEPControl_AsIs)) throw std::runtime_error("the kernel translated no body");
  APIHeaderSection_MakeHeader header(writer.ChangeWriter().Model());
  header.SetName(new TCollection_HAsciiString(assembly.name.c_str()));
  // A fixed time makes equal designs give equal files.
  header.SetTimeStamp(new TCollection_HAsciiString("1970-01-01T00:00:00"));
  stage("writing them");
  return written(writer);
}

}  // namespace triskin::cad_reader
