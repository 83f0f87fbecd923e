// SPDX-License-Identifier: Apache-2.0
#include "triskin/sim/table_controller.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "triskin/logic/sampling/frozen_taxels.hpp"
#include "triskin/logic/sampling/module_reading.hpp"
#include "triskin/logic/storage/table_store.hpp"
#include "triskin/logic/stream/full_stream.hpp"
#include "triskin/wire/iso_tp.hpp"
#include "triskin/wire/node_claim.hpp"
#include "triskin/wire/uds.hpp"

namespace triskin::sim {
namespace {

// The table is only read.
class ReadOnlyFlash final : public fw::FlashArea {
 public:
  explicit ReadOnlyFlash(const FlashModel& model) : model_(model) {}
  [[nodiscard]] std::size_t size_bytes() const override { return model_.size_bytes(); }
  [[nodiscard]] std::size_t page_bytes() const override { return model_.page_bytes(); }
  [[nodiscard]] std::size_t program_bytes() const override { return model_.program_bytes(); }
  bool erase_page(std::size_t) override { return false; }
  bool program(std::size_t, Bytes) override { return false; }
  [[nodiscard]] Bytes bytes() const override { return Bytes(model_.bytes()); }

 private:
  const FlashModel& model_;
};

// A row of the table with the schedule of its samples.
struct Row {
  std::uint8_t line = 0, address = 0;
  wire::TaxelFrame last{};
  std::uint64_t sequence_ns = 0;
  std::uint64_t delay_us = 0;  // A sample is published so long after the end of its sequence.
  int steady = 0;              // So many samples followed one another as the schedule says.
  std::uint32_t sent = 0;
  fw::FrozenTaxels frozen{};
  // The schedule counts from here.
  std::uint64_t base_us = 0;
  std::uint32_t base_number = 0, next_number = 0;
  [[nodiscard]] std::uint64_t end_us(std::uint32_t number) const {
    return base_us + (number - base_number) * sequence_ns / 1000;
  }
  [[nodiscard]] std::uint64_t publish_us() const { return end_us(next_number) + delay_us; }
};

class TableController final : public VirtualController {
 public:
  TableController(const VirtualBoard& board, LookAtChip look)
      : board_(board), look_(std::move(look)), flash_(*board.flash), tables_(flash_) {
    VirtualBoard inner = board;
    inner.send = [this](const wire::CanFrame& frame) { take_from_firmware(frame); };
    inner.room = [this] { return catching_up_ || has_room(); };
    firmware_ = make_virtual_controller(inner);
  }

  void receive(const wire::CanFrame& frame) override {
    if (by_table_) {
      missed_.emplace_back(now_us_, frame);
      if (!handle(frame)) wake();
      return;
    }
    note(frame);
    firmware_->receive(frame);
  }
  [[nodiscard]] wire::UsbFunction& usb() override {
    if (by_table_) wake();
    return firmware_->usb();
  }
  [[nodiscard]] int usb_session() const override { return firmware_->usb_session(); }

  void run_until(std::uint64_t now_us) override {
    while (by_table_ && next_step_us() <= now_us) {
      now_us_ = std::max(now_us_, next_step_us());
      step();
    }
    now_us_ = std::max(now_us_, now_us);
    if (by_table_) return;
    firmware_->run_until(now_us_);
    if (sent_a_sample_ && may_hand_over()) hand_over();
    sent_a_sample_ = false;
  }
  [[nodiscard]] std::uint64_t next_event_us() const override {
    return by_table_ ? next_step_us() : firmware_->next_event_us();
  }

 private:
  static constexpr int kSteady = 8;
  static constexpr std::uint64_t kQuiet_us = 100'000;

  [[nodiscard]] bool has_room() const { return !board_.room || board_.room(); }

  // The following functions observe the firmware. While it catches up, only samples that the table has not sent are
  // new.
  void take_from_firmware(const wire::CanFrame& frame) {
    const auto sample = wire::decode_full(frame);
    if (sample && sample->starts != starts_) read_table(sample->starts);
    if (!sample || sample->module >= rows_.size()) {
      if (!catching_up_) board_.send(frame);
      return;
    }
    observe(*sample);
    if (sample->sample >= rows_[sample->module].next_number) board_.send(frame);
  }
  // Sampling restarts with another table, and numbers begin at 1 again.
  void read_table(std::uint8_t starts) {
    starts_ = starts;
    rows_.clear();
    tables_.load();
    if (!tables_.has_table()) return;
    for (const layout::ModuleRow& m : tables_.table().rows()) rows_.push_back(Row{m.line, m.address});
  }

