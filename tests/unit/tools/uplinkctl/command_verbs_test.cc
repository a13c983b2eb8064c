#include "tools/uplinkctl/verbs/command_verbs.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/tools/uplinkctl/fake_api.h"
#include "tools/uplinkctl/verbs/lists.h"

namespace uplink::ctl {
namespace {

using ::testing::HasSubstr;

TEST(Labels, AreNamesAndValues) {
  const auto labels = LabelsOf({"site=hall 2", "url=a=b", "line="});
  ASSERT_TRUE(labels.ok()) << labels.status();
  EXPECT_EQ(boost::json::serialize(*labels), R"({"site":"hall 2","url":"a=b","line":""})");
  EXPECT_THAT(std::string(LabelsOf({"site"}).status().message()), HasSubstr("NAME=VALUE"));
}

TEST(Commands, SendTheirBodyAndShowRefusals) {
  std::string sent;
  link::HttpAnswer answer{200, R"({"blocked":true})"};
  Api api(
      {}, "/uplink", "that of the test",
      [&](const std::string& target, const std::string& json) -> absl::StatusOr<link::HttpAnswer> {
        sent = target + " " + json;
        return answer;
      });
  const auto done = api.Post("/api/v1/robot/block", {{"ruri", "rcan://a"}});
  ASSERT_TRUE(done.ok()) << done.status();
  EXPECT_TRUE(done->at("blocked").as_bool());
  EXPECT_EQ(sent, R"(/uplink/api/v1/robot/block {"ruri":"rcan://a"})");
  answer = {409, R"({"error":{"code":"RESOURCE_EXHAUSTED","message":"16 labels"}})"};
  EXPECT_EQ(api.Post("/x", {}).status().code(), absl::StatusCode::kResourceExhausted);
  answer = {405, R"({"error":{"code":"UNIMPLEMENTED","message":"GET and HEAD"}})"};
  EXPECT_THAT(std::string(api.Post("/x", {}).status().message()), HasSubstr("older"));
}

TEST(Lists, HaveTheAuditAndTheRevocations) {
  bool audit = false;
  bool revoked = false;
  for (const List& list : Lists()) {
    audit = audit || (list.noun == "audit" && list.member == "audit");
    revoked = revoked || (list.noun == "certificates" && list.verb == "revoked");
  }
  EXPECT_TRUE(audit);
  EXPECT_TRUE(revoked);
}

}  // namespace
}  // namespace uplink::ctl
