// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/design/rest_values.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "triskin/base/error.hpp"

namespace triskin::design {
namespace {

TEST(RestValues, come_back_as_they_were_written) {
  RestValues rest(2);
  rest[0].fill(32'768.0);
  rest[1].fill(31'000.25);
  EXPECT_EQ(parse_rest(rest_text(rest), "rest.json", 2), rest);
}

TEST(RestValues, that_a_controller_did_not_say_come_back_as_not_known) {
  RestValues settled(2);
  settled[0].fill(31'000.0);
  settled[1].fill(std::numeric_limits<double>::quiet_NaN());
  const std::string text = settled_text(settled);
  const RestValues back = parse_settled(text, "settled.json", 2);
  EXPECT_EQ(back[0], settled[0]);
  EXPECT_TRUE(std::isnan(back[1][0]) && std::isnan(back[1][11]));
  EXPECT_THROW((void)parse_rest(text, "rest.json", 2), InputError) << "rest values of a tare are all known";
  settled[0] = settled[1];
  EXPECT_EQ(settled_text(settled), "");
  EXPECT_EQ(settled_text({}), "");
}

TEST(RestValues, of_another_design_or_damaged_are_refused_with_the_place) {
  const std::string text = rest_text(RestValues(2));
  EXPECT_THROW((void)parse_rest(text, "rest.json", 3), InputError);
  EXPECT_THROW((void)parse_rest(text.substr(0, text.size() / 2), "rest.json", 2), InputError);
  try {
    (void)parse_rest(R"({"rest_counts":[[1,2,3]]})", "rest.json", 1);
    FAIL() << "three taxels were taken for a module";
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), testing::AllOf(testing::HasSubstr("rest.json"), testing::HasSubstr("rest_counts")));
  }
}

}  // namespace
}  // namespace triskin::design
