// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/sampling/address_scan.hpp"

#include "triskin/layout/patch_image.hpp"

namespace triskin::fw {

void AddressScan::request() {
  result_ = {};
  requested_ = true;
}

void AddressScan::begin() {
  requested_ = false;
  address_ = 0;
}

bool AddressScan::answered(Status transfer, Status identity) {
  const auto bit = static_cast<std::uint8_t>(1U << address_);
  if (transfer == Status::kOk) {
    result_.answers = static_cast<std::uint8_t>(result_.answers | bit);
    if (identity != Status::kOk) result_.wrong_id = static_cast<std::uint8_t>(result_.wrong_id | bit);
  }
  ++address_;
  result_.done = address_ == layout::kAddressesPerLine;
  return !result_.done;
}

void AddressScan::line_stuck(bool freed) {
  if (freed) return request();
  result_.stuck = true;
  result_.done = true;
}

}  // namespace triskin::fw
