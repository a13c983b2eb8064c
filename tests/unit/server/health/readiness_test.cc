#include "server/health/readiness.h"

#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::health {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

ReadinessFacts Good() {
  ReadinessFacts facts;
  facts.now = FromUnixMs(1'000'000'000'000);
  facts.certificate_expiry = facts.now + std::chrono::hours(24 * 90);
  facts.robots = {1, 10};
  facts.journal_bytes = {0, 1000};
  facts.journal_records = {0, 1000};
  facts.descriptors = {10, 1000};
  return facts;
}

TEST(Readiness, IsReadyAndWholeByDefault) {
  const Readiness readiness = ReadinessOf(Good());
  EXPECT_TRUE(readiness.ready());
  EXPECT_THAT(readiness.degraded, IsEmpty());
}

TEST(Readiness, IsNotReadyWhileTheServerStarts) {
  EXPECT_FALSE(StartingReadiness().ready());
  EXPECT_THAT(StartingReadiness().refuses, ElementsAre("starting"));
}

TEST(Readiness, RefusesWhileDraining) {
  ReadinessFacts facts = Good();
  facts.draining = true;
  EXPECT_THAT(ReadinessOf(facts).refuses, ElementsAre("draining"));
}

TEST(Readiness, RefusesFromTheMomentTheCertificateExpires) {
  ReadinessFacts facts = Good();
  facts.certificate_expiry = facts.now + milliseconds(1);
  EXPECT_TRUE(ReadinessOf(facts).ready());
  EXPECT_THAT(ReadinessOf(facts).degraded, ElementsAre("certificate_expiring"));
  facts.certificate_expiry = facts.now;
  EXPECT_THAT(ReadinessOf(facts).refuses, ElementsAre("certificate_expired"));
  EXPECT_THAT(ReadinessOf(facts).degraded, IsEmpty());
}

TEST(Readiness, ReportsFilesThatAreNotServed) {
  ReadinessFacts facts = Good();
  facts.certificate_fits = false;
  EXPECT_TRUE(ReadinessOf(facts).ready()) << "the last good ones are served";
  EXPECT_THAT(ReadinessOf(facts).degraded, ElementsAre("certificate_mismatch"));
  facts.draining = true;
  EXPECT_THAT(ReadinessOf(facts).all(), ElementsAre("draining", "certificate_mismatch"));
}

TEST(Readiness, ReportsTokensThatCannotBeRead) {
  ReadinessFacts facts = Good();
  facts.http.tokens_unread = true;
  EXPECT_TRUE(ReadinessOf(facts).ready());
  EXPECT_THAT(ReadinessOf(facts).degraded, ElementsAre("tokens_unread"));
}

TEST(Readiness, ReportsListsOfAuthoritiesThatCannotBeRead) {
  ReadinessFacts facts = Good();
  facts.http.crl_unread = true;
  EXPECT_TRUE(ReadinessOf(facts).ready());
  EXPECT_THAT(ReadinessOf(facts).degraded, ElementsAre("crl_unread"));
}

TEST(Readiness, ReportsThatItDoesNotKnowWhoMayNotComeIn) {
  ReadinessFacts facts = Good();
  facts.identity_unread = true;
  EXPECT_TRUE(ReadinessOf(facts).ready());
  EXPECT_THAT(ReadinessOf(facts).degraded, ElementsAre("identity"));
}

TEST(Readiness, ReportsAClockThatNobodyVouchesFor) {
  ReadinessFacts facts = Good();
  facts.clock_not_vouched = true;
  EXPECT_TRUE(ReadinessOf(facts).ready());
  EXPECT_THAT(ReadinessOf(facts).degraded, ElementsAre("clock"));
}

TEST(Readiness, ReportsARelayThatIsBehind) {
  ReadinessFacts facts = Good();
  facts.relay_behind = true;
  EXPECT_TRUE(ReadinessOf(facts).ready());
  EXPECT_THAT(ReadinessOf(facts).degraded, ElementsAre("relay_behind"));
}

