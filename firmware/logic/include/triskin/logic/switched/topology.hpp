// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "triskin/layout/patch_image.hpp"
#include "triskin/logic/sampling/table_row.hpp"
#include "triskin/ports/route_chain.hpp"
#include "triskin/wire/adoption.hpp"

namespace triskin::fw {

using layout::JointEnd;
using layout::kNoModule;

/// Modules of a patch and the joints between their ports; module 0 has the cable. Symmetric.
struct PatchGraph {
  std::uint8_t count = 0;
  std::uint8_t cable_port = 0;  ///< port of module 0 where the cable is connected
  std::array<std::array<JointEnd, layout::kPorts>, layout::kMaxModules> joint{};
  bool operator==(const PatchGraph&) const = default;
};

/// Line, and address on it, at which a module is read. They stay the same when the tree changes.
struct LineAddress {
  std::uint8_t line = 0, address = 0;
};

/// Writes and measures the chain. Register: bits 0..1 line, 2..3 address, 4..6 ports A..C, 7 marker (always 1).
class ChainDriver {
 public:
  enum class Answer : std::uint8_t { kModule, kRefused, kNothing, kUnchanged, kLost };

  explicit ChainDriver(RouteChain& port) : port_(port) {}
  /// Closes everything, then lets the module at a cable (0, 1) in. False: no module answers.
  bool restart(std::uint8_t cable);
  /// True if restart() failed because another controller holds the module at that cable.
  [[nodiscard]] bool refused() const { return refused_; }
  void set_address(std::uint8_t module, LineAddress address);
  /// Opens a port that is last in the chain; when a module comes in it gets the number `child`.
  Answer open(std::uint8_t module, std::uint8_t port, std::uint8_t child);
  /// Closes a port that was just opened and showed nothing new. False: the chain stays broken (a short).
  bool close(std::uint8_t module, std::uint8_t port);
  /// Closes a port that was just opened, wherever it lies in the chain: the answer was kModule, which is let go, or
  /// kUnchanged. False: the chain is not as it was before.
  bool shut(std::uint8_t module, std::uint8_t port);
  /// Opens several ports at once, which must lead to new modules; checked by the next write or check().
  void attach(std::uint8_t module, std::uint8_t port, std::uint8_t child);
  bool write();
  /// The chain has its length. The registers then hold anything: write before the next latch.
  bool measured() { return measure() == Answer::kUnchanged; }
  /// The chain has its length; every register is written once more.
  bool settle();
  /// Every register holds what was written and the chain has its length.
  bool check();
  /// Bit m: module m is in the chain.
  [[nodiscard]] std::uint16_t members() const { return static_cast<std::uint16_t>(members_); }
  [[nodiscard]] std::uint8_t stuck_lines() const { return port_.stuck_lines(); }
  /// EN low: no module is reached.
  void silence();

 private:
  static constexpr std::size_t kMaxBytes = layout::kMaxModules + 3;
  static constexpr std::size_t kNumbers = layout::kMaxModules + 1;  // One more than modules; shut() releases it.
  std::size_t order();
  bool echo();
  [[nodiscard]] Answer measure();
  void clear();

  RouteChain& port_;
  std::array<std::uint8_t, kNumbers> config_{};
  std::array<std::array<std::uint8_t, layout::kPorts>, kNumbers> child_{};
  std::array<std::uint8_t, kNumbers> order_{};
  std::size_t length_ = 0;
  std::uint32_t members_ = 0;
  bool refused_ = false;
};

/// Finds all modules and joints of a patch, and keeps it alive around what breaks. Sampling must pause while it works.
class Topology {
 public:
  struct Report {
    bool complete = false;       ///< false: the chain would not settle; the graph is what was certain
    std::uint8_t shorts = 0;     ///< ports left closed because opening them broke the chain or held a line
    std::uint16_t alive = 0;     ///< reroute(): bit m: module m of the table is in the tree
    std::uint8_t max_depth = 0;  ///< depth of the active tree
    bool min_depth = false;      ///< reroute(): no tree over the joints that were found is less deep
    bool as_table = false;       ///< reroute(): the table's tree is up
    bool second_cable = false;   ///< module 0 is the one at the second cable
    std::uint8_t unknown = 0;    ///< reroute(): modules found at places that the table does not know; left closed
    std::uint16_t held = 0;      ///< reroute(): bit m: module m of the table is there, and another controller holds it
    bool more_adopted = false;   ///< reroute(): behind the layers that were asked for is one more, and room for it
  };

