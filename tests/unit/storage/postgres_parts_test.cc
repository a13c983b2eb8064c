#include <limits>
#include <string>
#include <utility>

#include <absl/strings/match.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "storage/postgres/link/errors.h"
#include "storage/postgres/link/parameters.h"
#include "storage/postgres/link/url.h"

namespace uplink::storage::postgres {
namespace {

using std::string_literals::operator""s;

TEST(PostgresErrorsTest, EachStateSaysWhatToDo) {
  EXPECT_EQ(DispositionOf("UL001"), Disposition::kReadFirst);
  EXPECT_EQ(DispositionOf("08006"), Disposition::kRetry);
  EXPECT_EQ(DispositionOf("22021"), Disposition::kRefuseRow);
  EXPECT_EQ(DispositionOf("23514"), Disposition::kRefuseRow);
  EXPECT_EQ(DispositionOf("25006"), Disposition::kRetry);
  EXPECT_EQ(DispositionOf("28P01"), Disposition::kStop);
  EXPECT_EQ(DispositionOf("3D000"), Disposition::kStop);
  EXPECT_EQ(DispositionOf("40001"), Disposition::kConflict);
  EXPECT_EQ(DispositionOf("40P01"), Disposition::kConflict);
  EXPECT_EQ(DispositionOf("42501"), Disposition::kStop);
  EXPECT_EQ(DispositionOf("53100"), Disposition::kFull);
  EXPECT_EQ(DispositionOf("53300"), Disposition::kRetry);
  EXPECT_EQ(DispositionOf("54000"), Disposition::kRefuseRow);
  EXPECT_EQ(DispositionOf("55P03"), Disposition::kRetry);
  EXPECT_EQ(DispositionOf("57014"), Disposition::kTooLong);
  EXPECT_EQ(DispositionOf("57P01"), Disposition::kRetry);
  EXPECT_EQ(DispositionOf("58030"), Disposition::kRetry);
  EXPECT_EQ(DispositionOf("P0001"), Disposition::kRefuseRow);
  EXPECT_EQ(DispositionOf("XX001"), Disposition::kStop);
  EXPECT_EQ(DispositionOf(""), Disposition::kStop);
  EXPECT_EQ(DispositionOf("2"), Disposition::kStop);
}

TEST(PostgresErrorsTest, ARefusedRowIsToldWithoutOurPlace) {
  const ServerError error{"23514", "no such fault"};
  EXPECT_EQ(MakeStatus(error, "db:5432/x", "commit"),
            absl::InvalidArgumentError("no such fault (23514)"));
  EXPECT_EQ(MakeStatus({"53100", "no space left"}, "db:5432/x", "commit"),
            absl::ResourceExhaustedError("postgresql db:5432/x: commit: no space left (53100)"));
}

TEST(PostgresErrorsTest, ASessionThatIsRefusedForAParameterStaysSo) {
  const auto code = [](std::string state, std::string message) {
    return MakeConnectStatus({std::move(state), std::move(message)}, "db:5432/x").code();
  };
  EXPECT_EQ(code("22023", "invalid value"), absl::StatusCode::kInternal);
  EXPECT_EQ(code("08P01", "unsupported startup parameter: options"), absl::StatusCode::kInternal);
  EXPECT_EQ(code("08P01", "pgbouncer cannot connect to server"), absl::StatusCode::kUnavailable);
  EXPECT_EQ(code("08006", "a startup parameter"), absl::StatusCode::kUnavailable);
  EXPECT_EQ(code("57P03", "the database system is starting up"), absl::StatusCode::kUnavailable);
  EXPECT_EQ(code("53300", "too many clients"), absl::StatusCode::kUnavailable);
}

TEST(PostgresErrorsTest, WhatLibpqSaysIsOneLine) {
  EXPECT_EQ(OneLine("connection closed\n\tThis means it ended\n\tbefore the request.\n"),
            "connection closed; This means it ended before the request.");
  EXPECT_EQ(
      OneLine("at ::1: refused\n\tIs it running?\nat 127.0.0.1:  refused\r\n\tIs it running?\n"),
      "at ::1: refused; Is it running?; at 127.0.0.1: refused; Is it running?");
  EXPECT_EQ(OneLine("no lines"), "no lines");
  EXPECT_EQ(OneLine("\n"), "");
}

TEST(PostgresErrorsTest, WhereARefusedParameterComesFromIsSaid) {
  const auto says_where = [](std::string state, std::string message) {
    const absl::Status refused = MakeConnectStatus({std::move(state), std::move(message)}, "db/x");
    return absl::StrContains(refused.message(), "; the parameter comes from store.url, or");
  };
  EXPECT_TRUE(says_where("22023", "invalid value for parameter"));
  EXPECT_TRUE(says_where("42601", "invalid command-line argument for server process"));
  EXPECT_TRUE(says_where("42704", "unrecognized configuration parameter"));
  EXPECT_TRUE(says_where("55P02", "parameter cannot be changed without restarting the server"));
  EXPECT_TRUE(says_where("42501", "permission denied to set parameter"));
  EXPECT_FALSE(says_where("42501", "permission denied for database"));
  EXPECT_FALSE(says_where("28P01", "password authentication failed"));
  EXPECT_FALSE(says_where("3D000", "database does not exist"));
}

TEST(PostgresErrorsTest, ALoginThatFailsSaysWhatToDo) {
  const auto told = [](std::string state, std::string message) {
    const absl::Status status = MakeConnectStatus({std::move(state), std::move(message)}, "db/x");
    EXPECT_TRUE(absl::IsInternal(status)) << status;
    return std::string(status.message());
  };
  EXPECT_EQ(told("3D000", "database \"x\" does not exist"),
            "postgresql db/x: connect: database \"x\" does not exist (3D000); create the database, "
            "or correct its name in the URL");
  EXPECT_THAT(told("28P01", "no"),
              ::testing::EndsWith("; correct the password file, or set the role's password anew"));
  EXPECT_THAT(told("28000", "no"),
              ::testing::EndsWith("let pg_hba.conf admit it from this machine"));
}

TEST(PostgresUrlTest, ShowsThePlaceAndNotTheUser) {
  const auto url = ParseUrl("postgresql://me@db.example:5433/uplink?sslmode=require");
  ASSERT_TRUE(url.ok()) << url.status();
  EXPECT_EQ(url->shown, "db.example:5433/uplink");
  ASSERT_EQ(url->places.size(), 1U);
}

TEST(PostgresUrlTest, TakesSeveralHostsApart) {
  const auto url = ParseUrl("postgresql://a:1,b:2,c:3/uplink");
  ASSERT_TRUE(url.ok()) << url.status();
  ASSERT_EQ(url->places.size(), 3U);
  EXPECT_EQ(url->places[1],
            (std::vector<std::pair<std::string, std::string>>{{"host", "b"}, {"port", "2"}}));
}

struct BadUrl {
  const char* url;
  const char* says;
};

class PostgresBadUrlTest : public ::testing::TestWithParam<BadUrl> {};

TEST_P(PostgresBadUrlTest, IsNamed) {
  const auto url = ParseUrl(GetParam().url);
  ASSERT_TRUE(absl::IsInvalidArgument(url.status())) << url.status();
  EXPECT_TRUE(url.status().message().find(GetParam().says) != absl::string_view::npos)
      << url.status();
  EXPECT_TRUE(url.status().message().find("secret") == absl::string_view::npos) << url.status();
}

INSTANTIATE_TEST_SUITE_P(
    Urls, PostgresBadUrlTest,
    ::testing::Values(
        BadUrl{"mysql://db/x", "store.url does not begin with postgresql://"},
        BadUrl{"postgresql://db/x?colour=red", "invalid URI query parameter: \"colour\""},
        BadUrl{"postgresql://me:secret@db/x", "store.url holds a password"},
        BadUrl{"postgresql://me:%zzsecret@db/x", "store.url: "},
        BadUrl{"postgresql://me:secret%00@db/x", "store.url: "},
        BadUrl{"postgresql://db/x?password:secret", "store.url: "},
        BadUrl{"postgresql://db/x?password=secret", "store.password_file"},
        BadUrl{"postgresql://db/x?replication=database", "store.url asks for a session for rep"},
        BadUrl{"postgresql://me:secret@[::1/x", "store.url: "},
        BadUrl{"postgresql:///x?host=a,b&port=1,2,3", "store.url names 3 hosts and 2 of host"}));

TEST(PostgresParametersTest, NumbersAreBigEndian) {
  EXPECT_EQ(EncodeInt4(0x01020304), "\x01\x02\x03\x04"s);
  EXPECT_EQ(EncodeInt4(-1), "\xFF\xFF\xFF\xFF"s);
  EXPECT_EQ(EncodeInt8(std::numeric_limits<std::int64_t>::max()),
            "\x7F\xFF\xFF\xFF\xFF\xFF\xFF\xFF"s);
}

TEST(PostgresParametersTest, TimesCountFrom2000AndStayInRange) {
  EXPECT_EQ(EncodeTime(FromUnixMs(946'684'800'001)), EncodeInt8(1000));
  EXPECT_EQ(EncodeTime(FromUnixMs(0)), EncodeInt8(-946'684'800'000'000));
  EXPECT_EQ(EncodeTime(FromUnixMs(std::numeric_limits<std::int64_t>::min())),
            EncodeInt8(-211'813'488'000'000'000));
  EXPECT_EQ(EncodeTime(FromUnixMs(std::numeric_limits<std::int64_t>::max())),
            EncodeInt8(9'223'371'331'199'999'000));
}

TEST(PostgresParametersTest, AnArrayHoldsItsElements) {
  Array array(Type::kText);
  array.Text("ab");
  array.Null();
  array.Text("");
  EXPECT_EQ(array.size(), 3U);
  EXPECT_EQ(std::move(array).Take(),
            "\0\0\0\1"    // one dimension
            "\0\0\0\1"    // nulls
            "\0\0\0\x19"  // text
            "\0\0\0\3"    // elements
            "\0\0\0\1"    // from 1
            "\0\0\0\2ab"
            "\xFF\xFF\xFF\xFF"
            "\0\0\0\0"s);
}

TEST(PostgresParametersTest, AnEmptyArrayHasNoDimension) {
  EXPECT_EQ(Array(Type::kInt8).Take(), "\0\0\0\0\0\0\0\0\0\0\0\x14"s);
}

}  // namespace
}  // namespace uplink::storage::postgres
