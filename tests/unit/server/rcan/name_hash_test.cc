#include "server/rcan/name_hash.h"

#include <string>

#include <gtest/gtest.h>

namespace uplink::rcan {
namespace {

TEST(NameHash, IsSipHash13) {
  // As CPython 3.11 says with PYTHONHASHSEED=0, whose key is zero: hash(b"joint_1") & (2**64 - 1).
  const NameHash hash({});
  EXPECT_EQ(hash("a"), 0x407448d2b89b1813U);
  EXPECT_EQ(hash("joint_1"), 0x4514f434d1270b98U) << "a byte less than a block";
  EXPECT_EQ(hash("12345678"), 0x3489982430560a87U) << "a block";
  EXPECT_EQ(hash("shoulder_pan"), 0x41f69f6b06c0438bU);
  EXPECT_EQ(hash(std::string(31, 'x')), 0x003e6ede9d87d836U);
}

TEST(NameHash, IsAnotherOneByAnotherKey) {
  EXPECT_NE(NameHash({1, 2})("a"), NameHash({1, 3})("a"));
  EXPECT_NE(NameHash({1, 2})("a"), NameHash({2, 2})("a"));
}

}  // namespace
}  // namespace uplink::rcan
