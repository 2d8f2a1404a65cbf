// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/png.hpp"

#include "partpose/io/testing.hpp"

#include <png.h>

#include <csetjmp>
#include <cstdint>

namespace partpose {
namespace {

using namespace testing;

using Pixels = std::vector<std::array<std::uint8_t, 3>>;

/// A PNG file of any kind, written without the code under test; `rows` as libpng takes them.
std::string png_file(int width, int bit_depth, int colour_type, std::vector<std::vector<std::uint8_t>> rows,
                     int interlace = PNG_INTERLACE_NONE, const std::vector<png_color>& palette = {}) {
  std::string out;
  const png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(
      png, &out,
      [](png_structp p, png_bytep bytes, std::size_t length) {
        static_cast<std::string*>(png_get_io_ptr(p))->append(reinterpret_cast<char*>(bytes), length);
      },
      [](png_structp) {});
  png_set_IHDR(png, info, width, static_cast<int>(rows.size()), bit_depth, colour_type, interlace,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  if (!palette.empty()) png_set_PLTE(png, info, palette.data(), static_cast<int>(palette.size()));
  std::vector<png_bytep> row_pointers;
  for (auto& row : rows) row_pointers.push_back(row.data());
  png_write_info(png, info);
  png_write_image(png, row_pointers.data());
  png_write_end(png, info);
  png_structp to_destroy = png;
  png_destroy_write_struct(&to_destroy, &info);
  return out;
}

std::uint32_t crc(const std::string& bytes) {
  std::uint32_t value = 0xffffffff;
  for (const char c : bytes) {
    value ^= static_cast<std::uint8_t>(c);
    for (int bit = 0; bit < 8; ++bit) value = value >> 1 ^ (value & 1 ? 0xedb88320 : 0);
  }
  return ~value;
}

std::string big_endian(std::uint32_t value) {
  const std::string bytes = as_bytes(value);
  return {bytes.rbegin(), bytes.rend()};
}

/// The same file with another size in its header, and the check sum made right.
std::string with_size(std::string bytes, std::uint32_t width, std::uint32_t height) {
  bytes.replace(16, 8, big_endian(width) + big_endian(height));
  return bytes.replace(29, 4, big_endian(crc(bytes.substr(12, 17))));
}

DepthImage some_depth(int width, int height, double scale_mm) {
  DepthImage depth(width, height);
  for (std::size_t i = 0; i < depth.z_mm.size(); ++i)
    depth.z_mm[i] = static_cast<float>((i * 40503 % 65536) * scale_mm);
  return depth;
}

const std::string depth_file = png_file(3, 16, PNG_COLOR_TYPE_GRAY, {{0, 0, 0, 1, 1, 0}, {255, 255, 4, 210, 0, 2}});

std::string depth_error(const std::string& bytes) {
  const TempFolder folder;
  const auto path = folder.file("depth.png", bytes);
  const auto error = error_of([&] { read_depth_png(path, 1); });
  EXPECT_TRUE(error == "no error" || error.starts_with(path.string() + ": ")) << error;
  return error;
}

TEST(DepthPng, RoundTripKeepsBits) {
  const TempFolder folder;
  for (const double scale_mm : {1.0, 0.1, 0.001, 1.0 / 3}) {
    const auto depth = some_depth(301, 227, scale_mm);
    write_depth_png(folder / "a.png", depth, scale_mm);
    const auto again = read_depth_png(folder / "a.png", scale_mm);
    EXPECT_EQ(again.width, 301);
    EXPECT_EQ(again.height, 227);
    EXPECT_TRUE(same_bits(again.z_mm, depth.z_mm));
  }
  EXPECT_EQ(folder.files(), 1);
}

TEST(DepthPng, ReadsUnitsRowByRow) {
  const TempFolder folder;
  const auto depth = read_depth_png(folder.file("a.png", depth_file), 0.5);
  EXPECT_EQ(depth.width, 3);
  EXPECT_EQ(depth.height, 2);
  EXPECT_EQ(depth.z_mm, (std::vector<float>{0, 0.5f, 128, 32767.5f, 617, 1}));
}

TEST(DepthPng, ReadsInterlacedFiles) {
  const TempFolder folder;
  std::vector<std::vector<std::uint8_t>> rows(11, std::vector<std::uint8_t>(2 * 13));
  for (std::size_t v = 0; v < rows.size(); ++v)
    for (std::size_t i = 0; i < rows[v].size(); ++i) rows[v][i] = static_cast<std::uint8_t>(v * 26 + i);
  const auto plain = png_file(13, 16, PNG_COLOR_TYPE_GRAY, rows);
  const auto interlaced = png_file(13, 16, PNG_COLOR_TYPE_GRAY, rows, PNG_INTERLACE_ADAM7);
  EXPECT_NE(plain, interlaced);
  EXPECT_EQ(read_depth_png(folder.file("a.png", plain), 1).z_mm,
            read_depth_png(folder.file("b.png", interlaced), 1).z_mm);
}

TEST(DepthPng, RoundsToTheNearestUnit) {
  const TempFolder folder;
  DepthImage depth(5, 1);
  depth.z_mm = {0.2f, 0.3f, 1.24f, 1.26f, 32767.5f};
  write_depth_png(folder / "a.png", depth, 0.5);
  EXPECT_EQ(read_depth_png(folder / "a.png", 0.5).z_mm, (std::vector<float>{0, 0.5f, 1, 1.5f, 32767.5f}));
}

TEST(DepthPng, RefusesToWriteWhatDoesNotFit) {
  const TempFolder folder;
  const auto writing = [&](float z_mm, double scale_mm) {
    DepthImage depth(4, 3);
    depth.at(2, 1) = z_mm;
    return error_of([&] { write_depth_png(folder / "a.png", depth, scale_mm); });
  };
  EXPECT_CONTAINS(writing(65536, 1), "a.png: pixel (2, 1): 65536 mm is 65536 units of 1 mm, must be 0 to 65535");
  EXPECT_CONTAINS(writing(-1, 1), "pixel (2, 1): -1 mm is -1 units");
  EXPECT_CONTAINS(writing(std::numeric_limits<float>::quiet_NaN(), 1), "pixel (2, 1): nan mm");
  EXPECT_CONTAINS(writing(std::numeric_limits<float>::infinity(), 1), "pixel (2, 1): inf mm");
  EXPECT_CONTAINS(writing(1, 0), "a.png: depth scale 0 mm per unit, must be positive");
  EXPECT_CONTAINS(writing(1, std::numeric_limits<double>::quiet_NaN()), "depth scale nan mm");
  EXPECT_CONTAINS(error_of([&] { write_depth_png(folder / "a.png", {}, 1); }), "a.png: an image of 0 x 0 px");
  DepthImage lying(2, 2);
  lying.height = 3;
  EXPECT_CONTAINS(error_of([&] { write_depth_png(folder / "a.png", lying, 1); }), "an image of 2 x 3 px with 4 pixels");
  EXPECT_EQ(folder.files(), 0);
}

TEST(DepthPng, RefusesOtherKindsOfPng) {
  EXPECT_CONTAINS(depth_error(png_file(1, 8, PNG_COLOR_TYPE_RGB, {{1, 2, 3}})),
                  "byte 24: 8-bit RGB PNG, a 16-bit greyscale depth image is needed");
  EXPECT_CONTAINS(depth_error(png_file(1, 8, PNG_COLOR_TYPE_GRAY, {{1}})), "8-bit greyscale PNG, a 16-bit");
  EXPECT_CONTAINS(depth_error(png_file(1, 16, PNG_COLOR_TYPE_RGBA, {std::vector<std::uint8_t>(8)})), "16-bit RGBA PNG");
  EXPECT_CONTAINS(depth_error(png_file(1, 16, PNG_COLOR_TYPE_GRAY_ALPHA, {std::vector<std::uint8_t>(4)})),
                  "16-bit greyscale and alpha PNG");
  EXPECT_CONTAINS(depth_error(png_file(1, 1, PNG_COLOR_TYPE_PALETTE, {{0}}, 0, {{1, 2, 3}})), "1-bit palette PNG");
}

TEST(DepthPng, RefusesABadScale) {
  const TempFolder folder;
  const auto path = folder.file("a.png", depth_file);
  EXPECT_CONTAINS(error_of([&] { read_depth_png(path, -0.1); }),
                  "a.png: depth scale -0.1 mm per unit, must be positive");
}

TEST(DepthPng, RefusesWhatIsNoPng) {
  EXPECT_CONTAINS(depth_error("P5 3 2 65535\n"), "byte 0: not a PNG file");
  EXPECT_CONTAINS(depth_error("x"), "byte 0: not a PNG file");
}

TEST(DepthPng, RefusesEveryTruncation) {
  for (std::size_t length = 1; length < depth_file.size(); ++length)
    EXPECT_CONTAINS(depth_error(depth_file.substr(0, length)), "truncated");
  EXPECT_CONTAINS(depth_error(depth_file.substr(0, 40)), "byte 33: truncated PNG");
}

TEST(DepthPng, RefusesCorruptedData) {
  auto bytes = depth_file;
  bytes[bytes.find("IDAT") + 8] ^= 1;
  EXPECT_CONTAINS(depth_error(bytes), "corrupted PNG: ");
  bytes = depth_file;
  bytes[bytes.find("IHDR") + 7] ^= 1;
  EXPECT_CONTAINS(depth_error(bytes), "byte 33: corrupted PNG: IHDR: CRC error");
}

TEST(DepthPng, RefusesImpossibleSizesBeforeAllocating) {
  EXPECT_EQ(depth_error(with_size(depth_file, 3, 2)), "no error");
  EXPECT_CONTAINS(depth_error(with_size(depth_file, 65537, 2)), "byte 16: 65537 x 2 px, at most 65536 px a side");
  EXPECT_CONTAINS(depth_error(with_size(depth_file, 2, 0x7fffffff)), "byte 16: 2 x 2147483647 px, at most 65536 px");
  EXPECT_CONTAINS(depth_error(with_size(depth_file, 65536, 65536)), "at most 65536 px a side and 268435456 pixels");
  EXPECT_CONTAINS(depth_error(with_size(depth_file, 10000, 10000)), "byte 16: 10000 x 10000 px cannot be in a file of");
  EXPECT_CONTAINS(depth_error(with_size(depth_file, 30, 20)), "corrupted PNG: ");
  EXPECT_CONTAINS(depth_error(with_size(depth_file, 0, 2)), "corrupted PNG: ");
}

TEST(DepthPng, SurvivesDamageWithoutAWord) {
  const TempFolder folder;
  write_depth_png(folder / "a.png", some_depth(16, 9, 1), 1);
  ::testing::internal::CaptureStderr();
  ::testing::internal::CaptureStdout();
  EXPECT_EQ(survive_damage(content(folder / "a.png"), [](const auto& path) { return read_depth_png(path, 1); }), 0);
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

TEST(ColourPng, RoundTripKeepsBits) {
  const TempFolder folder;
  ColourImage image{17, 9, Pixels(17 * 9)};
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i] = {static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(3 * i),
                       static_cast<std::uint8_t>(255 - i)};
  write_png(folder / "a.png", image);
  const auto again = read_png(folder / "a.png");
  EXPECT_EQ(again.width, 17);
  EXPECT_EQ(again.height, 9);
  EXPECT_EQ(again.pixels, image.pixels);
  EXPECT_EQ(folder.files(), 1);
}

TEST(ColourPng, MakesEveryKindRgb) {
  const TempFolder folder;
  const auto pixels = [&](const std::string& bytes) { return read_png(folder.file("a.png", bytes)).pixels; };
  EXPECT_EQ(pixels(png_file(2, 8, PNG_COLOR_TYPE_RGB, {{1, 2, 3, 4, 5, 6}})), (Pixels{{1, 2, 3}, {4, 5, 6}}));
  EXPECT_EQ(pixels(png_file(2, 8, PNG_COLOR_TYPE_RGBA, {{1, 2, 3, 0, 4, 5, 6, 9}})), (Pixels{{1, 2, 3}, {4, 5, 6}}));
  EXPECT_EQ(pixels(png_file(2, 8, PNG_COLOR_TYPE_GRAY, {{7, 200}})), (Pixels{{7, 7, 7}, {200, 200, 200}}));
  EXPECT_EQ(pixels(png_file(1, 8, PNG_COLOR_TYPE_GRAY_ALPHA, {{7, 0}})), (Pixels{{7, 7, 7}}));
  EXPECT_EQ(pixels(png_file(2, 1, PNG_COLOR_TYPE_GRAY, {{0x40}})), (Pixels{{0, 0, 0}, {255, 255, 255}}));
  EXPECT_EQ(pixels(png_file(2, 8, PNG_COLOR_TYPE_PALETTE, {{1, 0}}, 0, {{9, 8, 7}, {1, 2, 3}})),
            (Pixels{{1, 2, 3}, {9, 8, 7}}));
}

TEST(ColourPng, RefusesWhatIsWrong) {
  const TempFolder folder;
  const auto deep = folder.file("deep.png", depth_file);
  EXPECT_CONTAINS(error_of([&] { read_png(deep); }),
                  "deep.png: byte 24: 16-bit greyscale PNG, an 8-bit image is needed");
  EXPECT_CONTAINS(error_of([&] {
                    write_png(folder / "a.png", ColourImage{2, 2, Pixels(3)});
                  }),
                  "a.png: an image of 2 x 2 px with 3 pixels");
  EXPECT_CONTAINS(error_of([&] {
                    write_png(folder / "a.png", ColourImage{65537, 1, Pixels(65537)});
                  }),
                  "1 to 65536 px");
}

TEST(ColourPng, SurvivesDamage) {
  survive_damage(png_file(3, 8, PNG_COLOR_TYPE_PALETTE, {{1, 0, 2}, {2, 2, 1}}, PNG_INTERLACE_ADAM7,
                          {{9, 8, 7}, {1, 2, 3}, {4, 5, 6}}),
                 read_png);
}

TEST(Png, APictureIsKnownByItsHeader) {
  const TempFolder folder;
  write_png(folder / "colour.png", {2, 1, {{1, 2, 3}, {4, 5, 6}}});
  write_depth_png(folder / "depth.png", DepthImage(2, 1), 1);
  EXPECT_TRUE(is_picture_png(folder / "colour.png"));
  EXPECT_FALSE(is_picture_png(folder / "depth.png"));
  EXPECT_FALSE(is_picture_png(folder.file("text.png", "this is no picture, though it is longer than a header")));
  EXPECT_FALSE(is_picture_png(folder.file("cut.png", content(folder / "colour.png").substr(0, 20))));
  EXPECT_FALSE(is_picture_png(folder / "none.png"));
}

}  // namespace
}  // namespace partpose
