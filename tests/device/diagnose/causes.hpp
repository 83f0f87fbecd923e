// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "support/blob_design.hpp"
#include "triskin/deploy/flash.hpp"
#include "triskin/design/supply.hpp"
#include "triskin/diagnose/verify.hpp"
#include "triskin/hardware/sim_link.hpp"
#include "triskin/session/bus.hpp"

/// What a technician meets at a skin, drawn by seed, and what `verify` says about it: one finding, the right place, the
/// right cause? All converters are drawn from the whole of their ranges.
namespace triskin::test {

enum class Cause {
  kNone,
  kSupplyDrop,
  kBrokenTrace,
  kLineHeld,
  kOtherFirmware,
  kWrongAddress,
  kBrokenStrap,
  kSameNumber,
  kDriftingChip,
  kStuckTaxel,
  kLoosePlug,
  kDeadModule,  // This one and those below are of switched modules.
  kOpenJoint,
  kShortedJoint,
  kModuleHoldsLine,
  kTurnedModule,
  kExchangedModules,
  kModuleReset,
};
inline constexpr std::array<const char*, 18> kCauseNames{"nothing is wrong",
                                                         "supply drop along the tree",
                                                         "one broken trace of a line",
                                                         "a line held low",
                                                         "firmware of another release",
                                                         "wrong straps of a module",
                                                         "a strap that breaks later",
                                                         "two boards on one number",
                                                         "a chip that drifts",
                                                         "a taxel that sticks",
                                                         "a plug that comes and goes",
                                                         "switched: a dead module",
                                                         "switched: an open joint",
                                                         "switched: a shorted joint",
                                                         "switched: a module that holds a line low",
                                                         "switched: a module turned by 120°",
                                                         "switched: two modules exchanged",
                                                         "switched: a module forgets its ports for a moment"};

/// A skin with one cause, and what a right finding says.
class CauseDraw {
 public:
  CauseDraw(Cause cause, std::uint64_t seed) : random_(seed * 977 + static_cast<std::uint64_t>(cause)) {
    do scene_ = {};
    while (!draw(cause, seed));
  }

  enum class Verdict {
    kRight,   ///< one finding, with the cause and its place
    kBoth,    ///< one finding with its place; it names the cause beside another one that looks alike
    kWrong,   ///< another cause, or another place
    kMany,    ///< several findings, the right one among them or not
    kMissed,  ///< no finding
  };
  struct Told {
    Verdict verdict = Verdict::kMissed;
    std::string findings;  ///< their kinds
    std::string text;
  };

  [[nodiscard]] Told verify() {
    const design::Design design = scene_.design;
    hardware::SimLink link(std::move(scene_));
    session::Bus bus(link);
    (void)deploy::flash(bus, design, {});
    if (bus.now_us() >= kVerifyAt_us) throw std::logic_error("the flash took longer than the faults wait");
    bus.listen(kVerifyAt_us);
    diagnose::VerifyOptions options;
    options.touch = true;
    options.actuator = &link;
    return judge(diagnose::verify(bus, design, options).findings);
  }

 private:
  using Kind = hardware::FaultKind;
  static constexpr std::uint64_t kVerifyAt_us = 8'000'000, kHappens_us = kVerifyAt_us + 1'000'000;

  int any(std::size_t count) { return static_cast<int>(random_() % count); }
  hardware::Fault& fault(Kind kind) {
    hardware::Fault f;
    f.kind = kind;
    return scene_.faults.emplace_back(f);
  }
  [[nodiscard]] const design::RoutedModule& routed(int module) const {
    for (const design::Patch& p : scene_.design.patches) {
      const auto found = std::ranges::find(p.modules, module, &design::RoutedModule::node);
      if (found != p.modules.end()) return *found;
    }
    throw std::logic_error("a module of no patch");
  }
  [[nodiscard]] int patch_of(int module) const {
    for (std::size_t p = 0; p < scene_.design.patches.size(); ++p) {
      if (std::ranges::count(scene_.design.patches[p].modules, module, &design::RoutedModule::node) > 0)
        return static_cast<int>(p);
    }
    return -1;
  }
  [[nodiscard]] std::set<int> behind(int module) const {
    std::set<int> all{module};
    for (const auto& m : scene_.design.patches[static_cast<std::size_t>(patch_of(module))].modules) {
      if (all.contains(m.parent)) all.insert(m.node);  // Parents precede children.
    }
    return all;
  }

