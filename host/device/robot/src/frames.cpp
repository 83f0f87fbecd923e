// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/robot/frames.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <boost/property_tree/ptree.hpp>
#include <boost/property_tree/xml_parser.hpp>
#include <cmath>
#include <numbers>
#include <set>
#include <sstream>
#include <vector>

#include "triskin/base/error.hpp"
#include "triskin/base/file_kind.hpp"
#include "triskin/base/short_list.hpp"
#include "triskin/base/text_file.hpp"
#include "triskin/base/xml_depth.hpp"
#include "triskin/robot/robot.hpp"

namespace triskin::robot {
namespace {

using boost::property_tree::ptree;

constexpr double kMm_per_m = 1000.0;
// No joint of a robot with a skin is farther from the one before it; the longest arms reach a few metres.
constexpr double kMaxOffset_m = 10.0;
constexpr double kMaxTurn_rad = 2.0 * std::numbers::pi + 0.01;   // More than a whole turn says nothing but degrees.
constexpr double kMaxLimit_rad = 4.0 * std::numbers::pi + 0.01;  // Wrists turn once or twice to each side.

struct Joint {
  std::string parent, child;
  Eigen::Isometry3d origin = Eigen::Isometry3d::Identity();
};

class Urdf {
 public:
  Urdf(const std::string& text, std::string file) : file_(std::move(file)) {
    if (const std::string what = not_asked_for(text, FileUse::kRobot, file_); !what.empty()) fail("is " + what);
    require_shallow_xml(text, file_);
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
    if (const std::size_t robots = document.count("robot"); robots > 1)
      fail(fmt::format("holds {} robots ({}); give each a file of its own, or join their links by a joint", robots,
                       names_of(document, "robot")));
    for (const auto& [tag, element] : *robot) {
      if (tag == "link") add_link(attribute(element, "link", "name"));
      if (tag == "joint") {
        const std::string name = attribute(element, "joint", "name");
        if (!joint_names_.insert(name).second)
          fail(fmt::format("joint \"{}\" stands there twice; give each its own name", name));
        joints_.push_back(read_joint(element, name));
      }
    }
  }

  [[nodiscard]] std::string names_of(const ptree& parent, const char* wanted) const {
    std::vector<std::string> names;
    for (const auto& [tag, element] : parent) {
      if (tag == wanted) names.push_back(element.get<std::string>("<xmlattr>.name", "without a name"));
    }
    return short_list(names, 5);
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
    if (text->find("${") != std::string::npos || text->find("$(") != std::string::npos)
      fail(fmt::format("{}=\"{}\" is an expression of xacro; make a URDF of it: xacro FILE > robot.urdf", name, *text));
    std::istringstream in(*text);
    std::string rest;
    if (!(in >> v[0] >> v[1] >> v[2]) || in >> rest || !std::isfinite(v[0] + v[1] + v[2]))
      fail(fmt::format("{}=\"{}\" must be three numbers", name, *text));
    return v;
  }
  // A number that has to be finite.
  [[nodiscard]] double number_in(const ptree& element, const char* key, const std::string& where) const {
    const std::string text = attribute(element, "limit", key);
    std::istringstream in(text);
    double value = 0.0;
    std::string rest;
    if (!(in >> value) || in >> rest || !std::isfinite(value))
      fail(fmt::format("{}: {}=\"{}\" must be a number", where, key, text));
    return value;
  }
  // What readers of ROS refuse of a joint's motion, or take in different ways (wiki.ros.org/urdf/XML/joint).
  void check_motion(const ptree& element, const std::string& name) const {
    constexpr std::array<std::string_view, 6> kTypes{"fixed",     "revolute", "continuous",
                                                     "prismatic", "floating", "planar"};
    const std::string type = attribute(element, "joint", "type"), where = fmt::format("joint \"{}\"", name);
    if (std::ranges::find(kTypes, type) == kTypes.end())
      fail(fmt::format("{} has the type \"{}\"; there are {}", where, type, fmt::join(kTypes, ", ")));
    if (const auto axis = element.get_child_optional("axis")) {
      const auto v = numbers(*axis, "xyz");
      const double length = std::hypot(v[0], v[1], v[2]);
      constexpr double kRounding = 0.01;  // Files have two to six digits of each component.
      if (std::abs(length - 1.0) > kRounding)
        fail(fmt::format("{} has an axis of length {:g}; write it with length 1{}", where, length,
                         length > 0.0
                             ? fmt::format(": {:.6g} {:.6g} {:.6g}", v[0] / length, v[1] / length, v[2] / length)
                             : ", as 0 0 1"));
    }
    if (const auto mimic = element.get_child_optional("mimic"); mimic && attribute(*mimic, "mimic", "joint") == name)
      fail(fmt::format("{} mimics itself; name the joint that it follows, or take out its <mimic>", where));
    if (type != "revolute" && type != "prismatic") return;
    const auto limit = element.get_child_optional("limit");
    if (!limit)
      fail(
          fmt::format("{} is {} and has no <limit>, which ROS demands; add one with effort and velocity, or make the "
                      "joint {}",
                      where, type, type == "revolute" ? "continuous" : "fixed"));
    for (const char* key : {"effort", "velocity"}) (void)number_in(*limit, key, where);
    const bool has_range =
        limit->get_optional<std::string>("<xmlattr>.lower") && limit->get_optional<std::string>("<xmlattr>.upper");
    if (has_range && number_in(*limit, "lower", where) > number_in(*limit, "upper", where))
      fail(fmt::format("{} has a lower limit above its upper one; exchange them", where));
    for (const char* key : {"lower", "upper"}) {
      if (type != "revolute" || !limit->get_optional<std::string>(fmt::format("<xmlattr>.{}", key))) continue;
      if (const double turn = number_in(*limit, key, where); std::abs(turn) > kMaxLimit_rad)
        fail(fmt::format(
            "{} has the limit {}=\"{:g}\", more than two turns; a URDF is in radians: is it in degrees? Then "
            "write {:.7g}",
            where, key, turn, turn * std::numbers::pi / 180.0));
    }
  }

