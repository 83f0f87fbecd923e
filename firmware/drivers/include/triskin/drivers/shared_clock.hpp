// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>

#include "triskin/ports/ports.hpp"

namespace triskin::fw {

/// Handles four lines whose SCL pins are tied to one wire, as in installed iCub patches: one SCL, four SDA. Their
/// masters would drive the clock against each other, so only one transfer runs at a time; the others wait in the order
/// in which they were started. A chip on another line sees pulses of SCL while its SDA is high, which is no start
/// condition, so it does not answer.
///
/// `Line` is the line of the board, an I2cLine. Cost: a check of the waiting lines when a transfer ends. Not for use in
/// interrupts.
template <class Line>
class SharedClock {
 public:
  static constexpr std::size_t kLines = 4;
  /// `lines` must outlive it, and no other code may start transfers on them.
  explicit SharedClock(std::span<Line, kLines> lines) {
    for (std::size_t k = 0; k < kLines; ++k) gates_[k].tie(*this, lines[k]);
  }
  SharedClock(const SharedClock&) = delete;
  SharedClock& operator=(const SharedClock&) = delete;

  /// Returns the line for the application. Its times are those of the transfer itself, without the waiting time.
  [[nodiscard]] I2cLine& line(std::size_t k) { return gates_[k]; }

 private:
  class Gate final : public I2cLine {
   public:
    void tie(SharedClock& clock, Line& line) {
      clock_ = &clock;
      line_ = &line;
    }
    void start(std::uint8_t address, Bytes write, std::span<std::uint8_t> read) override {
      address_ = address;
      write_ = write;
      read_ = read;
      ticket_ = ++clock_->last_ticket_;
      clock_->start_next();
    }
    std::optional<Status> poll() override {
      if (clock_->active_ == this) clock_->look();
      return std::exchange(outcome_, std::nullopt);
    }
    [[nodiscard]] std::uint64_t started_us() const override { return line_->started_us(); }
    [[nodiscard]] std::uint64_t ended_us() const override { return line_->ended_us(); }
    // The pulses would disturb the transfer of another line, so that one ends first; its outcome is kept.
    Status recover() override {
      while (clock_->active_ != nullptr) clock_->look_without_next();
      const Status status = line_->recover();
      clock_->start_next();
      return status;
    }
    void begin() {
      ticket_ = 0;
      line_->start(address_, write_, read_);
    }
    /// Returns the number of a transfer that waits; 0 means that none does.
    [[nodiscard]] std::uint32_t ticket() const { return ticket_; }
    /// Returns true if the transfer is over and its outcome waits for poll().
    [[nodiscard]] bool ended() {
      const auto outcome = line_->poll();
      if (outcome) outcome_ = outcome;
      return outcome.has_value();
    }

   private:
    SharedClock* clock_ = nullptr;
    Line* line_ = nullptr;
    std::uint8_t address_ = 0;
    Bytes write_;
    std::span<std::uint8_t> read_;
    std::uint32_t ticket_ = 0;
    std::optional<Status> outcome_;
  };

  void look_without_next() {
    if (active_->ended()) active_ = nullptr;
  }
  void look() {
    look_without_next();
    start_next();
  }
  void start_next() {
    if (active_ != nullptr) return;
    for (Gate& gate : gates_) {
      const bool earlier = active_ == nullptr || gate.ticket() - active_->ticket() > UINT32_MAX / 2;
      if (gate.ticket() != 0 && earlier) active_ = &gate;
    }
    if (active_ != nullptr) active_->begin();
  }

  std::array<Gate, kLines> gates_;
  Gate* active_ = nullptr;
  std::uint32_t last_ticket_ = 0;
};

}  // namespace triskin::fw