  // Returns false if the cause is not possible at what was drawn.
  bool draw(Cause cause, std::uint64_t seed) {
    cause_ = cause;
    modules_.clear();
    patch_ = line_ = taxel_ = -1;
    const std::vector<std::vector<int>> kCovers{{13}, {16, 11}, {16, 16, 7}, {12, 5}};
    scene_.design = blob(kCovers[static_cast<std::size_t>(any(kCovers.size()))], random_());
    scene_.seed = seed + 1;
    scene_.effects.converters.drawn = true;
    const int module = any(scene_.design.layout.modules.size());
    patch_ = patch_of(module);
    switch (cause) {
      case Cause::kNone:
        return true;
      case Cause::kSupplyDrop:
        return draw_supply();
      case Cause::kBrokenTrace: {
        line_ = any(layout::kLines);
        for (const int m : behind(module)) {
          if (routed(m).line == line_) modules_.insert(m);
        }
        hardware::Fault& f = fault(Kind::kOpenLine);
        f.module = layout::ModuleId{module};
        f.line = line_;
        return !modules_.empty();
      }
      case Cause::kLineHeld: {
        line_ = routed(module).line;
        hardware::Fault& f = fault(Kind::kStuckLine);
        f.patch = layout::PatchIndex{patch_};
        f.line = line_;
        f.stuck_scl = any(2) == 0;
        return true;
      }
      case Cause::kOtherFirmware: {
        hardware::Fault& f = fault(Kind::kOtherFirmware);
        f.patch = layout::PatchIndex{patch_};
        f.value = 2 + any(9);
        f.from_us = kVerifyAt_us - 1'000'000;
        return true;
      }
      case Cause::kWrongAddress: {
        hardware::Fault& f = fault(Kind::kMovedChip);
        f.module = layout::ModuleId{module};
        f.line = any(layout::kLines);
        f.address = any(layout::kAddressesPerLine);
        modules_ = {module};
        const auto& row = routed(module);
        return f.line != row.line || f.address != row.address;
      }
      case Cause::kBrokenStrap: {  // It answers beside another module of its line, with its own configuration.
        hardware::Fault& f = fault(Kind::kMovedChip);
        f.module = layout::ModuleId{module};
        f.line = routed(module).line;
        f.address = any(layout::kAddressesPerLine);
        f.from_us = kVerifyAt_us - 2'000'000;
        modules_ = {module};
        return std::ranges::any_of(scene_.design.patches[static_cast<std::size_t>(patch_)].modules, [&](const auto& m) {
          return m.node != module && m.line == f.line && m.address == f.address;
        });
      }
      case Cause::kSameNumber: {
        const int other = any(scene_.design.patches.size());
        hardware::Fault& f = fault(Kind::kSameNumber);
        f.patch = layout::PatchIndex{other};
        f.other_patch = layout::PatchIndex{patch_};
        f.from_us = kVerifyAt_us - 1'000'000;
        return other != patch_;
      }
      case Cause::kDriftingChip: {
        hardware::Fault& f = fault(Kind::kDriftingChip);
        f.module = layout::ModuleId{module};
        f.value = (20 + any(181)) * (any(2) == 0 ? 1 : -1);
        modules_ = {module};
        return true;
      }
      case Cause::kStuckTaxel: {
        hardware::Fault& f = fault(Kind::kFrozenTaxel);
        f.module = layout::ModuleId{module};
        f.taxel = layout::TaxelIndex{taxel_ = any(layout::kTaxelsPerModule)};
        modules_ = {module};
        return layout::measures_pressure(static_cast<std::size_t>(taxel_));
      }
      case Cause::kLoosePlug: {
        hardware::Fault& f = fault(Kind::kLoosePlug);
        f.module = layout::ModuleId{module};
        f.from_us = kHappens_us;
        f.until_us = kHappens_us + 200'000 + 100'000 * static_cast<std::uint64_t>(any(6));
        modules_ = behind(module);
        return true;
      }
      default:
        return draw_switched(cause, module);
    }
  }

