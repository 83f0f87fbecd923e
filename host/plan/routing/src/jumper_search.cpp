// SPDX-License-Identifier: GPL-3.0-or-later
#include "jumper_search.hpp"

#include <algorithm>
#include <utility>

namespace triskin::routing {
namespace {

constexpr int kTrees = 100;
constexpr int kMovesAPart = 400, kMovesAQuestion = 64;
constexpr long kAlwaysVisited = 300'000;  // The limit counts nodes of search trees, which take some 10 ms.

// A spanning tree of some nodes, and the most that can be saved by joining its nodes into parts.
class TreeDivision {
 public:
  TreeDivision(const JumperGraph& g, int capacity, const IntegerPrice& price)
      : g_(g),
        capacity_(capacity),
        price_(price),
        parent_(g.joined.node.size()),
        by_jumper_(g.joined.node.size()),
        seen_(g.joined.node.size(), 0),
        saved_(g.joined.node.size()),
        best_(g.joined.node.size()),
        most_(g.joined.node.size()),
        taken_(g.joined.node.size()) {}

  // Draws a random tree over the nodes v with scope[v] == stamp, which must be connected; joints come before jumpers,
  // except in one tree of four.
  void draw(const Numbers& scope, int stamp, int root, Dice& random) {
    struct Step {
      int from, to;
      bool jumper;
    };
    order_.clear();
    ++now_;
    std::vector<Step> front, late;
    const bool mixed = random.below(4) == 0;
    const int depth_first_of_8 = random.below(9);
    Step step{-1, root, false};
    for (;;) {
      if (seen_[step.to] != now_) {
        seen_[step.to] = now_;
        parent_[step.to] = step.from;
        by_jumper_[step.to] = step.jumper;
        order_.push_back(step.to);
        const int first = random.below(3);
        for (int k = 0; k < 3; ++k) {
          const std::size_t s = at((first + k) % 3);
          const int w = g_.joined.neighbour[step.to][s];
          if (w < 0 || scope[w] != stamp || seen_[w] == now_) continue;
          const bool jumper = g_.over_jumper[step.to][s];
          (jumper && !mixed ? late : front).push_back({step.to, w, jumper});
        }
      }
      auto& list = front.empty() ? late : front;
      if (list.empty()) return;
      if (&list == &late || random.below(8) >= depth_first_of_8)
        std::swap(list[at(random.below(static_cast<int>(list.size())))], list.back());
      step = list.back();
      list.pop_back();
    }
  }

  // Finds the cheapest parts that the tree allows, exactly: by node and weight of the part at it, the most that joining
  // saves. Numbers the parts from `first` on and returns their number.
  int divide(int first, Numbers& part_of) {
    for (const int v : order_) {
      saved_[v][1] = 0;
      most_[v] = 1;
    }
    for (std::size_t k = order_.size(); k-- > 1;) {
      choose_best(order_[k]);
      join(order_[k], parent_[order_[k]]);
    }
    choose_best(order_[0]);
    return number_parts(first, part_of);
  }

  [[nodiscard]] const Numbers& order() const { return order_; }

 private:
  using Row = std::array<std::int64_t, kModulesAController + 1>;
  static constexpr std::int64_t kNever = -(std::int64_t{1} << 60);

  void choose_best(int v) {
    const auto first = saved_[v].begin() + 1;
    best_[v] = static_cast<int>(std::max_element(first, first + most_[v]) - first) + 1;
  }

  // Parts at a node weigh 1 … most_.
  void join(int child, int parent) {
    const Row mine = saved_[parent], &theirs = saved_[child];
    Row& out = saved_[parent];
    auto& taken = taken_[child];
    const std::size_t m = at(most_[parent]), n = at(most_[child]);
    const std::size_t most = std::min(at(capacity_), m + n);
    most_[parent] = static_cast<int>(most);
    const std::int64_t apart = theirs[at(best_[child])], saves = price_.part - (by_jumper_[child] ? price_.jumper : 0);
    for (std::size_t w = 1; w <= most; ++w) {
      out[w] = w <= m ? mine[w] + apart : kNever;
      taken[w] = 0;
      for (std::size_t c = w > m ? w - m : 1; c < w && c <= n; ++c) {
        const std::int64_t together = mine[w - c] + theirs[c] + saves;
        if (together <= out[w]) continue;
        out[w] = together;
        taken[w] = static_cast<int>(c);
      }
    }
  }

