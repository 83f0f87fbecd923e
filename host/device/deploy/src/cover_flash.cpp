// SPDX-License-Identifier: GPL-3.0-or-later
#include "cover_flash.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>

#include "address_moves.hpp"
#include "table_writer.hpp"
#include "triskin/session/controller.hpp"

namespace triskin::deploy {
namespace {

// An address is free if no controller has it and no patch of this design needs it; the lowest is used first. Addresses
// that the robot file gives to controllers of other covers are last, because a board there has to move again when their
// cover is flashed.
class FreeAddresses {
 public:
  FreeAddresses(const session::Bus& bus, const design::Design& design, const FlashOptions& options)
      : name_(bus.name()) {
    for (const layout::PatchIndex patch : design::patches_here(design))
      used_.insert(design::node_address_of(design, patch));
    for (const FlashOptions::Neighbour& n : options.neighbours) promised_.insert(n.node);
  }
  void take(int address) { used_.insert(address); }
  int next() {
    for (const bool may_be_promised : {false, true}) {
      for (int address = layout::kFirstNode; address <= layout::kLastNode; ++address) {
        if (used_.contains(address) || (!may_be_promised && promised_.contains(address))) continue;
        used_.insert(address);
        return address;
      }
    }
    throw DeviceError(fmt::format("{}: no free node address is left; take controllers off the bus", name_));
  }

