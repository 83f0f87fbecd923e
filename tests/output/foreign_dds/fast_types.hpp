// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <fastcdr/Cdr.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

/// Declares the messages as a foreign program would, written by hand from the definitions of ROS 2 and of
/// ros/triskin_msgs.
namespace triskin::foreign {

using Cdr = eprosima::fastcdr::Cdr;

template <class... Fields>
void read_fields(Cdr& cdr, Fields&... fields) {
  (cdr.deserialize(fields), ...);
}
template <class Item>
void read_items(Cdr& cdr, std::vector<Item>& items) {
  std::uint32_t n = 0;
  cdr.deserialize(n);
  for (std::uint32_t k = 0; k < n; ++k) items.emplace_back().read(cdr);
}

struct Header {
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
  std::string frame_id;
  void read(Cdr& cdr) { read_fields(cdr, sec, nanosec, frame_id); }
};

struct PointField {
  std::string name;
  std::uint32_t offset = 0, count = 0;
  std::uint8_t datatype = 0;
  void read(Cdr& cdr) { read_fields(cdr, name, offset, datatype, count); }
};

struct PointCloud2 {
  Header header;
  std::uint32_t height = 0, width = 0, point_step = 0, row_step = 0;
  std::vector<PointField> fields;
  bool is_bigendian = false, is_dense = false;
  std::vector<std::uint8_t> data;
  void read(Cdr& cdr) {
    header.read(cdr);
    read_fields(cdr, height, width);
    read_items(cdr, fields);
    read_fields(cdr, is_bigendian, point_step, row_step, data, is_dense);
  }
};

struct RawFrame {
  std::uint8_t node = 0;
  std::uint32_t sample = 0, error_us = 0;
  std::uint64_t device_time_us = 0, link_time_us = 0, sampled_ns = 0;
  std::vector<std::uint32_t> module, link_delay_us;
  std::vector<std::int32_t> device_delay_us;
  std::vector<std::uint8_t> row, state;
  std::vector<std::uint16_t> valid, value;
  void read(Cdr& cdr) {
    read_fields(cdr, node, sample, device_time_us, link_time_us, module, row, valid, state, link_delay_us,
                device_delay_us, value, sampled_ns, error_us);
  }
};

struct SkinLayout {
  Header header;
  std::string name;
  std::uint64_t design_id = 0;
  std::vector<float> corner, position, normal;
  std::vector<std::int32_t> patch;
  std::vector<std::uint32_t> module;
  void read(Cdr& cdr) {
    header.read(cdr);
    read_fields(cdr, name, design_id, corner, position, normal, patch, module);
  }
};

struct Contact {
  std::array<double, 3> position{}, normal{};
  double force = 0.0, area = 0.0;
  std::vector<std::uint32_t> module;
  std::vector<std::uint8_t> taxel;
  std::vector<float> change, taxel_position, taxel_normal;
  void read(Cdr& cdr) {
    read_fields(cdr, position[0], position[1], position[2], normal[0], normal[1], normal[2], force, area, module, taxel,
                change, taxel_position, taxel_normal);
  }
};

struct Contacts {
  Header header;
  std::string force_unit;
  std::vector<Contact> contacts;
  void read(Cdr& cdr) {
    header.read(cdr);
    read_fields(cdr, force_unit);
    read_items(cdr, contacts);
  }
};

}  // namespace triskin::foreign
