// SPDX-License-Identifier: GPL-3.0-or-later
#include "argument_words.hpp"

#include <regex>

namespace triskin::library {

std::string argument_words(const std::string& message) {
  const std::regex clause("[^;\n]*[;\n]?");
  const std::regex link("--link ((?:sim|can|hid|usb)(?:[\\w:.,-]*\\w)?)"), every("--every (\\d+)");
  const std::regex other("--(link|scene|every|overload)\\b");
  std::string said;
  for (std::sregex_iterator part(message.begin(), message.end(), clause), end; part != end; ++part) {
    std::string text = part->str();
    if (text.find("triskin ") == std::string::npos) {
      text = std::regex_replace(text, link, "link=\"$1\"");
      text = std::regex_replace(text, every, "every=$1");
      text = std::regex_replace(text, other, "$1");
    }
    said += text;
  }
  return said;
}

}  // namespace triskin::library
