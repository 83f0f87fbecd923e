// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/geometry/mesh_io.hpp"

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <assimp/Importer.hpp>
#include <cctype>
#include <cmath>
#include <cstring>

#include "clean.hpp"
#include "isolated.hpp"
#include "off_reader.hpp"
#include "ply_reader.hpp"
#include "text_readers.hpp"
#include "triskin/host/error.hpp"
#include "triskin/host/files.hpp"

namespace triskin::geometry {
namespace {

constexpr double kSmallestPart_mm = 20.0;
constexpr double kLargestGuess_mm = 3000.0;  // without a unit
constexpr double kLargestPart_mm = 5000.0;

// COLLADA states its unit; assimp hands it over as a scene or root property. Other formats have none.
// 0: none.
double file_scale(const aiScene& scene) {
  double metres = 0.0;
  float single = 0.0F;
  if (scene.mMetaData == nullptr) return 0.0;
  if (scene.mMetaData->Get("UnitScaleFactor", metres) && metres > 0.0) return metres * 10.0;
  if (scene.mMetaData->Get("UnitScaleFactor", single) && single > 0.0F) return static_cast<double>(single) * 10.0;
  return 0.0;
}

void collect(const aiScene& scene, const aiNode& node, const aiMatrix4x4& parent, Mesh& out) {
  const aiMatrix4x4 transform = parent * node.mTransformation;
  for (unsigned m = 0; m < node.mNumMeshes; ++m) {
    const aiMesh& part = *scene.mMeshes[node.mMeshes[m]];
    const int base = static_cast<int>(out.vertices.size());
    for (unsigned v = 0; v < part.mNumVertices; ++v) {
      const aiVector3D p = transform * part.mVertices[v];
      out.vertices.emplace_back(static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z));
    }
    for (unsigned f = 0; f < part.mNumFaces; ++f) {
      const aiFace& face = part.mFaces[f];
      if (face.mNumIndices != 3) continue;  // points and lines carry no surface
      out.faces.push_back({base + static_cast<int>(face.mIndices[0]), base + static_cast<int>(face.mIndices[1]),
                           base + static_cast<int>(face.mIndices[2])});
    }
  }
  for (unsigned c = 0; c < node.mNumChildren; ++c) collect(scene, *node.mChildren[c], transform, out);
}

void require_finite(const std::filesystem::path& path, const Mesh& mesh) {
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (!mesh.vertices[v].allFinite()) {
      throw InputError(
          fmt::format("{}: vertex {} is not a finite point; repair or export the mesh again", path.string(), v));
    }
  }
}

// Without a unit from the person or the file, a size that no part has is a question.
void require_size(const std::filesystem::path& path, const Mesh& mesh, bool unit_is_known) {
  const double size_mm = diagonal_of(mesh);
  if (size_mm < kSmallestPart_mm) {
    const bool metres = 1000.0 * size_mm <= kLargestGuess_mm;
    throw InputError(
        fmt::format("{}: the mesh is only {:.3g} mm across, no module of 30 mm fits; are its numbers {}? Then pass "
                    "{} (--unit m or --unit cm)",
                    path.string(), size_mm, metres ? "metres" : "centimetres", metres ? "--unit m" : "--unit cm"));
  }
  if (size_mm > kLargestPart_mm) {
    throw InputError(
        fmt::format("{}: the mesh is {:.3g} m across, larger than a body part (5 m); check its unit (--unit mm|cm|m)",
                    path.string(), size_mm / 1000.0));
  }
  if (size_mm > kLargestGuess_mm && !unit_is_known) {
    throw InputError(
        fmt::format("{}: the mesh is {:.3g} m across if its numbers are millimetres; are they? Then pass "
                    "--unit mm",
                    path.string(), size_mm / 1000.0));
  }
}

