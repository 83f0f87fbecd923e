// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scene_reader.hpp"
#include "triskin/design/module_graph.hpp"
#include "triskin/wire/identity.hpp"

namespace triskin::hardware {
namespace {

using design::has;
using design::JsonValue;
using design::number_in;

bool needs_switched(FaultKind kind) {
  return kind >= FaultKind::kDeadModule;
}

// Returns the keys of a kind besides "kind", "at_s" and "until_s".
std::vector<std::string_view> keys_of(FaultKind kind) {
  switch (kind) {
    case FaultKind::kMovedChip:
      return {"module", "line", "address"};
    case FaultKind::kSwappedChips:
    case FaultKind::kFingerElsewhere:
    case FaultKind::kOpenJoint:
    case FaultKind::kShortedJoint:
    case FaultKind::kExtraJoint:
      return {"module", "other"};
    case FaultKind::kStuckLine:
      return {"patch", "line", "signal", "frees_after_pulses"};
    case FaultKind::kWrongId:
      return {"module", "value"};
    case FaultKind::kLostConfiguration:
      return {"module", "every_s"};
    case FaultKind::kSaturatedTaxel:
    case FaultKind::kFrozenTaxel:
      return {"module", "taxel"};
    case FaultKind::kRotatedModule:
      return {"module", "steps"};
    case FaultKind::kHeldLine:
    case FaultKind::kOpenLine:
      return {"module", "line"};
    case FaultKind::kDriftingChip:
      return {"module", "counts_per_s"};
    case FaultKind::kOtherFirmware:
      return {"patch", "wire_version"};
    case FaultKind::kStuckBit:
      return {"module", "bit", "value"};
    case FaultKind::kSwappedPatches:
    case FaultKind::kSameNumber:
      return {"patch", "other"};
    case FaultKind::kRemovedChip:
    case FaultKind::kLoosePlug:
    case FaultKind::kDeadModule:
    case FaultKind::kModuleReset:
      break;
  }
  return {"module"};
}

void require_keys(const SceneNames& names, const JsonValue& v, FaultKind kind) {
  require_part_of_robot(names, v);
  const auto allowed = keys_of(kind);
  for (const auto& [key, value] : v.raw().items()) {
    const bool always = key == "kind" || key == "at_s" || key == "until_s" || key == "part";
    if (always || std::ranges::count(allowed, std::string_view(key)) > 0) continue;
    v.fail_at_key(key,
                  fmt::format("key \"{}\" is unknown for a {}; see docs/scene.md", key, kFaultKindNames.name(kind)));
  }
}

FaultKind read_kind(const SceneNames& names, const JsonValue& v) {
  const std::string text = v.text();
  const auto known = kFaultKindNames.value(text);
  if (!known) v.fail("\"" + text + "\" is not a kind of fault; docs/scene.md lists them");
  if (needs_switched(*known) && !names.switched)
    v.fail("\"" + text + "\" needs \"hardware\": \"switched\" in the scene");
  if (*known == FaultKind::kMovedChip && names.switched)
    v.fail("\"moved_chip\" is a fault of straps; switched modules have none");
  return *known;
}

// The chain of switched modules is assembled once before power-up, so such faults cannot have a time.
bool is_of_assembly(FaultKind kind, bool switched) {
  return kind == FaultKind::kExtraJoint ||
         (switched && (kind == FaultKind::kRotatedModule || kind == FaultKind::kSwappedChips));
}

void read_times(const SceneNames& names, const JsonValue& v, Fault& f) {
  const bool timed = has(v, "at_s") || has(v, "until_s");
  if (timed && is_of_assembly(f.kind, names.switched))
    v[has(v, "at_s") ? "at_s" : "until_s"].fail(
        "switched modules are joined before power comes, so this fault is there from the beginning; leave it out");
  if (has(v, "until_s") && f.kind == FaultKind::kSameNumber)
    v["until_s"].fail("the controller keeps its number until it gets another one; leave it out");
  if (has(v, "until_s") && f.kind == FaultKind::kModuleReset)
    v["until_s"].fail("a module_reset takes no time; leave it out");
  if (has(v, "until_s") && f.kind == FaultKind::kLostConfiguration && !has(v, "every_s"))
    v["until_s"].fail("one power dip takes no time; leave it out, or give \"every_s\"");
  if (f.kind == FaultKind::kLostConfiguration) f.from_us = 1'000'000;
  if (has(v, "at_s")) f.from_us = scene_time_us(v["at_s"]);
  if (has(v, "until_s")) f.until_us = scene_time_us(v["until_s"]);
  if (f.until_us <= f.from_us) v["until_s"].fail("must be later than \"at_s\"");
}

void read_other(const SceneNames& names, const JsonValue& v, Fault& f) {
  f.other = names.module(v["other"]);
  if (f.other == f.module) v["other"].fail("must be another module");
  if (f.kind != FaultKind::kOpenJoint && f.kind != FaultKind::kShortedJoint) return;
  const bool neighbours = std::ranges::count(design::joined_to(names.design.layout, f.module), f.other) > 0;
  if (!neighbours) v["other"].fail("has no joint with \"module\"");
}

void read_patches(const SceneNames& names, const JsonValue& v, Fault& f) {
  f.patch = names.patch(v["patch"]);
  f.other_patch = names.patch(v["other"]);
  if (f.other_patch == f.patch) v["other"].fail("must be another patch");
}

void read_stuck_line(const SceneNames& names, const JsonValue& v, Fault& f) {
  f.patch = names.patch(v["patch"]);
  f.line = v["line"].integer(0, 3);
  if (has(v, "signal")) {
    const std::string signal = v["signal"].text();
    if (signal != "sda" && signal != "scl") v["signal"].fail("must be \"sda\" or \"scl\"");
    f.stuck_scl = signal == "scl";
  }
  if (has(v, "frees_after_pulses")) f.frees_after_pulses = v["frees_after_pulses"].integer(0, 1000);
}

void read_numbers(const JsonValue& v, Fault& f) {
  switch (f.kind) {
    case FaultKind::kMovedChip:
      f.line = v["line"].integer(0, 3);
      f.address = v["address"].integer(0, 3);
      break;
    case FaultKind::kWrongId:
      f.value = has(v, "value") ? v["value"].integer(0, 0xFFFF) : 0xFFFF;
      break;
    case FaultKind::kLostConfiguration:
      if (has(v, "every_s")) f.every_us = static_cast<std::uint64_t>(number_in(v["every_s"], 1e-3, kMaxScene_s) * 1e6);
      break;
    case FaultKind::kSaturatedTaxel:
    case FaultKind::kFrozenTaxel:
      f.taxel = layout::TaxelIndex{v["taxel"].integer(0, 11)};
      break;
    case FaultKind::kRotatedModule:
      f.value = has(v, "steps") ? v["steps"].integer(1, 2) : 1;
      break;
    case FaultKind::kHeldLine:
    case FaultKind::kOpenLine:
      f.line = v["line"].integer(0, 3);
      break;
    case FaultKind::kDriftingChip:
      f.value = v["counts_per_s"].integer(-10'000, 10'000);
      break;
    case FaultKind::kStuckBit:
      f.bit = v["bit"].integer(0, 7);
      f.value = v["value"].integer(0, 1);
      break;
    default:
      break;  // The other kinds have no number of their own.
  }
}

}  // namespace

Fault read_fault(const SceneNames& names, const JsonValue& v) {
  Fault f;
  f.kind = read_kind(names, v["kind"]);
  require_keys(names, v, f.kind);
  if (f.kind == FaultKind::kStuckLine) {
    read_stuck_line(names, v, f);
  } else if (f.kind == FaultKind::kSwappedPatches || f.kind == FaultKind::kSameNumber) {
    read_patches(names, v, f);
  } else if (f.kind == FaultKind::kOtherFirmware) {
    f.patch = names.patch(v["patch"]);
    f.value = has(v, "wire_version") ? v["wire_version"].integer(0, 0xFFFF) : wire::kWireVersion + 1;
  } else {
    f.module = names.module(v["module"]);
    const auto keys = keys_of(f.kind);
    if (std::ranges::count(keys, std::string_view("other")) > 0) read_other(names, v, f);
    read_numbers(v, f);
  }
  read_times(names, v, f);
  return f;
}

}  // namespace triskin::hardware
