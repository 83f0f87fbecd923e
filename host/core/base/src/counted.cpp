// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/base/counted.hpp"

namespace triskin {

std::string noun_after(bool is_one, std::string_view noun) {
  constexpr std::string_view kVowels = "aeiou", kVertex = "vertex";
  std::string text(noun);
  if (is_one || noun.empty()) return text;
  if (noun.ends_with(kVertex)) return text.replace(text.size() - 2, 2, "ices");
  const bool is_consonant_y =
      noun.size() > 1 && noun.back() == 'y' && kVowels.find(noun[noun.size() - 2]) == std::string_view::npos;
  if (is_consonant_y) return text.replace(text.size() - 1, 1, "ies");
  const bool hisses = noun.ends_with("s") || noun.ends_with("x") || noun.ends_with("ch") || noun.ends_with("sh");
  return text + (hisses ? "es" : "s");
}

}  // namespace triskin
