// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "triskin/core/bytes.hpp"
#include "triskin/logic/storage/table_store.hpp"
#include "triskin/wire/faults.hpp"
#include "triskin/wire/table_state.hpp"
#include "triskin/wire/uds.hpp"

namespace triskin::fw {

/// The server needs these functions from the rest of the application; app/ implements them.
class UdsHost {
 public:
  virtual ~UdsHost() = default;
  /// Writes the value of an identifier; returns false if it is unknown.
  virtual bool read_identifier(std::uint16_t did, ByteWriter& out) = 0;
  /// Writes an identifier. Returns kOk, or kOutOfRange for an unknown identifier or a bad value.
  virtual Status write_identifier(std::uint16_t did, Bytes value) = 0;
  /// Starts a routine and appends its immediate result to `out`. Returns kOk; kOutOfRange if there is no such routine;
  /// otherwise why it cannot start.
  virtual Status start_routine(std::uint16_t routine, Bytes option, ByteWriter& out) = 0;
  /// Writes the result of a routine. Returns kOk, or kOutOfRange if there is no such routine or it was not started.
  virtual Status routine_result(std::uint16_t routine, ByteWriter& out) = 0;
  /// Clears the fault memory. Returns kOk or kFlashFailed.
  virtual Status clear_faults() = 0;
  /// Writes the records of a wire::FaultList whose status has a bit of `mask`.
  virtual void read_faults(std::uint8_t mask, ByteWriter& out) = 0;
  /// Writes a DTC with its status and freeze data (wire::FreezeFrame); returns false if there is no such entry.
  virtual bool read_fault(std::uint32_t dtc, ByteWriter& out) = 0;
  /// Requests a reset, which must happen after the answer has been sent.
  virtual void request_reset() = 0;
  /// Returns the time of the port's clock in µs.
  [[nodiscard]] virtual std::uint64_t now_us() const = 0;
};

/// The UDS server (ISO 14229-1) works over any transport. It handles one request at a time and uses no heap. Sessions
/// time out after S3; writing needs the programming or extended session and security access. Functional requests are
/// answered only when positive.
class UdsServer {
 public:
  static constexpr std::size_t kMaxResponse = 512;
  /// Host and tables must outlive the server.
  UdsServer(UdsHost& host, TableStore& tables) : host_(host), tables_(tables) {}

  /// Answers a request; an empty answer means that nothing is sent.
  [[nodiscard]] Bytes handle(Bytes request, bool functional);
  /// Returns to the default session when the tester has gone.
  void tick();
  /// Returns true while a download or upload is running, during which the bus is reserved for it.
  [[nodiscard]] bool transferring() const { return transfer_ != Transfer::kNone; }
  /// Restores the state after power-up: default session, locked, no transfer.
  void restart();
  [[nodiscard]] wire::Session session() const { return session_; }

 private:
  using Out = ByteWriter;
  std::uint8_t dispatch(Bytes request, Out& out);
  std::uint8_t session_control(Bytes request, Out& out);
  std::uint8_t reset(Bytes request, Out& out);
  std::uint8_t read(Bytes request, Out& out);
  std::uint8_t write(Bytes request, Out& out);
  std::uint8_t security(Bytes request, Out& out);
  std::uint8_t routine(Bytes request, Out& out);
  std::uint8_t faults(Bytes request, Out& out);
  std::uint8_t clear(Bytes request, Out& out);
  std::uint8_t begin_transfer(Bytes request, bool download, Out& out);
  std::uint8_t transfer(Bytes request, Out& out);
  std::uint8_t transfer_exit(Bytes request, Out& out);
  std::uint8_t tester_present(Bytes request, Out& out);
  [[nodiscard]] std::uint8_t need_unlocked() const;
  void leave_session();

  enum class Transfer : std::uint8_t { kNone, kDownload, kUpload };
  UdsHost& host_;
  TableStore& tables_;
  std::array<std::uint8_t, kMaxResponse> response_{};
  wire::Session session_ = wire::Session::kDefault;
  std::uint64_t last_request_us_ = 0;
  bool unlocked_ = false, suppress_ = false;
  std::uint32_t seed_ = 0, seed_count_ = 0;
  int wrong_keys_ = 0;
  std::uint64_t locked_until_us_ = 0;  // Until then no seed is given.
  Transfer transfer_ = Transfer::kNone;
  std::uint8_t block_ = 0;
  std::size_t upload_at_ = 0;
  Bytes upload_;
};

}  // namespace triskin::fw
