// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <iterator>

#include "triskin/triskin.h"
#include "triskin/wire/taxel_frames.hpp"

namespace triskin::library {

/// Converts a frame to a sample of triskin.h, taken at `time_s` since 1970 within ± `error_s`, of module `module`.
[[nodiscard]] inline triskin_sample sample_of(const wire::TaxelFrame& frame, int module, double time_s,
                                              double error_s) {
  triskin_sample s{};
  s.time_s = time_s;
  s.error_s = error_s;
  s.device_time_us = frame.device_time_us;
  s.number = frame.sample;
  s.module = module;
  s.node = frame.node_address;
  s.valid = frame.valid;
  std::ranges::copy(frame.value, std::begin(s.value));
  return s;
}

}  // namespace triskin::library
