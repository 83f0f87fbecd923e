// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "triskin/base/progress.hpp"
#include "triskin/deploy/firmware_update.hpp"
#include "triskin/session/bus.hpp"
#include "triskin/wire/node_claim.hpp"

namespace triskin::deploy {

enum class UpdateOutcome : std::uint8_t {
  kUpdated,   ///< The new image runs.
  kEqual,     ///< The image was already running.
  kWould,     ///< Without the dry run, the image would be written.
  kByLoader,  ///< The board claims its address and does not know the broadcast, so update_firmware() is used for it.
  kRefused,   ///< The controller refused, or nothing was sent to it; its old image continues.
  kHeldBack,  ///< The controller was ready, but another one refused; its old image continues.
  kGivenUp,   ///< The controller no longer answers, or was restarted; it will start its old image.
};
/// Returns the name of an outcome for reports.
[[nodiscard]] std::string_view outcome_name(UpdateOutcome outcome);

struct BoardUpdate {
  wire::NodeClaim claim;
  std::string serial;
  UpdateOutcome outcome = UpdateOutcome::kGivenUp;
  std::string why;        ///< The reason is a sentence; it is empty for kUpdated, kEqual and kWould.
  int slot = -1;          ///< The board now runs from this slot; −1 means unknown.
  std::size_t bytes = 0;  ///< An equal image leaves this at 0, because nothing was written.
};

struct BroadcastResult {
  std::vector<BoardUpdate> boards;  ///< The order is that of the given boards.
  int rounds = 0;                   ///< On the bus with the most rounds, missing units were requested this often.
  std::size_t frames = 0;           ///< This many data frames were sent on all buses.
  std::size_t again = 0;            ///< This many of them repeat an earlier frame.
  double link_s = 0.0;              ///< The slowest bus took this long.
  /// Returns true when every board has the image, including those that already had it.
  [[nodiscard]] bool complete() const;
};

/// Only those controllers of the bus that need the update are listed.
struct UpdateBus {
  session::Bus* bus = nullptr;
  std::vector<wire::NodeClaim> boards;
};

/// The wires of some links, each with its controllers.
struct BoardsOnWires {
  std::vector<std::unique_ptr<session::Bus>> wires;
  std::vector<UpdateBus> boards;       ///< one for each wire
  std::vector<wire::UniqueId> silent;  ///< expected, and silent on every wire however often they were asked
};
/// Finds the controllers on each wire of `links`, which must outlive the result. Whoever in `expected` (what the
/// command knows: the design's controllers, all that an earlier step has heard) does not answer is asked again on each
/// wire, see Bus::discover(). An update is not complete while somebody is silent. Throws Unreachable.
[[nodiscard]] BoardsOnWires find_boards(std::span<link::Link* const> links, const std::set<wire::UniqueId>& expected);

/// Writes the firmware into the free slot of all these controllers at once (docs/protocol.md, "One image to all"): each
/// image is sent once over each bus, then the parts that were lost. When all remaining controllers have checked it, all
/// start it; if one refuses, none does, unless `each` is set. A controller that was given up does not delay the others.
/// Controllers continue to sample until they restart. If there are several buses, each is served by its own thread;
/// `progress` is called by one thread at a time, with the number of the board (over all buses, in order) as part.
/// Throws InputError as require_fit(), the exceptions of Bus on a dead link, and
/// Cancelled when the process was asked to end before anything was activated; the old images then continue.
[[nodiscard]] BroadcastResult broadcast_firmware(std::span<const UpdateBus> buses, const FirmwarePackage& package,
                                                 const UpdateOptions& options = {}, const ProgressSink& progress = {});

}  // namespace triskin::deploy
