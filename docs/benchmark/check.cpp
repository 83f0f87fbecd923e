// SPDX-License-Identifier: CC0-1.0
// Checks entries of the open benchmark of skin placement (README.md beside this file has the problem and the format).
//
//   c++ -std=c++17 -O2 check.cpp -o check
//   ./check OUTLINE ENTRY
//
// Prints what holds and ends with 0; ends with 1 when something that the entry claims is not shown, 2 when a file
// cannot be read. Nothing but the standard library is used, and nothing of Triskin.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

namespace {

constexpr double kSide_mm = 30.0, kHeight_mm = 25.980762113533160, kInradius_mm = 8.6602540378443865;
constexpr double kHalfRoot3 = 0.86602540378443865, kSixth_rad = 1.0471975511965976;
// Coordinates stay below 1e5 mm, so a rotation and a distance are wrong by less than 1e-10 mm in doubles.
constexpr double kRounding_mm = 1e-9;
constexpr int kMaxHalvings = 75;
constexpr std::size_t kProofLine = 110;  // letters
constexpr double kCoarse_mm = 60.0;      // in a cell in which points move farther, nothing is refuted yet

struct Point {
  double x = 0.0, y = 0.0;
};
Point operator-(Point a, Point b) {
  return {a.x - b.x, a.y - b.y};
}
Point operator+(Point a, Point b) {
  return {a.x + b.x, a.y + b.y};
}
Point operator*(double s, Point a) {
  return {s * a.x, s * a.y};
}
double cross(Point a, Point b) {
  return a.x * b.y - a.y * b.x;
}
double dot(Point a, Point b) {
  return a.x * b.x + a.y * b.y;
}
double norm(Point a) {
  return std::hypot(a.x, a.y);
}
Point rotated(Point p, double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  return {c * p.x - s * p.y, s * p.x + c * p.y};
}

struct Tile {
  int i = 0, j = 0;
  bool up = false;
  bool operator<(const Tile& other) const { return std::tie(i, j, up) < std::tie(other.i, other.j, other.up); }
  [[nodiscard]] Point centre() const {
    const Point corner{kSide_mm * i + 0.5 * kSide_mm * j, kHeight_mm * j};
    return corner + (up ? Point{0.5 * kSide_mm, kHeight_mm / 3.0} : Point{kSide_mm, 2.0 * kHeight_mm / 3.0});
  }
};

struct Motion {
  double x_mm = 0.0, y_mm = 0.0, angle_rad = 0.0;
};

/// All motions with x, y and angle between these ends.
struct Cell {
  double low[3], high[3];
};

struct Outline {
  std::string name;
  std::vector<std::vector<Point>> rings;
};

struct Entry {
  std::string outline;
  int modules = -1, bound = -1;
  double tolerance_mm = 0.0;
  Point pivot_mm;
  Motion motion;
  std::vector<Tile> tiles;
  std::string proof;  ///< halvings of the motions, README.md
};

// ---- reading ----

[[noreturn]] void refuse(const std::string& file, int line, const std::string& why) {
  throw std::runtime_error(file + ", line " + std::to_string(line) + ": " + why);
}

/// Calls `take(key, rest of the line)` for each line that has more than a comment. The first has to be `format 1`; of
/// the others, `ring`, `tile` and `proof` may be there more than once.
template <typename Take>
void read_lines(const std::string& file, const std::string& format, Take take) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error(file + ": cannot be opened");
  std::string text;
  std::set<std::string> seen;
  for (int number = 1; std::getline(in, text); ++number) {
    std::istringstream line(text.substr(0, text.find('#')));
    std::string key;
    if (!(line >> key)) continue;
    if (seen.empty() != (key == format))
      refuse(file, number, "'" + format + " 1' has to be the first line, and only that");
    if (!seen.insert(key).second && key != "ring" && key != "tile" && key != "proof")
      refuse(file, number, "'" + key + "' is there twice");
    if (!take(key, line)) refuse(file, number, "'" + key + "' is no line of this file, or its words are not right");
    std::string more;
    line.clear();
    if (line >> more) refuse(file, number, "'" + more + "' is too much or no number");
  }
}

bool read_version(std::istringstream& line) {
  int version = 0;
  return line >> version && version == 1;
}

