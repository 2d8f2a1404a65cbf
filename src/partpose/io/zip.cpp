// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/zip.hpp"

#include "partpose/core/error.hpp"
#include "partpose/io/bytes.hpp"
#include "partpose/io/text_reader.hpp"

#include <zlib.h>

#include <algorithm>
#include <cstdint>

namespace partpose {

namespace {

// PKWARE's APPNOTE.TXT 6.3: sizes and signatures of its sections 4.3.7, 4.3.12 and 4.3.16.
constexpr std::uint32_t local_signature = 0x04034b50, central_signature = 0x02014b50, end_signature = 0x06054b50;
constexpr std::size_t local_bytes = 30, central_bytes = 46, end_bytes = 22;

std::string inflated(std::string_view packed, std::size_t most_bytes, std::string_view name) {
  z_stream stream{};
  if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) throw Error("{}: zlib cannot start", name);
  std::string out(most_bytes, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  stream.avail_in = static_cast<uInt>(std::min<std::size_t>(packed.size(), 1u << 30));
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  const int result = inflate(&stream, Z_SYNC_FLUSH);
  out.resize(out.size() - stream.avail_out);
  inflateEnd(&stream);
  if (result != Z_OK && result != Z_STREAM_END && !(result == Z_BUF_ERROR && out.size() == most_bytes))
    throw Error("{}: its compressed content is damaged", name);
  return out;
}

}  // namespace

std::string zip_entry(std::string_view archive, std::string_view ending, std::size_t most_bytes,
                      std::string_view name) {
  const auto fits = [&](std::size_t offset, std::size_t bytes) {
    return offset <= archive.size() && bytes <= archive.size() - offset;
  };
  if (!fits(0, 4) || load<std::uint32_t>(archive, 0) != local_signature)
    throw Error("{}: byte 0: not a ZIP archive", name);
  // The end record is the last thing in the file, behind it a comment of at most 64 KiB.
  std::size_t end = archive.size();
  for (std::size_t back = end_bytes; back <= std::min<std::size_t>(archive.size(), end_bytes + 0xffff); ++back)
    if (load<std::uint32_t>(archive, archive.size() - back) == end_signature) {
      end = archive.size() - back;
      break;
    }
  if (end == archive.size())
    throw Error("{}: byte {}: the archive ends here without its list of files: truncated", name, archive.size());
  const auto count = load<std::uint16_t>(archive, end + 10);
  std::size_t at = load<std::uint32_t>(archive, end + 16);
  for (int i = 0; i < count; ++i) {
    if (!fits(at, central_bytes) || load<std::uint32_t>(archive, at) != central_signature)
      throw Error("{}: byte {}: the archive's list of files is damaged", name, at);
    const auto method = load<std::uint16_t>(archive, at + 10);
    const std::size_t packed_bytes = load<std::uint32_t>(archive, at + 20);
    const std::size_t name_bytes = load<std::uint16_t>(archive, at + 28);
    const std::size_t more_bytes =
        std::size_t{load<std::uint16_t>(archive, at + 30)} + load<std::uint16_t>(archive, at + 32);
    const std::size_t local = load<std::uint32_t>(archive, at + 42);
    if (!fits(at + central_bytes, name_bytes)) throw Error("{}: byte {}: a file's name is cut off", name, at);
    const std::string_view entry = archive.substr(at + central_bytes, name_bytes);
    at += central_bytes + name_bytes + more_bytes;
    if (entry.size() < ending.size() || !equal_ignoring_case(entry.substr(entry.size() - ending.size()), ending))
      continue;
    if (!fits(local, local_bytes)) throw Error("{}: byte {}: a file lies beyond the archive's end", name, local);
    const std::size_t data =
        local + local_bytes + load<std::uint16_t>(archive, local + 26) + load<std::uint16_t>(archive, local + 28);
    if (!fits(data, packed_bytes)) throw Error("{}: byte {}: a file reaches beyond the archive's end", name, local);
    const std::string_view packed = archive.substr(data, packed_bytes);
    if (method == 0) return std::string(packed.substr(0, most_bytes));
    if (method == Z_DEFLATED) return inflated(packed, most_bytes, name);
    throw Error("{}: byte {}: compressed by method {}, which is not supported", name, local, method);
  }
  throw Error("{}: has no file that ends with \"{}\"", name, ending);
}

}  // namespace partpose
