// SPDX-License-Identifier: GPL-3.0-or-later
#include "three_mf_reader.hpp"

#include <fmt/format.h>
#include <minizip/unzip.h>

#include <Eigen/Geometry>
#include <array>
#include <charconv>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "triskin/base/error.hpp"
#include "triskin/base/index.hpp"
#include "xml_tag.hpp"

namespace triskin::geometry {
namespace {

constexpr const char* kRootModel = "/3D/3dmodel.model";
constexpr std::size_t kMaxBytes = 2'000'000'000, kMaxFaces = 50'000'000;  // of what is unpacked
constexpr int kMaxShown = 1'000'000;                                      // objects, each time that one is shown
constexpr int kMaxDepth = 32;                                             // of components in components

struct UnitRow {
  std::string_view name;
  double mm;
};
constexpr std::array<UnitRow, 6> kUnits{
    {{"micron", 1e-3}, {"millimeter", 1.0}, {"centimeter", 10.0}, {"inch", 25.4}, {"foot", 304.8}, {"meter", 1e3}}};

// An object shown at a place.
struct Shown {
  std::string part, id;
  Eigen::Affine3d place;
};
struct Object {
  std::string name;
  Mesh mesh;
  std::vector<Shown> components;
};
struct Model {
  double unit_mm = 1.0;
  std::map<std::string, Object> objects;  // by id
  std::vector<Shown> build;
};

class PackageReader {
 public:
  PackageReader(const std::filesystem::path& path, ObjectFilter& objects)
      : file_(path.string()), objects_(objects), zip_(unzOpen(path.c_str()), &unzClose) {
    if (!zip_) fail("it is not a package");
  }

  MeshInUnit read() {
    const Model& root = model(kRootModel);
    result_.unit_mm = root.unit_mm;
    for (const Shown& item : root.build) show(item, Eigen::Affine3d::Identity(), objects_.wanted.empty(), 0);
    return std::move(result_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(fmt::format("{}: not a mesh that can be read ({}); repair or export the mesh again", file_, what));
  }

  std::string bytes_of_part(const std::string& part) {
    constexpr int kAnyCase = 2;
    const std::string name = part.substr(part.starts_with('/') ? 1 : 0);
    if (unzLocateFile(zip_.get(), name.c_str(), kAnyCase) != UNZ_OK || unzOpenCurrentFile(zip_.get()) != UNZ_OK)
      fail(fmt::format("its part {} is missing", name.substr(0, 80)));
    std::string bytes;
    std::vector<char> buffer(1U << 16U);
    int got = 0;
    while ((got = unzReadCurrentFile(zip_.get(), buffer.data(), static_cast<unsigned>(buffer.size()))) > 0) {
      bytes.append(buffer.data(), static_cast<std::size_t>(got));
      if (bytes.size() > kMaxBytes) fail("it is too large");
    }
    unzCloseCurrentFile(zip_.get());
    if (got < 0) fail(fmt::format("its part {} is damaged", name.substr(0, 80)));
    return bytes;
  }

  const Model& model(const std::string& part) {
    const auto [entry, is_new] = models_.try_emplace(part);
    if (is_new) read_model(bytes_of_part(part), part, entry->second);
    return entry->second;
  }

  void read_model(std::string_view text, const std::string& part, Model& model) {
    Object* object = nullptr;
    for (std::size_t at = text.find('<'); at != std::string_view::npos; at = text.find('<', at + 1)) {
      const std::string_view inside = text.substr(at + 1, std::min(text.find('>', at), text.size()) - at - 1);
      const std::string_view tag = inside.substr(0, inside.find_first_of(" \t\r\n/"));
      if (tag == "model") model.unit_mm = unit_of(inside);
      if (tag == "object") {
        object = &model.objects[std::string(attribute_of(inside, "id"))];
        object->name = attribute_of(inside, attribute_of(inside, "name").empty() ? "id" : "name");
      }
      if (tag == "item") model.build.push_back(shown(inside, part));
      if (object == nullptr) continue;
      if (tag == "component") object->components.push_back(shown(inside, part));
      if (tag == "vertex")
        object->mesh.vertices.emplace_back(number(inside, "x"), number(inside, "y"), number(inside, "z"));
      if (tag == "triangle")
        object->mesh.faces.push_back({corner(inside, "v1"), corner(inside, "v2"), corner(inside, "v3")});
    }
  }

  [[nodiscard]] double unit_of(std::string_view inside) const {
    const std::string_view unit = attribute_of(inside, "unit");
    if (unit.empty()) return 1.0;
    for (const UnitRow& row : kUnits) {
      if (row.name == unit) return row.mm;
    }
    fail(fmt::format("unknown unit \"{}\"", unit.substr(0, 20)));
  }

  [[nodiscard]] double number_in(std::string_view text) const {
    text.remove_prefix(text.starts_with('+') ? 1 : 0);
    double value = 0.0;
    const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || rest != text.data() + text.size())
      fail(fmt::format("\"{}\" is no number", text.substr(0, 20)));
    return value;
  }
  [[nodiscard]] double number(std::string_view inside, std::string_view name) const {
    return number_in(attribute_of(inside, name));
  }
  [[nodiscard]] int corner(std::string_view inside, std::string_view name) const {
    const double value = number(inside, name);
    if (!(value >= 0.0 && value < 2e9)) fail("a face names a vertex that does not exist");
    return static_cast<int>(value);
  }