Outline read_outline(const std::string& file) {
  Outline outline;
  read_lines(file, "skin-placement-outline", [&](const std::string& key, std::istringstream& line) {
    if (key == "skin-placement-outline") return read_version(line);
    if (key == "name") return static_cast<bool>(line >> outline.name);
    if (key != "ring") return false;
    std::vector<Point> ring;
    for (Point p; line >> p.x >> p.y;) ring.push_back(p);
    for (const Point& p : ring) {
      if (!(std::abs(p.x) < 1e5 && std::abs(p.y) < 1e5)) return false;
    }
    outline.rings.push_back(ring);
    return ring.size() >= 3;
  });
  if (outline.rings.empty()) throw std::runtime_error(file + ": has no ring");
  return outline;
}

Entry read_entry(const std::string& file) {
  Entry entry;
  read_lines(file, "skin-placement-entry", [&](const std::string& key, std::istringstream& line) {
    if (key == "skin-placement-entry") return read_version(line);
    if (key == "outline") return static_cast<bool>(line >> entry.outline);
    if (key == "modules") return line >> entry.modules && entry.modules >= 0;
    if (key == "bound") return line >> entry.bound && entry.bound >= 0;
    if (key == "tolerance_mm")
      return line >> entry.tolerance_mm && entry.tolerance_mm >= 0.0 && entry.tolerance_mm <= 1.0;
    if (key == "pivot_mm")
      return line >> entry.pivot_mm.x >> entry.pivot_mm.y && std::abs(entry.pivot_mm.x) < 1e5 &&
             std::abs(entry.pivot_mm.y) < 1e5;
    if (key == "motion")
      return line >> entry.motion.x_mm >> entry.motion.y_mm >> entry.motion.angle_rad &&
             std::abs(entry.motion.x_mm) < 1e5 && std::abs(entry.motion.y_mm) < 1e5 &&
             std::abs(entry.motion.angle_rad) < 10.0;
    if (key == "proof") {
      std::string part;
      const bool is_read = static_cast<bool>(line >> part);
      entry.proof += part;
      return is_read;
    }
    if (key != "tile") return false;
    Tile tile;
    std::string way;
    if (!(line >> tile.i >> tile.j >> way) || (way != "up" && way != "down")) return false;
    if (std::abs(tile.i) > 10000 || std::abs(tile.j) > 10000) return false;
    tile.up = way == "up";
    entry.tiles.push_back(tile);
    return true;
  });
  if (entry.modules < 0) throw std::runtime_error(file + ": has no line 'modules'");
  return entry;
}

// ---- geometry ----

/// Returns whether `p` is inside by the even-odd rule. Which side a point on an edge belongs to is not defined; callers
/// ask for such points only where the edge test decides.
bool inside(const Outline& outline, Point p) {
  bool in = false;
  for (const auto& ring : outline.rings) {
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const Point a = ring[k], b = ring[(k + 1) % ring.size()];
      if ((a.y > p.y) == (b.y > p.y)) continue;
      if (p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)) in = !in;
    }
  }
  return in;
}

double distance(Point p, Point a, Point b) {
  const Point along = b - a;
  const double length2 = dot(along, along);
  const double share = length2 > 0.0 ? std::clamp(dot(p - a, along) / length2, 0.0, 1.0) : 0.0;
  return norm(p - a - share * along);
}

/// Returns whether the segment a b meets the open triangle: clips it by the three sides.
bool meets(const Point (&triangle)[3], Point a, Point b) {
  double from = 0.0, to = 1.0;
  for (int k = 0; k < 3; ++k) {
    const Point side = triangle[(k + 1) % 3] - triangle[k];
    const double at_a = cross(side, a - triangle[k]), at_b = cross(side, b - triangle[k]);
    if (at_a <= 0.0 && at_b <= 0.0) return false;
    const double crossing = at_a / (at_a - at_b);
    if (at_a < 0.0) from = std::max(from, crossing);
    if (at_b < 0.0) to = std::min(to, crossing);
  }
  return from < to;
}

/// Returns whether a tile, drawn in by `inset_mm` on each side, lies in the outline under a motion.
bool fits(const Outline& outline, const Tile& tile, const Motion& motion, Point pivot_mm, double inset_mm) {
  const double scale = 1.0 - inset_mm / kInradius_mm;
  const Point centre = tile.centre(), shift{motion.x_mm, motion.y_mm};
  const auto in_outline = [&](Point q) { return rotated(q - shift, -motion.angle_rad) + pivot_mm; };
  Point corners[3];
  for (int k = 0; k < 3; ++k) {
    // Corners follow each other counter-clockwise: that of an upward tile at 210°, 330°, 90° from its centre.
    const double angle_rad = kSixth_rad * (3.5 + 2.0 * k + (tile.up ? 0.0 : 3.0));
    corners[k] = in_outline(centre + scale * 2.0 * kInradius_mm * Point{std::cos(angle_rad), std::sin(angle_rad)});
  }
  if (!inside(outline, in_outline(centre))) return false;
  for (const auto& ring : outline.rings) {
    for (std::size_t k = 0; k < ring.size(); ++k) {
      if (meets(corners, ring[k], ring[(k + 1) % ring.size()])) return false;
    }
  }
  return true;
}

