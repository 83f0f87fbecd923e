// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>

namespace triskin {

/// Elements of XML that programs write are nested less deeply; a reader that recurses needs some hundred bytes of stack
/// for each.
inline constexpr int kMaxXmlDepth = 500;

/// Throws InputError "name, line N: …" for XML that is nested deeper than kMaxXmlDepth, before a parser recurses into
/// it. What is not well-formed is left to that parser. Cost: linear.
void require_shallow_xml(std::string_view text, const std::string& name);

}  // namespace triskin
