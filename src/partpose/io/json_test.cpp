// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/json.hpp"

#include "partpose/core/pose.hpp"
#include "partpose/io/testing.hpp"

#include <cstdint>
#include <cstring>

namespace partpose {
namespace {

using namespace testing;

struct Inner {
  float size_mm = 1.5f;
  int count = 3;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("size_mm", self.size_mm, "edge length [mm], > 0");
    visit("count", self.count, "how many");
  }
  void check() const {
    if (!(size_mm > 0)) throw Error("size_mm {}: must be positive", size_mm);
  }
  bool operator==(const Inner&) const = default;
};

/// A field of each kind.
struct Everything {
  bool flag = true;
  int number = -7;
  std::int64_t large = 1;
  std::uint64_t seed = 2;
  std::uint8_t small = 3;
  float length_mm = 0.1f;
  double angle_deg = 0.2;
  std::string name = "part";
  std::array<float, 3> three = {1, 2, 3};
  std::vector<int> list = {4, 5};
  std::optional<float> maybe;
  std::optional<Inner> maybe_inner;
  Inner inner;
  std::vector<Inner> inners;
  std::array<std::array<double, 2>, 2> table = {{{1, 2}, {3, 4}}};

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("flag", self.flag, "");
    visit("number", self.number, "");
    visit("large", self.large, "");
    visit("seed", self.seed, "");
    visit("small", self.small, "");
    visit("length_mm", self.length_mm, "");
    visit("angle_deg", self.angle_deg, "");
    visit("name", self.name, "");
    visit("three", self.three, "");
    visit("list", self.list, "");
    visit("maybe", self.maybe, "");
    visit("maybe_inner", self.maybe_inner, "");
    visit("inner", self.inner, "");
    visit("inners", self.inners, "");
    visit("table", self.table, "");
  }
  bool operator==(const Everything&) const = default;
};

/// All keys must be there, but for the optional one.
struct Record {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  int id = -1;
  std::optional<std::string> hash;

  static constexpr bool all_keys_required = true;
  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("pose", self.pose, "");
    visit("id", self.id, "");
    visit("hash", self.hash, "");
  }
};

struct Records {
  std::vector<Record> records;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("records", self.records, "");
  }
};

template <typename T = Everything>
T read_text(const std::string& text) {
  return from_json<T>(Json::parse(text));
}

template <typename T = Everything>
std::string error_in(const std::string& text) {
  return error_of([&] { read_text<T>(text); });
}

Everything all_changed() {
  Everything value;
  value.flag = false;
  value.number = std::numeric_limits<int>::min();
  value.large = std::numeric_limits<std::int64_t>::min();
  value.seed = std::numeric_limits<std::uint64_t>::max();
  value.small = 255;
  value.length_mm = 1e-30f;
  value.angle_deg = -1.0 / 3;
  value.name = "\"quoted\", b\\ack, new\nline, \u00e4\u2260\U0001F600";
  value.three = {-1, 0.1f, 16777216};
  value.list = {};
  value.maybe = 2.5f;
  value.maybe_inner = Inner{7, 8};
  value.inner = {0.25f, -1};
  value.inners = {{1, 1}, {2, 2}, {}};
  value.table = {{{-1e300, 5e-324}, {1.0 / 7, 123456789.123456789}}};
  return value;
}

TEST(Json, AnEmptyObjectIsAllDefaults) { EXPECT_EQ(read_text("{}"), Everything{}); }

TEST(Json, RoundTrip) {
  for (const auto& value : {Everything{}, all_changed()}) {
    EXPECT_EQ(from_json<Everything>(to_json(value)), value);
    EXPECT_EQ(read_text(to_json(value).dump()), value) << "by way of text";
  }
}

TEST(Json, FilesRoundTrip) {
  const TempFolder folder;
  write_json(folder / "a.json", all_changed());
  EXPECT_EQ(read_json<Everything>(folder / "a.json"), all_changed());
  EXPECT_EQ(folder.files(), 1) << "the temporary file is still there";
  const auto text = content(folder / "a.json");
  EXPECT_TRUE(text.starts_with("{\n  \"flag\": false,\n  \"number\"")) << text;
  EXPECT_TRUE(text.ends_with("}\n"));
}

TEST(Json, KeysComeInTheOrderOfTheDescription) {
  std::vector<std::string> keys;
  const Json json = to_json(Inner{});
  for (const auto& [key, value] : json.items()) keys.push_back(key);
  EXPECT_EQ(keys, (std::vector<std::string>{"size_mm", "count"}));
}

