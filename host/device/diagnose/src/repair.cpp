// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/diagnose/repair.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "cover_place.hpp"
#include "rules.hpp"
#include "triskin/design/straps.hpp"
#include "triskin/session/patch_table.hpp"

namespace triskin::diagnose {
namespace {

Work work_of(const Finding& finding) {
  return finding.held_design != 0 ? Work::kOtherDesign : work_of(finding.kind);
}

bool at_the_bench(Work work) {
  return work != Work::kFlash && work != Work::kOtherDesign && work != Work::kTare && work != Work::kLook;
}

class Guide {
 public:
  Guide(const design::Design& design, const Finding& finding, const std::string& arguments)
      : design_(design), finding_(finding), arguments_(arguments), wiring_(design::wiring_of(design)) {}

  std::vector<std::string> run() {
    const Work work = work_of(finding_);
    const bool bench = at_the_bench(work);
    if (bench) {
      steps_.push_back(fmt::format(
          "keep what the controllers hold: triskin flash {} --save before_repair.json --dry-run", arguments_));
      steps_.emplace_back("switch the supply of the skin off");
    }
    by_hand(work);
    if (bench) steps_.emplace_back("switch the supply on");
    flash(work);
    if (work != Work::kLook)
      steps_.push_back(fmt::format("take everything off the skin: triskin live {} --tare --seconds 1", arguments_));
    steps_.push_back(fmt::format("triskin verify {} --touch: this finding is gone", arguments_));
    return std::move(steps_);
  }

 private:
  void flash(Work work) {
    if (work == Work::kTare || work == Work::kLook) return;
    const char* why = at_the_bench(work) ? " (equal tables are skipped; a new controller gets its own)" : "";
    const char* over = work == Work::kOtherDesign ? " --take-over" : "";
    steps_.push_back(
        fmt::format("{}triskin flash {}{}{}", work == Work::kOtherDesign ? "otherwise: " : "", arguments_, over, why));
  }
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
        for (const layout::ModuleId m : {finding_.module, finding_.other}) {
          find(m);
          straps(m);
        }
        break;
      case Work::kJoint:
        find(finding_.module);
        joint();
        break;
      case Work::kPart:
        find(finding_.module);
        find(finding_.other);
        steps_.push_back(finding_.remedy);
        break;
      case Work::kShort:
        line();
        break;
      case Work::kTurn:
        find(finding_.module);
        joints(finding_.module, "unsolder the joints of the module", "turn it and solder it in again");
        straps(finding_.module);
        break;
      case Work::kOtherDesign:
        other_file();
        break;
      case Work::kCable:
      case Work::kLook:
        if (!finding_.place.empty()) steps_.push_back("find the " + finding_.place);
        steps_.push_back(finding_.remedy);
        break;
      case Work::kFlash:
      case Work::kTare:
        break;
    }
  }
  void other_file() {
    const std::string file = finding_.held_file.empty()
                                 ? fmt::format("the file of design {:016x}", finding_.held_design)
                                 : finding_.held_file;
    const std::size_t first_word = std::min(arguments_.find(' '), arguments_.size());
    steps_.push_back(fmt::format("is this skin meant to be {}? Then nothing is wrong with it: triskin verify {}{}",
                                 file, finding_.held_file.empty() ? "FILE" : finding_.held_file,
                                 arguments_.substr(first_word)));
  }
  // Lists the modules of the line from the far end of the tree: the line is free once the module with the short is
  // separated.
  void line() {
    if (finding_.patch < 0) return;
    std::vector<design::ModuleNumber> far_first;
    for (const auto& m : design_.patches.at(static_cast<std::size_t>(finding_.patch)).modules) {
      if (m.line == finding_.line) far_first.insert(far_first.begin(), number(m.node));
    }
    steps_.push_back(fmt::format("measure SDA and SCL of line L{} of patch {} against ground and supply at its cable",
                                 finding_.line, finding_.patch));
    steps_.push_back(
        fmt::format("part the joints towards its modules, from the far end on, until the short is gone: {}; mend the "
                    "module or joint that was parted last, and solder the others again",
                    fmt::join(far_first, ", ")));
  }
  [[nodiscard]] design::ModuleNumber number(int module) const { return design::number_of(design_, module); }
  [[nodiscard]] bool known(layout::ModuleId module) const {
    return module >= 0 && module < static_cast<int>(wiring_.size()) &&
           wiring_[static_cast<std::size_t>(module)].patch >= 0;
  }
  void find(layout::ModuleId module) {
    if (!known(module)) return;
    steps_.push_back(fmt::format("find module {} of patch {} ({})", number(module),
                                 wiring_[static_cast<std::size_t>(module)].patch, place_on_cover(design_, module)));
  }
  void straps(layout::ModuleId module) {
    if (!known(module)) return;
    const design::RoutedModule& m = wiring_[static_cast<std::size_t>(module)].routed;
    steps_.push_back(
        fmt::format("module {}: port A at side {}; close the straps of line L{} and {}, no others (switched "
                    "modules have none)",
                    number(module), m.rotation, m.line, design::address_strap(m.address)));
  }

