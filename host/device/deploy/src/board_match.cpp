// SPDX-License-Identifier: GPL-3.0-or-later
#include "board_match.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <exception>
#include <map>
#include <set>

#include "touch_finder.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/short_list.hpp"
#include "triskin/session/address_users.hpp"
#include "triskin/session/controller.hpp"
#include "triskin/session/patch_table.hpp"
#include "triskin/session/scheduler.hpp"

namespace triskin::deploy {
namespace {

/// Tells which design a controller belongs to.
enum class Owner {
  kNobody,     // The controller has no table.
  kThis,       // The controller has a table of this design.
  kAnother,    // The controller has a table of another design.
  kNeighbour,  // FlashOptions::neighbours names the controller, so it is never used.
  kUnknown,    // The controller has a table and shares its address, so it cannot be asked.
  kSilent,     // The controller has a table and did not answer, so it counts as absent unless it is named.
};

struct Candidate {
  Board board;
  Owner owner = Owner::kNobody;
  wire::ActiveTable table;
};

class Matcher {
 public:
  Matcher(session::Bus& bus, const design::Design& design, const FlashOptions& options, BusBoards& known)
      : bus_(bus), design_(design), options_(options), known_(known), here_(design::patches_here(design)) {}

  MatchedBoards run() {
    find(known_.claims);
    assign_named();
    keep_own();
    keep_moved();
    if (missing_.empty()) assign_rest();
    require_all();
    require_addresses();
    MatchedBoards matched;
    for (const Candidate& c : candidates_) matched.boards.push_back(c.board);
    for (const auto& [patch, why] : missing_) matched.missing.push_back({patch, why});
    return matched;
  }

 private:
  // Some controllers cannot be told apart by their shapes.
  struct Undecided {
    std::vector<FeelingBoard> boards;
    std::vector<Candidate*> candidates;
  };

  void assign_rest() {
    if (options_.recognise && neighbours_are_known()) recognise();
    fill(Owner::kNobody);
    if (!options_.take_over) return;
    fill(Owner::kAnother);
    fill(Owner::kUnknown);
  }

  void find(const std::vector<wire::NodeClaim>& claims) {
    if (claims.empty()) throw DeviceError(bus_.nobody_answers());
    const auto users = session::users_of_addresses(claims);
    bool any_answer = false;
    std::exception_ptr silence;
    for (const auto& c : claims) {
      Candidate candidate{{c, layout::PatchIndex::none()}, Owner::kNobody, {}};
      try {
        if (c.has_table) ask(candidate, users.at(c.node_address) == 1);
        any_answer = any_answer || candidate.table.present();
      } catch (const session::NoAnswer&) {
        silence = std::current_exception();
        candidate.owner = Owner::kSilent;
        silent_.push_back(session::to_text(c.unique_id));
      }
      if (is_neighbour(candidate)) candidate.owner = Owner::kNeighbour;
      candidates_.push_back(candidate);
    }
    // If no board answers, the cable is at fault rather than the boards.
    if (silence && !any_answer) std::rethrow_exception(silence);
  }
  // Asks a controller which design it serves, if its address is not shared.
  void ask(Candidate& c, bool alone) {
    c.owner = Owner::kUnknown;
    if (!alone) return;
    const wire::ActiveTable table = session::Controller(bus_, c.board.claim.node_address).active_table();
    if (!table.present()) return;
    c.table = table;
    c.owner = table.design_id == design_.design_id          ? Owner::kThis
              : table.design_id == session::kIdentifyDesign ? Owner::kNobody
                                                            : Owner::kAnother;
  }

  // Compares serial numbers or, if the file names none, the address and the design of the table.
  [[nodiscard]] bool is_neighbour(const Candidate& c) const {
    const std::string serial = session::to_text(c.board.claim.unique_id);
    return std::ranges::any_of(options_.neighbours, [&](const FlashOptions::Neighbour& n) {
      if (!n.serial.empty()) return n.serial == serial;
      return c.table.present() && n.node == c.board.claim.node_address && n.design_id == c.table.design_id;
    });
  }

