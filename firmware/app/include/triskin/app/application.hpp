// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "triskin/app/identifiers.hpp"
#include "triskin/app/journal.hpp"
#include "triskin/logic/diagnostics/fault_memory.hpp"
#include "triskin/logic/diagnostics/log_sender.hpp"
#include "triskin/logic/diagnostics/uds_server.hpp"
#include "triskin/logic/icub/icub_board.hpp"
#include "triskin/logic/icub/icub_triangles.hpp"
#include "triskin/logic/sampling/sampler.hpp"
#include "triskin/logic/storage/offset_store.hpp"
#include "triskin/logic/storage/table_store.hpp"
#include "triskin/logic/stream/full_stream.hpp"
#include "triskin/logic/stream/stream_queue.hpp"
#include "triskin/logic/switched/route.hpp"
#include "triskin/ports/ports.hpp"
#include "triskin/wire/iso_tp.hpp"
#include "triskin/wire/node_claim.hpp"
#include "triskin/wire/taxel_frames.hpp"

namespace triskin::fw {

/// The application of a patch controller, as the only class, knows all parts. step() performs the work that is due and
/// returns at once.
class Application final : private UdsHost, private PatchControl {
 public:
  /// Loads the newest table and starts to sample. Everything that `ports` points to must outlive the application.
  explicit Application(const Ports& ports);

  /// Handles frames, bus transfers and timers that are due.
  void step();
  /// Performs the work that must continue while the board waits for its flash inside a call of step(): transfers on the
  /// lines, readings, the stream. It neither reads nor writes the flash; faults are recorded with the readings
  /// afterwards. Switched modules wait, because a check of their chain is needed before a reading counts.
  void step_during_flash();
  /// Returns the earliest time at which step_during_flash() has work, not counting ends of transfers.
  [[nodiscard]] std::uint64_t next_during_flash_us() const;
  /// Returns the earliest time at which step() has work, not counting frames and line transfers, whose ends the board
  /// reports.
  [[nodiscard]] std::uint64_t next_event_us() const;
  /// The condition is for a light of the board; a faulty module has priority over everything else.
  enum class Condition : std::uint8_t { kNoTable, kSampling, kStreaming, kFault };
  [[nodiscard]] Condition condition() const;
  /// Returns true if frames wait for room in the CAN port; call step() again when there is some.
  [[nodiscard]] bool frames_wait() const;

 private:
  bool read_identifier(std::uint16_t did, ByteWriter& out) override { return identifiers_.read(did, out); }
  Status write_identifier(std::uint16_t did, Bytes value) override { return identifiers_.write(did, value); }
  Status start_routine(std::uint16_t routine, Bytes option, ByteWriter& out) override;
  Status routine_result(std::uint16_t routine, ByteWriter& out) override {
    return identifiers_.routine_result(routine, out);
  }
  Status protect_loader(Bytes option);
  Status set_node_address(std::uint8_t address) override;
  Status set_stream(wire::StreamMode mode) override;
  Status set_sampling(const wire::SamplingSetting& setting) override;
  Status set_calibration(Bytes value) override { return tables_.set_calibration(value); }
  Status set_log(wire::LogLevel level) override;
  [[nodiscard]] wire::LogLevel log_level() const override { return channel_of(asking_).log.level(); }
  [[nodiscard]] wire::StreamAccount stream_account() const override;
  [[nodiscard]] std::uint32_t dropped_samples() const override;
  Status clear_faults() override;
  void read_faults(std::uint8_t mask, ByteWriter& out) override { faults_.report(mask, out); }
  bool read_fault(std::uint32_t dtc, ByteWriter& out) override;
  void request_reset() override {
    journal_.restart();
    reset_requested_ = through_loader_ = true;
  }
  [[nodiscard]] std::uint64_t now_us() const override { return ports_.clock->now_us(); }

