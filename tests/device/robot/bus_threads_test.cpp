// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/robot/bus_threads.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <barrier>
#include <thread>

#include "triskin/base/error.hpp"
#include "triskin/base/interrupt.hpp"

namespace triskin::robot {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(BusThreads, buses_are_served_at_the_same_time) {
  std::barrier all(3);  // No thread passes before all three are there.
  std::atomic<int> done = 0;
  on_each_bus({"a", "b", "c"}, [&](std::size_t) {
    all.arrive_and_wait();
    ++done;
  });
  EXPECT_EQ(done, 3);
}

TEST(BusThreads, one_bus_runs_in_the_calling_thread_and_throws_as_it_is) {
  std::thread::id where;
  on_each_bus({""}, [&](std::size_t) { where = std::this_thread::get_id(); });
  EXPECT_EQ(where, std::this_thread::get_id());
  try {
    on_each_bus({""}, [](std::size_t) { throw DeviceError("can0: down"); });
    FAIL();
  } catch (const DeviceError& e) {
    EXPECT_STREQ(e.what(), "can0: down");
  }
}

TEST(BusThreads, the_others_go_on_and_all_failures_are_named) {
  std::atomic<int> done = 0;
  try {
    on_each_bus({"left", "head", "right"}, [&](std::size_t k) {
      if (k == 0) throw DeviceError("no answer");
      if (k == 2) throw InputError("no such thing");
      ++done;
    });
    FAIL();
  } catch (const DeviceError& e) {
    EXPECT_THAT(e.what(), AllOf(HasSubstr("bus left: no answer"), HasSubstr("bus right: no such thing"),
                                HasSubstr("1 of 3 buses did what was asked")));
  }
  EXPECT_EQ(done, 1);
}

TEST(BusThreads, keeps_the_kind_of_the_first_failure) {
  EXPECT_THROW(on_each_bus({"a", "b"}, [](std::size_t) { throw InputError("x"); }), InputError);
  EXPECT_THROW(on_each_bus({"a", "b"}, [](std::size_t) { throw Cancelled("x"); }), Cancelled);
}

}  // namespace
}  // namespace triskin::robot
