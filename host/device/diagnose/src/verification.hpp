// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <bitset>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "rules.hpp"
#include "triskin/diagnose/verify.hpp"
#include "triskin/session/controller.hpp"
#include "triskin/session/patch_table.hpp"

namespace triskin::diagnose {

/// The state collects the answers of one patch. Rows are those of the table `image`; with a backup table their order
/// differs from the design's patch.
struct PatchState {
  layout::PatchIndex patch;
  layout::PatchImage image;
  bool on_backup = false;  ///< `image` is the table that the design prepared for a failure.
  bool usable = false;     ///< The controller answers and has this table.
  wire::ModuleStates states;
  std::array<wire::LineReport, layout::kLines> lines{};
  wire::LineStates line_states;
  std::optional<wire::Crash> crash;
  wire::FaultList earlier;            ///< These faults were in memory when the verification began.
  wire::FaultList faults;             ///< These faults were recorded during the verification.
  wire::LiveTaxels first, rest, now;  ///< before anything else, before the first touch, and at the end
  wire::FoundTopology topology;
  wire::ActiveRoute route;
  wire::Adoption adoption;  ///< The adoption was read at the same time as the samples.
  std::bitset<layout::kLines * layout::kAddressesPerLine>
      adopted_places;  ///< Adopted modules answer at these places, now or earlier.
  void note(const wire::Adoption& told) {
    adoption = told;
    for (const wire::AdoptedModule& g : told.list_of_adopted()) adopted_places.set(g.place);
  }

  [[nodiscard]] session::Controller controller(session::Bus& bus) const { return {bus, image.node_address}; }
  const design::Design* design = nullptr;
  [[nodiscard]] layout::ModuleId module(std::size_t row) const {
    return session::module_of(*design, image.modules[row]);
  }
  /// Returns true if the table has a module; a backup table leaves some out.
  [[nodiscard]] bool reads(layout::ModuleId id) const {
    for (std::size_t row = 0; row < image.module_count; ++row) {
      if (module(row) == id) return true;
    }
    return false;
  }
};

/// The skin responds to the press of a module in this way.
struct TouchOutcome {
  layout::ModuleId module = layout::ModuleId::none();
  /// The taxels of this module changed most; −1 means that none did.
  layout::ModuleId answered = layout::ModuleId::none();
  bool whole = false;  ///< So many taxels of the module changed that the finger must have pressed its centre.
  /// Bit t is set for a pressure taxel of the module that did not change while most others did.
  unsigned silent_taxels = 0;
  /// Pressing a single taxel shows that the module is turned by this many steps of 120°; 0 also means that this was
  /// not tried.
  int turned = 0;
};

/// Presses the modules of all usable patches; without an actuator it waits for a person.
class TouchTest {
 public:
  /// `actuator` presses the modules of the design; null means that a person does.
  TouchTest(session::Bus& bus, link::TouchActuator* actuator, const design::Design& design,
            std::vector<PatchState>& patches)
      : bus_(bus), actuator_(actuator), design_(design), patches_(patches), wiring_(design::wiring_of(design)) {}
  /// Returns empty if the person skipped the module.
  std::optional<TouchOutcome> press(layout::ModuleId module, const PatchState& patch, const VerifyOptions& options);
  void finish();
  /// Reads all taxels at rest. Call it once, before the first press.
  void take_rest();

 private:
  struct Response {
    layout::ModuleId module = layout::ModuleId::none();
    double strength = 0.0;
    unsigned changed = 0;  // Bit t stands for taxel t.
    layout::TaxelIndex taxel = layout::TaxelIndex::none();
    double taxel_counts = 0.0;
  };
  [[nodiscard]] Response strongest(const PatchState& patch) const;
  [[nodiscard]] Response response_to_actuator(layout::ModuleId module, const PatchState& patch);
  [[nodiscard]] Response response_to_person(const PatchState& patch);
  [[nodiscard]] static unsigned silent_taxels(const Response& response);
  Response strongest_anywhere(const PatchState& first);
  [[nodiscard]] Response response_of(const PatchState& patch, std::size_t row, const wire::LiveTaxels& now) const;
  [[nodiscard]] int turned(link::TouchActuator& actuator, layout::ModuleId module, const PatchState& patch);

  session::Bus& bus_;
  link::TouchActuator* actuator_;
  const design::Design& design_;
  std::vector<PatchState>& patches_;
  std::vector<design::ModuleWiring> wiring_;
};

/// Returns how much the temperature pads of a module have changed, on average; warmth affects the other taxels alike.
template <class Rest>
[[nodiscard]] double pads_change_counts(const wire::ModuleTaxels& now, const Rest& rest) {
  double sum = 0.0;
  int pads = 0;
  for (const std::size_t t : layout::kTemperaturePads) {
    if (!now.is_valid(t)) continue;
    sum += static_cast<double>(now.value[t]) - static_cast<double>(rest[t]);
    ++pads;
  }
  return pads == 0 ? 0.0 : sum / pads;
}

struct CableExplanation;
struct TopologyMatch;

/// Turns observations into findings, without using a link. It first looks for exchanged cables and then reads
/// everything else as if they were plugged in correctly, so that one mistake does not hide another. Then it examines
/// the modules in groups that one cause explains. Words and remedies are in rules.cpp.
class Diagnosis {
 public:
  /// `rest` has the rest values, or is empty. References must outlive the diagnosis; other arguments are moved into it.
  Diagnosis(const design::Design& design, std::vector<PatchState> patches, std::vector<TouchOutcome> touches,
            const design::RestValues& rest);
  void run(VerifyResult& result);

