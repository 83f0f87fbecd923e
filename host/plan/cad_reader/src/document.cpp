// SPDX-License-Identifier: GPL-3.0-or-later
#include "document.hpp"

#include <BRepBuilderAPI_Sewing.hxx>
#include <BRep_Builder.hxx>
#include <IGESCAFControl_Reader.hxx>
#include <IGESData_BasicEditor.hxx>
#include <IGESData_GlobalSection.hxx>
#include <IGESData_IGESEntity.hxx>
#include <IGESData_IGESModel.hxx>
#include <Interface_EntityIterator.hxx>
#include <Interface_Graph.hxx>
#include <Interface_Static.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <STEPControl_Reader.hxx>
#include <StepData_StepModel.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <StepShape_FaceSurface.hxx>
#include <StepShape_ManifoldSolidBrep.hxx>
#include <StepShape_ShapeRepresentation.hxx>
#include <TColStd_SequenceOfAsciiString.hxx>
#include <TCollection_ExtendedString.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <cmath>
#include <cstdio>
#include <set>
#include <sstream>
#include <stdexcept>

namespace triskin::cad_reader {
namespace {

// Edges of loose faces that are this near count as the same: IGES files state 0.001 … 0.01 mm.
constexpr double kSewing_mm = 0.02;
constexpr int kMaxNamed = 5;

std::string utf8_of(const TCollection_ExtendedString& text) {
  std::string bytes(static_cast<std::size_t>(text.LengthOfCString()) + 1, '\0');
  Standard_PCharacter out = bytes.data();
  bytes.resize(static_cast<std::size_t>(text.ToUTF8CString(out)));
  return bytes;
}

std::string name_of(const TDF_Label& label) {
  Handle(TDataStd_Name) name;
  return label.FindAttribute(TDataStd_Name::GetID(), name) ? utf8_of(name->Get()) : std::string();
}

std::string hex_of(const Quantity_Color& colour) {
  const auto byte = [](double linear) {
    return static_cast<unsigned>(std::lround(255.0 * Quantity_Color::Convert_LinearRGB_To_sRGB(linear))) & 0xFFU;
  };
  std::array<char, 8> text{};
  std::snprintf(text.data(), text.size(), "#%02x%02x%02x", byte(colour.Red()), byte(colour.Green()),
                byte(colour.Blue()));
  return text.data();
}

std::string colour_of(const Handle(XCAFDoc_ColorTool) & colours, const TDF_Label& label) {
  Quantity_Color colour;
  for (const XCAFDoc_ColorType type : {XCAFDoc_ColorSurf, XCAFDoc_ColorGen}) {
    if (colours->GetColor(label, type, colour)) return hex_of(colour);
  }
  return {};
}

// Extracts the bodies of a document of assemblies.
class Collector {
 public:
  Collector(const Handle(TDocStd_Document) & xde, Document& out)
      : shapes_(XCAFDoc_DocumentTool::ShapeTool(xde->Main())),
        colours_(XCAFDoc_DocumentTool::ColorTool(xde->Main())),
        out_(out) {}

  void run() {
    TDF_LabelSequence roots;
    shapes_->GetFreeShapes(roots);
    for (const TDF_Label& root : roots) visit(root, TopLoc_Location(), {}, {}, false);
    for (PlacedBody& loose : sewn_loose_faces()) out_.bodies.push_back(std::move(loose));
  }

 private:
  void visit(const TDF_Label& label, const TopLoc_Location& place, const std::string& path,
             const std::string& inherited, bool is_hidden) {
    is_hidden = is_hidden || !colours_->IsVisible(label);
    const std::string own = colour_of(colours_, label);
    const std::string colour = own.empty() ? inherited : own;
    TDF_Label product;
    if (XCAFDoc_ShapeTool::GetReferredShape(label, product)) {
      visit(product, place * XCAFDoc_ShapeTool::GetLocation(label), path, colour, is_hidden);
      return;
    }
    const std::string name = name_of(label);
    const std::string here = path.empty() ? name : path + "/" + name;
    if (XCAFDoc_ShapeTool::IsAssembly(label)) {
      TDF_LabelSequence parts;
      XCAFDoc_ShapeTool::GetComponents(label, parts);
      for (const TDF_Label& part : parts) visit(part, place, here, colour, is_hidden);
      return;
    }
    note_sub_shapes(label);
    add_bodies(XCAFDoc_ShapeTool::GetShape(label).Moved(place), {{}, name, here, colour, is_hidden});
  }

  void note_sub_shapes(const TDF_Label& label) {
    TDF_LabelSequence subs;
    XCAFDoc_ShapeTool::GetSubShapes(label, subs);
    for (const TDF_Label& sub : subs) {
      Label& said = out_.labels[XCAFDoc_ShapeTool::GetShape(sub).TShape().get()];
      if (const std::string colour = colour_of(colours_, sub); !colour.empty()) said.colour = colour;
      if (const std::string name = name_of(sub); !name.empty() && said.name.empty()) said.name = name;
    }
  }

