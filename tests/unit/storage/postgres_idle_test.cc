// Sessions that are idle for hours, and those that a server or a pooler does not begin.
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "storage/postgres/link/link.h"
#include "storage/postgres/reader.h"
#include "storage/postgres/store.h"
#include "tests/support/eventually.h"
#include "tests/support/fault_proxy.h"
#include "tests/support/postgres_database.h"
#include "tests/support/temp_folder.h"

namespace uplink::storage::postgres {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using uplink::testing::Eventually;
using uplink::testing::FaultProxy;
using uplink::testing::PostgresDatabase;
using uplink::testing::ProxyMode;

std::string Text(const absl::Status& status) { return std::string(status.message()); }

TEST(PostgresIdleTest, NoSessionOfOursEndsForBeingIdle) {
  PostgresDatabase database;
  const SystemClock clock;
  database.Shell().Run("ALTER DATABASE " + database.name() + " SET idle_session_timeout = '1h'");
  for (const std::string& settings :
       {SessionSettings(Purpose::kRead, milliseconds(5'000)),
        SessionSettings(Purpose::kWrite, milliseconds(5'000)), std::string(kNoTimeouts)}) {
    auto url = ParseUrl(database.url());
    ASSERT_TRUE(url.ok()) << url.status();
    ConnectionOptions options;
    options.url = *std::move(url);
    options.session_settings = settings;
    const auto connection = Connection::Open(options, clock);
    ASSERT_TRUE(connection.ok()) << connection.status();
    std::vector<StoreCall> calls;
    calls.push_back({"SELECT current_setting('idle_session_timeout')", {}});
    const auto now = (*connection)->Run(calls, "ask");
    ASSERT_TRUE(now.ok()) << now.status();
    EXPECT_EQ(now->front().Bytes(0, 0), "0") << settings;
  }
}

/// A reader of a database behind a proxy.
class PostgresDeadReadTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::string password = folder_.File("password");
    std::ofstream(password) << "uplinkd\n";
    ReaderOptions options;
    options.url = "postgresql://uplinkd@127.0.0.1:" + std::to_string(proxy_.port()) + "/" +
                  database_.name() + "?sslmode=disable&gssencmode=disable";
    options.password_file = password;
    options.statement_timeout = milliseconds(500);
    options.retry_pause = milliseconds(0);
    auto opened = PostgresReader::Open(options, clock_);
    ASSERT_TRUE(opened.ok()) << opened.status();
    reader_ = *std::move(opened);
    ASSERT_TRUE(Read().ok()) << Read();
  }
  absl::Status Read() { return reader_->RobotCount().status(); }
  void EndSessions() {
    database_.Shell().Run(
        "SELECT pg_terminate_backend(pid, 10000) FROM pg_stat_activity"
        " WHERE datname = current_database() AND pid <> pg_backend_pid()");
  }

  const SystemClock clock_{};
  uplink::testing::TempFolder folder_;
  PostgresDatabase database_;
  FaultProxy proxy_{static_cast<std::uint16_t>(std::stoi(database_.cluster().port))};
  std::unique_ptr<PostgresReader> reader_;
};

TEST_F(PostgresDeadReadTest, OneThatTheServerEndedCostsNoAnswer) {
  for (int i = 0; i < 3; ++i) {
    EndSessions();
    const absl::Status read = Read();
    EXPECT_TRUE(read.ok()) << read;
  }
}

TEST_F(PostgresDeadReadTest, OneThatAFirewallCutCostsNoAnswer) {
  proxy_.Set(ProxyMode::kRefuse);
  ASSERT_TRUE(Eventually([&] { return proxy_.cuts() > 0; }));
  proxy_.Set(ProxyMode::kPass);
  ASSERT_TRUE(Eventually([&] { return proxy_.listens(); }));
  const absl::Status read = Read();
  EXPECT_TRUE(read.ok()) << read;
}

TEST_F(PostgresDeadReadTest, AServerThatIsAwayIsAnErrorAtOnce) {
  proxy_.Set(ProxyMode::kRefuse);
  ASSERT_TRUE(Eventually([&] { return proxy_.cuts() > 0; }));
  const absl::Status read = Read();
  EXPECT_TRUE(absl::IsUnavailable(read)) << read;
  EXPECT_THAT(Text(read), HasSubstr("connect"));
}

TEST_F(PostgresDeadReadTest, WhatIsNotAnsweredInTimeIsNotAskedAgain) {
  const int connections = proxy_.connections();
  proxy_.Set(ProxyMode::kBlackHole);
  const absl::Status read = Read();
  EXPECT_TRUE(absl::IsUnavailable(read)) << read;
  EXPECT_THAT(Text(read), HasSubstr("no answer within its time"));
  EXPECT_EQ(proxy_.connections(), connections);
}

/// Refuses each connection with an error of the protocol, as PgBouncer words it.
class RefusingPooler final {
 public:
  RefusingPooler(std::string state, std::string message)
      : answer_("SFATAL" + std::string(1, '\0') + "C" + std::move(state) + std::string(1, '\0') +
                "M" + std::move(message) + std::string(2, '\0')) {
    listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t length = sizeof(address);
    auto* const any = reinterpret_cast<sockaddr*>(&address);
    EXPECT_EQ(::bind(listener_, any, length), 0);
    EXPECT_EQ(::listen(listener_, 8), 0);
    EXPECT_EQ(::getsockname(listener_, any, &length), 0);
    port_ = ntohs(address.sin_port);
    thread_ = std::jthread([this] { Serve(); });
  }
  RefusingPooler(const RefusingPooler&) = delete;
  RefusingPooler& operator=(const RefusingPooler&) = delete;
  ~RefusingPooler() {
    ::shutdown(listener_, SHUT_RDWR);
    thread_.join();
    ::close(listener_);
  }
  [[nodiscard]] std::string Url() const {
    return "postgresql://uplinkd@127.0.0.1:" + std::to_string(port_) +
           "/x?sslmode=disable&gssencmode=disable&options=-c%20geqo%3Doff";
  }

 private:
  void Serve() const {
    while (true) {
      const int peer = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
      if (peer < 0) return;
      char startup[1024];
      EXPECT_GT(::recv(peer, startup, sizeof startup, 0), 0);
      const auto bytes = static_cast<std::uint32_t>(answer_.size() + 4);
      const std::uint32_t length = htonl(bytes);
      std::string message = "E";
      message.append(reinterpret_cast<const char*>(&length), sizeof length).append(answer_);
      EXPECT_EQ(::send(peer, message.data(), message.size(), MSG_NOSIGNAL),
                static_cast<ssize_t>(message.size()));
      ::close(peer);
    }
  }

  const std::string answer_;
  int listener_ = -1;
  std::uint16_t port_ = 0;
  std::jthread thread_;
};

absl::StatusOr<std::unique_ptr<PostgresStore>> OpenStore(const std::string& url,
                                                         const Clock& clock) {
  StoreOptions options;
  options.url = url;
  options.process = {1};
  return PostgresStore::Open(std::move(options), clock);
}

TEST(PostgresParameterTest, OneThatAPoolerDoesNotPassOnEndsTheStart) {
  const SystemClock clock;
  for (const std::string words : {"unsupported startup parameter: options",
                                  "unsupported startup parameter in options: geqo"}) {
    const RefusingPooler pooler("08P01", words);
    const absl::Status refused = OpenStore(pooler.Url(), clock).status();
    EXPECT_TRUE(absl::IsInternal(refused)) << refused;
    EXPECT_THAT(Text(refused), AllOf(HasSubstr(words), HasSubstr("08P01"), HasSubstr("store.url")));
  }
}

TEST(PostgresParameterTest, WhatElseAPoolerSaysIsWaitedFor) {
  const SystemClock clock;
  const RefusingPooler pooler("08P01", "no more connections allowed (max_client_conn)");
  const auto store = OpenStore(pooler.Url(), clock);
  ASSERT_TRUE(store.ok()) << store.status();
  EXPECT_TRUE(absl::IsUnavailable((*store)->open_error())) << (*store)->open_error();
}

TEST(PostgresParameterTest, OneThatTheServerRefusesEndsTheStart) {
  PostgresDatabase database;
  const SystemClock clock;
  for (const auto& [option, says] :
       std::vector<std::pair<std::string, std::string>>{{"-c%20geqo%3Dperhaps", "22023"},
                                                        {"-c%20no_such%3D1", "42704"},
                                                        {"-c%20max_connections%3D5", "55P02"},
                                                        {"--nonsense", "(42601)"}}) {
    const absl::Status refused = OpenStore(database.url() + "&options=" + option, clock).status();
    EXPECT_TRUE(absl::IsInternal(refused)) << option << ": " << refused;
    EXPECT_THAT(Text(refused), AllOf(HasSubstr(says), HasSubstr("/" + database.name()),
                                     HasSubstr("; the parameter comes from store.url, or")));
  }
}

}  // namespace
}  // namespace uplink::storage::postgres