TEST(Json, OneKeyChangesOneField) {
  Everything expected;
  expected.inner.count = 9;
  EXPECT_EQ(read_text(R"({"inner": {"count": 9}})"), expected);
  expected = {};
  expected.list = {1};
  EXPECT_EQ(read_text(R"({"list": [1]})"), expected);
}

std::uint32_t bits(float value) {
  std::uint32_t out;
  std::memcpy(&out, &value, sizeof out);
  return out;
}

float through_text(float value) {
  Inner inner;
  inner.size_mm = value;
  // Only the number: check() would refuse negative ones.
  return Json::parse(to_json(inner).dump())["size_mm"].get<float>();
}

TEST(Json, FloatsKeepTheirBits) {
  std::mt19937 random(1);
  int finite = 0;
  for (int i = 0; i < 200000; ++i) {
    float value;
    const auto pattern = static_cast<std::uint32_t>(random());
    std::memcpy(&value, &pattern, sizeof value);
    if (!std::isfinite(value)) continue;
    ++finite;
    ASSERT_EQ(bits(through_text(value)), bits(value)) << value;
  }
  EXPECT_GT(finite, 190000);
  using Limits = std::numeric_limits<float>;
  for (const float value : {0.0f, 1.0f, 0.1f, 16777217.0f, 3e9f, 1e15f, 1e16f, 1e20f, Limits::max(), Limits::lowest(),
                            Limits::min(), Limits::denorm_min()})
    EXPECT_EQ(bits(through_text(value)), bits(value)) << value;
}

TEST(Json, FloatsAreNotRoundedTwice) {
  // Its shortest decimal, read as a double and then rounded to a float, is the next float.
  EXPECT_EQ(bits(through_text(7.038531e-26f)), bits(7.038531e-26f));
}

TEST(Json, NegativeZeroKeepsItsSign) { EXPECT_EQ(bits(through_text(-0.0f)), bits(-0.0f)); }

TEST(Json, FloatsAreWrittenShort) { EXPECT_EQ(to_json(Inner{0.1f, 3}).dump(), R"({"size_mm":0.1,"count":3})"); }

TEST(Json, DoublesKeepTheirBits) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 100000; ++i) {
    const std::uint64_t pattern = random();
    double value;
    std::memcpy(&value, &pattern, sizeof value);
    if (!std::isfinite(value)) continue;
    Everything everything;
    everything.angle_deg = value;
    EXPECT_EQ(read_text(to_json(everything).dump()).angle_deg, value);
  }
}

TEST(Json, WholeNumbersAreNumbersToo) {
  EXPECT_EQ(read_text(R"({"length_mm": 3, "angle_deg": -4})").length_mm, 3);
  EXPECT_EQ(read_text(R"({"length_mm": 3, "angle_deg": -4})").angle_deg, -4);
}

TEST(Json, OptionalFields) {
  EXPECT_FALSE(to_json(Everything{}).contains("maybe"));
  EXPECT_EQ(read_text(R"({"maybe": 4})").maybe, 4.0f);
  EXPECT_EQ(read_text(R"({"maybe": null})").maybe, std::nullopt);
  EXPECT_EQ(read_text(R"({"maybe_inner": {}})").maybe_inner, Inner{});
  EXPECT_EQ(error_in(R"({"maybe": "4"})"), "key \"maybe\": expected a number, got string \"4\"");
}

TEST(Json, AnUnknownKeyNamesTheNearestAndItsPath) {
  EXPECT_EQ(error_in(R"({"flg": true})"), "unknown key \"flg\"; did you mean \"flag\"?");
  EXPECT_EQ(error_in(R"({"inner": {"size": 2}})"), "unknown key \"inner.size\"; did you mean \"size_mm\"?");
  EXPECT_EQ(error_in(R"({"inners": [{}, {"coumt": 2}]})"), "unknown key \"inners[1].coumt\"; did you mean \"count\"?");
  EXPECT_EQ(error_in(R"({"maybe_inner": {"Count": 2}})"), "unknown key \"maybe_inner.Count\"; did you mean \"count\"?");
}

