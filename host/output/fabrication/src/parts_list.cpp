// SPDX-License-Identifier: GPL-3.0-or-later
#include "parts_list.hpp"

#include <fmt/format.h>

#include "module_board.hpp"
#include "triskin/sheet/bill.hpp"

namespace triskin::fabrication {
namespace {

void add_cables(const std::vector<sheet::PieceCount>& pieces, const char* part, const char* note,
                std::vector<PartLine>& parts) {
  for (const auto& [length_mm, count] : pieces) {
    const std::string length = length_mm > 0 ? fmt::format(", {} mm", length_mm) : std::string(", length not known");
    parts.push_back({part + length, count, "", "", note});
  }
}

std::string quoted(const std::string& field) {
  if (field.find_first_of(",\"\r\n") == std::string::npos) return field;
  std::string text = "\"";
  for (const char c : field) text += c == '"' ? std::string("\"\"") : std::string(1, c);
  return text + "\"";
}

}  // namespace

std::vector<PartLine> parts_of(const design::Design& design, const sheet::Sides& sides,
                               const std::vector<FlatIsland>& islands) {
  const sheet::Bill bill = sheet::bill_of(design, sides);
  std::vector<PartLine> parts;
  for (const FlatIsland& island : islands) {
    parts.push_back(
        {"flexible board, 4 layers", 1, "", island.part_number,
         fmt::format("island {}, {} modules, {} folds", island.island, island.modules.size(), island.folds.size())});
  }
  for (const ModulePart& part : module_parts()) {
    parts.push_back({fmt::format("{} {}, {}", part.designator[0] == 'U' ? "capacitance converter" : "capacitor",
                                 part.value, part.package),
                     bill.modules, part.manufacturer, part.order_number,
                     fmt::format("{} of each module", part.designator)});
  }
  parts.push_back({"patch controller with microcontroller", bill.controllers, "STMicroelectronics", "STM32G474RET6",
                   "the number is that of its microcontroller"});
  add_cables(bill.cables, "flat cable, 10 ways, 1.0 mm", "entry to rim, straight; add what lies beyond the rim", parts);
  add_cables(bill.jumpers, "flat cable, 10 ways, 1.0 mm", "jumper, along the surface", parts);
  return parts;
}

std::string parts_csv(const std::vector<PartLine>& parts) {
  std::string text = "part,quantity,manufacturer,part_number,note\r\n";
  for (const PartLine& line : parts)
    text += fmt::format("{},{},{},{},{}\r\n", quoted(line.part), line.quantity, quoted(line.manufacturer),
                        quoted(line.part_number), quoted(line.note));
  return text;
}

}  // namespace triskin::fabrication
