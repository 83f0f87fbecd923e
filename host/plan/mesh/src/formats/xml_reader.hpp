// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace triskin::mesh {

/// The start tag of an XML element with its namespace resolved. It is valid only during the call that receives it.
struct XmlTag {
  std::string_view space;  ///< The namespace is given by its URI, and is empty if there is none.
  std::string_view name;   ///< The name has no prefix.
  long line = 0;           ///< Lines are counted from 1.
  /// Each name is "URI\nname" or "name", followed by its value.
  std::vector<std::pair<std::string_view, std::string_view>> attributes;

  /// Returns the value of an attribute; `space` is empty for one without a prefix. The data is nullptr if the tag has
  /// no such attribute.
  [[nodiscard]] std::string_view attribute(std::string_view wanted, std::string_view in_space = {}) const;
};

/// parse_xml() calls these functions in the order of the text. They may be empty, and may throw.
struct XmlHandler {
  std::function<void(const XmlTag&)> start;
  std::function<void(std::string_view space, std::string_view name)> end;
  std::function<void(std::string_view)> text;  ///< One text may arrive in several pieces.
  /// This call precedes the tag that declares the namespace.
  std::function<void(std::string_view prefix, std::string_view uri)> declare;
};

/// Parses XML 1.0 in UTF-8 or UTF-16 with namespaces (expat). Comments, processing instructions and CDATA are treated
/// as the standard says. Errors: InputError "name, line N: …" in our own words, and what the handler throws. Cost:
/// linear.
void parse_xml(std::string_view bytes, const std::string& name, const XmlHandler& handler);

}  // namespace triskin::mesh