  // Names both ends of a joint; a port without one has the cable.
  [[nodiscard]] std::string port_text(const layout::PatchImage& image, std::size_t row, std::size_t port) const {
    const layout::ModuleRow& own = image.modules[row];
    const std::string side = fmt::format("side {} (port {})", (port + own.rotation) % 3, "ABC"[port]);
    const std::uint8_t far = own.joints[port];
    if (far == 0) return side + " to the cable";
    const layout::ModuleRow& other = image.modules[layout::joint_row(far)];
    return fmt::format("{} to side {} of module {}", side, (layout::joint_port(far) + other.rotation) % 3,
                       number(session::module_of(design_, other)));
  }
  // Names both ends of each joint and whether the tree uses it.
  void joints(layout::ModuleId module, const char* before, const char* after) {
    if (!known(module)) return;
    const layout::PatchIndex patch = wiring_[static_cast<std::size_t>(module)].patch;
    const layout::PatchImage image = session::image_of(design_, patch);
    const auto rows = image.rows();
    const auto id_of = [this](const layout::ModuleRow& r) { return session::module_of(design_, r); };
    const auto row = static_cast<std::size_t>(std::ranges::find(rows, module, id_of) - rows.begin());
    const auto kept = layout::kept_ports(image);
    std::vector<std::string> carrying, cut;
    for (std::size_t port = 0; port < layout::kPorts; ++port) {
      const bool carries = (kept[row] >> port & 1) != 0;
      const bool has_joint = image.modules[row].joints[port] != 0;
      if (carries || has_joint) (carries ? carrying : cut).push_back(port_text(image, row, port));
    }
    steps_.push_back(fmt::format("{}: {}", before, fmt::join(carrying, ", ")));
    steps_.push_back(
        fmt::format("{}, with the joints that carry the lines: {}{}", after, fmt::join(carrying, ", "),
                    cut.empty() ? "" : fmt::format("; on strapped modules these stay cut: {}", fmt::join(cut, ", "))));
  }

  // Names the joint to `other`, or the one towards the controller.
  void joint() {
    const layout::ModuleId module = finding_.module;
    if (!known(module)) return;
    const auto& wiring = wiring_[static_cast<std::size_t>(module)];
    const layout::ModuleId other = finding_.other >= 0 ? finding_.other : layout::ModuleId{wiring.routed.parent};
    if (finding_.line >= 0)
      steps_.push_back(
          fmt::format("measure SDA and SCL of line L{} from the cable of patch {} to module {}: find where "
                      "one of the two is open",
                      finding_.line, wiring.patch, number(module)));
    if (other < 0) {
      steps_.push_back(fmt::format("look at the cable of patch {} and its plug at module {}; solder or plug it anew",
                                   wiring.patch, number(module)));
      return;
    }
    steps_.push_back(fmt::format("look at {}; solder it anew, all pads of it", joint_text(design_, module, other)));
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

}  // namespace triskin::diagnose
