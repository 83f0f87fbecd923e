// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/session/conversations.hpp"

#include <algorithm>
#include <deque>
#include <map>
#include <memory>
#include <semaphore>
#include <thread>
#include <utility>

#include "triskin/wire/uds.hpp"

namespace triskin::device {
namespace {

class Hall;

// What a conversation takes for the link.
class Lane final : public Link {
 public:
  enum class State { kFresh, kReady, kWaiting, kEnded };

  Lane(Hall& hall, Link& link, const Conversation& conversation, std::size_t index)
      : hall_(hall), link_(link), conversation_(conversation), index_(index), wire(link.wire_of(conversation.node)) {}

  void send(const wire::CanFrame& frame) override { link_.send(frame); }
  std::optional<wire::CanFrame> receive(std::uint64_t until_us) override;
  [[nodiscard]] std::uint64_t now_us() const override { return link_.now_us(); }
  [[nodiscard]] bool fd() const override { return link_.fd(); }
  [[nodiscard]] std::uint8_t frame_bytes() const override { return link_.frame_bytes(); }
  [[nodiscard]] std::uint64_t answer_us() const override { return link_.answer_us(); }
  [[nodiscard]] std::string name() const override { return link_.name(); }
  [[nodiscard]] std::string trouble() const override { return link_.trouble(); }
  [[nodiscard]] std::unique_ptr<MessageChannel> open_channel(std::uint32_t tx_id, std::uint32_t rx_id) override {
    return link_.open_channel(tx_id, rx_id);
  }
  [[nodiscard]] int wire_of(std::uint8_t node) const override { return link_.wire_of(node); }

  void run();
  [[nodiscard]] bool hears(const wire::CanFrame& f) const {
    return f.extended && f.id == wire::physical_id(wire::kTesterAddress, conversation_.node);
  }

 private:
  Hall& hall_;
  Link& link_;
  const Conversation& conversation_;
  const std::size_t index_;

 public:
  const int wire;
  State state = State::kFresh;
  std::uint64_t until_us = 0;
  bool woken = false;
  std::deque<wire::CanFrame> inbox;
  std::exception_ptr link_failure, outcome;
  std::binary_semaphore turn{0};
};

// Whoever speaks holds the floor; nobody else touches anything meanwhile.
class Hall {
 public:
  Hall(Link& link, std::span<const Conversation> conversations, int per_wire) : link_(link), per_wire_(per_wire) {
    for (const Conversation& c : conversations) lanes_.push_back(std::make_unique<Lane>(*this, link, c, lanes_.size()));
  }

  std::vector<std::exception_ptr> run() {
    std::vector<std::jthread> threads;
    for (auto& lane : lanes_) {
      threads.emplace_back([&l = *lane] {
        l.turn.acquire();
        l.run();
      });
    }
    pass_on(lanes_.size() - 1);
    all_ended_.acquire();
    threads.clear();
    std::vector<std::exception_ptr> outcomes;
    for (const auto& lane : lanes_) outcomes.push_back(lane->outcome);
    return outcomes;
  }

  // The lane `from` has nothing to do now: the next one that has goes on. Its turn may be over before this returns.
  void pass_on(std::size_t from) {
    Lane* const next = next_ready(from);
    if (next == nullptr) return all_ended_.release();
    if (next->state == Lane::State::kFresh) ++busy_[next->wire];
    next->state = Lane::State::kReady;
    next->woken = false;
    next->turn.release();
  }
  void ended(std::size_t index) {
    --busy_[lanes_[index]->wire];
    pass_on(index);
  }
  // What has come in already, without waiting.
  void look() {
    while (const auto frame = link_.receive(link_.now_us())) hand_out(*frame);
  }

 private:
  // Waits for the link until somebody can go on; null: all have ended.
  Lane* next_ready(std::size_t from) {
    while (true) {
      for (std::size_t k = 1; k <= lanes_.size(); ++k) {
        Lane& lane = *lanes_[(from + k) % lanes_.size()];
        if (can_go_on(lane)) return &lane;
      }
      std::uint64_t until_us = UINT64_MAX;
      Lane* first = nullptr;
      for (const auto& lane : lanes_) {
        if (lane->state != Lane::State::kWaiting || lane->until_us >= until_us) continue;
        until_us = lane->until_us;
        first = lane.get();
      }
      if (first == nullptr) return nullptr;
      wait(*first);
    }
  }
  [[nodiscard]] bool can_go_on(const Lane& lane) {
    if (lane.state == Lane::State::kFresh) return busy_[lane.wire] < per_wire_;
    if (lane.state != Lane::State::kWaiting) return false;
    return lane.woken || !lane.inbox.empty() || lane.link_failure || link_.now_us() >= lane.until_us;
  }
  void wait(Lane& first) {
    try {
      const auto frame = link_.receive(first.until_us);
      if (frame) return hand_out(*frame);
      for (auto& lane : lanes_) lane->woken = true;  // a channel of the system has something, or it is time
    } catch (...) {
      first.link_failure = std::current_exception();  // it would have been told, had it waited alone
    }
  }
  void hand_out(const wire::CanFrame& frame) {
    for (auto& lane : lanes_) {
      if (lane->state != Lane::State::kEnded && lane->hears(frame)) lane->inbox.push_back(frame);
    }
  }

  Link& link_;
  const int per_wire_;
  std::vector<std::unique_ptr<Lane>> lanes_;
  std::map<int, int> busy_;  // conversations under way on a wire
  std::binary_semaphore all_ended_{0};
};

std::optional<wire::CanFrame> Lane::receive(std::uint64_t until) {
  if (inbox.empty()) hall_.look();
  if (inbox.empty() && link_.now_us() < until) {
    until_us = until;
    state = State::kWaiting;
    hall_.pass_on(index_);
    turn.acquire();
    if (link_failure) std::rethrow_exception(std::exchange(link_failure, nullptr));
  }
  if (inbox.empty()) return std::nullopt;
  const wire::CanFrame frame = inbox.front();
  inbox.pop_front();
  return frame;
}

void Lane::run() {
  try {
    Bus bus(*this);
    conversation_.talk(bus);
  } catch (...) {
    outcome = std::current_exception();
  }
  state = State::kEnded;
  hall_.ended(index_);
}

}  // namespace

std::vector<std::exception_ptr> converse(Link& link, std::span<const Conversation> conversations, int per_wire) {
  if (conversations.empty()) return {};
  return Hall(link, conversations, std::max(1, per_wire)).run();
}

}  // namespace triskin::device
