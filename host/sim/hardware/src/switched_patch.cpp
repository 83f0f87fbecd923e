// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/hardware/switched_patch.hpp"

#include <algorithm>
#include <numeric>

#include "triskin/sim/port_logic.hpp"

namespace triskin::hardware {
namespace {

// These elements of the data path are constants instead of modules.
constexpr int kConstantZero = -1, kConstantOne = -2;

bool bit(std::uint8_t set, int k) {
  return ((set >> k) & 1) != 0;
}

}  // namespace

SwitchedPatch::SwitchedPatch(std::vector<std::array<End, layout::kPorts>> joints, int cable_port, std::uint64_t seed)
    : joints_(std::move(joints)),
      faults_(joints_.size()),
      modules_(joints_.size()),
      controllers_{{{{End{layout::TableRow{}, cable_port}, End{}}}, 0}},
      random_(seed),
      flips_(~seed) {}

std::uint8_t SwitchedPatch::output(int m) const {
  const Module& module = at(m);
  if (module.stuck_bit < 0) return module.latched;
  const auto mask = static_cast<std::uint8_t>(1U << module.stuck_bit);
  return static_cast<std::uint8_t>(module.stuck_value != 0 ? module.latched | mask : module.latched & ~mask);
}

std::uint8_t SwitchedPatch::opened(int m) const {
  return at(m).dead ? std::uint8_t{0} : sim::en_out(at(m).grant, static_cast<std::uint8_t>(output(m) >> 4 & 7));
}

std::uint8_t SwitchedPatch::raised(int m) const {
  std::uint8_t in = 0;
  for (int p = 0; p < static_cast<int>(layout::kPorts); ++p) {
    if (at_cable(m, p) >= 0) in = static_cast<std::uint8_t>(in | 1U << p);
    const End e = end(m, p);
    if (e.row >= 0 && fault(m, p) != JointFault::kOpen && bit(opened(e.row), e.port))
      in = static_cast<std::uint8_t>(in | 1U << p);
  }
  return in;
}

int SwitchedPatch::add_controller(End cable) {
  controllers_.push_back({{cable, End{}}, 0});
  return static_cast<int>(controllers_.size()) - 1;
}

// The chain is created on demand, because it refers to this object, which may be moved before.
sim::ChainModel& SwitchedPatch::chain_of(int controller) {
  (void)at_controller(controller);
  while (chains_.size() < controllers_.size()) chains_.emplace_back(*this, static_cast<int>(chains_.size()));
  return chains_[static_cast<std::size_t>(controller)];
}

int SwitchedPatch::at_cable(int m, int port) const {
  for (std::size_t k = 0; k < controllers_.size(); ++k) {
    const Controller& owner = controllers_[k];
    for (std::size_t c = 0; c < owner.cables.size(); ++c) {
      if ((owner.enabled >> c & 1) != 0 && owner.cables[c].row == m && owner.cables[c].port == port)
        return static_cast<int>(k);
    }
  }
  return -1;
}

bool SwitchedPatch::attached_child(int m, int p) const {
  const End e = end(m, p);
  return e.row >= 0 && fault(m, p) == JointFault::kNone && !at(e.row).dead && at(e.row).grant == e.port &&
         bit(opened(m), p);
}

bool SwitchedPatch::shorted(int controller) const {
  for (int m = 0; m < static_cast<int>(modules_.size()); ++m) {
    if (controller_of(layout::TableRow{m}) != controller) continue;
    for (int p = 0; p < static_cast<int>(layout::kPorts); ++p) {
      if (bit(opened(m), p) && fault(m, p) == JointFault::kShort) return true;
    }
  }
  return false;
}

SwitchedPatch::WayUp SwitchedPatch::walk_up(int module) const {
  int depth = 0;
  for (int m = module;; ++depth) {
    if (at(m).dead || at(m).grant == sim::kNoGrant || depth > static_cast<int>(modules_.size())) return {};
    if (const int controller = at_cable(m, at(m).grant); controller >= 0) return {depth, controller};
    const End above = end(m, at(m).grant);
    if (above.row < 0 || !attached_child(above.row, above.port)) return {};
    m = above.row;
  }
}

void SwitchedPatch::collect(int m, std::vector<int>& chain) const {
  chain.push_back(m);
  for (int p = 0; p < static_cast<int>(layout::kPorts); ++p) {
    if (!bit(opened(m), p)) continue;
    const End e = end(m, p);
    if (attached_child(m, p)) {
      collect(e.row, chain);
    } else {
      const bool nobody = e.row < 0 || at(e.row).dead || fault(m, p) != JointFault::kNone;
      chain.push_back(nobody ? kConstantZero : kConstantOne);
    }
  }
}

// Returns a chain for each cable with EN; a module whose parent is at another port refuses it and reads as ones.
std::vector<std::vector<int>> SwitchedPatch::chains(int controller) const {
  std::vector<std::vector<int>> list;
  if (shorted(controller)) return list;
  for (const End& c : at_controller(controller).cables) {
    if (c.row < 0 || at(c.row).dead || at_cable(c.row, c.port) != controller) continue;
    if (at(c.row).grant == c.port)
      collect(c.row, list.emplace_back());
    else if (at(c.row).grant != sim::kNoGrant)
      list.push_back({kConstantOne});
  }
  return list;
}

void SwitchedPatch::exchange(int controller, Bytes out, std::span<std::uint8_t> in) {
  time_us_ += static_cast<double>(8 * out.size()) * kBit_ns * 1e-3;
  std::fill_n(in.begin(), out.size(), std::uint8_t{0});
  for (const std::vector<int>& chain : chains(controller)) {
    for (std::size_t k = 0; k < out.size(); ++k) {
      in[k] = static_cast<std::uint8_t>(in[k] |
                                        (bit_errors_ > 0.0 ? shift_bits(chain, out[k]) : shift_byte(chain, out[k])));
    }
  }
}

// Every register is one byte long, so after eight clocks each has the previous one's contents.
std::uint8_t SwitchedPatch::shift_byte(const std::vector<int>& chain, std::uint8_t carry) {
  for (const int element : chain) {
    if (element >= 0)
      std::swap(carry, at(element).shift);
    else
      carry = element == kConstantOne ? 0xFF : 0;
  }
  return carry;
}

std::uint8_t SwitchedPatch::shift_bits(const std::vector<int>& chain, std::uint8_t out) {
  std::bernoulli_distribution flip(bit_errors_);
  std::uint8_t in = 0;
  for (int k = 7; k >= 0; --k) {
    int carry = out >> k & 1;
    for (const int element : chain) {
      if (element < 0) {
        carry = element == kConstantOne ? 1 : 0;
        continue;
      }
      Module& m = at(element);
      const int next = m.shift >> 7;
      if (flip(flips_)) carry ^= 1;
      m.shift = static_cast<std::uint8_t>(m.shift << 1 | carry);
      carry = next;
    }
    in = static_cast<std::uint8_t>(in | carry << k);
  }
  return in;
}

void SwitchedPatch::latch(int controller) {
  time_us_ += kSettle_ns * 1e-3;
  for (const std::vector<int>& chain : chains(controller)) {
    for (const int element : chain) {
      if (element >= 0) at(element).latched = at(element).shift;
    }
  }
  settle();
}

void SwitchedPatch::enable(int controller, std::uint8_t cables) {
  at_controller(controller).enabled = cables;
  time_us_ += kSettle_ns * 1e-3;
  settle();
}

// Gates act in any order; tests with many seeds check that results do not depend on it.
void SwitchedPatch::settle() {
  std::vector<int> order(modules_.size());
  std::iota(order.begin(), order.end(), 0);
  // Two registers with stuck bits could toggle each other for ever; hardware would oscillate, but the model stops.
  const std::size_t most = 100 * modules_.size();
  bool moved = true;
  for (std::size_t round = 0; moved && round < most; ++round) {
    moved = false;
    std::shuffle(order.begin(), order.end(), random_);
    for (const int k : order) {
      Module& m = at(k);
      const sim::PortInputs in{static_cast<std::uint8_t>(output(k) >> 4 & 7), raised(k), m.grant};
      if (m.dead ? m.grant != sim::kNoGrant : sim::loses_grant(in)) {
        m.grant = sim::kNoGrant;
        m.shift = m.latched = 0;
        moved = true;
      } else if (!m.dead && sim::may_be_granted(in) != 0) {
        do m.grant = static_cast<int>(random_() % 3);
        while (!bit(in.en_in, m.grant));
        moved = true;
      }
    }
  }
}

std::uint8_t SwitchedPatch::stuck_lines(int controller) const {
  std::uint8_t stuck = 0;
  for (int m = 0; m < static_cast<int>(modules_.size()); ++m) {
    if (at(m).stuck_line >= 0 && controller_of(layout::TableRow{m}) == controller)
      stuck = static_cast<std::uint8_t>(stuck | 1U << at(m).stuck_line);
  }
  return stuck;
}

void SwitchedPatch::set_dead(layout::TableRow module, bool dead) {
  at(module).dead = dead;
  settle();
}

void SwitchedPatch::set_joint(End e, JointFault f) {
  const End other = end(e.row, e.port);
  faults_[static_cast<std::size_t>(e.row)][static_cast<std::size_t>(e.port)] = f;
  if (other.row >= 0) faults_[static_cast<std::size_t>(other.row)][static_cast<std::size_t>(other.port)] = f;
  settle();
}

void SwitchedPatch::set_stuck_line(layout::TableRow module, int line) {
  at(module).stuck_line = line;
}

void SwitchedPatch::set_stuck_bit(layout::TableRow module, int which, int value) {
  at(module).stuck_bit = value < 0 ? -1 : which;
  at(module).stuck_value = value;
  settle();
}

void SwitchedPatch::reset_alone(layout::TableRow module) {
  at(module).shift = at(module).latched = 0;
  settle();
}

}  // namespace triskin::hardware
