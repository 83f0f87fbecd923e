// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <string>
#include <vector>

#include "triskin/session/bus.hpp"
#include "verification.hpp"

namespace triskin::diagnose {

/// Makes a finding that concerns the controller of `patch` and no module.
template <class... Words>
[[nodiscard]] Finding controller_finding(Seen seen, layout::PatchIndex patch, const Words&... words) {
  Finding f = finding(seen, fmt::arg("patch", patch), words...);
  f.patch = patch;
  return f;
}

/// Checks that the controllers are present and have the tables of the design. One cause gives one finding, however many
/// patches it concerns.
class ControllerCheck {
 public:
  /// Asks which controllers are on the bus. Throws DeviceError when none answers.
  ControllerCheck(session::Bus& bus, const design::Design& design);
  /// Returns true if more can be read from the patch. If false, the reason becomes a finding, now or in summarise().
  /// Throws DeviceError.
  bool check(PatchState& p, std::vector<Finding>& findings);
  /// Adds findings that concern several patches together: controllers without a table, and those of another design.
  /// Asks controllers at addresses that the design does not use if patches lack theirs. Throws DeviceError.
  void summarise(std::vector<Finding>& findings);

 private:
  bool differs_in_kinds(const PatchState& p, session::Controller& c, const wire::ActiveTable& active,
                        std::vector<Finding>& findings);
  [[nodiscard]] std::string name_of_kind(int kind) const;
  bool runs_on_backup(PatchState& p, std::uint32_t crc, std::vector<Finding>& findings);
  [[nodiscard]] std::vector<std::string> serials_at(layout::NodeAddress node) const;
  [[nodiscard]] bool has_identify_table(std::uint8_t node);
  [[nodiscard]] std::size_t count_new_controllers();
  [[nodiscard]] Finding unflashed_finding(std::size_t new_controllers) const;
  [[nodiscard]] Finding duplicate_finding(layout::PatchIndex patch,
                                          const std::vector<layout::PatchIndex>& without) const;
  [[nodiscard]] Finding other_design_finding(std::uint64_t held, const std::vector<layout::PatchIndex>& patches) const;

  session::Bus& bus_;
  const design::Design& design_;
  std::vector<wire::NodeClaim> claims_;
  // The map counts the controllers with a table at each node address.
  std::map<layout::NodeAddress, std::size_t> with_table_;
  std::vector<layout::PatchIndex> doubled_;  // Several controllers have the node address of these patches.
  std::vector<layout::PatchIndex> absent_;   // No controller with a table of a design has the node address of these.
  // For the design of each foreign table, the map has the patches where it was found.
  std::map<std::uint64_t, std::vector<layout::PatchIndex>> foreign_;
};

}  // namespace triskin::diagnose
