#include "server/robot/opening.h"

#include <gtest/gtest.h>

namespace uplink::robot {
namespace {

TEST(OpeningTest, TheAnswerToTheLastQuestionIsTakenOnce) {
  Opening opening;
  const std::uint64_t id = opening.Ask();
  EXPECT_FALSE(opening.answered(id));
  opening.Answer(id, {.cursor = 9});
  EXPECT_TRUE(opening.answered(id));
  const auto answer = opening.Take(id);
  ASSERT_TRUE(answer.has_value());
  EXPECT_EQ(answer->cursor, 9U);
  EXPECT_FALSE(opening.Take(id).has_value());
}

TEST(OpeningTest, AnAnswerToAnOlderQuestionDoesNotCount) {
  Opening opening;
  const std::uint64_t first = opening.Ask();
  const std::uint64_t second = opening.Ask();
  opening.Answer(first, {.cursor = 9});
  EXPECT_FALSE(opening.answered(first));
  EXPECT_FALSE(opening.Take(second).has_value());
}

TEST(OpeningTest, AfterWelcomeALateAnswerIsNotKept) {
  Opening opening;
  const std::uint64_t id = opening.Ask();
  EXPECT_FALSE(opening.Take(id).has_value());
  opening.Answer(id, {.cursor = 9});
  EXPECT_FALSE(opening.answered(id));
}

TEST(OpeningTest, ALateAnswerIsKeptWhereItIsWanted) {
  Opening opening;
  const std::uint64_t id = opening.Ask();
  EXPECT_FALSE(opening.Take(id).has_value());
  opening.WantLate();
  EXPECT_FALSE(opening.came_late());
  opening.Answer(id, {.cursor = 9});
  EXPECT_TRUE(opening.came_late());
  EXPECT_EQ(opening.Take(id)->cursor, 9U);
  EXPECT_FALSE(opening.came_late());
}

TEST(OpeningTest, ANewQuestionWantsNoLateAnswerToTheOlder) {
  Opening opening;
  const std::uint64_t first = opening.Ask();
  EXPECT_FALSE(opening.Take(first).has_value());
  opening.WantLate();
  const std::uint64_t second = opening.Ask();
  opening.Answer(first, {.cursor = 9});
  opening.Answer(second, {.cursor = 9});
  EXPECT_FALSE(opening.came_late()) << "Welcome waits for it";
}

TEST(OpeningTest, WhatIsForgottenIsNotAnswered) {
  Opening opening;
  const std::uint64_t id = opening.Ask();
  opening.Answer(id, {.cursor = 9});
  opening.Forget();
  EXPECT_FALSE(opening.answered(id));
}

}  // namespace
}  // namespace uplink::robot
