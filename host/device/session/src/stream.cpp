// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/session/stream.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <random>
#include <utility>

#include "triskin/base/interrupt.hpp"
#include "triskin/link/link_kind.hpp"
#include "triskin/session/controller.hpp"
#include "triskin/session/patch_table.hpp"
#include "triskin/wire/stream_lease.hpp"

namespace triskin::session {
namespace {

constexpr std::uint8_t kLease_10ms = 100;
constexpr std::uint64_t kLease_us = std::uint64_t{kLease_10ms} * 10'000;
constexpr std::uint64_t kRenew_us = 200'000;
constexpr std::uint64_t kSlice_us = 50'000;     // Silent controllers are checked this often.
constexpr std::uint64_t kSilence_us = 400'000;  // A slice and this time together stay below half a second.
constexpr std::uint64_t kRest_us = 300'000;
constexpr std::uint64_t kAskClock_us = 1'000'000, kAskClockAgain_us = 100'000;
constexpr std::uint64_t kSettle_us = 2'000;  // A lease reaches the controllers within this time.
constexpr int kAttempts = 5;
constexpr std::size_t kMaxEarly = 512;  // 16 modules produce this many samples in 0.3 s; an answer takes far less.

// Other readers may share a bus, so the number is random. A simulation in this process has one reader at a time, and
// equal scenes must give equal frames, some of which repeat the number.
std::uint32_t draw_reader(const link::Link& link) {
  if (link::is_in_process(link.name())) return static_cast<std::uint32_t>(link.now_us()) | 1U;
  std::random_device random;
  std::uint32_t number = 0;
  while (number == 0) number = static_cast<std::uint32_t>(random());
  return number;
}

// An adopted module that is in several lists of one controller is reported as one row.
void add_adopted(std::vector<AdoptedCounts>& list, const AdoptedCounts& one) {
  const auto same = std::ranges::find_if(list, [&](const AdoptedCounts& a) {
    return a.module == one.module && a.patch == one.patch && a.cover == one.cover;
  });
  if (same == list.end())
    list.push_back(one);
  else
    same->counts += one.counts;
}

}  // namespace

Stream::Stream(Bus& bus, const design::Design& design, OnFrame handler, StreamOptions options)
    : Stream(bus, std::array{&design}, std::move(handler), std::move(options)) {}

Stream::Stream(Bus& bus, std::span<const design::Design* const> covers, OnFrame handler, StreamOptions options)
    : bus_(bus), handler_(std::move(handler)), say_(std::move(options.say)), reader_(draw_reader(bus.link())) {
  if (!bus.link().fd())
    throw InputError(fmt::format(
        "{}: carries classic frames only, and the full stream needs CAN FD; bring the interface up with fd on",
        bus.link().name()));
  for (const design::Design* design : covers) {
    covers_.push_back(design->name);
    ends_.push_back(design::module_ends(*design));
    find_controllers(*design, layout::CoverIndex{covers_.size() - 1}, options);
  }
  choose_rate(options);
  thrown_away_before_ = bus_.link().thrown_away();
  bus_.on_stream([this](const wire::CanFrame& frame) { handle(frame); });
  try {
    send_lease(kLease_10ms);
    for (auto& [address, node] : nodes_) begin(address, node);
  } catch (...) {
    bus_.on_stream({});
    give_back();
    throw;
  }
}

// If several covers share the bus, the name of a patch includes its cover.
std::string Stream::name_of(const Node& node) const {
  const std::string patch = fmt::format("patch {}", node.patch);
  return covers_.size() > 1 ? covers_[static_cast<std::size_t>(node.cover)] + ", " + patch : patch;
}

// Other readers would get their samples in another way without knowing why.
wire::SamplingSetting Stream::set_sampling(Controller& controller, const Node& node, const StreamOptions& options) {
  const wire::SamplingSetting before = controller.sampling();
  wire::SamplingSetting wanted = before;
  wanted.decimation = options.decimation.value_or(before.decimation);
  wanted.timing = options.timing.value_or(before.timing);
  if (wanted == before) return before;
  if (controller.stream_account().readers > 0) {
    throw DeviceError(
        fmt::format("{}: others read the controller of {} at decimation {}{}; end them first, or read at it",
                    bus_.link().name(), name_of(node), wire::readings_added(before.decimation),
                    before.timing == wire::SamplingTiming::kTimer ? ", by a timer" : ""));
  }
  controller.set_sampling(wanted);
  return wanted;
}

design::ModuleNumber Stream::number_of(const Node& node, layout::ModuleId module) const {
  if (module < 0) return {};
  return {numbers_.at(static_cast<std::size_t>(node.cover)).at(static_cast<std::size_t>(module))};
}

void Stream::find_controllers(const design::Design& design, layout::CoverIndex cover, const StreamOptions& options) {
  numbers_.resize(std::max(numbers_.size(), static_cast<std::size_t>(cover) + 1));
  numbers_[static_cast<std::size_t>(cover)] = design::all_numbers(design.layout);
  for (const layout::PatchIndex p : design::patches_here(design)) {
    const layout::PatchImage image = image_of(design, p);
    Node node;
    node.cover = cover;
    node.patch = p;
    Controller c(bus_, image.node_address);
    const wire::ActiveTable table = c.active_table();
    if (!table.present() || !holds_image(table.crc, image)) {
      throw DeviceError(
          fmt::format("{}: the controller of {} does not hold the table of this design; run triskin flash first",
                      bus_.link().name(), name_of(node)));
    }
    const wire::SamplingSetting sampling = set_sampling(c, node, options);
    node.interval_us = std::uint64_t{wire::sequence_us(sampling.decimation)} * sampling.every;
    for (const auto& row : image.rows()) node.modules.push_back(module_of(design, row));
    nodes_[image.node_address] = std::move(node);
  }
}

void Stream::choose_rate(const StreamOptions& options) {
  std::vector<StreamDemand> demands;
  for (const auto& [address, node] : nodes_) demands.push_back({address, node.modules.size(), node.interval_us});
  for (StreamDemand d : options.neighbours) {
    if (nodes_.contains(d.node)) continue;
    if (d.interval_us == 0) d.interval_us = wire::sequence_us(wire::Decimation::k256);
    demands.push_back(d);
  }
  budget_ = make_budget(bus_.link(), demands, options.every);
  if (!budget_.fits && !(options.every > 0 && options.overload)) {
    throw InputError(fmt::format("{}: {}{}", bus_.link().name(), describe(budget_),
                                 options.every > 0 ? " (--overload streams it all the same)" : ""));
  }
  if (budget_.every > 1 && options.every == 0 && say_) {
    say_(fmt::format("every sample would be {:.0f} % of the bus; {}", 100.0 * budget_.full, describe(budget_)));
  }
  for (auto& [address, node] : nodes_) {
    for (std::size_t k = 0; k < node.modules.size(); ++k) node.counts.emplace_back(budget_.every, node.interval_us);
  }
}

void Stream::send_lease(std::uint8_t lasts_10ms) {
  const auto pace = static_cast<std::uint16_t>(std::min<std::uint64_t>((budget_.pace_us + 99) / 100, UINT16_MAX));
  bus_.link().send(wire::encode_lease({reader_, lasts_10ms, static_cast<std::uint8_t>(budget_.every), pace}));
  renewed_us_ = bus_.now_us();
}

// The account shows whether the lease arrived; samples up to its number are not counted for this reader.
void Stream::begin(std::uint8_t address, Node& node) {
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    renew_when_due();
    node.asked_us = bus_.now_us();
    const wire::StreamAccount account = Controller(bus_, address).stream_account();
    node.clock.exchanged(node.asked_us, account.time_us, bus_.now_us());
    if (account.serves(reader_) && account.count == node.counts.size()) {
      for (std::size_t k = 0; k < node.counts.size(); ++k)
        node.counts[k].begin(account.starts, account.modules[k], bus_.now_us());
      node.begin_device_us = account.time_us;
      node.heard_us = bus_.now_us();
      node.started = true;
      for (const auto& [frame, heard_us] : std::exchange(node.early, {})) take(node, frame, heard_us);
      return;
    }
    if (account.readers == wire::kMaxLeases) break;
    send_lease(kLease_10ms);
    bus_.listen(bus_.now_us() + kSettle_us);
  }
  throw DeviceError(
      fmt::format("{}: controller {} takes no reader: {} read already is the most; end another program that reads, or "
                  "wait a second for one that died",
                  bus_.link().name(), address, wire::kMaxLeases));
}