  void add_bodies(const TopoDS_Shape& shape, const PlacedBody& like) {
    const std::size_t first = out_.bodies.size();
    for (TopExp_Explorer it(shape, TopAbs_SOLID); it.More(); it.Next()) add(it.Current(), like);
    for (TopExp_Explorer it(shape, TopAbs_SHELL, TopAbs_SOLID); it.More(); it.Next()) add(it.Current(), like);
    for (TopExp_Explorer it(shape, TopAbs_FACE, TopAbs_SHELL); it.More(); it.Next()) {
      loose_.push_back(like);
      loose_.back().shape = it.Current();
    }
    if (out_.bodies.size() - first < 2) return;
    for (std::size_t b = first; b < out_.bodies.size(); ++b) name_solid(out_.bodies[b]);
  }
  void add(const TopoDS_Shape& shape, const PlacedBody& like) {
    out_.bodies.push_back(like);
    out_.bodies.back().shape = shape;
    const std::string& own = label_of(out_, shape).colour;
    if (!own.empty()) out_.bodies.back().colour = own;
  }
  // Several solids of one product can only be told by names of their own.
  void name_solid(PlacedBody& body) const {
    const std::string& own = label_of(out_, body.shape).name;
    if (own.empty() || own == body.name) return;
    body.name = own;
    body.path += "/" + own;
  }

  std::vector<PlacedBody> sewn_loose_faces() {
    if (loose_.size() < 2) return loose_;
    BRepBuilderAPI_Sewing sewing(kSewing_mm);
    for (const PlacedBody& face : loose_) sewing.Add(face.shape);
    sewing.Perform();
    for (const PlacedBody& face : loose_) keep_label(face.shape, sewing.ModifiedSubShape(face.shape));
    std::vector<PlacedBody> bodies;
    const auto take = [&](const TopoDS_Shape& shape) {
      bodies.push_back(loose_.front());
      bodies.back().shape = shape;
    };
    const TopoDS_Shape all = sewing.SewedShape();
    for (TopExp_Explorer it(all, TopAbs_SHELL); it.More(); it.Next()) take(it.Current());
    for (TopExp_Explorer it(all, TopAbs_FACE, TopAbs_SHELL); it.More(); it.Next()) take(it.Current());
    return bodies;
  }
  void keep_label(const TopoDS_Shape& before, const TopoDS_Shape& after) {
    if (before.TShape() == after.TShape()) return;
    const Label said = label_of(out_, before);
    for (TopExp_Explorer it(after, TopAbs_FACE); it.More(); it.Next()) out_.labels[it.Current().TShape().get()] = said;
  }

  Handle(XCAFDoc_ShapeTool) shapes_;
  Handle(XCAFDoc_ColorTool) colours_;
  Document& out_;
  std::vector<PlacedBody> loose_;
};

// Returns the number of an entity as "#17".
std::string number_of(const Handle(StepData_StepModel) & model, const Handle(Standard_Transient) & entity) {
  return std::string("#").append(std::to_string(model->IdentLabel(entity)));
}

void note_entity(Document& out, const TopoDS_Shape& shape, const Label& said) {
  for (TopExp_Explorer it(shape, TopAbs_FACE); it.More(); it.Next()) {
    Label& label = out.labels[it.Current().TShape().get()];
    label.entity = said.entity;
    if (!said.name.empty()) label.name = said.name;
  }
}

void mark_hidden(const TopoDS_Shape& shape, Document& out) {
  if (shape.IsNull()) return;
  for (TopExp_Explorer it(shape, TopAbs_FACE); it.More(); it.Next())
    out.labels[it.Current().TShape().get()].is_hidden = true;
}

std::string text_of(const Handle(TCollection_HAsciiString) & text) {
  // The kernel keeps strings in UTF-8 once it has resolved their escapes. SolidWorks writes NONE for no name.
  const std::string name = text.IsNull() ? std::string() : text->ToCString();
  return name == "NONE" ? std::string() : name;
}

class LostEntities {
 public:
  void add(const std::string& number) {
    if (++count_ <= kMaxNamed) numbers_ += (numbers_.empty() ? "" : ", ") + number;
  }
  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] std::string list() const { return numbers_ + (count_ > kMaxNamed ? ", …" : ""); }

