// SPDX-License-Identifier: GPL-3.0-or-later
#include "design_edit.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <sstream>
#include <utility>

#include "design_argument.hpp"
#include "module_ids.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"
#include "triskin/base/lower_case.hpp"
#include "triskin/base/short_list.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/pipeline/edit_design.hpp"

namespace triskin::cli {
namespace {

constexpr int kMaxId = 9'999'999;

std::vector<std::string> parts_of(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, separator);) parts.push_back(part);
  return parts;
}

[[noreturn]] void refuse(const std::string& option, const std::string& part, const std::string& remedy) {
  throw InputError(fmt::format("{}: \"{}\" is not understood; {}", option, part, remedy));
}

// Parses a whole number in [low, high]; the text may contain nothing else.
bool read_whole(const std::string& text, int low, int high, int& value) {
  std::istringstream in(text);
  return !text.empty() && text.find_first_not_of("-0123456789") == std::string::npos && (in >> value) && in.eof() &&
         value >= low && value <= high;
}

constexpr const char* kPlaceRemedy = "give MODULE.SIDE (side 0 … 2) or ISLAND:I/J/up or ISLAND:I/J/down";

pipeline::TileOfIsland tile_of(const std::string& part, std::size_t colon) {
  const std::vector<std::string> tile = parts_of(part.substr(colon + 1), '/');
  pipeline::TileOfIsland place;
  if (tile.size() != 3 || !read_whole(part.substr(0, colon), 0, kMaxId, place.island) ||
      !read_whole(tile[0], -design::kMaxLattice, design::kMaxLattice, place.tile.i) ||
      !read_whole(tile[1], -design::kMaxLattice, design::kMaxLattice, place.tile.j) ||
      (tile[2] != "up" && tile[2] != "down"))
    refuse("--add", part, kPlaceRemedy);
  place.tile.up = tile[2] == "up";
  return place;
}

// Parses "MODULE.SIDE" or "ISLAND:I/J/up".
pipeline::NewPlace place_of(const design::Design& design, const std::string& part) {
  if (const std::size_t colon = part.find(':'); colon != std::string::npos) return tile_of(part, colon);
  design::ModuleNumber module;
  int free_side = 0;
  const std::vector<std::string> side = parts_of(part, '.');
  if (side.size() != 2 || !read_whole(side[0], 0, kMaxId, module.value) || !read_whole(side[1], 0, 2, free_side))
    refuse("--add", part, kPlaceRemedy);
  return pipeline::BesideModule{design::require_module(design, module), free_side};
}

// Parses "x", "y", "z", or "NX,NY,NZ[,D]" with a normal of any length and D in mm along it.
design::MirrorPlane plane_of(const std::string& text) {
  if (text == "x") return {design::Vec3::UnitX(), 0.0};
  if (text == "y") return {design::Vec3::UnitY(), 0.0};
  if (text == "z") return {design::Vec3::UnitZ(), 0.0};
  std::array<double, 4> value{};
  const std::vector<std::string> parts = parts_of(text, ',');
  bool is_read = parts.size() == 3 || parts.size() == 4;
  for (std::size_t k = 0; is_read && k < parts.size(); ++k) {
    std::istringstream in(parts[k]);
    is_read = (in >> value[k]) && in.eof() && std::isfinite(value[k]);
  }
  const design::Vec3 normal(value[0], value[1], value[2]);
  if (!is_read || !(normal.norm() > 1e-9))
    refuse("--mirror", text, "give x, y or z, or a plane NX,NY,NZ,D: normal, and distance from the origin in mm");
  return {normal.normalized(), value[3]};
}

