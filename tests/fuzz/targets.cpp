// SPDX-License-Identifier: GPL-3.0-or-later
#include "targets.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <vector>

#include "triskin/base/error.hpp"
#include "triskin/boot/dfu_device.hpp"
#include "triskin/boot/image_receiver.hpp"
#include "triskin/boot/loader.hpp"
#include "triskin/hardware/tcp_link.hpp"
#include "triskin/layout/firmware_package.hpp"
#include "triskin/layout/patch_image.hpp"
#include "triskin/logic/diagnostics/uds_server.hpp"
#include "triskin/logic/icub/icub_triangles.hpp"
#include "triskin/logic/storage/table_store.hpp"
#include "triskin/logic/usb/usb_device.hpp"
#include "triskin/wire/calibration.hpp"
#include "triskin/wire/faults.hpp"
#include "triskin/wire/identity.hpp"
#include "triskin/wire/iso_tp.hpp"
#include "triskin/wire/lines.hpp"
#include "triskin/wire/live_taxels.hpp"
#include "triskin/wire/log.hpp"
#include "triskin/wire/module_state.hpp"
#include "triskin/wire/node_claim.hpp"
#include "triskin/wire/sampling.hpp"
#include "triskin/wire/statistics.hpp"
#include "triskin/wire/table_state.hpp"
#include "triskin/wire/taxel_frames.hpp"
#include "triskin/wire/topology.hpp"
#include "triskin/wire/usb_packet.hpp"

