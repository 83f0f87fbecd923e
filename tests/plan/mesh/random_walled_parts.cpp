// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "block_solid.hpp"
#include "shell_solid.hpp"
#include "walled_parts.hpp"

namespace triskin::testing {
namespace {

using design::Vec3;
using std::numbers::pi;

class Dice {
 public:
  explicit Dice(unsigned seed) : engine_(seed) {}
  // The distributions of the library differ from one to another, the engine does not.
  double number(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_()) / 4294967296.0);
  }
  int count(int low, int high) { return low + static_cast<int>(number(0, high - low + 0.999)); }
  bool chance(double of) { return number(0, 1) < of; }

 private:
  std::mt19937 engine_;
};

// A box of walls of equal thickness, open below, with its top at z = 0; everything under the wall is inside.
struct Cover {
  Vec3 size;
  double wall;
  BlockSolid solid;

  Cover(Dice& d, double min_depth, double max_depth, double step = 1e9)
      : size(std::round(d.number(90, 200)), std::round(d.number(80, 150)), std::round(d.number(min_depth, max_depth))),
        wall(0.1 * d.count(10, 35)),
        solid(step) {
    solid.add({0, 0, -size.z()}, {size.x(), size.y(), 0});
    solid.cut({wall, wall, -size.z() - 1.0}, {size.x() - wall, size.y() - wall, -wall});
  }
  // Ribs stand on the inner side of the top.
  void add_ribs(Dice& d, double pitch, double thickness) {
    const double foot = -wall - d.number(3, std::max(3.5, 0.7 * (size.z() - wall)));
    for (double x = pitch; x < size.x() - wall - 2 * thickness; x += pitch)
      solid.add({x, wall, foot}, {x + thickness, size.y() - wall, -wall});
    for (double y = pitch; y < size.y() - wall - 2 * thickness; y += pitch)
      solid.add({wall, y, foot}, {size.x() - wall, y + thickness, -wall});
  }
  void add_bosses(Dice& d, int count) {
    for (int k = 0; k < count; ++k) {
      const double x = d.number(12, size.x() - 12), y = d.number(12, size.y() - 12);
      const double foot = -wall - d.number(4, std::max(4.5, size.z() - wall - 1.0));
      solid.add({x - 4, y - 4, foot}, {x + 4, y + 4, -wall});
      solid.cut({x - 1.5, y - 1.5, foot - 1}, {x + 1.5, y + 1.5, -wall});
    }
  }
  void engrave(Dice& d, double depth) {
    const double y = d.number(15, size.y() - 30);
    for (double x = 15; x + 24 < size.x(); x += 13) {
      solid.cut({x, y, -depth}, {x + 2, y + 12, 1});
      for (const double up : {0.0, 5.0, 10.0}) solid.cut({x, y + up, -depth}, {x + 8, y + up + 2, 1});
    }
  }
  void pierce(Dice& d, int count) {
    for (int k = 0; k < count; ++k) {
      const double x = d.number(8, size.x() - 8), y = d.number(8, size.y() - 8), r = d.number(1.5, 4);
      solid.cut({x - r, y - r, -wall - 0.01}, {x + r, y + r, 1});
    }
  }
  [[nodiscard]] bool is_at_wall(const Vec3& m) const {
    return m.x() < 1e-6 || m.y() < 1e-6 || m.x() > size.x() - 1e-6 || m.y() > size.y() - 1e-6;
  }
  // The floor of letters is outer, and so is what looks up where nothing of the part is above.
  [[nodiscard]] BlockSolid::SideRule rule(double outer_down_to = 0.0) const {
    const Cover& c = *this;
    return [size = c.size, wall = c.wall, outer_down_to](const Vec3& m, const Vec3& n) {
      if (n.z() > 0.5) return m.z() > -std::max(0.9 * wall, outer_down_to) - 1e-6 ? 1 : -1;
      if (n.z() < -0.5) return m.z() < -size.z() + 1e-6 ? 0 : -1;
      const bool at_wall = m.x() < 1e-6 || m.y() < 1e-6 || m.x() > size.x() - 1e-6 || m.y() > size.y() - 1e-6;
      if (at_wall) return 1;
      return m.z() > -std::max(wall, outer_down_to) ? 0 : -1;
    };
  }
};

