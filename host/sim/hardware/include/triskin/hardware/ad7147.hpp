// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "triskin/layout/module.hpp"
#include "triskin/sim/table_controller.hpp"

namespace triskin::hardware {

/// The converter gives this many results per picofarad, because its range is ±8 pF.
inline constexpr double kCountsPerPf = 32768.0 / 8.0;

/// Capacitances at the pins of one converter as a function of time, so that they are computed only for samples that are
/// read.
class CapacitanceSource {
 public:
  virtual ~CapacitanceSource() = default;
  /// Returns the capacitance at pin `cin` (0..12) and virtual time `at_us`, in converter counts (8 pF / 32768) above
  /// the converter's reference. A larger capacitance, that is more pressure, gives a larger number.
  [[nodiscard]] virtual double counts(int cin, std::uint64_t at_us) const = 0;
  /// Returns true if the result of this pin is stuck, so that not even the converter's noise shows.
  [[nodiscard]] virtual bool is_stuck(int /*cin*/, std::uint64_t /*at_us*/) const { return false; }
};

/// What the data sheet leaves open, or the parts of a series differ in; the default is the ideal chip. The firmware
/// must work with any combination within the ranges of converters.hpp.
struct Ad7147Behaviour {
  /// A write to PWR_CONTROL restarts the sequence. False: only CONV_RESET does, and a write that changes PWR_CONTROL
  /// leaves the sequence at an arbitrary stage.
  bool power_control_restarts = false;
  /// A change of PWR_CONTROL in mid-sequence shifts the results by one stage until the next CONV_RESET.
  bool shifted_after_stop = false;
  /// All results change together at the end of the sequence. False: each changes at the end of its stage.
  bool latched_at_end = false;
  /// The status has only the stages that STAGE_COMPLETE_INT_ENABLE (0x007) enables.
  bool status_needs_enable = false;
  double step_counts = 0.32 * kCountsPerPf;  ///< a step of the positive input's offset DAC at its beginning
  double neg_step_ratio = 1.0;               ///< a step of the negative input's DAC as a share of it
  /// The last step of the DAC is larger than the first by this share.
  double step_bend = 0.0, neg_step_bend = 0.0;
  double step_unevenness = 0.0;  ///< each code of a DAC is off by up to ± this share of a step
  /// Counts of a capacitance as a share of the nominal ones, at both inputs and in every stage. The steps count as
  /// well.
  double gain = 1.0;
  double zero_counts = 0.0;         ///< what every result has too much
  double neg_extra_counts = 0.0;    ///< capacitance of the path from a pin to the negative input
  double path_spread_counts = 0.0;  ///< that of each pin differs by up to ± this
  double neg_gain_ratio = 1.0;      ///< the gain of the negative input as a share of the positive one's
  double stage_gain_spread = 0.0;   ///< the gain of each stage at each input differs by up to ± this share
  /// Integral non-linearity: so many counts too much at both ends of the range, none in the middle. An odd part is the
  /// same at both inputs with opposite signs, as a gain is.
  double curve_counts = 0.0;
  double stage_memory = 0.0;   ///< share of what the stage before was off mid scale that a result has too much
  double noise = 1.0;          ///< as a share of the data sheet's, if set_noise() switched it on
  double wander_counts = 0.0;  ///< amplitude of slow noise, for which a wave of 4 s stands
  double period_error = 0.0;   ///< the oscillator is slower by this share
  /// What the tracks of each I²C line have to a pad above them if no shield lies between: each of the samples of a
  /// result (three times the decimation) sees it with either sign while a line is busy.
  double bus_coupling_counts = 0.0;
  double first_error_counts = 0.0;  ///< results of the first sequence after a restart are off by up to ± this
  std::uint64_t serial = 0;         ///< what is drawn for each pin and code depends on it
};

/// The class models an AD7147 at register level (data sheet rev. E): 16-bit registers at 16-bit addresses, big endian,
/// address increment, 12 stages converted one after another. Not thread-safe. Modelled: power modes, stage count,
/// decimation, software reset, restart of the sequence by CONV_RESET, input connections, AFE offsets, stage-complete
/// status, device id, loss of the configuration in a power dip, outages. Not modelled: interrupts, environmental
/// calibration.
class Ad7147 {
 public:
  static constexpr std::uint64_t kNever = ~std::uint64_t{0};
  static constexpr int kStages = layout::kTaxelsPerModule;
  static constexpr std::uint16_t kDeviceId = 0x1472;  ///< The value is 0x1470 | revision (data sheet, table 20).

  /// `source` must outlive the chip. The chip is powered from time 0 on.
  explicit Ad7147(const CapacitanceSource& source, std::uint16_t device_id = kDeviceId)
      : source_(&source), device_id_(device_id) {}

  /// Makes the power fail for a moment at `at_us`, and again every `every_us` after that if it is not 0, before
  /// `until_us`. Afterwards all registers have their reset values.
  void schedule_power_dip(std::uint64_t at_us, std::uint64_t every_us, std::uint64_t until_us = kNever);
  /// Makes the chip silent from `at_us` until `until_us`, exclusive, when all registers have their reset values.
  void schedule_outage(std::uint64_t at_us, std::uint64_t until_us);
  /// Returns false during an outage: the chip does not acknowledge its address.
  [[nodiscard]] bool is_powered(std::uint64_t now_us) const;
  /// Makes the chip report the device id `device_id` from `at_us` until `until_us`, exclusive, as another chip would.
  void show_device_id(std::uint16_t device_id, std::uint64_t at_us, std::uint64_t until_us);

