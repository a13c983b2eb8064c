// Every way to break the protocol, as the agent sees it over the wire.
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/relay_world.h"

namespace uplink::testing {
namespace {

using ::testing::HasSubstr;

/// What an agent does wrong, and what it is told: its call ends as INVALID_ARGUMENT.
struct Fault {
  const char* name;
  /// True: a Hello and its Welcome come first.
  bool after_welcome;
  std::vector<std::string> frames;
  const char* text;
};

std::string Bytes(const v1::RelayRequest& frame) { return frame.SerializeAsString(); }

std::string Hello(const std::function<void(v1::Hello&)>& change) {
  v1::RelayRequest frame = HelloFrame(SessionOf(1));
  change(*frame.mutable_hello());
  return Bytes(frame);
}

std::string Numbers(const std::vector<model::Seq>& numbers) {
  std::vector<Sent> messages;
  messages.reserve(numbers.size());
  for (const model::Seq seq : numbers) messages.push_back({seq, MotionPayload()});
  return Bytes(BatchFrame(messages));
}

std::string NotUtf8InHello() {
  // The checked setter of the library takes the bytes, but says so in the log: build them by hand.
  std::string hello = HelloFrame(SessionOf(1)).hello().SerializeAsString();
  hello += std::string("\x2a\x02\xc3\x28", 4);  // agent_version, two bytes
  std::string frame = "\x0a";
  frame.push_back(static_cast<char>(hello.size()));
  return frame + hello;
}

constexpr auto kInvalid = grpc::StatusCode::INVALID_ARGUMENT;
constexpr model::Seq kPastMax = model::kSeqMax + 1;

Fault AtFirst(const char* name, const std::vector<std::string>& frames, const char* text) {
  return {name, false, frames, text};
}

Fault Later(const char* name, const std::vector<std::string>& frames, const char* text) {
  return {name, true, frames, text};
}

std::vector<Fault> FrameFaults() {
  return {
      AtFirst("NotProtobuf", {"\xff\xff\xff"}, "frame 1: not a RelayRequest"),
      AtFirst("TextNotUtf8", {NotUtf8InHello()}, "frame 1: not a RelayRequest"),
      Later("NotProtobufLater", {Numbers({1}), "\x0a\x7f"}, "frame 3: not a RelayRequest"),
      AtFirst("EmptyFrame", {std::string()}, "frame 1: it holds neither hello, batch nor goodbye"),
      AtFirst("BatchFirst", {Numbers({1})}, "frame 1: the first frame must be a hello"),
      Later("HelloTwice", {Bytes(HelloFrame(SessionOf(1)))},
            "frame 2: hello: only the first frame may be one"),
  };
}

std::vector<Fault> HelloFaults() {
  const auto session = [](std::size_t bytes) {
    return Hello([&](v1::Hello& hello) { hello.set_session_id(std::string(bytes, 'x')); });
  };
  return {
      AtFirst("SessionIdShort", {session(15)}, "frame 1: hello.session_id: 15 bytes"),
      AtFirst("SessionIdLong", {session(17)}, "frame 1: hello.session_id: 17 bytes"),
      AtFirst("SchemaUnspecified", {Hello([](v1::Hello& hello) { hello.clear_schema(); })},
              "frame 1: hello.schema: it must be given"),
      AtFirst("SchemaUnknown", {Hello([](v1::Hello& hello) {
                hello.set_schema(static_cast<v1::PayloadSchema>(99));
              })},
              "frame 1: hello.schema: 99"),
      AtFirst("AgentVersionLong",
              {Hello([](v1::Hello& hello) { hello.set_agent_version(std::string(257, 'v')); })},
              "frame 1: hello.agent_version: 257 bytes"),
      AtFirst("RuriLong",
              {Hello([](v1::Hello& hello) { hello.set_robot_ruri(std::string(257, 'r')); })},
              "frame 1: hello.robot_ruri: 257 bytes"),
      AtFirst("JudgedBelowSettled", {Bytes(HelloFrame(SessionOf(1), 5, 4))},
              "frame 1: hello.judged_seq: 4 is below settled_seq 5"),
      AtFirst("SettledPastMax", {Bytes(HelloFrame(SessionOf(1), kPastMax, kPastMax))},
              "frame 1: hello.settled_seq: 9223372036854775808 is over 2^63-1"),
      AtFirst("JudgedPastMax", {Bytes(HelloFrame(SessionOf(1), 1, kPastMax))},
              "frame 1: hello.judged_seq: 9223372036854775808 is over 2^63-1"),
  };
}

std::vector<Fault> NumberFaults() {
  return {
      Later("NumberZero", {Numbers({0})}, "frame 2: batch.uplinks[0].seq: it must be at least 1"),
      Later("NumberPastMax", {Numbers({kPastMax})},
            "frame 2: batch.uplinks[0].seq: 9223372036854775808 is over 2^63-1"),
      Later("NumberTwiceInAFrame", {Numbers({1, 2, 2})},
            "frame 2: batch.uplinks[2].seq: 2 does not increase over 2"),
      Later("NumberFallsOverFrames", {Numbers({5}), Numbers({4})},
            "frame 3: batch.uplinks[0].seq: 4 does not increase over 5"),
      Later("NumberJumps", {Numbers({1}), Numbers({2 + (std::uint64_t{1} << 32U)})},
            "frame 3: batch.uplinks[0].seq: 4294967298 jumps over more than 2^32"),
      Later("TooManyMessages", {Numbers({1, 2, 3, 4, 5, 6, 7, 8, 9})},
            "frame 2: batch.uplinks: 9 messages, the limit is 8"),
  };
}

class ProtocolErrorTest : public ::testing::TestWithParam<Fault> {};

TEST_P(ProtocolErrorTest, EndsTheStream) {
  RelayWorld world({.session = {.batch_uplinks_max = 8}});
  TestAgent agent(world.Channel(RuriOf(1)));
  if (GetParam().after_welcome) {
    ASSERT_TRUE(agent.Connect(SessionOf(1)));
  }
  for (const std::string& frame : GetParam().frames) agent.SendBytes(frame);
  const grpc::Status status = agent.End();
  EXPECT_EQ(status.error_code(), kInvalid) << status.error_message();
  EXPECT_THAT(status.error_message(), HasSubstr(GetParam().text));
  EXPECT_EQ(world.session_probe.protocol_errors_total.value(), 1);
  EXPECT_TRUE(Eventually([&] { return world.server().streams() == 0; }));
}

const auto kName = [](const auto& instance) { return instance.param.name; };
INSTANTIATE_TEST_SUITE_P(Frames, ProtocolErrorTest, ::testing::ValuesIn(FrameFaults()), kName);
INSTANTIATE_TEST_SUITE_P(Hellos, ProtocolErrorTest, ::testing::ValuesIn(HelloFaults()), kName);
INSTANTIATE_TEST_SUITE_P(Numbers, ProtocolErrorTest, ::testing::ValuesIn(NumberFaults()), kName);

TEST(ProtocolErrors, HalfCloseBeforeHello) {
  RelayWorld world;
  TestAgent agent(world.Channel(RuriOf(1)));
  agent.HalfClose();
  const grpc::Status status = agent.End();
  EXPECT_EQ(status.error_code(), kInvalid);
  EXPECT_THAT(status.error_message(), HasSubstr("half-closed before a hello"));
}

TEST(ProtocolErrors, ABreakBeforeHelloIsNone) {
  RelayWorld world;
  TestAgent agent(world.Channel(RuriOf(1)));
  ASSERT_TRUE(Eventually([&] { return world.session_probe.streams.value() == 1; }));
  agent.Cancel();
  EXPECT_TRUE(Eventually([&] { return world.session_probe.streams.value() == 0; }));
  EXPECT_EQ(world.session_probe.protocol_errors_total.value(), 0);
}

TEST(ProtocolErrors, WhatWasTakenBeforeStillCommits) {
  RelayWorld world;
  TestAgent agent(world.Channel(RuriOf(1)));
  ASSERT_TRUE(agent.Connect(SessionOf(1)));
  agent.Send(BatchFrame({{1, FaultPayload("a")}, {2, FaultPayload("b")}}));
  agent.Send(BatchFrame({{3, FaultPayload("c")}, {3, FaultPayload("d")}}));
  EXPECT_EQ(agent.End().error_code(), kInvalid);
  EXPECT_TRUE(world.Settles());
  // Nothing of the invalid frame was taken.
  EXPECT_EQ(world.database.Log(RuriOf(1), SessionOf(1)).stored, (std::vector<model::Seq>{1, 2}));
}

TEST(ProtocolErrors, AFirstNumberMayJump) {
  RelayWorld world;
  TestAgent agent(world.Channel(RuriOf(1)));
  ASSERT_TRUE(agent.Connect(SessionOf(1)));
  const model::Seq far = std::uint64_t{1} << 40U;
  agent.Send(BatchFrame({{far, FaultPayload("a")}}));
  EXPECT_TRUE(agent.ReadThrough(far));
}

}  // namespace
}  // namespace uplink::testing
