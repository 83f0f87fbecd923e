// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <ostream>
#include <string>
#include <utility>

#include "support/places.hpp"
#include "triskin/mesh/generate.hpp"
#include "triskin/mesh/mesh_io.hpp"

namespace triskin::test {

/// Returns the folder with parts/ and hard/: the variable TRISKIN_DATA, or else the one that CMake was given
/// (TRISKIN_SHARED_DATA). It need not exist.
inline std::filesystem::path data_folder() {
  const char* named = std::getenv("TRISKIN_DATA");
  return named != nullptr ? named : configured_data_folder();
}

/// Returns the reason of a case that is skipped because that folder does not exist; tools/test counts these words.
inline std::string no_data() {
  return "left out without data: " + data_folder().string() + " does not exist (TRISKIN_SHARED_DATA)";
}

/// Provides a mesh file for a test and deletes a generated one at the end.
class CoverFile {
 public:
  explicit CoverFile(std::filesystem::path real) : path_(std::move(real)) {}
  CoverFile(const std::string& name, const design::Mesh& mesh)
      : path_(std::filesystem::temp_directory_path() / (name + "." + std::to_string(::getpid()) + ".obj")),
        is_generated_(true) {
    mesh::write_obj(path_, mesh);
  }
  CoverFile(CoverFile&& other) noexcept
      : path_(std::move(other.path_)), is_generated_(std::exchange(other.is_generated_, false)) {}
  CoverFile& operator=(CoverFile&&) = delete;
  ~CoverFile() {
    std::error_code ignored;
    if (is_generated_) std::filesystem::remove(path_, ignored);
  }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  bool is_generated_ = false;
};

/// Names a generated shape, or a file (without extension) of the data folder's parts/; a generated one also has a size.
struct CoverName {
  std::string name;
  mesh::GenerateOptions options = {};
};
inline void PrintTo(const CoverName& cover, std::ostream* out) {
  *out << cover.name;
}

/// Returns its file; nothing when it is a real cover and there is no data folder. A file that is missing from an
/// existing folder makes the test fail when it is read.
inline std::optional<CoverFile> cover_file(const CoverName& cover) {
  if (const auto shape = mesh::shape_named(cover.name))
    return CoverFile(cover.name, mesh::generate(*shape, cover.options));
  if (!std::filesystem::exists(data_folder())) return std::nullopt;
  return CoverFile(data_folder() / "parts" / (cover.name + ".obj"));
}

/// Makes a name of a test case, which allows no hyphen.
inline std::string case_name(std::string name) {
  std::ranges::replace(name, '-', '_');
  return name;
}

}  // namespace triskin::test
