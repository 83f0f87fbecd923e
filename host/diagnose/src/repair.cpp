// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/diagnose/repair.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "triskin/session/patch_table.hpp"

namespace triskin::device {
namespace {

// Work that a person has to do at the patch.
enum class Work {
  kNone,
  kFlash,       // the tables are wrong
  kReplace,     // take the module out, put a new one in
  kStrap,       // its straps are wrong
  kPlace,       // several modules sit at wrong places
  kJoint,       // solder a joint anew
  kTurn,        // the module is turned
  kCable,       // cables of controllers, lines of a cable
  kController,  // a controller does not answer
};

Work work_of(FindingKind kind) {
  switch (kind) {
    case FindingKind::kNotFlashed:
    case FindingKind::kWrongTable:
      return Work::kFlash;
    case FindingKind::kAbsentController:
    case FindingKind::kDuplicateController:
      return Work::kController;
    case FindingKind::kAbsentModule:
    case FindingKind::kMissingModule:
    case FindingKind::kWrongId:
    case FindingKind::kSaturatedTaxel:
    case FindingKind::kFrozenTaxel:
    case FindingKind::kNoTouchResponse:
      return Work::kReplace;
    case FindingKind::kWrongAddress:
    case FindingKind::kDuplicateAddress:
      return Work::kStrap;
    case FindingKind::kSwappedModules:
    case FindingKind::kWrongOrder:
    case FindingKind::kTouchedOtherModule:
      return Work::kPlace;
    case FindingKind::kIntermittentModule:
    case FindingKind::kLostConfiguration:
    case FindingKind::kMissingJoint:
    case FindingKind::kAdoptedModule:
    case FindingKind::kLooseJoint:
    case FindingKind::kSaggingSupply:
      return Work::kJoint;
    case FindingKind::kRotatedModule:
      return Work::kTurn;
    case FindingKind::kWrongPatch:
    case FindingKind::kSwappedLines:
    case FindingKind::kMirroredPatch:
    case FindingKind::kWrongEntry:
    case FindingKind::kSecondCable:
      return Work::kCable;
    default:
      return Work::kNone;
  }
}

class Guide {
 public:
  Guide(const design::Design& design, const Finding& finding, const std::string& arguments)
      : design_(design), finding_(finding), arguments_(arguments), wiring_(design::wiring_of(design)) {}

  std::vector<std::string> run() {
    const Work work = work_of(finding_.kind);
    if (work == Work::kNone) return {};
    if (work != Work::kFlash) {
      steps_.push_back(fmt::format(
          "keep what the controllers hold: triskin flash {} --save before_repair.json --dry-run", arguments_));
      steps_.emplace_back("switch the supply of the skin off");
    }
    by_hand(work);
    if (work != Work::kFlash) steps_.emplace_back("switch the supply on");
    steps_.push_back(
        fmt::format("triskin flash {}{}", arguments_,
                    work == Work::kFlash ? "" : " (equal tables are skipped; a new controller gets its own)"));
    steps_.push_back(fmt::format("triskin verify {} --touch: this finding is gone", arguments_));
    return std::move(steps_);
  }

