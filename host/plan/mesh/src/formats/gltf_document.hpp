// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "mesh_source.hpp"

namespace triskin::mesh {

/// Gives access to the JSON of a glTF 2.0 file and its buffers and checks every access. Errors of all functions:
/// InputError naming file and place.
class GltfDocument {
 public:
  /// Reads the JSON, and the binary chunk of a GLB. Refuses versions other than 2 and required extensions that this
  /// reader does not support, naming them. `source` must outlive the document.
  explicit GltfDocument(const MeshSource& source);

  [[nodiscard]] const nlohmann::json& root() const { return json_; }
  /// Returns element `index` of the top-level list `list` ("nodes").
  [[nodiscard]] const nlohmann::json& element(const char* list, std::size_t index) const;
  /// Returns a whole number ≥ 0 of an object; `fallback` if the key is missing.
  [[nodiscard]] std::size_t whole(const nlohmann::json& object, const char* key, std::size_t fallback) const;
  /// Does the same for a key that must be present.
  [[nodiscard]] std::size_t whole(const nlohmann::json& object, const char* key) const;
  /// Returns the numbers of a list that must have `n` of them; empty if the key is missing.
  [[nodiscard]] std::vector<double> numbers(const nlohmann::json& object, const char* key, std::size_t n) const;
  /// Returns the numbers of a list of any length; empty if the key is missing.
  [[nodiscard]] std::vector<double> list(const nlohmann::json& object, const char* key) const;
  /// Returns the elements of accessor `index`, which must have `width` components each (1: SCALAR, 3: VEC3, 4: VEC4,
  /// 16: MAT4 of floats). Integers
  /// are normalized if the accessor asks for it (also KHR_mesh_quantization), and sparse values are applied. Cost:
  /// linear.
  [[nodiscard]] std::vector<double> accessor(std::size_t index, std::size_t width);

  [[noreturn]] void fail(const std::string& what) const;

 private:
  struct View {
    const std::string* bytes;
    std::size_t offset, length, stride;
  };
  void read_json(std::string_view text);
  void read_glb();
  void require_known_extensions() const;
  void require_type(const nlohmann::json& accessor, std::size_t index, const char* type) const;
  const std::string& buffer(std::size_t index);
  std::string load(const nlohmann::json& buffer, std::size_t index) const;
  View view(std::size_t index);
  void read_elements(const View& view, std::size_t offset, std::size_t type, bool is_normalized, std::size_t width,
                     std::vector<double>& values) const;
  void put_sparse(const nlohmann::json& sparse, std::size_t type, bool is_normalized, std::size_t width,
                  std::vector<double>& values);

  const MeshSource& source_;
  nlohmann::json json_;
  std::string binary_;  // Only a GLB has a binary chunk.
  bool has_binary_ = false;
  std::vector<std::string> buffers_;
  std::vector<bool> is_loaded_;
};

}  // namespace triskin::mesh
