// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/deploy/firmware_update.hpp"

#include <fmt/format.h>

#include <optional>

#include "triskin/base/counted.hpp"
#include "triskin/base/file_kind.hpp"
#include "triskin/base/files.hpp"
#include "triskin/base/interrupt.hpp"
#include "triskin/layout/image_check.hpp"
#include "triskin/session/controller.hpp"
#include "triskin/session/firmware_version.hpp"
#include "triskin/wire/loader_protocol.hpp"

namespace triskin::deploy {
namespace {

using LoaderCommand = wire::loader::Command;

constexpr std::uint64_t kHelloEvery_us = 4'000, kEnter_us = 500'000;
constexpr int kResets = 6;  // A busy host may miss the loader's window.
constexpr std::uint64_t kReply_us = 2'000'000, kErase_us = 8'000'000;
constexpr std::uint64_t kStart_us = 200'000;  // Covers the loader's window and the application's first steps.

// Talks to the loader of one controller. It does not acknowledge single frames: after every 32 it reports how many it
// has.
class LoaderSession {
 public:
  LoaderSession(session::Bus& bus, const wire::UniqueId& id)
      : bus_(bus), link_(bus.link()), id_crc_(crc32(id)), name_(session::to_text(id)) {}

  // Returns the states of both slots: bit 0 valid, 1 confirmed, 2 startable; slot 1 in bits 3–5.
  std::uint8_t enter(session::Controller& controller) {
    for (int k = 0; k < kResets; ++k) {
      if (const auto states = enter_after_reset(controller)) return *states;
    }
    fail("does not come up in its loader; check its power, then run the command again");
  }
  std::optional<std::uint8_t> enter_after_reset(session::Controller& controller) {
    try {
      controller.reset();
    } catch (const DeviceError&) {
      // The controller may already be in its loader.
    }
    const std::uint64_t end_us = link_.now_us() + kEnter_us;
    while (link_.now_us() < end_us) {
      send(LoaderCommand::kHello);
      const auto reply = wait(LoaderCommand::kHello, kHelloEvery_us);
      if (!reply || reply->size() != 7 || ByteReader(Bytes(*reply).subspan(3)).le32() != id_crc_) continue;
      if (((*reply)[2] >> 6) != wire::loader::kProtocol)
        fail("speaks another loader protocol; use the tool of its release");
      send(LoaderCommand::kSelect, id_crc_, 4);
      if (!wait(LoaderCommand::kSelect, kReply_us)) fail("does not answer in its loader");
      return (*reply)[2];
    }
    return std::nullopt;
  }
  void erase(int slot) {
    send(LoaderCommand::kErase, static_cast<std::uint64_t>(slot), 1);
    check(wait(LoaderCommand::kErase, kErase_us), "erasing");
  }
  void write(Bytes image, const std::function<void(double)>& steps) {
    constexpr std::size_t kBlock = std::size_t{8} * wire::loader::kFramesPerReply;
    for (std::size_t at = 0; at < image.size(); at += 8) {
      wire::CanFrame f;
      f.id = wire::loader::kDataId;
      f.extended = true;
      f.size = 8;
      std::ranges::copy(image.subspan(at, 8), f.data.begin());
      link_.send(f);
      if ((at + 8) % kBlock != 0) continue;
      const auto reply = wait(LoaderCommand::kData, kReply_us);
      check(reply, "writing");
      if (reply->size() != 6 || ByteReader(Bytes(*reply).subspan(2)).le32() != at + 8)
        fail("has lost a frame; run the command again");
      steps(static_cast<double>(at) / static_cast<double>(image.size()));
    }
  }
  void commit(Bytes image) {
    send(LoaderCommand::kCommit, image.size() | static_cast<std::uint64_t>(crc32(image)) << 24, 7);
    check(wait(LoaderCommand::kCommit, kReply_us), "checking");
  }
  void boot() { send(LoaderCommand::kBoot); }
  // Starts the application and waits until it can answer. Nobody answers the command, so it is sent twice: an
  // application does not know it.
  void leave() {
    boot();
    boot();
    bus_.listen(link_.now_us() + kStart_us);
  }

