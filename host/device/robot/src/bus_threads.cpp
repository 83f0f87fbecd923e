// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/robot/bus_threads.hpp"

#include <fmt/format.h>

#include <exception>

#include "triskin/base/counted.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/interrupt.hpp"
#include "triskin/base/outcomes.hpp"

namespace triskin::robot {
namespace {

// Describes the results of the other buses, to follow the message of the first that failed.
std::string rest_of(const std::vector<std::string>& names, const std::vector<std::exception_ptr>& failures,
                    std::size_t first) {
  std::string text;
  std::size_t good = 0;
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (!failures[k]) {
      ++good;
      continue;
    }
    if (k == first) continue;
    try {
      std::rethrow_exception(failures[k]);
    } catch (const std::exception& e) {
      text += fmt::format("\n  bus {}: {}", names[k], e.what());
    }
  }
  return text + fmt::format("\n  {} of {} did what was asked", good, counted(names.size(), "bus"));
}

[[noreturn]] void rethrow(const std::vector<std::string>& names, const std::vector<std::exception_ptr>& failures,
                          std::size_t first) {
  const std::string rest = rest_of(names, failures, first);
  const auto told = [&](const std::exception& e) { return fmt::format("bus {}: {}{}", names[first], e.what(), rest); };
  try {
    std::rethrow_exception(failures[first]);
  } catch (const InputError& e) {
    throw InputError(told(e));
  } catch (const Cancelled& e) {
    throw Cancelled(told(e));
  } catch (const DeviceError& e) {
    throw DeviceError(told(e));
  }
}

}  // namespace

void on_each_bus(const std::vector<std::string>& names, const std::function<void(std::size_t)>& work) {
  if (names.size() == 1) return work(0);
  const std::vector<std::exception_ptr> failures = outcomes_of(names.size(), work);
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (failures[k]) rethrow(names, failures, k);
  }
}

}  // namespace triskin::robot