  // From power-up on, or since a moment before `verify`.
  bool draw_switched(Cause cause, int module) {
    static constexpr std::array kKinds{Kind::kDeadModule,    Kind::kOpenJoint,    Kind::kShortedJoint, Kind::kHeldLine,
                                       Kind::kRotatedModule, Kind::kSwappedChips, Kind::kModuleReset};
    scene_.switched = true;
    const int parent = routed(module).parent;
    hardware::Fault& f = fault(kKinds[static_cast<std::size_t>(cause) - static_cast<std::size_t>(Cause::kDeadModule)]);
    f.module = layout::ModuleId{module};
    modules_ = {module};
    if (any(2) == 0 && cause != Cause::kTurnedModule && cause != Cause::kExchangedModules)
      f.from_us = kVerifyAt_us - 2'000'000;
    if (cause == Cause::kOpenJoint || cause == Cause::kShortedJoint) f.other = layout::ModuleId{parent};
    if (cause == Cause::kModuleHoldsLine) f.line = line_ = any(layout::kLines);
    if (cause == Cause::kTurnedModule) f.value = 1 + any(2);
    if (cause == Cause::kModuleReset) f.from_us = kVerifyAt_us - 1'000'000;
    if (cause == Cause::kExchangedModules) f.other = layout::ModuleId{any(scene_.design.layout.modules.size())};
    if (f.other >= 0) modules_.insert(f.other);
    const bool needs_parent = cause == Cause::kOpenJoint || cause == Cause::kShortedJoint;
    // Switched modules of one rotation may be exchanged: the controller gives them their addresses.
    const bool differs = cause != Cause::kExchangedModules || (f.other != f.module && patch_of(f.other) == patch_ &&
                                                               routed(f.other).rotation != routed(module).rotation);
    return (!needs_parent || parent >= 0) && differs;
  }