namespace triskin::fuzz {
namespace {

// Simulates erased memory of any size; every operation is allowed.
class Memory final : public fw::FlashArea {
 public:
  explicit Memory(std::size_t size) : bytes_(size, 0xFF) {}
  [[nodiscard]] std::size_t size_bytes() const override { return bytes_.size(); }
  [[nodiscard]] std::size_t page_bytes() const override { return 2048; }
  [[nodiscard]] std::size_t program_bytes() const override { return 8; }
  bool erase_page(std::size_t offset) override {
    require(offset % 2048 == 0 && offset + 2048 <= bytes_.size());
    std::fill_n(bytes_.begin() + static_cast<std::ptrdiff_t>(offset), 2048, std::uint8_t{0xFF});
    return true;
  }
  bool program(std::size_t offset, Bytes in) override {
    require(offset % 8 == 0 && in.size() % 8 == 0 && offset + in.size() <= bytes_.size());
    std::copy(in.begin(), in.end(), bytes_.begin() + static_cast<std::ptrdiff_t>(offset));
    return true;
  }
  [[nodiscard]] Bytes bytes() const override { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
};

// Splits the input into pieces with one byte of length before each.
template <typename F>
void each_piece(Bytes input, F&& f) {
  while (!input.empty()) {
    const std::size_t n = std::min<std::size_t>(input[0], input.size() - 1);
    f(input.subspan(1, n));
    input = input.subspan(1 + n);
  }
}

wire::CanFrame frame_of(Bytes piece, std::uint32_t id, bool extended) {
  wire::CanFrame f;
  f.id = id;
  f.extended = extended;
  f.size = static_cast<std::uint8_t>(std::min<std::size_t>(piece.size(), 64));
  f.fd = f.size > 8;
  std::copy_n(piece.begin(), f.size, f.data.begin());
  return f;
}

void iso_tp(Bytes input) {
  wire::IsoTp link(1, 2, 8);
  std::uint64_t now_us = 0;
  const std::array<std::uint8_t, 40> message{};
  each_piece(input, [&](Bytes piece) {
    if (link.receive(frame_of(piece, 2, true), now_us) == wire::IsoTp::Event::kReceived)
      require(!link.message().empty() && link.message().size() <= wire::IsoTp::kCapacity);
    if (piece.size() == 1) (void)link.send(message, now_us);
    for (int k = 0; k < 200 && link.transmit(now_us); ++k) {
    }
    now_us += piece.empty() ? 1'100'000 : 500;
    (void)link.tick(now_us);
  });
}

class Host final : public fw::UdsHost {
 public:
  bool read_identifier(std::uint16_t did, ByteWriter& out) override {
    out.be16(did);
    return did % 2 == 0;
  }
  Status write_identifier(std::uint16_t, Bytes) override { return Status::kOk; }
  Status start_routine(std::uint16_t, Bytes, ByteWriter&) override { return Status::kOk; }
  Status routine_result(std::uint16_t, ByteWriter&) override { return Status::kOk; }
  Status clear_faults() override { return Status::kOk; }
  void read_faults(std::uint8_t, ByteWriter&) override {}
  bool read_fault(std::uint32_t, ByteWriter&) override { return false; }
  void request_reset() override {}
  [[nodiscard]] std::uint64_t now_us() const override { return now; }
  std::uint64_t now = 0;
};

void uds_server(Bytes input) {
  Host host;
  Memory flash(16384);
  fw::TableStore tables(flash);
  tables.load();
  fw::UdsServer server(host, tables);
  each_piece(input, [&](Bytes piece) {
    if (piece.empty()) return;
    host.now += 1000;
    const Bytes answer = server.handle(piece, piece.size() % 5 == 0);
    require(answer.size() <= fw::UdsServer::kMaxResponse);
    if (answer.empty()) return;
    require((answer.size() == 3 && answer[0] == 0x7F && answer[1] == piece[0]) ||
            answer[0] == static_cast<std::uint8_t>(piece[0] + 0x40));
  });
}

void usb_packet(Bytes input) {
  const auto frame = wire::from_usb(input);
  if (!frame) return;
  const auto packet = wire::to_usb(*frame);
  require(packet && wire::from_usb(packet->used()) == frame);
}

template <typename Device>
void control_transfers(Device& device, Bytes input) {
  each_piece(input, [&](Bytes piece) {
    if (piece.size() < 8) {
      device.out(static_cast<std::uint8_t>(piece.size() % 4), piece);
      (void)device.in(static_cast<std::uint8_t>(0x80 | piece.size() % 4));
      return;
    }
    (void)device.control(wire::setup_of(piece), piece.subspan(8));
  });
}

void usb_control(Bytes input) {
  fw::UsbDevice device({1, 2, 3});
  control_transfers(device, input);
  while (device.receive()) {
  }
}

void dfu(Bytes input) {
  Memory a(8192), b(8192);
  boot::SlotStore slots({&a, &b}, {0x08004000, 0x08040000});
  boot::DfuDevice device(slots, {1, 2, 3});
  control_transfers(device, input);
  device.tick(1);
}

class Wire final : public fw::CanPort {
 public:
  [[nodiscard]] bool fd() const override { return false; }
  std::optional<wire::CanFrame> receive() override { return std::nullopt; }
  bool send(const wire::CanFrame& f) override {
    require(f.extended && f.id == wire::loader::kReplyId && f.size >= 2 && f.size <= 8);
    return true;
  }
};

// The first byte of a piece tells whether it is a command or data of the image.
void loader(Bytes input) {
  Memory a(8192), b(8192);
  boot::SlotStore slots({&a, &b}, {0x08004000, 0x08040000});
  Wire can;
  boot::Loader device(slots, can, {1, 2, 3});
  std::uint64_t now_us = 0;
  each_piece(input, [&](Bytes piece) {
    if (piece.empty()) return;
    const Bytes bytes = piece.subspan(1, std::min<std::size_t>(piece.size() - 1, 8));
    (void)device.handle(frame_of(bytes, piece[0] % 2 == 0 ? wire::loader::kRequestId : wire::loader::kDataId, true),
                        now_us += 1000);
  });
}

class Answers final : public fw::CanPort {
 public:
  explicit Answers(std::uint32_t id) : id_(id) {}
  [[nodiscard]] bool fd() const override { return true; }
  std::optional<wire::CanFrame> receive() override { return std::nullopt; }
  bool send(const wire::CanFrame& f) override {
    require(f.extended && f.id == id_ && (f.size == 8 || f.size == 64) && f.data[0] >= 0x10);
    return true;
  }