TEST(Readiness, ReportsAStoreThatWentBack) {
  ReadinessFacts facts = Good();
  facts.store_went_back = true;
  EXPECT_TRUE(ReadinessOf(facts).ready());
  EXPECT_THAT(ReadinessOf(facts).degraded, ElementsAre("store_went_back"));
}

TEST(Readiness, ReportsAStoreThatIsKeptFromCleaningUp) {
  ReadinessFacts facts = Good();
  facts.store_old_snapshot = true;
  EXPECT_TRUE(ReadinessOf(facts).ready());
  EXPECT_THAT(ReadinessOf(facts).degraded, ElementsAre("store_old_snapshot"));
}

TEST(Readiness, ReportsAStoreWithLittleSpace) {
  ReadinessFacts facts = Good();
  facts.store_space_scarce = true;
  EXPECT_TRUE(ReadinessOf(facts).ready());
  EXPECT_THAT(ReadinessOf(facts).degraded, ElementsAre("store_space"));
}

TEST(Readiness, ReportsSeriesWithoutRoom) {
  ReadinessFacts facts = Good();
  facts.series_left_out = true;
  EXPECT_TRUE(ReadinessOf(facts).ready());
  EXPECT_THAT(ReadinessOf(facts).degraded, ElementsAre("series_max"));
}

TEST(Readiness, ReportsALeaseThatIsNotRenewed) {
  ReadinessFacts facts = Good();
  facts.lease_failing = true;
  EXPECT_TRUE(ReadinessOf(facts).ready());
  EXPECT_THAT(ReadinessOf(facts).degraded, ElementsAre("lease"));
}

TEST(Readiness, ReportsWhatIsWrongWithTheBroker) {
  const auto words_of = [](const BrokerFacts& broker) {
    ReadinessFacts facts = Good();
    facts.broker = broker;
    EXPECT_TRUE(ReadinessOf(facts).ready());
    return ReadinessOf(facts).degraded;
  };
  EXPECT_THAT(words_of({}), IsEmpty());
  EXPECT_THAT(words_of({.away = true}), ElementsAre("mqtt_away"));
  EXPECT_THAT(words_of({.filters = true}), ElementsAre("mqtt_filters"));
  EXPECT_THAT(words_of({.session_lost = true}), ElementsAre("mqtt_session_lost"));
  EXPECT_THAT(words_of({.id_taken = true}), ElementsAre("mqtt_id_taken"));
  EXPECT_THAT(words_of({.unread = true}), ElementsAre("mqtt_unread"));
  EXPECT_THAT(words_of({.twins = {89, 100}}), IsEmpty());
  EXPECT_THAT(words_of({.twins = {90, 100}}), ElementsAre("twins_max"));
}

TEST(Readiness, ReportsLiveStateOverItsBudget) {
  ReadinessFacts facts = Good();
  facts.live_state_over = true;
  EXPECT_TRUE(ReadinessOf(facts).ready());
  EXPECT_THAT(ReadinessOf(facts).degraded, ElementsAre("live_bytes_max"));
}

TEST(Readiness, ReportsTheCertificateOfHttpAndTakesRobotsWithoutIt) {
  ReadinessFacts facts = Good();
  const auto words_at = [&facts](SystemTime expiry) {
    facts.http.certificate_expiry = expiry;
    EXPECT_TRUE(ReadinessOf(facts).ready());
    return ReadinessOf(facts).degraded;
  };
  EXPECT_THAT(words_at(facts.now + kCertificateNotice), IsEmpty());
  EXPECT_THAT(words_at(facts.now + kCertificateNotice - milliseconds(1)),
              ElementsAre("certificate_expiring"));
  EXPECT_THAT(words_at(facts.now - milliseconds(1)), ElementsAre("certificate_expiring"));
  facts.http = {.certificate_fits = false};
  EXPECT_THAT(ReadinessOf(facts).degraded, ElementsAre("certificate_mismatch"));
}

