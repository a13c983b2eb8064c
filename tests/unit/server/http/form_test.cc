#include "server/http/form.h"

#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/server_world.h"

namespace uplink::http {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class FormTest : public ::testing::Test {
 protected:
  FormTest() { world_.AddRobot("rcan://a"); }

  Response Get(const Request& request) { return world_.Get(request); }
  Response Get(const std::string& target) { return world_.Get(target); }

  testing::ServerWorld world_;
};

constexpr const char* kRobots = "/api/v1/robots";

TEST_F(FormTest, OnlyLargeAnswersAreZipped) {
  Request request{Method::kGet, "/api/v1/config"};
  request.accept_encoding = "gzip";
  const Response large = Get(request);
  EXPECT_EQ(large.coding, "gzip");
  EXPECT_THAT(large.body, StartsWith("\x1f\x8b"));
  EXPECT_LT(large.body.size(), Get("/api/v1/config").body.size() / 2);
  request.target = "/api/v1/events";
  EXPECT_EQ(Get(request).coding, "") << "it is small";
  EXPECT_TRUE(Get(request).varies);
}

TEST_F(FormTest, AnswersAreZippedFromTheBoundOn) {
  const Route& route = Routes().back();
  RoutedRequest request;
  request.coding = metrics::Coding::kGzip;
  const auto coding_of = [&](std::size_t bytes) {
    Response answer;
    answer.body = std::string(bytes, 'x');
    return InFormOf(request, route, std::move(answer)).coding;
  };
  EXPECT_EQ(coding_of(kGzipBytesMin - 1), "");
  EXPECT_EQ(coding_of(kGzipBytesMin), "gzip");
  request.coding = metrics::Coding::kPlain;
  EXPECT_EQ(coding_of(kGzipBytesMin), "");
}

TEST_F(FormTest, WhatTheClientHasIsNotSentAgain) {
  for (const char* target : {kRobots, "/api/v1/robots/rcan%3A%2F%2Fa",
                             "/api/v1/robot?ruri=rcan%3A%2F%2Fa", "/api/v1/openapi.yaml"}) {
    Request request{Method::kGet, target};
    const Response first = Get(request);
    ASSERT_EQ(first.status, 200) << target;
    ASSERT_NE(first.entity_tag, "") << target;
    for (const std::string& header : {first.entity_tag, "\"x\", " + first.entity_tag,
                                      first.entity_tag.substr(2), std::string("*")}) {
      request.if_none_match = header;
      const Response second = Get(request);
      EXPECT_EQ(second.status, 304) << target << header;
      EXPECT_EQ(second.body, "");
      EXPECT_EQ(second.entity_tag, first.entity_tag);
      EXPECT_TRUE(second.varies);
    }
    request.if_none_match = "\"x\"";
    EXPECT_EQ(Get(request).status, 200) << target;
  }
}

TEST_F(FormTest, AChangeHasAnotherTag) {
  Request request{Method::kGet, kRobots};
  request.if_none_match = Get(request).entity_tag;
  world_.AddRobot("rcan://b");
  EXPECT_EQ(Get(request).status, 200);
  // Its lines are another text than its JSON.
  request.if_none_match = Get(request).entity_tag;
  request.accept = "application/x-ndjson";
  EXPECT_EQ(Get(request).status, 200);
}

TEST_F(FormTest, AnErrorHasNoTagAndIsNeverNotModified) {
  Request request{Method::kGet, "/api/v1/robot?ruri=rcan%3A%2F%2Fnobody"};
  request.if_none_match = "*";
  request.accept = "application/x-ndjson";
  const Response response = Get(request);
  EXPECT_EQ(response.status, 404);
  EXPECT_EQ(response.entity_tag, "");
  EXPECT_EQ(response.content_type, kJson);
  request.target = "/api/v1/events";
  EXPECT_EQ(Get(request).status, 200) << "histories have no tags";
}

TEST_F(FormTest, AListGoesAsLinesWithItsTokenAside) {
  world_.AddRobot("rcan://b");
  Request request{Method::kGet, "/api/v1/robots?pageSize=1"};
  request.accept = "application/x-ndjson";
  Response page = Get(request);
  EXPECT_EQ(page.content_type, "application/x-ndjson");
  EXPECT_THAT(page.body, StartsWith(R"({"ruri":"rcan://a")"));
  EXPECT_TRUE(page.body.ends_with("}\n"));
  ASSERT_NE(page.next_page_token, "");
  request.target += "&pageToken=" + page.next_page_token;
  page = Get(request);
  EXPECT_THAT(page.body, HasSubstr("rcan://b"));
  EXPECT_EQ(page.next_page_token, "");
  request.target = "/api/v1/robots/rcan%3A%2F%2Fa";
  EXPECT_EQ(Get(request).content_type, kJson) << "it is no list";
}

TEST_F(FormTest, ProbesStayAsTheyAre) {
  Request request{Method::kGet, "/readyz"};
  request.accept = "application/x-ndjson";
  request.if_none_match = "*";
  const Response response = Get(request);
  EXPECT_EQ(response.status, 200);
  EXPECT_EQ(response.body, R"({"degraded":[]})");
  EXPECT_FALSE(response.varies);
}

TEST_F(FormTest, TheOpenapiFileIsPartOfTheProgram) {
  const Response response = Get("/api/v1/openapi.yaml");
  EXPECT_EQ(response.content_type, "application/yaml");
  EXPECT_THAT(response.body, StartsWith("openapi: 3.1"));
  EXPECT_EQ(Get("/api/v1/openapi.yaml?x=1").status, 400);
}

TEST_F(FormTest, TheConfigurationSaysWhereEachKeyWasSet) {
  const std::string body = Get("/api/v1/config").body;
  EXPECT_THAT(body, StartsWith(R"({"file":"/etc/uplinkd/uplinkd.toml","sections":[{"name":)"));
  EXPECT_THAT(body, HasSubstr(R"({"key":"level","source":"file","place":"uplinkd.toml:7",)"
                              R"("effect":"reload","value":"info"})"));
  EXPECT_THAT(body, HasSubstr(R"({"key":"robots_max","source":"default","place":"",)"
                              R"("effect":"restart","value":20000})"));
  EXPECT_EQ(Get("/api/v1/config?section=log").status, 400);
}

}  // namespace
}  // namespace uplink::http