  /// Sets the error of the oscillator in ppm; positive means slow.
  void set_clock_error(int ppm) { behaviour_.period_error = ppm * 1e-6; }
  /// Adds the converter's own noise: 12, 7 or 3 counts peak to peak at decimation 64, 128, 256 (data sheet, table 1).
  /// Equal seeds give equal noise for equal numbers of conversions since the sequence was started.
  void set_noise(std::uint64_t seed) { noise_seed_ = seed; }
  /// Makes it another chip of the series. Call it before the chip is used.
  void set_behaviour(const Ad7147Behaviour& behaviour);
  [[nodiscard]] const Ad7147Behaviour& behaviour() const { return behaviour_; }

  // The following functions are what an I²C target sees between start and stop. `now_us` is virtual time and never
  // decreases.

  /// Handles a start condition with the chip's address; `read` is the direction bit.
  void select(bool read, std::uint64_t now_us);
  /// Handles a byte from the controller: two bytes of register address, then data, high byte first.
  void write_byte(std::uint8_t byte, std::uint64_t now_us);
  /// Returns the next byte for the controller; the register address advances after each low byte.
  [[nodiscard]] std::uint8_t read_byte(std::uint64_t now_us);

  /// Returns the register at `address`, or 0 for addresses that the chip lacks. Reading the stage-complete status
  /// clears it; other reads change nothing.
  [[nodiscard]] std::uint16_t read_register(std::uint16_t address, std::uint64_t now_us);
  /// Writes a register; writes to read-only and missing ones are ignored.
  void write_register(std::uint16_t address, std::uint16_t value, std::uint64_t now_us);

  /// Returns what a reading of the results would give, without a transfer and without an effect on the chip. Empty if
  /// the chip is silent, is about to lose its configuration, or converts fewer than 12 stages.
  [[nodiscard]] std::optional<sim::ChipReading> look(std::uint64_t now_us) const;

  /// Returns the time of one pass over the enabled stages: 9.2, 18.4 or 36.9 ms for 12 of them.
  [[nodiscard]] std::uint64_t sequence_us() const;

 private:
  using Dac = std::array<double, 64>;
  static Dac ideal_dac();
  static constexpr std::size_t kSetupRegisters = 8;   // These registers are 0x000 … 0x007.
  static constexpr std::size_t kStageRegisters = 96;  // These registers are 0x080 … 0x0DF.

  struct PowerDips {
    std::uint64_t next_us, every_us, until_us;
  };
  struct Outage {
    std::uint64_t at_us, until_us;
  };
  struct ShownId {
    std::uint16_t device_id;
    std::uint64_t at_us, until_us;
  };

  [[nodiscard]] std::uint16_t device_id(std::uint64_t now_us) const;
  void reset(std::uint64_t now_us);
  void apply_power_dips(std::uint64_t now_us);
  void write_power_control(std::uint16_t value, std::uint64_t now_us);
  void restart_sequence(std::uint64_t now_us);
  void latch_results(std::uint64_t now_us);
  [[nodiscard]] std::uint64_t stage_ns() const;
  [[nodiscard]] std::uint64_t period_ns() const;
  [[nodiscard]] int stages_on() const;
  [[nodiscard]] bool converting() const;
  struct Conversion {
    /// The conversion ended at this time; kNever means that there was none since the restart.
    std::uint64_t at_us = kNever;
    std::uint64_t number = 0;  ///< Conversions are numbered from the restart.
  };
  /// Returns the latest conversion of `stage` up to now.
  [[nodiscard]] Conversion last_conversion(int stage, std::uint64_t now_us) const;
  /// Returns the conversion whose result the registers show.
  [[nodiscard]] Conversion shown_conversion(int stage, std::uint64_t now_us) const;
  [[nodiscard]] double spread(std::uint64_t of) const;
  [[nodiscard]] double path_counts(int pin, bool negative) const;
  [[nodiscard]] double gain(int stage, bool negative) const;
  struct Charge {
    double counts = 0.0;  ///< of both inputs, off mid scale
    bool connected = false, stuck = false;
  };
  [[nodiscard]] Charge charge(int stage, std::uint64_t at_us) const;
  [[nodiscard]] double wander(int stage, std::uint64_t at_us) const;
  [[nodiscard]] std::uint16_t convert(int stage, const Conversion& conversion) const;
  [[nodiscard]] double noise(int stage, std::uint64_t number) const;
  [[nodiscard]] double bus_noise(int stage, std::uint64_t number) const;
  [[nodiscard]] std::uint16_t result(int place, std::uint64_t now_us) const;
  [[nodiscard]] std::uint16_t complete_status(std::uint64_t now_us);

  const CapacitanceSource* source_;
  std::uint16_t device_id_;
  std::array<std::uint16_t, kSetupRegisters> setup_{};
  std::array<std::uint16_t, kStageRegisters> stage_{};
  // These results are from before the last restart or change of a setup.
  std::array<std::uint16_t, kStages> latched_{};
  std::array<std::uint64_t, kStages> changed_us_{};  // The setup of each stage last changed at this time.
  bool shifted_ = false;
  Ad7147Behaviour behaviour_;
  Dac positive_dac_ = ideal_dac(), negative_dac_ = ideal_dac();  // counts of each code
  std::uint64_t noise_seed_ = 0;                                 // Zero disables the noise.
  std::uint64_t restart_us_ = 0;
  std::uint64_t status_read_us_ = 0;
  std::vector<PowerDips> dips_;
  std::vector<Outage> outages_;
  std::vector<ShownId> shown_ids_;
  // Two address bytes precede pairs of data bytes on the bus.
  std::uint16_t pointer_ = 0;
  int address_bytes_ = 0;
  bool high_byte_next_ = true;
  std::uint8_t half_ = 0;
  std::uint16_t outgoing_ = 0;
};

}  // namespace triskin::hardware
