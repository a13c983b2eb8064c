#include "server/identity/invisible_characters.h"

#include <cstdint>
#include <string>

#include <gtest/gtest.h>

namespace uplink::identity {
namespace {

std::string Utf8(char32_t code) {
  const auto byte = [](char32_t bits) { return static_cast<char>(bits); };
  if (code < 0x80) return {byte(code)};
  if (code < 0x800) return {byte(0xC0 | (code >> 6U)), byte(0x80 | (code & 0x3FU))};
  if (code < 0x10000) {
    return {byte(0xE0 | (code >> 12U)), byte(0x80 | ((code >> 6U) & 0x3FU)),
            byte(0x80 | (code & 0x3FU))};
  }
  return {byte(0xF0 | (code >> 18U)), byte(0x80 | ((code >> 12U) & 0x3FU)),
          byte(0x80 | ((code >> 6U) & 0x3FU)), byte(0x80 | (code & 0x3FU))};
}

TEST(InvisibleCharacter, IsNotInNamesOfAnyScript) {
  for (const char* name : {"acme", "North 3", "Köln", "Værløse", "Łódź", "Москва", "Ελλάδα", "東京",
                           "서울", "ไทยรัฐ", "हिन्दी", "العربية", "עברית", "தமிழ்", "🤖"}) {
    EXPECT_EQ(InvisibleCharacter(name), std::nullopt) << name;
  }
}

TEST(InvisibleCharacter, IsFoundWhereverItStands) {
  for (const char32_t code :
       {0x80U,   0x85U,   0x9FU,                                 // C1
        0xADU,   0x200BU, 0x200CU, 0x200DU,  0x2060U,  0xFEFFU,  // of no width
        0x202EU, 0x2066U, 0x061CU, 0xE0041U, 0xFE0FU,            // marks
        0x2028U, 0x2029U,                                        // ends of lines
        0x378U,  0xFFFFU, 0xFDD0U, 0x2FE0U,  0x10FFFFU}) {       // not assigned
    EXPECT_EQ(InvisibleCharacter(Utf8(code)), code) << std::hex << std::uint32_t{code};
    EXPECT_EQ(InvisibleCharacter("a" + Utf8(code) + "b"), code) << std::hex << std::uint32_t{code};
    EXPECT_EQ(InvisibleCharacter("東" + Utf8(code)), code) << std::hex << std::uint32_t{code};
  }
}

TEST(InvisibleCharacter, EndsWithItsRuns) {
  // Beside C1, the soft hyphen and the first characters that are not assigned.
  for (const char32_t code : {0x7EU, 0xA0U, 0xACU, 0xAEU, 0x377U, 0x37AU, 0x2010U, 0xFFFDU}) {
    EXPECT_EQ(InvisibleCharacter(Utf8(code)), std::nullopt) << std::hex << std::uint32_t{code};
  }
}

TEST(InvisibleCharacter, ReadsNothingBehindTheText) {
  for (const char* cut : {"\xE2", "\xE2\x80", "\xF0\x9F\xA4", "\xC3", "\x80"}) {
    static_cast<void>(InvisibleCharacter(cut));
  }
}

}  // namespace
}  // namespace uplink::identity
