// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "triskin/bridge/dds.hpp"

namespace triskin::bridge {

/// A parameter of the node as `ros2 param` shows it. All are fixed while the program runs.
struct Parameter {
  std::string name;
  ParameterValue value;
  std::string description;
};

/// Serves the six services of parameters that each node of ROS 2 has (rcl_interfaces/srv): list, get, types, describe;
/// to set one is refused with a reason. Threads: one.
class ParameterServices {
 public:
  /// `domain` must outlive it. Throws DeviceError.
  ParameterServices(Domain& domain, std::vector<Parameter> parameters);
  ~ParameterServices();
  ParameterServices(const ParameterServices&) = delete;
  ParameterServices& operator=(const ParameterServices&) = delete;
  /// Answers the requests since the last call. Throws DeviceError.
  void step();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace triskin::bridge
