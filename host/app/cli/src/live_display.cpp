// SPDX-License-Identifier: GPL-3.0-or-later
#include "live_display.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <set>

#include "terminal.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/pace.hpp"
#include "triskin/base/terminal_text.hpp"
#include "triskin/skin/taxel_trace.hpp"

namespace triskin::cli {
namespace {

using skin::LiveMonitor;
using skin::PressedTaxel;
using skin::PressureUnit;

constexpr const char* kAboveRange = " (above the calibrated range)";

std::string_view name_of(PressureUnit unit) {
  return unit == PressureUnit::kKpa       ? "kPa"
         : unit == PressureUnit::kPercent ? "% of range"
         : unit == PressureUnit::kModule  ? "numbers of modules"
                                          : "counts";
}

PressureUnit best_unit(const LiveMonitor& monitor) {
  return monitor.calibration().complete() ? PressureUnit::kKpa : PressureUnit::kCounts;
}

std::string force_of(const LiveMonitor& monitor) {
  return monitor.calibration().complete() ? fmt::format(", {:.2f} N total", monitor.force_n()) : "";
}

nlohmann::json numbers_of(const design::Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

bool is_above_range(const skin::SkinContact& c, const design::SkinCalibration& calibration) {
  return calibration.complete() && std::ranges::any_of(c.taxels, [&](const PressedTaxel& t) {
           return calibration.is_above_range({t.module, t.taxel}, t.change_counts);
         });
}

nlohmann::json contacts_json(const design::Design& design, const std::vector<skin::SkinContact>& contacts,
                             const design::SkinCalibration& calibration) {
  nlohmann::json list = nlohmann::json::array();
  for (const skin::SkinContact& c : contacts) {
    list.push_back({{"position_mm", numbers_of(c.position_mm)},
                    {"position_sd_mm", c.position_sd_mm},
                    {"normal", numbers_of(c.normal)},
                    {"area_mm2", c.area_mm2},
                    {"change_counts", c.change_counts},
                    {"module", design::number_of(design, c.taxels.front().module)},
                    {"taxel", c.taxels.front().taxel},
                    {"taxels", c.taxels.size()}});
    if (!std::isfinite(c.force_n)) continue;
    list.back()["force_n"] = c.force_n;
    list.back()["force_sd_n"] = c.force_sd_n;
    if (is_above_range(c, calibration)) list.back()["above_calibration"] = true;
  }
  return list;
}

std::string bar_of(double change_counts) {
  return std::string(static_cast<std::size_t>(std::clamp(change_counts / 500.0, 1.0, 24.0)), '#');
}

class Lines final : public LiveDisplay {
 public:
  explicit Lines(const Output& output) : output_(output) {}
  Wish show(LiveMonitor& monitor, const LiveState& state) override {
    const auto pressed = monitor.touches().pressed();
    if (const std::string remark = off_rest_.due(monitor, state.time_s); !remark.empty())
      output_.say(fmt::format("{:7.2f} s  {}", state.time_s, remark));
    if (pressed.empty() && state.time_s < spoke_s_ + OffRestNotice::kHeartbeat_s) return Wish::kNothing;
    spoke_s_ = state.time_s;
    if (pressed.empty()) {
      say_nothing_pressed(state);
      return Wish::kNothing;
    }
    const auto& first = pressed.front();
    output_.say(fmt::format("{:7.2f} s  {} {:<24}{}{}", state.time_s, place_text(monitor, first),
                            bar_of(first.change_counts), more_taxels(pressed.size() - 1), force_of(monitor)));
    for (const skin::SkinContact& c : monitor.contacts())
      output_.say(fmt::format("{:>11}{}", "", contact_text(monitor.design(), c, monitor.calibration())));
    return Wish::kNothing;
  }

 private:
  void say_nothing_pressed(const LiveState& state) const {
    output_.say(fmt::format("{:7.2f} s  nothing is pressed; {}, {} lost", state.time_s, counted(state.frames, "sample"),
                            state.lost));
  }

  const Output& output_;
  double spoke_s_ = 0.0;
  OffRestNotice off_rest_;
};

class Objects final : public LiveDisplay {
 public:
  explicit Objects(const Output& output) : output_(output) {}
  Wish show(LiveMonitor& monitor, const LiveState& state) override {
    output_.each(to_json(monitor, state));
    return Wish::kNothing;
  }

 private:
  const Output& output_;
};

// Arranges texts in `beside` columns that are `wide` characters wide.
std::vector<std::string> in_columns(const std::vector<std::string>& texts, std::size_t wide, std::size_t beside) {
  const std::size_t high = (texts.size() + beside - 1) / beside;
  std::vector<std::string> lines(high);
  for (std::size_t k = 0; k < texts.size(); ++k)
    lines[k % high] += k + high < texts.size() ? fmt::format("{:<{}}", texts[k], wide) : texts[k];
  return lines;
}

class Screen final : public LiveDisplay {
 public:
  explicit Screen(const design::Design& design) : design_(design) {}

  Wish show(LiveMonitor& monitor, const LiveState& state) override {
    Wish wish = Wish::kNothing;
    trace_.step(monitor);
    if (!has_chosen_) follow(monitor);
    while (const char key = terminal_.key()) {
      const Wish asked = take(key);
      if (asked != Wish::kNothing) wish = asked;
    }
    terminal_.draw(page(monitor, state));
    // Our own simulation would be too fast for a person to follow.
    (void)triskin::sleep_until(start_ + std::chrono::microseconds(static_cast<std::int64_t>(state.time_s * 1e6)));
    return wish;
  }

 private:
  Wish take(char key) {
    if (key == 'q') return Wish::kEnd;
    if (key == 't') return Wish::kTare;
    if (key == 'n' || key == 'p') {
      const std::vector<layout::PatchIndex> patches = design::patches_of(design_);
      const auto at = static_cast<std::size_t>(std::ranges::find(patches, patch_) - patches.begin());
      patch_ = patches[(at + (key == 'n' ? 1 : patches.size() - 1)) % patches.size()];
      has_chosen_ = true;
    }
    if (key == 'f') has_chosen_ = false;
    if (key == 'h') trace_.toggle_hold();
    if (key == 'u') ++unit_turns_;
    return Wish::kNothing;
  }

  // The picture follows the patch with the strongest pressure.
  void follow(const LiveMonitor& monitor) {
    const auto pressed = monitor.touches().pressed();
    if (!pressed.empty()) patch_ = std::max(layout::PatchIndex{}, patch_of(pressed.front().module));
  }

  [[nodiscard]] layout::PatchIndex patch_of(layout::ModuleId module) const {
    const auto found = std::ranges::find_if(design_.patches, [&](const design::Patch& p) {
      return std::ranges::find(p.modules, module, &design::RoutedModule::node) != p.modules.end();
    });
    return found == design_.patches.end() ? layout::PatchIndex::none()
                                          : layout::PatchIndex{found - design_.patches.begin()};
  }

  // The key u goes through the units; kPa is the first where it is known.
  [[nodiscard]] PressureUnit unit(const LiveMonitor& monitor) const {
    constexpr std::array kUnits{PressureUnit::kKpa, PressureUnit::kCounts, PressureUnit::kPercent,
                                PressureUnit::kModule};
    const std::size_t unknown = monitor.calibration().complete() ? 0 : 1;
    return kUnits[unknown + unit_turns_ % (kUnits.size() - unknown)];
  }

  [[nodiscard]] std::vector<std::string> page(const LiveMonitor& monitor, const LiveState& state) const {
    const Terminal::Size size = Terminal::size();
    std::vector<std::string> lines;
    lines.push_back(fmt::format("{}  {:.1f} s  {}, {} lost{}", for_terminal(design_.name), state.time_s,
                                counted(state.frames, "sample"), state.lost, force_of(monitor)));
    std::vector<std::string> below = lines_below_patches(monitor, state, size.columns);
    const int room = std::max(size.rows - static_cast<int>(lines.size() + below.size()) - 2, kMinPatchLines);
    for (std::string& line : patch_lines(monitor, room, size.columns)) lines.push_back(std::move(line));
    lines.emplace_back();
    for (std::string& line : below) lines.push_back(std::move(line));
    return lines;
  }
  [[nodiscard]] std::vector<std::string> lines_below_patches(const LiveMonitor& monitor, const LiveState& state,
                                                             int columns) const {
    std::vector<std::string> below = pressed_lines(monitor, columns);
    if (const std::string remark = design::sentence(monitor.off_rest()); !remark.empty()) below.push_back(remark);
    for (const session::AdoptedCounts& a : state.adopted)
      below.push_back(fmt::format("module {} is read by the controller of patch {}", a.number, a.patch));
    if (!state.note.empty()) below.push_back(for_terminal(state.note));
    below.push_back(
        fmt::format("n p f: patch ({})  u: unit ({})", has_chosen_ ? "chosen" : "pressed", name_of(unit(monitor))));
    below.emplace_back("q: end  t: tare, nobody touches  h: hold the plotted taxel");
    return below;
  }
  [[nodiscard]] std::vector<std::string> pressed_lines(const LiveMonitor& monitor, int columns) const {
    std::vector<std::string> below = monitor.picture(patch_, unit(monitor), Terminal::has_colour(), columns);
    below.emplace_back();
    const auto pressed = monitor.touches().pressed();
    for (std::size_t k = 0; k < std::min(kMaxTaxels, pressed.size()); ++k)
      below.push_back(place_text(monitor, pressed[k]));
    const auto contacts = monitor.contacts();
    for (std::size_t k = 0; k < std::min(kMaxContacts, contacts.size()); ++k)
      below.push_back(contact_text(monitor.design(), contacts[k], monitor.calibration()));
    if (pressed.size() > kMaxTaxels) below.push_back(more_taxels(pressed.size() - kMaxTaxels));
    for (std::string& line : trace_.lines(static_cast<std::size_t>(std::max(1, columns - 1)), kStep_s))
      below.push_back(std::move(line));
    return below;
  }

  // All patches where there is room, else the chosen one and those that are pressed or at fault before the others.
  // Arranges the patches in as many columns as the width permits and in `rows` lines at most.
  [[nodiscard]] std::vector<std::string> patch_lines(const LiveMonitor& monitor, int rows, int columns) const {
    std::vector<layout::PatchIndex> shown = design::patches_of(design_);
    std::vector<std::string> all(design_.patches.size());
    std::size_t wide = 0;
    for (const layout::PatchIndex p : shown) {
      all[static_cast<std::size_t>(p)] = line_of(monitor, p);
      wide = std::max(wide, all[static_cast<std::size_t>(p)].size() + 3);
    }
    const int beside = std::max(1, columns / static_cast<int>(wide)), room = rows * beside;
    const int patches = static_cast<int>(shown.size());
    if (patches > room) {
      const std::set<layout::PatchIndex> pressed = pressed_patches(monitor);
      std::ranges::stable_sort(shown, {}, [&](layout::PatchIndex p) {
        return p == patch_ ? 0 : pressed.contains(p) ? 1 : monitor.faults(p) + monitor.unheard(p) > 0 ? 2 : 3;
      });
      shown.resize(static_cast<std::size_t>(room - 1));
      std::ranges::sort(shown);
    }
    std::vector<std::string> texts;
    for (const layout::PatchIndex p : shown) texts.push_back(std::move(all[static_cast<std::size_t>(p)]));
    if (patches > room) texts.push_back(fmt::format("  +{}", counted(patches - room + 1, "patch")));
    return in_columns(texts, wide, static_cast<std::size_t>(beside));
  }

  [[nodiscard]] std::set<layout::PatchIndex> pressed_patches(const LiveMonitor& monitor) const {
    std::set<layout::PatchIndex> patches;
    for (const PressedTaxel& t : monitor.touches().pressed()) patches.insert(patch_of(t.module));
    return patches;
  }

  [[nodiscard]] std::string line_of(const LiveMonitor& monitor, layout::PatchIndex patch) const {
    std::string text = fmt::format("{} patch {:3}  {:>10}  {:5.1f}/s", patch == patch_ ? ">" : " ", patch,
                                   counted(design_.patches[static_cast<std::size_t>(patch)].modules.size(), "module"),
                                   monitor.rate_hz(patch));
    if (monitor.faults(patch) > 0) text += fmt::format("  {}", counted(monitor.faults(patch), "fault"));
    if (monitor.unheard(patch) > 0) text += fmt::format("  {} never heard", monitor.unheard(patch));
    return text;
  }

  static constexpr std::size_t kMaxTaxels = 5, kMaxContacts = 3;
  static constexpr int kMinPatchLines = 3;
  // show() is called once in this period.
  static constexpr double kStep_s = 0.2;
  const design::Design& design_;
  Terminal terminal_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  skin::TaxelTrace trace_;
  layout::PatchIndex patch_;
  bool has_chosen_ = false;  // The user's choice of a patch stops the automatic choice.
  std::size_t unit_turns_ = 0;
};

}  // namespace

std::string OffRestNotice::due(const LiveMonitor& monitor, double time_s) {
  std::string remark = design::sentence(monitor.off_rest());
  const bool is_due = !is_off_rest_ || time_s >= said_s_ + kHeartbeat_s;
  is_off_rest_ = !remark.empty();
  if (!is_off_rest_ || !is_due) return {};
  said_s_ = time_s;
  return remark;
}

// The value stands before the place, because a narrow terminal cuts what is at the right.
std::string more_taxels(std::size_t number) {
  return number == 0 ? "" : fmt::format(" and {} more {}", number, noun_after(number == 1, "taxel"));
}

std::string place_text(const LiveMonitor& monitor, const PressedTaxel& t) {
  const design::SkinCalibration& calibration = monitor.calibration();
  const bool is_kpa = best_unit(monitor) == PressureUnit::kKpa;
  const std::string value =
      is_kpa ? fmt::format("{:6.2f} kPa", calibration.pressure_kpa({t.module, t.taxel}, t.change_counts))
             : fmt::format("{:6.0f} counts", t.change_counts);
  const bool is_above = is_kpa && calibration.is_above_range({t.module, t.taxel}, t.change_counts);
  return fmt::format("module {:4} taxel {:2}  {}{}  at ({:8.2f}, {:8.2f}, {:8.2f}) mm",
                     design::number_of(monitor.design(), t.module), t.taxel, value, is_above ? kAboveRange : "",
                     t.position_mm.x(), t.position_mm.y(), t.position_mm.z());
}

std::string contact_text(const design::Design& design, const skin::SkinContact& c,
                         const design::SkinCalibration& calibration) {
  std::string text = fmt::format("contact  module {}  ", design::number_of(design, c.taxels.front().module));
  if (std::isfinite(c.force_n)) text += fmt::format("{:.2f} N ± {:.2f}  ", c.force_n, c.force_sd_n);
  if (is_above_range(c, calibration)) text += fmt::format("{}  ", kAboveRange + 1);
  return text + fmt::format("at ({:8.2f}, {:8.2f}, {:8.2f}) mm ± {:.1f}  {:.0f} mm²", c.position_mm.x(),
                            c.position_mm.y(), c.position_mm.z(), c.position_sd_mm, c.area_mm2);
}

nlohmann::json to_json(const design::OffRest& off) {
  return {{"taxels", off.taxels}, {"modules", off.modules}};
}

namespace {

nlohmann::json pressed_json(const LiveMonitor& monitor) {
  const bool calibrated = monitor.calibration().complete();
  nlohmann::json pressed = nlohmann::json::array();
  for (const PressedTaxel& t : monitor.touches().pressed()) {
    pressed.push_back({{"module", design::number_of(monitor.design(), t.module)},
                       {"taxel", t.taxel},
                       {"change_counts", t.change_counts},
                       {"position_mm", {t.position_mm.x(), t.position_mm.y(), t.position_mm.z()}},
                       {"normal", {t.normal.x(), t.normal.y(), t.normal.z()}}});
    if (!calibrated) continue;
    pressed.back()["pressure_kpa"] = monitor.calibration().pressure_kpa({t.module, t.taxel}, t.change_counts);
    if (monitor.calibration().is_above_range({t.module, t.taxel}, t.change_counts))
      pressed.back()["above_calibration"] = true;
  }
  return pressed;
}

}  // namespace

nlohmann::json to_json(const LiveMonitor& monitor, const LiveState& state) {
  nlohmann::json line = {
      {"time_s", state.time_s}, {"frames", state.frames}, {"lost", state.lost}, {"pressed", pressed_json(monitor)}};
  line["unit"] = name_of(best_unit(monitor));
  line["off_rest"] = to_json(monitor.off_rest());
  const auto contacts = monitor.contacts();
  line["contacts"] = contacts_json(monitor.design(), contacts, monitor.calibration());
  if (monitor.calibration().complete()) {
    line["force_n"] = monitor.force_n();
    const skin::NetForce net = skin::net_force(contacts);
    line["net_force_n"] = numbers_of(net.force_n);
    line["net_torque_nmm"] = numbers_of(net.torque_nmm);
  }
  if (state.error_us) line["time_error_us"] = *state.error_us;
  for (const session::AdoptedCounts& a : state.adopted)
    line["adopted"].push_back({{"module", a.number}, {"patch", a.patch}});
  return line;
}

std::unique_ptr<LiveDisplay> make_display(const design::Design& design, const Output& output) {
  if (output.json()) return std::make_unique<Objects>(output);
  if (Terminal::there() && !design.patches.empty()) return std::make_unique<Screen>(design);
  return std::make_unique<Lines>(output);
}

}  // namespace triskin::cli
