// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/skin/sample_queue.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "triskin/base/error.hpp"
#include "triskin/base/interrupt.hpp"

namespace triskin::skin {
namespace {

constexpr std::uint64_t kQueueSlice_us = 20'000;

bool any_cover(const LiveBus& bus, Tare::State state) {
  return std::ranges::any_of(bus.covers(), [=](const LiveCover& c) { return c.tare().state() == state; });
}

}  // namespace

SampleQueue::SampleQueue(LiveSkin& skin, std::vector<layout::SkinModule> first_modules, std::size_t modules,
                         double keep_s, bool virtual_time)
    : skin_(skin),
      first_modules_(std::move(first_modules)),
      keep_ns_(static_cast<std::uint64_t>(keep_s * 1e9)),
      virtual_time_(virtual_time),
      fresh_(skin.buses().size()),
      change_counts_(modules),
      by_bus_(skin.buses().size()),
      tare_(skin.buses().size(), TareStep::kNone) {}

SampleQueue::~SampleQueue() {
  stop();
}

bool SampleQueue::runs() const {
  return skin_.buses().front()->runs() || !threads_.empty();
}

void SampleQueue::take(std::size_t bus, const LiveSample& s) {
  const LiveCover& cover = skin_.buses()[bus]->covers()[static_cast<std::size_t>(s.cover)];
  const layout::SkinModule module{first_modules_[static_cast<std::size_t>(cover.config().cover)] + s.module};
  fresh_[bus].push_back({module, s.unix_ns, s.error_us, s.raw.sample});
  const std::lock_guard lock(mutex_);
  change_counts_[static_cast<std::size_t>(module)] = s.change_counts;
}

void SampleQueue::start_bus(LiveBus& bus, const session::StreamOptions& options) {
  fresh_[bus.index()].clear();
  bus.start(options, [this, b = bus.index()](const LiveSample& s) { take(b, s); });
}

void SampleQueue::start(const session::StreamOptions& options) {
  if (runs()) return;
  {
    const std::lock_guard lock(mutex_);
    waiting_.clear();
    by_bus_.assign(by_bus_.size(), {});
    dropped_ = 0;
    failure_ = nullptr;
    ending_ = false;
    running_ = true;
  }
  try {
    for (const auto& bus : skin_.buses()) start_bus(*bus, options);
  } catch (...) {
    for (const auto& bus : skin_.buses()) bus->finish();
    running_ = false;
    throw;
  }
  for (std::size_t b = 0; b < fresh_.size(); ++b) publish(b);
  started_ = true;
  if (virtual_time_) return;
  for (std::size_t b = 0; b < fresh_.size(); ++b) threads_.emplace_back([this, b] { receive(b); });
}

void SampleQueue::drop_old(std::uint64_t newest_ns) {
  while (!waiting_.empty() && waiting_.front().unix_ns + keep_ns_ < newest_ns) {
    waiting_.pop_front();
    ++dropped_;
  }
}

// Moves the samples of the slice into the queue and wakes waiting readers.
void SampleQueue::publish(std::size_t bus) {
  const LiveBus& live = *skin_.buses()[bus];
  const session::SampleCounts counts = live.report().total;
  std::vector<QueuedSample>& fresh = fresh_[bus];
  const std::lock_guard lock(mutex_);
  waiting_.insert(waiting_.end(), fresh.begin(), fresh.end());
  if (!fresh.empty()) drop_old(fresh.back().unix_ns);
  by_bus_[bus] = counts;
  fresh.clear();
  if (tare_[bus] == TareStep::kRunning && !any_cover(live, Tare::State::kRunning))
    tare_[bus] = any_cover(live, Tare::State::kDone) || any_cover(live, Tare::State::kIncomplete) ? TareStep::kEnded
                                                                                                  : TareStep::kNoSample;
  came_.notify_all();
}

void SampleQueue::pass(std::size_t bus, std::uint64_t slice_us) {
  LiveBus& live = *skin_.buses()[bus];
  {
    const std::lock_guard lock(mutex_);
    if (tare_[bus] == TareStep::kAsked) {
      for (LiveCover& cover : live.covers()) cover.begin_tare(live.now_us());
      tare_[bus] = TareStep::kRunning;
    }
  }
  live.run({live.now_us() + slice_us, slice_us, {}, {}});
  if (interrupt_request()) throw Cancelled(live.bus().name() + ": ended on request");
  publish(bus);
}

// Advances the simulated buses of this process together.
void SampleQueue::pass_all(std::uint64_t slice_us) {
  for (std::size_t b = 0; b < fresh_.size(); ++b) pass(b, slice_us);
}

// Runs in the thread of a bus in real time. If one bus fails, all end.
void SampleQueue::receive(std::size_t bus) {
  while (true) {
    {
      const std::lock_guard lock(mutex_);
      if (ending_) return;
    }
    try {
      pass(bus, kQueueSlice_us);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!failure_) failure_ = std::current_exception();
      running_ = false;
      ending_ = true;
      came_.notify_all();
      return;
    }
  }
}

