#include <random>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include "metrics/exposition.h"
#include "metrics/gzip.h"

namespace uplink::metrics {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;

std::string Unzipped(const std::string& zipped, std::size_t size) {
  std::string plain(size, '\0');
  z_stream stream{};
  EXPECT_EQ(inflateInit2(&stream, 15 + 16), Z_OK);
  std::string in = zipped;
  stream.next_in = reinterpret_cast<Bytef*>(in.data());
  stream.avail_in = static_cast<uInt>(in.size());
  stream.next_out = reinterpret_cast<Bytef*>(plain.data());
  stream.avail_out = static_cast<uInt>(plain.size());
  EXPECT_EQ(inflate(&stream, Z_FINISH), Z_STREAM_END);
  EXPECT_EQ(stream.avail_out, 0U);
  inflateEnd(&stream);
  return plain;
}

TEST(Gzip, ComesBackAsItWasWhateverItsSize) {
  std::mt19937 random(1);
  std::string zipped;
  for (const std::size_t size : {1U, 100U, 5'000U, 3'000'000U}) {
    std::string repetitive;
    std::string noise;
    for (std::size_t i = 0; i < size; ++i) {
      repetitive += static_cast<char>('a' + i % 7);
      noise += static_cast<char>(random());
    }
    for (const std::string& plain : {repetitive, noise}) {
      Gzip(plain, zipped);
      EXPECT_EQ(Unzipped(zipped, size), plain) << size;
    }
  }
  Gzip("", zipped);
  EXPECT_FALSE(zipped.empty());
}

TEST(OpenMetrics, NamesCountersWithoutTotalInTheirFamilyAndEndsWithEof) {
  Exposition page;
  page.Add(MetricId::kAcks, 7);
  page.Add(MetricId::kStreams, 2);
  page.Add(MetricId::kBuildInfo, 1, {"1.\"2"});
  const std::string text = page.Text(Format::kOpenMetrics);
  EXPECT_THAT(text, HasSubstr("# TYPE uplinkd_acks_sent counter\nuplinkd_acks_sent_total 7\n"));
  EXPECT_THAT(text, HasSubstr("# TYPE uplinkd_streams gauge\nuplinkd_streams 2\n"));
  EXPECT_THAT(text, HasSubstr("uplinkd_build_info{version=\"1.\\\"2\"} 1\n"));
  EXPECT_THAT(text, EndsWith("# EOF\n"));
}

TEST(OpenMetrics, WritesBucketsWithBoundsThatHaveAPoint) {
  LatencyDistribution seconds(kLatencyBoundsSeconds);
  seconds.Observe(0.25);
  Exposition page;
  page.Add(MetricId::kAckSeconds, seconds);
  const std::string text = page.Text(Format::kOpenMetrics);
  EXPECT_THAT(text, HasSubstr("uplinkd_ack_seconds_bucket{le=\"10.0\"} 1\n"));
  EXPECT_THAT(text, HasSubstr("uplinkd_ack_seconds_bucket{le=\"0.1\"} 0\n"));
  EXPECT_THAT(text, HasSubstr("uplinkd_ack_seconds_bucket{le=\"+Inf\"} 1\n"));
  EXPECT_THAT(text, HasSubstr("uplinkd_ack_seconds_count 1\nuplinkd_ack_seconds_sum 0.25\n"));
}

}  // namespace
}  // namespace uplink::metrics
