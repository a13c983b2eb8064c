// gRPC over HTTP/2 as it is published: requests, statuses, and how calls end.
#include <string>

#include <gtest/gtest.h>

#include "tests/component/front/front_world.h"

namespace uplink::testing {
namespace {

class Protocol : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(client_.Begin()); }

  /// The answer to a call with these headers changed.
  const RawStream& Answer(const http2::Fields& changes) {
    client_.Send(OpenRelay(1, changes));
    EXPECT_TRUE(client_.ReadUntilOver(1));
    return client_.At(1);
  }

  RelayWorld world_;
  RawHttp2 client_{ClientOf(world_, RobotKeys(world_, 1))};
};

TEST_F(Protocol, ACallIsHeadersThenMessagesThenTrailers) {
  client_.Send(OpenRelay(1) + http2::Data(1, HelloMessage(1) + FaultsMessage(1, 3)));
  ASSERT_TRUE(client_.ReadUntil([&] { return LastAck(client_.At(1)).through_seq() == 3; }));
  const RawStream& stream = client_.At(1);
  EXPECT_EQ(stream.Header(":status"), "200");
  EXPECT_EQ(stream.Header("content-type"), "application/grpc");
  EXPECT_EQ(stream.Header("grpc-status"), "");
  EXPECT_TRUE(FramesOf(stream).front().has_welcome());
  client_.Send(http2::Data(1, "", http2::kEndStream));
  ASSERT_TRUE(client_.ReadUntilOver(1));
  EXPECT_TRUE(stream.ended);
  EXPECT_EQ(stream.header_blocks, 2U);
  EXPECT_EQ(StatusOf(stream), "0");
  EXPECT_EQ(stream.reset, std::nullopt);
}

TEST_F(Protocol, ARefusalIsOfTrailersOnly) {
  const RawStream& stream = Answer({{":path", "/uplink.v1.UplinkRelay/Other"}});
  EXPECT_EQ(stream.header_blocks, 1U);
  EXPECT_EQ(stream.data_frames, 0U);
  EXPECT_EQ(stream.Header(":status"), "200");
  EXPECT_EQ(stream.Header("content-type"), "application/grpc");
  EXPECT_EQ(StatusOf(stream), "12");
}

TEST_F(Protocol, AfterARefusalThePeerIsToldToStopSending) {
  static_cast<void>(Answer({{":path", "/nothing"}}));
  ASSERT_TRUE(client_.ReadUntil([&] { return client_.At(1).reset.has_value(); }));
  EXPECT_EQ(client_.At(1).reset, http2::kNoError);
}

TEST_F(Protocol, AForeignEncodingIsNamedPercentEncodedBesideWhatIsTaken) {
  const RawStream& stream = Answer({{"grpc-encoding", "50%\xC3\xBC"}});
  EXPECT_EQ(StatusOf(stream), "12");
  EXPECT_EQ(stream.Trailer("grpc-message"), "grpc-encoding 50%25%C3%BC: only identity is taken");
  EXPECT_EQ(stream.Trailer("grpc-accept-encoding"), "identity");
}

TEST_F(Protocol, RequestsThatAreNoneOfOursAreRefusedByGrpcOrByHttp) {
  struct Case {
    http2::Fields changes;
    std::string status;
    std::string grpc_status;
  };
  std::uint32_t stream = 1;
  for (const Case& each :
       {Case{{{":path", "/" + std::string(4000, 'x')}}, "200", "12"},
        Case{{{"te", ""}}, "200", "13"}, Case{{{"grpc-timeout", "123456789S"}}, "200", "3"},
        Case{{{":method", "GET"}}, "405", ""},
        Case{{{"content-type", "application/json"}}, "415", ""},
        Case{{{"content-type", "application/grpc-web"}}, "415", ""}}) {
    SCOPED_TRACE(each.changes.front().first + ' ' + each.changes.front().second);
    client_.Send(OpenRelay(stream, each.changes));
    ASSERT_TRUE(client_.ReadUntilOver(stream));
    EXPECT_EQ(client_.At(stream).Header(":status"), each.status);
    EXPECT_EQ(StatusOf(client_.At(stream)), each.grpc_status);
    stream += 2;
  }
}

