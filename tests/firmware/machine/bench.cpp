// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.hpp"

#include <algorithm>

#include "triskin/core/bytes.hpp"
#include "triskin/wire/identity.hpp"
#include "triskin/wire/iso_tp.hpp"

namespace triskin::machine {

std::filesystem::path firmware(const char* name) {
  // The suite also runs with an image that was built with other options.
  const char* other = std::getenv("TRISKIN_IMAGE");
  return std::filesystem::path(other != nullptr ? other : TRISKIN_FIRMWARE) / name;
}

BenchBoard nucleo_board() {
  return {firmware, {}};
}

BenchBoard icub_patch_board() {
  BoardPins pins;
  pins.lines[0].sda = {1, 9};
  pins.lines[2].sda = {2, 11};
  pins.can_receive = {0, 11};
  pins.can_send = {0, 12};
  pins.log = {1, 3};
  pins.one_scl = true;
  return {[](const char* name) { return std::filesystem::path(TRISKIN_ICUB_PATCH) / name; }, pins};
}

BenchBoard nucleo_l452re_board() {
  BoardPins pins;
  pins.lines = {{{{1, 8}, {1, 9}}, {{1, 10}, {1, 11}}, {{2, 0}, {2, 1}}, {{1, 6}, {1, 7}}}};
  pins.line_functions = {4, 4, 4, 5};
  pins.can_receive = {0, 11};
  pins.can_send = {0, 12};
  return {[](const char* name) { return std::filesystem::path(TRISKIN_NUCLEO_L452RE) / name; }, pins, Chip::kStm32l452,
          false};
}

BenchBoard l452_usb_board() {
  BenchBoard board = nucleo_l452re_board();
  board.file = [](const char* name) { return std::filesystem::path(TRISKIN_L452_USB) / name; };
  board.pins.lines[0] = {{0, 9}, {0, 10}};
  board.pins.can_receive = {1, 8};
  board.pins.can_send = {1, 9};
  return board;
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

void Bench::power_up(bool will_be_cut) {
  // A new board begins at 0; the chips keep their power, and for them time goes on.
  const std::uint64_t before_us = machine || posix ? now_us() : 0;
  for (SkinLine& line : lines) line.origin_us -= before_us;
  wire::UniqueId id{};
  for (std::size_t k = 0; k < id.size(); ++k) id[k] = static_cast<std::uint8_t>(0x10 + k);
  if (on_posix) {
    posix = sim::make_virtual_controller({{&lines[0], &lines[1], &lines[2], &lines[3]},
                                          &tables,
                                          id,
                                          [this](const wire::CanFrame& f) { frames.push_back(f); },
                                          true});
    posix_us = 0;
    return;
  }
  MachineSetup setup;
  for (std::size_t k = 0; k < layout::kLines; ++k) setup.lines[k] = &lines[k];
  setup.flash = &flash;
  setup.chip = board.chip;
  setup.unique_id = id;
  setup.on_can = [this](const wire::CanFrame& f, std::uint64_t) { frames.push_back(f); };
  setup.trace = trace;
  setup.profile = profile;
  setup.crystal_hz = crystal_hz;
  setup.crystal_fails_at_us = crystal_fails_at_us;
  setup.will_be_cut = will_be_cut;
  setup.watch_reads = watch_reads;
  setup.boot_pin_high = boot_pin_high;
  setup.pins = board.pins;
  setup.scl_rise_ns = scl_rise_ns;
  setup.disturbances = disturbances;
  setup.spread = spread;
  machine = std::make_unique<Machine>(setup);
}

void Bench::behave(const hardware::Ad7147Behaviour& behaviour) {
  for (SkinLine& line : lines) {
    for (const auto& m : line.modules) {
      m->behaviour = behaviour;
      m->chip->set_behaviour(behaviour);
    }
  }
}

void Bench::run_for(std::uint64_t us) {
  if (!on_posix) return machine->run_until(machine->now_us() + us);
  posix_us += us;
  posix->run_until(posix_us);
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

std::vector<std::uint8_t> Bench::request(const std::vector<std::uint8_t>& bytes, std::uint64_t patience_us) {
  wire::IsoTp tester(wire::physical_id(1, wire::kTesterAddress), wire::physical_id(wire::kTesterAddress, 1),
                     board.fd ? 64 : 8);
  EXPECT_EQ(tester.send(bytes, now_us()), Status::kOk);
  const std::uint64_t until = now_us() + patience_us;
  std::size_t seen = frames.size();
  while (now_us() < until) {
    (void)tester.tick(now_us());
    while (const auto f = tester.transmit(now_us())) deliver(*f);
    run_for(500);
    for (; seen < frames.size(); ++seen) {
      if (frames[seen].id != tester.rx_id()) continue;  // The stream continues meanwhile.
      if (tester.receive(frames[seen], now_us()) != wire::IsoTp::Event::kReceived) continue;
      const Bytes m = tester.message();
      return {m.begin(), m.end()};
    }
  }
  return {};
}

void Bench::unlock() {
  ASSERT_EQ(request({0x10, 0x03}).at(0), 0x50);
  const auto seed = request({0x27, 0x01});
  ASSERT_EQ(seed.size(), 6U);
  const std::uint32_t k = wire::security_key(ByteReader(Bytes(seed).subspan(2)).be32());
  ASSERT_EQ(request({0x27, 0x02, static_cast<std::uint8_t>(k >> 24), static_cast<std::uint8_t>(k >> 16),
                     static_cast<std::uint8_t>(k >> 8), static_cast<std::uint8_t>(k)})
                .at(0),
            0x67);
}

bool Bench::flash_table(const layout::PatchImage& image) {
  std::vector<std::uint8_t> bytes(layout::kMaxImageBytes);
  bytes.resize(layout::encode(image, bytes).value());
  unlock();
  if (HasFatalFailure()) return false;
  const auto size = static_cast<std::uint8_t>(bytes.size());
  if (request({0x34, 0x00, 0x44, 0x00, 0x01, 0x00, 0x00, 0x00, 0x00, 0x00, size}).at(0) != 0x74) return false;
  std::uint8_t block = 0;
  for (std::size_t at = 0; at < bytes.size(); at += 64) {
    std::vector<std::uint8_t> transfer{0x36, ++block};
    for (std::size_t k = at; k < std::min(at + 64, bytes.size()); ++k) transfer.push_back(bytes[k]);
    if (request(transfer).at(0) != 0x76) return false;
  }
  if (request({0x37}).at(0) != 0x77) return false;
  const auto activated = request({0x31, 0x01, 0x02, 0x05});
  return activated.size() >= 5 && activated[0] == 0x71 && activated[4] == 0;
}

namespace {

template <class Value>
std::optional<Value> value_of(const std::vector<std::uint8_t>& reply) {
  if (reply.size() < 3 || reply[0] != 0x62) return std::nullopt;
  const auto value = Value::decode(Bytes(reply).subspan(3));
  return value ? std::optional(*value) : std::nullopt;
}

}  // namespace

std::optional<wire::BoardHealth> Bench::health() {
  return value_of<wire::BoardHealth>(request({0x22, 0xFD, 0x11}));
}

std::optional<wire::Crash> Bench::crash() {
  const auto last = value_of<wire::Crash>(request({0x22, 0xFD, 0x12}));
  return last && last->cause != wire::CrashCause::kNone ? last : std::nullopt;
}

bool Bench::confirmed() {
  const auto state = value_of<wire::ImageState>(request({0x22, 0xFD, 0x09}));
  return state && state->confirmed;
}

void Bench::self_test() {
  ASSERT_EQ(request({0x31, 0x01, 0x02, 0x02}).at(0), 0x71);
}

void Bench::send(std::uint32_t id, std::span<const std::uint8_t> data) {
  wire::CanFrame f;
  f.id = id;
  f.extended = true;
  f.size = static_cast<std::uint8_t>(data.size());
  std::ranges::copy(data, f.data.begin());
  deliver(f);
}

}  // namespace triskin::machine
