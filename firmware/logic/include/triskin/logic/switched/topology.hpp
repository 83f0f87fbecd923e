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

/// The graph contains the modules of a patch and the joints between their ports; module 0 has the cable. Joints are
/// symmetric.
struct PatchGraph {
  std::uint8_t count = 0;
  std::uint8_t cable_port = 0;  ///< The cable is connected to this port of module 0.
  std::array<std::array<JointEnd, layout::kPorts>, layout::kMaxModules> joint{};
  bool operator==(const PatchGraph&) const = default;
};

/// Line, and address on it, at which a module is read. They do not change with the tree.
struct LineAddress {
  std::uint8_t line = 0, address = 0;
};

/// Writes and measures the chain. In a register, bits 0..1 are the line, 2..3 the address, 4..6 the ports A..C, and 7
/// is a marker (always 1).
class ChainDriver {
 public:
  enum class Answer : std::uint8_t { kModule, kRefused, kNothing, kUnchanged, kLost };

  explicit ChainDriver(RouteChain& port) : port_(port) {}
  /// Closes all ports, then lets in the module at a cable (0, 1). Returns false if no module answers.
  bool restart(std::uint8_t cable);
  /// Returns true if restart() failed because another controller holds the module at that cable.
  [[nodiscard]] bool refused() const { return refused_; }
  void set_address(std::uint8_t module, LineAddress address);
  /// Opens a port that is last in the chain; if a module comes in, it gets the number `child`.
  Answer open(std::uint8_t module, std::uint8_t port, std::uint8_t child);
  /// Closes a port that was just opened and showed nothing new. Returns false if the chain stays broken (a short).
  bool close(std::uint8_t module, std::uint8_t port);
  /// Closes a port that was just opened, wherever it lies in the chain; the answer was kModule, which is released, or
  /// kUnchanged. Returns false if the chain is not as it was before.
  bool shut(std::uint8_t module, std::uint8_t port);
  /// Opens several ports at once, which must lead to new modules; the next write or check() verifies this.
  void attach(std::uint8_t module, std::uint8_t port, std::uint8_t child);
  bool write();
  /// Returns true if the chain has the expected length. The registers then contain arbitrary data, so they must be
  /// written before the next latch.
  bool measured() { return measure() == Answer::kUnchanged; }
  /// Returns true if the chain has the expected length; every register is then written once more.
  bool settle();
  /// Returns true if every register holds what was written and the chain has the expected length.
  bool check();
  /// Bit m says that module m is in the chain.
  [[nodiscard]] std::uint16_t members() const { return static_cast<std::uint16_t>(members_); }
  [[nodiscard]] std::uint8_t stuck_lines() const { return port_.stuck_lines(); }
  /// Sets EN low, so that no module is reached.
  void silence();

 private:
  static constexpr std::size_t kMaxBytes = layout::kMaxModules + 3;
  // One number more than there can be modules is needed, because shut() releases it.
  static constexpr std::size_t kNumbers = layout::kMaxModules + 1;
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

/// Finds all modules and joints of a patch, and keeps the patch working around failures. Sampling must pause while it
/// works.
class Topology {
 public:
  struct Report {
    bool complete = false;    ///< False means that the chain did not settle; the graph contains what was certain.
    std::uint8_t shorts = 0;  ///< This many ports are closed because opening them broke the chain or held a line low.
    std::uint16_t alive = 0;  ///< After reroute(), bit m says that module m of the table is in the tree.
    std::uint8_t max_depth = 0;  ///< The active tree has this depth.
    bool min_depth = false;  ///< After reroute(), true means that no tree over the joints that were found is less deep.
    bool as_table = false;   ///< After reroute(), true means that the table's tree is active.
    bool second_cable = false;  ///< True means that module 0 is the one at the second cable.
    /// After reroute(), this many modules were found at places that the table does not know; they stay closed.
    std::uint8_t unknown = 0;
    /// After reroute(), bit m says that module m of the table exists and another controller holds it.
    std::uint16_t held = 0;
    /// After reroute(), true means that another layer and room for it exist behind the requested ones.
    bool more_adopted = false;
  };

  /// Decides how far a search goes beyond the joints of the table. The table has no joints for ports that lead to a
  /// neighbouring patch.
  enum class Look : std::uint8_t {
    kOwn,     ///< Such ports stay closed, because the controller of the modules behind them may just be searching.
    kBeyond,  ///< Such ports are probed; modules behind them are noted and stay closed.
    /// Such ports are probed. When the whole table is in the tree, free modules behind them are adopted too, nearest
    /// first, as long as the table leaves addresses.
    kAdopt,
  };

