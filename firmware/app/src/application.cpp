// SPDX-License-Identifier: Apache-2.0
#include "triskin/app/application.hpp"

#include <algorithm>
#include <new>

namespace triskin::fw {

using wire::ModuleState;
using wire::StreamMode;

namespace {

// After this time a serial port of 115,200 baud has sent half of the bytes in its FIFO.
constexpr std::uint64_t kSerialRoom_us = 350;

wire::IsoTp make_link(std::uint8_t node, std::uint8_t frame_bytes) {
  return {wire::physical_id(wire::kTesterAddress, node), wire::physical_id(node, wire::kTesterAddress), frame_bytes};
}

}  // namespace

Application::Application(const Ports& ports)
    : ports_(ports),
      tables_(*ports.flash),
      server_(*this, tables_),
      faults_(*ports.flash),
      offset_store_(*ports.flash),
      channels_{{{ports.can, make_link(1, 8)}, {ports.usb, make_link(1, 8)}}},
      asking_(ports.can),
      stream_port_(ports.can),
      route_(ports.chain),
      serial_log_(ports.serial),
      identifiers_(parts(), *this),
      journal_(log_, parts()) {
  restart();
}

PatchParts Application::parts() const {
  return {ports_,   tables_, faults_,   route_,  lines_,        samples_, published_,
          offsets_, stream_, sampling_, output_, sample_count_, icub_};
}

// Restores the state after power-up: the newest table is active, and nothing is known about the modules.
void Application::restart() {
  tables_.load();
  faults_.load();
  offset_store_.load(offsets_);
  for (Channel& c : channels()) {
    // The link is constructed in place, because a copy would take two kilobytes of the stack.
    ::new (static_cast<void*>(&c.link)) wire::IsoTp(make_link(tables_.node_address(), c.port->frame_bytes()));
    c.held.reset();
  }
  if (stream_ == StreamMode::kIcub && !wire::icub::is_board(tables_.node_address())) stream_ = StreamMode::kOff;
  restart_sampling();
}

void Application::restart_sampling() {
  forget_samples(0);
  ++starts_;
  for (Channel& c : channels()) c.stream.restart(starts_);
  icub_triangles_.calibrate();
  route_.begin(tables_.has_table() ? &tables_.table() : nullptr);
  next_tick_us_ = now_us() + ad7147::sequence_us(sampling_.decimation);
  if (started_) journal_.table();
  const auto rows = tables_.has_table() ? tables_.table().rows() : std::span<const layout::ModuleRow>{};
  for (std::size_t l = 0; l < lines_.size(); ++l) {
    lines_[l].begin(*ports_.lines[l], static_cast<std::uint8_t>(l),
                    {rows, samples_, offsets_, tables_.has_table() && tables_.table().positive_input}, sampling_,
                    now_us());
  }
}

// The chain of switched modules is checked regularly, and rerouted when that is due. If a check fails, the results of
// running transfers are discarded.
void Application::keep_route() {
  for (std::uint8_t l = 0; l < layout::kLines; ++l) route_.line_state(l, lines_[l].stuck());
  if (!pausing_ && route_.check_due(now_us()) && !route_.check(now_us())) invalidate_samples();
  if (!pausing_ && !route_.due(now_us())) return;
  pausing_ = true;
  bool idle = true;
  for (LineSampler& l : lines_) idle = l.pause() && idle;
  if (!idle) return;
  invalidate_samples();
  if (route_.due(now_us())) route_.reroute(*ports_.clock);
  place_adopted();
  for (LineSampler& l : lines_) l.resume(now_us());
  pausing_ = false;
}

void Application::forget_samples(std::size_t first) {
  for (std::size_t k = first; k < samples_.size(); ++k) samples_[k] = published_[k] = ModuleReading{};
}

void Application::place_adopted() {
  const wire::Adoption& now = route_.adoption();
  if (now.list == adopted_list_) return;
  adopted_list_ = now.list;
  const std::size_t own = rows(), first_new = own + route_.kept_adopted();
  forget_samples(first_new);
  for (Channel& c : channels()) c.stream.forget_from(first_new);
  for (LineSampler& l : lines_) l.replace_adopted(own, now.list_of_adopted(), route_.kept_adopted(), now_us());
}

// Samples since the last successful check of the chain may come from another module.
void Application::invalidate_samples() {
  for (auto* samples : {&samples_, &published_}) {
    for (ModuleReading& s : *samples) {
      s.valid = 0;
      s.fresh = false;
    }
  }
  pausing_ = true;
}

void Application::step() {
  for (Channel& c : channels()) {
    receive(c);
    (void)c.link.tick(now_us());
    c.stream.tick(now_us());
  }
  server_.tick();
  keep_route();
  const std::uint64_t now = now_us();
  for (LineSampler& line : lines_) line.step(now);
  if (pausing_) keep_route();
  if (now_us() >= next_tick_us_) tick();
  take_samples();
  if (read_a_module_) prove();  // The call is not inside publish(), where the flash may be busy.
  note_start();
  offsets_wait_ = offset_store_.step(offsets_);
  send_pending();
  route_.send_status(*ports_.can, tables_.node_address(), now_us());
  if (ports_.update != nullptr) ports_.update->step(*ports_.can, now_us());
  step_log();
  reset_when_answered();
}

// A power failure deletes a crash from RAM, but not from the fault memory.
void Application::note_start() {
  if (started_) return;
  started_ = true;
  journal_.started();
  journal_.table();
  const auto crash = ports_.monitor != nullptr ? ports_.monitor->crash() : std::nullopt;
  if (crash && crash != faults_.crash()) (void)faults_.note_crash(*crash);
}

void Application::step_log() {
  serial_log_.step(log_);
  for (Channel& c : channels()) c.log.step(log_, *c.port, tables_.node_address(), now_us());
}

void Application::prove() {
  if (!proved_ && ports_.restart != nullptr) ports_.restart->confirm();
  proved_ = true;
}

// Each step writes one unit of an image to the flash, so that the lines are served in between.
void Application::receive(Channel& c) {
  while (ports_.update == nullptr || c.port != ports_.can || !ports_.update->full()) {
    const auto frame = c.port->receive();
    if (!frame) return;
    handle_frame(c, *frame);
  }
}

// The answer is sent first, also through the queue of the port. One that nobody takes delays the restart by no more
// than a second, and later requests do not delay it.
void Application::reset_when_answered() {
  constexpr std::uint64_t kQueue_us = 5'000;
  if (!reset_requested_) return;
  if (reset_at_us_ == UINT64_MAX) reset_at_us_ = now_us() + wire::IsoTp::kTimeout_us;
  const bool through_loader = through_loader_ && ports_.restart != nullptr;
  const bool answered = std::ranges::none_of(
      channels(), [&](const Channel& c) { return c.port == asking_ && (c.link.sending() || c.held); });
  if (answered) reset_at_us_ = std::min(reset_at_us_, now_us() + (through_loader ? kQueue_us : 0));
  if (now_us() < reset_at_us_) return;
  if (through_loader) ports_.restart->restart();
  reset_at_us_ = UINT64_MAX;
  reset_requested_ = through_loader_ = false;
  stream_ = StreamMode::kOff;
  // The channels are constructed in place like the links, because a copy would need too much of the stack.
  for (Channel& c : channels()) {
    ::new (static_cast<void*>(&c.stream)) FullStream;
    c.log.set(wire::LogLevel::kOff, 8);
  }
  sampling_ = {};
  output_ = wire::TaxelOutput::kRaw;
  server_.restart();
  icub_ = {};
  restart();
}

std::uint64_t Application::next_event_us() const {
  std::uint64_t next =
      std::min({next_tick_us_, reset_at_us_,
                pausing_ ? UINT64_MAX : route_.next_event_us()});  // While pausing, the lines report their own ends.
  const std::uint64_t now = now_us();
  for (const Channel& c : channels()) {
    if (!c.held) next = std::min(next, c.link.next_event_us());  // A held frame waits for room.
    // If the stream's time has passed, it waits for room.
    if (c.stream.next_event_us() > now) next = std::min(next, c.stream.next_event_us());
  }
  for (const LineSampler& line : lines_) next = std::min(next, line.next_event_us(now));
  for (const Channel& c : channels()) next = std::min(next, c.log.next_us(log_));
  if (serial_log_.waits(log_)) next = std::min(next, now + kSerialRoom_us);
  if (ports_.update != nullptr) next = std::min(next, ports_.update->next_event_us(now));
  return offsets_wait_ ? now : next;
}

void Application::handle_frame(Channel& c, const wire::CanFrame& frame) {
  if (!frame.extended) {
    if (c.port == ports_.can) handle_icub_frame(frame);
    return;
  }
  if (ports_.update != nullptr && c.port == ports_.can && ports_.update->handle(frame, now_us())) {
    prove();
    return;
  }
  if (handle_claim_frame(c, frame)) return;
  if (const auto lease = wire::decode_lease(frame)) {
    if (c.port->fd()) c.stream.renew(*lease, now_us());
    return;
  }
  if (route_.receive(frame, tables_.node_address(), now_us())) return;
  const bool functional = frame.id == wire::kFunctionalId;
  if (!functional && frame.id != c.link.rx_id()) return;
  if (functional) {  // ISO 15765-4 allows only single frames here.
    wire::IsoTp single(0, wire::kFunctionalId, 8);
    if (single.receive(frame, now_us()) == wire::IsoTp::Event::kReceived && !c.link.sending())
      answer(c, single.message(), true);
    return;
  }
  c.fd = frame.fd;
  c.link.set_frame_bytes(frame.fd ? c.port->frame_bytes() : 8);
  if (c.link.receive(frame, now_us()) == wire::IsoTp::Event::kReceived) answer(c, c.link.message(), false);
}

void Application::answer(Channel& c, Bytes request, bool functional) {
  asking_ = c.port;
  prove();  // The call comes first, because the answer may depend on it.
  const Bytes response = server_.handle(request, functional);
  if (!response.empty()) (void)c.link.send(response, now_us());
}

void Application::handle_icub_frame(const wire::CanFrame& frame) {
  const IcubBoard::Reaction reaction =
      icub_.handle(frame, {tables_.node_address(), kFirmwareVersion, ports_.unique_id, now_us()});
  if (reaction.calibrate) calibrate();
  if (reaction.restart) reset_requested_ = through_loader_ = true;
  if (reaction.node_address) take_node_address(*reaction.node_address);
  if (!reaction.transmit) return;
  stream_port_ = ports_.can;
  if (*reaction.transmit)
    stream_ = StreamMode::kIcub;
  else if (stream_ == StreamMode::kIcub)
    stream_ = StreamMode::kOff;
}

void Application::take_node_address(std::uint8_t address) {
  if (address != tables_.node_address() && tables_.set_node_address(address) == Status::kOk) restart();
}

// Discovery and assignment use the unique id, so they work while several new boards have the default address.
bool Application::handle_claim_frame(Channel& c, const wire::CanFrame& frame) {
  if (frame.id == wire::kWhoIsThereId) {
    c.claim = wire::encode_claim({ports_.unique_id, tables_.node_address(), tables_.has_table()});
    c.claim_at = 0;
    return true;
  }
  if (frame.id != wire::kAssignId) return false;
  const auto wanted = c.assignment.add(frame);
  if (!wanted || wanted->unique_id != ports_.unique_id) return true;
  if (wanted->b != wire::assignment_key(wanted->unique_id, wanted->a)) return true;
  take_node_address(wanted->a);
  return true;
}

void Application::send_pending(Channel& c, std::uint64_t now_us) {
  while (c.claim_at < c.claim.size() && c.port->send(c.claim[c.claim_at])) ++c.claim_at;
  while (true) {  // A frame that finds the queue full is kept, because ISO-TP has already counted it.
    if (!c.held) c.held = c.link.transmit(now_us);
    if (!c.held || !c.port->send(*c.held)) return;
    c.held.reset();
  }
}

void Application::send_pending() {
  while (icub_.reply() != nullptr && ports_.can->send(*icub_.reply())) icub_.pop_reply();
  for (Channel& c : channels()) send_pending(c, now_us());
  send_stream();
}

void Application::send_stream() {
  const bool held = std::ranges::any_of(channels(), [&](const Channel& c) { return c.port == stream_port_ && c.held; });
  while (!held && !stream_queue_.empty() && stream_port_->send(stream_queue_.front())) stream_queue_.pop();
  const std::uint64_t now = now_us();
  for (Channel& c : channels()) {
    while (!c.held && c.stream.due(now) && c.port->send(c.stream.front())) c.stream.pop(now);
  }
}

bool Application::frames_wait() const {
  const std::uint64_t now = now_us();
  const bool channel_waits = std::ranges::any_of(channels(), [&](const Channel& c) {
    return (c.held || c.claim_at < c.claim.size() || c.stream.due(now)) && c.port->has_room();
  });
  return channel_waits || (icub_.reply() != nullptr && ports_.can->has_room()) ||
         (!stream_queue_.empty() && stream_port_->has_room());
}

Application::Condition Application::condition() const {
  if (!tables_.has_table()) return Condition::kNoTable;
  const auto own = std::span(samples_).first(rows());
  if (std::ranges::any_of(
          own, [](const ModuleReading& s) { return s.state != ModuleState::kOk && s.state != ModuleState::kUnknown; }))
    return Condition::kFault;
  const bool leased = std::ranges::any_of(channels(), [](const Channel& c) { return c.stream.active(); });
  return leased || stream_ != StreamMode::kOff ? Condition::kStreaming : Condition::kSampling;
}

void Application::publish(std::size_t module) {
  samples_[module].fresh = false;
  read_a_module_ = read_a_module_ || samples_[module].valid != 0;
  published_[module] = samples_[module];
  if (module < rows()) icub_triangles_.read(module, samples_[module]);
  stream_full(table_row(module));
}

void Application::step_during_flash() {
  const std::uint64_t now = now_us();
  for (LineSampler& line : lines_) line.step(now);
  for (std::size_t k = 0; !route_.switched() && tables_.has_table() && k < tables_.table().module_count; ++k) {
    if (samples_[k].fresh) publish(k);
  }
  send_stream();
}

std::uint64_t Application::next_during_flash_us() const {
  const std::uint64_t now = now_us();
  std::uint64_t next = UINT64_MAX;
  for (const LineSampler& line : lines_) next = std::min(next, line.next_event_us(now));
  return next;
}

// Each reading is sent as soon as it is available, because the converters have their own clocks.
void Application::take_samples() {
  const bool any = std::ranges::any_of(samples_, &ModuleReading::fresh);
  if (!any) return;
  if (route_.switched() && !route_.check(now_us())) return invalidate_samples();
  for (std::size_t k = 0; k < modules(); ++k) {
    ModuleReading& s = samples_[k];
    if (!s.fresh) continue;
    publish(k);
    if (k >= rows()) continue;  // The owner of an adopted module records its faults.
    // The fault is recorded last: if its page is full, a page is erased, and the module may have been read again after
    // that.
    faults_.note(table_row(k), s.state, {static_cast<std::uint32_t>(now_us() / 1000), s.number});
  }
  if (!tables_.has_table()) return;
  const bool silent = std::ranges::all_of(std::span(samples_).first(tables_.table().module_count),
                                          [](const ModuleReading& s) { return s.state == ModuleState::kAbsent; });
  if (silent) route_.nothing_answers(now_us());
}

// Runs once per nominal sequence. A module without data reports this as often as it would have reported data.
void Application::tick() {
  const std::uint32_t sequence_us = ad7147::sequence_us(sampling_.decimation);
  next_tick_us_ = std::max(next_tick_us_ + sequence_us, now_us());
  journal_.look();
  if (!tables_.has_table()) return;
  ++sample_count_;
  for (std::size_t k = 0; k < modules(); ++k) {
    ModuleReading& s = samples_[k];
    if (s.valid != 0 || ++s.unheard < 2) continue;  // A single tick may come just before the sampler's own report.
    s.unheard = 1;
    ++s.number;
    s.time_us = now_us();
    s.fresh = true;
  }
  if (stream_ == StreamMode::kIcub && !server_.transferring() && icub_.due(now_us())) queue_icub();
}

// Each port counts every sample, even those that none of its readers gets.
void Application::stream_full(TableRow row) {
  const ModuleReading& s = samples_[index_of(row)];
  const wire::TaxelFrame sample{.node_address = tables_.node_address(),
                                .module = static_cast<std::uint8_t>(row),
                                .sample = s.number,
                                .device_time_us = s.time_us,
                                .valid = s.valid,
                                .state = s.state,
                                .value = output_ == wire::TaxelOutput::kRaw ? s.raw : s.compensation.output(),
                                .adopted_modules = index_of(row) < rows() ? std::uint8_t{0} : adopted_list_};
  for (Channel& c : channels()) c.stream.add(sample, modules(), server_.transferring());
}

// Every enabled triangle is sent, even without a module: an MTB4 board does the same, and hosts would take silence for
// pressure.
void Application::queue_icub() {
  const auto rows = tables_.table().rows();
  for (std::size_t triangle = 0; triangle < wire::icub::kTriangles; ++triangle) {
    if (!icub_.enabled(triangle)) continue;
    const auto row =
        std::ranges::find_if(rows, [&](const layout::ModuleRow& m) { return 4U * m.line + m.address == triangle; });
    const auto k = static_cast<std::size_t>(row - rows.begin());
    wire::IcubTaxels t = row == rows.end() ? IcubTriangles::nobody(icub_, triangle)
                                           : icub_triangles_.taxels(k, published_[k], icub_, triangle);
    t.board = tables_.node_address() & 0xF;
    (void)stream_queue_.push(wire::encode_icub(t));
  }
}

void Application::calibrate() {
  for (ModuleReading& s : samples_) s.compensation.restart();  // The next reading becomes the baseline.
  icub_triangles_.calibrate();
}

Status Application::clear_faults() {
  if (ports_.monitor != nullptr) ports_.monitor->forget_crash();
  return faults_.clear() ? Status::kOk : Status::kFlashFailed;
}

bool Application::read_fault(std::uint32_t dtc, ByteWriter& out) {
  const auto frame = faults_.snapshot(dtc);
  if (frame) frame->encode(out);
  return frame.has_value();
}

// The setting takes effect at once, because every converter is configured again.
Status Application::set_sampling(const wire::SamplingSetting& setting) {
  output_ = setting.output;
  const Sampling wanted{setting.decimation, setting.every, setting.timing};
  if (wanted == sampling_) return Status::kOk;
  sampling_ = wanted;
  restart_sampling();
  return Status::kOk;
}

Status Application::set_node_address(std::uint8_t address) {
  const Status s = tables_.set_node_address(address);
  if (s == Status::kOk) reset_requested_ = true;  // The answer still uses the old address.
  return s;
}

Status Application::set_stream(StreamMode mode) {
  if (mode == StreamMode::kFull && !asking_->fd()) return Status::kOutOfRange;
  if (mode == StreamMode::kIcub && !wire::icub::is_board(tables_.node_address())) return Status::kOutOfRange;
  stream_port_ = asking_;
  stream_queue_.clear();
  stream_ = mode;
  journal_.stream(mode);
  for (Channel& c : channels()) c.stream.hold(mode == StreamMode::kFull && c.port == asking_);
  return Status::kOk;
}

Status Application::set_log(wire::LogLevel level) {
  Channel& c = channel_of(asking_);
  c.log.set(level, c.fd ? c.port->frame_bytes() : std::uint8_t{8});
  return Status::kOk;
}

wire::StreamAccount Application::stream_account() const {
  return channel_of(asking_).stream.account(rows(), now_us());
}

std::uint32_t Application::dropped_samples() const {
  std::uint32_t dropped = stream_queue_.dropped();
  for (const Channel& c : channels()) dropped += c.stream.dropped();
  return dropped;
}

Status Application::protect_loader(Bytes option) {
  const auto on = option.size() == 1 ? wire::checked_bool(option[0]) : std::unexpected(Status::kBadLength);
  if (!on) return on.error();
  return ports_.monitor != nullptr && ports_.monitor->protect_loader(*on) ? Status::kOk : Status::kFlashFailed;
}

Status Application::start_routine(std::uint16_t routine, Bytes option, ByteWriter&) {
  switch (routine) {
    case wire::routine::kDiscover:
      for (LineSampler& l : lines_) l.request_scan();
      return Status::kOk;
    case wire::routine::kSelfTest:
      for (LineSampler& l : lines_) l.request_check();
      return Status::kOk;
    case wire::routine::kOffsets:
      for (LineSampler& l : lines_) l.request_offsets();
      return Status::kOk;
    case wire::routine::kCalibrate:
      calibrate();
      return Status::kOk;
    case wire::routine::kReroute:
      route_.request();
      return Status::kOk;
    case wire::routine::kProtectLoader:
      return protect_loader(option);
    case wire::routine::kActivate: {
      const Status s = tables_.activate(tables_.node_address());
      if (s != Status::kOk) return s;
      (void)faults_.clear_modules();  // Its rows refer to the old table.
      restart_sampling();
      return s;
    }
    default:
      return Status::kOutOfRange;
  }
}

}  // namespace triskin::fw
