// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/machine/machine.hpp"

#include "core.hpp"

namespace triskin::machine {

Machine::Machine(const MachineSetup& setup) : core_(std::make_unique<Core>(setup)) {}
Machine::~Machine() = default;

void Machine::run_until(std::uint64_t us) {
  core_->run_until(us * kMicrosecond);
  for (std::size_t k = 0; k < 4; ++k) core_->counts_.i2c_busy_us[k] = core_->i2c_busy(k) / kMicrosecond;
}

void Machine::power_cycle(const FlashChip& cells) {
  core_->power_cycle(cells);
}
void Machine::press_reset() {
  core_->press_reset();
}
void Machine::hold_core(bool held) {
  core_->hold(held);
}
void Machine::write_register(std::uint32_t address, std::uint32_t value) {
  core_->write_register(address, value);
}
void Machine::hold_button(bool pressed) {
  core_->gpio().hold_button(pressed);
}
std::uint64_t Machine::now_us() const {
  return core_->time().now_us();
}
void Machine::receive(const wire::CanFrame& frame) {
  core_->receive(frame);
}
std::size_t Machine::frames_waiting() const {
  return core_->frames_waiting();
}
bool Machine::disturb(std::size_t line, Trouble trouble, std::uint64_t stretch_us) {
  return core_->disturb(line, trouble, stretch_us * kMicrosecond);
}
void Machine::fail_can_ram() {
  core_->fail_can_ram();
}
const std::vector<Incident>& Machine::incidents() const {
  return core_->incidents_;
}
UsbWire& Machine::usb() {
  return core_->usb();
}
std::uint32_t Machine::read_word(std::uint32_t address) const {
  return core_->load(address);
}
void Machine::write_word(std::uint32_t address, std::uint32_t value) {
  core_->overwrite(address, value);
}
std::uint32_t Machine::read_register(std::uint32_t address) const {
  return core_->peek(address);
}
const std::string& Machine::serial_text() const {
  return core_->serial_text();
}
const std::vector<Violation>& Machine::violations() const {
  return core_->violations_;
}
const MachineCounts& Machine::counts() const {
  return core_->counts_;
}
std::uint64_t Machine::sysclk_hz() const {
  return core_->sysclk_hz();
}
bool Machine::in_rom_loader() const {
  return core_->in_rom_loader();
}
std::uint32_t Machine::vector_table() const {
  return core_->image();
}

}  // namespace triskin::machine
