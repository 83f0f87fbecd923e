// SPDX-License-Identifier: GPL-3.0-or-later
// libFuzzer enters one target here.
#include "fuzz/targets.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const triskin::fuzz::Target target = triskin::fuzz::find_target(TRISKIN_TARGET);
  target.run({data, size});
  return 0;
}
