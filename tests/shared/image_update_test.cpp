// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the frames of tests/vectors/image_update.txt, which docs/protocol.md shows, and frames that must be refused.
#include "triskin/wire/image_update.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>
#include <sstream>

#include "triskin/layout/image_label.hpp"
#include "triskin/wire/identity.hpp"
#include "vectors/frame_text.hpp"

namespace triskin::wire::update {
namespace {

using test::frame_of;
using test::Vector;

Vector named(const std::string& name) {
  for (const Vector& v : test::read_vectors("image_update.txt")) {
    if (v.name == name) return v;
  }
  throw std::runtime_error("no vector " + name);
}

template <class T>
T number(const Vector& v, const char* key) {
  return static_cast<T>(v.number(key));
}

Offer offer_of(const Vector& v) {
  return {number<std::uint8_t>(v, "slot"),     v.number("older") != 0, number<std::uint32_t>(v, "bytes"),
          number<std::uint32_t>(v, "version"), crc32(kPartNumber),     number<std::uint32_t>(v, "crc")};
}

std::vector<std::uint16_t> units_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::uint16_t> units;
  for (unsigned u = 0; in >> u;) units.push_back(static_cast<std::uint16_t>(u));
  return units;
}

TEST(ImageUpdateVectors, an_offer_in_four_frames) {
  const Vector v = named("an offer");
  const auto session = number<std::uint16_t>(v, "session");
  const auto frames = v.all("frame");
  const auto orders = encode_offer(offer_of(v), session);
  ASSERT_EQ(frames.size(), orders.size());
  OfferParts parts;
  std::optional<Offer> whole;
  for (std::size_t k = 0; k < orders.size(); ++k) {
    EXPECT_EQ(encode_order(orders[k]), frame_of(frames[k])) << k;
    EXPECT_FALSE(whole);
    whole = parts.add(decode_order(frame_of(frames[k])).value());
  }
  EXPECT_EQ(whole, offer_of(v));
}

TEST(ImageUpdateVectors, commands_data_and_answers) {
  const Vector join = named("join");
  EXPECT_EQ(encode_order(order_to(static_cast<Command>(join.number("command")), number<std::uint16_t>(join, "session"),
                                  number<std::uint32_t>(join, "id_crc"))),
            frame_of(join.one("frame")));
  for (const char* name : {"data", "data in an FD frame"}) {
    const Vector v = named(name);
    const CanFrame f = frame_of(v.one("frame"));
    EXPECT_EQ(encode_data(number<std::uint8_t>(v, "slot"), number<std::uint16_t>(v, "unit"), f.payload()), f);
    EXPECT_TRUE(is_data(f));
    EXPECT_EQ(data_slot(f.id), v.number("slot"));
    EXPECT_EQ(data_unit(f.id), v.number("unit"));
  }
  const auto same = [](const Vector& v, const auto& bytes) {
    EXPECT_TRUE(std::ranges::equal(frame_of(v.one("frame")).payload(), bytes)) << v.name;
  };
  const Vector who = named("who"), image = named("which image");
  const Who w{kProtocol, number<std::uint8_t>(who, "slot"), who.number("confirmed") != 0,
              number<std::uint32_t>(who, "version")};
  same(who, encode_who(w));
  EXPECT_EQ(decode_who(frame_of(who.one("frame")).payload()), w);
  const Image i{number<std::uint32_t>(image, "crc"), number<std::uint32_t>(image, "sequence")};
  same(image, encode_image(i));
  EXPECT_EQ(decode_image(frame_of(image.one("frame")).payload()), i);
  for (const char* name : {"a state", "refused"}) {
    const Vector v = named(name);
    const State s{static_cast<Phase>(v.number("phase")), static_cast<Status>(v.number("status")),
                  number<std::uint16_t>(v, "session"), number<std::uint16_t>(v, "count")};
    same(v, encode_state(s));
    EXPECT_EQ(decode_state(frame_of(v.one("frame")).payload()), s);
  }
}

TEST(ImageUpdateVectors, missing_units_as_a_list_or_as_a_bitmap) {
  for (const char* name : {"some missing", "many missing"}) {
    const Vector v = named(name);
    const auto units = units_of(v.one("missing"));
    MissingPart part(units[0], 8);
    for (std::size_t k = 1; k < units.size(); ++k) EXPECT_TRUE(part.add(units[k])) << name << k;
    const CanFrame f = frame_of(v.one("frame"));
    EXPECT_TRUE(std::ranges::equal(f.payload(), Bytes(part.encode()).first(8))) << name;
    std::vector<std::uint16_t> found;
    EXPECT_EQ(decode_missing(f.payload(), [&](std::uint16_t u) { found.push_back(u); }), Status::kOk);
    EXPECT_EQ(found, units);
  }
}

TEST(ImageUpdate, any_set_of_missing_units_comes_through) {
  std::mt19937 random(22);
  for (int run = 0; run < 400; ++run) {
    std::set<std::uint16_t> missing;
    const auto share = 1 + random() % 1000, count = 1 + random() % kMaxUnits;
    for (std::size_t u = 0; u < count; ++u) {
      if (random() % 1000 < share) missing.insert(static_cast<std::uint16_t>(u));
    }
    const std::size_t bytes = run % 2 == 0 ? 8 : 64;
    std::set<std::uint16_t> found;
    for (auto at = missing.begin(); at != missing.end();) {
      MissingPart part(*at, bytes);
      for (++at; at != missing.end() && part.add(*at);) ++at;
      ASSERT_EQ(decode_missing(Bytes(part.encode()).first(bytes), [&](std::uint16_t u) { found.insert(u); }),
                Status::kOk);
    }
    ASSERT_EQ(found, missing) << "run " << run << " of seed 22";
  }
}

TEST(ImageUpdate, damaged_frames_are_refused) {
  const Vector v = named("an offer");
  const auto orders = encode_offer(offer_of(v), number<std::uint16_t>(v, "session"));
  const auto completes = [](const auto& list) {
    OfferParts parts;
    bool any = false;
    for (const Order& o : list) any = parts.add(o).has_value() || any;
    return any;
  };
  ASSERT_TRUE(completes(orders));
  // One order is lost, one belongs to another session, one is sent twice.
  for (std::size_t k = 0; k < orders.size(); ++k) {
    std::vector<Order> list(orders.begin(), orders.end());
    list.erase(list.begin() + static_cast<std::ptrdiff_t>(k));
    EXPECT_FALSE(completes(list)) << k;
    list.assign(orders.begin(), orders.end());
    list[k].session ^= 1;
    EXPECT_FALSE(completes(list)) << k;
  }
  auto wrong_key = orders;
  wrong_key[1].arguments[4] ^= 1;
  EXPECT_FALSE(completes(wrong_key));
  auto no_slot = orders;
  no_slot[0].arguments[0] = 2;
  EXPECT_FALSE(completes(no_slot));

  CanFrame f = encode_order(orders[0]);
  f.size = 7;
  EXPECT_EQ(decode_order(f).error(), Status::kBadLength);
  f = encode_order(orders[0]);
  for (const int none : {0, 12, 255}) {
    f.data[0] = static_cast<std::uint8_t>(none);
    EXPECT_EQ(decode_order(f).error(), Status::kOutOfRange);
  }
  auto state = encode_state({});
  state[1] = 8;
  EXPECT_EQ(decode_state(state).error(), Status::kOutOfRange);
  EXPECT_EQ(decode_who(state).error(), Status::kBadMagic);
  const std::array<std::uint8_t, 8> beyond{wire_number(Answer::kList), 0xFF, 0xFF, 0, 0, 0, 0, 0};
  EXPECT_EQ(decode_missing(beyond, [](std::uint16_t) {}), Status::kOutOfRange);
}

TEST(ImageLabel, stands_behind_the_vectors) {
  const layout::ImageLabel label{kPartNumber, 0x00020000, 0x08040000};
  std::vector<std::uint8_t> image(600, 0xFF);
  EXPECT_EQ(layout::decode_label(image).error(), Status::kBadMagic);
  std::ranges::copy(layout::encode_label(label), image.begin() + 0x1D8);
  EXPECT_EQ(layout::decode_label(image), label);
  image[0x1D8 + 4] = 2;
  EXPECT_EQ(layout::decode_label(image).error(), Status::kBadVersion);
  EXPECT_EQ(layout::decode_label(Bytes(image).first(495)).error(), Status::kTooShort);
}

}  // namespace
}  // namespace triskin::wire::update