  [[nodiscard]] bool wanted(layout::PatchIndex patch) const {
    return std::ranges::binary_search(here_, patch) && (options_.patch < 0 || options_.patch == patch) &&
           !missing_.contains(patch);
  }
  void give(Candidate& c, layout::PatchIndex patch, FoundBy by) {
    c.board.patch = patch;
    c.board.by = by;
    taken_.insert(patch);
  }

  void assign_named() {
    for (const FlashOptions::Assignment& a : options_.assign) {
      if (!std::ranges::binary_search(here_, a.patch))
        throw InputError(fmt::format("--assign {}={}: the design has patches {}", a.patch, a.serial,
                                     design::patch_numbers(design_)));
      const auto named = std::ranges::find_if(
          candidates_, [&](const Candidate& c) { return session::to_text(c.board.claim.unique_id) == a.serial; });
      if (named != candidates_.end())
        assign_to(*named, a);
      else if (wanted(a.patch))
        missing_[a.patch] =
            fmt::format("{}: no controller {} answers; triskin discover lists those that do", bus_.name(), a.serial);
    }
  }
  void assign_to(Candidate& named, const FlashOptions::Assignment& a) {
    if (named.board.patch >= 0 || taken_.contains(a.patch) || missing_.contains(a.patch))
      throw InputError(fmt::format("--assign {}={}: the patch or the controller is named twice", a.patch, a.serial));
    if (wanted(a.patch))
      give(named, a.patch, FoundBy::kName);
    else
      named.owner = Owner::kNeighbour;  // The board belongs to a patch that is not requested.
  }
  void keep_own() {
    for (Candidate& c : candidates_) {
      const layout::PatchIndex patch = design::patch_at(design_, layout::NodeAddress{c.board.claim.node_address});
      if (c.board.patch < 0 && c.owner == Owner::kThis && wanted(patch) && !taken_.contains(patch))
        give(c, patch, FoundBy::kTable);
    }
  }
  // Finds controllers that were flashed with this design while their patch had another address, as without a robot
  // file.
  void keep_moved() {
    design::Design then;
    for (Candidate& c : candidates_) {
      if (c.board.patch >= 0 || c.owner != Owner::kThis) continue;
      if (then.patches.empty()) then = design_;
      then.node_addresses.assign(design_.patches.size(), c.board.claim.node_address);
      const auto found = std::ranges::find_if(here_, [&](layout::PatchIndex patch) {
        return wanted(patch) && !taken_.contains(patch) &&
               session::holds_image(c.table.crc, session::image_of(then, patch));
      });
      if (found != here_.end()) give(c, *found, FoundBy::kTable);
    }
  }

