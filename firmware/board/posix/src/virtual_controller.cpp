// SPDX-License-Identifier: Apache-2.0
#include "triskin/sim/virtual_controller.hpp"

#include <algorithm>
#include <deque>
#include <optional>
#include <stdexcept>

#include "triskin/app/application.hpp"
#include "triskin/boot/dfu_device.hpp"
#include "triskin/boot/image_receiver.hpp"
#include "triskin/boot/loader.hpp"
#include "triskin/layout/image_check.hpp"
#include "triskin/logic/usb/usb_device.hpp"

namespace triskin::sim {
namespace {

constexpr std::uint64_t kByte_ns = 22'500;  // Nine bits at 400 kHz take this long.
constexpr std::uint64_t kBit_ns = 2'500;    // A start, repeated start or stop takes this long.
constexpr std::uint64_t kStuckTimeout_us = 1'000;
// The check of a whole image takes 480 steps, which take no time here.
constexpr int kMaxStepsAtOnce = 10'000;

class VirtualClock final : public fw::Clock {
 public:
  std::uint64_t now = 0;
  [[nodiscard]] std::uint64_t now_us() const override { return now; }
  // Advances the time by work for which the processor waits.
  void spend(std::uint64_t ns) {
    rest_ns_ += ns;
    now += rest_ns_ / 1000;
    rest_ns_ %= 1000;
  }

 private:
  std::uint64_t rest_ns_ = 0;
};

// Moves all bytes at once, each with the time at which the bus would have ended it, and reports the end at the end
// time.
class VirtualI2cLine final : public fw::I2cLine {
 public:
  VirtualI2cLine(I2cBus& bus, const VirtualClock& clock) : bus_(bus), clock_(clock) {}

  void start(std::uint8_t address, Bytes write, std::span<std::uint8_t> read) override {
    spent_ns_ = 0;
    started_us_ = clock_.now;
    status_ = transfer(address, write, read);
    done_us_ = at_us() + (status_ == Status::kLineStuck ? kStuckTimeout_us : 0);
    busy_ = true;
  }
  std::optional<Status> poll() override {
    if (!busy_ || clock_.now < done_us_) return std::nullopt;
    busy_ = false;
    return status_;
  }
  [[nodiscard]] std::uint64_t started_us() const override { return started_us_; }
  [[nodiscard]] std::uint64_t ended_us() const override { return done_us_; }
  Status recover() override {
    for (int pulse = 0; pulse < 9 && !bus_.sda(); ++pulse) bus_.pulse_scl(clock_.now);
    bus_.stop(clock_.now);
    return bus_.sda() && bus_.scl() ? Status::kOk : Status::kLineStuck;
  }
  [[nodiscard]] std::uint64_t done_us() const { return busy_ ? done_us_ : UINT64_MAX; }

 private:
  Status transfer(std::uint8_t address, Bytes write, std::span<std::uint8_t> read) {
    if (!bus_.sda() || !bus_.scl()) return Status::kLineStuck;
    const auto shifted = static_cast<std::uint8_t>(address << 1);
    Status status = Status::kOk;
    if (!write.empty()) {
      status = address_byte(shifted);
      for (std::size_t k = 0; k < write.size() && status == Status::kOk; ++k)
        status = acknowledged(bus_.write(write[k], after(kByte_ns)));
    }
    if (!read.empty() && status == Status::kOk) {
      status = address_byte(static_cast<std::uint8_t>(shifted | 1));
      for (std::size_t k = 0; k < read.size() && status == Status::kOk; ++k)
        read[k] = bus_.read(k + 1 < read.size(), after(kByte_ns));
    }
    bus_.stop(after(kBit_ns));
    return bus_.sda() && bus_.scl() ? status : Status::kLineStuck;
  }
  Status address_byte(std::uint8_t byte) { return acknowledged(bus_.start(byte, after(kBit_ns + kByte_ns))); }
  static Status acknowledged(bool yes) { return yes ? Status::kOk : Status::kBusError; }
  std::uint64_t at_us() const { return clock_.now + (spent_ns_ + 999) / 1000; }
  std::uint64_t after(std::uint64_t ns) {
    spent_ns_ += ns;
    return at_us();
  }

