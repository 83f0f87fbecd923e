// SPDX-License-Identifier: GPL-3.0-or-later
// Tests what h5py cannot test: equal bytes, and a design without taxels. hdf5_test.py reads the content back.
#include "triskin/hdf5/taxel_table.hpp"

#include <gtest/gtest.h>

#include "support/strip_design.hpp"
#include "triskin/base/error.hpp"

namespace triskin::test {
namespace {

TEST(TaxelTable, is_the_same_for_the_same_design) {
  if (!hdf5::can_write()) GTEST_SKIP() << "built without HDF5";
  const std::string first = hdf5::taxel_table(strip(3));
  EXPECT_TRUE(first.starts_with("\x89HDF\r\n"));
  EXPECT_EQ(first, hdf5::taxel_table(strip(3)));
  EXPECT_NE(first, hdf5::taxel_table(strip(4)));
}

TEST(TaxelTable, refuses_a_design_without_modules) {
  EXPECT_THROW((void)hdf5::taxel_table(flat_design("empty", {0, 0}, {10, 10})), InputError);
}

}  // namespace
}  // namespace triskin::test
