#include "server/http/errors.h"

#include <chrono>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::http {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kTelling =
    "postgresql db.internal:5432: list faults: relation \"uplinkd.faults\" (42P01)";

TEST(Errors, NameNeitherStatementNorHostAndKeepTheCauseForTheLog) {
  for (const absl::StatusCode code :
       {absl::StatusCode::kUnavailable, absl::StatusCode::kAborted, absl::StatusCode::kInternal,
        absl::StatusCode::kResourceExhausted, absl::StatusCode::kDeadlineExceeded,
        absl::StatusCode::kInvalidArgument, absl::StatusCode::kOutOfRange,
        absl::StatusCode::kUnknown}) {
    const Response response = ErrorResponse(absl::Status(code, kTelling));
    EXPECT_GE(response.status, 400);
    EXPECT_THAT(response.body, Not(HasSubstr("db.internal"))) << code;
    EXPECT_THAT(response.body, Not(HasSubstr("42P01"))) << code;
    EXPECT_EQ(response.cause, kTelling) << code;
  }
}

TEST(Errors, WhatWeSayOfARequestIsShownWhole) {
  const Response token = ErrorResponse(absl::InvalidArgumentError("pageToken is not one of ours"));
  EXPECT_EQ(token.status, 400);
  EXPECT_THAT(token.body, HasSubstr("pageToken is not one of ours"));
  EXPECT_THAT(token.body, HasSubstr(R"("field":"pageToken")"));
  EXPECT_EQ(token.cause, "");
  EXPECT_THAT(ErrorResponse(absl::NotFoundError("no robot a")).body, HasSubstr("no robot a"));
}

TEST(Errors, AReadAtItsLimitIs504AndNamesIt) {
  const Response response = ErrorResponse(absl::DeadlineExceededError("57014"));
  EXPECT_EQ(response.status, 504);
  EXPECT_THAT(response.body, HasSubstr(R"("code":"DEADLINE_EXCEEDED")"));
  EXPECT_THAT(response.body, HasSubstr("store.timeout"));
}

TEST(Errors, WhoHasNotShownWhoItIsLearnsHow) {
  const Response none = Unauthenticated("show who you are");
  EXPECT_EQ(none.status, 401);
  EXPECT_EQ(none.authenticate, "Bearer");
  const Response invalid = InvalidToken("the token has expired");
  EXPECT_EQ(invalid.status, 401);
  EXPECT_EQ(invalid.authenticate, R"(Bearer error="invalid_token")");
  EXPECT_EQ(Forbid("x").status, 403);
  const Response later = TooManyFailures(std::chrono::seconds(60));
  EXPECT_EQ(later.status, 429);
  EXPECT_EQ(later.retry_after, std::chrono::seconds(60));
  EXPECT_EQ(TokenInAddress().status, 400);
}

TEST(Errors, AStoreThatIsAwayIs503) {
  EXPECT_EQ(ErrorResponse(absl::UnavailableError("x")).status, 503);
  EXPECT_EQ(ErrorResponse(absl::InternalError("x")).status, 500);
}

TEST(Errors, ACommandIsToldWhatItAskedWronglyAndWhatStandsAgainstIt) {
  const Response field = CommandError(absl::InvalidArgumentError("note must be text in UTF-8"));
  EXPECT_EQ(field.status, 400);
  EXPECT_THAT(field.body, HasSubstr(R"("field":"note")"));
  const Response none = CommandError(absl::NotFoundError("no robot a"));
  EXPECT_EQ(none.status, 404);
  EXPECT_THAT(none.body, HasSubstr("no robot a"));
  const Response twin = CommandError(absl::FailedPreconditionError("a has no stream"));
  EXPECT_EQ(twin.status, 409);
  EXPECT_THAT(twin.body, HasSubstr(R"("code":"FAILED_PRECONDITION")"));
  const Response bound = CommandError(absl::ResourceExhaustedError("too many"));
  EXPECT_EQ(bound.status, 409);
  EXPECT_EQ(bound.retry_after, std::chrono::seconds(0));
}

TEST(Errors, ACommandShowsNothingThatTheStoreSaysOfItself) {
  const Response away = CommandError(absl::UnavailableError(kTelling));
  EXPECT_EQ(away.status, 503);
  EXPECT_THAT(away.body, Not(HasSubstr("db.internal")));
  EXPECT_EQ(away.cause, kTelling);
}

}  // namespace
}  // namespace uplink::http
