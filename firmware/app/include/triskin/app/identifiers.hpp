// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "triskin/logic/diagnostics/fault_memory.hpp"
#include "triskin/logic/icub/icub_board.hpp"
#include "triskin/logic/sampling/sampler.hpp"
#include "triskin/logic/storage/offset_store.hpp"
#include "triskin/logic/storage/table_store.hpp"
#include "triskin/logic/switched/route.hpp"
#include "triskin/ports/ports.hpp"
#include "triskin/wire/health.hpp"
#include "triskin/wire/identity.hpp"
#include "triskin/wire/lines.hpp"
#include "triskin/wire/live_taxels.hpp"
#include "triskin/wire/log.hpp"
#include "triskin/wire/offsets.hpp"
#include "triskin/wire/settled_rest.hpp"
#include "triskin/wire/statistics.hpp"
#include "triskin/wire/stream_account.hpp"
#include "triskin/wire/table_state.hpp"
#include "triskin/wire/topology.hpp"

namespace triskin::fw {

/// The version is that of the project (CMakeLists.txt).
inline constexpr std::uint32_t kFirmwareVersion = TRISKIN_FIRMWARE_VERSION;

/// Identifiers read these parts, which must outlive them.
struct PatchParts {
  const Ports& ports;
  const TableStore& tables;
  const FaultMemory& faults;
  const Route& route;
  const std::array<LineSampler, layout::kLines>& lines;
  /// The latest samples may still be rejected by the next check of the chain.
  const std::array<ModuleReading, layout::kMaxModules>& samples;
  /// These samples were read before the last good check of the chain.
  const std::array<ModuleReading, layout::kMaxModules>& published;
  const OffsetBook& offsets;
  const wire::StreamMode& stream;
  const Sampling& sampling;
  const wire::TaxelOutput& output;
  const std::uint32_t& sequences;  ///< Nominal sequences are counted from power-up.
  const IcubBoard& icub;
};

/// Writing an identifier triggers these actions, and some facts only the application knows. Values are checked before.
class PatchControl {
 public:
  virtual ~PatchControl() = default;
  /// Sets the node address, which takes effect after the answer. Errors: kFlashFailed.
  virtual Status set_node_address(std::uint8_t address) = 0;
  /// Streams to the port that sent the request. Errors: kOutOfRange (the full stream on a classic bus; the iCub stream
  /// with a node address above 14).
  virtual Status set_stream(wire::StreamMode mode) = 0;
  /// Configures every converter again at once. Always kOk, because the decoder has refused invalid values.
  virtual Status set_sampling(const wire::SamplingSetting& setting) = 0;
  /// Stores a calibration with the table. Errors: those of TableStore::set_calibration.
  virtual Status set_calibration(Bytes value) = 0;
  /// Sends the log to the port of the request; kOff ends it.
  virtual Status set_log(wire::LogLevel level) = 0;
  /// Returns the log level of the port of the request.
  [[nodiscard]] virtual wire::LogLevel log_level() const = 0;
  /// Returns the account of the full stream over the port of the request.
  [[nodiscard]] virtual wire::StreamAccount stream_account() const = 0;
  /// Counts the samples and iCub frames on all ports that found no room since power-up.
  [[nodiscard]] virtual std::uint32_t dropped_samples() const = 0;
};

/// Each identifier of the controller has a row here with the functions that read and write it. The session (F186)
/// belongs to the diagnostic server.
class Identifiers {
 public:
  /// Everything that `parts` refers to, and `control`, must outlive the identifiers.
  Identifiers(const PatchParts& parts, PatchControl& control) : parts_(parts), control_(control) {}

  /// Appends the value. Returns false if there is no such identifier or no value (no table; not started from a slot).
  [[nodiscard]] bool read(std::uint16_t did, ByteWriter& out) const;
  /// Writes a value. Errors: kOutOfRange (no such identifier, or read-only), those of the value's decoder and of
  /// PatchControl.
  [[nodiscard]] Status write(std::uint16_t did, Bytes value) const;
  /// Appends the result of a routine. Error: kOutOfRange (no such routine, or one without a result).
  [[nodiscard]] Status routine_result(std::uint16_t routine, ByteWriter& out) const;

 private:
  struct Row;
  struct Table;

  [[nodiscard]] wire::SerialNumber serial_number() const { return {parts_.ports.unique_id}; }
  [[nodiscard]] static wire::FirmwareVersion firmware() { return {kFirmwareVersion}; }
  [[nodiscard]] wire::Hello hello() const;
  [[nodiscard]] wire::NodeAddress node_address() const { return {parts_.tables.node_address()}; }
  [[nodiscard]] wire::ActiveTable active_table() const;
  [[nodiscard]] std::optional<wire::ModuleStates> module_states() const;
  [[nodiscard]] wire::Statistics statistics() const;
  [[nodiscard]] wire::StreamSetting stream() const { return {parts_.stream}; }
  [[nodiscard]] wire::LineStates line_states() const;
  [[nodiscard]] wire::FoundTopology topology() const { return parts_.route.found(); }
  [[nodiscard]] wire::ActiveRoute route() const;
  [[nodiscard]] std::optional<wire::ImageState> image_state() const;
  [[nodiscard]] wire::SamplingSetting sampling() const;
  [[nodiscard]] wire::StreamAccount stream_account() const { return control_.stream_account(); }
  [[nodiscard]] const PlaceOffsets& offsets_of(std::size_t row) const;
  [[nodiscard]] wire::Offsets offsets() const;
  [[nodiscard]] wire::SettledRest settled_rest() const;
  [[nodiscard]] const wire::Adoption& adoption() const { return parts_.route.adoption(); }
  [[nodiscard]] wire::LiveTaxels live_taxels() const;
  [[nodiscard]] std::optional<wire::BoardHealth> health() const;
  [[nodiscard]] std::optional<wire::Crash> crash() const;
  [[nodiscard]] wire::LogSetting log() const;
  [[nodiscard]] wire::icub::State icub() const { return parts_.icub.state(parts_.tables.node_address()); }
  [[nodiscard]] wire::Discovery discovery() const;
  [[nodiscard]] wire::SelfTestResult self_test() const;

  [[nodiscard]] std::uint8_t rows() const {
    return parts_.tables.has_table() ? parts_.tables.table().module_count : std::uint8_t{0};
  }
  /// Returns a valid sample; with switched modules, it was read before the last good check of the chain.
  [[nodiscard]] const ModuleReading& shown(std::size_t row) const {
    return parts_.route.switched() ? parts_.published[row] : parts_.samples[row];
  }
  [[nodiscard]] wire::ModuleStates states() const;

  PatchParts parts_;
  PatchControl& control_;
};

}  // namespace triskin::fw