  I2cBus& bus_;
  const VirtualClock& clock_;
  bool busy_ = false;
  Status status_ = Status::kOk;
  std::uint64_t spent_ns_ = 0, started_us_ = 0, done_us_ = 0;
};

// While a step waits for the flash, its clock is ahead of the bus, so a frame that it sends leaves when the bus has
// reached that time.
class VirtualCan final : public fw::CanPort {
 public:
  VirtualCan(const VirtualBoard& board, const VirtualClock& clock) : board_(board), clock_(clock) {}
  [[nodiscard]] bool fd() const override { return board_.can_fd; }
  [[nodiscard]] bool has_room() const override { return !board_.room || board_.room(); }
  bool send(const wire::CanFrame& frame) override {
    if (!has_room()) return false;
    if (clock_.now > bus_us_ || !later_.empty())
      later_.emplace_back(clock_.now, frame);
    else
      board_.send(frame);
    return true;
  }
  // Notes that the bus has reached this time.
  void advance(std::uint64_t bus_us) {
    bus_us_ = bus_us;
    for (; next_us() <= bus_us_; later_.pop_front()) board_.send(later_.front().second);
  }
  // Returns when the next frame must leave that was sent ahead of the bus.
  [[nodiscard]] std::uint64_t next_us() const { return later_.empty() ? UINT64_MAX : later_.front().first; }
  std::optional<wire::CanFrame> receive() override {
    if (queue.empty()) return std::nullopt;
    const wire::CanFrame frame = queue.front();
    queue.pop_front();
    return frame;
  }
  std::deque<wire::CanFrame> queue;

 private:
  const VirtualBoard& board_;
  const VirtualClock& clock_;
  std::uint64_t bus_us_ = 0;
  std::deque<std::pair<std::uint64_t, wire::CanFrame>> later_;
};

class VirtualChain final : public fw::RouteChain {
 public:
  VirtualChain(ChainModel* model, VirtualClock& clock) : model_(model), clock_(clock) {}
  void enable(std::uint8_t cables) override {
    model_->enable(cables);
    clock_.spend(ChainModel::kSettle_ns);
  }
  void exchange(Bytes out, std::span<std::uint8_t> in) override {
    model_->exchange(out, in);
    clock_.spend(out.size() * 8 * ChainModel::kBit_ns);
  }
  void latch() override {
    model_->latch();
    clock_.spend(ChainModel::kSettle_ns);
  }
  [[nodiscard]] std::uint8_t stuck_lines() override { return model_->stuck_lines(); }

 private:
  ChainModel* model_;
  VirtualClock& clock_;
};

// Each area is a part of a larger flash memory.
class VirtualFlash final : public fw::FlashArea {
 public:
  VirtualFlash(FlashModel* model, std::size_t offset, std::size_t size) : model_(model), offset_(offset), size_(size) {}
  explicit VirtualFlash(FlashModel& model) : VirtualFlash(&model, 0, model.size_bytes()) {}
  [[nodiscard]] std::size_t size_bytes() const override { return size_; }
  [[nodiscard]] std::size_t page_bytes() const override { return model_->page_bytes(); }
  [[nodiscard]] std::size_t program_bytes() const override { return model_->program_bytes(); }
  bool erase_page(std::size_t offset) override { return offset < size_ && model_->erase_page(offset_ + offset); }
  bool program(std::size_t offset, Bytes bytes) override {
    return offset + bytes.size() <= size_ && model_->program(offset_ + offset, bytes);
  }
  [[nodiscard]] Bytes bytes() const override { return Bytes(model_->bytes()).subspan(offset_, size_); }