Stream::~Stream() {
  finish();
}

void Stream::renew_when_due() {
  const std::uint64_t since_us = bus_.now_us() - renewed_us_;
  if (since_us > kLease_us) ++lapses_;
  if (since_us >= kRenew_us) send_lease(kLease_10ms);
}

void Stream::run_until(std::uint64_t until_us) {
  do {
    renew_when_due();
    bus_.listen(std::min(until_us, bus_.now_us() + kSlice_us));
    bus_.poll();
    watch();
    ask_clocks();
    ask_adopted();
  } while (bus_.now_us() < until_us);
}

// Asks only the controllers that are due, and at most a share of them in a slice, so that their answers do not all come
// at once.
void Stream::ask_clocks() {
  const std::size_t share = 1 + nodes_.size() * kSlice_us / kAskClock_us;
  std::size_t asked = 0;
  for (auto& [address, node] : nodes_) {
    const std::uint64_t wait_us = node.clock.bounded() ? kAskClock_us : kAskClockAgain_us;
    if (node.silent || bus_.now_us() - node.asked_us < wait_us) continue;
    renew_when_due();
    ask_clock(address, node);
    if (++asked >= share) return;
  }
}

// A lost answer does not matter, because the next question follows in a second and the bound shows how good the time is
// until then.
void Stream::ask_clock(std::uint8_t address, Node& node) {
  constexpr std::array<std::uint8_t, 3> kAsk{wire::service::kRead, wire::did::kStreamAccount >> 8,
                                             wire::did::kStreamAccount & 0xFF};
  node.asked_us = bus_.now_us();
  try {
    const Bus::Message answer = bus_.request(address, kAsk, Bus::Repeat::kNever);
    const auto account =
        answer.size() > 2 ? wire::StreamAccount::decode(Bytes(answer).subspan(2)) : std::unexpected(Status::kTooShort);
    if (account) node.clock.exchanged(node.asked_us, account->time_us, bus_.now_us());
  } catch (const NoAnswer&) {
  } catch (const Refused&) {
  }
}