  /// How far a look goes beyond the joints of the table. Ports to a neighbouring patch have none.
  enum class Look : std::uint8_t {
    kOwn,     ///< such ports stay closed: what is behind them may be in the middle of its own controller's look
    kBeyond,  ///< they are probed; what is there is noted and left closed
    kAdopt,   ///< they are probed; when the whole table is in, what is there and held by nobody is taken in as well,
              ///< nearest first, while the table leaves addresses
  };

  /// What the table says: joints, addresses and tree, by row.
  struct Table {
    PatchGraph graph;
    std::array<LineAddress, layout::kMaxModules> addresses{};
    std::array<JointEnd, layout::kMaxModules> parent{};  ///< row and output port; no module: least depth is what counts
    JointEnd second_entry{};                             ///< row and port with the second cable; no module: none
  };
  [[nodiscard]] static Table table_of(const layout::PatchImage& image);

  explicit Topology(RouteChain& port) : chain_(port) {}

  /// Depth-first probing, then the far end of every joint that closes a cycle. Ends after at most 64 restarts.
  Report discover() { return discover(nullptr, Look::kBeyond); }
  /// Lets all modules go, so that another controller reaches them. graph() stays.
  void let_go() { chain_.silence(); }
  [[nodiscard]] const PatchGraph& graph() const { return graph_; }
  /// Module 0 of graph() is the one at the second cable.
  [[nodiscard]] bool second_cable() const { return cable_ == 1; }

  /// Discovers anew and activates the table's tree where all of it is there, else the tree of least depth over the
  /// joints of the table that survive. A module keeps its address. Where no tree comes up, no module is reached. The
  /// second cable serves when nobody answers at the first, or less than half of the table does and more is behind the
  /// second. Guests are left out where the tree does not come up with them. `layers`: how many adopted modules may hang
  /// one behind the other, 1 or more.
  Report reroute(const Table& table, Look look = Look::kBeyond, std::uint8_t layers = kAllLayers);
  static constexpr std::uint8_t kAllLayers = layout::kMaxModules;
  /// Cheap check before and after a sampling cycle; false: samples of the cycle are not to be trusted, reroute.
  bool intact() { return chain_.check(); }
  /// Writes the registers again after intact() failed. True: this was enough, and the tree has the same modules.
  bool refresh() { return chain_.check() && chain_.settle() && chain_.check(); }
  /// Row of a module of graph() after reroute(); of adopted module k the number of rows of the table + k; kNoTableRow
  /// for any other that the table does not know. Guests stand last in graph(), a parent before its children.
  [[nodiscard]] TableRow row_of(std::uint8_t module) const { return table_row(table_index_[module]); }
  /// Module of graph() and its output port on which a module of graph() hangs in the active tree.
  [[nodiscard]] JointEnd parent_of(std::uint8_t module) const { return parent_[module]; }
  /// Modules that were taken in and that the table does not know.
  [[nodiscard]] std::uint8_t adopted_count() const { return adopted_count_; }
  /// Joint and address of adopted module `k` < guest_count().
  [[nodiscard]] wire::AdoptedModule adopted_module(std::uint8_t k) const;

 private:
  // kBeyond: a module that nobody holds is behind, and the table has no joint there or no number is left for it.
  enum class Port : std::uint8_t { kUnknown, kInput, kNothing, kChild, kJoined, kBeyond, kBad };
  using Exclusions = std::array<std::uint8_t, layout::kMaxModules>;

