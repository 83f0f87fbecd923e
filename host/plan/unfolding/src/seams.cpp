// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/unfolding/seams.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <queue>
#include <sstream>

#include "triskin/base/error.hpp"
#include "triskin/base/index.hpp"
#include "triskin/base/text_file.hpp"

namespace triskin::unfolding {
namespace {

Vec3 read_point(std::istringstream& words, const std::string& where) {
  Vec3 p = Vec3::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    if (!(words >> p[axis]) || !std::isfinite(p[axis]))
      throw InputError(where + ": a vertex needs three finite numbers, as in `v 10.5 0 -3`");
  }
  return p;
}

std::vector<Vec3> read_line(std::istringstream& words, const std::vector<Vec3>& points, const std::string& where) {
  std::vector<Vec3> line;
  std::string word;
  while (words >> word) {
    long index = 0;
    const char* end = word.data() + word.size();
    const auto [rest, error] = std::from_chars(word.data(), end, index);
    if (error != std::errc{} || (rest != end && *rest != '/'))
      throw InputError(fmt::format("{}: \"{}\" is no vertex number", where, word));
    const auto count = static_cast<long>(points.size());
    const long k = index > 0 ? index - 1 : count + index;
    if (index == 0 || k < 0 || k >= count)
      throw InputError(fmt::format("{}: vertex {} does not exist; {} stand before this line", where, index, count));
    line.push_back(points[static_cast<std::size_t>(k)]);
  }
  if (line.size() < 2) throw InputError(where + ": a line needs two points at least, as in `l 1 2`");
  return line;
}

class EdgeGraph {
 public:
  explicit EdgeGraph(const mesh::Surface& surface) : surface_(surface), from_(surface.mesh().vertices.size()) {
    for (FaceIndex f{0}; f < static_cast<int>(surface.mesh().faces.size()); ++f) {
      for (int s = 0; s < 3; ++s) {
        const VertexIndex a(surface.mesh().faces[at(f)][at(s)]), b(surface.mesh().faces[at(f)][at((s + 1) % 3)]);
        from_[at(a)].push_back({b, {f, s}});
        from_[at(b)].push_back({a, {f, s}});
      }
    }
  }

  [[nodiscard]] VertexIndex nearest(const Vec3& p) const {
    const auto& v = surface_.mesh().vertices;
    return VertexIndex(std::ranges::min_element(v, {}, [&](const Vec3& q) { return (q - p).squaredNorm(); }) -
                       v.begin());
  }

  // Returns an empty path when no edges lead there.
  [[nodiscard]] std::vector<SurfaceEdge> way(VertexIndex from, VertexIndex to) const {
    const auto& v = surface_.mesh().vertices;
    std::vector<double> distance(v.size(), std::numeric_limits<double>::infinity());
    std::vector<Step> before(v.size(), Step{VertexIndex::none(), {}});
    using Item = std::pair<double, VertexIndex>;
    std::priority_queue<Item, std::vector<Item>, std::greater<>> queue;
    distance[at(from)] = 0.0;
    queue.emplace(0.0, from);
    while (!queue.empty() && queue.top().second != to) {
      const auto [d, a] = queue.top();
      queue.pop();
      if (d > distance[at(a)]) continue;
      for (const Step& step : from_[at(a)]) {
        const double next = d + (v[at(step.vertex)] - v[at(a)]).norm();
        if (!(next < distance[at(step.vertex)])) continue;
        distance[at(step.vertex)] = next;
        before[at(step.vertex)] = {a, step.edge};
        queue.emplace(next, step.vertex);
      }
    }
    std::vector<SurfaceEdge> edges;
    for (VertexIndex a = to; a != from; a = before[at(a)].vertex) {
      if (before[at(a)].vertex < 0) return {};
      edges.push_back(before[at(a)].edge);
    }
    return edges;
  }

 private:
  struct Step {
    VertexIndex vertex;
    SurfaceEdge edge;
  };
  const mesh::Surface& surface_;
  std::vector<std::vector<Step>> from_;
};

}  // namespace

SeamLines read_seams(const std::filesystem::path& path, std::optional<mesh::LengthUnit> unit,
                     std::vector<std::string>* notes) {
  const std::string all = read_text(path);
  if (const std::string note = note_of_open_line(all, path.string()); notes != nullptr && !note.empty())
    notes->push_back(note);
  std::istringstream file(all);
  const double scale = mesh::scale_of(unit.value_or(mesh::LengthUnit::kMillimetre));
  SeamLines lines;
  std::vector<Vec3> points;
  std::string text;
  for (int number = 1; std::getline(file, text); ++number) {
    const std::string where = fmt::format("{}:{}", path.string(), number);
    std::istringstream words(text);
    std::string kind;
    words >> kind;
    if (kind == "v") points.push_back(scale * read_point(words, where));
    if (kind == "l") lines.push_back(read_line(words, points, where));
  }
  if (lines.empty())
    throw InputError(
        fmt::format("{}: no line in it; seams are written as OBJ polylines, `l 1 2 3` over `v x y z`", path.string()));
  return lines;
}

std::vector<SurfaceEdge> edges_along(const mesh::Surface& surface, const SeamLines& lines, const std::string& name,
                                     double within_mm) {
  const EdgeGraph graph(surface);
  std::vector<SurfaceEdge> edges;
  for (std::size_t l = 0; l < lines.size(); ++l) {
    VertexIndex before = VertexIndex::none();
    const std::size_t count = edges.size();
    for (std::size_t k = 0; k < lines[l].size(); ++k) {
      const Vec3& p = lines[l][k];
      const VertexIndex vertex = graph.nearest(p);
      const double off = (surface.mesh().vertices[at(vertex)] - p).norm();
      if (!(off <= within_mm)) {
        throw InputError(
            fmt::format("{}: line {}, point {} ({:.2f}, {:.2f}, {:.2f}) lies {:.2f} mm from the nearest vertex of the "
                        "surface, more than {} mm; "
                        "move it to a vertex, or pass the unit of the file",
                        name, l + 1, k + 1, p.x(), p.y(), p.z(), off, within_mm));
      }
      if (before >= 0 && vertex != before) {
        const auto way = graph.way(before, vertex);
        if (way.empty())
          throw InputError(
              fmt::format("{}: line {}: points {} and {} lie on parts of the surface that do not hang together", name,
                          l + 1, k, k + 1));
        edges.insert(edges.end(), way.begin(), way.end());
      }
      before = vertex;
    }
    if (edges.size() == count)
      throw InputError(
          fmt::format("{}: line {} falls on a single vertex of the surface; make it longer than an edge", name, l + 1));
  }
  return edges;
}

}  // namespace triskin::unfolding