std::vector<QueuedSample> SampleQueue::read(double timeout_s, std::size_t capacity) {
  if (virtual_time_ && runs()) {
    const LiveBus& first = *skin_.buses().front();
    const std::uint64_t end_us = first.now_us() + static_cast<std::uint64_t>(timeout_s * 1e6);
    while (waiting_.empty() && first.now_us() < end_us) pass_all(std::min(end_us - first.now_us(), kQueueSlice_us));
  }
  std::unique_lock lock(mutex_);
  if (!virtual_time_)
    came_.wait_for(lock, std::chrono::duration<double>(timeout_s), [this] { return !waiting_.empty() || !running_; });
  if (waiting_.empty() && failure_) std::rethrow_exception(failure_);
  const auto end = waiting_.begin() + static_cast<std::ptrdiff_t>(std::min(capacity, waiting_.size()));
  std::vector<QueuedSample> samples(waiting_.begin(), end);
  waiting_.erase(waiting_.begin(), end);
  return samples;
}

void SampleQueue::join() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  for (std::thread& thread : threads_) thread.join();
  threads_.clear();
}

void SampleQueue::stop() {
  if (!runs()) return;
  join();
  for (const auto& bus : skin_.buses()) {
    bus->finish();
    publish(bus->index());
  }
  running_ = false;
}

session::SampleCounts SampleQueue::counts() {
  const std::lock_guard lock(mutex_);
  session::SampleCounts all;
  for (const session::SampleCounts& bus : by_bus_) all += bus;
  return all;
}

std::uint64_t SampleQueue::dropped() {
  const std::lock_guard lock(mutex_);
  return dropped_;
}

bool SampleQueue::tare_runs() const {
  return std::ranges::any_of(tare_, [](TareStep t) { return t == TareStep::kAsked || t == TareStep::kRunning; });
}

void SampleQueue::tare() {
  {
    const std::lock_guard lock(mutex_);
    tare_.assign(tare_.size(), TareStep::kAsked);
    for (auto& module : change_counts_) module.fill(0.0);
  }
  while (virtual_time_ && tare_runs()) pass_all(kQueueSlice_us);
  std::unique_lock lock(mutex_);
  came_.wait(lock, [this] { return !tare_runs() || !running_; });
  if (failure_) std::rethrow_exception(failure_);
  if (std::ranges::all_of(tare_, [](TareStep t) { return t == TareStep::kNoSample; }))
    throw DeviceError(skin_.buses().front()->bus().name() + ": no sample came, so there is nothing to tare");
}

std::array<double, layout::kTaxelsPerModule> SampleQueue::change_counts(layout::SkinModule module) {
  const std::lock_guard lock(mutex_);
  return change_counts_.at(static_cast<std::size_t>(module));
}

}  // namespace triskin::skin
