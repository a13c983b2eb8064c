#include "server/identity/ruri.h"

#include <string>

#include <gtest/gtest.h>

namespace uplink::identity {
namespace {

std::string FormOf(std::string_view ruri) { return FlawOfForm(ruri).value_or(""); }

TEST(FlawOfForm, ACanonicalRuriHasNone) {
  for (const char* const ruri : {"rcan://f/one", "rcan://example.org:8443/Acme/Rover/1",
                                 "rcan://local.rcan/a/b.", "rcan://x"}) {
    EXPECT_EQ(FormOf(ruri), "") << ruri;
  }
}

TEST(FlawOfForm, EachOtherSpellingOfARobotHasOne) {
  EXPECT_EQ(FormOf("rcan://Example.org/a"), "has a host with capital letters");
  EXPECT_EQ(FormOf("rcan://example.org./a"), "has a host that ends with a dot");
  EXPECT_EQ(FormOf("rcan://example.org.:8443/a"), "has a host that ends with a dot");
  EXPECT_EQ(FormOf("rcan://example.org."), "has a host that ends with a dot");
  EXPECT_EQ(FormOf("rcan://example.org/a?sig=x"), "holds a query");
  EXPECT_EQ(FormOf("rcan://example.org/a#b"), "holds a fragment");
}

}  // namespace
}  // namespace uplink::identity