  void observe(const wire::TaxelFrame& sample) {
    sent_a_sample_ = true;
    Row& row = rows_[sample.module];
    ++row.sent;
    const wire::TaxelFrame before = std::exchange(row.last, sample);
    (void)row.frozen.add(sample.value);
    const bool follows = sample.sample > before.sample && sample.state == wire::ModuleState::kOk &&
                         sample.dropped == 0 && sample.unread == 0;
    const std::uint64_t delay_us = now_us_ - std::min(now_us_, sample.device_time_us);
    row.delay_us = row.steady == 0 ? delay_us : std::min(row.delay_us, delay_us);
    row.steady = follows ? row.steady + 1 : 0;
  }

  void note(const wire::CanFrame& frame) {
    const auto lease = wire::decode_lease(frame);
    if (!lease) {
      if (!is_for_others(frame)) quiet_from_us_ = now_us_ + kQuiet_us;
      return;
    }
    const auto mine = std::ranges::find(leases_, lease->reader, [](const auto& l) { return l.second.reader; });
    if (mine == leases_.end())
      leases_.emplace_back(now_us_, *lease);
    else
      *mine = {now_us_, *lease};
  }

  // Requests to other controllers and their answers pass on the same bus.
  [[nodiscard]] bool is_for_others(const wire::CanFrame& frame) const {
    if (wire::is_claim(frame)) return true;
    const bool physical = frame.extended && (frame.id & 0xFFFF0000U) == wire::kPhysicalBase;
    return physical && (frame.id >> 8 & 0xFF) != tables_.node_address();
  }

  // The table takes over when it would have sent the latest sample of each row as the firmware did.
  [[nodiscard]] bool may_hand_over() {
    if (board_.chain != nullptr || now_us_ < quiet_from_us_ || !has_room()) return false;
    if (rows_.empty() || std::ranges::any_of(rows_, [](const Row& r) { return r.steady < kSteady; })) return false;
    return std::ranges::all_of(rows_, [this](Row& r) { return is_predicted(r); });
  }
  [[nodiscard]] bool is_predicted(Row& row) const {
    const auto reading = look(row, row.last.device_time_us + row.delay_us);
    if (!reading) return false;
    row.sequence_ns = reading->sequence_ns;
    return reading->results == row.last.value;
  }
  [[nodiscard]] std::optional<ChipReading> look(const Row& row, std::uint64_t at_us) const {
    auto reading = look_(row.line, layout::cdc_address(row.address), at_us);
    if (reading && tables_.table().positive_input) {
      for (std::uint16_t& r : reading->results) r = static_cast<std::uint16_t>(~r);
    }
    return reading;
  }

  void hand_over() {
    stream_ = fw::FullStream{};
    stream_.restart(starts_);
    for (Row& r : rows_) {
      r.base_us = r.last.device_time_us;
      r.base_number = r.last.sample;
      r.next_number = r.base_number + 1;
      stream_.add(r.last, rows_.size(), false);  // Without a lease, the stream only notes the number.
    }
    for (const auto& [at_us, lease] : leases_) stream_.renew(lease, at_us);
    stream_.tick(now_us_);
    const std::uint8_t node = rows_.front().last.node_address;
    link_ = wire::IsoTp(wire::physical_id(wire::kTesterAddress, node), wire::physical_id(node, wire::kTesterAddress),
                        board_.can_fd ? 64 : 8);
    held_.reset();
    missed_.clear();
    by_table_ = true;
  }