  // Returns the free controllers that may serve patches of this design. Those of another design are included only if
  // the others do not suffice.
  [[nodiscard]] std::vector<Candidate*> free_candidates(std::size_t n_open) {
    std::vector<Candidate*> free = free_of(Owner::kNobody);
    if (options_.take_over && free.size() < n_open) {
      for (Candidate* c : free_of(Owner::kAnother)) free.push_back(c);
    }
    return free;
  }
  [[nodiscard]] std::vector<Candidate*> free_of(Owner owner) {
    std::vector<Candidate*> free;
    for (Candidate& c : candidates_) {
      if (c.board.patch < 0 && c.owner == owner) free.push_back(&c);
    }
    return free;
  }
  [[nodiscard]] std::vector<layout::PatchIndex> open_patches() const {
    std::vector<layout::PatchIndex> open;
    for (const layout::PatchIndex p : here_) {
      if (!taken_.contains(p)) open.push_back(p);
    }
    return open;
  }
  // Assigns boards by shape even if only one patch is requested, because the other boards narrow the choice. If
  // controllers are missing, it asks nothing, and require_all() reports that.
  void recognise() {
    std::vector<layout::PatchIndex> open = open_patches();
    const std::vector<Candidate*> free = free_candidates(options_.patch < 0 ? open.size() : 1);
    std::vector<Seat> seats = seats_of(design_, open);
    add_neighbours(seats);
    const bool one = free.size() < 2 && (options_.patch >= 0 || seats.size() < 2);
    if (open.empty() || one || (options_.patch >= 0 && taken_.contains(options_.patch))) return;
    if (options_.patch < 0 && free.size() < open.size()) return;
    if (options_.dry_run && share_addresses(free)) return;
    const Undecided alike = settle_by_shape(free, open, seats);
    std::erase_if(open, [&](layout::PatchIndex p) { return !wanted(p) || taken_.contains(p); });
    if (open.empty() || alike.boards.empty()) return;  // No board is left that would have to be distinguished.
    if (options_.actuator == nullptr || options_.dry_run) refuse_alike(open, alike.boards);
    touch(open, alike);
  }
  // Returns the patches of this design among the seats; the seats of neighbours follow those of `open`.
  static std::vector<layout::PatchIndex> patches_at(const std::vector<int>& seats,
                                                    const std::vector<layout::PatchIndex>& open) {
    std::vector<layout::PatchIndex> patches;
    for (const int seat : seats) {
      if (static_cast<std::size_t>(seat) < open.size()) patches.push_back(open[static_cast<std::size_t>(seat)]);
    }
    return patches;
  }
  // A search of all boards at once may find too little, so it is repeated before the shapes count as inexact.
  std::pair<std::vector<BoardShape>, ShapeAssignment> match_shapes(const std::vector<Candidate*>& free,
                                                                   const std::vector<Seat>& seats) const {
    std::vector<BoardShape> shapes = shapes_of(free);
    ShapeAssignment by_shape = assign_by_shape(shapes, seats);
    if (!by_shape.exact && std::ranges::any_of(shapes, &BoardShape::switched)) {
      look_again(free);
      shapes = shapes_of(free);
      by_shape = assign_by_shape(shapes, seats);
    }
    return {std::move(shapes), std::move(by_shape)};
  }
  // `seats` begins with those of the patches in `open`; the others belong to neighbours.
  Undecided settle_by_shape(const std::vector<Candidate*>& free, const std::vector<layout::PatchIndex>& open,
                            const std::vector<Seat>& seats) {
    const auto [shapes, by_shape] = match_shapes(free, seats);
    Undecided alike;
    for (std::size_t k = 0; k < free.size(); ++k) {
      std::vector<layout::PatchIndex> likely = patches_at(by_shape.likely[k], open);
      const bool elsewhere = likely.empty() && !by_shape.likely[k].empty();
      const bool settled = by_shape.seat[k] >= 0;
      const bool own = settled && static_cast<std::size_t>(by_shape.seat[k]) < open.size();
      const auto patch = own ? open[static_cast<std::size_t>(by_shape.seat[k])] : layout::PatchIndex::none();
      if (own && wanted(patch)) {
        give(*free[k], patch, FoundBy::kShape);
      } else if (settled || elsewhere) {
        free[k]->owner = Owner::kNeighbour;  // The board serves another patch.
      } else {
        alike.boards.push_back({free[k]->board.claim, shapes[k], std::move(likely), by_shape.across[k]});
        alike.candidates.push_back(free[k]);
      }
    }
    return alike;
  }
  // Lets all boards search their patches at the same time; boards that already searched for another cover of the pass
  // do not search again.
  [[nodiscard]] std::vector<BoardShape> shapes_of(const std::vector<Candidate*>& boards) const {
    std::vector<const wire::NodeClaim*> unknown;
    for (const Candidate* c : boards) {
      if (!known_.shapes.contains(c->board.claim.unique_id)) unknown.push_back(&c->board.claim);
    }
    const std::vector<BoardShape> looked = read_shapes(unknown);
    for (std::size_t k = 0; k < unknown.size(); ++k) known_.shapes.try_emplace(unknown[k]->unique_id, looked[k]);
    std::vector<BoardShape> shapes;
    for (const Candidate* c : boards) shapes.push_back(known_.shapes.at(c->board.claim.unique_id));
    return shapes;
  }
  [[nodiscard]] std::vector<BoardShape> read_shapes(const std::vector<const wire::NodeClaim*>& claims) const {
    std::vector<BoardShape> looked(claims.size());
    std::vector<session::Task> tasks;
    for (std::size_t k = 0; k < claims.size(); ++k) {
      const std::uint8_t node = claims[k]->node_address;
      tasks.push_back({node, [&looked, k, node](session::Bus& bus) {
                         session::Controller controller(bus, node);
                         looked[k] = read_shape(controller);
                       }});
    }
    for (const std::exception_ptr& failure : session::run_tasks(bus_.link(), tasks, options_.per_wire)) {
      if (failure) std::rethrow_exception(failure);
    }
    return looked;
  }
  // Lets the boards search one after the other, because boards on joined patches take modules from each other when they
  // search together.
  void look_again(const std::vector<Candidate*>& boards) const {
    for (const Candidate* c : boards) {
      session::Controller controller(bus_, c->board.claim.node_address);
      known_.shapes.insert_or_assign(c->board.claim.unique_id, read_shape(controller));
    }
  }
  void touch(const std::vector<layout::PatchIndex>& open, const Undecided& alike) {
    if (options_.say)
      options_.say(fmt::format("{} {} {} alike; a simulated touch tells their controllers apart.",
                               open.size() == 1 ? "Patch" : "Patches", short_list(open),
                               agreeing(open.size(), "looks", "look")));
    IdentifyOptions how;
    how.say = options_.say;
    how.actuator = options_.actuator;
    TouchFinder finder(bus_, design_, alike.boards, how);
    std::vector<layout::PatchIndex> silent;
    for (const layout::PatchIndex patch : open) {
      if (const auto board = finder.find(patch))
        give(*alike.candidates[*board], patch, FoundBy::kTouch);
      else
        silent.push_back(patch);
    }
    if (!silent.empty()) refuse_alike(silent, alike.boards);
  }
  static std::string likeness_text(const std::vector<layout::PatchIndex>& likely) {
    if (likely.empty()) return "like no patch that is left";
    return fmt::format("like {} {}", noun_after(likely.size() == 1, "patch"), short_list(likely, 4));
  }
  [[noreturn]] void refuse_alike(const std::vector<layout::PatchIndex>& open,
                                 const std::vector<FeelingBoard>& boards) const {
    std::vector<std::string> names;
    for (const FeelingBoard& b : boards)
      names.push_back(fmt::format("{} ({})", session::to_text(b.claim.unique_id), likeness_text(b.likely)));
    // If several covers share the bus, the user has to name the cover in the options.
    const bool alone = options_.neighbours.empty();
    throw DeviceError(fmt::format(
        "{}: it is ambiguous which controller serves {} {}{}: {}. Let triskin identify find it out by touch, name "
        "them ({}--assign {}=SERIAL), or plug them in one after the other ({}--patch); --by-serial takes them in the "
        "order of their serial numbers; no table of the design was written",
        bus_.name(), noun_after(open.size() == 1, "patch"), short_list(open), alone ? "" : " of " + design_.name,
        short_list(names, 6), alone ? "" : fmt::format("--cover {} ", design_.name), open.front(),
        alone ? "" : fmt::format("--cover {} ", design_.name)));
  }
  static bool share_addresses(const std::vector<Candidate*>& list) {
    std::set<int> addresses;
    return !std::ranges::all_of(
        list, [&](const Candidate* c) { return addresses.insert(c->board.claim.node_address).second; });
  }
  // If the designs of neighbours are not available, new controllers may belong to them, and shapes cannot tell.
  [[nodiscard]] bool neighbours_are_known() const {
    return std::ranges::none_of(options_.neighbours,
                                [&](const FlashOptions::Neighbour& n) { return n.design == nullptr && is_vacant(n); });
  }
  void add_neighbours(std::vector<Seat>& seats) const {
    for (const FlashOptions::Neighbour& n : options_.neighbours) {
      if (is_vacant(n)) seats.push_back({n.design, n.patch});
    }
  }
  [[nodiscard]] bool is_vacant(const FlashOptions::Neighbour& n) const {
    return n.serial.empty() && std::ranges::none_of(candidates_, [&](const Candidate& c) {
             return c.owner == Owner::kNeighbour && c.board.claim.node_address == n.node;
           });
  }
  // If only one patch is requested, there must be no doubt about its controller.
  void fill(Owner owner) {
    const std::vector<Candidate*> free = free_of(owner);
    if (options_.patch >= 0 && !taken_.contains(options_.patch) && free.size() > 1)
      throw DeviceError(
          fmt::format("{}: {} could be that of patch {}: {}; connect one of them, or name it: --assign {}=SERIAL",
                      bus_.name(), counted(free.size(), "controller"), options_.patch, serials(free), options_.patch));
    auto next = free.begin();
    const auto patches = seats(free.size());
    const FoundBy by = patches.size() == 1 && free.size() == 1 ? FoundBy::kOnly : found_by_order();
    for (const layout::PatchIndex patch : patches) {
      if (next == free.end()) return;
      if (patch >= 0) give(**next, patch, by);
      ++next;
    }
  }

