// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/robot/frames.hpp"

#include <fmt/format.h>

#include <array>
#include <boost/property_tree/ptree.hpp>
#include <boost/property_tree/xml_parser.hpp>
#include <cmath>
#include <set>
#include <sstream>
#include <vector>

#include "triskin/base/error.hpp"
#include "triskin/base/text_file.hpp"
#include "triskin/robot/robot.hpp"

namespace triskin::robot {
namespace {

using boost::property_tree::ptree;

constexpr double kMm_per_m = 1000.0;

struct Joint {
  std::string parent, child;
  Eigen::Isometry3d origin = Eigen::Isometry3d::Identity();
};

class Urdf {
 public:
  Urdf(const std::string& text, std::string file) : file_(std::move(file)) {
    std::istringstream in(text);
    ptree document;
    try {
      boost::property_tree::read_xml(in, document);
    } catch (const boost::property_tree::xml_parser_error& e) {
      const bool is_cut = e.message().find("unexpected end") != std::string::npos;
      fail(fmt::format("line {}: is not well-formed XML{}; give a URDF file", e.line(),
                       is_cut ? ", because the file ends in the middle: it was cut" : ""));
    }
    const auto robot = document.get_child_optional("robot");
    if (!robot) fail("has no element <robot>; give a URDF file");
    for (const auto& [tag, element] : *robot) {
      if (tag == "link") add_link(attribute(element, "link", "name"));
      if (tag == "joint") joints_.push_back(read_joint(element));
    }
  }

  // Works from the base outwards and visits each joint once per level of the tree.
  [[nodiscard]] std::map<std::string, Eigen::Isometry3d> poses(std::string& base) const {
    check_joints(base);
    std::map<std::string, Eigen::Isometry3d> poses{{base, Eigen::Isometry3d::Identity()}};
    for (bool grew = true; grew;) {
      grew = false;
      for (const Joint& j : joints_) {
        const auto parent = poses.find(j.parent);
        if (parent != poses.end()) grew = poses.try_emplace(j.child, parent->second * j.origin).second || grew;
      }
    }
    if (poses.size() != links_.size()) fail("its joints form a ring; a robot is a tree of links");
    return poses;
  }

 private:
  void add_link(const std::string& name) {
    if (!links_.insert(name).second) fail(fmt::format("link \"{}\" stands there twice", name));
  }

  [[noreturn]] void fail(const std::string& what) const { throw InputError(fmt::format("{}: {}", file_, what)); }

  [[nodiscard]] std::string attribute(const ptree& element, const char* tag, const char* name) const {
    const auto value = element.get_optional<std::string>(fmt::format("<xmlattr>.{}", name));
    if (!value || value->empty()) fail(fmt::format("a <{}> has no attribute \"{}\"", tag, name));
    return *value;
  }
  [[nodiscard]] std::array<double, 3> numbers(const ptree& element, const char* name) const {
    std::array<double, 3> v{};
    const auto text = element.get_optional<std::string>(fmt::format("<xmlattr>.{}", name));
    if (!text) return v;
    std::istringstream in(*text);
    std::string rest;
    if (!(in >> v[0] >> v[1] >> v[2]) || in >> rest || !std::isfinite(v[0] + v[1] + v[2]))
      fail(fmt::format("{}=\"{}\" must be three numbers", name, *text));
    return v;
  }
  [[nodiscard]] Joint read_joint(const ptree& element) const {
    Joint joint;
    const auto end = [&](const char* tag) {
      const auto found = element.get_child_optional(tag);
      if (!found) fail(fmt::format("joint \"{}\" has no <{}>", attribute(element, "joint", "name"), tag));
      return attribute(*found, tag, "link");
    };
    joint.parent = end("parent");
    joint.child = end("child");
    if (const auto origin = element.get_child_optional("origin")) {
      const auto xyz = numbers(*origin, "xyz"), rpy = numbers(*origin, "rpy");
      joint.origin = pose_of({kMm_per_m * xyz[0], kMm_per_m * xyz[1], kMm_per_m * xyz[2], rpy[0], rpy[1], rpy[2]});
    }
    return joint;
  }
  void check_joints(std::string& base) const {
    std::set<std::string> bases = links_;
    for (const Joint& j : joints_) {
      for (const std::string& link : {j.parent, j.child}) {
        if (!links_.contains(link)) fail(fmt::format("a joint names link \"{}\", which is not there", link));
      }
      if (bases.erase(j.child) == 0) fail(fmt::format("link \"{}\" is the child of two joints", j.child));
    }
    if (bases.size() != 1) fail(fmt::format("has {} links that hang on no joint; a robot has one base", bases.size()));
    base = *bases.begin();
  }

  std::string file_;
  std::set<std::string> links_;
  std::vector<Joint> joints_;
};

}  // namespace

Frames Frames::parse_urdf(const std::string& text, const std::string& file) {
  Frames frames;
  frames.poses_ = Urdf(text, file).poses(frames.base_);
  return frames;
}

Frames Frames::read_urdf(const std::filesystem::path& path) {
  return parse_urdf(read_text(path), path.string());
}

}  // namespace triskin::robot
