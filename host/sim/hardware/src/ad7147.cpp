// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/hardware/ad7147.hpp"

#include <algorithm>
#include <cmath>

namespace triskin::hardware {
namespace {

// Register names and fields are those of the AD7147 data sheet rev. E, tables 20 to 24 and 48 to 52.
constexpr std::uint16_t kPwrControl = 0x000;
constexpr std::uint16_t kAmbCompControl0 = 0x002;
constexpr std::uint16_t kConvReset = 0x8000;  // The chip clears this bit itself once the sequence has restarted.
constexpr std::uint16_t kStageCompleteEnable = 0x007;
constexpr std::uint16_t kStageCompleteStatus = 0x00A;
constexpr std::uint16_t kResults = 0x00B;
constexpr std::uint16_t kDeviceIdRegister = 0x017;
constexpr std::uint16_t kStageSetup = 0x080;
constexpr int kRegistersPerStage = 8;
constexpr int kPins = 13;
constexpr int kPinsInLowRegister = 7;

constexpr int kMidScale = 0x8000;

// What is drawn for a chip comes from streams that do not meet.
constexpr std::uint64_t kPositiveDacStream = 0x100, kNegativeDacStream = 0x200, kPathStream = 0x300,
                        kWanderStream = 0x400, kGainStream = 0x500, kFirstStream = 0x1000;

// The times are for 12 stages, indexed by the value of the decimation field.
constexpr std::uint64_t kSequenceUs[] = {36'900, 18'400, 9'200, 9'200};
constexpr std::uint64_t kLowPowerDelayUs[] = {200'000, 400'000, 600'000, 800'000};

int power_mode(std::uint16_t pwr) {
  return pwr & 3;
}

// Returns the connection field of a pin: 0 open, 1 negative input, 2 positive input, 3 bias.
int connection(const std::uint16_t* stage, int pin) {
  const bool low = pin < kPinsInLowRegister;
  return (stage[low ? 0 : 1] >> (2 * (low ? pin : pin - kPinsInLowRegister))) & 3;
}

constexpr std::uint64_t kGolden = 0x9E3779B97F4A7C15;

// The finalizer of SplitMix64 (Steele, Lea, Flood 2014).
std::uint64_t hashed(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EB;
  return x ^ (x >> 31);
}

// The sum of four uniform numbers is close enough to a normal distribution of deviation 1.
double near_normal(std::uint64_t seed) {
  const std::uint64_t x = hashed(seed);
  double sum = 0.0;
  for (int k = 0; k < 4; ++k) sum += static_cast<double>(x >> (16 * k) & 0xFFFF) / 65536.0 - 0.5;
  return sum * std::sqrt(3.0);
}

}  // namespace

// Returns −1 … 1, another number for each pin, code or result of each chip.
double Ad7147::spread(std::uint64_t of) const {
  return static_cast<double>(hashed(behaviour_.serial + of * kGolden) >> 11) * 0x1p-52 - 1.0;
}

Ad7147::Dac Ad7147::ideal_dac() {
  Dac dac{};
  for (std::size_t code = 0; code < dac.size(); ++code)
    dac[code] = static_cast<double>(code) * Ad7147Behaviour{}.step_counts;
  return dac;
}

void Ad7147::set_behaviour(const Ad7147Behaviour& behaviour) {
  behaviour_ = behaviour;
  const auto fill = [&](Dac& dac, double step, double bend, std::uint64_t stream) {
    constexpr double kLast = 63.0;
    for (std::size_t code = 1; code < dac.size(); ++code) {
      const auto x = static_cast<double>(code);
      const double uneven = behaviour_.step_unevenness * spread(stream + code);
      dac[code] = step * (x + bend * x * x / (2.0 * kLast) + uneven);
    }
  };
  fill(positive_dac_, behaviour_.step_counts, behaviour_.step_bend, kPositiveDacStream);
  fill(negative_dac_, behaviour_.step_counts * behaviour_.neg_step_ratio, behaviour_.neg_step_bend, kNegativeDacStream);
}

void Ad7147::schedule_power_dip(std::uint64_t at_us, std::uint64_t every_us, std::uint64_t until_us) {
  if (at_us < until_us) dips_.push_back({at_us, every_us, until_us});
}

void Ad7147::schedule_outage(std::uint64_t at_us, std::uint64_t until_us) {
  outages_.push_back({at_us, until_us});
  if (until_us != kNever) schedule_power_dip(until_us, 0);
}

bool Ad7147::is_powered(std::uint64_t now_us) const {
  return std::ranges::none_of(outages_, [&](const Outage& o) { return now_us >= o.at_us && now_us < o.until_us; });
}

void Ad7147::show_device_id(std::uint16_t device_id, std::uint64_t at_us, std::uint64_t until_us) {
  shown_ids_.push_back({device_id, at_us, until_us});
}

std::uint16_t Ad7147::device_id(std::uint64_t now_us) const {
  const auto shown =
      std::ranges::find_if(shown_ids_, [&](const ShownId& id) { return now_us >= id.at_us && now_us < id.until_us; });
  return shown == shown_ids_.end() ? device_id_ : shown->device_id;
}

void Ad7147::reset(std::uint64_t now_us) {
  setup_.fill(0);
  stage_.fill(0);
  latched_.fill(0);
  changed_us_.fill(now_us);
  shifted_ = false;
  restart_us_ = status_read_us_ = now_us;
}

void Ad7147::apply_power_dips(std::uint64_t now_us) {
  for (PowerDips& d : dips_) {
    if (now_us < d.next_us) continue;
    std::uint64_t last_us = d.next_us;
    if (d.every_us != 0) last_us += (std::min(now_us, d.until_us - 1) - d.next_us) / d.every_us * d.every_us;
    reset(last_us);
    d.next_us = d.every_us != 0 ? last_us + d.every_us : kNever;
    if (d.next_us >= d.until_us) d.next_us = kNever;
  }
}

void Ad7147::select(bool read, std::uint64_t now_us) {
  apply_power_dips(now_us);
  high_byte_next_ = true;
  if (!read) address_bytes_ = 0;
}

void Ad7147::write_byte(std::uint8_t byte, std::uint64_t now_us) {
  if (address_bytes_ < 2) {
    pointer_ = static_cast<std::uint16_t>((address_bytes_ == 0 ? 0 : pointer_ << 8) | byte);
    ++address_bytes_;
    return;
  }
  if (high_byte_next_) {
    half_ = byte;
  } else {
    write_register(pointer_++, static_cast<std::uint16_t>((half_ << 8) | byte), now_us);
  }
  high_byte_next_ = !high_byte_next_;
}

std::uint8_t Ad7147::read_byte(std::uint64_t now_us) {
  if (high_byte_next_) outgoing_ = read_register(pointer_++, now_us);
  const int byte = high_byte_next_ ? outgoing_ >> 8 : outgoing_ & 0xFF;
  high_byte_next_ = !high_byte_next_;
  return static_cast<std::uint8_t>(byte);
}

std::uint16_t Ad7147::read_register(std::uint16_t address, std::uint64_t now_us) {
  apply_power_dips(now_us);
  if (address < kSetupRegisters) return setup_[address];
  if (address == kStageCompleteStatus) return complete_status(now_us);
  if (address >= kResults && address < kResults + kStages) return result(address - kResults, now_us);
  if (address == kDeviceIdRegister) return device_id(now_us);
  if (address >= kStageSetup && address < kStageSetup + kStageRegisters) return stage_[address - kStageSetup];
  return 0;
}

void Ad7147::write_register(std::uint16_t address, std::uint16_t value, std::uint64_t now_us) {
  apply_power_dips(now_us);
  if (address == kPwrControl) return write_power_control(value, now_us);
  if (address == kAmbCompControl0 && (value & kConvReset) != 0) {
    restart_sequence(now_us);
    value = static_cast<std::uint16_t>(value & ~kConvReset);
  }
  if (address < kSetupRegisters) setup_[address] = value;
  if (address < kStageSetup || address >= kStageSetup + kStageRegisters) return;
  const auto at = static_cast<std::size_t>(address - kStageSetup);
  if (stage_[at] == value) return;
  latch_results(now_us);
  changed_us_[at / std::size_t{kRegistersPerStage}] = now_us;
  stage_[at] = value;
}

void Ad7147::write_power_control(std::uint16_t value, std::uint64_t now_us) {
  constexpr std::uint16_t kSoftwareReset = 1U << 10;
  if ((value & kSoftwareReset) != 0) return reset(now_us);
  const bool changed = value != setup_[kPwrControl];
  if (changed) {
    latch_results(now_us);
    changed_us_.fill(now_us);
  }
  setup_[kPwrControl] = value;
  if (behaviour_.power_control_restarts) return restart_sequence(now_us);
  if (!changed) return;
  shifted_ = behaviour_.shifted_after_stop;
  // The sequencer continues at an unknown stage; the golden ratio spreads the phases.
  const std::uint64_t phase_us = now_us * 0x9E3779B97F4A7C15ULL % (period_ns() / 1000);
  restart_us_ = now_us - std::min(now_us, phase_us);
}

void Ad7147::restart_sequence(std::uint64_t now_us) {
  latch_results(now_us);
  shifted_ = false;
  restart_us_ = now_us;
}

// The registers keep their results until a stage ends again.
void Ad7147::latch_results(std::uint64_t now_us) {
  std::array<std::uint16_t, kStages> shown{};
  for (int s = 0; s < kStages; ++s) shown[static_cast<std::size_t>(s)] = result(s, now_us);
  latched_ = shown;
}

int Ad7147::stages_on() const {
  return std::min(kStages, ((setup_[kPwrControl] >> 4) & 0xF) + 1);
}

bool Ad7147::converting() const {
  return (power_mode(setup_[kPwrControl]) & 1) == 0;
}

std::uint64_t Ad7147::stage_ns() const {
  const auto nominal_ns = static_cast<double>(kSequenceUs[(setup_[kPwrControl] >> 8) & 3] * 1000);
  return static_cast<std::uint64_t>(std::llround(nominal_ns * (1.0 + behaviour_.period_error))) / kStages;
}

std::uint64_t Ad7147::sequence_us() const {
  return (stage_ns() * static_cast<std::uint64_t>(stages_on()) + 500) / 1000;
}

std::uint64_t Ad7147::period_ns() const {
  const bool low_power = power_mode(setup_[kPwrControl]) == 2;
  const std::uint64_t delay_us = low_power ? kLowPowerDelayUs[(setup_[kPwrControl] >> 2) & 3] : 0;
  return stage_ns() * static_cast<std::uint64_t>(stages_on()) + delay_us * 1000;
}

Ad7147::Conversion Ad7147::last_conversion(int stage, std::uint64_t now_us) const {
  if (!converting() || stage >= stages_on() || now_us < restart_us_) return {};
  const std::uint64_t since_ns = (now_us - restart_us_) * 1000,
                      first_ns = stage_ns() * static_cast<std::uint64_t>(stage + 1);
  if (since_ns < first_ns) return {};
  const std::uint64_t number = (since_ns - first_ns) / period_ns();
  return {restart_us_ + (first_ns + number * period_ns()) / 1000, number};
}

std::optional<sim::ChipReading> Ad7147::look(std::uint64_t now_us) const {
  const bool loses_power = std::ranges::any_of(dips_, [&](const PowerDips& d) { return now_us >= d.next_us; });
  const bool full_power = power_mode(setup_[kPwrControl]) == 0;
  const bool is_shown =
      std::ranges::any_of(shown_ids_, [&](const ShownId& id) { return now_us >= id.at_us && now_us < id.until_us; });
  if (!is_powered(now_us) || loses_power || is_shown || !full_power || stages_on() != kStages) return std::nullopt;
  sim::ChipReading reading;
  for (int s = 0; s < kStages; ++s) reading.results[static_cast<std::size_t>(s)] = result(s, now_us);
  reading.sequence_ns = period_ns();
  return reading;
}

// Peak to peak is taken as 6.6 standard deviations.
double Ad7147::noise(int stage, std::uint64_t number) const {
  if (noise_seed_ == 0) return 0.0;
  constexpr double kPeakToPeak[] = {3.0, 7.0, 12.0, 12.0};
  const double normal = near_normal(noise_seed_ ^ (number * 16 + static_cast<std::uint64_t>(stage)));
  return behaviour_.noise * normal * kPeakToPeak[(setup_[kPwrControl] >> 8) & 3] / 6.6;
}

// A line that reads its chips once a sequence of 9.2 ms is busy for 30 % of the time (docs/measurements/firmware.md).
// The samples of a result: three times the decimation, as the AD7142's data sheet says.
double Ad7147::bus_noise(int stage, std::uint64_t number) const {
  constexpr double kLines = 4.0, kBusy = 0.3;
  constexpr double kSamples[] = {3 * 256.0, 3 * 128.0, 3 * 64.0, 3 * 64.0};
  constexpr std::uint64_t kStream = 0xB05;
  const double deviation = std::sqrt(kLines * kBusy / kSamples[(setup_[kPwrControl] >> 8) & 3]);
  const std::uint64_t at = (restart_us_ * 4096 + number) * 16 + static_cast<std::uint64_t>(stage);
  return behaviour_.bus_coupling_counts * deviation * near_normal((behaviour_.serial + kStream) * kGolden ^ at);
}

double Ad7147::path_counts(int pin, bool negative) const {
  double counts = negative ? behaviour_.neg_extra_counts : 0.0;
  if (behaviour_.path_spread_counts != 0.0)
    counts += behaviour_.path_spread_counts * spread(kPathStream + static_cast<unsigned>(pin) * 2 + (negative ? 1 : 0));
  return counts;
}

double Ad7147::gain(int stage, bool negative) const {
  const double input = behaviour_.gain * (negative ? behaviour_.neg_gain_ratio : 1.0);
  if (behaviour_.stage_gain_spread == 0.0) return input;
  const double deviation = spread(kGainStream + static_cast<unsigned>(stage) * 2 + (negative ? 1 : 0));
  return input * (1.0 + behaviour_.stage_gain_spread * deviation);
}

// A triangle of 4 s between −1 and 1, for each stage at another moment.
double Ad7147::wander(int stage, std::uint64_t at_us) const {
  constexpr double kPeriod_us = 4e6;
  const double phase = static_cast<double>(at_us) / kPeriod_us + spread(kWanderStream + static_cast<unsigned>(stage));
  return behaviour_.wander_counts * (4.0 * std::abs(phase - std::floor(phase) - 0.5) - 1.0);
}

Ad7147::Charge Ad7147::charge(int stage, std::uint64_t at_us) const {
  const std::uint16_t* setup = &stage_[static_cast<std::size_t>(stage * kRegistersPerStage)];
  // Each input has a six-bit offset and its swap bit (bit 7 of the field), which adds it.
  const std::uint16_t afe = setup[2];
  double positive = positive_dac_[(afe >> 8) & 0x3F] * ((afe & 0x8000) != 0 ? 1.0 : -1.0);
  double negative = negative_dac_[afe & 0x3F] * ((afe & 0x80) != 0 ? 1.0 : -1.0);
  Charge charge;
  for (int pin = 0; pin < kPins; ++pin) {
    const int to = connection(setup, pin);
    if (to != 1 && to != 2) continue;
    charge.connected = true;
    charge.stuck = charge.stuck || source_->is_stuck(pin, at_us);
    (to == 1 ? negative : positive) += source_->counts(pin, at_us) + path_counts(pin, to == 1);
  }
  charge.counts = gain(stage, false) * positive - gain(stage, true) * negative;
  return charge;
}

std::uint16_t Ad7147::convert(int stage, const Conversion& conversion) const {
  const auto [own_counts, connected, stuck] = charge(stage, conversion.at_us);
  if (!connected) return kMidScale;
  double counts = own_counts;
  if (behaviour_.stage_memory != 0.0 && !stuck)
    counts += behaviour_.stage_memory *
              std::clamp(charge((stage + kStages - 1) % kStages, conversion.at_us).counts, -32768.0, 32767.0);
  const double of_range = std::clamp(counts / kMidScale, -1.0, 1.0);
  double value = kMidScale + behaviour_.zero_counts + counts + behaviour_.curve_counts * of_range * of_range;
  if (!stuck) value += noise(stage, conversion.number);
  if (behaviour_.bus_coupling_counts != 0.0 && !stuck) value += bus_noise(stage, conversion.number);
  if (behaviour_.wander_counts != 0.0 && !stuck) value += wander(stage, conversion.at_us);
  if (behaviour_.first_error_counts != 0.0 && conversion.number == 0 && !stuck)
    value +=
        behaviour_.first_error_counts * spread(kFirstStream + restart_us_ * kStages + static_cast<unsigned>(stage));
  return static_cast<std::uint16_t>(std::clamp(std::lround(value), 0L, 0xFFFFL));
}

Ad7147::Conversion Ad7147::shown_conversion(int stage, std::uint64_t now_us) const {
  Conversion last = last_conversion(stage, now_us);
  if (!behaviour_.latched_at_end || last.at_us == kNever) return last;
  const Conversion end = last_conversion(stages_on() - 1, now_us);
  if (end.at_us == kNever) return {};
  if (end.number == last.number) return last;
  return {restart_us_ + (stage_ns() * static_cast<std::uint64_t>(stage + 1) + end.number * period_ns()) / 1000,
          end.number};
}

std::uint16_t Ad7147::result(int place, std::uint64_t now_us) const {
  const int stage = shifted_ ? (place + kStages - 1) % kStages : place;
  const Conversion shown = shown_conversion(stage, now_us);
  // A conversion that ended before the setup changed has already left its result.
  const bool stale = shown.at_us == kNever || shown.at_us <= changed_us_[static_cast<std::size_t>(stage)];
  return stale ? latched_[static_cast<std::size_t>(place)] : convert(stage, shown);
}

std::uint16_t Ad7147::complete_status(std::uint64_t now_us) {
  int status = 0;
  for (int s = 0; s < kStages; ++s) {
    const Conversion last = last_conversion(s, now_us);
    if (last.at_us != kNever && last.at_us > status_read_us_) status |= 1 << s;
  }
  status_read_us_ = now_us;
  if (behaviour_.status_needs_enable) status &= setup_[kStageCompleteEnable];
  return static_cast<std::uint16_t>(status);
}

}  // namespace triskin::hardware