TEST(Json, WrongTypesNameTheKeyAndTheValue) {
  EXPECT_EQ(error_in(R"({"flag": 1})"), "key \"flag\": expected true or false, got number 1");
  EXPECT_EQ(error_in(R"({"flag": "true"})"), "key \"flag\": expected true or false, got string \"true\"");
  EXPECT_EQ(error_in(R"({"number": 1.5})"), "key \"number\": expected a whole number, got number 1.5");
  EXPECT_EQ(error_in(R"({"number": 1.0})"), "key \"number\": expected a whole number, got number 1.0");
  EXPECT_EQ(error_in(R"({"number": true})"), "key \"number\": expected a whole number, got boolean true");
  EXPECT_EQ(error_in(R"({"length_mm": null})"), "key \"length_mm\": expected a number, got null");
  EXPECT_EQ(error_in(R"({"length_mm": [1]})"), "key \"length_mm\": expected a number, got array [1]");
  EXPECT_EQ(error_in(R"({"angle_deg": true})"), "key \"angle_deg\": expected a number, got boolean true");
  EXPECT_EQ(error_in(R"({"name": 5})"), "key \"name\": expected a string, got number 5");
  EXPECT_EQ(error_in(R"({"inner": []})"), "key \"inner\": expected an object, got array []");
  EXPECT_EQ(error_in(R"({"inner": null})"), "key \"inner\": expected an object, got null");
  EXPECT_EQ(error_in(R"({"inners": {}})"), "key \"inners\": expected an array, got object {}");
  EXPECT_EQ(error_in(R"({"list": [1, "2"]})"), "key \"list[1]\": expected a whole number, got string \"2\"");
  EXPECT_EQ(error_in(R"({"inner": {"count": {}}})"), "key \"inner.count\": expected a whole number, got object {}");
  EXPECT_EQ(error_in("[]"), "expected an object, got array []");
  EXPECT_EQ(error_in("3"), "expected an object, got number 3");
}

TEST(Json, ArraysOfFixedLength) {
  EXPECT_EQ(error_in(R"({"three": [1, 2]})"), "key \"three\": expected an array of 3, got array [1,2]");
  EXPECT_EQ(error_in(R"({"three": [1, 2, 3, 4]})"), "key \"three\": expected an array of 3, got array [1,2,3,4]");
  EXPECT_EQ(error_in(R"({"three": 1})"), "key \"three\": expected an array of 3, got number 1");
  EXPECT_EQ(error_in(R"({"three": [1, null, 3]})"), "key \"three[1]\": expected a number, got null");
  EXPECT_EQ(error_in(R"({"table": [[1, 2], [3, "4"]]})"), "key \"table[1][1]\": expected a number, got string \"4\"");
}

TEST(Json, LongValuesAreCutInMessages) {
  const auto message = error_in(R"({"number": ")" + std::string(1000, 'x') + R"("})");
  EXPECT_LT(message.size(), 120);
  EXPECT_CONTAINS(message, "...");
}