  // Turns about the fixed axes x, y, z, or from version 1.1 of URDF a quaternion.
  [[nodiscard]] Eigen::Matrix3d turn_of(const ptree& origin, const std::string& name) const {
    const auto text = origin.get_optional<std::string>("<xmlattr>.quat_xyzw");
    const auto rpy = numbers(origin, "rpy");
    if (!text) return pose_of({0.0, 0.0, 0.0, rpy[0], rpy[1], rpy[2]}).linear();
    if (origin.get_optional<std::string>("<xmlattr>.rpy"))
      fail(fmt::format("joint \"{}\" has rpy and quat_xyzw; leave one out", name));
    std::istringstream in(*text);
    std::string rest;
    Eigen::Vector4d q = Eigen::Vector4d::Zero();
    constexpr double kRounding = 0.01;
    if (!(in >> q[0] >> q[1] >> q[2] >> q[3]) || in >> rest || !(std::abs(q.norm() - 1.0) <= kRounding))
      fail(fmt::format("joint \"{}\": quat_xyzw=\"{}\" must be four numbers of length 1", name, *text));
    return Eigen::Quaterniond(q.normalized()).toRotationMatrix();
  }

  [[nodiscard]] Joint read_joint(const ptree& element, const std::string& name) const {
    check_motion(element, name);
    Joint joint;
    const auto end = [&](const char* tag) {
      const auto found = element.get_child_optional(tag);
      if (!found) fail(fmt::format("joint \"{}\" has no <{}>", name, tag));
      return attribute(*found, tag, "link");
    };
    joint.parent = end("parent");
    joint.child = end("child");
    if (const auto origin = element.get_child_optional("origin")) {
      const auto xyz = numbers(*origin, "xyz"), rpy = numbers(*origin, "rpy");
      if (const double far_m = std::hypot(xyz[0], xyz[1], xyz[2]); far_m > kMaxOffset_m)
        fail(fmt::format(
            "joint \"{}\" is {:g} m from its parent; a URDF is in metres: are its numbers millimetres? Then "
            "divide its xyz by 1000",
            name, far_m));
      if (const double turn = std::max({std::abs(rpy[0]), std::abs(rpy[1]), std::abs(rpy[2])}); turn > kMaxTurn_rad)
        fail(
            fmt::format("joint \"{}\" is turned by {:g} rad, more than a whole turn; a URDF is in radians: are its "
                        "numbers degrees? Then write {:.7g} for {:g}",
                        name, turn, turn * std::numbers::pi / 180.0, turn));
      joint.origin.linear() = turn_of(*origin, name);
      joint.origin.translation() = kMm_per_m * Eigen::Vector3d(xyz[0], xyz[1], xyz[2]);
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
    if (links_.empty()) fail("has no <link>; a robot has at least one");
    if (bases.empty()) fail("its joints form a ring; a robot is a tree of links");
    if (bases.size() != 1)
      fail(
          fmt::format("has {} links that hang on no joint ({}); a robot has one base: join them by a fixed joint, or "
                      "take out what is no part of the robot",
                      bases.size(), short_list(std::vector(bases.begin(), bases.end()), 5)));
    base = *bases.begin();
  }

  std::string file_;
  std::set<std::string> links_, joint_names_;
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
