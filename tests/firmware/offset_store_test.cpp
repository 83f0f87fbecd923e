// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/logic/storage/offset_store.hpp"

#include <gtest/gtest.h>

#include <random>

#include "flash_double.hpp"

namespace triskin::test {
namespace {

using fw::OffsetBook;
using fw::OffsetStore;
using Flash = FlashDouble<fw::FlashArea>;

constexpr std::size_t kPageBytes = Flash::kPage, kSlots = kPageBytes / OffsetStore::kRecordBytes;

void put(OffsetBook& book, std::size_t place, std::uint8_t steps) {
  fw::PlaceOffsets& p = book[place];
  p.known = p.to_store = true;
  p.device_id = 0x1472;
  p.steps.fill(steps);
}
void write_all(OffsetStore& store, OffsetBook& book) {
  int n = 0;
  while (n < 10'000 && store.step(book)) ++n;
  ASSERT_LT(n, 10'000);
}
OffsetBook read_anew(Flash& flash) {
  OffsetBook book{};
  OffsetStore store(flash);
  store.load(book);
  return book;
}

TEST(OffsetStore, KeepsWhatWasPut) {
  Flash flash;
  OffsetStore store(flash);
  OffsetBook book{};
  store.load(book);
  EXPECT_FALSE(store.step(book));
  put(book, 3, 31);
  book[3].steps[11] = 63;
  put(book, 15, 7);
  write_all(store, book);
  EXPECT_EQ(flash.operations(), 2 * 4);  // Each record has units of eight bytes, and a fresh board needs no erase.
  const OffsetBook again = read_anew(flash);
  EXPECT_EQ(again[3].steps, book[3].steps);
  EXPECT_EQ(again[3].device_id, 0x1472);
  EXPECT_TRUE(again[3].known && again[15].known);
  EXPECT_FALSE(again[0].known);
  EXPECT_EQ(again[15].steps[0], 7);
}

TEST(OffsetStore, WritesOneUnitAStep) {
  Flash flash;
  OffsetStore store(flash);
  OffsetBook book{};
  store.load(book);
  for (std::size_t p = 0; p < book.size(); ++p) put(book, p, 31);
  int before = flash.operations();
  while (store.step(book)) {
    EXPECT_LE(flash.operations() - before, 1);
    before = flash.operations();
  }
}

TEST(OffsetStore, TheRecordIsAsInTheDocument) {
  Flash flash;
  OffsetStore store(flash);
  OffsetBook book{};
  store.load(book);
  put(book, 5, 31);
  write_all(store, book);
  const Bytes record = flash.bytes().subspan(6 * kPageBytes, 32);
  const std::vector<std::uint8_t> head{'O', 'F', 1, 5, 1, 0, 0, 0, 0x72, 0x14};
  EXPECT_TRUE(std::ranges::equal(record.first(10), head));
  EXPECT_TRUE(std::ranges::all_of(record.subspan(10, 12), [](std::uint8_t b) { return b == 31; }));
  EXPECT_EQ(ByteReader(record.subspan(28)).le32(), crc32(record.first(28)));
}

TEST(OffsetStore, OfAnotherVersionOrDamagedIsNotRead) {
  for (const std::size_t at : {2U, 12U}) {
    Flash flash;
    OffsetStore store(flash);
    OffsetBook book{};
    store.load(book);
    put(book, 5, 31);
    write_all(store, book);
    ++flash.raw()[6 * kPageBytes + at];
    EXPECT_FALSE(read_anew(flash)[5].known) << at;
  }
}

TEST(OffsetStore, TheNewestCountsThroughManyPages) {
  Flash flash;
  auto store = std::make_unique<OffsetStore>(flash);
  OffsetBook book{};
  store->load(book);
  std::mt19937 random(3);
  std::array<std::uint8_t, 16> steps{};
  for (std::size_t n = 0; n < 12 * kSlots; ++n) {
    const std::size_t place = random() % 4 == 0 ? random() % 16 : 2;  // Most places change rarely.
    steps[place] = static_cast<std::uint8_t>(random() % 64);
    put(book, place, steps[place]);
    write_all(*store, book);
    if (n % 37 == 0) {  // This simulates a power-up.
      store = std::make_unique<OffsetStore>(flash);
      book = {};
      store->load(book);
    }
    for (std::size_t p = 0; p < 16; ++p) {
      if (book[p].known) {
        ASSERT_EQ(read_anew(flash)[p].steps[0], steps[p]) << n << " place " << p;
      }
    }
  }
}

// Power is cut in each operation of filling two pages: afterwards every place has its old or its new offsets, and can
// be written.
TEST(OffsetStore, ACutOfPowerLosesNothingButTheRecordUnderWay) {
  for (const auto tear : {Flash::Tear::kNothing, Flash::Tear::kHalf, Flash::Tear::kAll}) {
    for (int cut = 0; cut < 330; ++cut) {
      Flash flash;
      OffsetStore store(flash);
      OffsetBook book{};
      store.load(book);
      for (std::size_t p = 0; p < 16; ++p) put(book, p, 1);
      write_all(store, book);
      flash.cut_after(cut, tear);
      std::uint8_t written = 1, started = 1;
      try {
        for (std::uint8_t n = 2; n < 60; ++n) {
          started = n;
          put(book, 9, n);
          write_all(store, book);
          written = n;
        }
      } catch (const sim::PowerLost&) {
      }
      flash.never_cut();
      OffsetBook after = read_anew(flash);
      for (std::size_t p = 0; p < 16; ++p) {
        ASSERT_TRUE(after[p].known) << "cut " << cut << " place " << p;
        const std::uint8_t got = after[p].steps[0];
        ASSERT_TRUE(p == 9 ? got == written || got == started : got == 1) << "cut " << cut << " place " << p;
      }
      OffsetStore next(flash);
      next.load(after);
      put(after, 9, 63);
      write_all(next, after);
      ASSERT_EQ(read_anew(flash)[9].steps[0], 63) << "cut " << cut;
    }
  }
}

TEST(OffsetStore, AFlashThatRefusesStopsTheWritingAndASmallOneKeepsNothing) {
  Flash flash;
  flash.refuse(true);
  OffsetStore store(flash);
  OffsetBook book{};
  store.load(book);
  put(book, 1, 31);
  write_all(store, book);
  EXPECT_TRUE(book[1].known);
  Flash small(6);
  OffsetStore none(small);
  none.load(book);
  put(book, 1, 31);
  EXPECT_FALSE(none.step(book));
}

}  // namespace
}  // namespace triskin::test