 private:
  void by_hand(Work work) {
    switch (work) {
      case Work::kReplace:
        find(finding_.module);
        joints(finding_.module, "unsolder the joints of the module and take it out", "solder the new module in");
        straps(finding_.module);
        break;
      case Work::kStrap:
        find(finding_.module);
        straps(finding_.module);
        break;
      case Work::kPlace:
        for (const int m : {finding_.module, finding_.other}) {
          find(m);
          straps(m);
        }
        break;
      case Work::kJoint:
        find(finding_.module);
        joint();
        break;
      case Work::kTurn:
        find(finding_.module);
        joints(finding_.module, "unsolder the joints of the module", "turn it and solder it in again");
        straps(finding_.module);
        break;
      default:
        if (work != Work::kFlash) steps_.push_back(finding_.remedy);
        break;
    }
  }
  [[nodiscard]] bool known(int module) const {
    return module >= 0 && module < static_cast<int>(wiring_.size()) &&
           wiring_[static_cast<std::size_t>(module)].patch >= 0;
  }
  void find(int module) {
    if (!known(module)) return;
    const std::string place = module == finding_.module ? finding_.place : "";
    steps_.push_back(fmt::format("find module {} of patch {}{}", module,
                                 wiring_[static_cast<std::size_t>(module)].patch,
                                 place.empty() ? "" : fmt::format(" ({})", place)));
  }
  void straps(int module) {
    if (!known(module)) return;
    const design::RoutedModule& m = wiring_[static_cast<std::size_t>(module)].routed;
    steps_.push_back(
        fmt::format("module {}: port A at side {}; close the straps of line {} and address {}, no others (switched "
                    "modules have none)",
                    module, m.rotation, m.line, m.address));
  }

  // Both ends of each joint, and whether the tree uses it.
  void joints(int module, const char* before, const char* after) {
    if (!known(module)) return;
    const int patch = wiring_[static_cast<std::size_t>(module)].patch;
    const layout::PatchImage image = image_of(design_, patch);
    const auto rows = image.rows();
    const auto id_of = [this](const layout::ModuleRow& r) { return module_of(design_, r); };
    const auto row = static_cast<std::size_t>(std::ranges::find(rows, module, id_of) - rows.begin());
    const auto kept = layout::kept_ports(image);
    std::vector<std::string> carrying, cut;
    for (std::size_t port = 0; port < layout::kPorts; ++port) {
      const std::uint8_t far = image.modules[row].joints[port];
      const bool carries = (kept[row] >> port & 1) != 0;
      const std::string side = fmt::format("side {} (port {})", (port + image.modules[row].rotation) % 3, "ABC"[port]);
      if (far == 0) {
        if (carries) carrying.push_back(side + " to the cable");
        continue;
      }
      const layout::ModuleRow& other = image.modules[layout::joint_row(far)];
      const std::string joint =
          fmt::format("{} to side {} of module {}", side, (layout::joint_port(far) + other.rotation) % 3, id_of(other));
      (carries ? carrying : cut).push_back(joint);
    }
    steps_.push_back(fmt::format("{}: {}", before, fmt::join(carrying, ", ")));
    steps_.push_back(
        fmt::format("{}, with the joints that carry the lines: {}{}", after, fmt::join(carrying, ", "),
                    cut.empty() ? "" : fmt::format("; on strapped modules these stay cut: {}", fmt::join(cut, ", "))));
  }

  // The joint to `other`, or the one towards the controller.
  void joint() {
    const int module = finding_.module;
    if (!known(module)) return;
    const auto& wiring = wiring_[static_cast<std::size_t>(module)];
    const int other = finding_.other >= 0 ? finding_.other : wiring.routed.parent;
    if (other < 0) {
      steps_.push_back(fmt::format("look at the cable of patch {} and its plug at module {}; solder or plug it anew",
                                   wiring.patch, module));
      return;
    }
    const auto& neighbour = design_.layout.modules[static_cast<std::size_t>(module)].neighbour;
    const auto side = std::ranges::find(neighbour, other);
    steps_.push_back(
        fmt::format("look at the joint between module {}{} and module {}; solder it anew, all pads of it", module,
                    side == neighbour.end() ? "" : fmt::format(" (its side {})", side - neighbour.begin()), other));
  }

  const design::Design& design_;
  const Finding& finding_;
  const std::string& arguments_;
  std::vector<design::ModuleWiring> wiring_;
  std::vector<std::string> steps_;
};

}  // namespace

std::vector<std::string> repair_steps(const design::Design& design, const Finding& finding,
                                      const std::string& arguments) {
  return Guide(design, finding, arguments).run();
}

}  // namespace triskin::device
