// What an ack rests on, whatever the server, a pooler or an operator does to the session.
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "schema/base/clock.h"
#include "tests/support/records.h"
#include "tests/unit/storage/postgres_fixture.h"

namespace uplink::storage::postgres {
namespace {

/// A store on a database whose triggers do what a server does that stands between us and the disk.
class PostgresWarningTest : public PostgresFixture {
 protected:
  void SetUp() override {
    store_ = Store();
    held_since_ = Open().held_since;
  }
  OpenResult Open() { return PostgresFixture::Open(*store_); }
  absl::StatusOr<std::vector<Outcome>> Commit(const std::vector<model::Seq>& numbers) {
    Batch batch;
    for (const model::Seq seq : numbers) batch.records.push_back(Note(seq, held_since_));
    return store_->Commit(batch);
  }
  /// A trigger of one statement that the role of the store runs.
  void AddTrigger(const std::string& when, const std::string& statement) {
    const std::string name = "trigger_" + std::to_string(++triggers_);
    shell_.Run("CREATE FUNCTION public." + name +
               "() RETURNS trigger LANGUAGE plpgsql AS $$ BEGIN " + statement +
               " RETURN NEW; END $$");
    std::string sql = "CREATE ";
    sql += when;
    sql.replace(sql.find("NAME"), 4, name);
    shell_.Run(sql + " FOR EACH ROW EXECUTE FUNCTION public." + name + "()");
  }
  void AddAtCommit(const std::string& statement) {
    AddTrigger(
        "CONSTRAINT TRIGGER NAME AFTER INSERT OR UPDATE ON uplinkd.sessions"
        " DEFERRABLE INITIALLY DEFERRED",
        statement);
  }

  std::unique_ptr<PostgresStore> store_;
  Epoch held_since_ = 0;
  int triggers_ = 0;
};

TEST_F(PostgresWarningTest, ACommitWithAWarningIsOfUnknownOutcome) {
  AddAtCommit("RAISE WARNING 'not replicated';");
  const auto unknown = Commit({1, 2});
  EXPECT_TRUE(absl::IsUnavailable(unknown.status())) << unknown.status();
  EXPECT_NE(unknown.status().message().find("not replicated"), absl::string_view::npos)
      << unknown.status();
  EXPECT_EQ(store_->facts().commits_in_doubt, 1U);
  EXPECT_EQ(shell_.Read("SELECT count(*) FROM uplinkd.messages"), "2\n") << "it is there, maybe";
  // A duplicate moves no cursor, so nothing warns.
  const auto again = Commit({1, 2});
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ((*again)[0].kind, OutcomeKind::kDuplicate);
  EXPECT_EQ((*again)[1].kind, OutcomeKind::kDuplicate);
  EXPECT_EQ(shell_.Read("SELECT count(*) FROM uplinkd.messages"), "2\n");
}

TEST_F(PostgresWarningTest, AStreamWhoseOpeningWarnsIsNotOpen) {
  AddAtCommit("RAISE WARNING 'not replicated';");
  const OpenRequest request{robot_, session_, 0, FromUnixMs(kNowMs), {}};
  EXPECT_TRUE(absl::IsUnavailable(store_->OpenStreams({&request, 1}).status()));
}

TEST_F(PostgresWarningTest, AWarningOfAnotherStatementIsNoMatterOfTheCommit) {
  AddTrigger("TRIGGER NAME BEFORE INSERT ON uplinkd.messages", "RAISE WARNING 'how odd';");
  // With the preparations of the statements, and without.
  EXPECT_TRUE(Commit({1}).ok());
  EXPECT_TRUE(Commit({2}).ok());
  EXPECT_EQ(store_->facts().commits_in_doubt, 0U);
}

TEST_F(PostgresWarningTest, WhatAnAckRestsOnIsSetInEachTransaction) {
  shell_.Run("CREATE TABLE public.seen (settings text); GRANT INSERT ON public.seen TO uplinkd");
  // As a pooler does that lends the session to somebody else in between.
  AddTrigger("TRIGGER NAME BEFORE INSERT ON uplinkd.messages",
             "PERFORM set_config('synchronous_commit', 'off', false);"
             " PERFORM set_config('client_min_messages', 'error', false);");
  ASSERT_TRUE(Commit({1}).ok());
  shell_.Run("DROP TRIGGER trigger_1 ON uplinkd.messages");
  AddAtCommit(
      "INSERT INTO public.seen VALUES"
      " (current_setting('synchronous_commit') || ' ' || current_setting('client_min_messages'));");
  EXPECT_TRUE(Commit({2}).ok());
  EXPECT_TRUE(Commit({2, 3}).ok()) << "with a look at what is there first";
  Open();
  EXPECT_EQ(shell_.Read("SELECT settings FROM public.seen"),
            "on warning\non warning\non warning\n");
}

}  // namespace
}  // namespace uplink::storage::postgres