  // Children were joined in the reverse of the order, so the weights are read back in the order.
  int number_parts(int first, Numbers& part_of) {
    Numbers& weight = weight_;
    weight.resize(g_.joined.node.size());
    int parts = 0;
    for (const int v : order_) {
      const int p = parent_[v];
      const int mine = p < 0 ? 0 : taken_[v][at(weight[p])];
      if (mine > 0) {
        weight[p] -= mine;
        weight[v] = mine;
        part_of[v] = part_of[p];
      } else {
        weight[v] = best_[v];
        part_of[v] = first + parts++;
      }
    }
    return parts;
  }

  const JumperGraph& g_;
  int capacity_;
  const IntegerPrice& price_;
  Numbers order_, parent_, weight_;
  Table<int, bool> by_jumper_;
  Numbers seen_;
  Table<int, Row> saved_;
  Numbers best_, most_;
  Table<int, std::array<int, kModulesAController + 1>> taken_;
  int now_ = 0;
};

class JumperSearch {
 public:
  JumperSearch(const JumperGraph& g, int capacity, const IntegerPrice& price, Dice& random,
               const std::function<bool()>& give_up, JumperDivision& best)
      : g_(g), price_(price), random_(random), give_up_(give_up), trees_(g, capacity, price), best_(best) {}

  void run(std::int64_t bound) {
    Numbers part_of(g_.joined.node.size(), -1);
    const Numbers whole(g_.joined.node.size(), 0);
    for (int k = 0; k < kTrees && (best_.parts == 0 || (cost() > bound && !is_late())); ++k) {
      visited_nodes_ += g_.joined.size();
      trees_.draw(whole, 0, random_.below(g_.joined.size()), random_);
      const int parts = trees_.divide(0, part_of);
      best_.offer(g_, price_, part_of, parts);
    }
    if (cost() > bound) improve(bound);
  }

 private:
  [[nodiscard]] std::int64_t cost() const { return price_.of(best_.parts, best_.jumpers); }
  // However late it is, some search is made: without any, every island has controllers of its own, and 211 modules had
  // 19 of them where 14 are enough.
  [[nodiscard]] bool is_late() const { return visited_nodes_ > kAlwaysVisited && give_up_ && give_up_(); }

  // Joins some neighbouring parts and divides them along another tree. Equal prices are accepted, and in the first half
  // of the moves sometimes also one more jumper.
  void improve(std::int64_t bound) {
    now_ = best_.part_of;
    members_.assign(at(best_.parts), {});
    for (int v = 0; v < g_.joined.size(); ++v) members_[now_[v]].push_back(v);
    scope_.assign(g_.joined.node.size(), 0);
    divided_.assign(g_.joined.node.size(), -1);
    std::int64_t now = cost();
    const int moves = kMovesAPart * best_.parts;
    for (int k = 0; k < moves && cost() > bound; ++k) {
      if (k % kMovesAQuestion == 0 && is_late()) return;
      const bool loose = 2 * k < moves && random_.below(16) == 0;
      now += move(loose ? price_.jumper : 0);
      if (now < cost()) store();
    }
  }

  // Chooses the parts of the move: one, and neighbours of the chosen ones until there are two to five.
  void choose() {
    ++stamp_;
    chosen_.clear();
    take(now_[random_.below(g_.joined.size())]);
    const int wanted = 2 + random_.below(4);
    for (int tries = 0; tries < 32 && static_cast<int>(chosen_.size()) < wanted; ++tries) {
      const auto& from = members_[chosen_[random_.below(static_cast<int>(chosen_.size()))]];
      const int v = from[at(random_.below(static_cast<int>(from.size())))];
      const int w = g_.joined.neighbour[v][random_.below(3)];
      if (w >= 0 && scope_[w] != stamp_) take(now_[w]);
    }
  }
  void take(int part) {
    chosen_.push_back(part);
    for (const int v : members_[part]) scope_[v] = stamp_;
  }

