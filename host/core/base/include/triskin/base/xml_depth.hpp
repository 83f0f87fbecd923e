// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>

namespace triskin {

/// Elements of XML that programs write are nested less deeply; a reader that recurses needs some hundred bytes of stack
/// for each.
inline constexpr int kMaxXmlDepth = 500;

/// Throws the InputError "name, line N: …" of XML that is nested deeper than kMaxXmlDepth.
[[noreturn]] void fail_too_deep(const std::string& name, long line);

/// Calls fail_too_deep() where the XML is, before a parser recurses into it. What is not well-formed is left to that
/// parser; a strict one in this place would stop at what a lenient one reads on. Cost: linear.
void require_shallow_xml(std::string_view text, const std::string& name);

}  // namespace triskin
