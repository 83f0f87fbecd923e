// SPDX-License-Identifier: GPL-3.0-or-later
#include "three_mf_reader.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <array>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "package.hpp"
#include "percent.hpp"
#include "text_numbers.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/index.hpp"
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
};
struct Object {
  std::string name, type;
  Mesh mesh;
  std::vector<Shown> components;
};
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
      if (space == kCore && name == "object") object_ = nullptr;
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
    if (tag.space != kCore) return;
    if (tag.name == "model") return model(tag);
    if (tag.name == "object") return object(tag);
    if (tag.name == "item") return model_.build.push_back(shown(tag));
    if (object_ == nullptr) return;
    if (tag.name == "component") object_->components.push_back(shown(tag));
    if (tag.name == "vertex") object_->mesh.vertices.emplace_back(number(tag, "x"), number(tag, "y"), number(tag, "z"));
    if (tag.name == "triangle")
      object_->mesh.faces.push_back({corner(tag, "v1"), corner(tag, "v2"), corner(tag, "v3")});
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
    Shown s{path.empty() ? part_ : path, std::string(tag.attribute("objectid")), Eigen::Affine3d::Identity()};
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
    for (const Shown& item : root.build) show(item, Eigen::Affine3d::Identity(), source_.objects.wanted.empty(), 0);
    for (const auto& [type, count] : left_out_) {
      source_.notes.push_back(
          fmt::format("{} objects of the type \"{}\" are no part of the body and were left out", count, type));
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

  void show(const Shown& item, const Eigen::Affine3d& parent, bool is_in, int depth) {
    if (depth > kMaxDepth || ++shown_ > kMaxShown) fail("its components have no end");
    const Model& in = model(item.part);
    const auto found = in.objects.find(item.id);
    if (found == in.objects.end()) fail(fmt::format("it has no object {}", item.id.substr(0, 20)));
    const Object& object = found->second;
    const Eigen::Affine3d place = parent * item.place;
    is_in = source_.objects.meets(object.name) || is_in;
    if (object.type != "model" && object.type != "surface" && source_.objects.wanted.empty()) {
      ++left_out_[object.type];
      return;
    }
    for (const Shown& component : object.components) show(component, place, is_in, depth + 1);
    if (is_in) append(object.mesh, place, in.unit_mm / result_.unit_mm);
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
  MeshInUnit result_;
};

}  // namespace

MeshInUnit read_3mf(const MeshSource& source) {
  return ThreeMf(source).read();
}

}  // namespace triskin::mesh