// Two samples of a controller may be more than half a second apart if the reader asked for few.
std::uint64_t Stream::silence_us(const Node& node) const {
  return std::max(kSilence_us,
                  3 * std::max(budget_.pace_us, node.interval_us * static_cast<std::uint64_t>(budget_.every)));
}

void Stream::watch() {
  for (auto& [address, node] : nodes_) {
    const bool silent = bus_.now_us() - node.heard_us > silence_us(node);
    if (silent == node.silent) continue;
    node.silent = silent;
    if (say_)
      say_(silent ? fmt::format("{}: its controller {} is silent; check power and cable", name_of(node), address)
                  : fmt::format("{}: its controller {} speaks again", name_of(node), address));
  }
}

void Stream::handle(const wire::CanFrame& frame) {
  const auto decoded = wire::decode_full(frame);
  if (!decoded) return;
  const auto found = nodes_.find(decoded->node_address);
  if (found == nodes_.end()) return;
  Node& node = found->second;
  // The answer that begins the account has several frames; samples that it does not count may arrive between them.
  if (!node.started) {
    if (node.early.size() == kMaxEarly) node.early.pop_front();
    node.early.emplace_back(*decoded, bus_.now_us());
    return;
  }
  take(node, *decoded, bus_.now_us());
}

void Stream::take(Node& node, const wire::TaxelFrame& sample, std::uint64_t heard_us) {
  node.heard_us = std::max(node.heard_us, heard_us);
  if (sample.module >= node.modules.size()) return take_adopted(node, sample, heard_us);
  if (!node.counts[sample.module].add(sample, heard_us)) return;
  ++frames_;
  // The module's own controller cannot reach it; the controller that reads it knows more.
  if (sample.valid == 0 && read_by_another(node, node.modules[sample.module])) return;
  node.clock.arrived(sample.device_time_us, heard_us);
  node.newest_device_us = sample.device_time_us;
  if (handler_)
    handler_(
        {node.modules[sample.module], heard_us, sample, node.cover, node.clock.at(sample.device_time_us, heard_us)});
}

void Stream::take_adopted(Node& node, const wire::TaxelFrame& sample, std::uint64_t heard_us) {
  const layout::ModuleId module = node.adopted_modules.add(sample.module - node.modules.size(), sample, heard_us);
  if (module < 0) return;
  ++frames_;
  if (handler_)
    handler_({module, heard_us, sample, node.cover, node.clock.at(sample.device_time_us, heard_us), node.patch});
}

bool Stream::read_by_another(const Node& node, layout::ModuleId module) const {
  const std::uint64_t since_us = bus_.now_us() - std::min(bus_.now_us(), silence_us(node));
  return std::ranges::any_of(nodes_, [&](const auto& entry) {
    return entry.second.cover == node.cover && entry.second.adopted_modules.reads(module, since_us);
  });
}

