// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include "pages.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/design/module_side.hpp"
#include "triskin/design/outline.hpp"
#include "triskin/design/straps.hpp"
#include "triskin/layout/module.hpp"
#include "triskin/sheet/bill.hpp"

namespace triskin::sheet {
namespace {

using Lines = std::vector<TextLine>;
constexpr std::size_t kLongestLine = 112;  // The unit is bytes; this many characters of 3.1 mm fit on A4.
constexpr std::size_t kBesideCode = 96;    // This many characters fit if a QR code is at the right.
const std::vector<double> kBoxed_mm{6.0};  // The text begins beside a box to tick.

std::vector<std::string> wrapped(const std::string& text, std::size_t longest) {
  std::vector<std::string> lines;
  std::size_t from = 0;
  while (text.size() - from > longest) {
    const std::size_t space = text.rfind(' ', from + longest);
    const std::size_t to = space == std::string::npos || space <= from ? from + longest : space;
    lines.push_back(text.substr(from, to - from));
    from = to + (to == space ? 1 : 0);
  }
  lines.push_back(text.substr(from));
  return lines;
}

void add_title(Lines& lines, const std::string& text) {
  if (!lines.empty()) lines.push_back({LineKind::kGap, {}, {}});
  lines.push_back({LineKind::kTitle, {text}, {}});
}

void add_text(Lines& lines, const std::string& text, std::size_t longest = kLongestLine) {
  for (const auto& line : wrapped(text, longest)) lines.push_back({LineKind::kText, {line}, {}});
}

void add_tick(Lines& lines, const std::string& text) {
  LineKind kind = LineKind::kTick;
  for (const auto& line : wrapped(text, kLongestLine)) {
    lines.push_back({kind, {line}, kBoxed_mm});
    kind = LineKind::kText;
  }
}

// The parts of an island are on consecutive pages.
std::string text_of_pages(const std::vector<int>& pages) {
  if (pages.empty()) return "";
  return pages.size() == 1 ? std::to_string(pages.front()) : fmt::format("{} to {}", pages.front(), pages.back());
}

std::vector<int> pages_of_island(const Plan& plan, int island) {
  std::vector<int> pages;
  for (std::size_t p = 0; p < plan.pages.size(); ++p) {
    for (const IslandPage& i : plan.pages[p].islands) {
      if (i.island == island) pages.push_back(static_cast<int>(p) + 1);
    }
  }
  return pages;
}

int page_of_controller(const Plan& plan, int patch) {
  for (std::size_t p = 0; p < plan.pages.size(); ++p) {
    if (std::ranges::find(plan.pages[p].lines, patch, &TextLine::patch) != plan.pages[p].lines.end())
      return static_cast<int>(p) + 1;
  }
  return 0;
}

// The functions from here on list the parts.

void add_pieces(Lines& lines, const char* what, const char* least, const std::vector<PieceCount>& pieces,
                const std::vector<double>& columns) {
  for (const PieceCount& p : pieces) {
    const std::string length = p.length_mm == 0 ? "no rim to measure to" : fmt::format("{}{} mm", least, p.length_mm);
    lines.push_back({LineKind::kTickRow, {what, length, std::to_string(p.count)}, columns});
  }
}

int total(const std::vector<PieceCount>& pieces) {
  return std::accumulate(pieces.begin(), pieces.end(), 0, [](int sum, const PieceCount& p) { return sum + p.count; });
}

std::string text_of_kind(const design::Design& design, int kind, const std::string& shape) {
  if (design.kinds.empty()) return shape;
  const design::ModuleKind k = design::kind_of(design.kinds, kind);
  return fmt::format("{}: {}{}; {}", k.name, counted(k.taxels, "taxel"),
                     k.dielectric.empty() ? "" : ", " + k.dielectric, shape);
}

void add_parts(Lines& lines, const design::Design& design, const Bill& bill) {
  const std::vector<double> columns{6.0, 76.0, 150.0};
  const auto row = [&](const std::string& what, const std::string& kind, int count) {
    lines.push_back({LineKind::kTickRow, {what, kind, std::to_string(count)}, columns});
  };
  add_title(lines, "Parts");
  lines.push_back({LineKind::kHead, {"part", "kind", "pieces"}, columns});
  const double cut_mm = design.layout.corner_cut_mm;
  const std::string shape =
      cut_mm > 0.0 ? fmt::format("all corners cut by {:g} mm", cut_mm) : "whole triangles, side 30 mm";
  for (std::size_t k = 0; k < bill.modules_by_kind.size(); ++k) {
    if (bill.modules_by_kind[k] > 0 || design.kinds.empty())
      row("modules", text_of_kind(design, static_cast<int>(k), shape), bill.modules_by_kind[k]);
  }
  row("controllers", "", bill.controllers);
  for (std::size_t k = 0; k < 4; ++k) row("line straps", fmt::format("line L{}", k), bill.line_straps[k]);
  for (std::size_t k = 0; k < 4; ++k)
    row("address straps", design::address_strap(static_cast<int>(k)), bill.address_straps[k]);
  add_pieces(lines, "cables to controllers", "at least ", bill.cables, columns);
  add_pieces(lines, "2nd cables", "at least ", bill.second_cables, columns);
  add_pieces(lines, "jumper cables", "", bill.jumpers, columns);
  const int straps = std::accumulate(bill.line_straps.begin(), bill.line_straps.end(), 0) +
                     std::accumulate(bill.address_straps.begin(), bill.address_straps.end(), 0);
  add_text(lines, fmt::format("In all: {}, {} to close, {}, {}, {}.", counted(bill.modules, "module"),
                              counted(straps, "strap"), counted(bill.controllers, "controller"),
                              counted(total(bill.cables), "cable"), counted(total(bill.jumpers), "jumper")));
  add_text(lines,
           fmt::format("Joints: {} to keep, {} whose traces are cut inside a patch, {} whose traces are cut between "
                       "controllers; {}.",
                       bill.kept_joints, bill.cut_joints, bill.apart_joints, counted(bill.slits, "slit")));
  add_text(
      lines,
      "The length of a cable is the straight way from the entry to the nearest point of a rim; add what lies between "
      "the rim and the controller.");
}

// Avoids the text "-0.0".
double tenths(double value) {
  return std::round(value * 10.0) / 10.0 + 0.0;
}

void add_landmarks(Lines& lines, const Plan& plan) {
  const std::vector<double> columns{0.0, 18.0, 120.0};
  add_title(lines, "Landmarks of the part");
  if (plan.landmarks.empty()) add_text(lines, "The design has no surface, so no place on the part can be stated.");
  if (plan.landmarks.empty()) return;
  add_text(lines,
           "Places are measured from these points with calipers or compasses, in a straight line. Find them on the "
           "overview and mark them on the part first.");
  lines.push_back({LineKind::kHead, {"mark", "where", "x, y, z in the frame of the mesh"}, columns});
  for (const Landmark& l : plan.landmarks)
    lines.push_back(
        {LineKind::kRow,
         {l.name, l.where,
          fmt::format("{:.1f}, {:.1f}, {:.1f} mm", tenths(l.at_mm.x()), tenths(l.at_mm.y()), tenths(l.at_mm.z()))},
         columns});
}

// The functions from here on describe the order of work.

void add_preparation(Lines& lines, const design::Design& design, const Plan& plan) {
  add_title(lines, "Order of work: before");
  add_tick(lines,
           "Print all pages at 100 % (no \"fit to page\"). Measure the ruler at the foot of every page: 0 to 100 must "
           "be 100.0 mm within 0.3 mm.");
  add_tick(lines,
           "Read the key on page 2. All drawings of islands are seen from outside, from the side that is touched.");
  add_tick(
      lines,
      "Have ready: the parts of the list (count them), soldering iron, sharp knife, calipers or compasses, adhesive "
      "tape that comes off again, and what fixes modules to this part, for example double-sided film.");
  if (!plan.landmarks.empty())
    add_tick(lines, fmt::format("Mark the landmarks {} to {} of the overview on the part.", plan.landmarks.front().name,
                                plan.landmarks.back().name));
  add_tick(lines, "Cut out the labels. Those of controllers are for the controllers, those of jumpers for both ends.");
  if (design.layout.corner_cut_mm > 0.0)
    add_tick(lines, fmt::format("Cut all three corners off every module, {0:g} mm along each side: long sides of {1:g} "
                                "mm and short ones of {0:g} mm stay.",
                                design.layout.corner_cut_mm, design::kSide_mm - 2.0 * design.layout.corner_cut_mm));
}

// Describes once what is done with every island; the list of islands behind it is ticked off.
void add_island_steps(Lines& lines, const Plan& plan) {
  add_title(lines, "Order of work: each island of the list");
  add_text(lines,
           "1. Lay its modules on the drawing, the side that is touched upwards, each with port A where the arrow is. "
           "Of an island on several pages lay the pages together first, so that equal red crosses coincide.");
  add_text(lines, "2. On every module close the line strap and the address strap that are drawn black, and no other.");
  add_text(lines,
           "3. Join the modules. Keep the joints that are drawn dashed. Cut the traces of the joints that are drawn "
           "with crosses. Cut solid lines through.");
  add_text(lines, "4. Fold each joint by the angle beside it: + away from you, − towards you.");
  if (plan.landmarks.empty()) return;
  add_text(lines,
           "5. Tape it to the part, the side that is touched outwards, by the points P and Q: each goes where it has "
           "the distances of the list. Where two places have them, the overview (page 1) tells which one it is; when P "
           "and Q do not both fit, divide the difference between them.");
}

std::string text_of_anchor(const Anchor& anchor, const design::Design& design, const Plan& plan) {
  std::string text = fmt::format("module {}:", design::number_of(design, anchor.module));
  for (std::size_t k = 0; k < 2; ++k) {
    if (anchor.fix.landmark[k] >= 0)
      text +=
          fmt::format("{} {} {:.1f}", k == 0 ? "" : ",",
                      plan.landmarks[static_cast<std::size_t>(anchor.fix.landmark[k])].name, anchor.fix.distance_mm[k]);
  }
  return text;
}

void add_island_list(Lines& lines, const design::Design& design, const Plan& plan, const std::vector<int>& modules) {
  const bool placed = !plan.landmarks.empty();
  const std::vector<double> columns{6.0, 20.0, 38.0, 62.0, 130.0};
  TextLine head{LineKind::kHead, {"island", "modules", "page"}, columns};
  if (placed) head.cells.insert(head.cells.end(), {"P goes where it has, mm", "Q goes where it has, mm"});
  lines.push_back(std::move(head));
  for (std::size_t island = 0; island < modules.size(); ++island) {
    if (modules[island] == 0) continue;
    TextLine row{LineKind::kTickRow,
                 {std::to_string(island), std::to_string(modules[island]),
                  text_of_pages(pages_of_island(plan, static_cast<int>(island)))},
                 columns};
    for (std::size_t k = 0; k < 2 && placed; ++k)
      row.cells.push_back(text_of_anchor(plan.anchors[island][k], design, plan));
    lines.push_back(std::move(row));
  }
}

// Lists the modules that are bent more than the paper allows.
void add_bends(Lines& lines, const design::Design& design) {
  std::vector<std::pair<double, int>> bends;
  for (std::size_t k = 0; k < design.layout.modules.size(); ++k) {
    const double radius_mm = bend_radius_of_depth(design.layout.modules[k].edge_depth_mm);
    if (radius_mm < kPaperBendRadius_mm) bends.emplace_back(radius_mm, static_cast<int>(k));
  }
  if (bends.empty()) return;
  std::ranges::sort(bends);
  constexpr std::size_t kMaxNamed = 12;
  std::string text;
  for (std::size_t k = 0; k < std::min(kMaxNamed, bends.size()); ++k)
    text += fmt::format("{}{} ({})", k == 0 ? "" : ", ", design::number_of(design, bends[k].second),
                        bend_text(bends[k].first));
  if (bends.size() > kMaxNamed) text += ", …";
  add_text(lines,
           fmt::format("Modules bent to a radius of less than {:.0f} mm, which is written in red (mm): {}; {} in all. "
                       "Check that the board and its solder joints can take this bend.",
                       kPaperBendRadius_mm, text, bends.size()));
}

// Lists the controllers whose last modules have too little supply.
void add_supply(Lines& lines, const design::Design& design, const Plan& plan) {
  for (std::size_t p = 0; p < design.patches.size(); ++p) {
    std::vector<int> weak;
    for (const design::RoutedModule& m : design.patches[p].modules) {
      if (plan.supply_v[static_cast<std::size_t>(m.node)] < plan.supply.needed_v()) weak.push_back(m.node);
    }
    if (weak.empty()) continue;
    add_text(lines,
             fmt::format("Controller {}: modules {} get less than {:.2f} V, which is written in red. Lead supply and "
                         "ground to the last of them by a second pair of wires.",
                         p, fmt::join(design::numbers_of(design, weak), ", "), plan.supply.needed_v()));
  }
}

void add_jumpers(Lines& lines, const design::Design& design, const Plan& plan) {
  if (design.layout.jumpers.empty()) return;
  add_title(lines, "Order of work: jumpers");
  for (const design::Jumper& j : design.layout.jumpers) {
    const auto end = [&](std::size_t e) {
      const auto module = static_cast<std::size_t>(j.node[e]);
      return fmt::format("module {} port {} (page {})", design::number_of(design, j.node[e]),
                         port_at(j.side[e], plan.wiring[module].routed.rotation), plan.page_of_module[module]);
    };
    add_tick(lines, fmt::format("{}: {} of {:.0f} mm from {} to {}.", design::jumper_name(design, j),
                                design::kJumperKindNames.name(j.kind), std::ceil(j.length_mm - 1e-9), end(0), end(1)));
  }
}

void add_connecting(Lines& lines, const design::Design& design, const Plan& plan) {
  add_title(lines, "Order of work: controllers");
  for (const layout::PatchIndex p : design::patches_of(design)) {
    const int entry = design.patches[static_cast<std::size_t>(p)].entry;
    add_tick(lines, fmt::format("Controller {}: plug its cable into port A of module {} (page {}; table on page {}).",
                                p, design::number_of(design, entry),
                                plan.page_of_module.at(static_cast<std::size_t>(entry)), page_of_controller(plan, p)));
  }
  add_tick(
      lines,
      "Any controller may take any of these places: flash finds out which modules hang on which one, and says what to "
      "do where patches are alike. Connect all to power and to the computer. LINK is can:IFACE for a CAN interface, "
      "usb or hid for USB; triskin list names what is attached.");
  add_tick(lines, "See whether all answer: triskin discover --link LINK");
  add_tick(lines, "Write the tables into the controllers: triskin flash DESIGN --link LINK");
  add_tick(lines,
           "Ask the patch whether it is the design: triskin verify DESIGN --link LINK --touch. Instead of DESIGN the "
           "text of a QR code does, in the folder that holds the design file. Each finding names the module and the "
           "remedy; it is mended now, while nothing is fixed.");
}

void add_fixing(Lines& lines) {
  add_title(lines, "Order of work: fixing");
  add_tick(
      lines,
      "Fix one island after the other in its place, and lead the cables so that no module is bent by them. Nothing "
      "may lie over the taxels but the dielectric of the skin.");
  add_tick(lines, "Verify once more: triskin verify DESIGN --link LINK --touch");
}

Lines work_lines(const design::Design& design, const Plan& plan) {
  Lines lines;
  add_preparation(lines, design, plan);
  std::vector<int> modules(plan.anchors.size());
  for (const auto& m : design.layout.modules) ++modules[static_cast<std::size_t>(m.island)];
  add_island_steps(lines, plan);
  add_bends(lines, design);
  add_supply(lines, design, plan);
  add_island_list(lines, design, plan, modules);
  add_title(lines, "Order of work: on the part");
  add_tick(lines,
           "Look at all seams. Sides with the same mark m0, m1, … are opposite each other; beside it is the gap. "
           "Where it is another by more than 1 mm, or modules overlap, move the island that fits its points worse.");
  add_jumpers(lines, design, plan);
  add_connecting(lines, design, plan);
  add_fixing(lines);
  return lines;
}

// The functions from here on make the tables of the controllers.

void add_entry(Lines& lines, const design::Design& design, const Plan& plan, int module, int side,
               const std::string& what) {
  const auto& m = design.layout.modules.at(static_cast<std::size_t>(module));
  const int rotation = plan.wiring[static_cast<std::size_t>(module)].routed.rotation;
  const design::Vec3 at = design::middle_of_side(m, side);
  add_text(lines,
           fmt::format("{}: module {}, port {} (page {}). The middle of this side lies at {}.", what,
                       design::number_of(design, module), port_at(side, rotation),
                       plan.page_of_module[static_cast<std::size_t>(module)],
                       text_of(fix_of(plan.landmarks, at), plan.landmarks)),
           kBesideCode);
}

// Lists the modules of each kind, if there are several.
void add_kinds(Lines& lines, const design::Design& design, const design::Patch& patch) {
  for (std::size_t k = 0; !design.kinds.empty() && k <= design.kinds.kinds.size(); ++k) {
    std::vector<int> ids;
    for (const auto& m : patch.modules) {
      if (design.layout.modules[static_cast<std::size_t>(m.node)].kind == static_cast<int>(k)) ids.push_back(m.node);
    }
    if (!ids.empty())
      add_text(lines,
               fmt::format("Kind {}: {} {}.", design::kind_of(design.kinds, static_cast<int>(k)).name,
                           noun_after(ids.size() == 1, "module"), fmt::join(design::numbers_of(design, ids), ", ")));
  }
}

Lines controller_lines(const design::Design& design, const Plan& plan, int p) {
  const auto& patch = design.patches[static_cast<std::size_t>(p)];
  const std::vector<double> columns{6.0, 20.0, 31.0, 41.0, 74.0, 110.0, 150.0};
  Lines lines;
  lines.push_back(
      {LineKind::kTitle,
       {fmt::format("Controller {} (node address {})", p, design::node_address_of(design, layout::PatchIndex{p}))},
       {},
       p});
  for (const auto& m : patch.modules) {
    if (m.parent < 0) add_entry(lines, design, plan, m.node, m.rotation, "Cable");
  }
  if (patch.second_entry >= 0)
    add_entry(lines, design, plan, patch.second_entry, patch.second_entry_side, "Second cable");
  lines.push_back({LineKind::kGap, {}, {}});
  lines.push_back(
      {LineKind::kHead, {"module", "page", "line", "address strap", "port A", "port B", "port C"}, columns});
  for (const auto& m : patch.modules) {
    const auto id = static_cast<std::size_t>(m.node);
    TextLine row{LineKind::kTickRow,
                 {fmt::format("{}", design::number_of(design, m.node)), std::to_string(plan.page_of_module[id]),
                  fmt::format("L{}", m.line), design::address_strap(m.address)},
                 columns};
    for (int port = 0; port < 3; ++port)
      row.cells.push_back(text_of(plan.sides.of[id][static_cast<std::size_t>((port + m.rotation) % 3)], design, plan));
    lines.push_back(std::move(row));
  }
  lines.push_back({LineKind::kGap, {}, {}});
  add_kinds(lines, design, patch);
  return lines;
}

double height_of(const Lines& lines) {
  double sum_mm = 0.0;
  for (const TextLine& line : lines) sum_mm += height_mm(line.kind);
  return sum_mm;
}

double room_of(Paper paper) {
  return text_size_mm(paper).y() - 2.0 * kMargin_mm - kHead_mm - kFoot_mm;
}

// Returns the head of a table, which is repeated where the table continues.
const TextLine* head_above(const Lines& lines, std::size_t k) {
  while (k > 0 && lines[k].kind == LineKind::kTickRow) --k;
  return lines[k].kind == LineKind::kHead ? &lines[k] : nullptr;
}

std::vector<Page> paginated(const Lines& lines, const std::string& title, Paper paper) {
  const design::Vec2 size_mm = text_size_mm(paper);
  const double room_mm = room_of(paper);
  std::vector<Page> pages;
  double used_mm = room_mm;
  for (std::size_t k = 0; k < lines.size(); ++k) {
    // A title stays with the line below it.
    const double needed_mm = height_mm(lines[k].kind) + (lines[k].kind == LineKind::kTitle ? 12.0 : 0.0);
    if (used_mm + needed_mm > room_mm) {
      pages.push_back({.kind = PageKind::kText, .title = title, .patch = -1, .size_mm = size_mm});
      used_mm = 0.0;
      const TextLine* head = lines[k].kind == LineKind::kTickRow ? head_above(lines, k) : nullptr;
      if (head != nullptr) pages.back().lines.push_back(*head);
      if (head != nullptr) used_mm += height_mm(head->kind);
    }
    pages.back().lines.push_back(lines[k]);
    used_mm += height_mm(lines[k].kind);
  }
  return pages;
}

// Puts as many tables of controllers on a page as fit completely.
std::vector<Page> controller_pages(const design::Design& design, const Plan& plan, Paper paper) {
  std::vector<Page> pages;
  double used_mm = 0.0;
  for (const layout::PatchIndex p : design::patches_of(design)) {
    Lines lines = controller_lines(design, plan, p);
    const double height = height_of(lines);
    if (!pages.empty() && used_mm + height <= room_of(paper)) {
      std::ranges::move(lines, std::back_inserter(pages.back().lines));
      std::string& title = pages.back().title;
      constexpr std::string_view kOne = "Controller ";
      const std::string numbers = title.substr(title.starts_with(kOne) ? kOne.size() : kOne.size() + 1);
      title = fmt::format("Controllers {}, {}", numbers, p);
      pages.back().patch = -1;
      used_mm += height;
      continue;
    }
    std::vector<Page> own = paginated(lines, fmt::format("Controller {}", p), paper);
    own.front().patch = p;
    used_mm = own.size() == 1 ? height : room_of(paper);
    std::ranges::move(own, std::back_inserter(pages));
  }
  return pages;
}

}  // namespace

design::Vec2 text_size_mm(Paper paper) {
  return paper == Paper::kA3 ? design::Vec2(297, 420) : design::Vec2(210, 297);
}

double height_mm(LineKind kind) {
  switch (kind) {
    case LineKind::kTitle:
      return 8.0;
    case LineKind::kTick:
    case LineKind::kHead:
      return 6.0;
    case LineKind::kTickRow:
      return 4.8;
    case LineKind::kText:
    case LineKind::kRow:
      return 5.0;
    case LineKind::kGap:
      break;
  }
  return 4.0;
}

std::string text_of(const Fix& fix, const std::vector<Landmark>& landmarks) {
  std::string text;
  for (std::size_t k = 0; k < 2; ++k) {
    if (fix.landmark[k] < 0) continue;
    text += fmt::format("{}{:.1f} mm from {}", text.empty() ? "" : " and ", fix.distance_mm[k],
                        landmarks[static_cast<std::size_t>(fix.landmark[k])].name);
  }
  return text.empty() ? "an unknown place (no surface)" : text;
}

std::string text_of(const Side& side, const design::Design& design, const Plan& plan) {
  if (side.cable) return "cable";
  if (side.jumper >= 0) {
    return "jumper " + design::jumper_name(design, design.layout.jumpers[static_cast<std::size_t>(side.jumper)]);
  }
  const design::ModuleNumber other = design::number_of(design, side.other);
  if (side.kind == SideKind::kKept) return fmt::format("{}", other);
  if (side.kind == SideKind::kCut) return fmt::format("cut ({})", other);
  const std::string second = side.second_cable ? "2nd cable, " : "";
  if (side.kind == SideKind::kApart)
    return fmt::format("{}cut ({} of C{})", second, other, plan.wiring[static_cast<std::size_t>(side.other)].patch);
  const std::string mark = side.match >= 0 ? fmt::format(", m{}", side.match) : "";
  return second + (side.kind == SideKind::kSlit ? fmt::format("slit ({})", other) : "edge") + mark;
}

std::vector<Page> text_pages(const design::Design& design, const Plan& plan, Paper paper) {
  Lines parts;
  add_parts(parts, design, bill_of(design, plan.sides));
  add_landmarks(parts, plan);
  auto pages = paginated(parts, "Parts and landmarks", paper);
  std::ranges::move(paginated(work_lines(design, plan), "Order of work", paper), std::back_inserter(pages));
  std::ranges::move(label_pages(design, plan, paper), std::back_inserter(pages));
  std::ranges::move(controller_pages(design, plan, paper), std::back_inserter(pages));
  return pages;
}

}  // namespace triskin::sheet
