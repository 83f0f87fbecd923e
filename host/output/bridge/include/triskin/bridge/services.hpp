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

/// The definitions of these services are in host/output/bridge/ros/triskin_msgs/srv.
namespace triskin::bridge {

/// Uses the present values of the taxels as rest values.
struct Tare {
  static constexpr std::string_view kName = "triskin_msgs/srv/Tare", kTopic = "tare";
  static const std::string_view kDefinition;
  struct Request {
    void read(recording::CdrReader& r) { (void)r.u8(); }  // ROS 2 sends one byte for a message without fields.
  };
  struct Answer {
    bool success = false;
    std::string message;  ///< The message says what failed and how to repair it.
    std::uint32_t taxels = 0;
    void write(recording::CdrWriter& w) const;
  };
};

/// Makes controllers search for modules and joints again and open a tree.
struct Reroute {
  static constexpr std::string_view kName = "triskin_msgs/srv/Reroute", kTopic = "reroute";
  static const std::string_view kDefinition;
  struct Request {
    std::int32_t patch = -1;  ///< The value −1 selects all patches.
    void read(recording::CdrReader& r) { patch = static_cast<std::int32_t>(r.u32()); }
  };
  struct Answer {
    bool success = false;
    std::string message;
    std::vector<std::int32_t> patch;  ///< Only these patches were asked to reroute.
    /// The tree of each patch has this many modules; −1 means that they have no switches.
    std::vector<std::int32_t> modules;
    void write(recording::CdrWriter& w) const;
  };
};

/// Reports which controllers serve the cover.
struct Identify {
  static constexpr std::string_view kName = "triskin_msgs/srv/Identify", kTopic = "identify";
  static const std::string_view kDefinition;
  using Request = Tare::Request;
  struct Answer {
    bool success = false;
    std::string message;
    std::uint64_t design_id = 0;  ///< The id is that of the published design.
    /// Each controller that answered has its patch here; the lists below have the same order.
    std::vector<std::int32_t> patch;
    std::vector<std::uint8_t> node;     ///< The controllers have these node addresses.
    std::vector<std::string> serial;    ///< The controllers have these unique ids.
    std::vector<std::string> firmware;  ///< The versions are those of the firmware.
    /// The table of each controller belongs to this design; 0 means that there is no table.
    std::vector<std::uint64_t> table_id;
    void write(recording::CdrWriter& w) const;
  };
};

/// Serves BASE/TOPIC of `Type`, one of the services above or of parameters.hpp. Threads: one.
template <class Type>
class Service {
 public:
  struct Asked {
    RequestId id;
    typename Type::Request request;
  };
  /// Advertises the service under `base`, such as "/skin/arm". `domain` must outlive it. Throws DeviceError.
  Service(Domain& domain, const std::string& base)
      : server_(domain.serve(base + "/" + std::string(Type::kTopic), Type::kName)) {}
  /// Removes and returns the oldest request; empty if there is none. Malformed requests are dropped. Throws
  /// DeviceError.
  std::optional<Asked> take() {
    while (const auto request = server_->take()) {
      recording::CdrReader r(request->message);
      Asked asked{request->id, {}};
      asked.request.read(r);
      if (r.ok()) return asked;
    }
    return std::nullopt;
  }
  /// Answers a request. Throws DeviceError.
  void answer(const RequestId& id, const typename Type::Answer& answer) {
    recording::CdrWriter w;
    answer.write(w);
    server_->write(id, w.message());
  }

 private:
  std::unique_ptr<Server> server_;
};

}  // namespace triskin::bridge