 private:
  void send(LoaderCommand command, std::uint64_t arguments = 0, int bytes = 0) {
    wire::CanFrame f;
    f.id = wire::loader::kRequestId;
    f.extended = true;
    f.data[0] = static_cast<std::uint8_t>(command);
    for (int k = 0; k < bytes; ++k)
      f.data[static_cast<std::size_t>(k) + 1] = static_cast<std::uint8_t>(arguments >> (8 * k));
    f.size = static_cast<std::uint8_t>(1 + bytes);
    link_.send(f);
  }
  std::optional<std::vector<std::uint8_t>> wait(LoaderCommand command, std::uint64_t timeout_us) {
    const std::uint64_t end_us = link_.now_us() + timeout_us;
    do {
      const auto f = bus_.receive(end_us);
      if (f && f->extended && f->id == wire::loader::kReplyId && f->size >= 2 &&
          f->data[0] == static_cast<std::uint8_t>(command)) {
        return std::vector<std::uint8_t>(f->data.begin(), f->data.begin() + f->size);
      }
    } while (link_.now_us() < end_us);
    return std::nullopt;
  }
  void check(const std::optional<std::vector<std::uint8_t>>& reply, const char* what) const {
    if (!reply) fail(fmt::format("does not answer while {}; the old firmware stays, run the command again", what));
    const auto status = wire::to_status((*reply)[1]);
    if (status && *status == Status::kOk) return;
    const std::string why = status ? session::describe(*status) : fmt::format("status {} is unknown", (*reply)[1]);
    fail(fmt::format("refuses while {}: {}; the old firmware stays", what, why));
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw DeviceError(fmt::format("{}: controller {} {}", link_.name(), name_, what));
  }

