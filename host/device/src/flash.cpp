// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/device/flash.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "triskin/device/controller.hpp"
#include "triskin/device/patch_table.hpp"

namespace triskin::device {
namespace {

constexpr int kMaxAddress = 126;
constexpr std::uint64_t kRestart_us = 20'000;  // a controller starts anew under its new address

struct Board {
  wire::NodeClaim claim;
  int patch = -1;  // -1: not needed for this design
};

// A controller whose address nobody shares can be asked which design it serves.
bool serves(Bus& bus, const wire::NodeClaim& claim, const model::Design& design) {
  if (!claim.has_table || claim.node_address < 1 || claim.node_address > design.patches.size()) return false;
  const ActiveTable table = Controller(bus, claim.node_address).active_table();
  return table.present && table.design_id == design.design_id;
}

std::vector<Board> match_boards(Bus& bus, const model::Design& design) {
  const std::vector<wire::NodeClaim> claims = bus.discover();
  const std::size_t n_patches = design.patches.size();
  if (claims.empty()) {
    throw DeviceError(fmt::format("{}: no controller answers; check power, cable and bit rate", bus.link().name()));
  }
  if (claims.size() < n_patches) {
    throw DeviceError(fmt::format("{}: the design has {} patches, {} controllers answer; connect the others, nothing was written",
                                  bus.link().name(), n_patches, claims.size()));
  }
  std::map<int, int> users;
  for (const auto& c : claims) ++users[c.node_address];
  std::vector<Board> boards;
  std::vector<bool> taken(n_patches, false);
  for (const auto& c : claims) {
    Board board{c};
    if (users[c.node_address] == 1 && serves(bus, c, design)) {
      board.patch = c.node_address - 1;
      taken[static_cast<std::size_t>(board.patch)] = true;
    }
    boards.push_back(board);
  }
  std::size_t next = 0;
  for (Board& board : boards) {
    while (next < n_patches && taken[next]) ++next;
    if (board.patch >= 0 || next == n_patches) continue;
    board.patch = static_cast<int>(next++);
  }
  return boards;
}

// Addresses 1 … patches belong to the patches; a spare controller that sits there moves behind them.
void assign_addresses(Bus& bus, const std::vector<Board>& boards, std::size_t n_patches) {
  std::set<int> used;
  for (const Board& b : boards) {
    if (b.patch < 0 && b.claim.node_address > n_patches) used.insert(b.claim.node_address);
  }
  bool changed = false;
  int spare_address = static_cast<int>(n_patches) + 1;
  for (const Board& b : boards) {
    int wanted = b.patch + 1;
    if (b.patch < 0) {
      if (b.claim.node_address > n_patches) continue;
      while (used.contains(spare_address)) ++spare_address;
      wanted = spare_address++;
      if (wanted > kMaxAddress) throw DeviceError(fmt::format("{}: no free node address is left; take controllers off the bus", bus.link().name()));
    }
    if (b.claim.node_address == wanted) continue;
    bus.assign(b.claim.unique_id, static_cast<std::uint8_t>(wanted));
    changed = true;
  }
  if (changed) bus.listen(bus.now_us() + kRestart_us);
}

// The answer to the activation may be lost, and the table active all the same: what counts is what is read back.
void write_and_compare(Controller& controller, Bus& bus, Bytes image, const std::function<void(double)>& steps) {
  try {
    controller.write_table(image, steps);
  } catch (const NoAnswer&) {
    if (controller.active_table().crc != crc32(image)) throw;
  }
  const std::vector<std::uint8_t> back = controller.read_table(image.size());
  const auto [a, b] = std::mismatch(image.begin(), image.end(), back.begin(), back.end());
  if (a != image.end() || b != back.end()) {
    throw DeviceError(fmt::format("{}: controller {}: byte {} of the table reads back differently; its flash memory is damaged",
                                  bus.link().name(), controller.node(), a - image.begin()));
  }
  controller.clear_faults();
}

FlashResult::Patch flash_one(Bus& bus, const Board& board, Bytes image, const FlashOptions& options,
                             const std::function<void(double)>& steps) {
  FlashResult::Patch result{board.patch, to_text(board.claim.unique_id), board.claim.node_address, false, false, false, image.size()};
  result.new_address = board.claim.node_address != board.patch + 1;
  if (options.dry_run) {
    result.equal = !result.new_address && board.claim.has_table &&
                   Controller(bus, board.claim.node_address).active_table().crc == crc32(image);
    return result;
  }
  Controller controller(bus, static_cast<std::uint8_t>(board.patch + 1));
  const Hello hello = controller.hello();
  controller.require_versions(hello);
  if (hello.unique_id != board.claim.unique_id) {
    throw DeviceError(fmt::format("{}: controller {} has serial number {}, {} was meant; two controllers may share the address, run flash again",
                                  bus.link().name(), controller.node(), to_text(hello.unique_id), result.serial));
  }
  const ActiveTable active = controller.active_table();
  // Equal CRC is not enough to skip: the bytes are cheap to compare.
  result.equal = active.present && active.crc == crc32(image) &&
                 std::ranges::equal(controller.read_table(image.size()), image);
  if (result.equal && !options.force) return result;
  write_and_compare(controller, bus, image, steps);
  result.written = true;
  return result;
}

}  // namespace

FlashResult flash(Bus& bus, const model::Design& design, const FlashOptions& options, const ProgressSink& progress) {
  const std::uint64_t start_us = bus.now_us();
  std::vector<std::vector<std::uint8_t>> images;
  const RouteChoice& route = options.route;
  if (route.module >= 0 && std::ranges::none_of(design.patches, [&](const auto& p) { return concerns(p, route); })) {
    throw InputError(route.other < 0 ? fmt::format("the design has no module {} in a patch", route.module)
                                     : fmt::format("modules {} and {} are not in one patch of the design", route.module, route.other));
  }
  for (std::size_t p = 0; p < design.patches.size(); ++p) images.push_back(bytes_of(image_of(design, static_cast<int>(p), route)));
  report(progress, "finding controllers", 0.0);
  std::vector<Board> boards = match_boards(bus, design);
  if (!options.dry_run) assign_addresses(bus, boards, design.patches.size());
  std::erase_if(boards, [](const Board& b) { return b.patch < 0; });
  std::ranges::sort(boards, {}, &Board::patch);
  FlashResult result;
  for (std::size_t k = 0; k < boards.size(); ++k) {
    const auto steps = [&](double fraction) {
      report(progress, "flashing", (static_cast<double>(k) + fraction) / static_cast<double>(boards.size()),
             fmt::format("controller {} of {}", k + 1, boards.size()));
    };
    steps(0.0);
    const auto& image = images[static_cast<std::size_t>(boards[k].patch)];
    result.patches.push_back(flash_one(bus, boards[k], image, options, steps));
    const FlashResult::Patch& done = result.patches.back();
    if (done.written) result.bytes += done.bytes;
    if (done.equal && !done.written) ++result.skipped;
  }
  result.link_s = static_cast<double>(bus.now_us() - start_us) * 1e-6;
  return result;
}

}  // namespace triskin::device
