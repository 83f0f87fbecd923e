// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <utility>

#include "triskin/base/error.hpp"
#include "triskin/robot/assembly.hpp"

namespace triskin::library {
namespace {

constexpr std::uint64_t kSlice_us = 20'000, kTare_us = 2'000'000;
constexpr double kSecond_us = 1e6;

device::StreamOptions stream_options(const triskin_options& options) {
  device::StreamOptions s;
  s.every = options.every;
  s.overload = options.overload != 0;
  return s;
}

device::LinkOptions link_options(const triskin_options& options) {
  device::LinkOptions link;
  link.chosen = options.link != nullptr;
  // As on the command line: a named link, else the environment, else a scene asks for the simulation.
  const char* named = std::getenv("TRISKIN_LINK");
  if (link.chosen)
    link.link = options.link;
  else if (named != nullptr && *named != '\0')
    link.link = named;
  else if (options.scene != nullptr)
    link.link = "sim";
  if (options.scene != nullptr) link.scene = options.scene;
  link.own_interrupts = false;
  return link;
}

// The time of simulations in this process passes when somebody waits, that of all others by itself.
bool has_virtual_time(const Source& source) {
  std::size_t here = 0;
  const bool by_file = source.site.is_robot && !source.link.chosen;
  for (const robot::BusConfig& bus : source.site.buses)
    here += device::is_in_process(by_file ? bus.link : source.link.link) ? 1 : 0;
  if (here != 0 && here != source.site.buses.size())
    throw InputError(fmt::format(
        "{}: some buses are simulated in this process and some are not; open it with the link sim, or serve "
        "the simulation by triskin simulate",
        source.site.file.string()));
  return here != 0;
}

}  // namespace

Source read_source(const std::string& file, const triskin_options& options) {
  Source source{robot::read_site(file), {}, {}, {}, link_options(options)};
  if (source.site.is_robot) {
    const robot::Assembly assembly = robot::read_assembly(file);
    design::SideBySide joint = robot::in_base(assembly);
    source.design = std::move(joint.design);
    source.offsets = std::move(joint.offsets);
    for (const robot::CoverEntry& cover : assembly.robot.covers) source.covers.push_back(cover.name);
  } else {
    source.design = source.site.buses.front().covers.front().design;
    source.offsets.emplace_back();
    source.covers.push_back(source.design.name);
  }
  if (source.design.layout.modules.empty())
    throw InputError(fmt::format("{}: the design has no modules: there is nothing to read", file));
  return source;
}

Skin::Skin(Source source, const triskin_options& options)
    : source_(std::move(source)),
      stream_options_(stream_options(options)),
      queue_s_(options.queue_s),
      virtual_time_(has_virtual_time(source_)),
      touches_(source_.design) {
  if (options.every < 0 || options.every > 255) throw InputError("every: must be 0 … 255");
  if (!(options.queue_s > 0.0 && options.queue_s <= 600.0))
    throw InputError("queue_s: must be above 0 and at most 600");
  for (std::size_t b = 0; b < source_.site.buses.size(); ++b) buses_.push_back(std::make_unique<BusReader>(source_, b));
  fresh_.resize(buses_.size());
  by_bus_.resize(buses_.size());
}

Skin::~Skin() {
  stop();
}

void Skin::start() {
  if (runs()) return;
  {
    const std::lock_guard lock(mutex_);
    waiting_.clear();
    by_bus_.assign(buses_.size(), {});
    lost_here_ = 0;
    failure_ = nullptr;
    ending_ = false;
    running_ = true;
  }
  try {
    if (!started_) {
      for (const auto& bus : buses_) bus->set_rest(touches_);
    }
    for (std::size_t b = 0; b < buses_.size(); ++b) {
      fresh_[b].clear();
      buses_[b]->start(stream_options_, [this, b](const triskin_sample& sample, const device::ModuleSample& frame) {
        fresh_[b].push_back(sample);
        const std::lock_guard lock(mutex_);
        touches_.add(frame);
      });
    }
  } catch (...) {
    for (const auto& bus : buses_) bus->stop();
    running_ = false;
    throw;
  }
  for (std::size_t b = 0; b < buses_.size(); ++b) publish(b);
  started_ = true;
  if (virtual_time_) return;
  for (std::size_t b = 0; b < buses_.size(); ++b) threads_.emplace_back([this, b] { receive(b); });
}

void Skin::drop_old(double newest_s) {
  while (!waiting_.empty() && waiting_.front().time_s < newest_s - queue_s_) {
    waiting_.pop_front();
    ++lost_here_;
  }
}

// Hands the samples of the slice to the readers that wait.
void Skin::publish(std::size_t bus) {
  const device::SampleCounts counts = buses_[bus]->counts();
  std::vector<triskin_sample>& fresh = fresh_[bus];
  const std::lock_guard lock(mutex_);
  waiting_.insert(waiting_.end(), fresh.begin(), fresh.end());
  if (!fresh.empty()) drop_old(fresh.back().time_s);
  by_bus_[bus] = counts;
  fresh.clear();
  came_.notify_all();
}

void Skin::pass(std::size_t bus, std::uint64_t until_us) {
  buses_[bus]->run_until(until_us);
  publish(bus);
}

// The simulated buses of this process, side by side.
void Skin::pass_all(std::uint64_t slice_us) {
  for (std::size_t b = 0; b < buses_.size(); ++b) pass(b, buses_[b]->now_us() + slice_us);
}

// The thread of a bus whose time passes by itself. When one fails all end.
void Skin::receive(std::size_t bus) {
  while (true) {
    {
      const std::lock_guard lock(mutex_);
      if (ending_) return;
    }
    try {
      pass(bus, buses_[bus]->now_us() + kSlice_us);
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

std::size_t Skin::read(double timeout_s, triskin_sample* samples, std::size_t capacity) {
  if (!(timeout_s >= 0.0 && timeout_s <= 3600.0)) throw InputError("timeout_s: must be 0 … 3600");
  if (!started_) start();  // After stop(), waiting samples can be read, and sampling does not begin anew.
  if (virtual_time_ && runs()) {
    const std::uint64_t end_us = buses_.front()->now_us() + static_cast<std::uint64_t>(timeout_s * kSecond_us);
    for (std::uint64_t now_us = buses_.front()->now_us(); waiting_.empty() && now_us < end_us;
         now_us = buses_.front()->now_us())
      pass_all(std::min(end_us - now_us, kSlice_us));
  }
  std::unique_lock lock(mutex_);
  if (!virtual_time_)
    came_.wait_for(lock, std::chrono::duration<double>(timeout_s), [this] { return !waiting_.empty() || !running_; });
  if (waiting_.empty() && failure_) std::rethrow_exception(failure_);
  const std::size_t n = std::min(capacity, waiting_.size());
  const auto end = waiting_.begin() + static_cast<std::ptrdiff_t>(n);
  std::copy(waiting_.begin(), end, samples);
  waiting_.erase(waiting_.begin(), end);
  return n;
}

void Skin::join() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  for (std::thread& thread : threads_) thread.join();
  threads_.clear();
}

void Skin::stop() {
  if (buses_.empty() || !runs()) return;
  join();
  for (std::size_t b = 0; b < buses_.size(); ++b) {
    buses_[b]->stop();
    publish(b);
  }
  running_ = false;
}

triskin_counts Skin::counts() {
  const std::lock_guard lock(mutex_);
  device::SampleCounts all;
  for (const device::SampleCounts& bus : by_bus_) all += bus;
  return {.expected = all.expected, .received = all.received, .lost = all.lost(), .lost_here = lost_here_};
}

void Skin::tare() {
  start();
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::microseconds(kTare_us);
  const std::uint64_t before = counts().received, end_us = buses_.front()->now_us() + kTare_us;
  {
    const std::lock_guard lock(mutex_);
    touches_.tare();
  }
  // Other taxels may have been there before: at least one sample of this tare, then until all have their rest.
  const auto received = [&] {
    std::uint64_t sum = 0;
    for (const device::SampleCounts& bus : by_bus_) sum += bus.received;
    return sum;
  };
  const auto done = [&] { return received() > before && touches_.tared(); };
  if (virtual_time_) {
    while (!done() && buses_.front()->now_us() < end_us) pass_all(kSlice_us);
  } else {
    std::unique_lock lock(mutex_);
    came_.wait_until(lock, deadline, [&] { return done() || !running_; });
    if (failure_) std::rethrow_exception(failure_);
  }
  if (counts().received == before)
    throw DeviceError(buses_.front()->name() + ": no sample came, so there is nothing to tare");
}

std::array<double, layout::kTaxelsPerModule> Skin::change_counts(int module) {
  const std::lock_guard lock(mutex_);
  return touches_.change(module);
}

std::vector<ModuleCalibration> Skin::calibration() {
  if (runs()) throw InputError("calibration: stop the stream first (triskin_stop)");
  std::vector<ModuleCalibration> modules(source_.design.layout.modules.size());
  for (const auto& bus : buses_) bus->calibrate(modules);
  return modules;
}

std::pair<std::string, bool> Skin::verify() {
  if (runs()) throw InputError("verify: stop the stream first (triskin_stop)");
  std::string report;
  bool good = true;
  for (const auto& bus : buses_) good = bus->verify(report) && good;
  return {std::move(report), !good};
}

}  // namespace triskin::library
