#include "metrics/gzip.h"

#include <algorithm>

#include <zlib.h>

#include "schema/base/check.h"

namespace uplink::metrics {
namespace {

/// The largest window, and a header of gzip.
constexpr int kGzipWindowBits = 15 + 16;
constexpr int kMemoryLevel = 8;
/// zlib counts in 32 bits.
constexpr std::size_t kChunkBytes = std::size_t{1} << 30U;

}  // namespace

void Gzip(std::string_view plain, std::string& out) {
  z_stream stream{};
  UPLINK_CHECK(deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, kGzipWindowBits, kMemoryLevel,
                            Z_DEFAULT_STRATEGY) == Z_OK,
               "zlib can be used");
  out.clear();
  out.resize(std::max<std::size_t>(out.capacity(), plain.size() / 8 + 1024));
  std::size_t written = 0;
  int result = Z_OK;
  while (result != Z_STREAM_END) {
    if (written == out.size()) out.resize(out.size() * 2);
    const std::size_t in = std::min(plain.size(), kChunkBytes);
    const std::size_t room = std::min(out.size() - written, kChunkBytes);
    stream.next_in = reinterpret_cast<const Bytef*>(plain.data());
    stream.avail_in = static_cast<uInt>(in);
    stream.next_out = reinterpret_cast<Bytef*>(out.data() + written);
    stream.avail_out = static_cast<uInt>(room);
    result = deflate(&stream, in == plain.size() ? Z_FINISH : Z_NO_FLUSH);
    UPLINK_CHECK(result == Z_OK || result == Z_STREAM_END || result == Z_BUF_ERROR,
                 "zlib compresses");
    plain.remove_prefix(in - stream.avail_in);
    written += room - stream.avail_out;
  }
  deflateEnd(&stream);
  out.resize(written);
}

}  // namespace uplink::metrics
