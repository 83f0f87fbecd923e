// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/exports/skingui.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>
#include <sstream>

#include "triskin/base/error.hpp"
#include "triskin/base/text_file.hpp"
#include "triskin/design/json_value.hpp"

namespace triskin::exports {
namespace {

// Edge neighbours are drawn 18.5 apart, rounded to whole units; the next nearest are 32 apart.
constexpr double kNearest_mm = 15.0, kFarthest_mm = 22.0;
constexpr double kTurn_rad = 35.0 * std::numbers::pi / 180.0;  // Drawn directions are wrong by at most this angle.

struct Drawn {
  int id = 0;
  double x = 0.0, y = 0.0;
  int board = -1;
};

std::vector<Drawn> read_ini(const std::string& text, const std::string& file) {
  std::vector<Drawn> drawn;
  std::istringstream lines(text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    if (kind.rfind("triangle", 0) != 0) continue;
    Drawn d;
    if (!(words >> d.id >> d.x >> d.y) || !std::isfinite(d.x) || !std::isfinite(d.y)) {
      throw InputError(fmt::format("{} line {}: expected \"{} id x y orientation …\"", file, number, kind));
    }
    d.board = d.id / 16;  // Each board has sixteen consecutive numbers.
    drawn.push_back(d);
  }
  return drawn;
}

std::string names_in(const design::JsonValue& parts) {
  std::string names;
  for (const auto& [name, value] : parts.raw().items()) names += (names.empty() ? "" : ", ") + name;
  return names;
}

std::vector<Drawn> read_collection(const std::string& text, const std::string& file, const std::string& part) {
  const nlohmann::json document = design::parse_json(text, file);
  const design::JsonValue parts = design::JsonValue(document, file)["ini_2d"];
  if (!parts.raw().is_object()) parts.fail("must be an object of parts");
  if (!parts.raw().contains(part))
    throw InputError(fmt::format("{}: no part \"{}\"; there are {}", file, part, names_in(parts)));
  const design::JsonValue triangles = parts[part.c_str()]["triangles"];
  std::vector<Drawn> drawn;
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    const design::JsonValue t = triangles.at(k);
    Drawn d{t["id"].integer(0, 0xFFFF), t["x"].number(), t["y"].number(), -1};
    if (t.raw().contains("board_index")) d.board = t["board_index"].integer(0, 0xFFFF);
    drawn.push_back(d);
  }
  return drawn;
}

double turn(double angle) {
  return std::remainder(angle, 2.0 * std::numbers::pi);
}

// Places each group of joined triangles on the lattice, from its first triangle outwards.
class Layer {
 public:
  Layer(const std::vector<Drawn>& drawn, const std::string& file)
      : drawn_(drawn), file_(file), near_(drawn.size()), place_(drawn.size()), side0_(drawn.size()) {
    for (std::size_t a = 0; a < drawn.size(); ++a) {
      for (std::size_t b = 0; b < drawn.size(); ++b) {
        const double d = std::hypot(drawn[a].x - drawn[b].x, drawn[a].y - drawn[b].y);
        if (a != b && d >= kNearest_mm && d <= kFarthest_mm) near_[a].push_back(b);
        if (a < b && d < kNearest_mm)
          fail(a, fmt::format("lies {:.1f} mm from triangle {}: they overlap", d, drawn[b].id));
      }
    }
  }

  design::ModuleList run() {
    design::ModuleList list;
    list.tiles.resize(drawn_.size());
    list.graph.nodes.resize(drawn_.size());
    std::vector<bool> laid(drawn_.size(), false);
    int island = 0;
    for (std::size_t first = 0; first < drawn_.size(); ++first) {
      if (laid[first]) continue;
      lay(first, island++, laid, list);
    }
    for (std::size_t k = 0; k < drawn_.size(); ++k) {
      list.ids.push_back(drawn_[k].id);
      list.tiles[k] = place_[k];
      list.graph.nodes[k].center_mm = {drawn_[k].x, drawn_[k].y, 0.0};
    }
    return list;
  }

 private:
  [[noreturn]] void fail(std::size_t k, const std::string& what) const {
    throw InputError(
        fmt::format("{}: triangle {} at ({:g}, {:g}) {}", file_, drawn_[k].id, drawn_[k].x, drawn_[k].y, what));
  }
  [[nodiscard]] double direction(std::size_t from, std::size_t to) const {
    return std::atan2(drawn_[to].y - drawn_[from].y, drawn_[to].x - drawn_[from].x);
  }

