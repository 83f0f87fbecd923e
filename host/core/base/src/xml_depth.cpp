// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/base/xml_depth.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "triskin/base/error.hpp"

namespace triskin {
namespace {

std::size_t behind(std::string_view text, std::string_view mark, std::size_t from) {
  const std::size_t at = text.find(mark, from);
  return at == std::string_view::npos ? text.size() : at + mark.size();
}

// A document type may declare entities in brackets, whose texts are no elements.
std::size_t behind_doctype(std::string_view text, std::size_t at) {
  int brackets = 0;
  for (; at < text.size() && (brackets > 0 || text[at] != '>'); ++at) {
    if (text[at] == '[') ++brackets;
    if (text[at] == ']') --brackets;
  }
  return std::min(at + 1, text.size());
}

// The values of attributes may have a ">".
std::size_t behind_tag(std::string_view text, std::size_t at) {
  at = std::min(text.find_first_of(" \t\r\n/>?", at + 1), text.size());
  char quote = 0, before = 0;
  for (; at < text.size() && (quote != 0 || text[at] != '>'); ++at) {
    const char c = text[at];
    if (c == quote)
      quote = 0;
    else if (quote == 0 && before == '=' && (c == '"' || c == '\''))
      quote = c;
    if (c != ' ' && c != '\t' && c != '\r' && c != '\n') before = c;
  }
  return std::min(at + 1, text.size());
}

}  // namespace

void fail_too_deep(const std::string& name, long line) {
  throw InputError(fmt::format("{}, line {}: its XML is nested more than {} deep; repair or export it again", name,
                               line, kMaxXmlDepth));
}

void require_shallow_xml(std::string_view text, const std::string& name) {
  int depth = 0;
  for (std::size_t at = text.find('<'); at != std::string_view::npos; at = text.find('<', at)) {
    const std::string_view rest = text.substr(at);
    if (rest.starts_with("<!--")) {
      at = behind(text, "-->", at + 4);
    } else if (rest.starts_with("<![CDATA[")) {
      at = behind(text, "]]>", at);
    } else if (rest.starts_with("<!DOCTYPE")) {
      at = behind_doctype(text, at);
    } else if (rest.starts_with("<?")) {
      at = behind(text, "?>", at);
    } else if (rest.starts_with("</")) {
      --depth;
      at = behind(text, ">", at);
    } else {
      const std::size_t from = at;
      at = behind_tag(text, at);
      const bool is_empty = text.substr(from, at - from).ends_with("/>");
      if (!is_empty && ++depth > kMaxXmlDepth) fail_too_deep(name, 1 + std::ranges::count(text.substr(0, from), '\n'));
    }
  }
}

}  // namespace triskin