 private:
  using Modules = std::set<layout::ModuleId>;
  struct Place {
    int line = 0, address = 0;
  };
  /// One joint, cable, line or supply explains these modules: they are behind `module`.
  struct Branch {
    layout::ModuleId module = layout::ModuleId::none(), parent = layout::ModuleId::none();
    std::vector<layout::ModuleId> members;
  };
  /// What several modules that fail alike are taken for.
  struct Group {
    std::optional<Seen> line;
    Seen supply, joint, alone;
  };

  // The order of the examination.
  void examine_cables();
  void note_adopted();
  void examine_patch(const PatchState& p);
  void examine_topology(const PatchState& p);
  [[nodiscard]] layout::PatchIndex attached_instead(const PatchState& p, const TopologyMatch& match) const;
  [[nodiscard]] std::vector<layout::ModuleId> found_but_silent(const PatchState& p, const TopologyMatch& match) const;
  void examine_missing(const PatchState& p, const Modules& missing);
  void examine_lines(const PatchState& p);
  void examine_history(const PatchState& p);
  void examine_modules(const PatchState& p);
  void examine_absent(const PatchState& p, const std::vector<std::size_t>& rows);
  void examine_taxels(const PatchState& p, std::size_t row);
  void examine_mirrored(const PatchState& p);
  void examine_adoption();
  void examine_drift();
  void examine_touch(const TouchOutcome& t);
  void examine_rest();
  [[nodiscard]] std::vector<Finding> examine_earlier() const;

  // One cause for many modules.
  void explain(const PatchState& p, Modules modules, const Group& group);
  [[nodiscard]] std::vector<Branch> branches(const PatchState& p, const Modules& modules) const;
  [[nodiscard]] std::optional<Branch> open_line(const PatchState& p, int line, const Modules& modules) const;
  [[nodiscard]] layout::ModuleId farthest_of_supply(const PatchState& p, const Modules& modules) const;
  [[nodiscard]] std::optional<std::pair<Seen, layout::ModuleId>> remembered(const PatchState& p,
                                                                            const wire::FaultRecord& fault) const;

  // Which module sits at a place.
  [[nodiscard]] std::vector<Place> unexpected(const PatchState& p) const;
  std::size_t take_likeliest(const PatchState& p, std::vector<std::size_t>& rows, const Place& place) const;
  [[nodiscard]] double cost_of_taking(const PatchState& p, const std::vector<std::size_t>& rows, std::size_t row,
                                      const Place& place) const;
  void add_at(Seen seen, const PatchState& p, std::size_t row, const Place& place,
              layout::ModuleId other = layout::ModuleId::none());
  [[nodiscard]] const TouchOutcome* touch_of(layout::ModuleId module) const;
  [[nodiscard]] std::vector<layout::ModuleId> ring_from(layout::ModuleId module) const;

  [[nodiscard]] std::string where(layout::ModuleId module) const;
  [[nodiscard]] design::ModuleNumber number(layout::ModuleId module) const {
    return design::number_of(design_, module);
  }
  /// Writes "3, 7, 12" for modules.
  template <class Modules>
  [[nodiscard]] std::string list_of(const Modules& modules) const {
    return fmt::format("{}", fmt::join(design::numbers_of(design_, modules), ", "));
  }
  /// These modules are not in order, and nothing else is said about them.
  template <class Range>
  void explained_by_this(const Range& modules) {
    bad_.insert(modules.begin(), modules.end());
    explained_.insert(modules.begin(), modules.end());
  }
  Finding& add(Finding f);
  /// Adds a finding about a module.
  template <class... Words>
  Finding& add(Seen seen, layout::ModuleId module, const Words&... words) {
    Finding f = finding(seen, fmt::arg("where", where(module)), fmt::arg("module", number(module)), words...);
    f.module = module;
    f.patch = wiring_[static_cast<std::size_t>(module)].patch;
    bad_.insert(module);
    return add(std::move(f));
  }
  /// Adds a finding about a patch, its cable or a line.
  template <class... Words>
  Finding& add(Seen seen, layout::PatchIndex patch, const Words&... words) {
    Finding f = finding(seen, fmt::arg("patch", patch), words...);
    f.patch = patch;
    return add(std::move(f));
  }

  const design::Design& design_;
  std::vector<PatchState> patches_;
  std::vector<TouchOutcome> touches_;
  const design::RestValues& rest_;
  std::vector<design::ModuleWiring> wiring_;
  std::vector<Finding> findings_;
  Modules bad_;                            // These modules have a state other than ok.
  Modules explained_;                      // The missing touch response of these modules already has a finding.
  std::set<layout::PatchIndex> left_out_;  // The controllers of these left out a module that held a line.
  // Each adopted module is mapped to the patch whose controller reads it.
  std::map<layout::ModuleId, layout::PatchIndex> adopter_;
};

}  // namespace triskin::diagnose
