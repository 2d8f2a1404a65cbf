// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/pcd.hpp"

#include "partpose/io/lzf.hpp"
#include "partpose/io/testing.hpp"

#include <cmath>
#include <cstdint>

namespace partpose {
namespace {

using namespace testing;
using namespace std::string_literals;

constexpr std::array all_encodings = {PcdEncoding::ascii, PcdEncoding::binary, PcdEncoding::binary_compressed};
const float nan = std::numeric_limits<float>::quiet_NaN();

/// Two points and a colour, as other programs write them; DATA and what follows is to be appended.
const std::string header =
    "# .PCD v0.7 - Point Cloud Data file format\n"
    "VERSION 0.7\n"
    "FIELDS rgb x hist y z\n"
    "SIZE 4 8 4 4 4\n"
    "TYPE U F F F F\n"
    "COUNT 1 1 3 1 1\n"
    "WIDTH 2\n"
    "HEIGHT 1\n"
    "VIEWPOINT 0 0 0 1 0 0 0\n"
    "POINTS 2\n";

std::string as_point(double x, float y, float z) {
  return as_bytes(std::uint32_t{0xff8040}) + as_bytes(x) + as_bytes(std::array<float, 3>{7, 8, 9}) + as_bytes(y) +
         as_bytes(z);
}

const std::string ascii_file = header + "DATA ascii\n4294967295 1.5 7 8 9 -2 3e1\n0 nan nan 8 9 NaN nan\n";
const std::string binary_file = header + "DATA binary\n" + as_point(1.5, -2, 30) + as_point(nan, nan, nan);

std::string compressed_file(const std::string& block) {
  const std::string packed = lzf_compress(block);
  return header + "DATA binary_compressed\n" + as_bytes(static_cast<std::uint32_t>(packed.size())) +
         as_bytes(static_cast<std::uint32_t>(block.size())) + packed;
}

/// Field by field: rgb, x, hist, y, z.
const std::string compressed_block = std::string(8, '\7') + as_bytes(std::array<double, 2>{1.5, nan}) +
                                     std::string(24, '\7') + as_bytes(std::array<float, 2>{-2, nan}) +
                                     as_bytes(std::array<float, 2>{30, nan});

std::string error_in(const std::string& bytes) {
  const TempFolder folder;
  const auto path = folder.file("scene.pcd", bytes);
  const auto error = error_of([&] { read_pcd(path); });
  EXPECT_TRUE(error == "no error" || error.starts_with(path.string() + ": ")) << error;
  return error;
}

class PcdEncodings : public ::testing::TestWithParam<PcdEncoding> {};
INSTANTIATE_TEST_SUITE_P(Pcd, PcdEncodings, ::testing::ValuesIn(all_encodings));

TEST_P(PcdEncodings, RoundTripKeepsBits) {
  const TempFolder folder;
  for (const bool normals : {false, true})
    for (const bool curvatures : {false, true})
      for (const int height : {1, 11}) {
        const auto cloud = random_cloud(13, height, normals, curvatures);
        write_pcd(folder / "a.pcd", cloud, GetParam());
        expect_same_cloud(read_pcd(folder / "a.pcd"), cloud);
        EXPECT_EQ(read_pcd(folder / "a.pcd").is_organized(), height > 1);
      }
  EXPECT_EQ(folder.files(), 1);
}

TEST_P(PcdEncodings, RoundTripKeepsExtremeNumbers) {
  const TempFolder folder;
  PointCloud cloud;
  cloud.points = {{-0.0f, 1e-45f, 3.4028235e38f}, {0.1f, -std::numeric_limits<float>::infinity(), 1.0f / 3}};
  cloud.width = 2;
  cloud.height = 1;
  write_pcd(folder / "a.pcd", cloud, GetParam());
  expect_same_cloud(read_pcd(folder / "a.pcd"), cloud);
}

TEST_P(PcdEncodings, RoundTripOfAnEmptyCloud) {
  const TempFolder folder;
  write_pcd(folder / "a.pcd", {}, GetParam());
  expect_same_cloud(read_pcd(folder / "a.pcd"), {});
}

TEST_P(PcdEncodings, ACloudWithoutWidthIsWrittenUnorganized) {
  const TempFolder folder;
  PointCloud cloud;
  cloud.points = {{1, 2, 3}, {4, 5, 6}};
  write_pcd(folder / "a.pcd", cloud, GetParam());
  EXPECT_EQ(read_pcd(folder / "a.pcd").width, 2);
  EXPECT_EQ(read_pcd(folder / "a.pcd").height, 1);
}

TEST_P(PcdEncodings, SurvivesDamage) {
  const TempFolder folder;
  write_pcd(folder / "a.pcd", random_cloud(4, 3, true, true), GetParam());
  survive_damage(content(folder / "a.pcd"), read_pcd);
}

TEST(Pcd, WritesTheHeaderOfPcl) {
  const TempFolder folder;
  write_pcd(folder / "a.pcd", random_cloud(3, 2, true, true), PcdEncoding::binary);
  EXPECT_TRUE(content(folder / "a.pcd")
                  .starts_with("# .PCD v0.7 - Point Cloud Data file format\n"
                               "VERSION 0.7\n"
                               "FIELDS x y z normal_x normal_y normal_z curvature\n"
                               "SIZE 4 4 4 4 4 4 4\n"
                               "TYPE F F F F F F F\n"
                               "COUNT 1 1 1 1 1 1 1\n"
                               "WIDTH 3\n"
                               "HEIGHT 2\n"
                               "VIEWPOINT 0 0 0 1 0 0 0\n"
                               "POINTS 6\n"
                               "DATA binary\n"));
}

TEST(Pcd, WritesCompressedDataFieldByField) {
  const TempFolder folder;
  PointCloud cloud;
  cloud.points = {{1, 2, 3}, {4, 5, 6}};
  write_pcd(folder / "a.pcd", cloud);
  const std::string bytes = content(folder / "a.pcd"), end = "DATA binary_compressed\n";
  const auto data = bytes.substr(bytes.find(end) + end.size());
  EXPECT_EQ(data.substr(0, 4), as_bytes(static_cast<std::uint32_t>(data.size() - 8)));
  EXPECT_EQ(data.substr(4, 4), as_bytes(std::uint32_t{24}));
  EXPECT_EQ(lzf_decompress(data.substr(8), 24), as_bytes(std::array<float, 6>{1, 4, 2, 5, 3, 6}));
}

TEST(Pcd, WritesNanInAsciiAsPclReadsIt) {
  const TempFolder folder;
  PointCloud cloud;
  cloud.points = {{nan, -nan, 1.25f}};
  write_pcd(folder / "a.pcd", cloud, PcdEncoding::ascii);
  EXPECT_TRUE(content(folder / "a.pcd").ends_with("DATA ascii\nnan nan 1.25\n"));
}

TEST(Pcd, ReadsFieldsAmongOthersInEveryEncoding) {
  const TempFolder folder;
  for (const auto& bytes : {ascii_file, binary_file, compressed_file(compressed_block)}) {
    const auto cloud = read_pcd(folder.file("a.pcd", bytes));
    ASSERT_EQ(cloud.size(), 2);
    EXPECT_EQ(cloud.points[0], Eigen::Vector3f(1.5f, -2, 30));
    EXPECT_TRUE(cloud.points[1].array().isNaN().all());
    EXPECT_FALSE(cloud.has_normals());
    EXPECT_FALSE(cloud.is_organized());
  }
}

TEST(Pcd, ReadsOrganizedCloudsWithMissingPoints) {
  const TempFolder folder;
  const auto organized = replaced(replaced(ascii_file, "WIDTH 2", "WIDTH 1"), "HEIGHT 1", "HEIGHT 2");
  const auto cloud = read_pcd(folder.file("a.pcd", organized));
  EXPECT_TRUE(cloud.is_organized());
  EXPECT_EQ(cloud.width, 1);
  EXPECT_EQ(cloud.height, 2);
  EXPECT_TRUE(std::isnan(cloud.points[1].x()));
}

TEST(Pcd, ReadsHeadersOfManyHands) {
  const TempFolder folder;
  const auto crlf =
      "VERSION .5\r\n\r\nFIELDS x y z\r\nSIZE 4 4 4\r\nTYPE F F F\r\n# no COUNT, no VIEWPOINT\r\nWIDTH 1\r\n"
      "HEIGHT 1\r\nPOINTS 1\r\n"s;
  const auto point = as_bytes(std::array<float, 3>{1, 2, 3});
  for (const auto& data : {"DATA ascii\r\n1\t 2   3\r\n\r\n"s, "DATA binary\r\n" + point})
    EXPECT_EQ(read_pcd(folder.file("a.pcd", crlf + data)).points.at(0), Eigen::Vector3f(1, 2, 3));
}

TEST(Pcd, ToleratesZeroPaddingBehindBinaryData) {
  EXPECT_EQ(error_in(binary_file + std::string(4096, '\0')), "no error");
  EXPECT_EQ(error_in(compressed_file(compressed_block) + std::string(4096, '\0')), "no error");
  const auto at = binary_file.size() + 10;
  EXPECT_CONTAINS(error_in(binary_file + std::string(10, '\0') + "x"),
                  fmt::format("byte {}: data behind the last of the 2 points", at));
  EXPECT_CONTAINS(error_in(compressed_file(compressed_block) + "x"), "data behind the last of the 2 points");
}

TEST(Pcd, RefusesBadHeaders) {
  const auto with = [](const char* from, const char* to) { return error_in(replaced(binary_file, from, to)); };
  EXPECT_CONTAINS(with("VERSION", "VERSOIN"), "line 2, byte 43: 'VERSOIN' where one of VERSION FIELDS SIZE ");
  EXPECT_CONTAINS(with("FIELDS rgb x hist y z\n", ""), "line 11, byte 163: the header ends here without a FIELDS line");
  EXPECT_CONTAINS(with("SIZE 4 8 4 4 4\n", ""), "without a SIZE line");
  EXPECT_CONTAINS(with("TYPE U F F F F\n", ""), "without a TYPE line");
  EXPECT_CONTAINS(with("WIDTH 2\n", ""), "without a WIDTH line");
  EXPECT_CONTAINS(with("HEIGHT 1\n", ""), "without a HEIGHT line");
  EXPECT_CONTAINS(with("POINTS 2\n", ""), "without a POINTS line");
  EXPECT_CONTAINS(with("POINTS 2\n", "POINTS 2\nPOINTS 2\n"), "line 11, byte 173: a second POINTS line");
  EXPECT_CONTAINS(with("SIZE 4 8 4 4 4", "SIZE 4 8 4 4"), "line 4, byte 77: SIZE has 4 entries, 5 expected");
  EXPECT_CONTAINS(with("TYPE U F F F F", "TYPE U F F F F F"), "line 5, byte 92: TYPE has 6 entries, 5 expected");
  EXPECT_CONTAINS(with("COUNT 1 1 3 1 1", "COUNT 1"), "line 6, byte 107: COUNT has 1 entries, 5 expected");
  EXPECT_CONTAINS(with("SIZE 4 8", "SIZE 3 8"), "line 4, byte 77: SIZE is 3, 1, 2, 4 or 8 expected");
  EXPECT_CONTAINS(with("COUNT 1 1 3", "COUNT 1 1 0"), "line 6, byte 107: COUNT is '0', a number from 1 to");
  EXPECT_CONTAINS(with("COUNT 1 1 3", "COUNT 1 1 2147483647"), "line 6, byte 107: more than 2147483647 bytes a point");
  EXPECT_CONTAINS(with("WIDTH 2", "WIDTH two"), "line 7, byte 123: WIDTH is 'two', a number from 0 to 2147483647");
  EXPECT_CONTAINS(with("WIDTH 2", "WIDTH 99999999999999999999"), "WIDTH is '99999999999999999999'");
  EXPECT_CONTAINS(with("HEIGHT 1", "HEIGHT -1"), "line 8, byte 131: HEIGHT is '-1'");
  EXPECT_CONTAINS(with("HEIGHT 1", "HEIGHT 3"), "line 10, byte 164: POINTS is 2, WIDTH x HEIGHT is 2 x 3");
  EXPECT_CONTAINS(with("POINTS 2", "POINTS 3"), "line 10, byte 164: POINTS is 3, WIDTH x HEIGHT is 2 x 1");
  EXPECT_CONTAINS(with("DATA binary", "DATA bin"),
                  "line 11, byte 173: DATA is 'bin', one of ascii, binary, binary_compressed expected");
  EXPECT_CONTAINS(with("DATA binary", "DATA"), "line 11, byte 173: DATA has 0 entries, 1 expected");
  EXPECT_CONTAINS(error_in(header), "line 11, byte 173: the file ends here, the header needs a DATA line");
  EXPECT_CONTAINS(error_in("\x89PNG\r\n"), "line 1, byte 0: '?PNG' where one of");
}

TEST(Pcd, RefusesUnusableFields) {
  const auto with = [](const char* from, const char* to) { return error_in(replaced(binary_file, from, to)); };
  EXPECT_CONTAINS(with("hist y z", "hist Y z"), "line 3, byte 55: a point cloud needs x, y and z");
  EXPECT_CONTAINS(with("rgb x", "normal_x x"), "line 3, byte 55: a normal needs normal_x, normal_y and normal_z");
  EXPECT_CONTAINS(with("rgb x", "z x"), "line 3, byte 55: z is there 2 times");
  EXPECT_CONTAINS(with("rgb x", "curvature x"),
                  "line 3, byte 55: field 'curvature' has TYPE 'U' and SIZE 4, a float (F) of 4 or 8 bytes is needed");
  EXPECT_CONTAINS(with("hist y z", "y hist z"), "line 3, byte 55: field y has COUNT 3, 1 is needed");
  EXPECT_CONTAINS(with("SIZE 4 8", "SIZE 4 2"), "field 'x' has TYPE 'F' and SIZE 2");
}

TEST(Pcd, RefusesTruncatedBinaryDataAndLyingCounts) {
  const auto begin = header.size() + "DATA binary\n"s.size();
  EXPECT_CONTAINS(error_in(binary_file.substr(0, binary_file.size() - 1)),
                  fmt::format("byte {}: 63 bytes of data, 2 points need at least 64: truncated", begin));
  const auto huge = replaced(replaced(binary_file, "WIDTH 2", "WIDTH 2147483647"), "POINTS 2", "POINTS 2147483647");
  EXPECT_CONTAINS(error_in(huge), "64 bytes of data, 2147483647 points need at least 68719476704: truncated");
}

TEST(Pcd, RefusesNumbersTooLargeForAFloat) {
  EXPECT_CONTAINS(error_in(header + "DATA binary\n" + as_point(0, 0, 0) + as_point(-1e39, 0, 0)),
                  "point 1: x is -1e+39, too large for a 32-bit float");
}

TEST(Pcd, RefusesBadCompressedData) {
  const std::string good = compressed_file(compressed_block);
  const auto begin = header.size() + "DATA binary_compressed\n"s.size();
  const auto patched = [&](std::size_t at, std::uint32_t value) {
    return error_in(std::string(good).replace(begin + at, 4, as_bytes(value)));
  };
  EXPECT_EQ(error_in(good), "no error");
  const auto packed = static_cast<std::uint32_t>(good.size() - begin - 8);
  EXPECT_CONTAINS(
      patched(0, packed + 1),
      fmt::format("byte {}: compressed size is {}, the file has {} bytes left: truncated", begin, packed + 1, packed));
  EXPECT_CONTAINS(patched(0, packed - 1), "data behind the last");
  EXPECT_CONTAINS(patched(4, 65),
                  fmt::format("byte {}: uncompressed size is 65, 2 points of 32 bytes need 64", begin + 4));
  EXPECT_CONTAINS(patched(4, 0xffffffff), "uncompressed size is 4294967295");
  EXPECT_CONTAINS(patched(8, 0xffffffff), fmt::format("byte {}: LZF data, byte 3: ", begin + 8));
  EXPECT_CONTAINS(error_in(good.substr(0, begin + 7)),
                  fmt::format("byte {}: truncated, two sizes expected", begin + 7));

  auto bomb = replaced(replaced(good, "WIDTH 2", "WIDTH 134217727"), "POINTS 2", "POINTS 134217727");
  bomb.replace(bomb.find("compressed\n") + 15, 4, as_bytes(std::uint32_t{134217727} * 32));
  EXPECT_CONTAINS(error_in(bomb), "LZF data, byte 0: ");
}

TEST(Pcd, RefusesBadAsciiData) {
  const auto with = [](const char* from, const char* to) { return error_in(replaced(ascii_file, from, to)); };
  const auto begin = header.size() + "DATA ascii\n"s.size();
  EXPECT_CONTAINS(with(" -2 3e1", " -2 3e1mm"), fmt::format("line 12, byte {}: '3e1mm' where a number", begin + 24));
  EXPECT_CONTAINS(with(" -2 3e1", " -2"), "line 12, byte 207: point 0 of 2 has 6 of 7 values");
  EXPECT_CONTAINS(with(" -2 3e1", " -2 3e1 4"), "line 12, byte 212: '4' where the line's end is expected");
  EXPECT_CONTAINS(error_in(ascii_file + "1 2 3"), "data behind the last of the 2 points");
  const auto cut = ascii_file.substr(0, ascii_file.find("0 nan"));
  EXPECT_CONTAINS(error_in(cut), "line 13, byte 212: point 1 of 2 has 0 of 7 values");
  EXPECT_CONTAINS(
      error_in(replaced(replaced(ascii_file, "WIDTH 2", "WIDTH 999999999"), "POINTS 2", "POINTS 999999999")),
      "50 bytes of data, 999999999 points need at least 13999999985: truncated");
  EXPECT_CONTAINS(with("COUNT 1 1 3", "COUNT 1 1 99999999"), "50 bytes of data, 2 points need at least");
}

TEST(Pcd, SurvivesDamageOfFilesOfOthers) {
  survive_damage(ascii_file, read_pcd);
  survive_damage(binary_file, read_pcd);
  survive_damage(compressed_file(compressed_block), read_pcd);
}

std::vector<std::vector<float>> some_histograms(int rows, int bins) {
  std::vector<std::vector<float>> histograms(rows, std::vector<float>(bins));
  for (int r = 0; r < rows; ++r)
    for (int b = 0; b < bins; ++b) histograms[r][b] = std::sin(static_cast<float>(r * bins + b));
  histograms[0][0] = nan;
  return histograms;
}

TEST(PcdHistograms, RoundTripKeepsBits) {
  const TempFolder folder;
  for (const int rows : {1, 5}) {
    const auto written = some_histograms(rows, 308);
    write_pcd_histograms(folder / "vfh.pcd", "vfh", 308, written);
    const auto read = read_pcd_histograms(folder / "vfh.pcd", "vfh");
    ASSERT_EQ(read.size(), rows);
    for (int r = 0; r < rows; ++r) EXPECT_TRUE(same_bits(read[r], written[r]));
  }
  write_pcd_histograms(folder / "none.pcd", "vfh", 308, {});
  EXPECT_TRUE(read_pcd_histograms(folder / "none.pcd", "vfh").empty());
}

TEST(PcdHistograms, WritesTheFormatOfPcl) {
  const TempFolder folder;
  write_pcd_histograms(folder / "a.pcd", "vfh", 3, {{1, 2, 3}});
  EXPECT_EQ(content(folder / "a.pcd"),
            "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS vfh\nSIZE 4\nTYPE F\nCOUNT 3\nWIDTH 1\n"
            "HEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 1\nDATA binary\n" +
                as_bytes(std::array<float, 3>{1, 2, 3}));
}

TEST(PcdHistograms, ReadsThemFromAnyEncodingAndAmongOtherFields) {
  const TempFolder folder;
  EXPECT_EQ(read_pcd_histograms(folder.file("a.pcd", binary_file), "hist"),
            (std::vector<std::vector<float>>{{7, 8, 9}, {7, 8, 9}}));
  EXPECT_EQ(read_pcd_histograms(folder.file("b.pcd", replaced(ascii_file, "nan nan 8", "1 2 8")), "hist"),
            (std::vector<std::vector<float>>{{7, 8, 9}, {2, 8, 9}}));
  const auto compressed =
      compressed_file(std::string(24, '\0') + as_bytes(std::array<float, 6>{1, 2, 3, 4, 5, 6}) + std::string(16, '\0'));
  EXPECT_EQ(read_pcd_histograms(folder.file("c.pcd", compressed), "hist"),
            (std::vector<std::vector<float>>{{1, 2, 3}, {4, 5, 6}}));
}

TEST(PcdHistograms, RefusesWhatIsWrong) {
  const TempFolder folder;
  const auto path = folder.file("a.pcd", binary_file);
  EXPECT_CONTAINS(error_of([&] { read_pcd_histograms(path, "vfh"); }),
                  "a.pcd: line 3, byte 55: no field 'vfh', there are 'rgb', 'x', 'hist', 'y', 'z'");
  EXPECT_CONTAINS(error_of([&] { read_pcd_histograms(path, "rgb"); }), "field 'rgb' has TYPE 'U' and SIZE 4");
  const auto writing = [&](const std::string& field, int bins) {
    return error_of([&] { write_pcd_histograms(folder / "b.pcd", field, bins, {{1, 2}, {1, 2, 3}}); });
  };
  EXPECT_CONTAINS(writing("vfh", 2), "b.pcd: histogram 1 has 3 values, 2 expected");
  EXPECT_CONTAINS(writing("vfh", 0), "b.pcd: 0 bins, at least 1 is needed");
  EXPECT_CONTAINS(writing("", 2), "b.pcd: field name '': must be one word");
  EXPECT_CONTAINS(writing("v f", 2), "b.pcd: field name 'v f': must be one word");
  EXPECT_EQ(folder.files(), 1);
}

TEST(PcdHistograms, SurvivesDamage) {
  const TempFolder folder;
  write_pcd_histograms(folder / "a.pcd", "vfh", 20, some_histograms(3, 20));
  survive_damage(content(folder / "a.pcd"),
                 [](const std::filesystem::path& path) { return read_pcd_histograms(path, "vfh"); });
}

}  // namespace
}  // namespace partpose