 private:
  int count_ = 0;
  std::string numbers_;
};

// Tells how shape representations use an entity.
struct Use {
  bool is_used = false;
  bool is_shape = false;  // True under an item of a representation, false for contexts, units and the like.
};

// Lists uses by the number in the model: a file may contain entities that nothing uses.
std::vector<Use> uses_of(const Handle(StepData_StepModel) & model) {
  const Interface_Graph graph(model, Standard_False);
  std::vector<Use> uses(static_cast<std::size_t>(model->NbEntities()) + 1);
  std::vector<int> todo;
  const auto use = [&](int e, bool is_shape) {
    Use& now = uses[static_cast<std::size_t>(std::max(e, 0))];
    if (e <= 0 || (now.is_used && (now.is_shape || !is_shape))) return;
    now = {true, is_shape};
    todo.push_back(e);
  };
  for (int e = 1; e <= model->NbEntities(); ++e) {
    if (model->Value(e)->IsKind(STANDARD_TYPE(StepShape_ShapeRepresentation))) use(e, false);
  }
  while (!todo.empty()) {
    const int e = todo.back();
    todo.pop_back();
    const bool is_shape = uses[static_cast<std::size_t>(e)].is_shape ||
                          model->Value(e)->IsKind(STANDARD_TYPE(StepRepr_RepresentationItem));
    Interface_EntityIterator below = graph.Shareds(model->Value(e));
    for (below.Start(); below.More(); below.Next()) use(model->Number(below.Value()), is_shape);
  }
  return uses;
}

bool has_face(const TopoDS_Shape& shape) {
  return !shape.IsNull() && TopExp_Explorer(shape, TopAbs_FACE).More();
}

// Finds the names and numbers of faces and solids.
void match_names(const Handle(StepData_StepModel) & model, const Handle(Transfer_TransientProcess) & transferred,
                 Document& out) {
  for (int e = 1; e <= model->NbEntities(); ++e) {
    const Handle(Standard_Transient) entity = model->Value(e);
    const bool is_face = entity->IsKind(STANDARD_TYPE(StepShape_FaceSurface));
    if (!is_face && !entity->IsKind(STANDARD_TYPE(StepShape_ManifoldSolidBrep))) continue;
    const TopoDS_Shape shape = TransferBRep::ShapeResult(transferred, entity);
    if (shape.IsNull()) continue;
    const Label said{
        text_of(Handle(StepRepr_RepresentationItem)::DownCast(entity)->Name()), {}, number_of(model, entity)};
    if (is_face) {
      note_entity(out, shape, said);
    } else {
      for (TopExp_Explorer it(shape, TopAbs_SOLID); it.More(); it.Next())
        out.labels[it.Current().TShape().get()].name = said.name;
    }
  }
}

bool is_open_solid(const Handle(Standard_Transient) & entity, const TopoDS_Shape& shape) {
  return entity->IsKind(STANDARD_TYPE(StepShape_ManifoldSolidBrep)) && has_face(shape) &&
         !TopExp_Explorer(shape, TopAbs_SOLID).More();
}

// Finds entities that the kernel could not read, faces that it dropped and solids that it left open, because it does
// not report them.
void find_lost(const Handle(StepData_StepModel) & model, const Handle(Transfer_TransientProcess) & transferred,
               Document& out) {
  const std::vector<Use> uses = uses_of(model);
  LostEntities lost, broken, beside, open;
  for (int e = 1; e <= model->NbEntities(); ++e) {
    const Use& use = uses[static_cast<std::size_t>(e)];
    if (!use.is_used) continue;
    const Handle(Standard_Transient) entity = model->Value(e);
    if (model->IsUnknownEntity(e) || model->IsErrorEntity(e))
      (use.is_shape ? broken : beside).add(number_of(model, entity));
    const TopoDS_Shape shape = TransferBRep::ShapeResult(transferred, entity);
    if (entity->IsKind(STANDARD_TYPE(StepShape_FaceSurface)) && !has_face(shape)) lost.add(number_of(model, entity));
    if (is_open_solid(entity, shape)) open.add(number_of(model, entity));
  }
  const auto tell = [](const LostEntities& some, const char* one, const char* many, std::vector<std::string>& to) {
    if (some.count() > 0) to.push_back(std::to_string(some.count()) + (some.count() == 1 ? one : many) + some.list());
  };
  tell(lost, " face of the file could not be built and is missing: ",
       " faces of the file could not be built and are missing: ", out.faults);
  tell(broken, " entity of the shapes is damaged: ", " entities of the shapes are damaged: ", out.faults);
  tell(open, " solid in the file is not closed: ", " solids in the file are not closed: ", out.faults);
  tell(beside, " entity other than shapes could not be read: ", " entities other than shapes could not be read: ",
       out.warnings);
}

Handle(TDocStd_Document) new_document() {
  const Handle(TDocStd_Document) xde = new TDocStd_Document("XmlXCAF");
  XCAFDoc_DocumentTool::Set(xde->Main());
  return xde;
}

// Expands the names of units that the kernel shortens.
std::string unit_name(const std::string& name) {
  if (name == "MM") return "millimetre";
  if (name == "CM") return "centimetre";
  if (name == "M") return "metre";
  if (name == "INCH" || name == "IN") return "inch";
  return name;
}

double unit_of_name_mm(const std::string& name) {
  const std::unordered_map<std::string, double> known{
      {"millimetre", 1.0}, {"milimetre", 1.0}, {"centimetre", 10.0},  {"metre", 1000.0},  {"inch", 25.4},
      {"INCH", 25.4},      {"foot", 304.8},    {"micrometre", 0.001}, {"kilometre", 1e6}, {"mil", 0.0254}};
  const auto found = known.find(name);
  return found == known.end() ? 1.0 : found->second;
}

}  // namespace

