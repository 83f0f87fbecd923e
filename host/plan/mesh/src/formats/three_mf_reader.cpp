// SPDX-License-Identifier: GPL-3.0-or-later
#include "three_mf_reader.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <array>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "package.hpp"
#include "percent.hpp"
#include "text_numbers.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/index.hpp"
#include "triskin/base/lower_case.hpp"
#include "xml_reader.hpp"

namespace triskin::mesh {
namespace {

constexpr std::string_view kCore = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02";
constexpr std::string_view kProduction = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06";
constexpr std::string_view kModelRelation = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel";
// These extensions change no surface: materials, sets of triangles.
constexpr std::array<std::string_view, 4> kHarmless{
    kCore, kProduction, "http://schemas.microsoft.com/3dmanufacturing/material/2015/02",
    "http://schemas.microsoft.com/3dmanufacturing/trianglesets/2021/07"};
constexpr std::size_t kMaxFaces = 50'000'000;
constexpr int kMaxShown = 1'000'000;  // An object counts once for each time it is shown.
constexpr int kMaxDepth = 32;         // Components may contain components this deep.

struct UnitRow {
  std::string_view name;
  double mm;
};
constexpr std::array<UnitRow, 6> kUnits{
    {{"micron", 1e-3}, {"millimeter", 1.0}, {"centimeter", 10.0}, {"inch", 25.4}, {"foot", 304.8}, {"meter", 1e3}}};

// An object that is shown at a place.
struct Shown {
  std::string part, id;
  Eigen::Affine3d place;
  bool is_printable = true;
};
struct Object {
  std::string name, type;
  Mesh mesh;
  std::vector<Shown> components;
  std::string slicer_role{};      // The slicer takes it for this, not for a part of the body.
  std::string lattice_or_slices;  // "a beam lattice" or "slices" that stand for its body
};
// What a slicer says of triangles or of a component of an object (docs/mesh.md).
struct SlicerVolume {
  std::string name, role;
  std::size_t first_face = 0, last_face = 0;  // PrusaSlicer, SuperSlicer: a range of the object's triangles
  std::string component;                      // Bambu Studio, OrcaSlicer: the object that the component shows
};
using SlicerVolumes = std::map<std::string, std::vector<SlicerVolume>>;  // by object of the root model

// Slicers keep bodies in a project that are no part of the print: ranges of other settings, cuts, supports.
std::string role_of(std::string_view type) {
  std::string lower = lower_case(type);
  if (lower.empty() || lower == "modelpart" || lower == "normal_part") return {};
  if (lower.starts_with("negative")) return "negative volume";
  if (lower.starts_with("modifier") || lower == "parametermodifier") return "modifier";
  if (lower.starts_with("support"))
    return "support " + lower.substr(std::min<std::size_t>(lower.size(), lower[7] == '_' ? 8 : 7));
  return lower;
}

// JSCAD declares no namespace.
bool is_core(std::string_view space) {
  return space == kCore || space.empty();
}

struct Model {
  double unit_mm = 1.0;
  std::map<std::string, Object> objects;
  std::vector<Shown> build;
};

// Reads one model part of the package.
class ModelReader {
 public:
  ModelReader(std::string file, std::string part) : file_(std::move(file)), part_(std::move(part)) {}