BlockSolid::Bend straight() {
  return [](const Vec3& p) { return p; };
}
BlockSolid::Bend lowered(double by, const Vec3& half_turn_about) {
  return [by, half_turn_about](const Vec3& p) {
    return Vec3(p.x(), half_turn_about.y() - p.y(), -half_turn_about.z() - p.z() - by);
  };
}
BlockSolid::Bend round_y(double radius) {
  return [radius](const Vec3& p) {
    const double r = radius + p.z(), a = p.x() / radius;
    return Vec3(r * std::sin(a), p.y(), r * std::cos(a));
  };
}
BlockSolid::Bend dome(double radius) {
  return [radius](const Vec3& p) {
    const Vec3 d = Vec3(std::tan(p.x() / radius), std::tan(p.y() / radius), 1.0).normalized();
    return Vec3((radius + p.z()) * d);
  };
}

void add_plain_tray(WalledPart& p, Dice& d) {
  Cover c(d, 6, 40);
  if (d.chance(0.5)) c.pierce(d, d.count(1, 6));
  c.solid.append_to(p, straight(), c.rule());
}
void add_ribbed_tray(WalledPart& p, Dice& d) {
  Cover c(d, 10, 45, 8);
  c.add_ribs(d, d.number(18, 45), d.number(1, 2));
  c.add_bosses(d, d.count(0, 4));
  c.solid.append_to(p, straight(), c.rule());
}
void add_engraved_tray(WalledPart& p, Dice& d) {
  Cover c(d, 8, 35);
  c.engrave(d, d.number(0.3, 0.6) * c.wall);
  c.add_bosses(d, d.count(1, 5));
  c.solid.append_to(p, straight(), c.rule());
}
void add_honeycomb_tray(WalledPart& p, Dice& d) {
  Cover c(d, 12, 35);
  c.add_ribs(d, d.number(9, 16), d.number(0.8, 1.4));
  c.solid.append_to(p, straight(), c.rule());
}
// The top is sunk within a frame, as for a display or a label: its floor is outside all the same.
void add_recessed_tray(WalledPart& p, Dice& d) {
  Cover c(d, 14, 45);
  const double depth = d.number(1, 0.5 * (c.size.z() - c.wall));
  const double x0 = d.number(0.1, 0.3) * c.size.x(), x1 = d.number(0.6, 0.9) * c.size.x();
  const double y0 = d.number(0.1, 0.3) * c.size.y(), y1 = d.number(0.6, 0.9) * c.size.y();
  c.solid.add({x0 - c.wall, y0 - c.wall, -depth - c.wall}, {x1 + c.wall, y1 + c.wall, -0.5 * c.wall});
  c.solid.cut({x0, y0, -depth}, {x1, y1, 1});
  if (d.chance(0.4)) c.add_bosses(d, 2);
  const double wall = c.wall, bottom = c.size.z();
  const Vec3 size = c.size;
  c.solid.append_to(p, straight(), [=](const Vec3& m, const Vec3& n) {
    const bool in_recess = m.x() > x0 - 1e-6 && m.x() < x1 + 1e-6 && m.y() > y0 - 1e-6 && m.y() < y1 + 1e-6;
    if (n.z() > 0.5) return m.z() > -1e-6 || (in_recess && std::abs(m.z() + depth) < 1e-6) ? 1 : -1;
    if (n.z() < -0.5) return m.z() < -bottom + 1e-6 ? 0 : -1;
    if (m.x() < 1e-6 || m.y() < 1e-6 || m.x() > size.x() - 1e-6 || m.y() > size.y() - 1e-6) return 1;
    if (in_recess && m.z() > -depth) return depth > 2 * wall ? 1 : 0;
    return -1;
  });
}
void add_ring(WalledPart& p, Dice& d) {
  const double radius = d.number(25, 75), wall = d.number(1, 3.5), length = d.number(25, 90);
  BlockSolid b(5, 2 * pi * radius);
  b.add({0, 0, -wall}, {2 * pi * radius, length, 0});
  for (int k = d.count(0, 4); k > 0; --k) {
    const double x = 40.0 * k, y = d.number(8, length - 8);
    b.cut({x - 2, y - 2, -wall - 1}, {x + 2, y + 2, 1});
  }
  b.append_to(p, round_y(radius), [=](const Vec3& m, const Vec3& n) {
    return n.z() > 0.5 && m.z() > -0.1 ? 1 : n.z() < -0.5 ? -1 : 0;
  });
}
void add_half_shell(WalledPart& p, Dice& d) {
  const double radius = d.number(35, 90), wall = d.number(1, 3), turn = d.number(1.6, 3.4);
  const double across = turn * radius, length = d.number(70, 160);
  BlockSolid b(4);
  b.add({0, 0, -wall}, {across, length, 0});
  if (d.chance(0.7)) {
    const double foot = -wall - d.number(3, 9), pitch = d.number(25, 50);
    for (double x = pitch; x < across - 5; x += pitch) b.add({x, 0, foot}, {x + 1.5, length, -wall});
    for (double y = pitch; y < length - 5; y += pitch) b.add({0, y, foot}, {across, y + 1.5, -wall});
  }
  for (int k = d.count(0, 5); k > 0; --k) {
    const double x = d.number(8, across - 8), y = d.number(8, length - 8);
    b.cut({x - 2, y - 2, -wall - 0.01}, {x + 2, y + 2, 1});
  }
  b.append_to(p, round_y(radius), [=](const Vec3& m, const Vec3& n) {
    if (n.z() > 0.5) return m.z() > -0.1 ? 1 : -1;
    if (n.z() < -0.5) return -1;
    return m.z() > -wall ? 0 : -1;
  });
}
void add_dome(WalledPart& p, Dice& d) {
  const double radius = d.number(80, 160), wall = d.number(1, 3), size = d.number(0.8, 1.3) * radius;
  BlockSolid b(4);
  b.add({-size / 2, -size / 2, -wall}, {size / 2, size / 2, 0});
  for (int k = d.count(0, 3); k > 0; --k) {
    const double x = d.number(-0.4, 0.4) * size, y = d.number(-0.4, 0.4) * size;
    b.add({x - 4, y - 4, -wall - d.number(5, 15)}, {x + 4, y + 4, -wall});
  }
  b.append_to(p, dome(radius), [=](const Vec3& m, const Vec3& n) {
    if (n.z() > 0.5) return 1;
    if (n.z() < -0.5) return -1;
    return m.z() > -wall ? 0 : -1;
  });
}
void add_box_with_lid(WalledPart& p, Dice& d) {
  Cover c(d, 30, 70);
  c.solid.append_to(p, straight(), c.rule());
  BlockSolid lid(1e9);
  const double t = c.wall, gap = c.wall + 0.2;
  lid.add({0, 0, -c.size.z() - 0.2 - t}, {c.size.x(), c.size.y(), -c.size.z() - 0.2});
  lid.add({gap, gap, -c.size.z() - 0.2}, {c.size.x() - gap, c.size.y() - gap, -c.size.z() + 3});
  lid.cut({gap + t, gap + t, -c.size.z() - 0.2}, {c.size.x() - gap - t, c.size.y() - gap - t, -c.size.z() + 4});
  lid.append_to(p, straight(), [bottom = c.size.z(), t](const Vec3& m, const Vec3& n) {
    if (n.z() < -0.5) return 1;
    return n.z() > 0.5 && m.z() < -bottom - 0.2 + 0.1 * t ? -1 : 0;
  });
}
void add_two_part_shell(WalledPart& p, Dice& d) {
  Cover c(d, 20, 50);
  c.solid.append_to(p, straight(), c.rule());
  Cover other = c;
  if (d.chance(0.5)) other.pierce(d, 3);
  other.solid.append_to(p, lowered(c.size.z() + 0.3, c.size), other.rule());
}
// The tray is rounded everywhere: half of a superellipsoid, from a dome to nearly a box with fillets.
void add_filleted_tray(WalledPart& p, Dice& d) {
  const Vec3 half(d.number(50, 100), d.number(40, 75), d.number(25, 60));
  const double power = d.number(2.5, 6), end_rad = d.number(1.2, 1.45), wall = d.number(1, 2.5);
  ShellSolid s;
  s.columns = s.rows = 80;
  s.rim_facets = d.chance(0.5) ? 1 : 6;
  s.wall_mm = [wall](double, double) { return wall; };
  s.sheet = [=](double u, double v) {
    const Vec3 way(std::tan((2 * u - 1) * end_rad), std::tan((2 * v - 1) * end_rad), 1);
    const Vec3 scaled = way.cwiseQuotient(half).cwiseAbs();
    const double size =
        std::pow(std::pow(scaled.x(), power) + std::pow(scaled.y(), power) + std::pow(scaled.z(), power), 1 / power);
    return Vec3(way / size);
  };
  s.append_to(p);
}
void add_cap(WalledPart& p, Dice& d) {
  ShellSolid s;
  const double radius = d.number(50, 140), wide = d.number(0.9, 1.5) * radius, wall = d.number(1, 3);
  const double thicker = d.chance(0.3) ? d.number(0.5, 2) : 0.0;
  s.rim_facets = d.chance(0.5) ? 8 : 1;
  s.wall_mm = [=](double u, double) { return wall + thicker * u; };
  s.sheet = [=](double u, double v) { return Vec3(dome(radius)({(u - 0.5) * wide, (v - 0.5) * wide, 0})); };
  s.append_to(p);
}
void add_limb(WalledPart& p, Dice& d) {
  ShellSolid s;
  const double r0 = d.number(28, 50), r1 = d.number(28, 60), length = d.number(80, 180), wall = d.number(1, 3);
  const double bulge = d.number(-12, 15), turn = d.number(1.7, 4.2);
  s.wraps = d.chance(0.35);
  s.rim_facets = d.chance(0.5) ? 6 : 1;
  s.wall_mm = [wall](double, double) { return wall; };
  s.sheet = [=, wraps = s.wraps](double u, double v) {
    const double angle = wraps ? 2 * pi * u : (u - 0.5) * turn;
    const double r = r0 + (r1 - r0) * v + bulge * std::sin(pi * v);
    return Vec3(r * std::sin(angle), length * v, r * std::cos(angle));
  };
  s.append_to(p);
}
// A scan has one sheet, or, of a shell that was scanned all around, two rough ones.
void add_scan(WalledPart& p, Dice& d) {
  const double radius = d.number(40, 90), wave = d.number(0, 6), turn = d.number(1.5, 3.5), length = d.number(100, 200);
  const double rough = d.number(0.01, 0.08);
  if (d.chance(0.5)) {
    add_cap(p, d);
  } else {
    constexpr int kRows = 80;
    p.truth = SideTruth::kNoWall;
    for (int i = 0; i <= kRows; ++i) {
      for (int j = 0; j <= kRows; ++j) {
        const double a = turn * (1.0 * i / kRows - 0.5), y = length * j / kRows, r = radius + wave * std::sin(0.06 * y);
        p.mesh.vertices.emplace_back(r * std::sin(a), y, r * std::cos(a));
      }
    }
    for (int i = 0; i < kRows; ++i) {
      for (int j = 0; j < kRows; ++j) {
        const int a = i * (kRows + 1) + j, b = a + kRows + 1;
        p.mesh.faces.push_back({a, b, b + 1});
        p.mesh.faces.push_back({a, b + 1, a + 1});
        p.side.insert(p.side.end(), 2, 1);
      }
    }
  }
  for (Vec3& v : p.mesh.vertices) v += Vec3(d.number(-rough, rough), d.number(-rough, rough), d.number(-rough, rough));
}
void add_populated_tray(WalledPart& p, Dice& d) {
  Cover c(d, 35, 60);
  c.solid.append_to(p, straight(), c.rule());
  const auto all_inside = [](const Vec3&, const Vec3&) { return -1; };
  BlockSolid board(6), motor(1e9);
  const double m = c.wall + 4;
  board.add({m, m, -c.size.z() / 2 - 1.6}, {c.size.x() - m, c.size.y() - m, -c.size.z() / 2});
  board.append_to(p, straight(), all_inside);
  motor.add({c.size.x() / 2 - 12, c.size.y() / 2 - 10, -c.size.z() / 2 + 2},
            {c.size.x() / 2 + 12, c.size.y() / 2 + 10, -c.wall - 4});
  motor.append_to(p, straight(), all_inside);
}
// Two levels: a part of the top lies lower, with a wall as thick between them.
void add_stepped_tray(WalledPart& p, Dice& d) {
  Cover c(d, 25, 60);
  const double at = d.number(0.35, 0.65) * c.size.x(), down = d.number(0.25, 0.6) * c.size.z(), w = c.wall;
  c.solid.add({at - w, 0, -c.size.z()}, {c.size.x(), c.size.y(), 0});
  c.solid.cut({at, -1, -down}, {c.size.x() + 1, c.size.y() + 1, 1});
  c.solid.cut({at - 1.1 * w, w, -c.size.z() - 1}, {c.size.x() - w, c.size.y() - w, -down - w});
  c.solid.cut({w, w, -c.size.z() - 1}, {at - w, c.size.y() - w, -w});
  const Vec3 size = c.size;
  c.solid.append_to(p, straight(), [=](const Vec3& m, const Vec3& n) {
    if (n.z() > 0.5) return m.z() > -1e-6 || (m.x() > at && std::abs(m.z() + down) < 1e-6) ? 1 : -1;
    if (n.z() < -0.5) return m.z() < -size.z() + 1e-6 ? 0 : -1;
    const bool at_wall = m.x() < 1e-6 || m.y() < 1e-6 || m.x() > size.x() - 1e-6 || m.y() > size.y() - 1e-6;
    return at_wall || (n.x() > 0.5 && std::abs(m.x() - at) < 1e-6 && m.z() > -down) ? 1 : -1;
  });
}

