// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <fmt/format.h>

#include <span>

#include "triskin/diagnose/verify.hpp"

namespace triskin::diagnose {

/// What verify can see; rules.cpp says for each what it is taken for, in which words, and what mends it.
enum class Seen {
  kNoController,
  kSharedNode,
  kNoTable,
  kNoTableAndSilent,
  kOtherTables,
  kOtherDesign,
  kOtherKind,
  kBackupTable,
  kOtherFirmware,
  kCrash,
  kCrashNamed,
  kSamplesLost,

  kCablesExchanged,
  kOtherPatch,
  kLinesExchanged,
  kMirrored,
  kLineHeld,
  kJointSilent,
  kLineSilent,
  kJointPassesNothing,
  kNothingBetween,
  kSupplySilent,
  kJointDipped,
  kSupplyAway,
  kSupplyDipped,
  kJointAway,
  kLineAway,
  kRing,
  kPairSwapped,
  kPairTurned,
  kOtherPlace,
  kTwoChips,
  kPlaceShared,
  kTurned,
  kPortsTurned,
  kOtherChip,
  kNoChip,
  kNoChipAfterTouch,
  kNothingRead,
  kReadByNeighbour,
  kNoResponse,
  kDipped,
  kAway,
  kDrifts,
  kManyAtEnd,
  kAtEnd,
  kOneValue,
  kNotUnderFinger,
  kOtherAnswered,
  kStrayChip,
  kOffRest,

  kModuleNotFound,
  kModuleFitsNowhere,
  kJointNotDesigned,
  kOtherEntry,
  kSecondCable,
};

/// A person has to do one of these kinds of work.
enum class Work {
  kFlash,        ///< The tables have to be flashed again.
  kOtherDesign,  ///< The tables belong to another design, so the file may be the wrong one.
  kTare,         ///< Only the rest values are wrong.
  kLook,         ///< The work is at the computer or the bus, with the supply on.
  kReplace,      ///< The module is replaced by a new one.
  kStrap,        ///< The module's straps have to be changed.
  kPlace,        ///< Several modules have to change their places.
  kJoint,        ///< A joint has to be soldered again.
  kPart,         ///< A joint that should not exist has to be separated.
  kShort,        ///< The module that holds a line low has to be found.
  kTurn,         ///< The module has to be turned back.
  kCable,        ///< The cables of controllers, the lines of a cable or whole patches are exchanged.
};

struct Rule {
  Seen seen;
  FindingKind cause;
  Work work;
  const char *said, *remedy;  ///< words in {} are filled in
};
/// All rules, in the order of Seen.
[[nodiscard]] std::span<const Rule> rules();

/// Places findings of this kind among others: one cause for many modules is likelier than a cause for each, a wrong map
/// likelier than dead hardware. Kinds that only a chain shows come last, as they were seen.
[[nodiscard]] int likelihood_rank(FindingKind kind);
[[nodiscard]] Work work_of(FindingKind kind);

/// Says what was seen. `words` are fmt::arg() for the words of the rule; fmt::format_error is thrown if one is missing.
template <class... Words>
[[nodiscard]] Finding finding(Seen seen, const Words&... words) {
  const Rule& rule = rules()[static_cast<std::size_t>(seen)];
  Finding f;
  f.kind = rule.cause;
  f.text = fmt::format(fmt::runtime(rule.said), words...);
  f.remedy = fmt::format(fmt::runtime(rule.remedy), words...);
  return f;
}

}  // namespace triskin::diagnose