  // In a dry run the shapes are unknown, so the order need not be what decides.
  [[nodiscard]] FoundBy found_by_order() const {
    return options_.dry_run && options_.recognise ? FoundBy::kNothing : FoundBy::kOrder;
  }

  // Returns the patches without a controller in the order of their node addresses; −1 stands for one of a neighbour.
  // If the free controllers do not suffice for all covers of the bus, only patches of this design are returned.
  [[nodiscard]] std::vector<layout::PatchIndex> seats(std::size_t n_free) const {
    std::vector<std::pair<layout::NodeAddress, layout::PatchIndex>> own, all;
    for (const layout::PatchIndex patch : here_) {
      if (wanted(patch) && !taken_.contains(patch)) own.emplace_back(design::node_address_of(design_, patch), patch);
    }
    all = own;
    for (const FlashOptions::Neighbour& n : options_.neighbours) {
      if (is_vacant(n)) all.emplace_back(n.node, layout::PatchIndex::none());
    }
    std::vector<layout::PatchIndex> patches;
    auto& list = n_free >= all.size() ? all : own;
    std::ranges::sort(list);
    for (const auto& [node, patch] : list) patches.push_back(patch);
    return patches;
  }

  static std::string serials(const std::vector<Candidate*>& list) {
    std::vector<std::string> names;
    for (const Candidate* c : list) names.push_back(session::to_text(c->board.claim.unique_id));
    return fmt::format("{}", fmt::join(names, ", "));
  }

