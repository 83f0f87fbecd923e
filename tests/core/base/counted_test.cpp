// SPDX-License-Identifier: GPL-3.0-or-later
// Messages count things in English; the expected forms come from a dictionary.
#include "triskin/base/counted.hpp"

#include <gtest/gtest.h>

namespace triskin {
namespace {

TEST(Counted, puts_the_plural_after_every_number_but_one) {
  EXPECT_EQ(counted(1, "taxel"), "1 taxel");
  EXPECT_EQ(counted(0, "taxel"), "0 taxels");
  EXPECT_EQ(counted(std::size_t{2}, "module sample"), "2 module samples");
  EXPECT_EQ(counted(-1, "byte"), "-1 bytes");
}

TEST(Counted, knows_the_nouns_of_the_messages) {
  for (const auto& [one, many] : {std::pair{"patch", "patches"},
                                  {"bus", "buses"},
                                  {"body", "bodies"},
                                  {"box", "boxes"},
                                  {"vertex", "vertices"},
                                  {"address", "addresses"},
                                  {"node address", "node addresses"},
                                  {"key", "keys"},
                                  {"triangle", "triangles"},
                                  {"piece", "pieces"},
                                  {"radius limit", "radius limits"}})
    EXPECT_EQ(noun_after(false, one), many);
}

TEST(Counted, lets_the_verb_agree) {
  EXPECT_EQ(agreeing(1, "does", "do"), "does");
  EXPECT_EQ(agreeing(0, "does", "do"), "do");
  EXPECT_EQ(agreeing(12U, "does", "do"), "do");
}

}  // namespace
}  // namespace triskin