TEST_F(Protocol, ATimeoutEndsTheCall) {
  client_.Send(OpenRelay(1, {{"grpc-timeout", "100m"}}) + http2::Data(1, HelloMessage(1)));
  ASSERT_TRUE(client_.ReadUntilOver(1));
  EXPECT_EQ(StatusOf(client_.At(1)), "4");
  EXPECT_TRUE(Eventually([&] { return world_.server().streams() == 0; }));
}

TEST_F(Protocol, ACancelFreesTheStream) {
  client_.Send(OpenRelay(1) + http2::Data(1, HelloMessage(1)));
  ASSERT_TRUE(client_.ReadUntil([&] { return !client_.At(1).data.empty(); }));
  EXPECT_EQ(world_.server().streams(), 1U);
  client_.Send(http2::RstStream(1, http2::kCancel));
  EXPECT_TRUE(Eventually([&] { return world_.server().streams() == 0; }));
  client_.Send(OpenRelay(3) + http2::Data(3, HelloMessage(1), http2::kEndStream));
  ASSERT_TRUE(client_.ReadUntilOver(3));
  EXPECT_EQ(StatusOf(client_.At(3)), "0");
}

class ProtocolStreams : public Protocol {
 protected:
  /// Opens so many at once, before there is an answer to any.
  void Open(std::uint32_t streams) {
    std::string frames;
    for (std::uint32_t i = 0; i < streams; ++i) frames += OpenRelay(2 * i + 1);
    client_.Send(frames);
  }
};

TEST_F(ProtocolStreams, MayBeAsManyAsWereTold) {
  Open(client_.settings().at(http2::kMaxConcurrentStreams));
  EXPECT_TRUE(client_.Sync());
  EXPECT_TRUE(client_.goaways().empty());
}

TEST_F(ProtocolStreams, PastTheirNumberEndTheConnection) {
  Open(client_.settings().at(http2::kMaxConcurrentStreams) + 1);
  EXPECT_TRUE(client_.ReadUntilEnd());
  EXPECT_EQ(client_.goaway_code(), http2::kProtocolError);
}

TEST_F(Protocol, AHalfClosedStreamTakesWindowsAndPriorities) {
  client_.Send(OpenRelay(1) + http2::Data(1, HelloMessage(1), http2::kEndStream) +
               http2::WindowUpdate(1, 1) + http2::Priority(1));
  ASSERT_TRUE(client_.ReadUntilOver(1));
  EXPECT_EQ(StatusOf(client_.At(1)), "0");
}

TEST_F(Protocol, ANumberBelowTheLastOpensNoStream) {
  client_.Send(OpenRelay(5) + http2::Data(5, HelloMessage(1)));
  ASSERT_TRUE(client_.ReadUntil([&] { return !client_.At(5).data.empty(); }));
  client_.Send(OpenRelay(3) + http2::Data(3, HelloMessage(2)));
  ASSERT_TRUE(client_.Sync());
  EXPECT_FALSE(client_.streams().contains(3));
  EXPECT_EQ(world_.server().streams(), 1U);
}

TEST_F(Protocol, TrailersOfARequestEndIt) {
  client_.Send(OpenRelay(1) + http2::Data(1, HelloMessage(1)) +
               http2::Headers(1, {{"x-last", "word"}}, http2::kEndHeaders | http2::kEndStream));
  ASSERT_TRUE(client_.ReadUntilOver(1));
  EXPECT_EQ(StatusOf(client_.At(1)), "0");
}

TEST_F(Protocol, ContinuedHeadersAreOneRequest) {
  const std::string block = http2::Hpack(RelayFields());
  client_.Send(http2::Frame(http2::kHeaders, http2::kNone, 1, block.substr(0, 10)) +
               http2::Frame(http2::kContinuation, http2::kNone, 1, block.substr(10, 20)) +
               http2::Frame(http2::kContinuation, http2::kEndHeaders, 1, block.substr(30)) +
               http2::Data(1, HelloMessage(1), http2::kEndStream));
  ASSERT_TRUE(client_.ReadUntilOver(1));
  EXPECT_EQ(StatusOf(client_.At(1)), "0");
}

}  // namespace
}  // namespace uplink::testing