 private:
  FlashModel* model_;
  std::size_t offset_, size_;
};

// The application runs while this flash is written, so the processor waits as long as for the real flash. During an
// erase the application continues as on the microcontroller.
class TimedFlash final : public fw::FlashArea {
 public:
  using Wait = std::function<void(std::uint64_t ns, bool goes_on)>;
  TimedFlash(VirtualFlash& flash, Wait wait) : flash_(flash), wait_(std::move(wait)) {}
  [[nodiscard]] std::size_t size_bytes() const override { return flash_.size_bytes(); }
  [[nodiscard]] std::size_t page_bytes() const override { return flash_.page_bytes(); }
  [[nodiscard]] std::size_t program_bytes() const override { return flash_.program_bytes(); }
  bool erase_page(std::size_t offset) override {
    wait_(kPageErase_ns, true);
    return flash_.erase_page(offset);
  }
  bool program(std::size_t offset, Bytes bytes) override {
    wait_(kUnitProgram_ns * (bytes.size() / program_bytes()), false);
    return flash_.program(offset, bytes);
  }
  [[nodiscard]] Bytes bytes() const override { return flash_.bytes(); }

 private:
  VirtualFlash& flash_;
  Wait wait_;
};

class Controller final : public VirtualController, private fw::Restart, private fw::BoardMonitor {
 public:
  explicit Controller(const VirtualBoard& board)
      : board_(board),
        lines_{{{*board.lines[0], clock_},
                {*board.lines[1], clock_},
                {*board.lines[2], clock_},
                {*board.lines[3], clock_}}},
        can_(board_, clock_),
        flash_(*board.flash),
        timed_flash_(flash_, [this](std::uint64_t ns, bool goes_on) { wait(ns, goes_on); }),
        chain_(board.chain, clock_),
        slot_areas_{{{board.slots, 0, kSlotsBytes / 2}, {board.slots, kSlotsBytes / 2, kSlotsBytes / 2}}},
        slots_({&slot_areas_[0], &slot_areas_[1]}, layout::kSlotOrigins),
        timed_areas_{{{slot_areas_[0], [this](std::uint64_t ns, bool goes_on) { wait(ns, goes_on); }},
                      {slot_areas_[1], [this](std::uint64_t ns, bool goes_on) { wait(ns, goes_on); }}}},
        timed_slots_({&timed_areas_[0], &timed_areas_[1]}, layout::kSlotOrigins) {
    start_application();
  }

  void receive(const wire::CanFrame& frame) override { can_.queue.push_back(frame); }
  [[nodiscard]] wire::UsbFunction& usb() override {
    if (dfu_) return *dfu_;
    return *usb_;
  }

  [[nodiscard]] int usb_session() const override { return usb_session_; }

  void run_until(std::uint64_t now_us) override {
    can_.advance(now_us);
    for (int at_once = 0; next_step_us() <= now_us; ++at_once) {
      if (next_step_us() > clock_.now) at_once = 0;
      if (at_once > kMaxStepsAtOnce) throw std::logic_error("the firmware makes no progress: its next event is past");
      clock_.now = std::max(clock_.now, next_step_us());
      step();
    }
    clock_.now = std::max(clock_.now, now_us);
    if (dfu_) dfu_->tick(clock_.now);
  }

  [[nodiscard]] std::uint64_t next_event_us() const override { return std::min(next_step_us(), can_.next_us()); }

 private:
  [[nodiscard]] std::uint64_t next_step_us() const {
    if (!can_.queue.empty()) return clock_.now;
    if (dfu_) return dfu_->wants_to_reconnect() ? clock_.now : dfu_->next_event_us();
    if (loader_) return loader_end_us();
    if (usb_->frame_waits() || wants_dfu() || application_->frames_wait()) return clock_.now;
    std::uint64_t next = application_->next_event_us();
    for (const VirtualI2cLine& line : lines_) next = std::min(next, line.done_us());
    return next;
  }
  void step() {
    if (dfu_) return step_dfu();
    if (loader_) return step_loader();
    application_->step();
    if (!wants_dfu()) return;
    application_.reset();
    ++usb_session_;
    can_.queue.clear();
    dfu_.emplace(slots_, board_.unique_id);
    dfu_->tick(clock_.now);
  }
  [[nodiscard]] std::uint64_t loader_end_us() const { return std::max(window_end_us_, loader_->stays_until_us()); }
  [[nodiscard]] bool wants_dfu() const { return usb_->wants_to_reconnect() && board_.slots != nullptr; }
  void step_dfu() {
    can_.queue.clear();  // During the restart the controller is not on the CAN bus.
    dfu_->tick(clock_.now);
    if (!dfu_->wants_to_reconnect()) return;
    dfu_.reset();
    start_application();
  }
  void step_loader() {
    bool start = false;
    while (const auto frame = can_.receive()) start |= loader_->handle(*frame, clock_.now);
    if (start || clock_.now >= loader_end_us()) start_application();
  }

