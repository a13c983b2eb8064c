#include "server/front/door/origin_reader.h"

#include <array>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/support/kept_lines.h"
#include "tests/support/manual_clock.h"
#include "tests/support/proxy_headers.h"

namespace uplink::front {
namespace {

using ::testing::IsEmpty;
using testing::ProxyHeaderBytes;
using testing::ProxyHeaderFor;
using ::testing::SizeIs;
using transport::TurnedAway;

constexpr const char* kLoadBalancer = "192.0.2.8";

sockaddr_storage PeerAt(const std::string& address) {
  sockaddr_in peer{};
  peer.sin_family = AF_INET;
  peer.sin_port = htons(1234);
  EXPECT_EQ(::inet_pton(AF_INET, address.c_str(), &peer.sin_addr), 1);
  sockaddr_storage storage{};
  std::memcpy(&storage, &peer, sizeof(peer));
  return storage;
}

/// The far end of a connection.
class Peer final {
 public:
  explicit Peer(int descriptor) : descriptor_(descriptor) {}

  void Send(std::string_view bytes) const {
    EXPECT_EQ(::send(descriptor_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(bytes.size()));
  }
  void Leave() { descriptor_ = Descriptor(); }
  /// The other end is closed.
  [[nodiscard]] bool IsClosed() const {
    char byte = 0;
    const ssize_t count = ::recv(descriptor_.get(), &byte, 1, MSG_DONTWAIT);
    return count == 0 || (count < 0 && errno == ECONNRESET);
  }

 private:
  Descriptor descriptor_;
};

class OriginReaderTest : public ::testing::Test {
 protected:
  static constexpr std::size_t kWaitingMax = 3;

  /// A connection from this address, which has said something already.
  Peer Arrive(const std::string& address, std::string_view said = {}) {
    std::array<int, 2> ends{};
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, ends.data()), 0);
    Peer peer(ends[0]);
    if (!said.empty()) peer.Send(said);
    origin_reader_->Arrive({Descriptor(ends[1]), PeerAt(address)});
    return peer;
  }
  /// All that the system has to tell is told.
  void Turn() {
    context_.restart();
    while (context_.poll() > 0) {
    }
  }
  [[nodiscard]] std::int64_t turned_away() const {
    return probe_.turned_away_total[static_cast<std::size_t>(TurnedAway::kProxyHeader)].value();
  }
  [[nodiscard]] std::int64_t waiting() const { return probe_.proxy_headers_waiting.value(); }

  testing::ManualClock clock_;
  std::vector<std::string> lines_;
  log::Logger logger_{std::make_unique<testing::KeptLines>(lines_), clock_, log::Format::kText,
                      log::Level::kDebug};
  transport::RelayProbe probe_;
  DoorBook book_{{.connections_max = 10, .lingers_max = 1}, probe_, &logger_};
  boost::asio::io_context context_;
  std::vector<IncomingConnection> handed_;
  std::unique_ptr<OriginReader> origin_reader_ = std::make_unique<OriginReader>(
      context_, book_, probe_, clock_,
      OriginReader::Setup{
          .load_balancers = {*config::Network::Parse(kLoadBalancer)},
          .waiting_max = kWaitingMax,
          .hand = [this](IncomingConnection incoming) { handed_.push_back(std::move(incoming)); }});
};

TEST_F(OriginReaderTest, WhoSaysNothingAndLeavesMakesNoNoise) {
  Peer before_it_is_seen = Arrive(kLoadBalancer);
  before_it_is_seen.Leave();
  Turn();
  EXPECT_EQ(waiting(), 0);
  std::array<int, 2> ends{};
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()), 0);
  ::close(ends[0]);
  origin_reader_->Arrive({Descriptor(ends[1]), PeerAt(kLoadBalancer)});
  EXPECT_EQ(origin_reader_->waiting(), 0U);
  EXPECT_EQ(turned_away(), 0);
  EXPECT_THAT(lines_, IsEmpty());
  EXPECT_THAT(handed_, IsEmpty());
}

TEST_F(OriginReaderTest, WhoseAddressStaysUntoldComesFromTheLoadBalancer) {
  const Peer peer = Arrive(
      kLoadBalancer, ProxyHeaderBytes(testing::kProxyRelayed, testing::kProxyUnspec, "whatever"));
  ASSERT_THAT(handed_, SizeIs(1));
  EXPECT_EQ(handed_[0].origin.text, "192.0.2.8:1234");
  EXPECT_FALSE(handed_[0].origin.health_check);
}

TEST_F(OriginReaderTest, WhoLeavesInTheMiddleOfAHeaderIsTurnedAway) {
  Peer peer = Arrive(kLoadBalancer, ProxyHeaderFor("203.0.113.7").substr(0, 20));
  EXPECT_EQ(waiting(), 1);
  peer.Leave();
  Turn();
  EXPECT_EQ(turned_away(), 1);
  EXPECT_EQ(waiting(), 0);
}

TEST_F(OriginReaderTest, AHeaderThatDoesNotComeInTimeIsTurnedAway) {
  const Peer silent = Arrive(kLoadBalancer);
  clock_.Advance(milliseconds(1));
  const Peer half = Arrive(kLoadBalancer, "\r\n\r\n");
  clock_.Advance(kProxyHeaderWait - milliseconds(2));
  origin_reader_->Tick();
  EXPECT_EQ(waiting(), 2);
  clock_.Advance(milliseconds(1));
  origin_reader_->Tick();
  EXPECT_EQ(waiting(), 1);
  EXPECT_TRUE(silent.IsClosed());
  EXPECT_FALSE(half.IsClosed());
  clock_.Advance(milliseconds(1));
  origin_reader_->Tick();
  EXPECT_TRUE(half.IsClosed());
  EXPECT_EQ(turned_away(), 2);
  Turn();
  EXPECT_EQ(waiting(), 0);
}

TEST_F(OriginReaderTest, PastItsBoundTheFirstGoes) {
  std::vector<Peer> peers;
  for (std::size_t i = 0; i < kWaitingMax; ++i) peers.push_back(Arrive(kLoadBalancer));
  EXPECT_EQ(waiting(), 3);
  EXPECT_EQ(turned_away(), 0);
  // A connection whose header is there does not wait.
  const Peer quick = Arrive(kLoadBalancer, ProxyHeaderFor("203.0.113.7"));
  EXPECT_EQ(turned_away(), 0);
  peers.push_back(Arrive(kLoadBalancer));
  EXPECT_EQ(waiting(), 3);
  EXPECT_EQ(turned_away(), 1);
  EXPECT_TRUE(peers[0].IsClosed());
  for (std::size_t i = 1; i < peers.size(); ++i) EXPECT_FALSE(peers[i].IsClosed()) << i;
  peers[1].Send(ProxyHeaderFor("203.0.113.8"));
  Turn();
  EXPECT_THAT(handed_, SizeIs(2));
}

TEST_F(OriginReaderTest, WhatTheSystemSaidBeforeSomebodyWentIsForgotten) {
  const Peer peer = Arrive(kLoadBalancer);
  peer.Send(ProxyHeaderFor("203.0.113.7"));
  clock_.Advance(kProxyHeaderWait);
  origin_reader_->Tick();
  Turn();
  EXPECT_THAT(handed_, IsEmpty());
  EXPECT_EQ(turned_away(), 1);
}

}  // namespace
}  // namespace uplink::front