 private:
  std::string name_;
  std::set<int> used_, promised_;
};

// New boards have the first address, and a board with a table may have it too, so neither could be asked. The new ones
// move away. Returns new addresses by unique id.
std::map<wire::UniqueId, int> ways_for_flashed(const std::vector<wire::NodeClaim>& claims, FreeAddresses free) {
  std::set<int> flashed;
  for (const wire::NodeClaim& c : claims) {
    free.take(c.node_address);
    if (c.has_table) flashed.insert(c.node_address);
  }
  std::map<wire::UniqueId, int> wanted;
  for (const wire::NodeClaim& c : claims) {
    if (!c.has_table && flashed.contains(c.node_address)) wanted[c.unique_id] = free.next();
  }
  return wanted;
}

void check_identity(session::Controller& controller, const session::Bus& bus, const FlashResult::Patch& r) {
  const wire::Hello hello = controller.hello();
  controller.require_versions(hello);
  if (session::to_text(hello.unique_id) == r.serial) return;
  throw DeviceError(fmt::format(
      "{}: controller {} has serial number {}, {} was meant; two controllers may share the address, run flash again",
      bus.name(), controller.node(), session::to_text(hello.unique_id), r.serial));
}

}  // namespace

void CoverFlash::plan(std::span<const FlashOptions::Neighbour> settled, BusBoards& known) {
  name_neighbours(settled);
  report(progress_, "finding controllers", -1.0);
  find(known.claims);
  MatchedBoards matched = match_boards(bus_, design_, options_, known);
  boards_ = std::move(matched.boards);
  missing_ = std::move(matched.missing);
  // Identification by touch leaves tables on boards, so the claims are outdated.
  if (std::ranges::count(boards_, FoundBy::kTouch, &Board::by) > 0) known.claims.clear();
  std::erase_if(boards_, [](const Board& b) { return b.patch < 0; });
  std::ranges::sort(boards_, {}, &Board::patch);
  list_patches();
}

void CoverFlash::name_neighbours(std::span<const FlashOptions::Neighbour> settled) {
  for (FlashOptions::Neighbour& n : options_.neighbours) {
    const auto same =
        std::ranges::find_if(settled, [&](const auto& s) { return s.node == n.node && s.design_id == n.design_id; });
    if (same != settled.end()) n.serial = same->serial;
  }
}

void CoverFlash::list_patches() {
  const std::vector<FlashResult::Patch> before = std::move(patches_);
  patches_.clear();
  for (const Board& b : boards_) {
    const auto earlier = std::ranges::find(before, b.patch, &FlashResult::Patch::patch);
    begin(patches_.emplace_back(earlier == before.end() ? FlashResult::Patch{} : *earlier), b);
  }
  for (const MissingBoard& m : missing_) {
    FlashResult::Patch& r = patches_.emplace_back();
    r.patch = m.patch;
    r.address = design::node_address_of(design_, m.patch);
    r.why = m.why;
  }
}

void CoverFlash::give_addresses(const std::deque<CoverFlash>& covers, BusBoards& known) {
  if (covers.empty() || covers.front().options_.dry_run) return;
  session::Bus& bus = covers.front().bus_;
  FreeAddresses free(bus, covers.front().design_, covers.front().options_);
  if (known.claims.empty()) known.claims = bus.discover();
  std::map<wire::UniqueId, int> present, wanted;
  for (const wire::NodeClaim& c : known.claims) present[c.unique_id] = c.node_address;
  std::set<int> needed;
  for (const CoverFlash& cover : covers) {
    for (const Board& b : cover.boards_) {
      const int address = cover.address_of(b);
      const auto at = present.find(b.claim.unique_id);
      if (at == present.end() || at->second != address) wanted[b.claim.unique_id] = address;
      if (at != present.end()) present.erase(at);
      needed.insert(address);
      free.take(address);
    }
  }
  for (const auto& [id, address] : present) free.take(address);
  for (const auto& [id, address] : present) {
    if (needed.contains(address)) wanted[id] = free.next();
  }
  if (!wanted.empty()) known.claims = assign_addresses(bus, std::move(wanted));
}

void CoverFlash::find(std::vector<wire::NodeClaim>& claims) {
  if (claims.empty()) claims = bus_.discover();
  found_ = claims.size();
  if (options_.dry_run) return;
  const auto wanted = ways_for_flashed(claims, {bus_, design_, options_});
  if (!wanted.empty()) claims = assign_addresses(bus_, wanted);
  // To read a board's shape, its address must not be shared. The only new board need not be asked.
  const bool many = std::ranges::count(claims, false, &wire::NodeClaim::has_table) > 1 || options_.take_over;
  if (options_.recognise && many) claims = put_apart(bus_, std::move(claims), options_.take_over);
}

std::vector<FlashOptions::Neighbour> CoverFlash::settled() const {
  std::vector<FlashOptions::Neighbour> list;
  for (const Board& b : boards_)
    list.push_back({layout::NodeAddress{address_of(b)}, design_.design_id, session::to_text(b.claim.unique_id),
                    &design_, b.patch});
  return list;
}

std::uint8_t CoverFlash::address_of(const Board& board) const {
  return static_cast<std::uint8_t>(design::node_address_of(design_, board.patch));
}

// A patch that was written before the cable was unplugged still counts as written.
void CoverFlash::begin(FlashResult::Patch& r, const Board& board) const {
  if (r.written) return;
  r = {};
  r.patch = board.patch;
  r.serial = session::to_text(board.claim.unique_id);
  r.by = board.by;
  r.old_address = layout::NodeAddress{board.claim.node_address};
  r.address = layout::NodeAddress{address_of(board)};
  r.new_address = r.old_address != r.address;
  r.bytes = images_[static_cast<std::size_t>(board.patch)].size();
}

void CoverFlash::step(layout::PatchIndex patch, const char* what, double fraction) const {
  report(progress_, what, fraction, fmt::format("patch {}", patch), patch);
}

void CoverFlash::add_tasks(std::vector<session::Task>& tasks) {
  for (std::size_t k = 0; k < boards_.size(); ++k) {
    const auto node = options_.dry_run ? boards_[k].claim.node_address : address_of(boards_[k]);
    tasks.push_back({node, [this, k](session::Bus& bus) { serve(bus, boards_[k], patches_[k]); }});
  }
}

// If the first frame of a long answer is lost, the board waits for the flow control and ignores requests in the
// meantime. It has given up by the second attempt.
void CoverFlash::serve(session::Bus& bus, const Board& board, FlashResult::Patch& r) const {
  bool began_to_write = false;
  try {
    return converse(bus, board, r, began_to_write);
  } catch (const session::NoAnswer&) {
    bus.listen(bus.now_us() + wire::IsoTp::kTimeout_us);
  }
  converse(bus, board, r, began_to_write);
}

void CoverFlash::converse(session::Bus& bus, const Board& board, FlashResult::Patch& r, bool& began_to_write) const {
  const Bytes image = images_[static_cast<std::size_t>(board.patch)];
  step(r.patch, "asking", 0.0);
  if (options_.dry_run) {
    r.equal = !r.new_address && board.claim.has_table &&
              session::Controller(bus, board.claim.node_address).active_table().crc == crc32(image);
    return step(r.patch, "planned", 1.0);
  }
  session::Controller controller(bus, address_of(board));
  check_identity(controller, bus, r);
  r.equal = holds_table(controller, image);
  if (r.equal && began_to_write) r.written = true;
  if (!r.equal || (options_.force && !r.written)) {
    began_to_write = true;
    write_and_compare(controller, bus, image, [&](double fraction) { step(r.patch, "writing", 0.9 * fraction); });
    r.written = true;
  }
  step(r.patch, "done", 1.0);
}

std::string CoverFlash::Failure::text() const {
  try {
    std::rethrow_exception(what);
  } catch (const std::exception& e) {
    return e.what();
  }
}

std::vector<CoverFlash::Failure> CoverFlash::failures(std::span<const std::exception_ptr> outcomes) {
  std::vector<Failure> list;
  for (std::size_t k = 0; k < boards_.size(); ++k) {
    if (!outcomes[k]) continue;
    list.push_back({fmt::format("patch {}, controller {}", patches_[k].patch, patches_[k].serial), outcomes[k]});
    patches_[k].why = list.back().text();
  }
  for (const MissingBoard& m : missing_)
    list.push_back({fmt::format("patch {}", m.patch), std::make_exception_ptr(DeviceError(m.why))});
  return list;
}

std::string CoverFlash::what_is_done() const {
  std::vector<layout::PatchIndex> done;
  for (const FlashResult::Patch& r : patches_) {
    if (r.equal || r.written) done.push_back(r.patch);
  }
  if (done.empty()) return "no controller has a new table";
  return fmt::format("{} of {} controllers have their table (patches {}), the others their old one", done.size(),
                     patches_.size(), fmt::join(done, ", "));
}

}  // namespace triskin::deploy
