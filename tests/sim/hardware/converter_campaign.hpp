// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "triskin/core/bytes.hpp"
#include "triskin/hardware/converters.hpp"
#include "triskin/hardware/flash_memory.hpp"
#include "triskin/hardware/i2c_line.hpp"
#include "triskin/hardware/scene.hpp"
#include "triskin/layout/patch_image.hpp"
#include "triskin/sim/virtual_controller.hpp"
#include "triskin/wire/iso_tp.hpp"
#include "triskin/wire/module_state.hpp"
#include "triskin/wire/sampling.hpp"
#include "triskin/wire/uds.hpp"

/// Patches of sixteen modules whose converters are drawn from the whole of their ranges, with the application of the
/// controller on them: which module does it refuse, which fault does it miss?
namespace triskin::test {

enum class PatchFault {
  kNone,
  kDoubledAddress,
  kDoubledLater,  ///< in the first three seconds the chip moves to the address of another one, with or without a reset
  kDeadChip,
  kOpenLine,
  kStuckTaxel,
  kShortedTaxel
};
inline constexpr std::array<const char*, 7> kPatchFaultNames{
    "none", "doubled address", "doubled later", "dead chip", "open line", "stuck taxel", "shorted taxel"};

/// Changes each drawn chip, to see what is borne beyond the ranges.
using ChipChange = std::function<void(hardware::Ad7147Behaviour&)>;

/// What became of the modules of one patch five seconds after its last change.
struct PatchResult {
  std::string description;       ///< what was drawn, and which modules are not as they should be
  int healthy = 0, refused = 0;  ///< modules without a fault; of these, those that are not in order
  int faulty = 0, missed = 0;    ///< modules with a fault; of these, those that are not in their state
};

class CampaignPatch {
 public:
  static constexpr std::uint64_t kAllowed_us = 5'000'000;
  /// A frozen taxel is called so only after the others of its chip have changed often.
  static constexpr std::uint64_t kFrozen_us = 60'000'000;

  CampaignPatch(std::uint32_t seed, PatchFault fault, const ChipChange& change = {}) : fault_(fault), random_(seed) {
    draw_chips(seed, change);
    plant_fault();
    start(seed);
  }

  PatchResult run() {
    now_us_ = joins_us_ + kAllowed_us;
    controller_->run_until(now_us_);
    PatchResult result;
    wire::ModuleStates states = ask_states();
    if (fault_ == PatchFault::kStuckTaxel) {
      check(states, result, false);
      controller_->run_until(kFrozen_us);
      now_us_ = kFrozen_us;
      states = ask_states();
      check(states, result, true);
    } else {
      check(states, result, true);
    }
    if (result.refused + result.missed > 0)
      result.description = std::string(kPatchFaultNames[static_cast<std::size_t>(fault_)]) + ", decimation " +
                           std::to_string(64 << static_cast<int>(2 - static_cast<int>(decimation_))) + ":" +
                           result.description;
    return result;
  }

 private:
  struct Electrodes final : hardware::CapacitanceSource {
    std::array<double, layout::kTaxelsPerModule> rest{};
    int stuck = -1;
    [[nodiscard]] double counts(int cin, std::uint64_t) const override {
      return cin < layout::kTaxelsPerModule ? rest[static_cast<std::size_t>(cin)] : 0.0;
    }
    [[nodiscard]] bool is_stuck(int cin, std::uint64_t) const override { return cin == stuck; }
  };
  struct Module {
    Electrodes electrodes;
    std::unique_ptr<hardware::Ad7147> chip;
    int line = 0, address = 0;
    int later_address = -1;  // from joins_us_ on
    bool attached = true;
    wire::ModuleState expected = wire::ModuleState::kOk;
  };