// ---- the bound ----

/// What a part of the motions leaves of one tile: the edges that may cut it.
struct OpenTile {
  Tile tile;
  std::vector<int> edges;
};

/// Tiles that lie in the outline under every motion of a cell, and those that may.
struct Remaining {
  int certain = 0;
  std::vector<OpenTile> open;
  [[nodiscard]] int count() const { return certain + static_cast<int>(open.size()); }
};

/// An edge under the middle motion of a cell: unit direction, and the height of its line over the shift.
struct MovedEdge {
  Point direction;
  double height_mm = 0.0;
};

/// Counts the tiles that may lie in the outline under the motions of a cell. README.md, "The proof of a bound", derives
/// each of its tests; `spare_mm` is by how much an inequality has to hold.
class CellCount {
 public:
  CellCount(const Outline& outline, Point pivot_mm, double spare_mm)
      : outline_(outline), pivot_mm_(pivot_mm), spare_mm_(spare_mm) {
    for (const auto& ring : outline.rings) {
      const std::size_t first = points_.size();
      for (std::size_t k = 0; k < ring.size(); ++k) {
        points_.push_back(ring[k] - pivot_mm);
        next_.push_back(k + 1 < ring.size() ? points_.size() : first);
      }
    }
    for (const Point& p : points_) reach_mm_ = std::max(reach_mm_, norm(p));
  }

  [[nodiscard]] double reach_mm() const { return reach_mm_; }

  /// All tiles that some motion of a cell brings near the outline, each with all edges.
  [[nodiscard]] Remaining everything(const Cell& cell) const {
    Remaining all;
    std::vector<int> edges(points_.size());
    for (std::size_t k = 0; k < edges.size(); ++k) edges[k] = static_cast<int>(k);
    const double radius_mm = reach_mm_ + (cell.high[0] - cell.low[0]) + (cell.high[1] - cell.low[1]) + kSide_mm;
    const int rows = static_cast<int>(radius_mm / kHeight_mm) + 2;
    for (int j = -rows; j <= rows; ++j) {
      for (int i = -2 * rows; i <= 2 * rows; ++i) {
        for (const bool up : {false, true}) {
          if (norm(Tile{i, j, up}.centre()) <= radius_mm) all.open.push_back({{i, j, up}, edges});
        }
      }
    }
    return all;
  }

  /// What a cell leaves of the tiles that a larger one left.
  [[nodiscard]] Remaining narrowed(const Cell& cell, const Remaining& before) {
    move_to(cell);
    if (half_[0] + half_[1] + half_[2] * reach_mm_ > kCoarse_mm) return before;
    Remaining after;
    after.certain = before.certain;
    for (const OpenTile& open : before.open) {
      OpenTile left{open.tile, {}};
      if (is_refuted(open, left)) continue;
      if (left.edges.empty())
        ++after.certain;
      else
        after.open.push_back(std::move(left));
    }
    return after;
  }

 private:
  void move_to(const Cell& cell) {
    for (int k = 0; k < 3; ++k) {
      half_[k] = 0.5 * (cell.high[k] - cell.low[k]);
      middle_[k] = 0.5 * (cell.high[k] + cell.low[k]);
    }
    const double c = std::cos(middle_[2]), s = std::sin(middle_[2]);
    turned_.clear();
    edges_.clear();
    for (const Point& p : points_) turned_.push_back({c * p.x - s * p.y, s * p.x + c * p.y});
    for (std::size_t k = 0; k < turned_.size(); ++k) {
      const Point along = turned_[next_[k]] - turned_[k];
      const Point direction = (1.0 / norm(along)) * along;
      edges_.push_back({direction, cross(direction, turned_[k])});
    }
  }

