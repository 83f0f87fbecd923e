// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <string>
#include <vector>

#include "triskin/session/bus.hpp"
#include "verification.hpp"

namespace triskin::device {

/// A finding that concerns the controller of `patch` and no module.
[[nodiscard]] Finding controller_finding(FindingKind kind, int patch, std::string text, std::string remedy);

/// Whether the controllers are there and hold the tables of the design. One cause gives one finding, however many
/// patches it concerns.
class ControllerCheck {
 public:
  /// Asks who is on the bus. Throws DeviceError when nobody answers.
  ControllerCheck(Bus& bus, const design::Design& design);
  /// True: the patch can be asked further. False: why not is a finding, now or after summarise(). Throws DeviceError.
  bool check(PatchState& p, std::vector<Finding>& findings);
  /// Adds what concerns several patches together: controllers without a table, and those of another design.
  void summarise(std::vector<Finding>& findings) const;

 private:
  bool differs_in_kinds(const PatchState& p, Controller& c, const wire::ActiveTable& active,
                        std::vector<Finding>& findings);
  [[nodiscard]] std::string name_of_kind(int kind) const;
  bool runs_on_backup(PatchState& p, std::uint32_t crc, std::vector<Finding>& findings);
  void note_missing(int patch, int node);
  [[nodiscard]] std::vector<std::string> serials_at(int node) const;
  [[nodiscard]] Finding unflashed_finding() const;
  [[nodiscard]] Finding duplicate_finding(int patch, const std::vector<int>& without) const;
  [[nodiscard]] Finding other_design_finding(std::uint64_t held, const std::vector<int>& patches) const;

  Bus& bus_;
  const design::Design& design_;
  std::vector<wire::NodeClaim> claims_;
  std::map<int, std::size_t> with_table_;  // By node address: how many controllers with a table have it.
  std::size_t without_table_ = 0;
  std::vector<int> doubled_;                           // Patches whose node address several controllers have.
  std::vector<int> absent_;                            // Patches whose node address nobody has.
  std::vector<int> unflashed_;                         // Patches without a controller while some have no table.
  std::map<std::uint64_t, std::vector<int>> foreign_;  // By the design of the table: the patches it was found at.
};

}  // namespace triskin::device