  // Twelve numbers: the rows of a matrix that is multiplied from the left by a point (x, y, z, 1).
  [[nodiscard]] Shown shown(std::string_view inside, const std::string& part) const {
    Shown s{std::string(attribute_of(inside, ":path")), std::string(attribute_of(inside, "objectid")),
            Eigen::Affine3d::Identity()};
    if (s.part.empty()) s.part = part;
    std::string_view text = attribute_of(inside, "transform");
    for (int k = 0; k < 12 && !text.empty(); ++k) {
      text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
      const std::string_view word = text.substr(0, text.find_first_of(" \t\r\n"));
      s.place.matrix()(k % 3, k / 3) = number_in(word);
      text.remove_prefix(word.size());
    }
    return s;
  }

  void show(const Shown& item, const Eigen::Affine3d& parent, bool is_in, int depth) {
    if (depth > kMaxDepth || ++shown_ > kMaxShown) fail("its components have no end");
    const Model& in = model(item.part);
    const auto found = in.objects.find(item.id);
    if (found == in.objects.end()) fail(fmt::format("it has no object {}", item.id.substr(0, 20)));
    const Object& object = found->second;
    const Eigen::Affine3d place = parent * item.place;
    is_in = objects_.meets(object.name) || is_in;
    for (const Shown& component : object.components) show(component, place, is_in, depth + 1);
    if (is_in) append(object.mesh, place);
  }

  void append(const Mesh& mesh, const Eigen::Affine3d& place) {
    const int first = static_cast<int>(result_.mesh.vertices.size());
    if (result_.mesh.faces.size() + mesh.faces.size() > kMaxFaces) fail("it is too large");
    for (const Vec3& v : mesh.vertices) result_.mesh.vertices.push_back(place * v);
    for (const auto& f : mesh.faces) {
      for (const int v : f) {
        if (at(v) >= mesh.vertices.size()) fail("a face names a vertex that does not exist");
      }
      result_.mesh.faces.push_back({first + f[0], first + f[1], first + f[2]});
    }
  }

  std::string file_;
  ObjectFilter& objects_;
  std::unique_ptr<void, decltype(&unzClose)> zip_;
  std::map<std::string, Model> models_;  // by part
  int shown_ = 0;
  MeshInUnit result_;
};

}  // namespace

MeshInUnit read_3mf(const std::filesystem::path& path, ObjectFilter& objects) {
  return PackageReader(path, objects).read();
}

}  // namespace triskin::geometry
