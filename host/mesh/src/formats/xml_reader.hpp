// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace triskin::geometry {

/// The start tag of an XML element, with its namespace resolved. Valid during the call that gets it.
struct XmlTag {
  std::string_view space;  ///< It is the URI of the namespace, empty where there is none.
  std::string_view name;   ///< The prefix is taken off.
  long line = 0;           ///< Lines are counted from 1.
  /// Each is "URI\nname" or "name", with its value.
  std::vector<std::pair<std::string_view, std::string_view>> attributes;

  /// Value of an attribute, `space` empty for one without a prefix; nullptr data where the tag has none.
  [[nodiscard]] std::string_view attribute(std::string_view wanted, std::string_view in_space = {}) const;
};

/// What parse_xml() calls, in the order of the text. Functions may be empty, and may throw.
struct XmlHandler {
  std::function<void(const XmlTag&)> start;
  std::function<void(std::string_view space, std::string_view name)> end;
  std::function<void(std::string_view)> text;  ///< It is called for each piece of text.
  /// Called ahead of the tag that declares it.
  std::function<void(std::string_view prefix, std::string_view uri)> declare;
};

/// Parses XML 1.0 in UTF-8 or UTF-16 with namespaces (expat). Comments, processing instructions and CDATA are what the
/// standard says. Errors: InputError "name, line N: …" in our own words, and what the handler throws. Cost: linear.
void parse_xml(std::string_view bytes, const std::string& name, const XmlHandler& handler);

}  // namespace triskin::geometry