  /// A demand on the motion, value >= 0. With the turn φ and the shift τ from the middle of the cell, it is
  /// value + (cos φ - 1) · even + sin φ · odd + (fixed + R(φ) turning) · τ.
  struct Demand {
    double value_mm = 0.0, even_mm = 0.0, odd_mm = 0.0;
    Point fixed, turning;
  };
  static Demand sum(const Demand& a, const Demand& b) {
    return {a.value_mm + b.value_mm, a.even_mm + b.even_mm, a.odd_mm + b.odd_mm, a.fixed + b.fixed,
            a.turning + b.turning};
  }
  /// How far a demand gets from its middle value in the cell.
  [[nodiscard]] double change_mm(const Demand& d) const {
    const double turn = half_[2], bend = 0.5 * turn * turn;
    const Point g = d.fixed + d.turning;
    return bend * std::abs(d.even_mm) + turn * std::abs(d.odd_mm) +
           (std::abs(g.x) + turn * std::abs(d.turning.y) + bend * std::abs(d.turning.x)) * half_[0] +
           (std::abs(g.y) + turn * std::abs(d.turning.x) + bend * std::abs(d.turning.y)) * half_[1];
  }
  [[nodiscard]] bool fails(const Demand& d) const { return d.value_mm + change_mm(d) < -spare_mm_; }
  [[nodiscard]] bool holds(const Demand& d) const { return d.value_mm - change_mm(d) > spare_mm_; }

  /// That a point of the outline is not on the inner side of a tile's side.
  [[nodiscard]] Demand beyond(std::size_t point, Point normal, Point centre) const {
    const Point v = turned_[point];
    const double along_mm = dot(normal, v);
    const double inner_mm = along_mm + dot(normal, Point{middle_[0], middle_[1]} - centre) + kInradius_mm;
    return {-inner_mm, -along_mm, -cross(v, normal), -1.0 * normal, {}};
  }
  /// That a corner of a tile is not to the right (sign 1) or left (-1) of an edge.
  [[nodiscard]] Demand beside(const MovedEdge& edge, double sign, Point corner) const {
    const Point e = sign * edge.direction;
    const double cross_mm = cross(e, corner);
    return {cross_mm - sign * edge.height_mm, cross_mm, -dot(e, corner), {}, {e.y, -e.x}};
  }

  /// A way in which an edge can leave a tile alone: all its demands hold.
  struct Way {
    std::array<Demand, 3> demands;
    int count = 0;
    [[nodiscard]] const Demand* begin() const { return demands.data(); }
    [[nodiscard]] const Demand* end() const { return demands.data() + count; }
  };
  struct Ways {
    std::array<Way, 5> ways;
    int count = 0;
    [[nodiscard]] const Way* begin() const { return ways.data(); }
    [[nodiscard]] const Way* end() const { return ways.data() + count; }
  };

  /// Returns whether one of the ways holds throughout the cell; else `ways` are those that are open.
  [[nodiscard]] bool leaves_alone(std::size_t edge, const Tile& tile, Ways& ways) const {
    const Point centre = tile.centre(), shift{middle_[0], middle_[1]};
    const double up = tile.up ? 1.0 : -1.0;
    const Point normals[] = {{0.0, up}, {up * kHalfRoot3, -0.5 * up}, {-up * kHalfRoot3, -0.5 * up}};
    const auto is_done = [&](const Way& way) {
      if (std::all_of(way.begin(), way.end(), [&](const Demand& d) { return holds(d); })) return true;
      if (std::none_of(way.begin(), way.end(), [&](const Demand& d) { return fails(d); }))
        ways.ways[static_cast<std::size_t>(ways.count++)] = way;
      return false;
    };
    for (const Point& normal : normals) {
      if (is_done({{beyond(edge, normal, centre), beyond(next_[edge], normal, centre)}, 2})) return true;
    }
    for (const double sign : {1.0, -1.0}) {
      Way way;
      for (const Point& n : normals)
        way.demands[static_cast<std::size_t>(way.count++)] =
            beside(edges_[edge], sign, centre + 2.0 * kInradius_mm * n - shift);
      if (is_done(way)) return true;
    }
    return false;
  }

