// SPDX-License-Identifier: GPL-3.0-or-later
#include "board_match.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>

#include "triskin/session/controller.hpp"

namespace triskin::device {
namespace {

/// Whom a controller belongs to.
enum class Owner {
  kNobody,   // it has no table
  kThis,     // a table of this design
  kAnother,  // a table of another design
  kUnknown,  // a table, and an address that others share: it cannot be asked
};

struct Candidate {
  Board board;
  Owner owner = Owner::kNobody;
  std::uint64_t design_id = 0;
};

class Matcher {
 public:
  Matcher(Bus& bus, const design::Design& design, const FlashOptions& options)
      : bus_(bus), design_(design), options_(options), n_patches_(design.patches.size()) {}

  std::vector<Board> run() {
    find();
    assign_named();
    keep_own();
    fill(Owner::kNobody);
    if (options_.take_over) {
      fill(Owner::kAnother);
      fill(Owner::kUnknown);
    }
    require_all();
    require_addresses();
    std::vector<Board> boards;
    for (const Candidate& c : candidates_) boards.push_back(c.board);
    return boards;
  }

 private:
  void find() {
    const std::vector<wire::NodeClaim> claims = bus_.discover();
    if (claims.empty())
      throw DeviceError(fmt::format("{}: no controller answers; check power, cable and bit rate", bus_.name()));
    std::map<int, int> users;
    for (const auto& c : claims) ++users[c.node_address];
    for (const auto& c : claims) {
      Candidate candidate{{c, -1}, Owner::kNobody, 0};
      if (c.has_table) ask(candidate, users[c.node_address] == 1);
      candidates_.push_back(candidate);
    }
  }
  // A controller whose address nobody shares can be asked which design it serves.
  void ask(Candidate& c, bool alone) {
    c.owner = Owner::kUnknown;
    if (!alone) return;
    const wire::ActiveTable table = Controller(bus_, c.board.claim.node_address).active_table();
    if (!table.present()) return;
    c.design_id = table.design_id;
    c.owner = table.design_id == design_.design_id ? Owner::kThis : Owner::kAnother;
  }

  [[nodiscard]] bool wanted(int patch) const {
    return patch >= 0 && patch < static_cast<int>(n_patches_) && (options_.patch < 0 || options_.patch == patch);
  }
  void give(Candidate& c, int patch) {
    c.board.patch = patch;
    taken_.insert(patch);
  }

  void assign_named() {
    for (const FlashOptions::Assignment& a : options_.assign) {
      if (a.patch < 0 || a.patch >= static_cast<int>(n_patches_))
        throw InputError(
            fmt::format("--assign {}={}: the design has patches 0 … {}", a.patch, a.serial, n_patches_ - 1));
      const auto named = std::ranges::find_if(
          candidates_, [&](const Candidate& c) { return to_text(c.board.claim.unique_id) == a.serial; });
      if (named == candidates_.end())
        throw DeviceError(
            fmt::format("{}: no controller {} answers; triskin discover lists those that do", bus_.name(), a.serial));
      if (named->board.patch >= 0 || taken_.contains(a.patch))
        throw InputError(fmt::format("--assign {}={}: the patch or the controller is named twice", a.patch, a.serial));
      if (wanted(a.patch)) give(*named, a.patch);
    }
  }
  void keep_own() {
    for (Candidate& c : candidates_) {
      const int patch = c.board.claim.node_address - 1;
      if (c.board.patch < 0 && c.owner == Owner::kThis && wanted(patch) && !taken_.contains(patch)) give(c, patch);
    }
  }
  // One patch alone: it must be clear which controller is meant.
  void fill(Owner owner) {
    std::vector<Candidate*> free;
    for (Candidate& c : candidates_) {
      if (c.board.patch < 0 && c.owner == owner) free.push_back(&c);
    }
    if (options_.patch >= 0 && !taken_.contains(options_.patch) && free.size() > 1)
      throw DeviceError(
          fmt::format("{}: {} controllers could be that of patch {}: {}; connect one of them, or name it: "
                      "--assign {}=SERIAL",
                      bus_.name(), free.size(), options_.patch, serials(free), options_.patch));
    auto next = free.begin();
    for (int patch = 0; patch < static_cast<int>(n_patches_) && next != free.end(); ++patch) {
      if (wanted(patch) && !taken_.contains(patch)) give(**next++, patch);
    }
  }

  static std::string serials(const std::vector<Candidate*>& list) {
    std::vector<std::string> names;
    for (const Candidate* c : list) names.push_back(to_text(c->board.claim.unique_id));
    return fmt::format("{}", fmt::join(names, ", "));
  }

  void require_all() const {
    std::vector<int> missing;
    for (int p = 0; p < static_cast<int>(n_patches_); ++p) {
      if (wanted(p) && !taken_.contains(p)) missing.push_back(p);
    }
    if (missing.empty()) return;
    std::vector<std::string> others;
    for (const Candidate& c : candidates_) {
      if (c.board.patch >= 0 || c.owner == Owner::kNobody || c.owner == Owner::kThis) continue;
      others.push_back(fmt::format("{} ({})", to_text(c.board.claim.unique_id),
                                   c.owner == Owner::kAnother
                                       ? fmt::format("design {:016x}", c.design_id)
                                       : fmt::format("shares node address {}", c.board.claim.node_address)));
    }
    if (others.empty())
      throw DeviceError(fmt::format(
          "{}: the design has {} patches, {} controllers answer; connect the others, or flash one patch at a time "
          "(--patch); nothing was written",
          bus_.name(), n_patches_, candidates_.size()));
    throw DeviceError(
        fmt::format("{}: no controller is free for patch{} {}; these hold a table that is not of this design and are "
                    "left alone: {}. "
                    "Name one (--assign PATCH=SERIAL) or take all of them (--take-over); nothing was written",
                    bus_.name(), missing.size() == 1 ? "" : "es", fmt::join(missing, ", "), fmt::join(others, ", ")));
  }

  // The address of a patch may be that of a controller that is none of ours.
  void require_addresses() const {
    for (const Candidate& c : candidates_) {
      const bool theirs = c.owner == Owner::kAnother || c.owner == Owner::kUnknown;
      if (options_.take_over || !theirs || c.board.patch >= 0 || !taken_.contains(c.board.claim.node_address - 1))
        continue;
      throw DeviceError(fmt::format(
          "{}: controller {} holds a table that is not of this design and has node address {}, which patch {} needs; "
          "take "
          "it off the bus, or let it move (--take-over: it must be flashed again then); nothing was written",
          bus_.name(), to_text(c.board.claim.unique_id), c.board.claim.node_address, c.board.claim.node_address - 1));
    }
  }

  Bus& bus_;
  const design::Design& design_;
  const FlashOptions& options_;
  const std::size_t n_patches_;
  std::vector<Candidate> candidates_;
  std::set<int> taken_;
};

}  // namespace

std::vector<Board> match_boards(Bus& bus, const design::Design& design, const FlashOptions& options) {
  if (options.patch >= static_cast<int>(design.patches.size()))
    throw InputError(
        fmt::format("--patch {}: the design has patches 0 … {}", options.patch, design.patches.size() - 1));
  return Matcher(bus, design, options).run();
}

}  // namespace triskin::device
