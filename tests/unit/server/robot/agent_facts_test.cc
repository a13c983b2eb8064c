#include "server/robot/agent_facts.h"

#include <gtest/gtest.h>

namespace uplink::robot {
namespace {

storage::ConnectionItem Item(std::uint8_t id, const std::string& version,
                             std::optional<SystemTime> not_after) {
  storage::ConnectionItem item;
  item.id[0] = id;
  item.agent_version = version;
  item.certificate.not_after = not_after;
  return item;
}

TEST(AgentFactsTest, TheCertificateIsThatOfTheConnectionThatBeganLast) {
  AgentFacts facts;
  EXPECT_EQ(facts.Get().certificate_not_after, std::nullopt);
  facts.Begin(Item(1, "a", FromUnixMs(1)));
  facts.Begin(Item(2, "b", FromUnixMs(2)));
  EXPECT_EQ(facts.Get().certificate_not_after, FromUnixMs(2));
  facts.End(Item(2, "", {}).id);
  EXPECT_EQ(facts.Get().certificate_not_after, FromUnixMs(1)) << "an older one is still open";
  facts.End(Item(1, "", {}).id);
  facts.End(Item(1, "", {}).id);
  EXPECT_EQ(facts.Get().certificate_not_after, std::nullopt);
}

TEST(AgentFactsTest, AVersionStaysUntilAnotherIsTold) {
  AgentFacts facts;
  facts.Begin(Item(1, "1.0", {}));
  facts.Begin(Item(2, "", {}));
  facts.End(Item(1, "", {}).id);
  EXPECT_EQ(facts.Get().version, "1.0");
  facts.Begin(Item(3, "1.1", {}));
  EXPECT_EQ(facts.Get().version, "1.1");
}

TEST(AgentFactsTest, RemembersAtMostItsBound) {
  AgentFacts facts;
  for (std::uint8_t id = 0; id <= kAgentConnectionsMax; ++id) {
    facts.Begin(Item(id, "", FromUnixMs(id + 1)));
  }
  for (std::uint8_t id = 1; id <= kAgentConnectionsMax; ++id) facts.End(Item(id, "", {}).id);
  EXPECT_EQ(facts.Get().certificate_not_after, std::nullopt) << "the oldest one was forgotten";
}

}  // namespace
}  // namespace uplink::robot
