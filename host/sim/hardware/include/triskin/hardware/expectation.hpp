// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "triskin/base/format_index.hpp"
#include "triskin/base/names.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/layout/index.hpp"
#include "triskin/wire/module_state.hpp"

namespace triskin::hardware {

/// Scene files use these names for the states of modules.
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

/// An expectation is a condition on the samples of a scene's skin.
struct Expectation {
  enum class Kind {
    kForceAbove,   ///< The sum over the taxels, in N, must be more than `bound`.
    kForceBelow,   ///< The sum over the taxels, in N, must be less than `bound`.
    kCountsAbove,  ///< The largest change of a taxel, in counts, must be more than `bound`.
    kCountsBelow,  ///< The largest change of a taxel, in counts, must be less than `bound`.
    kPressed,      ///< At least one taxel must be pressed.
    kNotPressed,   ///< No taxel may be pressed.
    kState,        ///< The module must report `state`.
    kSilent,       ///< No sample may arrive.
  };
  Kind kind = Kind::kPressed;
  std::string part{};  ///< In a scene of a robot, a part of it; if it is empty, the whole robot.
  layout::ModuleId module = layout::ModuleId::none();     ///< −1 means the whole skin of the part or robot.
  layout::TaxelIndex taxel = layout::TaxelIndex::none();  ///< −1 means all taxels of the module.
  design::ModuleNumber number{};                          ///< what people read of `module`
  std::uint64_t from_us = 0;
  /// Every sample until then counts; if it is empty, only the first of each module from `from_us` on.
  std::optional<std::uint64_t> until_us{};
  bool once = false;  ///< One sample in the interval is enough.
  double bound = 0.0;
  wire::ModuleState state = wire::ModuleState::kOk;
  std::string place{};  ///< Messages name this place in the file: "scene.json:12: expect[3]".
};

/// Formats the expectation as a sentence: "at 2 s module 4 of torso reports more than 1 N".
[[nodiscard]] std::string text_of(const Expectation& expectation);

}  // namespace triskin::hardware
