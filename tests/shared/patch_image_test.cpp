// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/layout/patch_image.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

#include "vectors/vector_file.hpp"

namespace triskin {
namespace {

using layout::ModuleRow;
using layout::PatchImage;
using test::Vector;

const std::map<std::string, Status> kStatusNames = {
    {"ok", Status::kOk},
    {"too_short", Status::kTooShort},
    {"bad_magic", Status::kBadMagic},
    {"bad_version", Status::kBadVersion},
    {"bad_length", Status::kBadLength},
    {"bad_crc", Status::kBadCrc},
    {"out_of_range", Status::kOutOfRange},
    {"duplicate", Status::kDuplicate},
    {"bad_tree", Status::kBadTree},
};

std::vector<std::uint8_t> bytes_of(const Vector& v) {
  std::vector<std::uint8_t> bytes;
  for (const std::string& line : v.all("hex")) {
    const auto more = test::hex_bytes(line);
    bytes.insert(bytes.end(), more.begin(), more.end());
  }
  return bytes;
}

ModuleRow row_of(const std::string& text) {
  std::istringstream in(text);
  unsigned id = 0, line = 0, address = 0, rotation = 0;
  std::string word, parent, port;
  in >> id >> word >> line >> word >> address >> word >> rotation >> word >> parent >> word >> port;
  const auto small = [](unsigned x) { return static_cast<std::uint8_t>(x); };
  return {static_cast<std::uint16_t>(id),
          small(line),
          small(address),
          small(rotation),
          parent == "none" ? layout::kNoParent : small(static_cast<unsigned>(std::stoul(parent))),
          port == "cable" ? layout::kCable : small(static_cast<unsigned>(std::stoul(port)))};
}

PatchImage image_of(const Vector& v) {
  PatchImage image;
  image.design_id = v.number("design_id");
  image.node_address = static_cast<std::uint8_t>(v.number("node"));
  image.positive_input = v.has("positive_input");
  for (const std::string& row : v.all("module")) image.modules[image.module_count++] = row_of(row);
  return image;
}

TEST(PatchImageVectors, DecodeAsTheFileSays) {
  const auto vectors = test::read_vectors("patch_image.txt");
  ASSERT_GE(vectors.size(), 20U);
  for (const Vector& v : vectors) {
    SCOPED_TRACE(v.name);
    const auto decoded = layout::decode(bytes_of(v));
    EXPECT_EQ(decoded ? Status::kOk : decoded.error(), kStatusNames.at(v.one("status")));
    if (decoded) {
      EXPECT_EQ(*decoded, image_of(v));
    }
  }
}

TEST(PatchImageVectors, EncodeToTheSameBytes) {
  for (const Vector& v : test::read_vectors("patch_image.txt")) {
    if (v.one("status") != "ok" || v.has("decode_only")) continue;
    SCOPED_TRACE(v.name);
    std::array<std::uint8_t, layout::kMaxImageBytes> out{};
    const auto size = layout::encode(image_of(v), out);
    ASSERT_TRUE(size);
    EXPECT_EQ(std::vector(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(*size)), bytes_of(v));
  }
}

PatchImage random_image(std::mt19937& random) {
  const auto below = [&](unsigned n) { return static_cast<std::uint8_t>(random() % n); };
  PatchImage image;
  image.design_id = static_cast<std::uint64_t>(random()) << 32 | random();
  image.node_address = static_cast<std::uint8_t>(layout::kFirstNode + below(layout::kMaxNodes));
  image.module_count = static_cast<std::uint8_t>(1 + below(layout::kMaxModules));
  std::array<int, layout::kMaxModules> slots{};
  for (int k = 0; k < layout::kMaxModules; ++k) slots[static_cast<std::size_t>(k)] = k;
  std::shuffle(slots.begin(), slots.end(), random);
  std::vector<std::pair<std::uint8_t, std::uint8_t>> free_ports;  // The pairs are parent and port.
  for (std::uint8_t k = 0; k < image.module_count; ++k) {
    ModuleRow& m = image.modules[k];
    m = {static_cast<std::uint16_t>(k * 257U),
         static_cast<std::uint8_t>(slots[k] / 4),
         static_cast<std::uint8_t>(slots[k] % 4),
         below(3),
         layout::kNoParent,
         layout::kCable};
    if (k > 0) {
      const auto at = static_cast<std::ptrdiff_t>(random() % free_ports.size());
      std::tie(m.parent, m.parent_port) = free_ports[static_cast<std::size_t>(at)];
      free_ports.erase(free_ports.begin() + at);
    }
    free_ports.emplace_back(k, 1);
    free_ports.emplace_back(k, 2);
  }
  return image;
}

TEST(PatchImage, RandomImagesSurviveTheRoundTrip) {
  std::mt19937 random(1);
  for (int run = 0; run < 2000; ++run) {
    const PatchImage image = random_image(random);
    std::array<std::uint8_t, layout::kMaxImageBytes> bytes{};
    const auto size = layout::encode(image, bytes);
    ASSERT_TRUE(size) << static_cast<int>(size.error());
    const auto decoded = layout::decode(Bytes(bytes));  // The slot is longer than the image.
    ASSERT_TRUE(decoded) << static_cast<int>(decoded.error());
    EXPECT_EQ(*decoded, image);
  }
}

TEST(PatchImage, EveryBitFlipAndEveryTruncationIsRefused) {
  std::mt19937 random(2);
  const PatchImage image = random_image(random);
  std::array<std::uint8_t, layout::kMaxImageBytes> bytes{};
  const std::size_t size = layout::encode(image, bytes).value();
  for (std::size_t bit = 0; bit < size * 8; ++bit) {
    auto damaged = bytes;
    damaged[bit / 8] = static_cast<std::uint8_t>(damaged[bit / 8] ^ (1U << (bit % 8)));
    EXPECT_FALSE(layout::decode(Bytes(damaged).first(size))) << "bit " << bit;
  }
  for (std::size_t n = 0; n < size; ++n) EXPECT_FALSE(layout::decode(Bytes(bytes).first(n))) << n << " bytes";
}

TEST(PatchImage, RandomBytesNeverPass) {
  std::mt19937 random(3);
  for (int run = 0; run < 20000; ++run) {
    std::array<std::uint8_t, layout::kMaxImageBytes> bytes{};
    for (auto& b : bytes) b = static_cast<std::uint8_t>(random());
    std::array<std::uint8_t, layout::kMaxImageBytes> good{};
    (void)layout::encode(random_image(random), good);
    std::copy_n(good.begin(), random() % 32, bytes.begin());  // The random bytes get a plausible beginning.
    EXPECT_FALSE(layout::decode(Bytes(bytes).first(random() % bytes.size())));
  }
}

TEST(PatchImage, TooSmallABufferIsRefused) {
  PatchImage image;
  image.module_count = 1;
  std::array<std::uint8_t, 43> out{};
  EXPECT_EQ(layout::encode(image, out).error(), Status::kNoSpace);
}

TEST(Crc32, MatchesTheCheckValueOfItsCatalogue) {
  constexpr std::array<std::uint8_t, 9> kDigits{'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  static_assert(crc32(kDigits) == 0xCBF43926);
  EXPECT_EQ(crc32(Bytes(kDigits).subspan(4), crc32(Bytes(kDigits).first(4))), 0xCBF43926U);
}

TEST(Bytes, RunningOverTheEndIsNoticed) {
  std::array<std::uint8_t, 3> out{};
  ByteWriter w(out);
  w.le16(0x1234);
  EXPECT_TRUE(w.ok());
  w.be16(0x5678);
  EXPECT_FALSE(w.ok());
  EXPECT_EQ(out, (std::array<std::uint8_t, 3>{0x34, 0x12, 0x56}));
  ByteReader r(out);
  EXPECT_EQ(r.be32(), 0x34125600U);
  EXPECT_FALSE(r.ok());
}

}  // namespace
}  // namespace triskin
