// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/design/rest_values.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "triskin/base/error.hpp"

namespace triskin::design {
namespace {

TEST(RestValues, come_back_as_they_were_written) {
  RestValues rest(2);
  rest[0].fill(32'768.0);
  rest[1].fill(31'000.25);
  EXPECT_EQ(parse_rest(rest_text(rest), "rest.json", 2), rest);
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
