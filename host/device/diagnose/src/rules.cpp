// SPDX-License-Identifier: GPL-3.0-or-later
#include "rules.hpp"

#include <algorithm>
#include <array>

namespace triskin::diagnose {
namespace {

using K = FindingKind;
using S = Seen;
using W = Work;

// What is seen → cause, work, words, remedy. {where} is a module with its patch and place, {or_else} names another
// cause that looks alike.
constexpr std::array kRules{
    // Controllers. What they read is not looked at.
    Rule{S::kNoController, K::kAbsentController, W::kCable,
         "patch {patch}: no controller answers at node address {node}", "check its power and its cable to the bus"},
    Rule{S::kSharedNode, K::kDuplicateController, W::kCable,
         "patch {patch}: {controllers} node address {node}: {serials}{without}",
         "take off the controller that does not belong to this skin; if both do, give each its own address: triskin "
         "flash --assign PATCH=SERIAL"},
    Rule{S::kNoTable, K::kNotFlashed, W::kFlash, "{patches}: no controller has {tables}; {controllers}",
         "run triskin flash with this design and link"},
    Rule{S::kNoTableAndSilent, K::kNotFlashed, W::kFlash,
         "{patches}: no controller has {tables}; {controllers}, and {silent} do not answer",
         "check power and cables of all controllers, then run triskin flash"},
    Rule{S::kOtherTables, K::kWrongTable, W::kFlash,
         "{patches}: the controllers hold other tables of this design ({held})", "run triskin flash with this design"},
    Rule{S::kOtherDesign, K::kWrongTable, W::kFlash,
         "{patches}: the skin holds design {held}, and this file is design {design}",
         "look first whether this is the right file: verify with that of design {held}; only if the skin is to become "
         "this design, run triskin flash --take-over"},
    Rule{S::kOtherKind, K::kWrongKind, W::kFlash,
         "patch {patch}: module {module} is {is} in the table of controller {node}, {meant} in the design",
         "look which kind is mounted; run triskin flash with the design that says so"},
    Rule{S::kBackupTable, K::kBackupRoute, W::kFlash,
         "patch {patch}: runs on the route prepared for the failure of {failure}; {read} read",
         "repair it, then run triskin flash without --route"},
    Rule{
        S::kOtherFirmware, K::kWrongFirmware, W::kLook,
        "patch {patch}: controller {node} has the firmware of another release: it speaks wire version {wire} and table "
        "layout {layout}, this program {own_wire} and {own_layout}",
        "update it: triskin flash --firmware; or use the program of its release"},
    Rule{S::kCrash, K::kCrashedController, W::kCable, "patch {patch}: controller {node} {crash}",
         "run triskin verify again and let it work; if it comes back, send this line and the firmware version to who "
         "makes the firmware, or find function and line with --elf"},
    Rule{S::kCrashNamed, K::kCrashedController, W::kCable, "patch {patch}: controller {node} {crash}",
         "the record is deleted now; if it comes back, send this line to who makes the firmware"},
    Rule{
        S::kSamplesLost, K::kLostSamples, W::kLook,
        "patch {patch}: {lost} of {samples} did not arrive: {dropped} found no room on the bus, {on_the_way} were lost "
        "on the way, {silent} while the controller was silent",
        "check cable and termination; {budget}"},

    // Many modules at once.
    Rule{S::kCablesExchanged, K::kWrongPatch, W::kCable,
         "patches {patch} and {other}: each is plugged into the controller of the other",
         "exchange the cables of the two controllers"},
    Rule{S::kOtherPatch, K::kWrongPatch, W::kCable, "patch {patch}: {what}",
         "exchange the cables of the controllers, or compare the patch with the assembly sheet"},
    Rule{S::kLinesExchanged, K::kSwappedLines, W::kCable,
         "patch {patch}: lines {line} and {other} are exchanged: modules of one answer on the other",
         "exchange the two lines at the patch's cable"},
    Rule{S::kMirrored, K::kMirroredPatch, W::kCable,
         "patch {patch}: it is mounted as its mirror image, or turned: {moved} of {modules} {answer} for others",
         "compare the patch with the assembly sheet; it may belong to the other side of the robot"},
    Rule{S::kLineHeld, K::kStuckLine, W::kShort,
         "patch {patch}, line L{line}: SDA or SCL {what}; modules on it: {list}",
         "look for a short of this line; part the joints from the far end on until the line is free"},
    Rule{S::kJointSilent, K::kMissingJoint, W::kJoint,
         "patch {patch}: no chip answers of the {modules} behind {joint} ({list})",
         "check this joint or cable first: one break explains all of them{or_else}"},
    Rule{
        S::kLineSilent, K::kMissingJoint, W::kJoint,
        "patch {patch}: no chip answers of the {modules} of line L{line} behind {joint} ({list}); its other lines pass "
        "there",
        "measure SDA and SCL of line L{line} along the way from the cable to this place: one of the two is open, at "
        "this joint or before it{or_else}"},
    Rule{S::kJointPassesNothing, K::kMissingJoint, W::kJoint,
         "patch {patch}: nothing passes {joint}{behind}{meanwhile}",
         "solder this joint anew; if that does not help, module {module} is dead, or holds a line of the bus low"},
    Rule{S::kNothingBetween, K::kMissingJoint, W::kJoint,
         "nothing passes between module {module} and module {other}, which are joined in the design",
         "look for a broken or unsoldered joint between them"},
    Rule{
        S::kSupplySilent, K::kSaggingSupply, W::kJoint,
        "patch {patch}: no chip answers of the {modules} with the longest way of the supply ({list}), which are behind "
        "{branches} different joints",
        "measure the supply at module {module}: a chip needs 2.6 V; shorten the way or feed it from another side"},
    Rule{S::kJointDipped, K::kSaggingSupply, W::kJoint,
         "patch {patch}: lost their configuration together: the {modules} behind {joint} ({list})",
         "measure the supply there: it sags along the tree; shorten the way or feed it from another side"},
    Rule{S::kSupplyAway, K::kSaggingSupply, W::kJoint,
         "patch {patch}: went and came back together: the {modules} with the longest way of the supply ({list}), which "
         "are behind {branches} different joints",
         "measure the supply at module {module}: a chip needs 2.6 V, and it dips; shorten the way or feed it from "
         "another side"},
    Rule{S::kSupplyDipped, K::kSaggingSupply, W::kJoint,
         "patch {patch}: lost their configuration together: the {modules} with the longest way of the supply ({list}), "
         "which are behind {branches} different joints",
         "measure the supply at module {module}: it sags along the tree; shorten the way or feed it from another side"},
    Rule{S::kJointAway, K::kLooseJoint, W::kJoint,
         "patch {patch}: went and came back together: the {modules} behind {joint} ({list})",
         "look for a loose contact there{or_else}"},
    Rule{S::kLineAway, K::kLooseJoint, W::kJoint,
         "patch {patch}: went and came back together: the {modules} of line L{line} behind {joint} ({list}); its other "
         "lines pass there",
         "measure SDA and SCL of line L{line} along the way from the cable to this place: one of the two is open, at "
         "this joint or before it{or_else}"},
    Rule{S::kRing, K::kWrongOrder, W::kPlace,
         "patch {patch}: modules {list} are in the wrong order: pressing each moves the next, the last moves the first",
         "compare the straps of these modules with the assembly sheet"},
    Rule{S::kPairSwapped, K::kSwappedModules, W::kPlace,
         "{where} and {other} are swapped: pressing one moves the taxels of the other",
         "exchange their straps, or their places"},
    Rule{S::kPairTurned, K::kSwappedModules, W::kPlace,
         "modules {module} and {other} are exchanged: each is turned as the other should be",
         "exchange them, or turn both as the assembly sheet says"},

    // One module.
    Rule{S::kOtherPlace, K::kWrongAddress, W::kStrap,
         "{where}: nothing answers there, but a chip answers at {place}, where the design has none",
         "solder the straps of module {module} to {meant}"},
    Rule{S::kTwoChips, K::kDuplicateAddress, W::kStrap, "{where}: two chips answer at once",
         "compare the straps of the modules with the assembly sheet"},
    Rule{S::kPlaceShared, K::kDuplicateAddress, W::kStrap,
         "{where}: nothing answers there; it sits at {place} together with module {other}",
         "solder the straps of module {module} to {meant}"},
    Rule{S::kTurned, K::kRotatedModule, W::kTurn, "{where}: is turned by {degrees}°: a tip on one taxel moves another",
         "turn the module back, or compare it with the assembly sheet"},
    Rule{S::kPortsTurned, K::kRotatedModule, W::kTurn,
         "module {module} is turned by {degrees}°: port A lies at side {side} instead of {designed}",
         "turn it as the assembly sheet says"},
    Rule{S::kOtherChip, K::kWrongId, W::kReplace, "{where}: a chip answers, but it is no AD7147",
         "look at the part that is soldered there; another device may share the address"},
    Rule{
        S::kNoChip, K::kAbsentModule, W::kReplace, "{where}: no chip answers",
        "check the module, its joint and its straps; verify --touch tells whether it sits on another module's address"},
    Rule{S::kNoChipAfterTouch, K::kAbsentModule, W::kReplace, "{where}: no chip answers",
         "replace the module, or check its joint to the parent"},
    Rule{S::kNothingRead, K::kAbsentModule, W::kReplace, "{where}: the controller has read nothing from it yet",
         "power-cycle the controller and verify again"},
    Rule{S::kReadByNeighbour, K::kAdoptedModule, W::kJoint,
         "patch {patch}: modules out of reach of its controller, which that of patch {other} reads: {list}",
         "repair the modules or joints between them and their own controller; they are handed back then"},
    Rule{S::kNoResponse, K::kNoTouchResponse, W::kReplace,
         "{where}: answers, but none of its taxels changes under a finger", "press it again; then replace the module"},
    Rule{S::kDipped, K::kLostConfiguration, W::kJoint, "{where}: its chip lost its configuration and was set up again",
         "check the supply of the module: its power dips"},
    Rule{S::kAway, K::kIntermittentModule, W::kJoint, "{where}: answers now, but did not for some time",
         "check its joints for a loose contact"},
    Rule{S::kDrifts, K::kDriftingChip, W::kReplace,
         "{where}: all its taxels drift by {rate} counts/s, the pads that feel no finger too; those of other modules "
         "do not",
         "let it warm up and verify again; then replace the module"},

    // Taxels.
    Rule{S::kManyAtEnd, K::kSaturatedTaxel, W::kReplace, "{where}: {taxels} {are} at the end of their range",
         "look for a short of the shield or of the converter's reference; else replace the module"},
    Rule{S::kAtEnd, K::kSaturatedTaxel, W::kReplace, "{where}: taxel {taxel} is at the end of its range",
         "look for a short between the pad and its neighbours or the shield"},
    Rule{S::kOneValue, K::kFrozenTaxel, W::kReplace, "{where}: taxel {taxel} keeps one value while the others change",
         "look for a broken trace to the pad"},
    Rule{S::kNotUnderFinger, K::kFrozenTaxel, W::kReplace,
         "{where}: taxel {taxel} does not change under a finger, the others do", "look for a broken trace to the pad"},
    Rule{S::kOtherAnswered, K::kTouchedOtherModule, W::kPlace, "{where} was to be pressed, {other} answered",
         "press the right module, or compare the straps of both with the assembly sheet"},
    Rule{S::kStrayChip, K::kUnexpectedChip, W::kCable,
         "patch {patch}: a chip answers at {place}, where the design has no module",
         "compare the straps with the assembly sheet"},
    Rule{S::kOffRest, K::kStaleRest, W::kTare, "{sentence}",
         "take everything off the skin and tare; what was exchanged or taken away since the last tare rests elsewhere"},

    // Only a chain of switched modules shows these.
    Rule{S::kModuleNotFound, K::kMissingModule, W::kReplace,
         "module {module} was not found: it or all of its joints are broken{behind}{meanwhile}",
         "check its supply and its joints, then the module, which may also hold a line of the bus low"},
    Rule{S::kModuleFitsNowhere, K::kExtraModule, W::kCable, "found module {number} fits nowhere in the design",
         "compare the patch with the assembly sheet"},
    Rule{
        S::kJointNotDesigned, K::kExtraJoint, W::kPart,
        "port {port} of module {module} and port {other_port} of module {other} are joined, in the design they are not",
        "part this joint"},
    Rule{S::kOtherEntry, K::kWrongEntry, W::kCable,
         "the cable is plugged into side {side} of module {entry}, the design has it at side {designed} of module "
         "{module}",
         "plug it where the assembly sheet says"},
    Rule{S::kSecondCable, K::kSecondCable, W::kCable,
         "the patch is read over its second cable, at module {entry}; over the first, at module {module}, too little "
         "answers",
         "check the first cable and its module"},
};

constexpr bool in_order() {
  for (std::size_t k = 0; k < kRules.size(); ++k) {
    if (kRules[k].seen != static_cast<Seen>(k)) return false;
  }
  return kRules.back().seen == Seen::kSecondCable;
}
static_assert(in_order());

}  // namespace

std::span<const Rule> rules() {
  return kRules;
}

int likelihood_rank(FindingKind kind) {
  const auto first = std::ranges::find(kRules, kind, &Rule::cause) - kRules.begin();
  return std::min(static_cast<int>(first), static_cast<int>(Seen::kModuleNotFound));
}

Work work_of(FindingKind kind) {
  return std::ranges::find(kRules, kind, &Rule::cause)->work;
}

}  // namespace triskin::diagnose
