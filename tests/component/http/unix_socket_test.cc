// listen.http on a Unix socket: its file, and what is answered there.
#include "server/http/unix_socket.h"

#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "tests/component/http/http_server_fixture.h"
#include "tests/support/temp_folder.h"

namespace uplink::http {
namespace {

using ::testing::HasSubstr;

sockaddr_un AddressOf(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path, path.data(), path.size());
  return address;
}

/// A socket of the test's own; -1 if `act` fails.
int Open(const std::string& path, int (*act)(int, const sockaddr*, socklen_t)) {
  const int end = ::socket(AF_UNIX, SOCK_STREAM, 0);
  const sockaddr_un address = AddressOf(path);
  if (act(end, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0) return end;
  ::close(end);
  return -1;
}

class UnixSocketTest : public HttpServerTest {
 protected:
  absl::StatusOr<std::unique_ptr<HttpServer>> ServeAt(const std::string& path, mode_t mode = 0660) {
    ListenerLimits limits = kHttpLimits;
    limits.connections_max = kConnectionsMax;
    return TryListen({.listener = ListenerId::kHttp,
                      .address = {.path = path},
                      .limits = limits,
                      .socket_mode = mode});
  }
  std::string Ask(const std::string& request) const {
    const int end = Open(path_, ::connect);
    if (end < 0) return "";
    EXPECT_EQ(::send(end, request.data(), request.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(request.size()));
    std::string all;
    char bytes[4096];
    for (ssize_t n = 0; (n = ::recv(end, bytes, sizeof(bytes), 0)) > 0;) {
      all.append(bytes, static_cast<std::size_t>(n));
    }
    ::close(end);
    return all;
  }

  testing::TempFolder folder_;
  const std::string path_ = folder_.File("http.sock");
};

TEST_F(UnixSocketTest, AnswersWithTheModeThatIsSetAndGoesAtTheEnd) {
  auto server = ServeAt(path_, 0640);
  ASSERT_TRUE(server.ok()) << server.status();
  EXPECT_EQ(config::ToText((*server)->bound()), "unix:" + path_);
  struct stat status {};
  ASSERT_EQ(::lstat(path_.c_str(), &status), 0);
  EXPECT_TRUE(S_ISSOCK(status.st_mode));
  EXPECT_EQ(status.st_mode & 0777U, 0640U);
  loop_.Start();
  EXPECT_THAT(Ask("GET /api/v1/status HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n"),
              HasSubstr("HTTP/1.1 200 OK\r\n"));
  EXPECT_THAT(Ask("GET /api/v1/status HTTP/1.0\r\nHost: elsewhere.example\r\n\r\n"),
              HasSubstr("HTTP/1.0 421 "));
  loop_.Stop();
  server->reset();
  EXPECT_FALSE(std::filesystem::exists(path_));
}

TEST_F(UnixSocketTest, ALeftSocketIsReplaced) {
  const int left = Open(path_, ::bind);
  ASSERT_GE(left, 0);
  ::close(left);
  ASSERT_TRUE(std::filesystem::exists(path_));
  EXPECT_TRUE(ServeAt(path_).ok());
}

TEST_F(UnixSocketTest, ALiveSocketIsNot) {
  const int live = Open(path_, ::bind);
  ASSERT_EQ(::listen(live, 1), 0);
  const auto server = ServeAt(path_);
  ASSERT_FALSE(server.ok());
  EXPECT_THAT(std::string(server.status().message()),
              HasSubstr("listen.http: unix:" + path_ + " cannot be bound: a server listens at"));
  EXPECT_TRUE(std::filesystem::exists(path_));
  ::close(live);
}

TEST_F(UnixSocketTest, AFileThatIsNoSocketIsNot) {
  std::ofstream(path_) << "data";
  const auto server = ServeAt(path_);
  ASSERT_FALSE(server.ok());
  EXPECT_THAT(std::string(server.status().message()), HasSubstr("is no socket"));
  EXPECT_TRUE(std::filesystem::exists(path_));
}

TEST_F(UnixSocketTest, AMissingFolderIsNamed) {
  const auto server = ServeAt(folder_.File("none/http.sock"));
  ASSERT_FALSE(server.ok());
  EXPECT_THAT(std::string(server.status().message()), HasSubstr("No such file or directory"));
}

TEST(SocketFile, RemovesItsOwnFileAlone) {
  const testing::TempFolder folder;
  const std::string path = folder.File("a.sock");
  {
    SocketFile file;
    const int ours = Open(path, ::bind);
    ASSERT_TRUE(file.Own(path, 0600).ok());
    ::close(ours);
  }
  EXPECT_FALSE(std::filesystem::exists(path));
  {
    SocketFile file;
    const int ours = Open(path, ::bind);
    ASSERT_TRUE(file.Own(path, 0600).ok());
    // Its inode is not free yet.
    std::filesystem::rename(path, folder.File("kept"));
    ::close(Open(path, ::bind));
    ::close(ours);
  }
  EXPECT_TRUE(std::filesystem::exists(path)) << "another server's";
}

}  // namespace
}  // namespace uplink::http
