#include "server/identity/der_reader.h"

#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "tests/support/der.h"

namespace uplink::identity {
namespace {

namespace der = uplink::testing::der;

Bytes BytesOf(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// Whether the bytes begin with an element that is taken.
bool IsTaken(const std::string& bytes) { return DerReader(BytesOf(bytes)).Take().has_value(); }

TEST(DerReader, TakesElementsOneAfterTheOther) {
  const std::string bytes = der::Integer("\x05") + der::Octets(std::string(300, 'x'));
  DerReader reader(BytesOf(bytes));
  EXPECT_TRUE(reader.IsNext(DerTag::kInteger));
  const auto number = reader.Take(DerTag::kInteger);
  ASSERT_TRUE(number);
  EXPECT_EQ(number->size(), 1U);
  EXPECT_EQ(number->front(), 5);
  EXPECT_FALSE(reader.empty());
  const auto octets = reader.Take();
  ASSERT_TRUE(octets);
  EXPECT_EQ(octets->tag, 4);
  EXPECT_EQ(octets->content.size(), 300U);
  EXPECT_TRUE(reader.empty());
  EXPECT_FALSE(reader.Take());
}

TEST(DerReader, AnotherTagIsLeftWhereItIs) {
  const std::string bytes = der::Null();
  DerReader reader(BytesOf(bytes));
  EXPECT_FALSE(reader.Take(DerTag::kSequence));
  EXPECT_TRUE(reader.Take(DerTag::kNull));
}

TEST(DerReader, ALengthHasItsShortestForm) {
  EXPECT_TRUE(IsTaken(der::Octets(std::string(127, 'x'))));
  EXPECT_TRUE(IsTaken(der::Octets(std::string(128, 'x'))));
  EXPECT_TRUE(IsTaken(der::Octets(std::string(255, 'x'))));
  EXPECT_TRUE(IsTaken(der::Octets(std::string(256, 'x'))));
  EXPECT_TRUE(IsTaken(der::Octets(std::string(0xFFFF, 'x'))));
  EXPECT_TRUE(IsTaken(der::Octets(std::string(0x10000, 'x'))));
  EXPECT_FALSE(IsTaken(std::string("\x04\x81\x7F", 3) + std::string(127, 'x')));
  EXPECT_FALSE(IsTaken(std::string("\x04\x82\x00\xFF", 4) + std::string(255, 'x')));
  EXPECT_FALSE(IsTaken(std::string("\x04\x83\x00\xFF\xFF", 5) + std::string(0xFFFF, 'x')));
  EXPECT_FALSE(IsTaken(std::string("\x04\x84\x00\x01\x00\x00", 6) + std::string(0x10000, 'x')));
}

TEST(DerReader, AnIndefiniteLengthIsNotTaken) {
  EXPECT_FALSE(IsTaken(std::string("\x30\x80\x02\x01\x01\x00\x00", 7)));
}

TEST(DerReader, ATagOfSeveralBytesIsNotTaken) {
  EXPECT_FALSE(IsTaken(std::string("\x1F\x01\x00", 3)));
  EXPECT_FALSE(IsTaken(std::string("\xBF\x01\x00", 3)));
}

TEST(DerReader, AnElementEndsWithinWhatIsRead) {
  const std::string whole = der::Octets(std::string(300, 'x'));
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_FALSE(IsTaken(whole.substr(0, size))) << size;
  }
  EXPECT_TRUE(IsTaken(whole));
}

}  // namespace
}  // namespace uplink::identity
