#include "server/http/target.h"

#include <gtest/gtest.h>

namespace uplink::http {
namespace {

TEST(PercentDecode, ResolvesBothCasesAndLeavesPlusAlone) {
  EXPECT_EQ(PercentDecode("rcan%3A%2F%2Fa%2fb+c"), "rcan://a/b+c");
  EXPECT_EQ(PercentDecode(""), "");
  EXPECT_EQ(PercentDecode("%ff"), "\xff");
}

TEST(PercentDecode, RefusesBrokenSequencesAndNul) {
  for (const char* bad : {"%", "a%2", "%zz", "%2g", "%00"}) {
    EXPECT_EQ(PercentDecode(bad), std::nullopt) << bad;
  }
}

TEST(MatchPath, TakesOneEncodedSegment) {
  const auto match = MatchPath("/api/v1/robots/{}/gaps", "/api/v1/robots/rcan%3A%2F%2Fa%2Fb/gaps");
  ASSERT_TRUE(match);
  EXPECT_EQ(match->segment, "rcan://a/b");
}

TEST(MatchPath, RefusesOtherPaths) {
  for (const char* path :
       {"/api/v1/robots", "/api/v1/robots/", "/api/v1/robots//gaps", "/api/v1/robots/a",
        "/api/v1/robots/a/b/gaps", "/api/v1/robots/a/gaps/", "/api/v1/robots/a%2/gaps"}) {
    EXPECT_FALSE(MatchPath("/api/v1/robots/{}/gaps", path)) << path;
  }
  EXPECT_TRUE(MatchPath("/livez", "/livez"));
  EXPECT_FALSE(MatchPath("/livez", "/livez/"));
}

TEST(SplitTarget, CutsAtTheFirstQuestionMark) {
  EXPECT_EQ(SplitTarget("/a?b=c?d").path, "/a");
  EXPECT_EQ(SplitTarget("/a?b=c?d").query, "b=c?d");
  EXPECT_EQ(SplitTarget("/a").query, "");
}

TEST(SplitAbsolute, FindsTheAuthorityAndTheRest) {
  struct Case {
    const char* target;
    const char* authority;
    const char* rest;
  };
  for (const Case& each :
       {Case{"http://a/b?c=http://d/", "a", "/b?c=http://d/"},
        Case{"HTTP://a:7480/", "a:7480", "/"}, Case{"https://a:7480/b", "a:7480", "/b"},
        Case{"http://[::1]", "[::1]", "/"}, Case{"http://a?b", "a", "/?b"},
        Case{"http://a//b", "a", "//b"}}) {
    ASSERT_TRUE(IsAbsolute(each.target)) << each.target;
    const auto whole = SplitAbsolute(each.target);
    ASSERT_TRUE(whole) << each.target;
    EXPECT_EQ(whole->authority, each.authority);
    EXPECT_EQ(whole->target, each.rest);
  }
}

TEST(SplitAbsolute, FindsNoHostWhereNoneIs) {
  for (const char* bad : {"http://", "http:///a", "http://?a", "http://:80/a", "http://me@a/b"}) {
    ASSERT_TRUE(IsAbsolute(bad)) << bad;
    EXPECT_FALSE(SplitAbsolute(bad)) << bad;
  }
  for (const char* other : {"", "/", "*", "http:/", "ftp://a/b", "/http://a/b", "a:80"}) {
    EXPECT_FALSE(IsAbsolute(other)) << other;
  }
}

}  // namespace
}  // namespace uplink::http