  // If boards are missing, only the certain ones are served.
  void require_all() {
    std::vector<layout::PatchIndex> open = open_patches();
    std::erase_if(open, [&](layout::PatchIndex p) { return !wanted(p); });
    if (open.empty()) return;
    const std::vector<std::string> others = takeable();
    if (!others.empty())
      throw DeviceError(fmt::format(
          "{}: no controller is free for {} {}; these hold a table that is not of this design and are left alone: "
          "{}. Name one (--assign PATCH=SERIAL) or take all of them (--take-over); nothing was written",
          bus_.name(), noun_after(open.size() == 1, "patch"), short_list(open), short_list(others)));
    const std::string too_few = too_few_text();
    const bool any_certain = std::ranges::any_of(candidates_, is_certain);
    if (!any_certain || options_.patch >= 0)
      throw DeviceError((missing_.empty() ? too_few : missing_.begin()->second) + "; nothing was written");
    release_uncertain(open);
    for (const layout::PatchIndex p : open) missing_.try_emplace(p, too_few);
  }
  [[nodiscard]] std::string too_few_text() const {
    const auto n_answer = std::ranges::count_if(candidates_, [](const Candidate& c) {
      return c.owner != Owner::kNeighbour && (c.owner != Owner::kSilent || c.board.patch >= 0);
    });
    return fmt::format(
        "{}: the design has {} here, {} {} that may serve them{}; connect the others, or flash one patch at a time "
        "(--patch)",
        bus_.name(), counted(here_.size(), "patch"), counted(n_answer, "controller"),
        agreeing(n_answer, "answers", "answer"),
        silent_.empty() ? "" : fmt::format(" ({} fell silent)", fmt::join(silent_, ", ")));
  }
  void release_uncertain(std::vector<layout::PatchIndex>& open) {
    for (Candidate& c : candidates_) {
      if (c.board.patch < 0 || is_certain(c)) continue;
      open.push_back(c.board.patch);
      taken_.erase(c.board.patch);
      c.board.patch = layout::PatchIndex::none();
    }
  }
  static bool is_certain(const Candidate& c) {
    return c.board.patch >= 0 && (c.board.by == FoundBy::kName || c.board.by == FoundBy::kTable);
  }
  // Returns the controllers that could serve but have a table of another design.
  [[nodiscard]] std::vector<std::string> takeable() const {
    std::vector<std::string> others;
    for (const Candidate& c : candidates_) {
      if (c.board.patch >= 0 || (c.owner != Owner::kAnother && c.owner != Owner::kUnknown)) continue;
      others.push_back(fmt::format("{} ({})", session::to_text(c.board.claim.unique_id),
                                   c.owner == Owner::kAnother
                                       ? fmt::format("design {:016x}", c.table.design_id)
                                       : fmt::format("shares node address {}", c.board.claim.node_address)));
    }
    return others;
  }

