// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "triskin/base/names.hpp"
#include "triskin/wire/module_state.hpp"

namespace triskin::scene {

/// Names of the states of modules in scene files.
inline constexpr NameTable kModuleStateNames{std::array<std::pair<wire::ModuleState, std::string_view>, 9>{{
    {wire::ModuleState::kUnknown, "unknown"},
    {wire::ModuleState::kOk, "ok"},
    {wire::ModuleState::kAbsent, "absent"},
    {wire::ModuleState::kWrongId, "wrong_id"},
    {wire::ModuleState::kLostConfiguration, "lost_configuration"},
    {wire::ModuleState::kSaturated, "saturated"},
    {wire::ModuleState::kFrozen, "frozen"},
    {wire::ModuleState::kLineStuck, "line_stuck"},
    {wire::ModuleState::kDuplicate, "duplicate"},
}}};

/// What a scene expects of the samples of its skin.
struct Expectation {
  enum class Kind {
    kForceAbove,   ///< sum over the taxels, N, is more than `bound`
    kForceBelow,   ///< the same, is less
    kCountsAbove,  ///< the largest change of a taxel, counts, is more than `bound`
    kCountsBelow,  ///< the same, is less
    kPressed,      ///< a taxel is pressed
    kNotPressed,   ///< none is
    kState,        ///< the module reports `state`
    kSilent,       ///< no sample comes
  };
  Kind kind = Kind::kPressed;
  int module = -1;  ///< id in the design; −1: the whole skin
  int taxel = -1;   ///< −1: all of the module
  std::uint64_t from_us = 0;
  /// Every sample until then counts; empty: the first of each module from `from_us` on.
  std::optional<std::uint64_t> until_us{};
  bool once = false;  ///< one sample in the time is enough
  double bound = 0.0;
  wire::ModuleState state = wire::ModuleState::kOk;
  std::string place{};  ///< in the file, for messages: "scene.json:12: expect[3]"
};

/// The expectation as a sentence: "at 2 s module 4 reports more than 1 N".
[[nodiscard]] std::string text_of(const Expectation& expectation);

}  // namespace triskin::scene
