// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/wire/topology.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <string>

#include "vectors/vector_file.hpp"

namespace triskin::wire {
namespace {

using test::Vector;

FoundTopology found_of(const Vector& v, std::uint8_t flags) {
  FoundTopology t;
  t.switched = (flags & 1) != 0;
  t.complete = (flags & 2) != 0;
  t.second_cable = (flags & 4) != 0;
  t.cable_port = static_cast<std::uint8_t>(v.number("cable"));
  for (const std::uint64_t row : test::numbers(v.one("rows"), 10)) t.row.at(t.count++) = static_cast<std::uint8_t>(row);
  std::istringstream joints(v.one("joints"));
  for (std::string joint; joints >> joint;) {  // A joint is written as M.P-M.P.
    const auto end = [&](std::size_t at) {
      return std::pair(static_cast<std::size_t>(joint[at] - '0'), static_cast<std::size_t>(joint[at + 2] - 'A'));
    };
    const auto [m, p] = end(0);
    const auto [n, q] = end(4);
    t.joints[m][p] = layout::joint_to(n, q);
    t.joints[n][q] = layout::joint_to(m, p);
  }
  return t;
}

ActiveRoute route_of(const Vector& v, Bytes bytes) {
  ActiveRoute a;
  const auto has = [&](const char* name) {
    std::istringstream flags(v.one("flags"));
    return std::find(std::istream_iterator<std::string>(flags), {}, name) != std::istream_iterator<std::string>();
  };
  a.switched = has("switched");
  a.busy = has("busy");
  a.complete = has("complete");
  a.as_table = has("as_table");
  a.min_depth = has("least_depth");
  a.second_cable = has("second_cable");
  a.shorts = bytes[1];
  a.unknown = bytes[2];
  a.max_depth = bytes[3];
  for (const std::uint64_t row : test::numbers(v.one("alive"), 10))
    a.alive = static_cast<std::uint16_t>(a.alive | 1U << row);
  a.reroutes = static_cast<std::uint32_t>(v.number("heals"));
  a.repairs = bytes[10];
  a.last_us = static_cast<std::uint32_t>(v.number("last_us"));
  a.parent.fill(kNoRow);
  a.parent_port.fill(layout::kCable);
  a.rows = static_cast<std::uint8_t>((bytes.size() - ActiveRoute::kMinBytes) / ActiveRoute::kRowBytes);
  std::istringstream parents(v.one("parents"));
  std::size_t row = 0;
  for (std::string parent; parents >> parent; ++row) {
    const auto dot = parent.find('.');
    a.parent.at(row) = static_cast<std::uint8_t>(std::stoi(parent.substr(0, dot)));
    a.parent_port.at(row) = static_cast<std::uint8_t>(std::stoi(parent.substr(dot + 1)));
  }
  return a;
}

template <class Message>
std::vector<std::uint8_t> encoded(const Message& m) {
  std::array<std::uint8_t, 256> buffer{};
  ByteWriter w(buffer);
  m.encode(w);
  const Bytes b = w.written();
  return {b.begin(), b.end()};
}

TEST(TopologyVectors, encode_and_decode_as_the_file_says) {
  int found = 0, route = 0, refused = 0;
  for (const Vector& v : test::read_vectors("topology.txt")) {
    SCOPED_TRACE(v.name);
    if (v.has("found")) {
      const auto bytes = test::hex_bytes(v.one("found"));
      const FoundTopology expected = found_of(v, bytes[0]);
      EXPECT_EQ(FoundTopology::decode(bytes), expected);
      EXPECT_EQ(encoded(expected), bytes);
      ++found;
    } else if (v.has("route")) {
      const auto bytes = test::hex_bytes(v.one("route"));
      const ActiveRoute expected = route_of(v, bytes);
      EXPECT_EQ(ActiveRoute::decode(bytes), expected);
      EXPECT_EQ(encoded(expected), bytes);
      ++route;
    } else if (v.has("refused")) {
      EXPECT_FALSE(FoundTopology::decode(test::hex_bytes(v.one("refused"))));
      ++refused;
    } else {
      EXPECT_FALSE(ActiveRoute::decode(test::hex_bytes(v.one("refused_route"))));
      ++refused;
    }
  }
  EXPECT_EQ(found, 5);
  EXPECT_EQ(route, 3);
  EXPECT_EQ(refused, 13);
}

}  // namespace
}  // namespace triskin::wire