  /// The joints, addresses and tree of the table are indexed by row.
  struct Table {
    PatchGraph graph;
    std::array<LineAddress, layout::kMaxModules> addresses{};
    /// Each row has the row and output port of its parent; without a module, only the least depth counts.
    std::array<JointEnd, layout::kMaxModules> parent{};
    JointEnd second_entry{};  ///< The second cable is at this row and port; without a module there is none.
  };
  [[nodiscard]] static Table table_of(const layout::PatchImage& image);

  explicit Topology(RouteChain& port) : chain_(port) {}

  /// Probes depth first, then finds the far end of every joint that closes a cycle. Ends after at most 64 restarts.
  Report discover() { return discover(nullptr, Look::kBeyond); }
  /// Releases all modules, so that another controller can reach them. graph() does not change.
  void let_go() { chain_.silence(); }
  [[nodiscard]] const PatchGraph& graph() const { return graph_; }
  /// Returns true if module 0 of graph() is the one at the second cable.
  [[nodiscard]] bool second_cable() const { return cable_ == 1; }

  /// Discovers again and activates the table's tree if all of it exists, otherwise the tree of least depth over the
  /// surviving joints of the table. A module keeps its address. If no tree can be activated, no module is reached. The
  /// second cable is used when no module answers at the first, or when less than half of the table does and there is
  /// more behind the second. Adopted modules are left out if the tree cannot be activated with them. `layers` limits
  /// how many adopted modules may follow each other, 1 or more.
  Report reroute(const Table& table, Look look = Look::kBeyond, std::uint8_t layers = kAllLayers);
  static constexpr std::uint8_t kAllLayers = layout::kMaxModules;
  /// Checks cheaply before and after a sampling cycle. If it returns false, the samples of the cycle are unreliable,
  /// and a reroute is needed.
  bool intact() { return chain_.check(); }
  /// Writes the registers again after intact() failed. Returns true if this was enough and the tree has the same
  /// modules.
  bool refresh() { return chain_.check() && chain_.settle() && chain_.check(); }
  /// Returns the row of a module of graph() after reroute(); for adopted module k the number of rows of the table + k,
  /// and kNoTableRow for any other unknown module. Adopted modules are last in graph(), a parent before its children.
  [[nodiscard]] TableRow row_of(std::uint8_t module) const { return table_row(table_index_[module]); }
  /// Returns the parent of a module in the active tree, both in graph(), and the parent's output port.
  [[nodiscard]] JointEnd parent_of(std::uint8_t module) const { return parent_[module]; }
  /// Returns how many modules outside the table were adopted.
  [[nodiscard]] std::uint8_t adopted_count() const { return adopted_count_; }
  /// Returns joint and address of adopted module `k` < adopted_count().
  [[nodiscard]] wire::AdoptedModule adopted_module(std::uint8_t k) const;

 private:
  // kBeyond means that a free module is behind the port, and the table has no joint there or no number is left for it.
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
  /// below), then the port. Returns whether the port brings a module in.
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
  // The tree of the discovery has for each module the parent and its output port.
  std::array<JointEnd, layout::kMaxModules> parent_{};
  // Enabling this port has no effect; if there are several, it is the first.
  std::array<std::uint8_t, layout::kMaxModules> input_{};
  // Bit p stands for port p; more than one bit means that an enable is broken.
  std::array<std::uint8_t, layout::kMaxModules> inputs_{};
  Exclusions bad_{};  // Ports are named by discovery number, which is the same in each pass.
  std::uint8_t shorts_ = 0, ends_left_ = 0;
  std::uint8_t first_tried_ = 0, cable_ = 0;  // explore() begins at first_tried_ and found the patch at cable_.
  std::uint8_t held_lines_ = 0;               // These lines were already low with the entry module alone.
  bool entry_held_ = false;                   // Another controller holds the entry at the first cable.
  const Table* expected_table_ = nullptr;     // The table is only set during discover(); null means that there is none.
  Look look_ = Look::kBeyond;
  // Each module has its row in the table, if the patch agrees with it, or no module.
  std::array<std::uint8_t, layout::kMaxModules> expected_{};
  std::uint8_t adopted_count_ = 0;
  std::array<std::uint8_t, layout::kMaxModules> table_index_{};
  std::array<LineAddress, layout::kMaxModules> address_{};  // Addresses are indexed by discovery number.
};

}  // namespace triskin::fw
