// SPDX-License-Identifier: GPL-3.0-or-later
#include "dae_reader.hpp"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <array>
#include <assimp/Importer.hpp>
#include <cmath>
#include <cstring>
#include <string_view>
#include <utility>

#include "clean.hpp"
#include "collada_counts.hpp"
#include "isolated.hpp"
#include "triskin/base/error.hpp"
#include "triskin/cad/reader_sandbox.hpp"

namespace triskin::mesh {
namespace {

// For files of 0.1, 5 and 67 MB the whole program needed less than eleven times their size.
constexpr std::uint64_t kSpareMemory_bytes = 256'000'000, kMemoryFactor = 40;

void append_part(const aiMesh& part, const aiMatrix4x4& transform, Mesh& out) {
  const int base = static_cast<int>(out.vertices.size());
  for (unsigned v = 0; v < part.mNumVertices; ++v) {
    const aiVector3D p = transform * part.mVertices[v];
    out.vertices.emplace_back(static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z));
  }
  const bool is_mirrored = aiMatrix3x3(transform).Determinant() < 0.0F;
  for (unsigned f = 0; f < part.mNumFaces; ++f) {
    const aiFace& face = part.mFaces[f];
    if (face.mNumIndices != 3) continue;  // Points and lines carry no surface.
    const auto corner = [&](int k) { return base + static_cast<int>(face.mIndices[k]); };
    out.faces.push_back({corner(0), corner(is_mirrored ? 2 : 1), corner(is_mirrored ? 1 : 2)});
  }
}

// Collects the wanted faces of a scene. Nodes below the wanted one belong to it.
class Collector {
 public:
  Collector(const aiScene& scene, ObjectFilter& objects) : scene_(scene), objects_(objects) {}

  Mesh run() {
    take(*scene_.mRootNode, aiMatrix4x4(), objects_.wanted.empty());
    return std::move(mesh_);
  }

 private:
  // Returns true if the node or one below it has faces.
  bool take(const aiNode& node, const aiMatrix4x4& parent, bool is_in) {
    const aiMatrix4x4 transform = parent * node.mTransformation;
    const std::string name = node.mName.C_Str();
    is_in = is_in || (!objects_.wanted.empty() && name == objects_.wanted);
    bool has_faces = false;
    for (unsigned m = 0; m < node.mNumMeshes; ++m) {
      const aiMesh& part = *scene_.mMeshes[node.mMeshes[m]];
      has_faces = has_faces || part.mNumFaces > 0;
      const bool is_named = objects_.meets(part.mName.C_Str());
      if (is_in || is_named) append_part(part, transform, mesh_);
    }
    for (unsigned c = 0; c < node.mNumChildren; ++c)
      has_faces = take(*node.mChildren[c], transform, is_in) || has_faces;
    if (has_faces) objects_.meets(name);
    return has_faces;
  }

  const aiScene& scene_;
  ObjectFilter& objects_;
  Mesh mesh_;
};

// The child process returns "m", unit, length of the names, names each on a line, mesh; or "!".
std::string library_answer(const std::string& bytes, double unit_mm, ObjectFilter objects) {
  Assimp::Importer importer;
  // RViz and MoveIt read such files in the same way.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene = importer.ReadFileFromMemory(bytes.data(), bytes.size(), aiProcess_Triangulate, "dae");
  if (scene == nullptr || scene->mRootNode == nullptr) return "!";
  Mesh mesh = Collector(*scene, objects).run();
  if (unit_mm > 0.0) {
    // The library converts to metres, but this reader returns the file's numbers.
    for (Vec3& v : mesh.vertices) v *= 1000.0 / unit_mm;
  }
  std::string names;
  for (const std::string& name : objects.names) names += name + '\n';
  const std::size_t length = names.size();
  std::string out = "m";
  out.append(reinterpret_cast<const char*>(&unit_mm), sizeof(unit_mm));
  out.append(reinterpret_cast<const char*>(&length), sizeof(length));
  return out + names + bytes_of(mesh);
}

MeshInUnit taken_from(const std::string& answer, ObjectFilter& objects) {
  MeshInUnit result;
  std::size_t length = 0, at = 1;
  std::memcpy(&result.unit_mm, answer.data() + at, sizeof(result.unit_mm));
  at += sizeof(result.unit_mm);
  std::memcpy(&length, answer.data() + at, sizeof(length));
  at += sizeof(length);
  for (const std::size_t names_end = at + length; at < names_end;) {
    const std::size_t end = answer.find('\n', at);
    objects.names.insert(answer.substr(at, end - at));
    at = end + 1;
  }
  result.mesh = mesh_of(answer.substr(at));
  return result;
}

}  // namespace

// The library crashes, aborts or never returns on some damaged files (seen with 5.2.5: OFF, PLY, OBJ), so it works in a
// process of its own.
MeshInUnit read_dae(const MeshSource& source) {
  const auto damaged = [&](const char* why) {
    return InputError(fmt::format("{}: not a mesh that can be read ({}); repair or export it again", source.name, why));
  };
  const double unit_mm = checked_collada_unit_mm(source);
  // A damaged count of elements makes the library reserve gigabytes.
  const IsolatedLimits limits{static_cast<unsigned>(1 + source.bytes.size() / 500'000),
                              kSpareMemory_bytes + kMemoryFactor * source.bytes.size()};
  const auto read = [&] {
    (void)cad::enter_reader_sandbox();  // `triskin doctor` says where the kernel has none.
    return library_answer(source.bytes, unit_mm, source.objects);
  };
  const auto answer = run_isolated(read, limits);
  if (!answer || answer->empty()) throw damaged("the file is damaged");
  if (answer->front() == '!') throw damaged("its contents are not what the format says");
  if (source.bytes.find("<instance_controller") != std::string::npos)
    source.notes.emplace_back("its skeleton is not applied: meshes are as they were bound");
  MeshInUnit result = taken_from(*answer, source.objects);
  for (const auto& f : result.mesh.faces) {
    for (const int v : f) {
      if (v < 0 || static_cast<std::size_t>(v) >= result.mesh.vertices.size())
        throw damaged("a face names a vertex that does not exist");
    }
  }
  return result;
}

}  // namespace triskin::mesh