struct Kind {
  const char* name;
  void (*add)(WalledPart&, Dice&);
};
constexpr std::array<Kind, kRandomKinds> kKinds{{{"plain_tray", add_plain_tray},
                                                 {"ribbed_tray", add_ribbed_tray},
                                                 {"engraved_tray", add_engraved_tray},
                                                 {"honeycomb_tray", add_honeycomb_tray},
                                                 {"recessed_tray", add_recessed_tray},
                                                 {"ring", add_ring},
                                                 {"half_shell", add_half_shell},
                                                 {"dome", add_dome},
                                                 {"box_with_lid", add_box_with_lid},
                                                 {"two_part_shell", add_two_part_shell},
                                                 {"filleted_tray", add_filleted_tray},
                                                 {"cap", add_cap},
                                                 {"limb", add_limb},
                                                 {"scan", add_scan},
                                                 {"populated_tray", add_populated_tray},
                                                 {"stepped_tray", add_stepped_tray}}};

}  // namespace

WalledPart random_walled_part(int kind, unsigned seed) {
  const Kind& k = kKinds.at(static_cast<std::size_t>(kind));
  WalledPart part;
  part.name = fmt::format("{}_{}", k.name, seed);
  Dice dice(1'000U * seed + static_cast<unsigned>(kind));
  k.add(part, dice);
  return part;
}

}  // namespace triskin::testing