 private:
  std::uint32_t id_;
};

class NoRestart final : public fw::Restart {
 public:
  void restart() override {}
  std::optional<wire::ImageState> image_state() override { return std::nullopt; }
};

// The first byte of a piece tells whether it is a command or data, which begins with the slot and the unit. The running
// slot must never change.
void image_update(Bytes input) {
  constexpr wire::UniqueId kId{1, 2, 3};
  Memory a(8192), b(8192);
  boot::SlotStore slots({&a, &b}, {0x08004000, 0x08040000});
  slots.confirm(0);
  const std::uint32_t before = crc32(a.bytes());
  NoRestart restart;
  Answers can(wire::claim_id(kId));
  boot::ImageReceiver receiver(slots, restart, {kId, 0, 0x00010000});
  std::uint64_t now_us = 0;
  each_piece(input, [&](Bytes piece) {
    if (piece.size() < 4) return;
    const bool data = piece[0] % 2 != 0;
    wire::CanFrame f = frame_of(piece.subspan(data ? 4 : 1, std::min<std::size_t>(piece.size() - (data ? 4 : 1), 8)),
                                wire::update::kCommandId, true);
    if (data)
      f.id = wire::update::kDataBase | std::uint32_t{piece[1]} % 2 << 16 | std::uint32_t{piece[3]} << 8 | piece[2];
    require(receiver.handle(f, now_us));
    for (int k = 0; k < 20; ++k) receiver.step(can, now_us += 50);
  });
  require(crc32(a.bytes()) == before);
}

void ad7147_results(Bytes piece, fw::ModuleReading& sample) {
  fw::ad7147::Results results{};
  for (std::size_t t = 0; t < results.size(); ++t)
    results[t] = static_cast<std::uint16_t>(piece[t % piece.size()] << 8 | piece[0]);
  sample.store(results, 0);
}

void icub(Bytes input) {
  fw::IcubBoard board;
  fw::IcubTriangles triangles;
  fw::ModuleReading sample;
  const wire::UniqueId unique_id{1, 2, 3};
  each_piece(input, [&](Bytes piece) {
    if (piece.size() < 2) return;
    const auto id = static_cast<std::uint32_t>(piece[0]) << 4 | 1U;
    const wire::CanFrame f = frame_of(piece.subspan(1, std::min<std::size_t>(piece.size() - 1, 8)), id & 0x7FF, false);
    if (board.handle(f, {1, 0, unique_id, piece[0]}).calibrate) triangles.calibrate();
    if (piece[0] % 2 == 0) board.pop_reply();
    ad7147_results(piece, sample);
    triangles.read(0, sample);
    for (std::size_t k = 0; k < 16; ++k) (void)triangles.taxels(0, sample, board, k);
  });
}

void patch_image(Bytes input) {
  const auto image = layout::decode(input);
  if (!image) return;
  std::array<std::uint8_t, layout::kMaxImageBytes> bytes{};
  const auto size = layout::encode(*image, bytes);
  require(size && *size <= input.size());  // A slot is longer than the input.
  require(layout::decode(Bytes(bytes).first(*size)) == image);
}

void taxel_frames(Bytes input) {
  if (input.size() < 4) return;
  const std::uint32_t id = ByteReader(input).le32() & 0x1FFFFFFF;
  const wire::CanFrame f = frame_of(input.subspan(4), id, (id >> 28) != 0);
  if (const auto full = wire::decode_full(f)) require(wire::decode_full(wire::encode_full(*full)) == full);
  if (const auto taxels = wire::decode_icub(f, f)) (void)wire::encode_icub(*taxels);
  wire::CanFrame second = f;
  second.data[0] = wire::kIcubSecond;
  if (const auto taxels = wire::decode_icub(f, second)) {
    const auto again = wire::encode_icub(*taxels);
    require(wire::decode_icub(again[0], again[1]) == taxels);
  }
}

void node_claim(Bytes input) {
  wire::IdFrames frames;
  each_piece(input, [&](Bytes piece) {
    const auto joined = frames.add(frame_of(piece, wire::kAssignId, true));
    if (!joined) return;
    const auto claim = wire::decode_claim(*joined);
    if (claim) require(wire::encode_claim(*claim)[1].data[6] == joined->a);
  });
}

template <class Value>
std::vector<std::uint8_t> encoded(const Value& value) {
  std::array<std::uint8_t, 512> buffer{};
  ByteWriter w(buffer);
  value.encode(w);
  require(w.ok());
  return {w.written().begin(), w.written().end()};
}

// A value that a decoder accepts must be encoded to the same bytes, or to fewer if its last field is left out at its
// default; those must then mean the same.
template <class Value>
void answer(Bytes bytes) {
  const auto value = Value::decode(bytes);
  if (!value) return;
  const std::vector<std::uint8_t> again = encoded(*value);
  const auto same = Value::decode(again);
  require(same && encoded(*same) == again);
  require(again.size() <= bytes.size() && std::ranges::equal(again, bytes.first(again.size())));
}

// Only the first bytes of another wire version are read.
void hello(Bytes bytes) {
  const auto h = wire::Hello::decode(bytes);
  if (h && h->wire_version == wire::kWireVersion) answer<wire::Hello>(bytes);
}

constexpr std::array kAnswers{hello,
                              answer<wire::ActiveSession>,
                              answer<wire::SerialNumber>,
                              answer<wire::FirmwareVersion>,
                              answer<wire::NodeAddress>,
                              answer<wire::ActiveTable>,
                              answer<wire::ModuleStates>,
                              answer<wire::SelfTestResult>,
                              answer<wire::Statistics>,
                              answer<wire::StreamSetting>,
                              answer<wire::LineStates>,
                              answer<wire::Discovery>,
                              answer<wire::SamplingSetting>,
                              answer<wire::ImageState>,
                              answer<wire::LiveTaxels>,
                              answer<wire::RerouteResult>,
                              answer<wire::ActivationResult>,
                              answer<wire::ProtectionResult>,
                              answer<wire::LogSetting>,
                              answer<wire::FaultList>,
                              answer<wire::FreezeFrame>,
                              answer<wire::FoundTopology>,
                              answer<wire::ActiveRoute>,
                              answer<wire::Calibration>};

// The first byte chooses the type.
void answers(Bytes input) {
  if (!input.empty()) kAnswers[input[0] % kAnswers.size()](input.subspan(1));
}

void firmware_package(Bytes input) {
  const auto head = layout::decode_package_head(input);
  if (head)
    require(head->total() <= layout::kPackageHeadBytes + 2 * layout::kMaxFirmwareImageBytes &&
            head->offset(1) > head->offset(0));
}

void record(Bytes input) {
  std::vector<std::uint8_t> in(input.begin(), input.end());
  try {
    while (const auto r = hardware::record::take(in)) (void)hardware::record::frame_of(*r);
  } catch (const DeviceError&) {
    return;  // The value was refused.
  }
}

constexpr std::array kTargets{Target{"iso_tp", iso_tp},
                              Target{"uds_server", uds_server},
                              Target{"usb_packet", usb_packet},
                              Target{"usb_control", usb_control},
                              Target{"dfu", dfu},
                              Target{"loader", loader},
                              Target{"image_update", image_update},
                              Target{"icub", icub},
                              Target{"patch_image", patch_image},
                              Target{"taxel_frames", taxel_frames},
                              Target{"node_claim", node_claim},
                              Target{"answers", answers},
                              Target{"firmware_package", firmware_package},
                              Target{"record", record}};

}  // namespace

std::span<const Target> targets() {
  return kTargets;
}

}  // namespace triskin::fuzz