  // Behaves like the loader: an application that never confirms itself is started only three times.
  void start_application() {
    loader_.reset();
    running_slot_ = board_.slots != nullptr ? slots_.choose() : -1;
    if (running_slot_ >= 0 && !slots_.inspect(running_slot_).confirmed) (void)slots_.note_start(running_slot_);
    ++usb_session_;
    usb_.emplace(board_.unique_id);
    receiver_.reset();
    // An image without a label is one of somebody else, which only the loader can replace.
    if (const auto label = running_label()) {
      receiver_.emplace(timed_slots_, static_cast<fw::Restart&>(*this),
                        boot::ImageReceiver::Self{board_.unique_id, running_slot_, label->firmware_version});
    }
    application_.emplace(fw::Ports{{&lines_[0], &lines_[1], &lines_[2], &lines_[3]},
                                   &clock_,
                                   &can_,
                                   &timed_flash_,
                                   board_.unique_id,
                                   &*usb_,
                                   board_.chain != nullptr ? &chain_ : nullptr,
                                   board_.slots != nullptr ? this : nullptr,
                                   receiver_ ? &*receiver_ : nullptr,
                                   this});
  }
  [[nodiscard]] std::optional<layout::ImageLabel> running_label() const {
    if (running_slot_ < 0) return std::nullopt;
    const auto label = layout::decode_label(slots_.bytes(running_slot_));
    return label ? std::optional(*label) : std::nullopt;
  }
  // Waits for work inside a step; before the application has started, nothing else continues.
  void wait(std::uint64_t ns, bool goes_on) {
    const std::uint64_t end_us = clock_.now + ns / 1000;
    goes_on = goes_on && application_.has_value();
    while (goes_on && clock_.now < end_us) {
      application_->step_during_flash();
      std::uint64_t next = application_->next_during_flash_us();
      for (const VirtualI2cLine& line : lines_) next = std::min(next, line.done_us());
      clock_.now = std::clamp(next, clock_.now + 1, end_us);
    }
    if (!goes_on) clock_.spend(ns);
  }

  // The following functions implement fw::Restart.
  void restart() override {
    loader_.emplace(slots_, can_, board_.unique_id);
    window_end_us_ = clock_.now + wire::loader::kWindow_us;
  }
  void confirm() override {
    if (running_slot_ >= 0) slots_.confirm(running_slot_);
  }
  std::optional<wire::ImageState> image_state() override {
    if (running_slot_ < 0) return std::nullopt;
    return boot::image_state_of(running_slot_, slots_.inspect(running_slot_));
  }

  // The following functions implement fw::BoardMonitor.
  [[nodiscard]] wire::BoardHealth health() const override { return board_.health; }
  [[nodiscard]] std::optional<wire::Crash> crash() const override { return board_.crash; }
  void forget_crash() override { board_.crash.reset(); }

  VirtualBoard board_;
  VirtualClock clock_;
  std::array<VirtualI2cLine, layout::kLines> lines_;
  VirtualCan can_;
  VirtualFlash flash_;
  TimedFlash timed_flash_;
  VirtualChain chain_;
  std::array<VirtualFlash, 2> slot_areas_;
  boot::SlotStore slots_;
  std::array<TimedFlash, 2> timed_areas_;
  boot::SlotStore timed_slots_;
  std::optional<fw::UsbDevice> usb_;
  std::optional<boot::ImageReceiver> receiver_;
  std::optional<fw::Application> application_;
  std::optional<boot::Loader> loader_;
  std::optional<boot::DfuDevice> dfu_;
  std::uint64_t window_end_us_ = 0;
  int running_slot_ = -1, usb_session_ = 0;
};

}  // namespace

std::unique_ptr<VirtualController> make_virtual_controller(const VirtualBoard& board) {
  return std::make_unique<Controller>(board);
}

}  // namespace triskin::sim
