// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/design/json_value.hpp"

namespace triskin::design {

nlohmann::json parse_json(const std::string& text, const std::string& file) {
  // The parser recurses: bound the depth before it does.
  int depth = 0;
  bool in_text = false;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const char c = text[k];
    if (in_text) {
      if (c == '\\') ++k;
      if (c == '"') in_text = false;
    } else if (c == '"') {
      in_text = true;
    } else if (c == '[' || c == '{') {
      if (++depth > 64) throw InputError(fmt::format("{}: nested deeper than 64", file));
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  try {
    return nlohmann::json::parse(text);
  } catch (const nlohmann::json::exception& e) {
    throw InputError(fmt::format("{}: not JSON ({})", file, e.what()));
  }
}

}  // namespace triskin::design
