// SPDX-License-Identifier: GPL-3.0-or-later
#include "off_reader.hpp"

#include <fmt/format.h>

#include <sstream>
#include <utility>

#include "polygon_faces.hpp"
#include "triskin/base/error.hpp"

namespace triskin::geometry {
namespace {

class OffReader {
 public:
  OffReader(const std::string& text, const std::string& file) : text_(text), file_(file) {}

  Mesh read() {
    Mesh mesh;
    std::istringstream line = next("the counts");
    std::string word = line.str();
    if (const std::size_t at = word.find("OFF"); at != std::string::npos) {
      line = std::istringstream(word.substr(at + 3));
      if (word.find_first_not_of(" \t\r", at + 3) == std::string::npos) line = next("the counts");
    }
    const long vertices = count(line, "vertices"), faces = count(line, "faces");
    for (long v = 0; v < vertices; ++v) mesh.vertices.push_back(vertex());
    for (long f = 0; f < faces; ++f) face(mesh);
    return mesh;
  }

 private:
  // A line that is neither empty nor a comment.
  std::istringstream next(const char* what) {
    std::string line;
    while (std::getline(text_, line)) {
      ++number_;
      line.resize(std::min(line.size(), line.find('#')));
      if (line.find_first_not_of(" \t\r") != std::string::npos) return std::istringstream(line);
    }
    fail(fmt::format("the file ends before {}", what));
  }

  long count(std::istringstream& line, const char* what) {
    long n = -1;
    if (!(line >> n) || n < 0 || n > kMost) fail(fmt::format("the number of {} must be 0 … {}", what, kMost));
    return n;
  }

  Vec3 vertex() {
    std::istringstream line = next("its last vertex");
    Vec3 v;
    if (!(line >> v.x() >> v.y() >> v.z())) fail("a vertex must be three numbers");
    return v;
  }

  void face(Mesh& mesh) {
    std::istringstream line = next("its last face");
    const long corners = count(line, "corners");
    std::vector<int> index;
    for (long k = 0; k < corners; ++k) {
      long v = -1;
      if (!(line >> v) || v < 0 || v >= static_cast<long>(mesh.vertices.size()))
        fail("a face names a vertex that does not exist");
      index.push_back(static_cast<int>(v));
    }
    add_polygon(mesh, std::move(index));
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(fmt::format("{}, line {}: {}; repair or export the mesh again", file_, number_, what));
  }

  static constexpr long kMost = 100'000'000;
  std::istringstream text_;
  const std::string& file_;
  int number_ = 0;
};

}  // namespace

Mesh read_off(const std::string& text, const std::string& file) {
  return OffReader(text, file).read();
}

}  // namespace triskin::geometry