TEST(Json, IntegersOutOfRange) {
  const auto expect_out_of_range = [](const std::string& key, const std::string& value) {
    EXPECT_EQ(error_in("{\"" + key + "\": " + value + "}"),
              "key \"" + key + "\": expected a whole number in range, got number " + value);
  };
  expect_out_of_range("number", "2147483648");
  expect_out_of_range("number", "-2147483649");
  expect_out_of_range("number", "18446744073709551615");
  expect_out_of_range("large", "9223372036854775808");
  expect_out_of_range("seed", "-1");
  expect_out_of_range("small", "256");
  expect_out_of_range("small", "-1");
  EXPECT_CONTAINS(error_in(R"({"seed": 18446744073709551616})"), "key \"seed\": expected a whole number");
  EXPECT_CONTAINS(error_in(R"({"large": -9223372036854775809})"), "key \"large\": expected a whole number");
  EXPECT_EQ(read_text(R"({"number": 2147483647})").number, 2147483647);
  EXPECT_EQ(read_text(R"({"seed": 18446744073709551615})").seed, 18446744073709551615ull);
  EXPECT_EQ(read_text(R"({"large": -9223372036854775808})").large, std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(read_text(R"({"small": 0})").small, 0);
}

TEST(Json, FloatsOutOfRange) {
  EXPECT_CONTAINS(error_in(R"({"length_mm": 1e39})"), "key \"length_mm\": expected a number in range");
  EXPECT_CONTAINS(error_in(R"({"length_mm": -1e300})"), "key \"length_mm\": expected a number in range");
  EXPECT_EQ(read_text(R"({"angle_deg": 1e39})").angle_deg, 1e39);
}

TEST(Json, WhatIsNotFiniteIsWrittenAsNull) {
  Everything value;
  value.length_mm = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(to_json(value)["length_mm"].is_null());
  value = {};
  value.angle_deg = std::numeric_limits<double>::infinity();
  EXPECT_CONTAINS(to_json(value).dump(), "\"angle_deg\":null");
}

TEST(Json, ChecksNameTheKey) {
  EXPECT_EQ(error_in(R"({"inner": {"size_mm": -2}})"), "inner: size_mm -2: must be positive");
  EXPECT_EQ(error_in(R"({"inners": [{}, {"size_mm": 0}]})"), "inners[1]: size_mm 0: must be positive");
  EXPECT_EQ(error_in<Inner>(R"({"size_mm": -2})"), "size_mm -2: must be positive");
}

TEST(Json, RecordsNeedAllTheirKeys) {
  const std::string pose = R"("pose": [[1,0,0,5],[0,1,0,6],[0,0,1,7],[0,0,0,1]])";
  const auto record = read_text<Record>("{" + pose + R"(, "id": 4})");
  EXPECT_EQ(record.id, 4);
  EXPECT_EQ(record.hash, std::nullopt);
  EXPECT_EQ(record.pose.translation(), Eigen::Vector3d(5, 6, 7));
  EXPECT_EQ(error_in<Record>("{" + pose + "}"), "key \"id\" is missing");
  EXPECT_EQ(error_in<Record>(R"({"id": 4})"), "key \"pose\" is missing");
  EXPECT_EQ(error_in<Records>(R"({"records": [{)" + pose + R"(, "id": 4}, {"id": 5}]})"),
            "key \"records[1].pose\" is missing");
  EXPECT_EQ(read_text<Record>("{" + pose + R"(, "id": 4, "hash": "ab"})").hash, "ab");
}

TEST(Json, PosesKeepTheirBits) {
  Record record;
  record.pose = Eigen::Translation3d(0.1, -650.123456789, 1e-9) *
                Eigen::AngleAxisd(1.2345, Eigen::Vector3d(1, 2, 3).normalized());
  const auto again = read_text<Record>(to_json(record).dump());
  EXPECT_EQ(again.pose.matrix(), record.pose.matrix());
  EXPECT_EQ(to_json(record)["pose"][0][3], 0.1) << "row by row";
}

TEST(Json, PosesMustBeRigid) {
  const auto error_with = [](const std::string& rows) {
    return error_in<Record>(R"({"id": 0, "pose": )" + rows + "}");
  };
  const std::string not_rigid = "key \"pose\": not a rigid transformation (rotation and translation, 4x4)";
  EXPECT_EQ(error_with("[[2,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]"), not_rigid) << "scaled";
  EXPECT_EQ(error_with("[[-1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]"), not_rigid) << "mirrored";
  EXPECT_EQ(error_with("[[1,0.1,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]"), not_rigid) << "sheared";
  EXPECT_EQ(error_with("[[1,0,0,0],[0,1,0,0],[0,0,1,0],[5,6,7,1]]"), not_rigid) << "columns for rows";
  EXPECT_EQ(error_with("[[0,0,0,0],[0,0,0,0],[0,0,0,0],[0,0,0,0]]"), not_rigid);
  EXPECT_EQ(error_with("[[1,0,0,0],[0,1,0,0],[0,0,1,0]]"),
            "key \"pose\": expected an array of 4, got array [[1,0,0,0],[0,1,0,0],[0,0,1,0]]");
  EXPECT_EQ(error_with("[[1,0,0,0],[0,1,0],[0,0,1,0],[0,0,0,1]]"),
            "key \"pose[1]\": expected an array of 4, got array [0,1,0]");
  EXPECT_EQ(error_with("[[1,0,0,null],[0,1,0,0],[0,0,1,0],[0,0,0,1]]"),
            "key \"pose[0][3]\": expected a number, got null");
}

TEST(JsonFile, BrokenOnesNameFileAndPlace) {
  const TempFolder folder;
  const auto reading = [&](const std::string& text) {
    const auto path = folder.file("broken.json", text);
    return replaced(error_of([&] { read_json_file(path); }), path.string(), "FILE");
  };
  EXPECT_EQ(reading("{\"a\": 1,}"), "FILE: line 1, column 9: not valid JSON here");
  EXPECT_EQ(reading("{\"a\": 1"), "FILE: line 1, column 8: not valid JSON here");
  EXPECT_EQ(reading("{\"a\": nope}"), "FILE: line 1, column 8: not valid JSON here");
  EXPECT_EQ(reading("{\n  \"a\": 1,\n  \"b\" 2\n}"), "FILE: line 3, column 7: not valid JSON here");
  EXPECT_EQ(reading("{} {}"), "FILE: line 1, column 4: not valid JSON here");
  EXPECT_CONTAINS(reading("{'a': 1}"), "FILE: line 1, column 2: ");
  EXPECT_CONTAINS(reading("{\"a\": \"\xff\"}"), "FILE: line 1, column 8: ");
  EXPECT_CONTAINS(reading("{\"a\": 1} / comment"), "FILE: line 1, column ");
  EXPECT_CONTAINS(reading("{\"a\": 1} /* comment"), "FILE: line 1, column ");
  EXPECT_CONTAINS(reading("{\"a\": 1e999}"), "FILE: ");
  EXPECT_CONTAINS(reading(std::string(100000, '[')), "FILE: line 1, column 100001: ");
  EXPECT_CONTAINS(reading(std::string("\0\0\0", 3)), "FILE: line 1, column 1: ");
  EXPECT_CONTAINS(reading(""), "FILE: byte 0: the file is empty");
}

TEST(JsonFile, CommentsAreSpace) {
  const TempFolder folder;
  const auto path = folder.file("commented.json", "// what it is\n{\"a\": /* one */ 1, // and\n \"b\": \"// no\"}\n");
  EXPECT_EQ(read_json_file(path), (Json{{"a", 1}, {"b", "// no"}}));
}

TEST(JsonFile, MissingOnes) {
  const TempFolder folder;
  EXPECT_EQ(error_of([&] { read_json<Inner>(folder / "no.json"); }), (folder / "no.json").string() + ": no such file");
}

TEST(JsonFile, AKeyGivenTwiceIsAnError) {
  const TempFolder folder;
  const auto reading = [&](const std::string& text) {
    const auto path = folder.file("a.json", text);
    return replaced(error_of([&] { read_json_file(path); }) + "#", path.string() + ": ", "");
  };
  EXPECT_EQ(reading(R"({"a": 1, "b": 2, "a": 1})"), "key \"a\" is given twice#");
  EXPECT_EQ(reading(R"({"x": [{"a": 1}, {"b": {"c": 1, "c": 2}}]})"), "key \"c\" is given twice#");
  EXPECT_EQ(reading(R"({"a": {"c": 1}, "a": 2})"), "key \"a\" is given twice#") << "also across an object between";
  const auto path = folder.file("a.json", R"({"a": {"a": 1, "b": 1}, "b": [{"a": 1}, {"a": 2}]})");
  EXPECT_EQ(error_of([&] { read_json_file(path); }), "no error") << "in other objects they may come again";
}

TEST(JsonFile, ErrorsNameTheFileAndTheKey) {
  const TempFolder folder;
  const auto path = folder.file("a.json", R"({"inner": {"count": "many"}})");
  EXPECT_EQ(error_of([&] { read_json<Everything>(path); }),
            path.string() + ": key \"inner.count\": expected a whole number, got string \"many\"");
}

TEST(JsonFile, ErrorsAreOneLineWhateverTheKey) {
  const TempFolder folder;
  for (const std::string text : {R"({"two\nlines": 1})", R"({"inner": {"a\tb": 1}})", R"({"k\r": 1, "k\r": 2})"}) {
    const auto path = folder.file("a.json", text);
    const auto message = error_of([&] { read_json<Everything>(path); });
    EXPECT_TRUE(std::ranges::none_of(message, [](char c) { return static_cast<unsigned char>(c) < ' '; })) << message;
  }
}

TEST(JsonFile, CutValuesInErrorsAreStillUtf8) {
  for (std::size_t before = 30; before < 40; ++before) {
    const auto message =
        error_in(R"({"number": ")" + std::string(before, 'x') + "\u00e4\u00e4\u00e4\u00e4\u00e4\u00e4\"}");
    EXPECT_NO_THROW(Json(message).dump()) << "not UTF-8 with " << before << " letters before";
  }
}

TEST(JsonFile, AStringThatIsNotUtf8CannotBeWritten) {
  const TempFolder folder;
  Everything value;
  value.name = "Latin-1: \xe4";
  const auto write = [&] { write_json(folder / "a.json", value); };
  EXPECT_THROW(write(), Error);
  EXPECT_EQ(folder.files(), 0);
}

}  // namespace
}  // namespace partpose
