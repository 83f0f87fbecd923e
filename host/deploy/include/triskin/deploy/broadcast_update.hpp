// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "triskin/base/progress.hpp"
#include "triskin/deploy/firmware_update.hpp"
#include "triskin/session/bus.hpp"
#include "triskin/wire/node_claim.hpp"

namespace triskin::device {

struct BroadcastOptions {
  bool each = false;         ///< A controller that is ready starts the new image even when another one refuses it.
  bool allow_older = false;  ///< A newer version may be replaced too.
  bool dry_run = false;      ///< It asks and says what would happen, and writes nothing.
  bool force = false;        ///< It writes images that are equal, too.
};

/// Result for one controller.
enum class UpdateOutcome : std::uint8_t {
  kUpdated,   ///< The new image runs.
  kEqual,     ///< The image ran already.
  kWould,     ///< The image would be written without the dry run.
  kByLoader,  ///< The board knows no broadcast (version 0.1), so update_firmware() is run for it.
  kRefused,   ///< The controller refused, or nothing was sent to it; what ran goes on.
  kHeldBack,  ///< The controller was ready, but another one refused; what ran goes on.
  kGivenUp,   ///< It does not answer any more, or was restarted; what ran is what starts.
};
/// Name of an outcome, as reports have it.
[[nodiscard]] std::string_view outcome_name(UpdateOutcome outcome);

struct BoardUpdate {
  wire::NodeClaim claim;
  std::string serial;
  UpdateOutcome outcome = UpdateOutcome::kGivenUp;
  std::string why;        ///< It is a sentence, and empty for kUpdated, kEqual and kWould.
  int slot = -1;          ///< This slot runs now; −1 means unknown.
  std::size_t bytes = 0;  ///< So many bytes were written.
};

struct BroadcastResult {
  std::vector<BoardUpdate> boards;  ///< They stand in the order of the boards given.
  int rounds = 0;                   ///< On the bus with the most rounds, missing units were asked for so often.
  std::size_t frames = 0;           ///< So many data frames were sent on all buses.
  std::size_t again = 0;            ///< So many of them repeat an earlier frame.
  double link_s = 0.0;              ///< It is the time of the slowest bus.
  /// True when every board has the image now, or had it.
  [[nodiscard]] bool complete() const;
};

/// A bus and those of its controllers that are to be updated.
struct UpdateBus {
  Bus* bus = nullptr;
  std::vector<wire::NodeClaim> boards;
};

/// True when the images of the package say what they are for: those of version 0.1 do not, and take no part.
[[nodiscard]] bool has_labels(const FirmwarePackage& package);

/// Puts the firmware into the free slot of all these controllers at once (docs/protocol.md, "One image to all"): each
/// image goes over each bus once, then what was lost. When all that are still there have checked it, all start it; if
/// one refuses, none does, unless `each`. A controller that is given up holds up nobody. Controllers go on sampling
/// until they restart. Buses are served side by side, each by a thread of its own where there are several; `progress`
/// is called by one at a time, with the number of the board (over all buses, in order) as part. Throws InputError (no
/// labels, other hardware, a head that does not fit); what Bus throws on a dead link; Cancelled when the process was
/// asked to end before anything was activated: what ran goes on.
[[nodiscard]] BroadcastResult broadcast_firmware(std::span<const UpdateBus> buses, const FirmwarePackage& package,
                                                 const BroadcastOptions& options = {},
                                                 const ProgressSink& progress = {});

}  // namespace triskin::device
