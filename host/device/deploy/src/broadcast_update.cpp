// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/deploy/broadcast_update.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <exception>
#include <memory>
#include <mutex>
#include <random>

#include "triskin/base/outcomes.hpp"
#include "triskin/session/controller.hpp"
#include "update_session.hpp"

namespace triskin::deploy {
namespace {

// Passes the exception on; that of a broken wire says what the update has left behind.
[[noreturn]] void rethrow_with(const std::exception_ptr& failure, std::string_view left_behind) {
  try {
    std::rethrow_exception(failure);
  } catch (const link::Unreachable& e) {
    throw link::Unreachable(fmt::format("{}; {}", e.what(), left_behind));
  }
}

using Sessions = std::vector<std::unique_ptr<UpdateSession>>;

// Does `work` on all buses and throws the first exception after all have ended; then no session goes on.
template <class Work>
void side_by_side(Sessions& sessions, std::string_view left_behind, Work work) {
  for (const std::exception_ptr& failure : outcomes_of(sessions.size(), [&](std::size_t k) { work(*sessions[k]); })) {
    if (!failure) continue;
    for (const auto& s : sessions) s->abandon();
    rethrow_with(failure, left_behind);
  }
}

// Unless `each`, no board starts the new image when another has refused it.
void update_all(Sessions& sessions, bool each) {
  const auto any_refused = [&] {
    return !each && std::ranges::any_of(sessions, [](const auto& s) { return s->any_refused(); });
  };
  constexpr const char* kTogether = "another controller refused; give --each to start it where it is ready";
  constexpr std::string_view kNothingStarted =
      "no controller has started the new firmware, all run what they ran; run the command again";
  constexpr std::string_view kPerhapsStarted =
      "some controllers may run the new firmware; run triskin discover, then the command again";
  side_by_side(sessions, kNothingStarted, [](UpdateSession& s) { s.begin(); });
  if (!any_refused()) side_by_side(sessions, kNothingStarted, [](UpdateSession& s) { s.transfer(); });
  if (any_refused())
    for (const auto& s : sessions) s->hold_back(kTogether);
  else
    side_by_side(sessions, kPerhapsStarted, [](UpdateSession& s) { s.activate(); });
}

void add_result(UpdateSession& session, BroadcastResult& result) {
  for (BoardUpdate& b : session.take_boards()) result.boards.push_back(std::move(b));
  result.rounds = std::max(result.rounds, session.rounds());
  result.frames += session.frames();
  result.again += session.again();
}

std::uint16_t draw_session() {
  std::random_device dice;
  return static_cast<std::uint16_t>(1 + dice() % 0xFFFF);
}

}  // namespace

BoardsOnWires find_boards(std::span<link::Link* const> links, const std::set<wire::UniqueId>& expected) {
  BoardsOnWires found;
  for (link::Link* link : links) {
    std::vector<link::Link*> parts = link->parts();
    if (parts.empty()) parts.push_back(link);
    for (link::Link* part : parts) found.wires.push_back(std::make_unique<session::Bus>(*part));
  }
  std::set<wire::UniqueId> silent = expected;
  for (const auto& wire : found.wires) {
    found.boards.push_back({wire.get(), wire->discover()});
    for (const wire::NodeClaim& c : found.boards.back().boards) silent.erase(c.unique_id);
  }
  // On which wire a silent controller hangs is not known.
  for (std::size_t k = 0; k < found.wires.size() && !silent.empty(); ++k) {
    for (const wire::UniqueId& id : silent) found.wires[k]->expect(id);
    for (const wire::NodeClaim& c : found.wires[k]->discover()) {
      if (silent.erase(c.unique_id) > 0) found.boards[k].boards.push_back(c);
    }
  }
  found.silent.assign(silent.begin(), silent.end());
  return found;
}

std::string_view outcome_name(UpdateOutcome outcome) {
  constexpr std::array<std::string_view, 7> kNames{"updated", "equal",     "would be updated", "by its loader",
                                                   "refused", "held back", "given up"};
  return kNames.at(static_cast<std::size_t>(outcome));
}

bool BroadcastResult::complete() const {
  return std::ranges::all_of(boards, [](const BoardUpdate& b) {
    return b.outcome == UpdateOutcome::kUpdated || b.outcome == UpdateOutcome::kEqual;
  });
}

BroadcastResult broadcast_firmware(std::span<const UpdateBus> buses, const FirmwarePackage& package,
                                   const UpdateOptions& options, const ProgressSink& progress) {
  require_fit(package, options.hardware);
  std::mutex telling;
  const std::uint16_t number = draw_session();
  Sessions sessions;
  std::vector<std::uint64_t> began_us;
  std::size_t first = 0;
  for (const UpdateBus& b : buses) {
    const auto tell = [&, first, boards = b.boards](std::size_t k, const char* stage, double fraction) {
      const std::scoped_lock lock(telling);
      report(progress, stage, fraction, session::to_text(boards[k].unique_id), static_cast<int>(first + k));
    };
    sessions.push_back(std::make_unique<UpdateSession>(*b.bus, b.boards, package, options, number, tell));
    began_us.push_back(b.bus->now_us());
    first += b.boards.size();
  }
  update_all(sessions, options.each);

  BroadcastResult result;
  for (std::size_t k = 0; k < sessions.size(); ++k) {
    add_result(*sessions[k], result);
    result.link_s = std::max(result.link_s, static_cast<double>(buses[k].bus->now_us() - began_us[k]) * 1e-6);
  }
  return result;
}

}  // namespace triskin::deploy