  Model read(const std::string& bytes) {
    XmlHandler handler;
    handler.declare = [this](std::string_view prefix, std::string_view uri) { spaces_[std::string(prefix)] = uri; };
    handler.start = [this](const XmlTag& tag) { start(tag); };
    handler.end = [this](std::string_view space, std::string_view name) {
      if (is_core(space) && name == "object") object_ = nullptr;
      if (is_core(space) && name == "metadata") end_metadata();
    };
    handler.text = [this](std::string_view text) {
      if (!metadata_.empty()) metadata_text_ += text;
    };
    parse_xml(bytes, fmt::format("{}, part {}", file_, part_.substr(0, 80)), handler);
    if (!has_model_) throw InputError(fmt::format("{}: its part {} is no 3MF model", file_, part_.substr(0, 80)));
    return std::move(model_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(fmt::format("{}, part {}, line {}: not a mesh that can be read ({}); repair or export it again",
                                 file_, part_.substr(0, 80), line_, what));
  }

  void start(const XmlTag& tag) {
    line_ = tag.line;
    if (object_ != nullptr && tag.name == "beamlattice") object_->lattice_or_slices = "a beam lattice";
    if (!is_core(tag.space)) return;
    if (tag.name == "model") return model(tag);
    if (tag.name == "object") return object(tag);
    if (tag.name == "item") return model_.build.push_back(shown(tag));
    if (object_ == nullptr) return;
    if (tag.name == "metadata") metadata_ = tag.attribute("name");
    if (tag.name == "component") object_->components.push_back(shown(tag));
    if (tag.name == "vertex") object_->mesh.vertices.emplace_back(number(tag, "x"), number(tag, "y"), number(tag, "z"));
    if (tag.name == "triangle")
      object_->mesh.faces.push_back({corner(tag, "v1"), corner(tag, "v2"), corner(tag, "v3")});
  }

  // Cura marks what is no part of the print by metadata of the object.
  void end_metadata() {
    const std::string name = std::exchange(metadata_, {}), text = lower_case(std::exchange(metadata_text_, {}));
    if (object_ == nullptr || (text != "true" && text != "1")) return;
    constexpr std::array<std::pair<std::string_view, std::string_view>, 4> kRoles{
        {{"cura:infill_mesh", "modifier"},
         {"cura:cutting_mesh", "cutting mesh"},
         {"cura:support_mesh", "support"},
         {"cura:anti_overhang_mesh", "support blocker"}}};
    for (const auto& [key, role] : kRoles) {
      if (name == key) object_->slicer_role = role;
    }
  }

  void model(const XmlTag& tag) {
    has_model_ = true;
    const std::string_view unit = tag.attribute("unit");
    const auto* row = std::ranges::find(kUnits, unit.empty() ? "millimeter" : unit, &UnitRow::name);
    if (row == kUnits.end()) fail(fmt::format("unknown unit \"{}\"", unit.substr(0, 20)));
    model_.unit_mm = row->mm;
    std::string_view required = tag.attribute("requiredextensions");
    for (std::string_view prefix = next_word(required); !prefix.empty(); prefix = next_word(required)) {
      const auto found = spaces_.find(std::string(prefix));
      const std::string uri = found == spaces_.end() ? std::string(prefix) : found->second;
      if (std::ranges::find(kHarmless, uri) == kHarmless.end())
        fail(fmt::format("it requires the extension {}, which is not read", uri.substr(0, 120)));
    }
  }

  void object(const XmlTag& tag) {
    const std::string id(tag.attribute("id"));
    if (id.empty() || model_.objects.contains(id)) fail("an object without an id of its own");
    object_ = &model_.objects[id];
    const std::string_view name = tag.attribute("name"), type = tag.attribute("type");
    for (const auto& [key, value] : tag.attributes) {
      if (key.ends_with("slicestackid")) object_->lattice_or_slices = "slices";
    }
    object_->name = name.empty() ? id : std::string(name);
    object_->type = type.empty() ? "model" : std::string(type);
  }

  [[nodiscard]] double number_in(std::string_view text) const {
    if (const auto value = decimal_number(text)) return *value;
    fail(fmt::format("\"{}\" is no number{}", text.substr(0, 20), has_decimal_comma(text) ? ": decimal commas" : ""));
  }
  [[nodiscard]] double number(const XmlTag& tag, std::string_view name) const { return number_in(tag.attribute(name)); }
  [[nodiscard]] int corner(const XmlTag& tag, std::string_view name) const {
    const auto value = whole_number(tag.attribute(name));
    if (!value || *value < 0 || *value > 2'000'000'000) fail("a face names a vertex that does not exist");
    return static_cast<int>(*value);
  }

  // A transform has twelve numbers: the rows of a matrix that is multiplied from the left by a point (x, y, z, 1).
  [[nodiscard]] Shown shown(const XmlTag& tag) const {
    const std::string path = percent_decoded(tag.attribute("path", kProduction));
    Shown s{path.empty() ? part_ : path, std::string(tag.attribute("objectid")), Eigen::Affine3d::Identity(),
            tag.attribute("printable") != "0" && tag.attribute("printable") != "false"};
    std::string text(tag.attribute("transform"));
    std::ranges::replace_if(text, [](char c) { return c == '\n' || c == '\r'; }, ' ');
    std::string_view rest = text;
    int count = 0;
    for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest), ++count) {
      if (count < 12) s.place.matrix()(count % 3, count / 3) = number_in(word);
    }
    if (count != 0 && count != 12) fail(fmt::format("a transform has {} numbers, not 12", count));
    return s;
  }