// Samples of adopted modules have arrived whose list is not known here.
void Stream::ask_adopted() {
  for (auto& [address, node] : nodes_) {
    if (!node.adopted_modules.wants_list() || node.silent) continue;
    wire::Adoption adoption;
    try {
      adoption = Controller(bus_, address).adoption();
    } catch (const NoAnswer&) {
      continue;  // The next slice repeats the question.
    }
    const auto modules = adopted_modules(ends_[static_cast<std::size_t>(node.cover)], node.modules, adoption);
    for (const auto& [sample, heard_us] : node.adopted_modules.set(adoption, modules, budget_.every, node.interval_us))
      take_adopted(node, sample, heard_us);
  }
}

// A silent controller is asked only once, because five attempts would take seconds.
void Stream::end(std::uint8_t address, Node& node) {
  const bool is_silent = bus_.now_us() - node.heard_us > silence_us(node);
  try {
    // A person who ends the stream should not wait for each silent controller.
    if (is_silent && interrupt_request()) throw Cancelled("");
    if (is_silent) {
      (void)bus_.request(address, std::array<std::uint8_t, 2>{wire::service::kTesterPresent, 0}, Bus::Repeat::kNever);
    }
    const wire::StreamAccount account = Controller(bus_, address).stream_account();
    for (std::size_t k = 0; k < node.counts.size() && k < account.count; ++k)
      node.counts[k].end(account.starts, account.modules[k], bus_.now_us());
    if (account.time_us > node.begin_device_us)
      node.due = (account.time_us - node.begin_device_us) / node.interval_us / static_cast<unsigned>(budget_.every);
  } catch (const Error&) {
    node.silent = true;
    for (SampleAccount& c : node.counts) c.end_silent(bus_.now_us());
  }
}

void Stream::wait_for_rest() {
  const std::uint64_t until_us = bus_.now_us() + kRest_us + 3 * budget_.pace_us;
  const auto waiting = [](const auto& entry) {
    return !entry.second.silent && !std::ranges::all_of(entry.second.counts, &SampleAccount::complete);
  };
  while (bus_.now_us() < until_us && std::ranges::any_of(nodes_, waiting)) {
    renew_when_due();
    bus_.listen(std::min(until_us, bus_.now_us() + kSlice_us / 10));
  }
}

void Stream::finish() {
  if (finished_) return;
  finished_ = true;
  const Bus::Uninterrupted guard(bus_);
  try {
    renew_when_due();
    for (auto& [address, node] : nodes_) end(address, node);
    wait_for_rest();
  } catch (const Error&) {  // The link is gone, so no account can be read.
    for (auto& [address, node] : nodes_) {
      for (SampleAccount& c : node.counts) c.end_silent(bus_.now_us());
    }
  }
  give_back();
  bus_.on_stream({});
}

// If the link does not work, the lease expires by itself.
void Stream::give_back() {
  try {
    send_lease(0);
  } catch (const Error&) {
    return;
  }
}

StreamReport Stream::report_of(layout::CoverIndex cover) const {
  StreamReport r;
  for (const auto& [address, node] : nodes_) {
    if (cover != kAllCovers && node.cover != cover) continue;
    for (std::size_t k = 0; k < node.counts.size(); ++k) {
      const SampleCounts c = node.counts[k].counts();
      const bool slow = 10 * (c.expected + 2) < 9 * node.due;
      r.modules.push_back({node.modules[k], node.patch, c, slow, node.cover, number_of(node, node.modules[k])});
    }
    for (const AdoptedReader::Read& g : node.adopted_modules.all()) {
      const bool now = node.adopted_modules.reads(g.module, bus_.now_us() - std::min(bus_.now_us(), silence_us(node)));
      add_adopted(r.adopted, {g.module, node.patch, g.counts.counts(), now, node.cover, number_of(node, g.module)});
    }
    if (node.silent) r.silent.push_back(node.patch);
    r.clocks.push_back({node.cover, node.patch, address, node.clock.drift_ppm(),
                        node.clock.at(node.newest_device_us).error_us, node.clock.restarts()});
  }
  r.lapses = lapses_;
  r.budget = budget_;
  sum_up(r, bus_.link().thrown_away() - thrown_away_before_);
  return r;
}

}  // namespace triskin::session