pipeline::EditedDesign edited(const design::Design& design, const EditOptions& options,
                              const pipeline::DesignOptions& effort, const ProgressSink& progress) {
  if (options.take >= 0) return {pipeline::take_alternative(design, options.take, progress), {}, {}, {}};
  if (!options.mirror.empty()) return pipeline::mirror_design(design, plane_of(options.mirror), progress);
  if (!options.keep.empty()) {
    const auto kept = modules_named(design, "--keep", options.keep);
    return pipeline::grow_around(design, {kept.begin(), kept.end()},
                                 {effort.time_limit_s, effort.iterations, effort.threads}, progress);
  }
  if (options.remove.empty() && options.add.empty()) {  // Only kinds change.
    return {design, {}, {}, design::patches_of(design)};
  }
  pipeline::LayoutEdit edit;
  const auto removed = modules_named(design, "--remove", options.remove);
  edit.remove.assign(removed.begin(), removed.end());
  for (const std::string& part : parts_of(options.add, ',')) edit.add.push_back(place_of(design, part));
  return pipeline::edit_design(design, edit, progress);
}

// Which labels and which controllers are as they were.
void report_changes(const design::Design& before, const pipeline::EditedDesign& e, const EditOptions& options,
                    Output& output) {
  if (options.mirror.empty()) {
    report_labels(before, e.design, output.result, output);
  } else {
    output.result.update(
        {{"kept", e.new_id.size()}, {"removed", nlohmann::json::array()}, {"added", nlohmann::json::array()}});
    output.say(fmt::format("{} mirrored, none renumbered", counted(e.new_id.size(), "module")));
  }
  report_tables(before, e.design, e.kept_patches, output.result, output);
}

int report_design(const design::Design& d, Output& output) {
  output.result.update({{"modules", d.layout.modules.size()},
                        {"islands", d.layout.islands},
                        {"patches", design::patches_of(d).size()},
                        {"patches_lower_bound", d.report.patches_lower_bound},
                        {"jumpers", d.layout.jumpers.size()},
                        {"jumpers_lower_bound", d.report.jumpers_lower_bound},
                        {"coverage", d.report.coverage},
                        {"seconds", d.report.seconds}});
  output.say(fmt::format("{} in {}, {}, {}, coverage {:.1f} %", counted(d.layout.modules.size(), "module"),
                         counted(d.layout.islands, "island"), counted(design::patches_of(d).size(), "controller"),
                         counted(d.layout.jumpers.size(), "jumper"), 100.0 * d.report.coverage));
  report_kinds(d, output);
  const bool is_covered = report_regions(d, output);
  report_alternatives(d, output);
  return is_covered ? 0 : 1;
}

}  // namespace

void EditOptions::add_to(CLI::App& app) {
  auto* take_option =
      app.add_option("--take", take, "take this alternative, without a search")->check(CLI::Range(0, 1000));
  auto* remove_option = app.add_option("--remove", remove, "remove these modules, as 3,7-9");
  auto* add_option =
      app.add_option("--add", add, "add modules at these free sides (MODULE.SIDE) or tiles (ISLAND:I/J/up)");
  auto* keep_option = app.add_option("--keep", keep, "keep these modules, as 0-40,52, and search the rest anew");
  auto* mirror_option =
      app.add_option("--mirror", mirror, "mirror at the plane x, y or z = 0 (x, y, z), or at NX,NY,NZ,D");
  for (CLI::Option* a : {remove_option, add_option}) {
    for (CLI::Option* b : {take_option, keep_option, mirror_option}) a->excludes(b);
  }
  take_option->excludes(keep_option)->excludes(mirror_option);
  keep_option->excludes(mirror_option);
  add_kinds(app, kinds);
}

bool EditOptions::any() const {
  return take >= 0 || !(remove.empty() && add.empty() && keep.empty() && mirror.empty() && kinds.empty());
}

design::KindPlan kind_plan_of(const std::string& kinds) {
  return kinds.empty() || kinds == "none" ? design::KindPlan{} : design::read_kind_plan(kinds);
}

void add_kinds(CLI::App& app, std::string& kinds) {
  app.add_option("--kinds", kinds, "file of module kinds (docs/pipeline.md); none: all are standard");
}