  // A foreign controller may already have the address of a patch.
  void require_addresses() const {
    for (const Candidate& c : candidates_) {
      const bool theirs = c.owner == Owner::kAnother || c.owner == Owner::kUnknown;
      const layout::PatchIndex patch = design::patch_at(design_, layout::NodeAddress{c.board.claim.node_address});
      if (options_.take_over || !theirs || c.board.patch >= 0 || !taken_.contains(patch)) continue;
      throw DeviceError(fmt::format(
          "{}: controller {} holds a table that is not of this design and has node address {}, which patch {} needs; "
          "take "
          "it off the bus, or let it move (--take-over: it must be flashed again then); nothing was written",
          bus_.name(), session::to_text(c.board.claim.unique_id), c.board.claim.node_address, patch));
    }
  }

  session::Bus& bus_;
  const design::Design& design_;
  const FlashOptions& options_;
  BusBoards& known_;
  const std::vector<layout::PatchIndex> here_;  // The patches are in ascending order.
  std::vector<Candidate> candidates_;
  std::set<layout::PatchIndex> taken_;
  std::vector<std::string> silent_;
  std::map<layout::PatchIndex, std::string> missing_;  // The value is the reason why the patch has no controller.
};

}  // namespace

MatchedBoards match_boards(session::Bus& bus, const design::Design& design, const FlashOptions& options,
                           BusBoards& known) {
  if (options.patch >= 0 && !design::has_patch(design, options.patch))
    throw InputError(
        fmt::format("--patch {}: the design has patches {}", options.patch, design::patch_numbers(design)));
  return Matcher(bus, design, options, known).run();
}

}  // namespace triskin::deploy