  [[nodiscard]] bool is_refuted(const OpenTile& open, OpenTile& left) const {
    const Point arm = open.tile.centre() - Point{middle_[0], middle_[1]};
    const double turn = half_[2];
    const double x_mm = half_[0] + turn * std::abs(arm.y) + 0.5 * turn * turn * std::abs(arm.x);
    const double y_mm = half_[1] + turn * std::abs(arm.x) + 0.5 * turn * turn * std::abs(arm.y);
    std::vector<Ways> narrow;  // edges with one way or two
    for (const int edge : open.edges) {
      const std::size_t from = static_cast<std::size_t>(edge);
      if (distance(arm, turned_[from], turned_[next_[from]]) > 2.0 * kInradius_mm + x_mm + y_mm + spare_mm_) continue;
      Ways ways;
      if (leaves_alone(from, open.tile, ways)) continue;
      left.edges.push_back(edge);
      if (ways.count == 0) return true;
      if (ways.count > 2) continue;
      if (std::any_of(narrow.begin(), narrow.end(), [&](const Ways& w) { return exclude_each_other(w, ways); }))
        return true;
      narrow.push_back(ways);
    }
    // The point of the outline at which the middle motion puts the tile's centre stays in the tile if it moves less
    // than the inradius; without an edge that may cut the tile, any of its points decides.
    if (!left.edges.empty() && std::hypot(x_mm, y_mm) + spare_mm_ >= kInradius_mm) return false;
    return !inside(outline_, rotated(arm, -middle_[2]) + pivot_mm_);
  }

  /// Whether each way of one edge has a demand that contradicts one of each way of the other: their sum fails.
  [[nodiscard]] bool exclude_each_other(const Ways& one, const Ways& other) const {
    const auto contradict = [&](const Way& a, const Way& b) {
      return std::any_of(a.begin(), a.end(), [&](const Demand& p) {
        return std::any_of(b.begin(), b.end(), [&](const Demand& q) {
          return dot(p.fixed + p.turning, q.fixed + q.turning) < -0.5 && fails(sum(p, q));
        });
      });
    };
    return std::all_of(one.begin(), one.end(), [&](const auto& a) {
      return std::all_of(other.begin(), other.end(), [&](const auto& b) { return contradict(a, b); });
    });
  }

  const Outline& outline_;
  Point pivot_mm_;
  double spare_mm_;
  double reach_mm_ = 0.0;
  std::vector<Point> points_;
  std::vector<std::size_t> next_;
  // The middle motion of the cell in question, its half widths, and the outline turned by it.
  double middle_[3] = {}, half_[3] = {};
  std::vector<Point> turned_;
  std::vector<MovedEdge> edges_;
};

/// All motions up to the steps of the grid and 60°, after which it repeats itself, with a little to spare.
constexpr Cell kAllMotions{{0.0, 0.0, 0.0}, {30.0, 25.981, 1.0472}};

Cell half_of(Cell cell, std::size_t axis, bool upper) {
  (upper ? cell.low : cell.high)[axis] = 0.5 * (cell.low[axis] + cell.high[axis]);
  return cell;
}

/// Follows the halvings of a proof, and shows that no more than `bound` tiles are left in each cell.
class ProofCheck {
 public:
  ProofCheck(const Outline& outline, const Entry& entry)
      : count_(outline, entry.pivot_mm, kRounding_mm), entry_(entry) {}

  [[nodiscard]] bool holds() {
    return holds(kAllMotions, count_.everything(kAllMotions), 0) && at_ == entry_.proof.size();
  }
  [[nodiscard]] long cells() const { return cells_; }

 private:
  bool holds(const Cell& cell, const Remaining& before, int depth) {
    if (at_ == entry_.proof.size() || depth > kMaxHalvings) return false;
    const char word = entry_.proof[at_++];
    const Remaining here = count_.narrowed(cell, before);
    if (word == '.') {
      ++cells_;
      return here.count() <= entry_.bound;
    }
    const auto axis = std::string("xya").find(word);
    return axis != std::string::npos && holds(half_of(cell, axis, false), here, depth + 1) &&
           holds(half_of(cell, axis, true), here, depth + 1);
  }

  CellCount count_;
  const Entry& entry_;
  std::size_t at_ = 0;
  long cells_ = 0;
};

/// Finds the halvings of a proof. Its inequalities hold by a hundred times what the check asks, so that a checker
/// with other rounding accepts it as well.
class ProofSearch {
 public:
  ProofSearch(const Outline& outline, const Entry& entry, std::size_t max_length)
      : count_(outline, entry.pivot_mm, 100.0 * kRounding_mm), bound_(entry.bound), max_length_(max_length) {}

  /// The proof, or nothing where it would be longer than asked.
  std::string proof() {
    const Remaining all = count_.narrowed(kAllMotions, count_.everything(kAllMotions));
    return divide(kAllMotions, all, 0) ? proof_ : std::string();
  }

