#include "tools/uplinkctl/doctor/socket_check.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "tests/support/temp_folder.h"

namespace uplink::ctl {
namespace {

using ::testing::HasSubstr;

/// Listens at a path until it goes; the path stays.
class ListeningAt final {
 public:
  explicit ListeningAt(const std::string& path)
      : socket_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(static_cast<char*>(address.sun_path), path.data(), path.size());
    const void* const place = &address;
    EXPECT_EQ(::bind(socket_, static_cast<const sockaddr*>(place), sizeof address), 0);
    EXPECT_EQ(::listen(socket_, 1), 0);
  }
  ~ListeningAt() { ::close(socket_); }
  ListeningAt(const ListeningAt&) = delete;
  ListeningAt& operator=(const ListeningAt&) = delete;

 private:
  int socket_;
};

PortFacts SocketAt(int error, pid_t holder = 0) {
  return {
      {"listen.http", {.host = {}, .port = 0, .path = "/run/uplinkd/http.sock"}}, error, holder};
}

MachineFacts Machine() {
  MachineFacts machine;
  machine.servers.push_back({{10, "uplinkd", 997}, 65'536});
  return machine;
}

TEST(SocketTrial, SaysWhatAServerWouldFind) {
  const testing::TempFolder folder;
  const std::string path = folder.File("http.sock");
  EXPECT_EQ(TryToListenAt(path).error, 0);
  EXPECT_EQ(TryToListenAt("/nowhere/http.sock").error, ENOENT);
  {
    const ListeningAt listening(path);
    const SocketTrial trial = TryToListenAt(path);
    EXPECT_EQ(trial.error, EADDRINUSE);
    EXPECT_EQ(trial.holder, ::getpid());
  }
  // A server that ended left it there.
  EXPECT_EQ(TryToListenAt(path).error, 0);
  std::ofstream(folder.File("file")) << "x";
  EXPECT_EQ(TryToListenAt(folder.File("file")).error, EEXIST);
}

TEST(SocketCheck, TheServersOwnIsGood) {
  const PortUser user{"uplinkd", ServerProcess{{10, "uplinkd", 997}, 65'536}};
  EXPECT_EQ(PortFinding(SocketAt(EADDRINUSE, 10), Machine(), user),
            Ok("listen.http", "/run/uplinkd/http.sock is held by the running uplinkd (pid 10)"));
  EXPECT_EQ(PortFinding(SocketAt(0), {}, {"uplinkd", {}}),
            Ok("listen.http", "/run/uplinkd/http.sock is free"));
}

TEST(SocketCheck, EachRefusalHasItsRemedy) {
  const auto finding = [](int error, pid_t holder = 0) {
    return PortFinding(SocketAt(error, holder), {}, {"uplinkd", {}});
  };
  EXPECT_THAT(finding(EADDRINUSE, 20).what, HasSubstr("held by another program (pid 20)"));
  EXPECT_THAT(finding(EADDRINUSE).what, HasSubstr("held by another program"));
  EXPECT_EQ(finding(ENOENT).severity, Severity::kWarning);
  EXPECT_THAT(finding(EEXIST).what, HasSubstr("is no socket"));
  EXPECT_THAT(finding(EACCES).what, HasSubstr("uplinkd may not make a socket in /run/uplinkd"));
  EXPECT_EQ(finding(EIO).severity, Severity::kError);
}

TEST(SocketCheck, ItTellsWhichServerRuns) {
  EXPECT_TRUE(FixesPort({SocketAt(0)}));
  const auto own = OwnServer({SocketAt(EADDRINUSE, 10)}, Machine());
  ASSERT_TRUE(own.has_value());
  EXPECT_EQ(own->pid, 10);
  EXPECT_EQ(OwnServer({SocketAt(EADDRINUSE, 11)}, Machine()), std::nullopt);
  EXPECT_EQ(OwnServer({SocketAt(0)}, Machine()), std::nullopt);
  EXPECT_TRUE(HasUnknownHolder({SocketAt(EADDRINUSE, 11)}, Machine()));
  EXPECT_FALSE(HasUnknownHolder({SocketAt(EADDRINUSE, 10)}, Machine()));
}

}  // namespace
}  // namespace uplink::ctl