  // Two to six modules of one patch lose the most on the way; the others have enough.
  bool draw_supply() {
    hardware::SupplyEffect supply;
    supply.joint_ohm = 0.05 + 0.05 * any(10);
    std::vector<std::pair<double, int>> drops;
    for (const design::Patch& p : scene_.design.patches) {
      const auto of_patch = hardware::supply_drops_v(supply, p);
      for (std::size_t k = 0; k < of_patch.size(); ++k) drops.emplace_back(of_patch[k], p.modules[k].node);
    }
    std::ranges::sort(drops, std::greater{});
    const auto count = static_cast<std::size_t>(2 + any(5));
    if (count >= drops.size() || drops[count - 1].first - drops[count].first < 1e-9) return false;
    for (std::size_t k = 0; k < count; ++k) modules_.insert(drops[k].second);
    patch_ = patch_of(*modules_.begin());
    const double too_low_v = supply.brown_out_v + (drops[count - 1].first + drops[count].first) / 2.0;
    if (any(2) == 0)
      supply.volts = {{0, too_low_v}};
    else
      supply.volts = {{0, 3.3},
                      {kHappens_us, 3.3},
                      {kHappens_us, too_low_v},
                      {kHappens_us + 400'000, too_low_v},
                      {kHappens_us + 400'000, 3.3}};
    scene_.effects.pads.supply = supply;
    return std::ranges::all_of(modules_, [&](int m) { return patch_of(m) == patch_; });
  }

  [[nodiscard]] bool names_the_place(const diagnose::Finding& f) const {
    std::set<int> named;
    for (const layout::ModuleId m : f.behind) named.insert(m);
    if (f.line < 0 || cause_ == Cause::kWrongAddress || cause_ == Cause::kBrokenStrap || modules_.contains(f.module))
      named.insert(f.module);
    switch (cause_) {
      case Cause::kSupplyDrop:
      case Cause::kBrokenTrace:
      case Cause::kLoosePlug:
        return f.patch == patch_ && named == modules_;
      case Cause::kLineHeld:
        return f.patch == patch_ && f.line == line_;
      case Cause::kOtherFirmware:
      case Cause::kSameNumber:
        return f.patch == patch_;
      case Cause::kStuckTaxel:
        return modules_.contains(f.module) && f.taxel == taxel_;
      case Cause::kWrongAddress:
      case Cause::kBrokenStrap:
      case Cause::kDriftingChip:
        return modules_.contains(f.module);
      case Cause::kDeadModule:
      case Cause::kOpenJoint:
      case Cause::kShortedJoint:
      case Cause::kModuleHoldsLine:
      case Cause::kTurnedModule:
      case Cause::kExchangedModules:
        return f.patch == patch_ &&
               (modules_.contains(f.module) || modules_.contains(f.other) || (f.line >= 0 && f.line == line_));
      case Cause::kModuleReset:
      case Cause::kNone:
        break;
    }
    return false;
  }

  [[nodiscard]] Told judge(const std::vector<diagnose::Finding>& findings) const {
    using K = diagnose::FindingKind;
    Told told;
    std::map<std::string, int> kinds;
    for (const diagnose::Finding& f : findings) {
      ++kinds[std::string(diagnose::kFindingKindNames.name(f.kind))];
      told.text += f.text + " | " + f.remedy + "\n";
    }
    for (const auto& [kind, count] : kinds)
      told.findings += (told.findings.empty() ? "" : ", ") + kind + (count > 1 ? fmt::format(" ×{}", count) : "");
    // The controller finds the way again by itself, within milliseconds.
    const bool heals = cause_ == Cause::kNone || cause_ == Cause::kModuleReset;
    if (heals) told.verdict = findings.empty() ? Verdict::kRight : Verdict::kWrong;
    if (findings.empty() || heals) return told;
    told.verdict = Verdict::kMany;
    if (findings.size() > 1) return told;
    const diagnose::Finding& f = findings[0];
    told.verdict = Verdict::kWrong;
    if (!names_the_place(f)) return told;
    const auto says = [&](const std::string& word) { return (f.text + f.remedy).find(word) != std::string::npos; };
    const auto is = [&](std::initializer_list<K> right) { return std::ranges::count(right, f.kind) > 0; };
    bool right = false, both = false;
    switch (cause_) {
      case Cause::kSupplyDrop:
        right = is({K::kSaggingSupply});
        both = is({K::kMissingJoint, K::kLooseJoint}) && says("the supply is too low");
        break;
      case Cause::kBrokenTrace:
        right = is({K::kMissingJoint}) && f.line == line_;
        // All modules behind the joint may be of this line, or only one of them.
        both = right ? says("fail") || says("the supply is too low")
                     : is({K::kMissingJoint, K::kAbsentModule}) && says("joint");
        break;
      case Cause::kLineHeld:
        right = is({K::kStuckLine});
        break;
      case Cause::kOtherFirmware:
        right = is({K::kWrongFirmware});
        break;
      case Cause::kWrongAddress:
        right = is({K::kWrongAddress, K::kDuplicateAddress});
        break;
      case Cause::kBrokenStrap:
        right = is({K::kDuplicateAddress});
        break;
      case Cause::kSameNumber:
        right = is({K::kDuplicateController});
        break;
      case Cause::kDriftingChip:
        right = is({K::kDriftingChip});
        break;
      case Cause::kStuckTaxel:
        right = is({K::kFrozenTaxel});
        break;
      case Cause::kLoosePlug:
        // With one module behind it the plug is that of the module.
        right = is({K::kLooseJoint}) || (modules_.size() == 1 && is({K::kIntermittentModule}));
        both = right && says("the supply is too low");
        break;
      case Cause::kDeadModule:  // At the end of a branch it looks like its joint.
        right = is({K::kMissingModule});
        both = is({K::kMissingJoint}) && says(fmt::format("module {}", *modules_.begin())) && says("dead");
        break;
      case Cause::kOpenJoint:
      case Cause::kShortedJoint:
        right = is({K::kMissingJoint});
        both = is({K::kMissingModule}) && says("joints");
        break;
      case Cause::kModuleHoldsLine:
        right = is({K::kStuckLine}) || says("was held low until this was left out");
        both = !right && is({K::kMissingModule, K::kMissingJoint}) && says("a line of the bus low");
        break;
      case Cause::kTurnedModule:
        right = is({K::kRotatedModule});
        break;
      case Cause::kExchangedModules:
        right = is({K::kSwappedModules});
        break;
      case Cause::kModuleReset:
      case Cause::kNone:
        break;
    }
    if (right || both) told.verdict = both ? Verdict::kBoth : Verdict::kRight;
    return told;
  }

  Cause cause_ = Cause::kNone;
  std::mt19937_64 random_;
  hardware::Scene scene_;
  std::set<int> modules_;  // that the cause concerns
  int patch_ = -1, line_ = -1, taxel_ = -1;
};

/// Draws of one cause, counted by verdict and by what was found.
struct CauseScore {
  int draws = 0;
  std::array<int, 5> verdicts{};       ///< by CauseDraw::Verdict
  std::map<std::string, int> found;    ///< by the kinds of the findings
  std::vector<std::string> not_right;  ///< seed and words of those that are neither right nor named beside another
  [[nodiscard]] int of(CauseDraw::Verdict v) const { return verdicts[static_cast<std::size_t>(v)]; }
};

[[nodiscard]] inline CauseScore score_of(Cause cause, std::uint64_t first_seed, int draws) {
  CauseScore score;
  for (int k = 0; k < draws; ++k) {
    const std::uint64_t seed = first_seed + static_cast<std::uint64_t>(k);
    const CauseDraw::Told told = CauseDraw(cause, seed).verify();
    ++score.draws;
    ++score.verdicts[static_cast<std::size_t>(told.verdict)];
    ++score.found[told.findings.empty() ? "none" : told.findings];
    if (told.verdict != CauseDraw::Verdict::kRight && told.verdict != CauseDraw::Verdict::kBoth)
      score.not_right.push_back(fmt::format("seed {}: {}", seed, told.text));
  }
  return score;
}

}  // namespace triskin::test
