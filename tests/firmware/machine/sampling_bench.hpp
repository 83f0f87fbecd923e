// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>

#include "bench.hpp"
#include "triskin/wire/taxel_frames.hpp"

namespace triskin::machine {

struct SamplingSetup {
  wire::Decimation decimation = wire::Decimation::k256;
  std::uint8_t every = 1;
  wire::TaxelOutput output = wire::TaxelOutput::kRaw;
  wire::SamplingTiming timing = wire::SamplingTiming::kTracked;
};

/// Streams a patch in full.
class Sampling : public Bench {
 protected:
  /// Afterwards sampling runs as requested, every module is found, checked at both inputs, and its clock is known;
  /// `frames` is still empty.
  void start(int modules, SamplingSetup setup = {}) {
    store_table(patch(modules));
    power_up();
    run_for(100'000);
    unlock();
    std::vector<std::uint8_t> write{0x2E,        0xFD,
                                    0x0A,        static_cast<std::uint8_t>(setup.decimation),
                                    setup.every, static_cast<std::uint8_t>(setup.output)};
    if (setup.timing != wire::SamplingTiming::kTracked) write.push_back(static_cast<std::uint8_t>(setup.timing));
    ASSERT_EQ(request(write).at(0), 0x6E);
    ASSERT_EQ(request({0x2E, 0xFD, 0x05, 0x02}).at(0), 0x6E);
    run_for(setup.decimation == wire::Decimation::k256 ? 1'000'000 : 500'000);
    frames.clear();
  }
  /// Returns full frames by row of the table.
  [[nodiscard]] std::map<int, std::vector<wire::TaxelFrame>> samples() const {
    std::map<int, std::vector<wire::TaxelFrame>> out;
    for (const wire::CanFrame& f : frames) {
      if (const auto t = wire::decode_full(f)) out[t->module].push_back(*t);
    }
    return out;
  }
};

}  // namespace triskin::machine