  std::string file_, part_;
  std::map<std::string, std::string> spaces_;  // Maps a prefix to the URI of its namespace.
  Model model_;
  Object* object_ = nullptr;
  std::string metadata_, metadata_text_;  // its name and contents while it is open
  long line_ = 0;
  bool has_model_ = false;
};

class ThreeMf {
 public:
  explicit ThreeMf(const MeshSource& source) : source_(source), package_(source.bytes, source.name) {}

  MeshInUnit read() {
    const Model& root = model(root_part());
    if (root.build.empty()) fail("its build has no items: the file shows nothing");
    result_.unit_mm = root.unit_mm;
    read_slicer_volumes();
    for (const Shown& item : root.build) show(item, Eigen::Affine3d::Identity(), source_.objects.wanted.empty(), 0);
    for (const auto& [type, count] : left_out_) {
      source_.notes.push_back(fmt::format("{} of the type \"{}\" {} no part of the body and left out",
                                          counted(count, "object"), type, agreeing(count, "is", "are")));
    }
    if (!hidden_.empty()) source_.notes.push_back(hidden_note(hidden_, hides_ranges_));
    if (result_.mesh.faces.empty() && !lattice_or_slices_.empty()) {
      source_.notes.push_back(
          fmt::format("its body is {}, which is not read; export it as triangles", lattice_or_slices_));
    }
    if (flattened_ > 0) source_.notes.push_back(flattened_note(flattened_));
    return std::move(result_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(
        fmt::format("{}: not a mesh that can be read ({}); repair or export it again", source_.name, what));
  }

  // Finds the root by the relation of the package rather than a name, as the Open Packaging Conventions require.
  std::string root_part() {
    const std::string relations = package_.read("_rels/.rels");
    std::string target;
    XmlHandler handler;
    handler.start = [&](const XmlTag& tag) {
      if (tag.name == "Relationship" && tag.attribute("Type") == kModelRelation && target.empty())
        target = percent_decoded(tag.attribute("Target"));
    };
    parse_xml(relations, source_.name + ", part _rels/.rels", handler);
    if (target.empty()) fail("it is an archive without a 3MF model");
    return target.starts_with('/') ? target : "/" + target;
  }

  const Model& model(const std::string& part) {
    const auto found = models_.find(part);
    if (found != models_.end()) return found->second;
    return models_.emplace(part, ModelReader(source_.name, part).read(package_.read(part))).first->second;
  }

  // PrusaSlicer and its kin keep roles of triangles, Bambu Studio and its kin of components, each in a part of its own
  // beside the model.
  void read_slicer_volumes() {
    for (const char* part :
         {"Metadata/Slic3r_PE_model.config", "Metadata/Slic3r_model.config", "Metadata/Prusa_Slicer_model.config",
          "Metadata/SuperSlicer_model.config", "Metadata/model_settings.config"}) {
      if (!package_.has(part)) continue;
      std::string object;
      SlicerVolume* volume = nullptr;
      XmlHandler handler;
      handler.start = [&](const XmlTag& tag) {
        if (tag.name == "object") object = tag.attribute("id");
        if (tag.name == "volume" || tag.name == "part") {
          volume = &slicer_volumes_[object].emplace_back();
          if (tag.name == "volume") {
            const auto first = whole_number(tag.attribute("firstid")), last = whole_number(tag.attribute("lastid"));
            if (!first || !last || *first < 0 || *last < *first)
              fail(fmt::format("{} does not say which triangles its volumes have (firstid, lastid)", part));
            volume->first_face = static_cast<std::size_t>(*first);
            volume->last_face = static_cast<std::size_t>(*last);
          }
          if (tag.name == "part") volume->component = tag.attribute("id");
          volume->role = role_of(tag.attribute("subtype"));
        }
        if (tag.name != "metadata" || volume == nullptr) return;
        const std::string_view key = tag.attribute("key"), value = tag.attribute("value");
        if (key == "name") volume->name = value;
        if (key == "volume_type") volume->role = role_of(value);
        if (key == "modifier" && value == "1" && volume->role.empty()) volume->role = "modifier";
      };
      handler.end = [&](std::string_view, std::string_view name) {
        if (name == "volume" || name == "part") volume = nullptr;
      };
      parse_xml(package_.read(part), fmt::format("{}, part {}", source_.name, part), handler);
    }
  }

  void hide(const std::string& name, const std::string& why) {
    const std::string text = fmt::format("{} ({})", name, why);
    if (std::ranges::find(hidden_, text) == hidden_.end()) hidden_.push_back(text);
  }

  // What the author switched off is shown only if it is the wanted object.
  void show(const Shown& item, const Eigen::Affine3d& parent, bool is_in, int depth, const std::string& role = {}) {
    if (depth > kMaxDepth || ++shown_ > kMaxShown) fail("its components have no end");
    const Model& in = model(item.part);
    const auto found = in.objects.find(item.id);
    if (found == in.objects.end()) fail(fmt::format("it has no object {}", item.id.substr(0, 20)));
    const Object& object = found->second;
    const Eigen::Affine3d place = parent * item.place;
    const bool is_wanted = source_.objects.meets(object.name);
    std::string why = item.is_printable ? object.slicer_role : "printable=\"0\"";
    if (why.empty()) why = role;
    if (is_in && !is_wanted && !why.empty()) {
      hide(object.name, why);
      is_in = false;
    }
    is_in = is_wanted || is_in;
    if (object.type != "model" && object.type != "surface" && source_.objects.wanted.empty()) {
      ++left_out_[object.type];
      return;
    }
    const auto volumes = depth == 0 ? slicer_volumes_.find(item.id) : slicer_volumes_.end();
    for (const Shown& component : object.components) {
      std::string part_role;
      if (volumes != slicer_volumes_.end()) {
        const auto part = std::ranges::find(volumes->second, component.id, &SlicerVolume::component);
        if (part != volumes->second.end()) part_role = part->role;
      }
      show(component, place, is_in, depth + 1, part_role);
    }
    if (!is_in) return;
    if (!object.lattice_or_slices.empty() && object.mesh.faces.empty()) lattice_or_slices_ = object.lattice_or_slices;
    const bool has_roles = volumes != slicer_volumes_.end() && !object.mesh.faces.empty();
    append(has_roles ? without_roles(object.mesh, volumes->second) : object.mesh, place, in.unit_mm / result_.unit_mm);
  }

  Mesh without_roles(const Mesh& mesh, const std::vector<SlicerVolume>& volumes) {
    Mesh kept = mesh;
    for (const SlicerVolume& volume : volumes) {
      if (volume.role.empty() || !volume.component.empty()) continue;
      hide(volume.name.empty() ? fmt::format("triangles {} to {}", volume.first_face, volume.last_face) : volume.name,
           volume.role);
      hides_ranges_ = true;
      for (std::size_t f = volume.first_face; f < mesh.faces.size() && f <= volume.last_face; ++f)
        kept.faces[f] = {0, 0, 0};
    }
    std::erase_if(kept.faces, [](const auto& f) { return f[0] == f[1] && f[1] == f[2]; });
    return kept;
  }

  // A part may have another unit than the root.
  void append(const Mesh& mesh, const Eigen::Affine3d& place, double scale) {
    const int first = static_cast<int>(result_.mesh.vertices.size());
    if (result_.mesh.faces.size() + mesh.faces.size() > kMaxFaces) fail("it is too large");
    flattened_ += !mesh.faces.empty() && place.linear().determinant() == 0.0 ? 1 : 0;
    const bool is_mirrored = place.linear().determinant() < 0.0;
    for (const Vec3& v : mesh.vertices) result_.mesh.vertices.push_back(place * (scale * v));
    for (const auto& f : mesh.faces) {
      for (const int v : f) {
        if (at(v) >= mesh.vertices.size()) fail("a face names a vertex that does not exist");
      }
      const auto [a, b, c] = f;
      result_.mesh.faces.push_back({first + a, first + (is_mirrored ? c : b), first + (is_mirrored ? b : c)});
    }
  }

  const MeshSource& source_;
  Package package_;
  std::map<std::string, Model> models_;
  std::map<std::string, int> left_out_;  // The key is the type of an object, the value the number of objects left out.
  int shown_ = 0;
  std::size_t flattened_ = 0;
  SlicerVolumes slicer_volumes_;
  std::vector<std::string> hidden_;  // what the author switched off, and how
  bool hides_ranges_ = false;        // Some of it are triangles of an object.
  std::string lattice_or_slices_;    // of an object without triangles
  MeshInUnit result_;
};

}  // namespace

MeshInUnit read_3mf(const MeshSource& source) {
  return ThreeMf(source).read();
}

}  // namespace triskin::mesh
