// SPDX-License-Identifier: GPL-3.0-or-later
#include "touch_finder.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "triskin/layout/module.hpp"
#include "triskin/layout/taxel_signal.hpp"
#include "triskin/session/patch_table.hpp"

namespace triskin::deploy {
namespace {

constexpr std::uint64_t kLook_us = 50'000;
constexpr std::uint64_t kSample_us = 85'000;  // A conversion and a reading fit into this time.
constexpr std::uint64_t kMaxOffsets_us = 1'500'000;
// The limit applies to the sum over the taxels of a module: three of them are pressed, or one more firmly.
constexpr double kFelt_counts = 3.0 * layout::kPressed_counts;
constexpr double kClearly = 3.0;  // The touched board must respond this many times more strongly than any other.
constexpr int kLooks = 2;         // One reading may be a glitch, so two in a row must agree.

// Makes a table for the chips that answer, without joints: strapped modules may have any tree.
layout::PatchImage image_of_answers(const BoardShape& shape) {
  layout::PatchImage image;
  for (std::size_t slot = 0; slot < layout::kMaxModules; ++slot) {
    const std::size_t line = slot / layout::kAddressesPerLine, address = slot % layout::kAddressesPerLine;
    if ((shape.answers.at(line) >> address & 1) == 0) continue;
    const std::size_t k = image.module_count++;
    layout::ModuleRow& row = image.modules[k];
    row.module_id = static_cast<std::uint16_t>(slot);
    row.line = static_cast<std::uint8_t>(line);
    row.address = static_cast<std::uint8_t>(address);
    if (k == 0) continue;
    row.parent = static_cast<std::uint8_t>((k - 1) / 2);
    row.parent_port = static_cast<std::uint8_t>(1 + (k - 1) % 2);
  }
  return image;
}

// Keeps only the module at the cable, because no other controller needs it on the way to its own modules.
void keep_entry_alone(layout::PatchImage& image) {
  layout::ModuleRow entry = image.modules[0];
  entry.joints = {};
  image.modules = {};
  image.modules[0] = entry;
  image.module_count = 1;
  image.second_entry = 0;
}

// Returns the table that makes a board sample what it sees; it has no module if the board sees none of this design.
layout::PatchImage image_to_feel(const FeelingBoard& board, const design::Design& design) {
  layout::PatchImage image;
  if (!board.shape.switched) image = image_of_answers(board.shape);
  if (board.shape.switched && !board.likely.empty()) image = session::image_of(design, board.likely.front());
  if (board.across && image.module_count > 0) keep_entry_alone(image);
  return image;
}

bool searching(const wire::Offsets& offsets) {
  return std::ranges::any_of(offsets.rows(), [](const wire::ModuleOffsets& m) {
    return m.state == wire::OffsetState::kNone || m.state == wire::OffsetState::kSearching;
  });
}

}  // namespace

TouchFinder::TouchFinder(session::Bus& bus, const design::Design& design, std::vector<FeelingBoard> boards,
                         const IdentifyOptions& options)
    : bus_(bus), design_(design), options_(options) {
  for (FeelingBoard& b : boards) probes_.push_back({std::move(b), false, false, {}});
  const bool any_across = std::ranges::any_of(probes_, [](const Probe& p) { return p.board.across; });
  if (any_across && options_.say)
    options_.say("the patches are joined across their borders: press the module at which the cable is plugged in");
  for (Probe& p : probes_) let_sample(p);
  settle();
}

void TouchFinder::let_sample(Probe& probe) {
  session::Controller controller(bus_, probe.board.claim.node_address);
  const wire::ActiveTable table = controller.active_table();
  probe.samples = table.present() && table.design_id != session::kIdentifyDesign;
  if (probe.samples) return;
  layout::PatchImage image = image_to_feel(probe.board, design_);
  if (image.module_count == 0) {
    if (options_.say)
      options_.say(fmt::format("controller {} is left out: {}", session::to_text(probe.board.claim.unique_id),
                               probe.board.shape.switched ? "its modules are those of no patch of the design"
                                                          : "no chip answers at its lines"));
    return;
  }
  image.design_id = session::kIdentifyDesign;
  image.node_address = probe.board.claim.node_address;
  controller.write_table(session::bytes_of(image), {});
  probe.samples = true;
}

// Waits, because taxels drift while the offsets of their converters are being searched.
void TouchFinder::settle() {
  const std::uint64_t end_us = bus_.now_us() + kMaxOffsets_us;
  const auto busy = [&](const Probe& p) {
    return p.samples && searching(session::Controller(bus_, p.board.claim.node_address).offsets());
  };
  while (bus_.now_us() < end_us && std::ranges::any_of(probes_, busy)) bus_.listen(bus_.now_us() + 2 * kLook_us);
  bus_.listen(bus_.now_us() + kSample_us);
}

void TouchFinder::take_rest() {
  for (Probe& p : probes_) {
    if (p.samples) p.rest = session::Controller(bus_, p.board.claim.node_address).taxels();
  }
}

// Pressure lowers a value, so the release of an earlier press does not count.
double TouchFinder::strength(const Probe& probe) const {
  const wire::LiveTaxels now = session::Controller(bus_, probe.board.claim.node_address).taxels();
  double most = 0.0;
  for (std::size_t row = 0; row < std::min(now.count, probe.rest.count); ++row) {
    double sum = 0.0;
    for (std::size_t t = 0; t < layout::kTaxelsPerModule; ++t) {
      const bool known = now.modules[row].is_valid(t) && probe.rest.modules[row].is_valid(t);
      if (known && layout::measures_pressure(t))
        sum += std::max(0.0, static_cast<double>(probe.rest.modules[row].value[t]) - now.modules[row].value[t]);
    }
    most = std::max(most, sum);
  }
  return most;
}

// `doubtful` becomes true when two boards feel the touch.
std::optional<std::size_t> TouchFinder::felt(bool& doubtful) {
  std::size_t best = 0;
  double strongest = 0.0, second = 0.0;
  for (std::size_t k = 0; k < probes_.size(); ++k) {
    if (!probes_[k].samples || probes_[k].found) continue;
    const double s = strength(probes_[k]);
    if (s > strongest) {
      second = strongest;
      strongest = s;
      best = k;
    } else {
      second = std::max(second, s);
    }
  }
  doubtful = strongest >= kFelt_counts && strongest < kClearly * second;
  if (strongest < kFelt_counts || doubtful) return std::nullopt;
  return best;
}

std::optional<std::size_t> TouchFinder::wait(std::uint64_t until_us) {
  std::optional<std::size_t> last;
  bool told = false;
  // A look at eighty boards takes longer than a press is waited for, so there are always enough looks.
  for (int looks = 0, looked = 0; bus_.now_us() < until_us || looked < 2 * kLooks; ++looked) {
    bus_.listen(bus_.now_us() + kLook_us);
    bool doubtful = false;
    const auto now = felt(doubtful);
    if (doubtful && !told && options_.say) {
      options_.say("two patches are touched at once; lift the hand and press one module");
      told = true;
    }
    looks = now && now == last ? looks + 1 : (now ? 1 : 0);
    last = now;
    if (looks >= kLooks) return now;
  }
  return std::nullopt;
}

// Presses several modules of the patch, because the first one may be dead.
std::optional<std::size_t> TouchFinder::press(link::TouchActuator& actuator, layout::PatchIndex patch) {
  for (const design::RoutedModule& m : design_.patches.at(static_cast<std::size_t>(patch)).modules) {
    actuator.press(layout::ModuleId{m.node});
    bus_.listen(bus_.now_us() + kSample_us);
    const auto board = wait(bus_.now_us() + 4 * kLook_us);
    actuator.lift();
    bus_.listen(bus_.now_us() + kSample_us);
    if (board) return board;
    take_rest();
  }
  return std::nullopt;
}

std::optional<std::size_t> TouchFinder::find(layout::PatchIndex patch) {
  take_rest();
  if (options_.ask) options_.ask(patch);
  const auto board = options_.actuator != nullptr
                         ? press(*options_.actuator, patch)
                         : wait(bus_.now_us() + static_cast<std::uint64_t>(options_.limit_s * 1e6));
  if (board) probes_[*board].found = true;
  return board;
}

}  // namespace triskin::deploy
