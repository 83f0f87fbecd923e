// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/base/nearest_name.hpp"

#include <algorithm>
#include <numeric>

namespace triskin {
namespace {

// Counts the letters to insert, delete, replace, or swap with the next (optimal string alignment).
std::size_t letters_between(const std::string& a, const std::string& b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
  std::iota(d[0].begin(), d[0].end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0U : 1U)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  }
  return d[a.size()][b.size()];
}

}  // namespace

std::string nearest_name(const std::string& word, const std::vector<std::string>& names, std::size_t typed) {
  std::string best;
  std::size_t fewest = std::max<std::size_t>(1, typed / 3) + 1;
  for (const std::string& name : names) {
    const std::size_t letters = letters_between(word, name);
    if (letters >= fewest) continue;
    fewest = letters;
    best = name;
  }
  return best;
}

}  // namespace triskin