  /// A channel leads to a host: it has a port and the one connection of a tester over it.
  struct Channel {
    CanPort* port;
    wire::IsoTp link;
    std::optional<wire::CanFrame> held{};  // The link has produced this frame, but the port has not accepted it yet.
    std::array<wire::CanFrame, wire::kClaimFrames> claim{};
    std::size_t claim_at = wire::kClaimFrames;  // The claim continues with this frame.
    wire::IdFrames assignment{};
    FullStream stream{};
    LogSender log{};
    bool fd = false;  // The last request came in an FD frame.
  };
  static constexpr std::size_t kCan = 0;

  void restart();
  [[nodiscard]] PatchParts parts() const;
  /// Notes that the image has proved itself once: it has read a module, or a host has reached it and could replace it.
  void prove();
  void note_start();
  void step_log();
  [[nodiscard]] Channel& channel_of(const CanPort* port) { return channels_[port == channels_[kCan].port ? kCan : 1]; }
  [[nodiscard]] const Channel& channel_of(const CanPort* port) const {
    return channels_[port == channels_[kCan].port ? kCan : 1];
  }
  void reset_when_answered();
  void restart_sampling();
  void keep_route();
  void forget_samples(std::size_t first);
  void place_adopted();
  void invalidate_samples();
  [[nodiscard]] std::span<Channel> channels() { return std::span(channels_).first(ports_.usb != nullptr ? 2 : 1); }
  [[nodiscard]] std::span<const Channel> channels() const {
    return std::span(channels_).first(ports_.usb != nullptr ? 2 : 1);
  }
  void receive(Channel& channel);
  void handle_frame(Channel& channel, const wire::CanFrame& frame);
  void answer(Channel& channel, Bytes request, bool functional);
  void handle_icub_frame(const wire::CanFrame& frame);
  bool handle_claim_frame(Channel& channel, const wire::CanFrame& frame);
  void send_pending();
  static void send_pending(Channel& channel, std::uint64_t now_us);
  void take_samples();
  void publish(std::size_t module);
  void send_stream();
  void tick();
  void stream_full(TableRow row);
  [[nodiscard]] std::size_t rows() const { return tables_.has_table() ? tables_.table().module_count : 0; }
  /// Counts rows of the table and adopted modules.
  [[nodiscard]] std::size_t modules() const { return rows() + route_.adoption().count; }
  void queue_icub();
  void calibrate();
  void take_node_address(std::uint8_t address);

  const Ports ports_;
  TableStore tables_;
  UdsServer server_;
  FaultMemory faults_;
  OffsetStore offset_store_;
  bool offsets_wait_ = false;  // The store has more to write.
  OffsetBook offsets_{};
  std::array<Channel, 2> channels_;  // One channel is for CAN and one for USB.
  CanPort* asking_;                  // The request that is being answered came from this port.
  CanPort* stream_port_;             // The iCub stream was requested from this port.
  std::array<LineSampler, layout::kLines> lines_;
  std::array<ModuleReading, layout::kMaxModules> samples_{};
  std::array<ModuleReading, layout::kMaxModules> published_{};
  Route route_;
  std::uint8_t adopted_list_ = 0;  // The present samples refer to this Adoption::list.
  bool pausing_ = false;           ///< The lines finish their transfers and start none.
  Sampling sampling_;
  wire::TaxelOutput output_ = wire::TaxelOutput::kRaw;
  std::uint64_t next_tick_us_ = 0;
  std::uint32_t sample_count_ = 0;
  wire::StreamMode stream_ = wire::StreamMode::kOff;
  StreamQueue stream_queue_;  // The queue holds frames of the iCub stream.
  std::uint8_t starts_ = 0;   // Sampling has started this often since power-up, modulo 256.
  bool reset_requested_ = false, through_loader_ = false;
  bool read_a_module_ = false, proved_ = false, started_ = false;
  std::uint64_t reset_at_us_ = UINT64_MAX;
  IcubBoard icub_;
  IcubTriangles icub_triangles_;
  Log log_;
  SerialLog serial_log_;
  Identifiers identifiers_;  // The identifiers read and write all members above.
  Journal journal_;
};

}  // namespace triskin::fw