 private:
  bool divide(const Cell& cell, const Remaining& here, int depth) {
    if (proof_.size() >= max_length_ || depth >= kMaxHalvings || here.certain > bound_) return false;
    if (here.count() <= bound_) {
      proof_ += '.';
      return true;
    }
    Remaining best[2];
    std::size_t best_axis = 3;
    double best_value = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double width_mm = (cell.high[axis] - cell.low[axis]) * (axis == 2 ? count_.reach_mm() : 1.0);
      Remaining parts[] = {count_.narrowed(half_of(cell, axis, false), here),
                           count_.narrowed(half_of(cell, axis, true), here)};
      // Each tile less halves the work that a part is expected to need; where none goes, the widest is halved.
      double value = 1e-9 / width_mm;
      for (const Remaining& part : parts)
        value += part.count() <= bound_ ? 0.0 : std::exp2(0.5 * (part.count() - here.count()));
      if (best_axis < 3 && value >= best_value) continue;
      best_axis = axis;
      best_value = value;
      best[0] = std::move(parts[0]);
      best[1] = std::move(parts[1]);
    }
    proof_ += "xya"[best_axis];
    return divide(half_of(cell, best_axis, false), best[0], depth + 1) &&
           divide(half_of(cell, best_axis, true), best[1], depth + 1);
  }

  CellCount count_;
  int bound_;
  std::size_t max_length_;
  std::string proof_;
};

// ---- the claims ----

int check(const Outline& outline, const Entry& entry) {
  int failed = 0;
  const auto say = [&](bool good, const std::string& what) {
    std::cout << (good ? "holds: " : "NOT SHOWN: ") << what << "\n";
    failed += good ? 0 : 1;
  };
  say(entry.outline == outline.name, "the entry is for outline " + outline.name);
  const std::set<Tile> different(entry.tiles.begin(), entry.tiles.end());
  say(different.size() == entry.tiles.size() && static_cast<int>(different.size()) == entry.modules,
      std::to_string(entry.modules) + " different modules are listed");
  long in = 0;
  for (const Tile& t : entry.tiles)
    in += fits(outline, t, entry.motion, entry.pivot_mm, entry.tolerance_mm + kRounding_mm) ? 1 : 0;
  std::ostringstream tolerance;
  tolerance << entry.tolerance_mm;
  say(in == static_cast<long>(entry.tiles.size()), "each lies in the outline (" + std::to_string(in) + " of " +
                                                       std::to_string(entry.tiles.size()) + ", within " +
                                                       tolerance.str() + " mm)");
  if (entry.bound < 0 && entry.proof.empty()) {
    std::cout << "no bound is claimed\n";
    return failed;
  }
  say(entry.modules <= entry.bound, "the bound is not below the modules");
  ProofCheck proof(outline, entry);
  const bool shown = proof.holds();
  say(shown, "no motion has more than " + std::to_string(entry.bound) + " modules (" + std::to_string(proof.cells()) +
                 " cells of motions)");
  if (failed == 0 && entry.modules == entry.bound) std::cout << "optimum: " << entry.modules << " modules\n";
  return failed;
}

/// Prints the lines of the proof of the entry's bound.
int search(const Outline& outline, const Entry& entry, std::size_t max_length) {
  const std::string proof = ProofSearch(outline, entry, max_length).proof();
  for (std::size_t k = 0; k < proof.size(); k += kProofLine)
    std::cout << "proof " << proof.substr(k, kProofLine) << "\n";
  if (proof.empty()) std::cerr << "no proof of at most " << max_length << " letters was found\n";
  return proof.empty() ? 1 : 0;
}

}  // namespace

int main(int count, char** arguments) {
  const std::vector<std::string> words(arguments + 1, arguments + count);
  const bool is_search = words.size() == 4 && words[0] == "--search" && !words[1].empty() && words[1].size() < 10 &&
                         words[1].find_first_not_of("0123456789") == std::string::npos;
  if (!is_search && words.size() != 2) {
    std::cerr << "usage: check OUTLINE ENTRY\n       check --search MAX_LENGTH OUTLINE ENTRY\n";
    return 2;
  }
  try {
    const Outline outline = read_outline(words[words.size() - 2]);
    const Entry entry = read_entry(words.back());
    return is_search ? search(outline, entry, std::stoul(words[1])) : check(outline, entry) == 0 ? 0 : 1;
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 2;
  }
}