  // Returns the change of the price, 0 when the move is refused.
  std::int64_t move(std::int64_t allowed) {
    choose();
    std::int64_t before = 0;
    for (const int p : chosen_) before += price_.of(1, pieces(members_[p], now_) - 1);
    const int root = members_[chosen_[0]][at(random_.below(static_cast<int>(members_[chosen_[0]].size())))];
    trees_.draw(scope_, stamp_, root, random_);
    const int parts = trees_.divide(0, divided_);
    visited_nodes_ += static_cast<long>(trees_.order().size());
    Table<int, Numbers> fresh(at(parts));
    for (const int v : trees_.order()) fresh[divided_[v]].push_back(v);
    std::int64_t after = 0;
    for (const auto& part : fresh) after += price_.of(1, pieces(part, divided_) - 1);
    const bool take = after <= before + allowed;
    for (const int v : trees_.order()) divided_[v] = -1;
    if (!take) return 0;
    replace(std::move(fresh));
    return after - before;
  }

  void replace(Table<int, Numbers> fresh) {
    std::ranges::sort(chosen_);
    for (std::size_t k = 0; k < fresh.size(); ++k) {
      if (k < chosen_.size()) {
        members_[chosen_[k]] = std::move(fresh[k]);
        renumber(chosen_[k]);
      } else {
        members_.push_back(std::move(fresh[k]));
        renumber(static_cast<int>(members_.size()) - 1);
      }
    }
    // The last part takes the number that became free.
    for (std::size_t k = chosen_.size(); k > fresh.size(); --k) {
      const int free = chosen_[k - 1];
      if (free + 1 < static_cast<int>(members_.size())) {
        members_[free] = std::move(members_.back());
        renumber(free);
      }
      members_.pop_back();
    }
  }
  void renumber(int part) {
    for (const int v : members_[part]) now_[v] = part;
  }
  void store() {
    best_.part_of = now_;
    best_.parts = static_cast<int>(members_.size());
    best_.jumpers = jumpers_of(g_, now_, best_.parts);
  }

  // Returns the number of pieces of a part without its jumpers.
  int pieces(const Numbers& part, const Numbers& part_of) {
    visited_.resize(g_.apart.node.size(), 0);
    ++visit_;
    int count = 0;
    for (const int start : part) {
      if (visited_[start] == visit_) continue;
      ++count;
      queue_.assign(1, start);
      visited_[start] = visit_;
      for (std::size_t k = 0; k < queue_.size(); ++k) {
        for (const int w : g_.apart.neighbour[queue_[k]]) {
          if (w < 0 || visited_[w] == visit_ || part_of[w] != part_of[start]) continue;
          visited_[w] = visit_;
          queue_.push_back(w);
        }
      }
    }
    return count;
  }

  const JumperGraph& g_;
  const IntegerPrice& price_;
  Dice& random_;
  const std::function<bool()>& give_up_;
  TreeDivision trees_;
  JumperDivision& best_;
  Numbers now_, scope_, divided_, chosen_, visited_, queue_;
  Table<int, Numbers> members_;
  int stamp_ = 0, visit_ = 0;
  long visited_nodes_ = 0;
};

}  // namespace

bool JumperDivision::offer(const JumperGraph& g, const IntegerPrice& price, const Numbers& other, int other_parts) {
  const int other_jumpers = jumpers_of(g, other, other_parts);
  if (parts > 0 && price.of(other_parts, other_jumpers) >= price.of(parts, jumpers)) return false;
  part_of = other;
  parts = other_parts;
  jumpers = other_jumpers;
  return true;
}

void search_division(const JumperGraph& g, int capacity, const IntegerPrice& price, std::int64_t bound, Dice& random,
                     const std::function<bool()>& give_up, JumperDivision& best) {
  JumperSearch(g, capacity, price, random, give_up, best).run(bound);
}

}  // namespace triskin::routing
