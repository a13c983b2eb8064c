#include "server/config/relations.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/config/minimal.h"

namespace uplink::config {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::uplink::config::testing::ParseWith;

/// The text of the one problem of kMinimal with `more`; empty if there is none.
std::string OneProblem(std::string_view more) {
  const LoadResult result = ParseWith(more);
  EXPECT_LE(result.problems.size(), 1U);
  if (result.problems.empty()) return {};
  EXPECT_THAT(result.problems[0].text, HasSubstr("; ")) << "what is wrong; what to do";
  return ToText(result.problems[0]);
}

TEST(RelationsTest, RequiresTheCertificateFiles) {
  EXPECT_THAT(ParseConfig("", "u.toml", {}).problems, SizeIs(3));
}

TEST(RelationsTest, AMessageMayBeAsLargeAsAPayloadButNotLarger) {
  EXPECT_EQ(OneProblem("[limits]\nmessage_bytes_max = \"256KiB\"\n"), "");
  EXPECT_THAT(OneProblem("[limits]\nmessage_bytes_max = \"257KiB\"\n"),
              HasSubstr("u.toml:6: limits.message_bytes_max: 257KiB is over "
                        "limits.payload_bytes_max, 256KiB"));
}

TEST(RelationsTest, APayloadMayBeAsLargeAsAFrameButNotLarger) {
  EXPECT_EQ(OneProblem("[limits]\npayload_bytes_max = \"1MiB\"\n"), "");
  EXPECT_THAT(OneProblem("[limits]\npayload_bytes_max = \"1025KiB\"\n"),
              HasSubstr("limits.payload_bytes_max: 1025KiB is over limits.frame_bytes_max"));
}

TEST(RelationsTest, ABatchMayTakeTheWholeJournalButNotMore) {
  EXPECT_EQ(OneProblem("[journal]\nrecords_max = 1000\n"), "");
  EXPECT_THAT(OneProblem("[journal]\nrecords_max = 999\n"),
              HasSubstr("journal.batch_records_max: 1000 is over journal.records_max, 999"));
}

TEST(RelationsTest, HttpStaysOnLoopback) {
  EXPECT_EQ(OneProblem("[listen]\nhttp = \"[::1]:7480\"\n"), "");
  EXPECT_EQ(OneProblem("[listen]\nhttp = \"unix:/run/uplinkd/http.sock\"\n"), "");
  EXPECT_THAT(OneProblem("[listen]\nhttp = \"0.0.0.0:7480\"\n"),
              AllOf(HasSubstr("listen.http: 0.0.0.0:7480 is not a loopback address"),
                    HasSubstr("http.tokens_file"), HasSubstr("tls.operator_ca_file"),
                    HasSubstr("[::1]"), HasSubstr("unix:")));
}

TEST(RelationsTest, HttpListensAnywhereWhereCallersShowWhoTheyAre) {
  constexpr const char* kAnywhere = "[listen]\nhttp = \"0.0.0.0:7480\"\n[http]\n";
  const std::string tls = "tls.certificate_file = \"h.crt\"\ntls.key_file = \"h.key\"\n";
  const std::string tokens = "tokens_file = \"tokens\"\n";
  EXPECT_EQ(OneProblem(kAnywhere + tls), "");
  EXPECT_EQ(OneProblem(kAnywhere + tls + tokens), "");
  EXPECT_EQ(OneProblem(kAnywhere + tokens + "plain_from = [\"10.0.0.0/8\"]\n"), "");
  EXPECT_THAT(OneProblem(kAnywhere + tokens),
              HasSubstr("http.plain_from: listen.http, 0.0.0.0:7480, speaks no TLS"));
  EXPECT_EQ(OneProblem("[http]\n" + tokens), "") << "on loopback";
  EXPECT_THAT(OneProblem("[http]\nplain_from = []\n"),
              HasSubstr("http.plain_from: listen.http, 127.0.0.1:7480, speaks no TLS, and no "
                        "address may speak plain HTTP"));
  EXPECT_EQ(OneProblem("[http]\nplain_from = []\n" + tls), "");
  EXPECT_EQ(OneProblem("[listen]\nhttp = \"unix:/run/s\"\n[http]\nplain_from = []\n"), "");
}

TEST(RelationsTest, HttpsCertificateNeedsItsKey) {
  EXPECT_THAT(OneProblem("[http]\ntls.certificate_file = \"h.crt\"\n"),
              HasSubstr("http.tls.key_file: it is required where http.tls.certificate_file is"));
  EXPECT_THAT(OneProblem("[http]\ntls.key_file = \"h.key\"\n"),
              HasSubstr("http.tls.certificate_file: it is required where http.tls.key_file is"));
}

TEST(RelationsTest, TheModeOfTheSocketIsOctal) {
  for (const char* const good : {"600", "0660", "0777"}) {
    EXPECT_EQ(OneProblem(std::string("[http]\nsocket_mode = \"") + good + "\"\n"), "") << good;
  }
  for (const char* const bad : {"", "66", "1777", "0680", "rw-", "00660"}) {
    EXPECT_THAT(OneProblem(std::string("[http]\nsocket_mode = \"") + bad + "\"\n"),
                HasSubstr("is no mode"))
        << bad;
  }
  EXPECT_EQ(ParseSocketMode("0640"), 0640U);
}

TEST(ConfigTest, OperatorsAreVerifiedByTheirOwnAuthoritiesIfTheyHaveAny) {
  TlsConfig tls;
  tls.client_ca_file = "ca";
  EXPECT_EQ(OperatorCaFile(tls), "ca");
  tls.operator_ca_file = "op";
  EXPECT_EQ(OperatorCaFile(tls), "op");
}

TEST(RelationsTest, TwoListenersDoNotShareAPort) {
  EXPECT_THAT(OneProblem("[listen]\nhttp = \"127.0.0.1:7443\"\n"),
              HasSubstr("listen.http: 127.0.0.1:7443 is taken by listen.relay, [::]:7443; give one "
                        "of them another port"));
  EXPECT_EQ(OneProblem("[listen]\nhttp = \"127.0.0.2:7999\"\nrelay = \"127.0.0.1:7999\"\n"), "");
  EXPECT_EQ(OneProblem("[listen]\nhttp = \"127.0.0.1:0\"\nrelay = \"[::]:0\"\n"), "");
}

TEST(RelationsTest, MetricsListenOnAnyAddressThatNoOtherListenerHas) {
  for (const char* const free :
       {"", "127.0.0.1:9090", "0.0.0.0:9090", "[::]:9090", "192.0.2.7:7480", "[::]:0"}) {
    EXPECT_EQ(OneProblem(std::string("[listen]\nmetrics = \"") + free + "\"\n"), "") << free;
  }
  EXPECT_THAT(OneProblem("[listen]\nmetrics = \"192.0.2.7:7443\"\n"),
              HasSubstr("u.toml:6: listen.metrics: 192.0.2.7:7443 is taken by listen.relay, "
                        "[::]:7443"));
  for (const char* const taken : {"127.0.0.1:7480", "0.0.0.0:7480", "[::]:7480"}) {
    EXPECT_THAT(OneProblem(std::string("[listen]\nmetrics = \"") + taken + "\"\n"),
                HasSubstr("is taken by listen.http, 127.0.0.1:7480"))
        << taken;
  }
}

TEST(RelationsTest, OnlyAnAbsoluteSqlitePathIsAStore) {
  EXPECT_EQ(OneProblem("[store]\nurl = \"sqlite:///x.db\"\n"), "");
  for (const char* const url :
       {"", "sqlite://", "sqlite:///", "sqlite://x.db", "sqlite:///x/", "/x.db", "mysql://h/d"}) {
    const std::string more = std::string("[store]\nurl = \"") + url + "\"\n";
    EXPECT_THAT(OneProblem(more), HasSubstr("store.url: it names no store; write sqlite:///"))
        << url;
  }
}

TEST(RelationsTest, PostgresIsRefusedWithoutRepeatingItsPassword) {
  const std::string problem = OneProblem("[store]\nurl = \"postgresql://me:pw@h/d\"\n");
  EXPECT_THAT(problem, HasSubstr("store.url: holds a password; name a file in"));
  EXPECT_EQ(problem.find("pw"), std::string::npos);
  EXPECT_THAT(OneProblem("[store]\nurl = \"postgresql://h/d?no_such=1\"\n"),
              HasSubstr("; write postgresql://USER@HOST/DATABASE"));
}

TEST(RelationsTest, TheSubsystemIsAWordOfASeriesName) {
  EXPECT_EQ(OneProblem("[rcan]\nsubsystem = \"" + std::string(32, 'a') + "\"\n"), "");
  for (const std::string& word :
       {std::string(), std::string("A"), std::string("a-b"), std::string(33, 'a')}) {
    EXPECT_THAT(OneProblem("[rcan]\nsubsystem = \"" + word + "\"\n"), HasSubstr("rcan.subsystem"))
        << word;
  }
}

TEST(RelationsTest, TheSubsystemNamesNoSeriesTwice) {
  for (const char* word : {"robot_battery", "robot_cpu"}) {
    EXPECT_THAT(OneProblem(std::string("[rcan]\nsubsystem = \"") + word + "\"\n"),
                HasSubstr("would name two series rcan_robot_"))
        << word;
  }
  for (const char* word : {"robot", "robot_arm"}) {
    EXPECT_EQ(OneProblem(std::string("[rcan]\nsubsystem = \"") + word + "\"\n"), "") << word;
  }
}

TEST(RelationsTest, HostsAreNamesWithoutSchemeAndPort) {
  const std::string longest(253, 'a');
  EXPECT_EQ(OneProblem("[http]\nhosts = [\"uplink.example.org\", \"" + longest + "\"]\n"), "");
  for (const std::string& host :
       {std::string("https://uplink.example.org"), std::string("uplink.example.org:443"),
        std::string("*.example.org"), std::string(254, 'a')}) {
    EXPECT_THAT(OneProblem("[http]\nhosts = [\"" + host + "\"]\n"), HasSubstr("http.hosts"))
        << host;
  }
}

TEST(RelationsTest, ABadValueIsNotReportedTwice) {
  EXPECT_THAT(ParseWith("[store]\nurl = 5\n").problems, SizeIs(1));
}

TEST(RelationsTest, TheDefaultsLackOnlyTheFiles) {
  Config config;
  EXPECT_THAT(CheckRelations(config), SizeIs(3));
  config.tls.certificate_file = "a";
  config.tls.key_file = "b";
  config.tls.client_ca_file = "c";
  EXPECT_THAT(CheckRelations(config), IsEmpty());
}

TEST(RelationsTest, TheTemplateOfDronesNamesThemAll) {
  EXPECT_EQ(OneProblem("[uncrew]\nruri_template = \"rcan://a/{uav_id}\"\n"), "");
  EXPECT_THAT(OneProblem("[uncrew]\nruri_template = \"rcan://a/b\"\n"),
              HasSubstr("uncrew.ruri_template: it names no {uav_id}"));
}

}  // namespace
}  // namespace uplink::config