namespace {

// Marks the faces of the entities with these numbers as switched off.
void mark_hidden(const Handle(StepData_StepModel) & model, const Handle(Transfer_TransientProcess) & transferred,
                 const std::set<std::string>& hidden, Document& out) {
  for (int e = 1; e <= model->NbEntities() && !hidden.empty(); ++e) {
    const Handle(Standard_Transient) entity = model->Value(e);
    if (hidden.contains(number_of(model, entity))) mark_hidden(TransferBRep::ShapeResult(transferred, entity), out);
  }
}

}  // namespace

Document read_step(std::istream& text, const StageSink& stage) {
  stage("reading the entities");
  std::set<std::string> hidden;
  std::string line;
  std::getline(text, line);
  std::istringstream numbers(line);
  for (std::string number; numbers >> number;) hidden.insert("#" + number);
  STEPCAFControl_Reader reader;
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");
  reader.SetNameMode(Standard_True);
  reader.SetColorMode(Standard_True);
  if (reader.ChangeReader().ReadStream("part", text) != IFSelect_RetDone)
    throw std::runtime_error("the entities cannot be read; export the part again");
  Document out;
  TColStd_SequenceOfAsciiString lengths, angles, solid_angles;
  reader.ChangeReader().FileUnits(lengths, angles, solid_angles);
  if (!lengths.IsEmpty()) out.unit = unit_name(lengths.First().ToCString());
  out.unit_mm = unit_of_name_mm(out.unit);
  stage("building the shapes");
  const Handle(TDocStd_Document) xde = new_document();
  (void)reader.Transfer(const_cast<Handle(TDocStd_Document)&>(xde));
  const auto model = Handle(StepData_StepModel)::DownCast(reader.ChangeReader().Model());
  const auto transferred = reader.ChangeReader().WS()->TransferReader()->TransientProcess();
  match_names(model, transferred, out);
  mark_hidden(model, transferred, hidden, out);
  find_lost(model, transferred, out);
  stage("taking the bodies out of the assemblies");
  Collector(xde, out).run();
  return out;
}

namespace {

// The first two digits of an entity's status number are 01 if it is blanked (IGES 5.3, 2.2.4.4.9).
void mark_blanked(const Handle(IGESData_IGESModel) & model, const Handle(Transfer_TransientProcess) & transferred,
                  Document& out) {
  for (int e = 1; e <= model->NbEntities(); ++e) {
    const Handle(IGESData_IGESEntity) entity = model->Entity(e);
    if (entity->BlankStatus() == 1) mark_hidden(TransferBRep::ShapeResult(transferred, entity), out);
  }
}

void note_unit(const IGESData_GlobalSection& global, Document& out) {
  out.unit_mm = global.UnitValue() > 0.0 ? global.UnitValue() : 1.0;
  if (!global.UnitName().IsNull()) out.unit = unit_name(global.UnitName()->ToCString());
}

}  // namespace

Document read_iges(const std::string& path, const StageSink& stage) {
  stage("reading the entities");
  IGESCAFControl_Reader reader;
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");
  Interface_Static::SetIVal("read.iges.bspline.continuity", 1);
  if (reader.ReadFile(path.c_str()) != IFSelect_RetDone)
    throw std::runtime_error("the entities cannot be read; export the part again");
  Document out;
  note_unit(Handle(IGESData_IGESModel)::DownCast(reader.Model())->GlobalSection(), out);
  stage("building the shapes");
  const Handle(TDocStd_Document) xde = new_document();
  (void)reader.Transfer(const_cast<Handle(TDocStd_Document)&>(xde));
  mark_blanked(Handle(IGESData_IGESModel)::DownCast(reader.Model()), reader.WS()->TransferReader()->TransientProcess(),
               out);
  stage("taking the bodies out of the assemblies");
  Collector(xde, out).run();
  return out;
}

const Label& label_of(const Document& document, const TopoDS_Shape& shape) {
  static const Label kNone;
  const auto found = document.labels.find(shape.TShape().get());
  return found == document.labels.end() ? kNone : found->second;
}

}  // namespace triskin::cad_reader
