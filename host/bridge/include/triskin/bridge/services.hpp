// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "triskin/bridge/dds.hpp"
#include "triskin/recording/cdr.hpp"

/// Services of the bridge, with the definitions of host/bridge/ros/triskin_msgs/srv. On the wire a request and its
/// answer begin with who asks and the number of the request, 8 bytes each, as rmw_cyclonedds writes them.
namespace triskin::bridge {

/// Takes the present values of the taxels for those of a skin that nobody touches.
struct Tare {
  static constexpr std::string_view kName = "triskin_msgs/srv/Tare", kTopic = "tare";
  static const std::string_view kDefinition;
  struct Request {
    void read(recording::CdrReader& r) { (void)r.u8(); }  // ROS 2 sends a byte for a message without fields.
  };
  struct Answer {
    bool success = false;
    std::string message;  ///< It says what failed and the remedy.
    std::uint32_t taxels = 0;
    void write(recording::CdrWriter& w) const;
  };
};

/// Lets controllers find modules and joints anew and open a tree.
struct Reroute {
  static constexpr std::string_view kName = "triskin_msgs/srv/Reroute", kTopic = "reroute";
  static const std::string_view kDefinition;
  struct Request {
    std::int32_t patch = -1;  ///< −1 asks for all patches.
    void read(recording::CdrReader& r) { patch = static_cast<std::int32_t>(r.u32()); }
  };
  struct Answer {
    bool success = false;
    std::string message;
    std::vector<std::int32_t> patch;  ///< These patches were asked.
    /// The tree of each patch has so many modules; −1 means that they have no switches.
    std::vector<std::int32_t> modules;
    void write(recording::CdrWriter& w) const;
  };
};

/// Says which controllers serve the cover.
struct Identify {
  static constexpr std::string_view kName = "triskin_msgs/srv/Identify", kTopic = "identify";
  static const std::string_view kDefinition;
  using Request = Tare::Request;
  struct Answer {
    bool success = false;
    std::string message;
    std::uint64_t design_id = 0;  ///< It is the id of the published design.
    /// Each controller that answered has its patch here; the lists below have the same order.
    std::vector<std::int32_t> patch;
    std::vector<std::uint8_t> node;       ///< They are node addresses.
    std::vector<std::string> serial;      ///< They are unique ids.
    std::vector<std::string> firmware;    ///< They are versions.
    std::vector<std::uint64_t> table_id;  ///< It is the design of the table; 0 means that there is none.
    void write(recording::CdrWriter& w) const;
  };
};

/// Identifies the request that an answer belongs to.
struct RequestId {
  std::uint64_t client = 0, number = 0;
  bool operator==(const RequestId&) const = default;
};

/// Serves /skin/PART/TOPIC of `Type`, one of those above. Threads: one.
template <class Type>
class Service {
 public:
  struct Asked {
    RequestId id;
    typename Type::Request request;
  };
  /// Advertises the service. `domain` outlives it. Throws DeviceError.
  Service(Domain& domain, const std::string& part)
      : server_(domain.serve("/skin/" + part + "/" + std::string(Type::kTopic), Type::kName)) {}
  /// The oldest request that nobody has taken; empty: there is none. Those that are malformed are dropped. Throws
  /// DeviceError.
  std::optional<Asked> take() {
    while (const auto bytes = server_->take()) {
      recording::CdrReader r(*bytes);
      Asked asked;
      asked.id = {r.u64(), r.u64()};
      asked.request.read(r);
      if (r.ok()) return asked;
    }
    return std::nullopt;
  }
  /// Answers a request. Throws DeviceError.
  void answer(const RequestId& id, const typename Type::Answer& answer) {
    recording::CdrWriter w;
    w.u64(id.client);
    w.u64(id.number);
    answer.write(w);
    server_->write(w.message());
  }

 private:
  std::unique_ptr<Server> server_;
};

}  // namespace triskin::bridge