  session::Bus& bus_;
  link::Link& link_;
  std::uint32_t id_crc_;
  std::string name_;
};

// Returns the slot that was written. If the user ends the program, the controller continues with its old application.
// The loader refuses to write the slot that runs. Slot 0 is free when slot 1 runs, or when neither does.
int free_slot(const std::optional<wire::ImageState>& before, std::uint8_t states) {
  const int running = before ? before->slot : (states & 4) != 0 ? 0 : 1;
  return running == 0 ? 1 : 0;
}

int write_free_slot(LoaderSession& loader, const std::optional<wire::ImageState>& before,
                    session::Controller& controller, const FirmwarePackage& package,
                    const std::function<void(double)>& steps) {
  try {
    const int slot = free_slot(before, loader.enter(controller));
    loader.erase(slot);
    loader.write(package.image(slot), steps);
    loader.commit(package.image(slot));
    return slot;
  } catch (const Cancelled& e) {
    loader.boot();
    throw Cancelled(std::string(e.what()) + "; the old firmware stays and starts again");
  } catch (const link::Unreachable& e) {
    throw link::Unreachable(std::string(e.what()) +
                            "; the old firmware stays and starts again by itself; run the command again");
  } catch (const DeviceError&) {
    loader.leave();  // While the loader waited for more, the next command would not find the controller.
    throw;
  }
}

bool runs(const std::optional<wire::ImageState>& state, const FirmwarePackage& package) {
  return state && state->record_crc == layout::slot_crc(state->sequence, package.image(state->slot));
}

std::string part_number(const std::array<std::uint8_t, 8>& hardware) {
  return {hardware.begin(), hardware.end()};
}

// A label that decodes and does not fit is of other hardware, another slot or another memory map.
std::string why_unfit(Status status, Bytes image, const layout::ImageTarget& target) {
  const auto label = layout::decode_label(image);
  switch (status) {
    case Status::kBadMagic:
    case Status::kBadVersion:
      return "has no label that says which board it is for; build the package again with this release";
    case Status::kWrongTarget:
      if (label->hardware != target.hardware)
        return fmt::format("is for a board \"{}\", these are \"{}\"; give the package of your board, or --board {}",
                           part_number(label->hardware), part_number(target.hardware), part_number(label->hardware));
      if (label->origin != target.origin)
        return fmt::format("is linked for address 0x{:08X}, the slot begins at 0x{:08X}; build the package again",
                           label->origin, target.origin);
      return "is linked for another microcontroller: its stack or its entry lies outside; build the package again";
    default:
      return "has a size that no slot takes; build the package again";
  }
}

// The loader does not know which version runs, so the host compares.
void require_newer_of_this_kind(session::Controller& controller, const FirmwarePackage& package,
                                const UpdateOptions& options, const std::string& name) {
  const std::string kind = controller.part_number();
  if (kind != part_number(options.hardware))
    throw DeviceError(fmt::format("{} is a board \"{}\", the package is for \"{}\"; nothing was written to it", name,
                                  kind, part_number(options.hardware)));
  const std::uint32_t now = controller.hello().firmware_version, offered = package.head.firmware_version;
  if (offered < now && !options.allow_older)
    throw DeviceError(
        fmt::format("{} runs version {}, the package has {}; --allow-older takes it; nothing was written to it", name,
                    session::firmware_version_text(now), session::firmware_version_text(offered)));
}

}  // namespace

void require_fit(const FirmwarePackage& package, const std::array<std::uint8_t, 8>& hardware) {
  for (int slot = 0; slot < 2; ++slot) {
    const Bytes image = package.image(slot);
    const layout::ImageTarget target{.hardware = hardware,
                                     .origin = layout::kSlotOrigins[static_cast<std::size_t>(slot)]};
    const Status status = layout::check_image(image, target);
    if (status != Status::kOk)
      throw InputError(fmt::format("firmware package: the image for slot {} {}", slot == 0 ? 'A' : 'B',
                                   why_unfit(status, image, target)));
    if (layout::decode_label(image)->firmware_version != package.head.firmware_version)
      throw InputError(
          fmt::format("firmware package: the image for slot {} is of another version than the head says; "
                      "build the package again",
                      slot == 0 ? 'A' : 'B'));
  }
}

FirmwarePackage read_firmware(const std::filesystem::path& file) {
  const std::string bytes = read_file(file);
  FirmwarePackage p;
  p.bytes.assign(bytes.begin(), bytes.end());
  const auto head = layout::decode_package_head(p.bytes);
  if (const std::string what = not_asked_for({reinterpret_cast<const char*>(p.bytes.data()), p.bytes.size()},
                                             FileUse::kFirmware, file.string());
      !head && !what.empty())
    throw InputError(fmt::format("{}: is {}", file.string(), what));
  if (!head)
    throw InputError(
        fmt::format("{}: not a firmware package ({}); give triskin_firmware.tsf", file.string(),
                    head.error() == Status::kBadMagic ? "wrong first bytes" : session::describe(head.error())));
  p.head = *head;
  if (p.bytes.size() < p.head.total()) {
    throw InputError(fmt::format("{}: is cut off: {}, its head says {}; copy it again", file.string(),
                                 counted(p.bytes.size(), "byte"), p.head.total()));
  }
  for (int slot = 0; slot < 2; ++slot) {
    if (crc32(p.image(slot)) != p.head.crc[static_cast<std::size_t>(slot)]) {
      throw InputError(fmt::format("{}: the image for slot {} is damaged; copy it again", file.string(), slot));
    }
  }
  return p;
}

FirmwareResult update_firmware(session::Bus& bus, const wire::NodeClaim& who, const FirmwarePackage& package,
                               const UpdateOptions& options, const ProgressSink& progress) {
  require_fit(package, options.hardware);
  FirmwareResult result{session::to_text(who.unique_id), false, -1, 0};
  session::Controller controller(bus, who.node_address);
  const auto before = controller.image_state();
  result.equal = runs(before, package);
  if (before) result.slot = before->slot;
  if (!result.equal)
    require_newer_of_this_kind(controller, package, options,
                               fmt::format("{}: controller {}", bus.link().name(), result.serial));
  if (options.dry_run || (result.equal && !options.force)) return result;
  report(progress, "entering the loader", 0.0, result.serial);
  LoaderSession loader(bus, who.unique_id);
  const int slot = write_free_slot(loader, before, controller, package, [&](double fraction) {
    report(progress, "writing firmware", fraction, result.serial);
  });
  loader.leave();
  const auto after = controller.image_state();
  if (!runs(after, package) || after->slot != slot) {
    throw DeviceError(fmt::format("{}: controller {} has not started the new firmware; the old one runs",
                                  bus.link().name(), result.serial));
  }
  result.slot = slot;
  result.bytes = package.image(slot).size();
  return result;
}

}  // namespace triskin::deploy