TEST(Readiness, EveryWordIsOnceInItsList) {
  ReadinessFacts bad = Good();
  bad.store_failing = bad.store_unsafe = bad.store_space_scarce = bad.store_old_snapshot = true;
  bad.store_went_back = true;
  bad.clock_not_vouched = bad.lease_failing = bad.relay_behind = true;
  bad.forward_incomplete = bad.live_state_over = bad.series_left_out = true;
  bad.broker = {.away = true,
                .filters = true,
                .session_lost = true,
                .id_taken = true,
                .unread = true,
                .twins = {90, 100}};
  bad.journal_oldest = kBacklogAge + milliseconds(1);
  bad.robots = {10, 10};
  bad.certificate_expiry = bad.now + milliseconds(1);
  bad.certificate_fits = false;
  bad.http.tokens_unread = bad.http.crl_unread = bad.identity_unread = true;
  bad.descriptors = {1000, 1000};
  std::vector<std::string> words;
  for (const DegradedWord& each : DegradedWords()) words.emplace_back(each.word);
  EXPECT_EQ(ReadinessOf(bad).degraded, words) << "a word that no fact of this test brings about";
  EXPECT_EQ(std::set<std::string>(words.begin(), words.end()).size(), words.size());
}

TEST(Readiness, ReportsACertificateAWeekAhead) {
  ReadinessFacts facts = Good();
  facts.certificate_expiry = facts.now + kCertificateNotice;
  EXPECT_THAT(ReadinessOf(facts).degraded, IsEmpty());
  facts.certificate_expiry -= milliseconds(1);
  EXPECT_THAT(ReadinessOf(facts).degraded, ElementsAre("certificate_expiring"));
}

TEST(Readiness, AFleetThatIsNearlyFullIsDegradedAndStaysReady) {
  ReadinessFacts facts = Good();
  facts.robots = {89, 100};
  EXPECT_THAT(ReadinessOf(facts).degraded, IsEmpty());
  for (const std::size_t robots : {90U, 100U, 101U}) {
    facts.robots = {robots, 100};
    EXPECT_TRUE(ReadinessOf(facts).ready()) << robots;
    EXPECT_THAT(ReadinessOf(facts).degraded, ElementsAre("robots_max")) << robots;
  }
}

TEST(Readiness, IsDegradedButReadyWithoutTheStore) {
  ReadinessFacts facts = Good();
  facts.store_failing = true;
  EXPECT_TRUE(ReadinessOf(facts).ready());
  EXPECT_THAT(ReadinessOf(facts).degraded, ElementsAre("store"));
}

TEST(Readiness, ReportsABacklogByBytesRecordsAndAge) {
  ReadinessFacts at = Good();
  at.journal_bytes = {800, 1000};
  at.journal_records = {800, 1000};
  at.journal_oldest = kBacklogAge;
  EXPECT_THAT(ReadinessOf(at).degraded, IsEmpty());

  ReadinessFacts bytes = at;
  bytes.journal_bytes.used = 801;
  EXPECT_THAT(ReadinessOf(bytes).degraded, ElementsAre("journal_backlog"));
  ReadinessFacts records = at;
  records.journal_records.used = 801;
  EXPECT_THAT(ReadinessOf(records).degraded, ElementsAre("journal_backlog"));
  ReadinessFacts age = at;
  age.journal_oldest += milliseconds(1);
  EXPECT_THAT(ReadinessOf(age).degraded, ElementsAre("journal_backlog"));
}

TEST(Readiness, ReportsDescriptorsThatRunOut) {
  ReadinessFacts facts = Good();
  facts.descriptors = {900, 1000};
  EXPECT_THAT(ReadinessOf(facts).degraded, IsEmpty());
  facts.descriptors.used = 901;
  EXPECT_THAT(ReadinessOf(facts).degraded, ElementsAre("descriptors"));
}

TEST(Readiness, NamesEverythingAtOnce) {
  ReadinessFacts facts = Good();
  facts.draining = true;
  facts.robots = {10, 10};
  facts.store_failing = true;
  facts.descriptors = {1000, 1000};
  const Readiness readiness = ReadinessOf(facts);
  EXPECT_THAT(readiness.refuses, ElementsAre("draining"));
  EXPECT_THAT(readiness.degraded, ElementsAre("store", "robots_max", "descriptors"));
}

}  // namespace
}  // namespace uplink::health