std::string extension_of(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

bool is_off(const std::filesystem::path& path, const std::string& bytes) {
  return extension_of(path) == ".off" || bytes.starts_with("OFF") || bytes.starts_with("COFF") ||
         bytes.starts_with("NOFF");
}

// What the child process hands over: scale, counts, vertices, faces; or a message.
template <class T>
void put(std::string& out, const T* values, std::size_t n) {
  if (n > 0) out.append(reinterpret_cast<const char*>(values), n * sizeof(T));
}

std::string library_answer(const std::filesystem::path& path) {
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(path.string(), aiProcess_Triangulate);
  if (scene == nullptr || scene->mRootNode == nullptr) return std::string("!") + importer.GetErrorString();
  Mesh mesh;
  collect(*scene, *scene->mRootNode, aiMatrix4x4(), mesh);
  const double scale = file_scale(*scene);
  const std::array<std::size_t, 2> counts{mesh.vertices.size(), mesh.faces.size()};
  std::string out = "m";
  put(out, &scale, 1);
  put(out, counts.data(), 2);
  put(out, mesh.vertices.data(), mesh.vertices.size());
  put(out, mesh.faces.data(), mesh.faces.size());
  return out;
}

// The library crashes, aborts or never returns on some damaged files (seen with 5.2.5: OFF, PLY, OBJ), so it works in a
// process of its own.
void read_with_library(const std::filesystem::path& path, std::size_t size, MeshFile& file) {
  const auto answer = run_isolated([&] { return library_answer(path); }, static_cast<unsigned>(1 + size / 500'000));
  const auto damaged = [&](const std::string& why) {
    throw InputError(fmt::format("{}: not a mesh that can be read ({}); give OBJ, STL, PLY, OFF, DAE, glTF, GLB or 3MF",
                                 path.string(), why));
  };
  if (!answer || answer->empty()) return damaged("the file is damaged");
  if (answer->front() == '!') return damaged(answer->substr(1));
  const char* at = answer->data() + 1;
  const auto take = [&](auto* values, std::size_t n) {
    const std::size_t bytes = n * sizeof(*values);
    if (bytes > 0) std::memcpy(values, at, bytes);
    at += bytes;
  };
  std::array<std::size_t, 2> counts{};
  double scale = 0.0;
  take(&scale, 1);
  const std::string extension = extension_of(path);
  if (extension == ".gltf" || extension == ".glb") scale = 1000.0;  // both are in metres by their standard
  file.report.unit_from_file = scale > 0.0;
  if (scale > 0.0) file.report.scale_to_mm = scale;
  take(counts.data(), 2);
  file.mesh.vertices.resize(counts[0]);
  file.mesh.faces.resize(counts[1]);
  for (Vec3& v : file.mesh.vertices) take(v.data(), 3);
  take(file.mesh.faces.data(), counts[1]);
  for (const auto& f : file.mesh.faces) {
    for (const int v : f) {
      if (v < 0 || static_cast<std::size_t>(v) >= counts[0])
        return damaged("a face names a vertex that does not exist");
    }
  }
}

}  // namespace

double scale_of(LengthUnit unit) {
  if (unit == LengthUnit::kMetre) return 1000.0;
  return unit == LengthUnit::kCentimetre ? 10.0 : 1.0;
}

MeshFile read_mesh(const std::filesystem::path& path, std::optional<LengthUnit> unit) {
  const std::string bytes = read_file(path);  // names the file when it cannot be read
  if (bytes.empty()) throw InputError(fmt::format("{}: the file is empty", path.string()));
  MeshFile file;
  const std::string extension = extension_of(path);
  if (is_off(path, bytes)) {
    file.mesh = read_off(bytes, path.string());
  } else if (extension == ".obj") {
    file.mesh = read_obj(bytes, path.string());
  } else if (extension == ".stl") {
    file.mesh = is_binary_stl(bytes) ? read_binary_stl(bytes) : read_text_stl(bytes, path.string());
  } else if (extension == ".ply") {
    file.mesh = read_ply(bytes, path.string());
  } else {
    read_with_library(path, bytes.size(), file);
  }
  if (unit) file.report.scale_to_mm = scale_of(*unit);
  require_finite(path, file.mesh);
  for (Vec3& v : file.mesh.vertices) v *= file.report.scale_to_mm;
  clean(file.mesh, file.report);
  if (file.mesh.faces.empty()) throw InputError(fmt::format("{}: no triangle with an area in it", path.string()));
  require_size(path, file.mesh, unit.has_value() || file.report.unit_from_file);
  return file;
}

Mesh read_obj_group(const std::filesystem::path& path, const std::string& group, double scale_to_mm) {
  if (extension_of(path) != ".obj")
    throw InputError(fmt::format("{}: only OBJ files have named groups; give faces, a sphere or a box", path.string()));
  std::set<std::string> names;
  Mesh mesh = read_obj(read_file(path), path.string(), group, names);
  if (!names.contains(group)) {
    throw InputError(names.empty() ? fmt::format("{}: has no group \"{}\", nor any other", path.string(), group)
                                   : fmt::format("{}: has no group \"{}\"; it has {}", path.string(), group,
                                                 fmt::join(names, ", ")));
  }
  for (Vec3& v : mesh.vertices) v *= scale_to_mm;
  return mesh;
}

void write_obj(const std::filesystem::path& path, const Mesh& mesh) {
  std::string text = "# triskin, mm\n";
  for (const Vec3& v : mesh.vertices) text += fmt::format("v {} {} {}\n", v.x(), v.y(), v.z());
  for (const auto& f : mesh.faces) text += fmt::format("f {} {} {}\n", f[0] + 1, f[1] + 1, f[2] + 1);
  write_output(path, text);
}

}  // namespace triskin::geometry
