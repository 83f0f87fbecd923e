// SPDX-License-Identifier: GPL-3.0-or-later
// Runs every target with its corpus, and with mutations of it from a fixed seed.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <random>
#include <vector>

#include "support/places.hpp"
#include "targets.hpp"

namespace triskin::fuzz {
namespace {

using Input = std::vector<std::uint8_t>;

std::vector<Input> corpus_of(std::string_view target) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(test::source_folder()) / "tests/fuzz/corpus" / target))
    files.push_back(entry.path());
  std::ranges::sort(files);
  std::vector<Input> inputs;
  for (const auto& file : files) {
    std::ifstream in(file, std::ios::binary);
    inputs.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  }
  return inputs;
}

Input mutate(const std::vector<Input>& corpus, std::mt19937& random) {
  constexpr std::array<std::uint8_t, 8> kTelling{0x00, 0x01, 0x07, 0x08, 0x7F, 0x80, 0xFE, 0xFF};
  Input x = corpus[random() % corpus.size()];
  for (unsigned n = 1 + random() % 4; n > 0; --n) {
    const std::size_t at = x.empty() ? 0 : random() % x.size();
    const auto place = x.begin() + static_cast<std::ptrdiff_t>(at);
    switch (x.empty() ? 3 : random() % 6) {
      case 0:
        x[at] ^= static_cast<std::uint8_t>(1U << random() % 8);
        break;
      case 1:
        x[at] = kTelling[random() % kTelling.size()];
        break;
      case 2:
        x.erase(place, place + static_cast<std::ptrdiff_t>(std::min<std::size_t>(1 + random() % 4, x.size() - at)));
        break;
      case 3:
        x.insert(place, 1 + random() % 4, static_cast<std::uint8_t>(random()));
        break;
      case 4:
        x.resize(at);
        break;
      default: {
        const Input& other = corpus[random() % corpus.size()];
        if (!other.empty())
          x.insert(x.end(), other.begin() + static_cast<std::ptrdiff_t>(random() % other.size()), other.end());
      }
    }
  }
  return x;
}

class Fuzz : public testing::TestWithParam<Target> {};

TEST_P(Fuzz, CorpusAndMutations) {
  const auto corpus = corpus_of(GetParam().name);
  ASSERT_GE(corpus.size(), 2U);
  for (const Input& input : corpus) GetParam().run(input);
  GetParam().run({});
  std::mt19937 random(31);
  for (int k = 0; k < GetParam().mutations; ++k) GetParam().run(mutate(corpus, random));
}

INSTANTIATE_TEST_SUITE_P(Decoders, Fuzz, testing::ValuesIn(targets().begin(), targets().end()),
                         [](const auto& p) { return std::string(p.param.name); });

}  // namespace
}  // namespace triskin::fuzz
