// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>

#include "triskin/jobs/verify.hpp"
#include "triskin/jobs/verify_report.hpp"

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

double unix_now_s() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

}  // namespace

Source read_source(const std::string& file, const triskin_options& options) {
  Source source{design::read_intact_design(file), {}};
  if (options.link != nullptr) source.link.link = options.link;
  if (options.scene != nullptr) source.link.scene = options.scene;
  source.link.own_interrupts = false;
  if (source.design.layout.modules.empty())
    throw InputError(fmt::format("{}: the design has no modules: there is nothing to read", file));
  return source;
}

Skin::Skin(Source source, const triskin_options& options)
    : design_(std::move(source.design)),
      stream_options_(stream_options(options)),
      queue_s_(options.queue_s),
      link_(device::open_link(source.link, &design_)),
      virtual_time_(source.link.link == "sim"),
      bus_(*link_),
      unix_start_s_(unix_now_s()),
      link_start_us_(bus_.now_us()),
      touches_(design_) {
  if (options.every < 0 || options.every > 255) throw InputError("every: must be 0 … 255");
  if (!(options.queue_s > 0.0 && options.queue_s <= 600.0))
    throw InputError("queue_s: must be above 0 and at most 600");
}

Skin::~Skin() {
  stop();
}

double Skin::unix_s(std::uint64_t link_us) const {
  const auto since_us = static_cast<std::int64_t>(link_us - link_start_us_);
  return unix_start_s_ + static_cast<double>(since_us) / kSecond_us;
}

double Skin::now_s() const {
  return unix_s(link_->now_us());
}

void Skin::start() {
  if (stream_) return;
  {
    const std::lock_guard lock(mutex_);
    waiting_.clear();
    counts_ = {};
    failure_ = nullptr;
    ending_ = false;
    running_ = true;
  }
  fresh_.clear();
  try {
    stream_ = std::make_unique<device::Stream>(
        bus_, design_, [this](const device::ModuleFrame& frame) { add(frame); }, stream_options_);
  } catch (...) {
    running_ = false;
    throw;
  }
  publish();
  started_ = true;
  if (!virtual_time_) thread_ = std::thread([this] { receive(); });
}

void Skin::add(const device::ModuleFrame& f) {
  triskin_sample s{};
  s.time_s = unix_s(f.sampled.link_us);
  s.error_s = f.sampled.error_us == device::LinkTime::kUnbounded ? std::numeric_limits<double>::infinity()
                                                                 : f.sampled.error_us / kSecond_us;
  s.device_time_us = f.sample.device_time_us;
  s.number = f.sample.sample;
  s.module = f.module;
  s.node = f.sample.node_address;
  s.valid = f.sample.valid;
  std::ranges::copy(f.sample.value, std::begin(s.value));
  fresh_.push_back(s);
  const std::lock_guard lock(mutex_);
  touches_.add(f);
}

void Skin::drop_old(double newest_s) {
  while (!waiting_.empty() && waiting_.front().time_s < newest_s - queue_s_) {
    waiting_.pop_front();
    ++counts_.lost_here;
  }
}

// What the slice brought, to those who wait for it.
void Skin::publish() {
  const device::StreamReport report = stream_->report();
  const std::lock_guard lock(mutex_);
  waiting_.insert(waiting_.end(), fresh_.begin(), fresh_.end());
  if (!fresh_.empty()) drop_old(fresh_.back().time_s);
  counts_.expected = report.total.expected;
  counts_.received = report.total.received;
  counts_.lost = report.total.lost();
  fresh_.clear();
  came_.notify_all();
}

void Skin::pass(std::uint64_t until_us) {
  stream_->run_until(until_us);
  publish();
}

// The thread of a link whose time passes by itself.
void Skin::receive() {
  while (true) {
    {
      const std::lock_guard lock(mutex_);
      if (ending_) return;
    }
    try {
      pass(bus_.now_us() + kSlice_us);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      failure_ = std::current_exception();
      running_ = false;
      came_.notify_all();
      return;
    }
  }
}

std::size_t Skin::read(double timeout_s, triskin_sample* samples, std::size_t capacity) {
  if (!(timeout_s >= 0.0 && timeout_s <= 3600.0)) throw InputError("timeout_s: must be 0 … 3600");
  if (!started_) start();  // after stop() what waits can be read, and nothing begins anew
  if (virtual_time_ && stream_) {
    const std::uint64_t end_us = bus_.now_us() + static_cast<std::uint64_t>(timeout_s * kSecond_us);
    while (waiting_.empty() && bus_.now_us() < end_us) pass(std::min(end_us, bus_.now_us() + kSlice_us));
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
  if (thread_.joinable()) thread_.join();
}

void Skin::stop() {
  if (!stream_) return;
  join();
  stream_->finish();
  publish();
  stream_.reset();
  running_ = false;
}

triskin_counts Skin::counts() {
  const std::lock_guard lock(mutex_);
  return counts_;
}

void Skin::tare() {
  start();
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::microseconds(kTare_us);
  const std::uint64_t before = counts().received, end_us = virtual_time_ ? bus_.now_us() + kTare_us : 0;
  {
    const std::lock_guard lock(mutex_);
    touches_.tare();
  }
  // Other taxels may have been there before: at least one sample of this tare, then until all have their rest.
  const auto done = [&] { return counts_.received > before && touches_.tared(); };
  if (virtual_time_) {
    while (!done() && bus_.now_us() < end_us) pass(bus_.now_us() + kSlice_us);
  } else {
    std::unique_lock lock(mutex_);
    came_.wait_until(lock, deadline, [&] { return done() || !running_; });
    if (failure_) std::rethrow_exception(failure_);
  }
  if (counts().received == before) throw DeviceError(bus_.name() + ": no sample came, so there is nothing to tare");
}

std::array<double, layout::kTaxelsPerModule> Skin::change_counts(int module) {
  const std::lock_guard lock(mutex_);
  return touches_.change(module);
}

std::pair<std::string, bool> Skin::verify() {
  if (stream_) throw InputError("verify: stop the stream first (triskin_stop)");
  const device::VerifyResult result = device::verify(bus_, design_, {});
  return {device::report_text(design_, result), !result.findings.empty()};
}

}  // namespace triskin::library
