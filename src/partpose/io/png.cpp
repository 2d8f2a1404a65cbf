// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/png.hpp"

#include "partpose/core/error.hpp"
#include "partpose/io/file.hpp"

#include <png.h>

#include <cmath>
#include <csetjmp>
#include <cstring>
#include <fstream>
#include <new>
#include <string>
#include <type_traits>

namespace partpose {

namespace {

constexpr int largest_side = 65536;
constexpr std::size_t most_pixels = std::size_t{1} << 28;
constexpr std::size_t best_compression = 1032;  // of deflate: 258 bytes from two bits

constexpr const char* truncated = "truncated";

/// What libpng's callbacks see.
struct Stream {
  std::string_view input;
  std::size_t position = 0;  ///< in the input
  std::string output;
  std::array<char, 128> complaint = {};  ///< the error that libpng reported
};

[[noreturn]] void on_error(png_structp png, png_const_charp message) {
  auto& complaint = static_cast<Stream*>(png_get_error_ptr(png))->complaint;
  std::strncpy(complaint.data(), message, complaint.size() - 1);
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

void on_read(png_structp png, png_bytep out, std::size_t length) {
  auto& stream = *static_cast<Stream*>(png_get_io_ptr(png));
  if (length > stream.input.size() - stream.position) png_error(png, truncated);
  std::memcpy(out, stream.input.data() + stream.position, length);
  stream.position += length;
}

void on_write(png_structp png, png_bytep bytes, std::size_t length) {
  bool stored = true;
  try {
    static_cast<Stream*>(png_get_io_ptr(png))->output.append(reinterpret_cast<const char*>(bytes), length);
  } catch (const std::bad_alloc&) {  // an exception must not cross libpng's C frames
    stored = false;
  }
  if (!stored) png_error(png, "out of memory");
}

void on_flush(png_structp) {}

/// libpng reports errors by longjmp, which must not skip destructors: every call that can fail is made in such a
/// function object, which owns nothing. False after an error.
template <typename Calls>
bool guarded(png_structp png, const Calls& calls) {
  static_assert(std::is_trivially_destructible_v<Calls>);
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  calls();
  return true;
}

struct ReadHandle {
  png_structp png;
  png_infop info;

  explicit ReadHandle(Stream& stream)
      : png(png_create_read_struct(PNG_LIBPNG_VER_STRING, &stream, on_error, on_warning)),
        info(png != nullptr ? png_create_info_struct(png) : nullptr) {}
  ~ReadHandle() { png_destroy_read_struct(&png, &info, nullptr); }
  ReadHandle(const ReadHandle&) = delete;
};

struct WriteHandle {
  png_structp png;
  png_infop info;

  explicit WriteHandle(Stream& stream)
      : png(png_create_write_struct(PNG_LIBPNG_VER_STRING, &stream, on_error, on_warning)),
        info(png != nullptr ? png_create_info_struct(png) : nullptr) {}
  ~WriteHandle() { png_destroy_write_struct(&png, &info); }
  WriteHandle(const WriteHandle&) = delete;
};

/// A PNG file whose header is read.
class PngReader {
 public:
  PngReader(std::string_view bytes, std::string_view name) : name_(name), stream_{bytes, 0, {}, {}}, handle_(stream_) {
    const png_structp png = handle_.png;
    const png_infop info = handle_.info;
    if (info == nullptr) throw std::bad_alloc();
    if (png_sig_cmp(reinterpret_cast<png_const_bytep>(bytes.data()), 0, std::min<std::size_t>(8, bytes.size())) != 0)
      throw Error("{}: byte 0: not a PNG file", name_);
    if (!guarded(png, [&] {
          png_set_read_fn(png, &stream_, on_read);
          png_set_user_limits(png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);  // checked below, with a better message
          png_read_info(png, info);
        }))
      fail();
    check_size();
  }

  int width() const { return static_cast<int>(png_get_image_width(handle_.png, handle_.info)); }
  int height() const { return static_cast<int>(png_get_image_height(handle_.png, handle_.info)); }
  int bit_depth() const { return png_get_bit_depth(handle_.png, handle_.info); }
  int colour_type() const { return png_get_color_type(handle_.png, handle_.info); }

  /// "8-bit RGB"
  std::string kind() const {
    const auto colour = colour_type() == PNG_COLOR_TYPE_GRAY         ? "greyscale"
                        : colour_type() == PNG_COLOR_TYPE_GRAY_ALPHA ? "greyscale and alpha"
                        : colour_type() == PNG_COLOR_TYPE_PALETTE    ? "palette"
                        : colour_type() == PNG_COLOR_TYPE_RGB        ? "RGB"
                                                                     : "RGBA";
    return fmt::format("{}-bit {}", bit_depth(), colour);
  }

  /// The pixels, row by row, `configure` having asked libpng for the conversions to Pixel's form.
  template <typename Pixel, typename Configure>
  std::vector<Pixel> pixels(const Configure& configure) {
    const png_structp png = handle_.png;
    const png_infop info = handle_.info;
    std::vector<Pixel> pixels(static_cast<std::size_t>(width()) * height());
    std::vector<png_bytep> rows(height());
    for (std::size_t v = 0; v < rows.size(); ++v) rows[v] = reinterpret_cast<png_bytep>(pixels.data() + v * width());
    const png_bytepp first_row = rows.data();
    if (!guarded(png, [&] {
          configure(png);
          png_read_image(png, first_row);
          png_read_end(png, info);
        }))
      fail();
    return pixels;
  }

 private:
  /// Before anything of the size that the header claims is allocated.
  void check_size() const {
    const std::size_t w = png_get_image_width(handle_.png, handle_.info);
    const std::size_t h = png_get_image_height(handle_.png, handle_.info);
    if (w > largest_side || h > largest_side || w * h > most_pixels)
      throw Error("{}: byte 16: {} x {} px, at most {} px a side and {} pixels can be read", name_, w, h, largest_side,
                  most_pixels);
    const std::size_t needed = png_get_rowbytes(handle_.png, handle_.info) * h;
    if (needed / best_compression > stream_.input.size())
      throw Error("{}: byte 16: {} x {} px cannot be in a file of {} bytes: truncated", name_, w, h,
                  stream_.input.size());
  }

  [[noreturn]] void fail() const {
    const std::string_view complaint = stream_.complaint.data();
    if (complaint == truncated) throw Error("{}: byte {}: truncated PNG", name_, stream_.position);
    throw Error("{}: byte {}: corrupted PNG: {}", name_, stream_.position, complaint);
  }

  std::string_view name_;
  Stream stream_;
  ReadHandle handle_;
};

/// `pixels` row by row without gaps, 16-bit values in the machine's (little-endian) order.
std::string encoded(int width, int height, int bit_depth, int colour_type, const void* pixels, std::size_t row_bytes,
                    std::string_view name) {
  Stream stream;
  const WriteHandle handle(stream);
  const png_structp png = handle.png;
  const png_infop info = handle.info;
  if (info == nullptr) throw std::bad_alloc();
  if (!guarded(png, [&] {
        png_set_write_fn(png, &stream, on_write, on_flush);
        png_set_IHDR(png, info, width, height, bit_depth, colour_type, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                     PNG_FILTER_TYPE_DEFAULT);
        png_write_info(png, info);
        png_set_swap(png);
        for (int v = 0; v < height; ++v) png_write_row(png, static_cast<png_const_bytep>(pixels) + v * row_bytes);
        png_write_end(png, info);
      }))
    throw Error("{}: cannot be written: {}", name, stream.complaint.data());
  return std::move(stream.output);
}

void check_image(int width, int height, std::size_t pixels, std::string_view name) {
  if (width < 1 || height < 1 || width > largest_side || height > largest_side ||
      pixels != static_cast<std::size_t>(width) * height)
    throw Error("{}: an image of {} x {} px with {} pixels: 1 to {} px a side and width x height pixels are needed",
                name, width, height, pixels, largest_side);
}

void check_scale(double depth_scale_mm, std::string_view name) {
  if (!(depth_scale_mm > 0) || !std::isfinite(depth_scale_mm))
    throw Error("{}: depth scale {} mm per unit, must be positive and finite", name, depth_scale_mm);
}

}  // namespace

DepthImage read_depth_png(const std::filesystem::path& path, double depth_scale_mm) {
  const std::string name = path.string();
  check_scale(depth_scale_mm, name);
  const std::string bytes = read_file(path);
  PngReader reader(bytes, name);
  if (reader.bit_depth() != 16 || reader.colour_type() != PNG_COLOR_TYPE_GRAY)
    throw Error("{}: byte 24: {} PNG, a 16-bit greyscale depth image is needed", name, reader.kind());
  const auto units = reader.pixels<std::uint16_t>(png_set_swap);
  DepthImage depth(reader.width(), reader.height());
  for (std::size_t i = 0; i < units.size(); ++i) depth.z_mm[i] = static_cast<float>(units[i] * depth_scale_mm);
  return depth;
}

bool is_picture_png(const std::filesystem::path& path) {
  constexpr std::string_view begin("\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 16);
  constexpr std::size_t bit_depth = 24, colour_type = 25;
  std::array<char, 26> header = {};
  std::ifstream stream(path, std::ios::binary);
  if (!stream.read(header.data(), header.size())) return false;
  if (std::string_view(header.data(), begin.size()) != begin) return false;
  return header[bit_depth] != 16 || header[colour_type] != PNG_COLOR_TYPE_GRAY;
}

void write_depth_png(const std::filesystem::path& path, const DepthImage& depth, double depth_scale_mm) {
  const std::string name = path.string();
  check_scale(depth_scale_mm, name);
  check_image(depth.width, depth.height, depth.z_mm.size(), name);
  std::vector<std::uint16_t> units(depth.z_mm.size());
  for (std::size_t i = 0; i < units.size(); ++i) {
    const double unit = std::round(depth.z_mm[i] / depth_scale_mm);
    if (!(unit >= 0 && unit <= 65535))
      throw Error("{}: pixel ({}, {}): {} mm is {} units of {} mm, must be 0 to 65535", name, i % depth.width,
                  i / depth.width, depth.z_mm[i], unit, depth_scale_mm);
    units[i] = static_cast<std::uint16_t>(unit);
  }
  write_file_atomically(path, encoded(depth.width, depth.height, 16, PNG_COLOR_TYPE_GRAY, units.data(),
                                      sizeof(std::uint16_t) * depth.width, name));
}

ColourImage read_png(const std::filesystem::path& path) {
  const std::string bytes = read_file(path), name = path.string();
  PngReader reader(bytes, name);
  if (reader.bit_depth() == 16) throw Error("{}: byte 24: {} PNG, an 8-bit image is needed", name, reader.kind());
  ColourImage image{reader.width(), reader.height(), {}};
  image.pixels = reader.pixels<std::array<std::uint8_t, 3>>([](png_structp png) {
    png_set_expand(png);
    png_set_gray_to_rgb(png);
    png_set_strip_alpha(png);
  });
  return image;
}

void write_png(const std::filesystem::path& path, const ColourImage& image) {
  const std::string name = path.string();
  check_image(image.width, image.height, image.pixels.size(), name);
  write_file_atomically(path, encoded(image.width, image.height, 8, PNG_COLOR_TYPE_RGB, image.pixels.data(),
                                      3 * static_cast<std::size_t>(image.width), name));
}

}  // namespace partpose
