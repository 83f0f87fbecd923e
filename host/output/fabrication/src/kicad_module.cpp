// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <map>
#include <numbers>
#include <set>

#include "kicad.hpp"
#include "kicad_text.hpp"

namespace triskin::fabrication {
namespace {

using design::Vec2;

// KiCad reads −0 as well as 0, but equal designs should give equal files.
double unsigned_zero(double value) {
  return value == 0.0 ? 0.0 : value;
}

struct PadForm {
  const char* kind;
  const char* shape;
  const char* layers;
};
PadForm form_of(const ModulePad& pad) {
  if (pad.layer == PadLayer::kThrough) return {"thru_hole", "circle", "\"*.Cu\""};
  if (pad.layer == PadLayer::kTouch) return {"smd", "circle", "\"F.Cu\""};
  return {"smd", "rect", has_paste(pad) ? "\"B.Cu\" \"B.Paste\" \"B.Mask\"" : "\"B.Cu\" \"B.Mask\""};
}

std::string effects() {
  return "(effects (font (size 1 1) (thickness 0.15)))";
}

std::string property(const char* key, const std::string& value, int id) {
  return fmt::format("    (property \"{}\" \"{}\" (id {}) (at 0 {} 0) (effects (font (size 1.27 1.27)){}))\n", key,
                     value, id, 3 * id, id < 2 ? "" : " hide");
}

std::string pin(const std::string& name, const std::string& number, double x_mm, double y_mm, int angle_deg) {
  return fmt::format(
      "      (pin passive line (at {:.2f} {:.2f} {}) (length 2.54) (name \"{}\" (effects (font (size 1.27 1.27)))) "
      "(number \"{}\" (effects (font (size 1.27 1.27)))))\n",
      x_mm, y_mm, angle_deg, name, number);
}

// Returns component and pin of a pad of the module: U1.5 is pin 5 of U1, A3 pin 3 of port A, T4 the only pin of T4.
std::pair<std::string, std::string> component_of(const ModulePad& pad) {
  const std::string& name = pad.name;
  if (pad.layer == PadLayer::kThrough) return {fmt::format("PORT_{}", name[0]), name.substr(1)};
  if (pad.layer == PadLayer::kTouch) return {name, "1"};
  const std::size_t dot = name.find('.');
  const bool is_strap = name.starts_with("S") || name.starts_with("ADD");
  return {(is_strap ? "JP_" : "") + name.substr(0, dot), name.substr(dot + 1)};
}

std::string value_of(const std::string& component) {
  static const std::map<std::string, std::string> kValues{
      {"U1", "AD7147-1"}, {"C1", "100n"}, {"C2", "1u"}, {"C3", "10n"}};
  const auto value = kValues.find(component);
  if (value != kValues.end()) return value->second;
  if (component.starts_with("JP_")) return "strap";
  return component.starts_with("PORT_") ? "port" : "taxel";
}

}  // namespace

bool has_paste(const ModulePad& pad) {
  const bool is_strap = pad.name.starts_with("S") || pad.name.starts_with("ADD");
  return pad.layer == PadLayer::kBack && !is_strap &&
         pad.name != "U1.25";  // paste_windows() has the paste of that one.
}

double degrees(double angle_rad) {
  return unsigned_zero(angle_rad * 180.0 / std::numbers::pi);
}

std::string pad_text(const ModulePad& pad, double turn_rad, const std::string& net) {
  const PadForm form = form_of(pad);
  const std::string drill =
      pad.layer == PadLayer::kThrough ? fmt::format(" (drill {:g})", kContactHole_mm) : std::string();
  return fmt::format("    (pad \"{}\" {} {} (at {:.6f} {:.6f} {:.4f}) (size {:g} {:g}){} (layers {}){})\n", pad.name,
                     form.kind, form.shape, unsigned_zero(pad.at_mm.x()), unsigned_zero(-pad.at_mm.y()),
                     degrees(pad.angle_rad + turn_rad), pad.size_mm.x(), pad.size_mm.y(), drill, form.layers, net);
}

std::string module_details(double turn_rad) {
  std::string text;
  for (const ModulePad& w : paste_windows())
    text += fmt::format("    (pad \"\" smd rect (at {:.6f} {:.6f} {:.4f}) (size {:g} {:g}) (layers \"B.Paste\"))\n",
                        w.at_mm.x(), unsigned_zero(-w.at_mm.y()), degrees(turn_rad), w.size_mm.x(), w.size_mm.y());
  const auto line = [&](const Vec2& a, const Vec2& b, const char* layer, double width_mm) {
    text += fmt::format("    (fp_line (start {:.4f} {:.4f}) (end {:.4f} {:.4f}) (layer \"{}\") (width {:g}))\n", a.x(),
                        unsigned_zero(-a.y()), b.x(), unsigned_zero(-b.y()), layer, width_mm);
  };
  for (const ModulePart& part : module_parts()) {
    const Vec2 h = part.half_size_mm;
    const std::array<Vec2, 4> box{part.at_mm - h, part.at_mm + Vec2(h.x(), -h.y()), part.at_mm + h,
                                  part.at_mm + Vec2(-h.x(), h.y())};
    for (std::size_t k = 0; k < box.size(); ++k) line(box[k], box[(k + 1) % box.size()], "B.CrtYd", 0.05);
    text += fmt::format(
        "    (fp_text user \"{}\" (at {:.4f} {:.4f} {:.4f}) (layer \"B.Fab\") (effects (font (size 0.6 0.6) (thickness "
        "0.1)) (justify mirror)))\n",
        part.designator, part.at_mm.x(), unsigned_zero(-part.at_mm.y()), degrees(turn_rad));
  }
  for (const SilkLine& l : module_silk()) line(l.from_mm, l.to_mm, "B.SilkS", kSilk_mm);
  return text;
}

std::vector<ModulePad> cable_pads() {
  std::vector<ModulePad> pads;
  for (std::size_t k = 0; k < kBusNets; ++k) {
    pads.push_back(
        {fmt::format("{}", k + 1), PadLayer::kBack, cable_pad_at(k), {kCablePadWidth_mm, kCablePadLength_mm}, 0.0});
  }
  return pads;
}

std::string module_footprint() {
  std::string text =
      fmt::format("(footprint \"{}\" (version 20211014) (generator triskin) (layer \"F.Cu\")\n", kModuleName);
  text += "  (descr \"Tactile module, triangle of 30 mm, AD7147-1 (a proposal: none was built)\")\n  (attr smd)\n";
  text += "  (fp_text reference \"M**\" (at 0 0) (layer \"F.Fab\") " + effects() + ")\n";
  text += fmt::format("  (fp_text value \"{}\" (at 0 2) (layer \"F.Fab\") {})\n", kModuleName, effects());
  for (const ModulePad& pad : module_pads()) text += pad_text(pad, 0.0, "");
  return text + module_details(0.0) + ")\n";
}

std::string module_symbol() {
  std::string text = "(kicad_symbol_lib (version 20211014) (generator triskin)\n";
  text += fmt::format("  (symbol \"{}\" (in_bom yes) (on_board yes)\n", kModuleName);
  text += property("Reference", "M", 0) + property("Value", kModuleName, 1);
  text += property("Footprint", fmt::format("Triskin:{}", kModuleName), 2) + property("Datasheet", "", 3);
  constexpr double kStep_mm = 2.54, kHalfWidth_mm = 20.32, kHalfHeight_mm = 40.64;
  text += fmt::format(
      "    (symbol \"{}_1_1\"\n      (rectangle (start {:g} {:g}) (end {:g} {:g}) (stroke (width 0.254)) "
      "(fill (type background)))\n",
      kModuleName, -kHalfWidth_mm, kHalfHeight_mm, kHalfWidth_mm, -kHalfHeight_mm);
  for (std::size_t port = 0; port < layout::kPorts; ++port) {
    for (std::size_t net = 0; net < kBusNets; ++net) {
      const double y_mm = kHalfHeight_mm - kStep_mm * static_cast<double>(1 + port * kBusNets + net);
      text += pin(fmt::format("{}_{}", "ABC"[port], kBusNetNames[net]), fmt::format("{}{}", "ABC"[port], net + 1),
                  -kHalfWidth_mm - kStep_mm, y_mm, 0);
    }
  }
  for (int t = 0; t < layout::kTaxelsPerModule; ++t)
    text += pin(fmt::format("CIN{}", t), fmt::format("T{}", t), kHalfWidth_mm + kStep_mm,
                kHalfHeight_mm - kStep_mm * (t + 1), 180);
  return text + "    )\n  )\n)\n";
}

std::string module_netlist() {
  std::set<std::string> components;
  std::map<std::string, std::set<std::pair<std::string, std::string>>> nets;
  for (const ModulePad& pad : module_pads()) {
    const auto pin_of = component_of(pad);
    components.insert(pin_of.first);
    const std::string net = net_of(pad, ModuleSetting{});
    if (!net.empty()) nets[net.substr(net.find('_') + 1)].insert(pin_of);
  }
  std::string text = "(export (version \"E\")\n  (design (source \"module\") (tool \"triskin\"))\n  (components\n";
  for (const std::string& name : components)
    text += fmt::format("    (comp (ref \"{}\") (value \"{}\"))\n", name, value_of(name));
  text += "  )\n  (nets\n";
  int code = 0;
  for (const auto& [name, pins] : nets) {
    text += fmt::format("    (net (code \"{}\") (name \"{}\")", ++code, name);
    for (const auto& [ref, number] : pins) text += fmt::format("\n      (node (ref \"{}\") (pin \"{}\"))", ref, number);
    text += ")\n";
  }
  return text + "  )\n)\n";
}

}  // namespace triskin::fabrication
