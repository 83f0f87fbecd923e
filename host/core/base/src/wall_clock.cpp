// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/base/wall_clock.hpp"

#include <fmt/format.h>

#include <ctime>

namespace triskin {

std::string utc_text(std::uint64_t unix_s) {
  const auto time = static_cast<std::time_t>(unix_s);
  std::tm utc{};
  gmtime_r(&time, &utc);
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}Z", utc.tm_year + 1900, utc.tm_mon + 1, utc.tm_mday,
                     utc.tm_hour, utc.tm_min, utc.tm_sec);
}

}  // namespace triskin
