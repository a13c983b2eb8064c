#include "tools/uplinkctl/probe_target.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temp_folder.h"

namespace uplink::ctl {
namespace {

using ::testing::HasSubstr;

std::string WithListenHttp(const testing::TempFolder& folder, const std::string& address) {
  std::string path = folder.File("uplinkd.toml");
  std::ofstream(path) << "[listen]\nhttp = \"" << address << "\"\n";
  return path;
}

TEST(ProbeTarget, AFileSaysWhereItsServerListens) {
  const testing::TempFolder folder;
  const std::string path = WithListenHttp(folder, "127.0.0.1:7481");
  const auto target = TargetOfConfig(path, {});
  ASSERT_TRUE(target.ok()) << target.status();
  EXPECT_EQ(target->url.address, "127.0.0.1:7481");
  EXPECT_EQ(target->source, "listen.http of " + path);
}

TEST(ProbeTarget, AFileMayNameASocketOrACertificate) {
  const testing::TempFolder folder;
  const std::string path = WithListenHttp(folder, "unix:/run/uplinkd/http.sock");
  EXPECT_EQ(TargetOfConfig(path, {})->url.address, "/run/uplinkd/http.sock");
  std::ofstream(path) << "[listen]\nhttp = \"192.0.2.7:7480\"\n[http]\n"
                         "tls.certificate_file = \"h.crt\"\ntls.key_file = \"h.key\"\n";
  const auto target = TargetOfConfig(path, {});
  ASSERT_TRUE(target.ok()) << target.status();
  EXPECT_EQ(ToText(target->url), "https://192.0.2.7:7480");
  EXPECT_EQ(target->certificate_file, "h.crt");
}

TEST(ProbeTarget, WithoutFlagsTheUsualFileIsReadIfItIsThere) {
  const testing::TempFolder folder;
  const std::string path = WithListenHttp(folder, "127.0.0.1:7481");
  EXPECT_EQ(TargetWithoutFlags(path, {})->url.address, "127.0.0.1:7481");
  const std::string none = folder.File("none.toml");
  const auto target = TargetWithoutFlags(none, {});
  ASSERT_TRUE(target.ok()) << target.status();
  EXPECT_EQ(target->url.address, "127.0.0.1:7480");
  EXPECT_EQ(target->source, "the default of listen.http, as " + none +
                                " cannot be read: No such file or directory");
}

TEST(ProbeTarget, AVariableThatSetsTheAddressIsNamed) {
  const testing::TempFolder folder;
  const config::Environment environment = {{"UPLINKD_LISTEN_HTTP", "127.0.0.1:7482"}};
  const std::string path = WithListenHttp(folder, "127.0.0.1:7481");
  for (const auto& target : {TargetOfConfig(path, environment),
                             TargetWithoutFlags(folder.File("none.toml"), environment)}) {
    ASSERT_TRUE(target.ok()) << target.status();
    EXPECT_EQ(target->url.address, "127.0.0.1:7482");
    EXPECT_EQ(target->source, "that of the variable UPLINKD_LISTEN_HTTP");
  }
}

TEST(ProbeTarget, WhatNamesNoAddressIsWrongUse) {
  const testing::TempFolder folder;
  const auto any = TargetOfConfig(WithListenHttp(folder, "127.0.0.1:0"), {});
  EXPECT_TRUE(absl::IsInvalidArgument(any.status()));
  EXPECT_THAT(std::string(any.status().message()), HasSubstr("name it by --url"));
  EXPECT_TRUE(absl::IsInvalidArgument(TargetOfConfig(folder.File("none.toml"), {}).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(TargetOfUrl("ftp://a:1").status()));
}

TEST(ProbeTarget, AProbeWithoutAnswerSaysWhereTheAddressCameFrom) {
  const absl::Status status =
      WithSource(absl::UnavailableError("http://a:1/livez: connect: Connection refused"),
                 TargetOfUrl("http://a:1").value());
  EXPECT_EQ(status, absl::UnavailableError("http://a:1/livez: connect: Connection refused; the "
                                           "address is that of --url"));
}

}  // namespace
}  // namespace uplink::ctl