  enum class Pass : std::uint8_t { kDone, kAgain, kNobody };
  Report discover(const Table* table, Look look);
  Pass explore();
  Report find(const Table& table, Look look);
  [[nodiscard]] JointEnd expected_cable() const;
  [[nodiscard]] bool within_table(std::uint8_t module, std::uint8_t port) const;
  void expect(std::uint8_t child);
  [[nodiscard]] std::uint16_t held_rows(const Table& table) const;
  [[nodiscard]] bool may_adopt(const Table& table, const Report& report) const;
  bool adopt(const Table& table, std::uint8_t layers, Report& report);
  void release_adopted();
  bool take_in(std::uint8_t module, std::uint8_t port, std::uint8_t place);
  bool ask(std::uint8_t adopted_module, std::uint8_t port);
  bool rebuild_all() { return rebuild(0xFFFF, true); }
  [[nodiscard]] bool more_behind_second(const Table& table, const Report& report) const;
  Pass probe(std::uint8_t module, std::uint8_t port);
  void note_answer(std::uint8_t module, std::uint8_t port, ChainDriver::Answer answer, bool beyond);
  Pass match();
  Pass match_end(std::uint8_t module, std::uint8_t port);
  Pass join_here(std::uint8_t module, std::uint8_t port, std::uint8_t far);
  Pass leave(std::uint8_t module, std::uint8_t port);
  /// Opens the tree up to the port of `module` without `left_out` and its subtree (kNoModule: without everything
  /// below), then the port: does it bring a module in?
  std::optional<bool> brings_module(std::uint8_t module, std::uint8_t port, std::uint8_t left_out);
  bool rebuild(std::uint16_t wanted, bool set_addresses);
  [[nodiscard]] bool below(std::uint8_t module, std::uint8_t top) const;
  [[nodiscard]] bool open_end(std::uint8_t module, std::uint8_t port) const;
  [[nodiscard]] int open_ends() const;
  void join(JointEnd a, JointEnd b);
  void note_input(std::uint8_t module, std::uint8_t port);
  void resolve_inputs(const PatchGraph& table, std::uint8_t module);
  void identify(const Table& table, Report& report);
  [[nodiscard]] bool in_table(const PatchGraph& table, std::uint8_t module, std::uint8_t port) const;
  [[nodiscard]] bool lines_free() const { return (chain_.stuck_lines() & ~held_lines_) == 0; }
  bool table_tree(const Table& table);
  bool min_depth_tree(const Table& table);
  bool activate(const Table& table, Report& report);
  [[nodiscard]] std::uint8_t depth() const;
  bool exclude(std::uint8_t module, std::uint8_t port);

  ChainDriver chain_;
  PatchGraph graph_;
  std::array<std::array<Port, layout::kPorts>, layout::kMaxModules> port_{};
  std::array<JointEnd, layout::kMaxModules> parent_{};     // Tree of the discovery: module and its output port.
  std::array<std::uint8_t, layout::kMaxModules> input_{};  // First port whose enable has no effect.
  // Bit p stands for port p; more than one bit: an enable is broken.
  std::array<std::uint8_t, layout::kMaxModules> inputs_{};
  Exclusions bad_{};  // Ports by discovery number, which repeats.
  std::uint8_t shorts_ = 0, ends_left_ = 0;
  std::uint8_t first_tried_ = 0, cable_ = 0;  // Cables: where explore() begins, and where it found the patch.
  std::uint8_t held_lines_ = 0;               // Lines that were already low with the entry module alone.
  bool entry_held_ = false;                   // Another controller holds the entry at the first cable.
  const Table* expected_table_ = nullptr;     // Set during discover(); null: none.
  Look look_ = Look::kBeyond;
  // Row in the table, if the patch agrees with it; no module: none.
  std::array<std::uint8_t, layout::kMaxModules> expected_{};
  std::uint8_t adopted_count_ = 0;
  std::array<std::uint8_t, layout::kMaxModules> table_index_{};
  std::array<LineAddress, layout::kMaxModules> address_{};  // Indexed by discovery number.
};

}  // namespace triskin::fw