  // The following functions run by the table.
  [[nodiscard]] std::uint64_t next_step_us() const {
    if (has_room() && (held_ || stream_.due(now_us_))) return now_us_;
    std::uint64_t next = held_ ? UINT64_MAX : link_.next_event_us();
    if (stream_.next_event_us() > now_us_) next = std::min(next, stream_.next_event_us());
    for (const Row& r : rows_) next = std::min(next, r.publish_us());
    return next;
  }
  void step() {
    (void)link_.tick(now_us_);
    stream_.tick(now_us_);
    for (std::size_t k = 0; k < rows_.size() && by_table_; ++k) {
      if (rows_[k].publish_us() <= now_us_) publish(k);
    }
    if (by_table_) send_pending();
  }
  void publish(std::size_t k) {
    Row& row = rows_[k];
    const auto reading = look(row, now_us_);
    if (!reading || reading->sequence_ns != row.sequence_ns) return wake();
    fw::ModuleReading sample;
    sample.store(reading->results, row.frozen.add(reading->results));
    row.last.sample = row.next_number;
    row.last.device_time_us = row.end_us(row.next_number);
    row.last.valid = sample.valid;
    row.last.state = sample.state;
    row.last.value = sample.raw;
    ++row.next_number;
    stream_.add(row.last, rows_.size(), false);
  }
  void send_pending() {
    while (true) {
      if (!held_) held_ = link_.transmit(now_us_);
      if (!held_) break;
      if (!has_room()) return;
      board_.send(*std::exchange(held_, std::nullopt));
    }
    while (stream_.due(now_us_) && has_room()) {
      board_.send(stream_.front());
      stream_.pop(now_us_);
    }
  }

  // Returns false if only the firmware knows an answer.
  [[nodiscard]] bool handle(const wire::CanFrame& frame) {
    if (const auto lease = wire::decode_lease(frame)) {
      note(frame);
      stream_.renew(*lease, now_us_);
      return true;
    }
    if (is_for_others(frame)) return true;
    if (!frame.extended || frame.id != link_.rx_id()) return false;
    link_.set_frame_bytes(frame.fd && board_.can_fd ? 64 : 8);
    if (link_.receive(frame, now_us_) != wire::IsoTp::Event::kReceived) return true;
    return answer_account(link_.message());
  }
  [[nodiscard]] bool answer_account(Bytes request) {
    const std::array<std::uint8_t, 3> asked{wire::service::kRead, wire::did::kStreamAccount >> 8,
                                            wire::did::kStreamAccount & 0xFF};
    if (!std::ranges::equal(request, asked)) return false;
    wire::StreamAccount account = stream_.account(rows_.size(), now_us_);
    for (std::size_t k = 0; k < rows_.size(); ++k) account.modules[k].sent += rows_[k].sent;
    std::array<std::uint8_t, 3 + wire::StreamAccount::kMaxBytes> bytes{};
    ByteWriter out(bytes);
    out.u8(wire::service::kRead + wire::service::kPositive);
    out.u8(asked[1]);
    out.u8(asked[2]);
    account.encode(out);
    return link_.send(Bytes(bytes).first(out.size()), now_us_) == Status::kOk;
  }

  // Lets the firmware run through the time since the table took over. What the table has sent is not sent again.
  void wake() {
    by_table_ = false;
    if (held_) board_.send(*std::exchange(held_, std::nullopt));
    for (; stream_.due(UINT64_MAX); stream_.pop(now_us_)) board_.send(stream_.front());
    catching_up_ = true;
    for (const auto& [at_us, frame] : std::exchange(missed_, {})) {
      firmware_->run_until(at_us);
      if (at_us == now_us_) catching_up_ = false;  // Frames of this moment have no answer yet.
      firmware_->receive(frame);
    }
    if (catching_up_) firmware_->run_until(now_us_);
    catching_up_ = false;
    quiet_from_us_ = now_us_ + kQuiet_us;
    for (Row& r : rows_) r.steady = 0;
  }

  VirtualBoard board_;
  LookAtChip look_;
  ReadOnlyFlash flash_;
  fw::TableStore tables_;
  std::unique_ptr<VirtualController> firmware_;
  std::vector<Row> rows_;
  std::vector<std::pair<std::uint64_t, wire::StreamLease>> leases_;
  std::vector<std::pair<std::uint64_t, wire::CanFrame>> missed_;  // The firmware has not got these frames yet.
  fw::FullStream stream_;
  wire::IsoTp link_{0, 0, 8};
  std::optional<wire::CanFrame> held_;
  std::uint64_t now_us_ = 0, quiet_from_us_ = 0;
  std::uint8_t starts_ = 0;
  bool by_table_ = false, catching_up_ = false, sent_a_sample_ = false;
};

}  // namespace

std::unique_ptr<VirtualController> make_table_controller(const VirtualBoard& board, LookAtChip look) {
  return std::make_unique<TableController>(board, std::move(look));
}

}  // namespace triskin::sim
