// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <map>
#include <random>

#include "triskin/layout/patch_image.hpp"
#include "triskin/wire/taxel_frames.hpp"
#include "vector_file.hpp"

namespace triskin {
namespace {

using test::from_hex;
using test::vector_rows;

static_assert(crc32(std::array<std::uint8_t, 9>{'1', '2', '3', '4', '5', '6', '7', '8', '9'}) == 0xCBF43926);

const std::map<std::string, Status> kStatus{{"ok", Status::kOk}, {"too_short", Status::kTooShort}, {"bad_magic", Status::kBadMagic},
                                            {"bad_version", Status::kBadVersion}, {"bad_length", Status::kBadLength},
                                            {"bad_crc", Status::kBadCrc}, {"out_of_range", Status::kOutOfRange},
                                            {"duplicate", Status::kDuplicate}, {"bad_tree", Status::kBadTree}};

TEST(PatchImage, every_vector_decodes_or_is_refused_as_written) {
  for (const auto& row : vector_rows("patch_image.txt")) {
    const auto bytes = from_hex(row[1]);
    const auto image = layout::decode(bytes);
    EXPECT_EQ(image ? Status::kOk : image.error(), kStatus.at(row[2])) << row[0];
    if (!image) continue;
    std::array<std::uint8_t, layout::kMaxImageBytes> out{};
    const auto size = layout::encode(*image, out);
    ASSERT_TRUE(size.has_value()) << row[0];
    EXPECT_EQ(std::vector<std::uint8_t>(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(*size)), bytes) << row[0];
  }
}

TEST(PatchImage, fields_of_the_first_vector) {
  const auto image = layout::decode(from_hex(vector_rows("patch_image.txt")[0][1]));
  ASSERT_TRUE(image);
  EXPECT_EQ(image->design_id, 0x1122334455667788U);
  EXPECT_EQ(image->node_address, 1);
  ASSERT_EQ(image->module_count, 2);
  EXPECT_EQ(image->modules[0], (layout::ModuleRow{7, 0, 0, 0, layout::kNoParent, layout::kCable, 2}));
  EXPECT_EQ(image->modules[1], (layout::ModuleRow{9, 1, 2, 1, 0, 1, 1}));
}

layout::PatchImage random_image(std::mt19937& random) {
  layout::PatchImage image;
  image.design_id = random() * 0x100000001ULL;
  image.node_address = static_cast<std::uint8_t>(1 + random() % 126);
  image.module_count = static_cast<std::uint8_t>(1 + random() % 16);
  std::array<int, 16> slots{};
  for (int k = 0; k < 16; ++k) slots[static_cast<std::size_t>(k)] = k;
  std::shuffle(slots.begin(), slots.end(), random);
  std::vector<std::pair<std::uint8_t, std::uint8_t>> free_ports;
  for (std::uint8_t k = 0; k < image.module_count; ++k) {
    auto& m = image.modules[k];
    m = {static_cast<std::uint16_t>(1000 + k), static_cast<std::uint8_t>(slots[k] / 4), static_cast<std::uint8_t>(slots[k] % 4),
         static_cast<std::uint8_t>(random() % 3), layout::kNoParent, layout::kCable, static_cast<std::uint8_t>(random() % 8)};
    if (k > 0) {
      const std::size_t pick = random() % free_ports.size();
      std::tie(m.parent, m.parent_port) = free_ports[pick];
      free_ports.erase(free_ports.begin() + static_cast<std::ptrdiff_t>(pick));
    }
    free_ports.emplace_back(k, std::uint8_t{1});
    free_ports.emplace_back(k, std::uint8_t{2});
  }
  return image;
}

TEST(PatchImage, random_images_survive_a_round_trip_and_no_flipped_bit_does) {
  std::mt19937 random(20260101);
  for (int trial = 0; trial < 200; ++trial) {
    const layout::PatchImage image = random_image(random);
    std::array<std::uint8_t, layout::kMaxImageBytes> bytes{};
    const auto size = layout::encode(image, bytes);
    ASSERT_TRUE(size.has_value());
    EXPECT_EQ(layout::decode(Bytes(bytes).first(*size)), image);
    const std::size_t bit = random() % (*size * 8);
    bytes[bit / 8] = static_cast<std::uint8_t>(bytes[bit / 8] ^ 1U << bit % 8);
    EXPECT_FALSE(layout::decode(Bytes(bytes).first(*size)).has_value()) << "bit " << bit;
  }
}

wire::CanFrame icub_frame(const std::string& text) {
  wire::CanFrame f;
  f.id = static_cast<std::uint32_t>(std::stoul(text.substr(0, 3), nullptr, 16));
  const auto bytes = from_hex(text.substr(4));
  f.size = static_cast<std::uint8_t>(bytes.size());
  std::copy(bytes.begin(), bytes.end(), f.data.begin());
  return f;
}

wire::IcubTaxels icub_fields(const std::string& text) {
  wire::IcubTaxels t;
  std::map<std::string, std::string> field;
  std::istringstream in(text);
  for (std::string item; in >> item;) field[item.substr(0, item.find('='))] = item.substr(item.find('=') + 1);
  const auto number = [&](const char* key) { return std::stoul(field.at(key), nullptr, 0); };
  t.board = static_cast<std::uint8_t>(number("board"));
  t.module = static_cast<std::uint8_t>(number("module"));
  t.out_of_range = static_cast<std::uint16_t>(number("out_of_range"));
  t.no_acknowledge = number("no_ack") != 0;
  t.not_connected = number("not_connected") != 0;
  std::istringstream values(field.at("values"));
  for (auto& v : t.value) {
    std::string item;
    std::getline(values, item, ',');
    v = static_cast<std::uint8_t>(std::stoul(item));
  }
  return t;
}

TEST(IcubTaxels, vectors_encode_and_decode) {
  for (const auto& row : vector_rows("icub_taxels.txt")) {
    const wire::IcubTaxels fields = icub_fields(row[1]);
    const auto frames = wire::encode_icub(fields);
    EXPECT_EQ(frames[0], icub_frame(row[2])) << row[0];
    EXPECT_EQ(frames[1], icub_frame(row[3])) << row[0];
    EXPECT_EQ(wire::decode_icub(icub_frame(row[2]), icub_frame(row[3])), fields) << row[0];
    EXPECT_FALSE(wire::decode_icub(icub_frame(row[3]), icub_frame(row[2])).has_value()) << row[0];
  }
}

TEST(FullTaxels, round_trip_and_refusals) {
  wire::FullTaxels t{5, 11, 0x01020304, 0x1122334455667788, 0xABC, 1, {}};
  for (std::size_t k = 0; k < t.value.size(); ++k) t.value[k] = static_cast<std::uint16_t>(0xF000 + k);
  wire::CanFrame f = wire::encode_full(t);
  EXPECT_EQ(f.id, 0x18F0050BU);
  EXPECT_EQ(f.size, 48);
  EXPECT_EQ(f.data[0], 0x04);   // little-endian sample number
  EXPECT_EQ(f.data[16], 0x00);  // first value, low byte
  EXPECT_EQ(f.data[17], 0xF0);
  EXPECT_EQ(wire::decode_full(f), t);
  f.size = 32;
  EXPECT_EQ(wire::decode_full(f).error(), Status::kBadLength);
  f.size = 48;
  f.data[15] = 3;  // module byte and identifier disagree
  EXPECT_EQ(wire::decode_full(f).error(), Status::kOutOfRange);
}

}  // namespace
}  // namespace triskin
