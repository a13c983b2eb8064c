#include "tools/uplinkctl/ask/access.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/support/certificates.h"
#include "tests/support/temp_folder.h"

namespace uplink::ctl {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kToken = "uplinkd_0123456789-_.~+/=";

class Access : public ::testing::Test {
 protected:
  /// Writes a file that its owner alone may read.
  [[nodiscard]] std::string Write(const std::string& name, const std::string& text,
                                  mode_t mode = 0600) const {
    std::string path = folder_.File(name);
    std::ofstream(path) << text;
    ::chmod(path.c_str(), mode);
    return path;
  }

  static std::string Words(const absl::Status& status) { return std::string(status.message()); }

  testing::TempFolder folder_;
  const ServerUrl plain_{.address = "192.0.2.7:7480"};
  const ServerUrl https_{.address = "192.0.2.7:7480", .prefix = {}, .tls = true};
};

TEST_F(Access, ATokenIsTheFirstLine) {
  for (const char* end : {"", "\n", "\r\n", "\nof ann\n"}) {
    const auto token = ReadToken(Write("token", kToken + std::string(end)));
    ASSERT_TRUE(token.ok()) << token.status();
    EXPECT_EQ(*token, kToken);
  }
  EXPECT_TRUE(ReadToken(Write("group", kToken, 0640)).ok());
}

TEST_F(Access, AFileThatOthersMayReadIsRefused) {
  for (const mode_t mode : {0644U, 0604U, 0602U, 0620U, 0601U}) {
    const absl::Status status = ReadToken(Write("token", kToken, mode)).status();
    EXPECT_TRUE(absl::IsInvalidArgument(status)) << mode;
    EXPECT_THAT(Words(status), HasSubstr("chmod 600 " + folder_.File("token")));
    EXPECT_THAT(Words(status), Not(HasSubstr(kToken)));
  }
}

TEST_F(Access, AFileWithoutATokenIsRefusedAndNotRepeated) {
  for (const char* text : {"", "\n", "pass word", "a\tb", "a\x1b[2J"}) {
    const absl::Status status = ReadToken(Write("token", text)).status();
    EXPECT_TRUE(absl::IsInvalidArgument(status)) << text;
    EXPECT_THAT(Words(status), HasSubstr("is no token"));
    EXPECT_THAT(Words(status), Not(HasSubstr("pass word")));
  }
  EXPECT_THAT(Words(ReadToken(folder_.File("none")).status()), HasSubstr("No such file"));
  const std::string large(kTokenFileBytesMax + 1, 'x');
  EXPECT_THAT(Words(ReadToken(Write("large", large)).status()), HasSubstr("is larger than"));
}

TEST_F(Access, FilesOfTlsAreForHttps) {
  EXPECT_TRUE(CheckAccess(plain_, {.token_file = "t"}).ok());
  EXPECT_THAT(Words(CheckAccess(plain_, {.ca_file = "c"})), HasSubstr("are for https://"));
  EXPECT_THAT(Words(CheckAccess(https_, {.certificate_file = "c"})), HasSubstr("go together"));
  EXPECT_TRUE(CheckAccess(https_, {.ca_file = "c", .token_file = "t"}).ok());
}

TEST_F(Access, AServerGetsWhatTheFilesHold) {
  const testing::TestAuthority authority;
  const testing::KeyPair ann = authority.Issue(testing::ServerSpec());
  const AccessFiles files{.ca_file = Write("ca.crt", authority.certificate()),
                          .certificate_file = Write("ann.crt", ann.certificate),
                          .key_file = Write("ann.key", ann.key),
                          .token_file = Write("token", kToken)};
  const auto server = ServerWith(https_, files, "");
  ASSERT_TRUE(server.ok()) << server.status();
  EXPECT_EQ(server->token, kToken);
  EXPECT_NE(server->tls, nullptr);
  const auto plain = ServerWith(plain_, {.token_file = files.token_file}, "/none.crt");
  ASSERT_TRUE(plain.ok()) << plain.status();
  EXPECT_EQ(plain->tls, nullptr);
}

TEST_F(Access, AWrongFileIsNamed) {
  const std::string empty = Write("empty.crt", "");
  const std::string wrong = Write("wrong.crt", "x");
  EXPECT_THAT(Words(ServerWith(https_, {.ca_file = empty}, "").status()), HasSubstr(empty));
  EXPECT_THAT(Words(ServerWith(https_, {.ca_file = wrong}, "").status()), HasSubstr(wrong));
  EXPECT_THAT(Words(ServerWith(https_, {}, wrong).status()), HasSubstr(wrong));
  EXPECT_THAT(Words(ServerWith(https_, {}, "/none.crt").status()), HasSubstr("/none.crt"));
  const testing::TestAuthority authority;
  const testing::KeyPair ann = authority.Issue(testing::ServerSpec());
  const AccessFiles files{.certificate_file = Write("ann.crt", ann.certificate),
                          .key_file = Write("ann.key", ann.key, 0644)};
  EXPECT_THAT(Words(ServerWith(https_, files, "").status()), HasSubstr("chmod 600"));
}

TEST_F(Access, AProbeShowsNothingAndBelievesAny) {
  const auto server = ServerToProbe(https_);
  ASSERT_TRUE(server.ok()) << server.status();
  EXPECT_EQ(server->token, "");
  EXPECT_NE(server->tls, nullptr);
  EXPECT_EQ(ServerToProbe(plain_)->tls, nullptr);
}

TEST_F(Access, ATokenIsShownToTheNetworkWithoutTlsAlone) {
  const auto shows = [](const char* address, const char* token) {
    return ShowsToken({.address = address, .token = token});
  };
  EXPECT_TRUE(shows("192.0.2.7:80", kToken));
  EXPECT_TRUE(shows("[2001:db8::1]:80", kToken));
  EXPECT_FALSE(shows("192.0.2.7:80", ""));
  EXPECT_FALSE(shows("127.0.0.1:7480", kToken));
  EXPECT_FALSE(shows("[::1]:7480", kToken));
  EXPECT_FALSE(shows("localhost:7480", kToken));
  EXPECT_FALSE(shows("/run/uplinkd/http.sock", kToken));
  const auto https = ServerToProbe(https_);
  ASSERT_TRUE(https.ok());
  EXPECT_FALSE(ShowsToken({.address = "192.0.2.7:80", .tls = https->tls, .token = kToken}));
}

}  // namespace
}  // namespace uplink::ctl
