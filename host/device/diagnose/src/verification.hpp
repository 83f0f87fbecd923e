// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <bitset>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "triskin/design/off_rest.hpp"
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
  wire::FaultList earlier;  ///< These faults were in memory when the verification began.
  wire::FaultList faults;   ///< These faults were recorded during the verification.
  wire::LiveTaxels now, rest;
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
  bool with_kinds = false;  ///< Both the design and the table have kinds of modules.
  [[nodiscard]] layout::ModuleId module(std::size_t row) const {
    const unsigned id = image.modules[row].module_id;
    return layout::ModuleId{with_kinds ? id % layout::kIdsBesideKinds : id};
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

struct CableExplanation;
struct MissingCause;
struct TopologyDifference;

/// What the fault memory says about modules that answer now: one cause for several modules behind a joint, another one
/// for a single module.
struct PastFault {
  FindingKind together;
  const char* seen_together;  ///< The sentence goes on with the modules.
  const char* remedy_together;
  FindingKind alone;
  const char* seen_alone;
  const char* remedy_alone;
};

/// Turns observations into findings, without using a link. It first looks for exchanged cables and then reads
/// everything else as if they were plugged in correctly, so that one mistake does not hide another. Then it examines
/// the modules in groups that one cause explains. The likeliest explanation is listed first.
class Diagnosis {
 public:
  /// `rest` has the rest values, or is empty. References must outlive the diagnosis; other arguments are moved into it.
  Diagnosis(const design::Design& design, std::vector<PatchState> patches, std::vector<TouchOutcome> touches,
            const design::RestValues& rest);
  void run(VerifyResult& result);

 private:
  struct Place {
    int line = 0, address = 0;
  };
  /// One joint, cable or supply explains these modules: `module` and all modules behind it.
  struct Branch {
    layout::ModuleId module = layout::ModuleId::none(), parent = layout::ModuleId::none();
    std::vector<layout::ModuleId> members;
  };
  [[nodiscard]] std::vector<Branch> branches(const PatchState& p, const std::set<layout::ModuleId>& modules) const;
  /// Modules of one line that are the only ones of it behind a joint: its wires are open there, and others pass.
  [[nodiscard]] std::optional<Branch> open_line(const PatchState& p, int line,
                                                const std::set<layout::ModuleId>& modules) const;
  void add_open_line(FindingKind kind, layout::PatchIndex patch, int line, const Branch& open, std::string text);
  void add_open_lines(FindingKind kind, const PatchState& p, std::set<layout::ModuleId>& modules,
                      const std::string& what);
  [[nodiscard]] std::string behind(const Branch& branch) const;
  void add_branch(FindingKind kind, const PatchState& p, const Branch& branch, const std::string& text,
                  const std::string& remedy);
  /// Adds one finding for each branch of `modules`.
  void add_branches(const PatchState& p, const std::set<layout::ModuleId>& modules, const PastFault& fault);
  [[nodiscard]] double cost_of_taking(const PatchState& p, const std::vector<std::size_t>& rows, std::size_t row,
                                      const Place& place) const;
  std::size_t take_likeliest(const PatchState& p, std::vector<std::size_t>& rows, const Place& place) const;
  void examine_cables();
  void add_exchanged(const CableExplanation& e);
  void examine_mirrored(const PatchState& p);
  [[nodiscard]] std::vector<const TouchOutcome*> whole_touches(layout::PatchIndex patch) const;
  [[nodiscard]] bool keep_distances(const std::vector<const TouchOutcome*>& touches) const;
  void examine_touch(const TouchOutcome& t);
  /// Examines the touch of a module that another one has answered.
  void examine_other_answer(const TouchOutcome& t, layout::PatchIndex patch);
  [[nodiscard]] std::vector<layout::ModuleId> ring_from(layout::ModuleId module) const;
  void examine_silent_taxels(const TouchOutcome& t, layout::PatchIndex patch);
  void add_wrong_address(const PatchState& p, std::size_t row, const Place& place);
  void examine_dips(const PatchState& p, std::set<layout::ModuleId> away, const std::set<layout::ModuleId>& dipped);
  void examine_lines(const PatchState& p);
  void examine_modules(const PatchState& p);
  void examine_doubled(const PatchState& p, std::vector<std::size_t>& absent, const std::vector<std::size_t>& doubled);
  void examine_absent(const PatchState& p, const std::vector<std::size_t>& rows);
  void match_elsewhere(const PatchState& p, std::vector<std::size_t>& open, std::vector<Place>& elsewhere);
  void examine_silent(const PatchState& p, std::set<layout::ModuleId> silent);
  void examine_taxels(const PatchState& p, std::size_t row);
  void add_bad_taxel(layout::ModuleId module, layout::PatchIndex patch, layout::TaxelIndex taxel, bool at_end);
  void examine_patch(const PatchState& p);
  void examine_topology(const PatchState& p);
  void add_wrong_patch(const PatchState& p, const std::string& what);
  void add_difference(const PatchState& p, const TopologyDifference& d);
  void note_adopted();
  void examine_adoption();
  void examine_missing(const PatchState& p, const std::set<layout::ModuleId>& missing);
  [[nodiscard]] std::string broken_joint_text(const MissingCause& c,
                                              const std::vector<layout::ModuleId>& concerned) const;
  [[nodiscard]] static std::string broken_module_text(const MissingCause& c);
  void examine_rest();
  [[nodiscard]] design::OffRest off_rest() const;
  void examine_history(const PatchState& p);
  [[nodiscard]] std::vector<Finding> examine_earlier() const;
  [[nodiscard]] std::optional<Finding> remembered(const PatchState& p, const wire::FaultRecord& fault) const;
  void examine_touches();
  [[nodiscard]] std::vector<Place> unexpected(const PatchState& p) const;
  [[nodiscard]] const TouchOutcome* touch_of(layout::ModuleId module) const;
  [[nodiscard]] std::string where(layout::ModuleId module) const;
  [[nodiscard]] static int strap_difference(const layout::ModuleRow& row, const Place& place);
  void add_duplicate(const PatchState& p, std::size_t row, layout::ModuleId other);
  [[nodiscard]] static std::string at(int line, int address);
  Finding& add(FindingKind kind, layout::ModuleId module, layout::PatchIndex patch, std::string text,
               std::string remedy);

  const design::Design& design_;
  std::vector<PatchState> patches_;
  std::vector<TouchOutcome> touches_;
  const design::RestValues& rest_;
  std::vector<design::ModuleWiring> wiring_;
  std::vector<Finding> findings_;
  std::set<layout::ModuleId> bad_;        // These modules have a state other than ok.
  std::set<layout::ModuleId> explained_;  // The missing touch response of these modules already has a finding.
  // Each adopted module is mapped to the patch whose controller reads it.
  std::map<layout::ModuleId, layout::PatchIndex> adopter_;
};

}  // namespace triskin::diagnose
