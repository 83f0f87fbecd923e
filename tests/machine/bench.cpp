// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.hpp"

#include <algorithm>

#include "triskin/base/bytes.hpp"
#include "triskin/wire/iso_tp.hpp"

namespace triskin::machine {

bool TestLine::start(std::uint8_t address_byte, std::uint64_t) {
  ++bytes;
  selected_ = nullptr;
  index_ = static_cast<std::size_t>((address_byte >> 1) - 0x2C);
  if (scl_held || sda_held || index_ > 3 || !chips[index_].present) return false;
  selected_ = &chips[index_];
  reading_ = (address_byte & 1) != 0;
  position_ = 0;
  return true;
}

bool TestLine::write(std::uint8_t byte, std::uint64_t now_us) {
  ++bytes;
  if (selected_ == nullptr) return false;
  if (position_ == 3 && pointer_ == 0) selected_->restart_us = now_us;
  if (position_ == 0) pointer_ = static_cast<std::uint16_t>(byte << 8);
  else if (position_ == 1) pointer_ = static_cast<std::uint16_t>(pointer_ | byte);
  else if (position_ % 2 == 0) selected_->regs[pointer_ & 0xFF] = static_cast<std::uint16_t>(byte << 8);
  else selected_->regs[pointer_++ & 0xFF] |= byte;
  ++position_;
  return true;
}

std::uint16_t TestLine::expected(std::size_t chip, int stage, std::uint64_t now_us) const {
  const std::uint64_t since_us = now_us - chips[chip].restart_us;
  return static_cast<std::uint16_t>(0x4000 + since_us / kSequence_us % 1024 * 8 + chip + static_cast<unsigned>(stage) * 0x800);
}

std::uint8_t TestLine::read(bool, std::uint64_t now_us) {
  ++bytes;
  if (selected_ == nullptr) return 0xFF;
  std::uint16_t value = selected_->regs[pointer_ & 0xFF];
  if (pointer_ == 0x17) value = selected_->id;
  if (pointer_ >= 0x0B && pointer_ <= 0x16) {
    const int stage = pointer_ - 0x0B;
    value = expected(index_, stage, now_us);
    const bool positive = (selected_->regs[0x81 + 8 * static_cast<std::size_t>(stage)] & 0x1000) != 0;
    if (positive) value = static_cast<std::uint16_t>(0x10000 - value);  // the converter's inputs mirror each other
  }
  if (position_++ % 2 == 0) return static_cast<std::uint8_t>(value >> 8);
  ++pointer_;
  return static_cast<std::uint8_t>(value);
}

void TestLine::stop(std::uint64_t) {
  selected_ = nullptr;
  ++stops;
}

void TestLine::pulse_scl(std::uint64_t) {
  if (++pulses == frees_after_pulses) sda_held = false;
}

std::vector<std::uint8_t> whole_blocks(const ElfImage& image) {
  const std::vector<std::uint8_t> flat = image.flat();
  std::vector<std::uint8_t> out((flat.size() + 255) / 256 * 256, 0xFF);
  std::ranges::copy(flat, out.begin());
  return out;
}

layout::PatchImage patch(int modules) {
  layout::PatchImage image;
  image.design_id = 0x1234;
  image.node_address = 1;
  image.module_count = static_cast<std::uint8_t>(modules);
  for (int k = 0; k < modules; ++k) {
    layout::ModuleRow& m = image.modules[static_cast<std::size_t>(k)];
    m.module_id = static_cast<std::uint16_t>(100 + k);
    m.line = static_cast<std::uint8_t>(k % 4);
    m.address = static_cast<std::uint8_t>(k / 4);
    m.parent = k == 0 ? layout::kNoParent : static_cast<std::uint8_t>((k - 1) / 2);
    m.parent_port = k == 0 ? layout::kCable : static_cast<std::uint8_t>(1 + (k - 1) % 2);
  }
  return image;
}

void Bench::power_up() {
  MachineSetup setup;
  for (std::size_t k = 0; k < 4; ++k) setup.lines[k] = &lines[k];
  setup.flash = &flash;
  for (std::size_t k = 0; k < 12; ++k) setup.unique_id[k] = static_cast<std::uint8_t>(0x10 + k);
  setup.on_can = [this](const wire::CanFrame& f, std::uint64_t) { frames.push_back(f); };
  setup.trace = trace;
  setup.crystal_works = crystal_works;
  machine = std::make_unique<Machine>(setup);
}

void Bench::store_table(const layout::PatchImage& image, std::uint32_t sequence) {
  std::vector<std::uint8_t> page(2048, 0xFF);
  const std::size_t size = layout::encode(image, page).value();
  std::array<std::uint8_t, 16> commit{};
  ByteWriter w(commit);
  w.le32(0x54494D43);
  w.le32(sequence);
  w.le32(static_cast<std::uint32_t>(size));
  w.le32(crc32(w.written(), crc32(Bytes(page).first(size))));
  page.resize(size);
  flash.store(0x0807C000, page);
  flash.store(0x0807C000 + 2048 - 16, {commit.begin(), commit.end()});
}

std::vector<std::uint8_t> Bench::request(const std::vector<std::uint8_t>& bytes) {
  wire::IsoTp tester(wire::physical_id(1, wire::kTesterAddress), wire::physical_id(wire::kTesterAddress, 1), 64);
  EXPECT_EQ(tester.send(bytes, machine->now_us()), Status::kOk);
  const std::uint64_t until = machine->now_us() + 200'000;
  std::size_t seen = frames.size();
  while (machine->now_us() < until) {
    (void)tester.tick(machine->now_us());
    while (const auto f = tester.transmit(machine->now_us())) machine->receive(*f);
    run_for(500);
    for (; seen < frames.size(); ++seen) {
      if (tester.receive(frames[seen], machine->now_us()) != wire::IsoTp::Event::kReceived) continue;
      const Bytes m = tester.message();
      return {m.begin(), m.end()};
    }
  }
  return {};
}

void Bench::send(std::uint32_t id, std::span<const std::uint8_t> data) {
  wire::CanFrame f;
  f.id = id;
  f.extended = true;
  f.size = static_cast<std::uint8_t>(data.size());
  std::ranges::copy(data, f.data.begin());
  machine->receive(f);
}

}  // namespace triskin::machine
