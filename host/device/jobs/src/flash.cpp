// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/jobs/flash.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <set>
#include <thread>

#include "address_moves.hpp"
#include "board_match.hpp"
#include "table_writer.hpp"
#include "triskin/host/interrupt.hpp"
#include "triskin/session/controller.hpp"
#include "triskin/session/patch_table.hpp"
#include "triskin/session/scheduler.hpp"

namespace triskin::device {
namespace {

// Node addresses that nobody has and that no patch of this design is to have, lowest first. Those that the robot file
// gives to controllers of other covers come last: who sits there makes way when their cover is flashed.
class FreeAddresses {
 public:
  FreeAddresses(const Bus& bus, const design::Design& design, const FlashOptions& options) : name_(bus.name()) {
    for (const int patch : design::patches_here(design)) used_.insert(design::node_address_of(design, patch));
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

// Fresh boards have the first address, and so may have one that holds a table: neither could be asked. The fresh ones
// make way. New addresses by unique id.
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

// The boards of the patches get the addresses of the patches; one that nobody needs and that sits there moves to the
// first free one. The new addresses, by unique id, of those that have another one now.
std::map<wire::UniqueId, int> moves(const std::vector<Board>& boards, const design::Design& design,
                                    FreeAddresses free) {
  std::set<int> needed;
  for (const Board& b : boards) {
    if (b.patch >= 0) needed.insert(design::node_address_of(design, b.patch));
    if (b.patch < 0) free.take(b.claim.node_address);
  }
  std::map<wire::UniqueId, int> wanted;
  for (const Board& b : boards) {
    if (b.patch < 0 && !needed.contains(b.claim.node_address)) continue;
    const int address = b.patch < 0 ? free.next() : design::node_address_of(design, b.patch);
    if (b.claim.node_address != address) wanted[b.claim.unique_id] = address;
  }
  return wanted;
}

// One attempt at all controllers. Boards, images and results have the order of the patches.
class Pass {
 public:
  Pass(Bus& bus, const design::Design& design, const FlashOptions& options, const ProgressSink& progress,
       const std::vector<std::vector<std::uint8_t>>& images)
      : bus_(bus), design_(design), options_(options), progress_(progress), images_(images) {}

  // `results` has what is done, also when this throws.
  void run(std::vector<FlashResult::Patch>& results) {
    report(progress_, "finding controllers", -1.0);
    boards_ = match_boards(bus_, design_, options_, find());
    if (!options_.dry_run) assign_addresses(bus_, moves(boards_, design_, {bus_, design_, options_}));
    std::erase_if(boards_, [](const Board& b) { return b.patch < 0; });
    std::ranges::sort(boards_, {}, &Board::patch);
    results.resize(boards_.size());
    std::vector<Task> tasks;
    for (std::size_t k = 0; k < boards_.size(); ++k) {
      begin(results[k], boards_[k]);
      const auto node = options_.dry_run ? boards_[k].claim.node_address : address_of(boards_[k]);
      tasks.push_back({node, [this, k, &results](Bus& bus) { serve(bus, boards_[k], results[k]); }});
    }
    throw_first(run_tasks(bus_.link(), tasks, options_.per_wire), results);
  }

 private:
  std::vector<wire::NodeClaim> find() {
    std::vector<wire::NodeClaim> claims = bus_.discover();
    const auto wanted = ways_for_flashed(claims, {bus_, design_, options_});
    if (options_.dry_run) return claims;
    if (!wanted.empty()) {
      assign_addresses(bus_, wanted);
      claims = bus_.discover();
    }
    // Whose shape is to be seen must be asked alone. One that is the only fresh one is not asked.
    const bool many = std::ranges::count(claims, false, &wire::NodeClaim::has_table) > 1 || options_.take_over;
    return options_.recognise && many ? put_apart(bus_, std::move(claims), options_.take_over) : claims;
  }
  [[nodiscard]] std::uint8_t address_of(const Board& board) const {
    return static_cast<std::uint8_t>(design::node_address_of(design_, board.patch));
  }
  // A patch that was written before the cable was pulled stays written.
  void begin(FlashResult::Patch& r, const Board& board) const {
    if (r.written && r.patch == board.patch) return;
    r = {board.patch,
         to_text(board.claim.unique_id),
         board.by,
         board.claim.node_address,
         address_of(board),
         false,
         false,
         false,
         images_[static_cast<std::size_t>(board.patch)].size()};
    r.new_address = board.claim.node_address != address_of(board);
  }
  void step(int patch, const char* what, double fraction) const {
    report(progress_, what, fraction, fmt::format("patch {}", patch), patch);
  }

  void serve(Bus& bus, const Board& board, FlashResult::Patch& r) const {
    const Bytes image = images_[static_cast<std::size_t>(board.patch)];
    step(r.patch, "asking", 0.0);
    if (options_.dry_run) {
      r.equal = !r.new_address && board.claim.has_table &&
                Controller(bus, board.claim.node_address).active_table().crc == crc32(image);
      return step(r.patch, "planned", 1.0);
    }
    Controller controller(bus, address_of(board));
    check_identity(controller, bus, r);
    const wire::ActiveTable active = controller.active_table();
    // Equal CRC is not enough to skip: the bytes are cheap to compare.
    r.equal = active.present() && active.crc == crc32(image) &&
              std::ranges::equal(controller.read_table(image.size()), image);
    if (!r.equal || (options_.force && !r.written)) {
      write_and_compare(controller, bus, image, [&](double fraction) { step(r.patch, "writing", 0.9 * fraction); });
      r.written = true;
    }
    step(r.patch, "done", 1.0);
  }
  static void check_identity(Controller& controller, const Bus& bus, const FlashResult::Patch& r) {
    const wire::Hello hello = controller.hello();
    controller.require_versions(hello);
    if (to_text(hello.unique_id) == r.serial) return;
    throw DeviceError(fmt::format(
        "{}: controller {} has serial number {}, {} was meant; two controllers may share the address, run flash again",
        bus.name(), controller.node(), to_text(hello.unique_id), r.serial));
  }

  void throw_first(const std::vector<std::exception_ptr>& outcomes,
                   const std::vector<FlashResult::Patch>& results) const {
    const auto first = std::ranges::find_if(outcomes, [](const auto& e) { return e != nullptr; });
    if (first == outcomes.end()) return;
    const auto failed = std::ranges::count_if(outcomes, [](const auto& e) { return e != nullptr; });
    const std::string others =
        failed > 1 ? fmt::format(" ({} more controllers did not get theirs either)", failed - 1) : "";
    const std::string done = others + "; " + what_is_done(results);
    try {
      std::rethrow_exception(*first);
    } catch (const Cancelled& e) {
      throw Cancelled(e.what() + done);
    } catch (const Unreachable& e) {
      throw Unreachable(e.what() + done);
    } catch (const DeviceError& e) {
      throw DeviceError(e.what() + done);
    }
  }
  [[nodiscard]] std::string what_is_done(const std::vector<FlashResult::Patch>& results) const {
    std::vector<int> done;
    for (const FlashResult::Patch& r : results) {
      if (r.equal || r.written) done.push_back(r.patch);
    }
    if (done.empty()) return "no controller has a new table";
    return fmt::format("{} of {} controllers have their table (patches {}), the others their old one", done.size(),
                       results.size(), fmt::join(done, ", "));
  }

  Bus& bus_;
  const design::Design& design_;
  const FlashOptions& options_;
  const ProgressSink& progress_;
  const std::vector<std::vector<std::uint8_t>>& images_;
  std::vector<Board> boards_;
};

// Until as many controllers answer as were there before.
bool wait_for_controllers(Bus& bus, std::size_t count, double wait_s) {
  constexpr std::uint64_t kPause_us = 300'000;
  const auto start = std::chrono::steady_clock::now();
  const std::uint64_t start_us = bus.now_us();
  // A dead link may have no time of its own.
  const auto over = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() > wait_s ||
           static_cast<double>(bus.now_us() - start_us) > wait_s * 1e6;
  };
  while (!over()) {
    try {
      bus.reconnect();
      if (bus.discover().size() >= count) return true;
      bus.listen(bus.now_us() + kPause_us);
    } catch (const DeviceError&) {
      if (interrupt_request()) throw Cancelled(bus.name() + ": ended on request while waiting for the cable");
      std::this_thread::sleep_for(std::chrono::microseconds(kPause_us));
    }
  }
  return false;
}

std::vector<std::vector<std::uint8_t>> images_of(const design::Design& design, const RouteChoice& route,
                                                 bool positive_input) {
  if (route.module >= 0 && std::ranges::none_of(design.patches, [&](const auto& p) { return concerns(p, route); })) {
    throw InputError(route.other < 0 ? fmt::format("the design has no module {} in a patch", route.module)
                                     : fmt::format("modules {} and {} are not in one patch of the design", route.module,
                                                   route.other));
  }
  std::vector<std::vector<std::uint8_t>> images(design.patches.size());
  for (const int patch : design::patches_here(design)) {
    layout::PatchImage image = image_of(design, patch, route);
    image.positive_input = positive_input;
    images[static_cast<std::size_t>(patch)] = bytes_of(image);
  }
  return images;
}

}  // namespace

FlashResult flash(Bus& bus, const design::Design& design, const FlashOptions& options, const ProgressSink& progress) {
  const std::uint64_t start_us = bus.now_us();
  const auto images = images_of(design, options.route, options.positive_input);
  FlashResult result;
  for (bool completed = false; !completed;) {
    try {
      Pass(bus, design, options, progress, images).run(result.patches);
      completed = true;
    } catch (const Unreachable& e) {
      if (options.wait_s <= 0.0) throw;
      if (options.say)
        options.say(fmt::format("{}; waiting {:.0f} s for the cable (Ctrl-C ends)", e.what(), options.wait_s));
      if (!wait_for_controllers(bus, options.patch >= 0 ? 1 : design::patches_here(design).size(), options.wait_s))
        throw;
      if (options.say) options.say("all controllers answer again, going on");
    }
  }
  for (const FlashResult::Patch& p : result.patches) {
    if (p.written) result.bytes += p.bytes;
    if (p.equal && !p.written) ++result.skipped;
  }
  result.link_s = static_cast<double>(bus.now_us() - start_us) * 1e-6;
  return result;
}

}  // namespace triskin::device
