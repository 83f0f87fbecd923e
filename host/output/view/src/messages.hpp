// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "triskin/view/server.hpp"

namespace triskin::view {

/// Parses a command from the page (docs/view.md); empty if it is invalid.
[[nodiscard]] std::optional<Command> command_of(std::string_view text);

/// Formats the status message for the page.
[[nodiscard]] std::string health_json(const LatestSamples::Health& health);

/// Formats the contacts for the page; a force that is not calibrated is null.
[[nodiscard]] std::string contacts_json(const std::vector<LatestSamples::Contact>& contacts);

/// Makes a random token of 32 hexadecimal digits. Throws DeviceError when the operating system has no random numbers.
[[nodiscard]] std::string random_token();

/// Returns true if two texts are equal; its running time does not reveal where they differ.
[[nodiscard]] bool equal_in_constant_time(std::string_view a, std::string_view b);

}  // namespace triskin::view