void report_check(const OutputCheck& check, Output& output) {
  nlohmann::json violations = nlohmann::json::array();
  for (const check::Violation& v : check.report.violations)
    violations.push_back({{"rule", v.rule}, {"where", v.where}, {"text", v.text}});
  output.result["check"] = {{"rules", check.report.rules.size()},
                            {"violations", std::move(violations)},
                            {"removed", check.removed.size()},
                            {"seconds", check.seconds}};
  if (check.removed.empty()) return;
  output.say(fmt::format("{} left out because triskin check would reject the design: {}",
                         counted(check.removed.size(), "module"), fmt::join(check.removed, ", ")));
}

void report_labels(const design::Design& before, const design::Design& now, nlohmann::json& result, Output& output) {
  const std::vector<int> old = design::all_numbers(before.layout), all = design::all_numbers(now.layout);
  std::vector<int> kept, removed, added;
  std::ranges::set_intersection(old, all, std::back_inserter(kept));
  std::ranges::set_difference(old, all, std::back_inserter(removed));
  std::ranges::set_difference(all, old, std::back_inserter(added));
  result["kept"] = kept.size();
  result["removed"] = removed;
  result["added"] = added;
  output.say(fmt::format("{} of {} as they were, {} removed, {} new", kept.size(), counted(old.size(), "module"),
                         removed.size(), added.size()));
  if (!removed.empty()) output.say("labels no longer in use: " + design::ranges_text(removed));
  if (!added.empty()) output.say("new labels: " + design::ranges_text(added));
}

void report_tables(const design::Design& before, const design::Design& now, const std::vector<layout::PatchIndex>& kept,
                   nlohmann::json& result, Output& output) {
  const std::vector<layout::PatchIndex> old = design::patches_of(before), all = design::patches_of(now);
  std::vector<layout::PatchIndex> anew, free;
  std::ranges::set_difference(all, kept, std::back_inserter(anew));
  std::ranges::set_difference(old, all, std::back_inserter(free));
  result["controllers"] = {{"kept", kept}, {"wired_anew", anew}, {"no_longer_used", free}};
  output.say(anew.empty() ? "all controllers are wired as before"
                          : fmt::format("{} of {} wired as before; wired anew: {}", kept.size(),
                                        counted(all.size(), "controller"), short_list(anew)));
  if (!free.empty()) output.say("controllers no longer in use: " + short_list(free));
}

namespace {

// Returns whether every cable enters in an allowed place.
bool report_entries(const design::Design& d, Output& output) {
  if (!d.regions.limits_entries()) return true;
  output.result["entries_elsewhere"] = d.report.entries_elsewhere;
  if (d.report.entries_elsewhere.empty()) return true;
  output.say(fmt::format(
      "  no free side of patch {} lies in an entry region: its cable enters elsewhere; make an entry region larger, or "
      "add one",
      fmt::join(d.report.entries_elsewhere, ", ")));
  return false;
}

nlohmann::json json_of(const design::Uncovered& u) {
  const auto& p = u.place_mm;
  return {{"region", u.region}, {"share", u.share}, {"place_mm", {p.x(), p.y(), p.z()}}, {"why", u.why}};
}

}  // namespace

bool report_regions(const design::Design& d, Output& output) {
  if (d.regions.empty()) return true;
  output.result["worth"] = d.report.module_value;
  output.result["uncovered"] = nlohmann::json::array();
  output.say(
      fmt::format("{}: the modules are worth {:.2f}", counted(d.regions.list.size(), "region"), d.report.module_value));
  for (const design::Uncovered& u : d.report.uncovered) {
    const auto& p = u.place_mm;
    const std::string why = u.why == "room" ? "a module fits there, but not beside the others" : u.why + " refuses any";
    output.result["uncovered"].push_back(json_of(u));
    output.say(
        fmt::format("  region \"{}\" must be covered, {:.1f} % of it is not: farthest from a module is "
                    "({:.1f}, {:.1f}, {:.1f}); {}",
                    u.region, 100.0 * u.share, p.x(), p.y(), p.z(), why));
  }
  return report_entries(d, output) && d.report.uncovered.empty();
}