  int side_towards(std::size_t from, std::size_t to) const {
    for (int s = 0; s < 3; ++s) {
      if (std::abs(turn(direction(from, to) - side0_[from] - s * 2.0 * std::numbers::pi / 3.0)) <= kTurn_rad) return s;
    }
    fail(from, fmt::format("and triangle {} are near, but not across a side", drawn_[to].id));
  }

  void lay(std::size_t first, int island, std::vector<bool>& laid, design::ModuleList& list) {
    place_[first] = {0, 0, true};
    side0_[first] = near_[first].empty() ? 0.0 : direction(first, near_[first].front());
    std::vector<std::size_t> queue{first};
    laid[first] = true;
    std::map<design::Tile, std::size_t> taken{{place_[first], first}};
    for (std::size_t k = 0; k < queue.size(); ++k) {
      const std::size_t v = queue[k];
      list.graph.nodes[v].island = island;
      for (const std::size_t w : near_[v]) {
        const int s = side_towards(v, w);
        const design::TileSide beyond = design::across(place_[v], s);
        if (!laid[w]) {
          laid[w] = true;
          place_[w] = beyond.tile;
          // Side `beyond.side` faces back, and sides follow counter-clockwise.
          side0_[w] = turn(direction(v, w) + std::numbers::pi - beyond.side * 2.0 * std::numbers::pi / 3.0);
          if (!taken.try_emplace(beyond.tile, w).second)
            fail(w, fmt::format("falls on the tile of triangle {}", drawn_[taken.at(beyond.tile)].id));
          queue.push_back(w);
        } else if (place_[w] != beyond.tile) {
          fail(w, fmt::format("does not fit the lattice of triangle {}", drawn_[v].id));
        }
        list.graph.nodes[v].neighbour[static_cast<std::size_t>(s)] = static_cast<int>(w);
        list.graph.nodes[v].border[static_cast<std::size_t>(s)] = false;
      }
    }
  }

  const std::vector<Drawn>& drawn_;
  const std::string& file_;
  std::vector<std::vector<std::size_t>> near_;
  std::vector<design::Tile> place_;
  std::vector<double> side0_;  // For each module the direction of side 0 is stored.
};

void count_boards(SkinGuiLayout& layout) {
  std::map<int, std::vector<int>> members;
  for (std::size_t k = 0; k < layout.board.size(); ++k) {
    if (layout.board[k] >= 0) members[layout.board[k]].push_back(static_cast<int>(k));
  }
  layout.boards = static_cast<int>(members.size());
  for (const auto& [board, nodes] : members) {
    std::set<int> seen{nodes.front()};
    std::vector<int> queue{nodes.front()};
    while (!queue.empty()) {
      const int v = queue.back();
      queue.pop_back();
      for (const int w : layout.list.graph.nodes[static_cast<std::size_t>(v)].neighbour) {
        if (w >= 0 && layout.board[static_cast<std::size_t>(w)] == board && seen.insert(w).second) queue.push_back(w);
      }
    }
    layout.boards_apart += seen.size() == nodes.size() ? 0 : 1;
  }
}

}  // namespace

SkinGuiLayout read_skingui(const std::filesystem::path& path, const std::string& part) {
  const std::string text = read_text(path), file = path.string();
  const std::vector<Drawn> drawn = part.empty() ? read_ini(text, file) : read_collection(text, file, part);
  if (drawn.empty())
    throw InputError(fmt::format(
        "{}: no triangle; expected lines \"triangle_10pad id x y orientation …\", or name a part of a collection",
        file));
  std::set<int> ids;
  for (const Drawn& d : drawn) {
    if (!ids.insert(d.id).second) throw InputError(fmt::format("{}: triangle {} appears twice", file, d.id));
  }
  SkinGuiLayout layout{Layer(drawn, file).run(), {}, 0, 0};
  for (const Drawn& d : drawn) layout.board.push_back(d.board);
  count_boards(layout);
  return layout;
}

nlohmann::json module_list_json(const design::ModuleList& list) {
  nlohmann::json modules = nlohmann::json::array();
  for (std::size_t k = 0; k < list.ids.size(); ++k) {
    const auto& n = list.graph.nodes[k];
    bool border = false;
    for (std::size_t s = 0; s < 3; ++s) border = border || (n.neighbour[s] < 0 && n.border[s]);
    modules.push_back({{"id", list.ids[k]},
                       {"i", list.tiles[k].i},
                       {"j", list.tiles[k].j},
                       {"up", list.tiles[k].up},
                       {"island", n.island},
                       {"border", border}});
  }
  return {{"modules", std::move(modules)}};
}

}  // namespace triskin::exports