  double in(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  int below(int n) { return static_cast<int>(random_() % static_cast<unsigned>(n)); }

  // The electrodes of one kind of board resemble each other, as those of our own board do, or they are any.
  void draw_chips(std::uint32_t seed, const ChipChange& change) {
    const hardware::Converters converters;
    const double low_pf = hardware::Effects{}.electrode_least_pf, high_pf = hardware::Effects{}.electrode_most_pf;
    constexpr double kOwnBoard_pf = 4.0;  // docs/silicon.md, without a plane under the pads
    const int kind = below(3);
    const double unlike_pf = in(0.1, 1.0);
    std::array<double, layout::kTaxelsPerModule> board_pf{};
    for (double& pf : board_pf) pf = in(low_pf, kind == 0 ? kOwnBoard_pf : high_pf);
    for (int m = 0; m < layout::kMaxModules; ++m) {
      Module& module = modules_[static_cast<std::size_t>(m)];
      for (std::size_t t = 0; t < board_pf.size(); ++t) {
        const double pf =
            kind < 2 ? std::clamp(board_pf[t] + in(-unlike_pf, unlike_pf), low_pf, high_pf) : in(low_pf, high_pf);
        module.electrodes.rest[t] = pf * hardware::kCountsPerPf;
      }
      const std::uint64_t serial = std::uint64_t{seed} * layout::kMaxModules + static_cast<std::uint64_t>(m) + 1;
      module.chip = std::make_unique<hardware::Ad7147>(module.electrodes);
      hardware::Ad7147Behaviour behaviour = converters.of(serial);
      if (change) change(behaviour);
      module.chip->set_behaviour(behaviour);
      module.chip->set_noise(serial);
      module.line = m / layout::kAddressesPerLine;
      module.address = m % layout::kAddressesPerLine;
    }
    decimation_ = static_cast<wire::Decimation>(below(3));
  }

  void plant_fault() {
    Module& one = modules_[static_cast<std::size_t>(below(layout::kMaxModules))];
    const int taxel = below(layout::kTaxelsPerModule);
    switch (fault_) {
      case PatchFault::kNone:
        return;
      case PatchFault::kDoubledAddress:
      case PatchFault::kDoubledLater:
        for (Module& other : modules_) {
          if (other.line != one.line || other.address != (one.address + 1) % layout::kAddressesPerLine) continue;
          one.expected = wire::ModuleState::kAbsent;
          other.expected = wire::ModuleState::kDuplicate;
          if (fault_ == PatchFault::kDoubledAddress) {
            one.address = other.address;
            return;
          }
          one.later_address = other.address;
          joins_us_ = static_cast<std::uint64_t>(below(3'000'000));
          if (below(2) == 0) one.chip->schedule_power_dip(joins_us_, 0);
          return;
        }
        return;
      case PatchFault::kDeadChip:
        one.attached = false;
        one.expected = wire::ModuleState::kAbsent;
        return;
      case PatchFault::kOpenLine:
        for (Module& m : modules_) {
          if (m.line != one.line) continue;
          m.attached = false;
          m.expected = wire::ModuleState::kAbsent;
        }
        return;
      case PatchFault::kStuckTaxel:
        one.electrodes.stuck = taxel;
        one.expected = wire::ModuleState::kFrozen;
        return;
      case PatchFault::kShortedTaxel:
        one.electrodes.rest[static_cast<std::size_t>(taxel)] = 1e6;
        one.expected = wire::ModuleState::kSaturated;
        return;
    }
  }

  void start(std::uint32_t seed) {
    layout::PatchImage image;
    image.design_id = seed;
    image.node_address = kNode;
    image.module_count = layout::kMaxModules;
    image.positive_input = below(2) == 0;
    for (std::uint8_t k = 0; k < layout::kMaxModules; ++k) {
      const auto parent = k == 0 ? layout::kNoParent : static_cast<std::uint8_t>(k - 1);
      image.modules[k] = {k,
                          static_cast<std::uint8_t>(k / layout::kAddressesPerLine),
                          static_cast<std::uint8_t>(k % layout::kAddressesPerLine),
                          0,
                          parent,
                          k == 0 ? layout::kCable : std::uint8_t{1}};
    }
    for (Module& m : modules_) {
      if (!m.attached) continue;
      lines_[static_cast<std::size_t>(m.line)].attach(*m.chip, [this, &m](std::uint64_t at_us) {
        return int{layout::cdc_address(m.later_address >= 0 && at_us >= joins_us_ ? m.later_address : m.address)};
      });
    }
    controller_ = sim::make_virtual_controller(
        {{&lines_[0], &lines_[1], &lines_[2], &lines_[3]}, &flash_, {1, 2, 3}, [this](const wire::CanFrame& f) {
           arrived_.push_back(f);
         }});
    controller_->run_until(0);
    flash_table(image);
    (void)ask({0x2E, 0xFD, 0x0A, wire::wire_number(decimation_), 1, 0});
  }

  void flash_table(const layout::PatchImage& image) {
    std::array<std::uint8_t, layout::kMaxImageBytes> bytes{};
    const std::size_t size = layout::encode(image, bytes).value();
    (void)ask({0x10, 0x03});
    const auto seed = ask({0x27, 0x01});
    const std::uint32_t key = wire::security_key(ByteReader(Bytes(seed).subspan(2)).be32());
    const auto byte = [](std::uint32_t value, int shift) { return static_cast<std::uint8_t>(value >> shift); };
    (void)ask({0x27, 0x02, byte(key, 24), byte(key, 16), byte(key, 8), byte(key, 0)});
    const auto length = static_cast<std::uint32_t>(size);
    (void)ask({0x34, 0x00, 0x44, 0, 1, 0, 0, 0, 0, byte(length, 8), byte(length, 0)});
    std::uint8_t block = 0;
    for (std::size_t at = 0; at < size; at += 64) {
      std::vector<std::uint8_t> m{0x36, ++block};
      const std::size_t end = std::min(at + 64, size);
      m.insert(m.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at),
               bytes.begin() + static_cast<std::ptrdiff_t>(end));
      (void)ask(m);
    }
    (void)ask({0x37});
    (void)ask({0x31, 0x01, 0x02, 0x05});
  }