void report_kinds(const design::Design& d, Output& output) {
  if (d.kinds.empty()) return;
  const std::vector<int> counts = design::count_kinds(d.kinds, d.layout);
  std::string text;
  for (std::size_t k = 0; k < counts.size(); ++k) {
    const std::string name = design::kind_of(d.kinds, static_cast<int>(k)).name;
    output.result["kinds"][name] = counts[k];
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", counts[k], name);
  }
  output.say(fmt::format("kinds: {}", text));
}

namespace {

// Prints a table, except for a single layout, which the lines above already describe.
void say_alternatives(const design::Design& d, Output& output) {
  if (d.alternatives.size() < 2) return;
  output.say("alternative  modules  controllers  jumpers  islands   price   value   (triskin edit --take N)");
  for (std::size_t k = 0; k < d.alternatives.size(); ++k) {
    const design::Alternative& a = d.alternatives[k];
    output.say(fmt::format("{:>9} {}  {:>7}  {:>11}  {:>7}  {:>7}  {:>6.2f}  {:>6.2f}", k,
                           static_cast<int>(k) == d.taken ? "*" : " ", a.layout.modules.size(), a.patches, a.jumpers,
                           a.layout.islands, a.price, a.module_value - a.price));
  }
  const auto value = [](const design::Alternative& a) { return a.module_value - a.price; };
  const auto best = std::ranges::max_element(d.alternatives, {}, value);
  if (d.taken >= 0 && value(*best) > value(d.alternatives[static_cast<std::size_t>(d.taken)]))
    output.say(
        fmt::format("The price of * is that of its wiring; the others are estimates. To wire the best of them: "
                    "triskin edit --take {}",
                    best - d.alternatives.begin()));
}

}  // namespace

void report_alternatives(const design::Design& d, Output& output) {
  output.result["price"] = d.price.of(static_cast<int>(design::patches_of(d).size()),
                                      static_cast<int>(d.layout.jumpers.size()), d.layout.islands);
  output.result["taken"] = d.taken;
  output.result["alternatives"] = nlohmann::json::array();
  for (std::size_t k = 0; k < d.alternatives.size(); ++k) {
    const design::Alternative& a = d.alternatives[k];
    const std::size_t n = a.layout.modules.size();
    output.result["alternatives"].push_back({{"modules", n},
                                             {"patches", a.patches},
                                             {"jumpers", a.jumpers},
                                             {"islands", a.layout.islands},
                                             {"price", a.price},
                                             {"worth", a.module_value}});
  }
  say_alternatives(d, output);
}

void require_design_output(const std::string& path) {
  static constexpr std::array kOtherFormats{".obj", ".stl",  ".ply", ".off",  ".dae", ".gltf", ".glb", ".3mf", ".step",
                                            ".stp", ".iges", ".igs", ".html", ".svg", ".pdf",  ".csv", ".dxf"};
  if (std::ranges::find(kOtherFormats, extension_of(path)) != kOtherFormats.end())
    throw InputError(fmt::format("{}: a design is a JSON file; name it {}", path,
                                 std::filesystem::path(path).replace_extension(".json").string()));
  require_writable(path);
}

int edit(const std::string& from, const std::string& to, const EditOptions& options,
         const pipeline::DesignOptions& effort, Output& output) {
  const design::Design before = design::read_design(from);
  say_if_changed(before, from, output);
  output.result = nlohmann::json::object();
  const design::KindPlan plan = kind_plan_of(options.kinds);  // Invalid kinds are refused before any work.
  pipeline::EditedDesign e = edited(before, options, effort, output.progress());
  if (!options.kinds.empty()) {
    e.design.kinds = plan;
    const int last = static_cast<int>(e.design.layout.modules.size()) - 1;
    design::require_fitting_number(e.design, design::number_of(e.design, last).value);
    design::assign_kinds(plan, e.design.layout);
    e.design.design_id = design::design_id_of(e.design);
  }
  const OutputCheck check = write_checked_design(to, e.design, OnViolation::kRefuse, output.progress());
  report_check(check, output);
  report_changes(before, e, options, output);
  const int status = report_design(e.design, output);
  output.say(fmt::format("design {:016x} written to {}", e.design.design_id, to));
  return check.keeps_all_rules() ? status : 1;
}

}  // namespace triskin::cli