  std::vector<std::uint8_t> ask(const std::vector<std::uint8_t>& request) {
    wire::IsoTp link(wire::physical_id(kNode, wire::kTesterAddress), wire::physical_id(wire::kTesterAddress, kNode),
                     64);
    (void)link.send(request, now_us_);
    for (int tick = 0; tick < 2'000; ++tick) {
      while (const auto f = link.transmit(now_us_)) controller_->receive(*f);
      now_us_ += 200;
      controller_->run_until(now_us_);
      while (!arrived_.empty()) {
        const wire::CanFrame frame = arrived_.front();
        arrived_.pop_front();
        if (frame.id != link.rx_id() || link.receive(frame, now_us_) != wire::IsoTp::Event::kReceived) continue;
        const Bytes m = link.message();
        return {m.begin(), m.end()};
      }
    }
    return {};
  }

  wire::ModuleStates ask_states() {
    const auto answer = ask({0x22, 0xFD, 0x03});
    return wire::ModuleStates::decode(Bytes(answer).subspan(3)).value();
  }

  void check(const wire::ModuleStates& states, PatchResult& result, bool with_faults) {
    for (std::size_t k = 0; k < modules_.size(); ++k) {
      const Module& m = modules_[k];
      const bool healthy = m.expected == wire::ModuleState::kOk;
      if (!healthy && !with_faults) continue;
      const bool wrong = k >= states.count || states.state[k] != m.expected;
      ++(healthy ? result.healthy : result.faulty);
      if (!wrong) continue;
      ++(healthy ? result.refused : result.missed);
      result.description += " module " + std::to_string(k) + " has state " +
                            std::to_string(k < states.count ? static_cast<int>(states.state[k]) : -1) + " instead of " +
                            std::to_string(static_cast<int>(m.expected));
    }
  }

  static constexpr std::uint8_t kNode = 1;
  PatchFault fault_;
  std::uint64_t joins_us_ = 0;
  std::mt19937 random_;
  std::array<Module, layout::kMaxModules> modules_;
  std::array<hardware::I2cLineModel, layout::kLines> lines_;
  hardware::FlashMemory flash_{std::size_t{8} * hardware::FlashMemory::kPageBytes};
  wire::Decimation decimation_ = wire::Decimation::k256;
  std::uint64_t now_us_ = 0;
  std::deque<wire::CanFrame> arrived_;
  std::unique_ptr<sim::VirtualController> controller_;
};

/// Counts of a campaign, for each kind of fault.
struct CampaignCounts {
  int patches = 0, healthy = 0, refused = 0, faulty = 0, missed = 0;
  std::vector<std::string> descriptions;
};

/// Runs `patches` patches of each kind with the seeds `first_seed` …
inline std::map<PatchFault, CampaignCounts> run_campaign(int patches, std::uint32_t first_seed,
                                                         const ChipChange& change = {}) {
  std::map<PatchFault, CampaignCounts> counts;
  std::uint32_t seed = first_seed;
  for (int kind = 0; kind < static_cast<int>(kPatchFaultNames.size()); ++kind) {
    CampaignCounts& c = counts[static_cast<PatchFault>(kind)];
    for (int k = 0; k < patches; ++k, ++seed) {
      const PatchResult r = CampaignPatch(seed, static_cast<PatchFault>(kind), change).run();
      ++c.patches;
      c.healthy += r.healthy;
      c.refused += r.refused;
      c.faulty += r.faulty;
      c.missed += r.missed;
      if (!r.description.empty()) c.descriptions.push_back("seed " + std::to_string(seed) + ", " + r.description);
    }
  }
  return counts;
}

}  // namespace triskin::test
