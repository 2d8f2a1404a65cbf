// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/apps/config_keys.hpp"

#include "partpose/evaluation/experiment.hpp"
#include "partpose/pipeline/config_file.hpp"
#include "partpose/synthesis/bop_scenes.hpp"

#include <gtest/gtest.h>

namespace partpose::apps {
namespace {

struct Inner {
  int count = 3;
  std::optional<double> limit_mm;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("count", self.count, "how many, >= 0");
    visit("limit_mm", self.limit_mm, "largest [mm]");
  }
  void check() const {
    if (count < 0) throw Error("count {}: must be 0 or more", count);
  }
};

struct Outer {
  bool flag = false;
  std::string name = "x";
  std::array<float, 2> range = {1, 2};
  std::vector<std::string> words = {"a"};
  Inner inner;
  std::optional<Inner> maybe;
  std::vector<Inner> list = {{}};

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("flag", self.flag, "yes or no");
    visit("name", self.name, "a name");
    visit("range", self.range, "from, to");
    visit("words", self.words, "some words");
    visit("inner", self.inner, "a section");
    visit("maybe", self.maybe, "a section that may be absent");
    visit("list", self.list, "a list of sections");
  }
};

Outer with(const std::vector<std::string>& overrides) {
  Outer outer;
  apply_overrides(outer, overrides);
  return outer;
}

std::string error_of(const std::vector<std::string>& overrides) {
  try {
    with(overrides);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(ConfigKeys, AreThoseOfTheStructs) {
  const auto keys = keys_of<Outer>();
  std::vector<std::string> lines;
  for (const auto& k : keys)
    lines.push_back(fmt::format("{} {}{}{} {}", k.path, k.type, k.optional ? "?" : "", k.section ? " section" : "",
                                json_line(k.standard)));
  const std::vector<std::string> expected = {"flag bool false",
                                             "name str \"x\"",
                                             "range 2 x float [1.0,2.0]",
                                             "words str[] [\"a\"]",
                                             "inner object section null",
                                             "inner.count int 3",
                                             "inner.limit_mm float? null",
                                             "maybe object? section null",
                                             "maybe.count int 3",
                                             "maybe.limit_mm float? null",
                                             "list object[] section null",
                                             "list[].count int 3",
                                             "list[].limit_mm float? null"};
  EXPECT_EQ(lines, expected);
  EXPECT_EQ(keys[5].help, "how many, >= 0");
}

TEST(ConfigKeys, OverridesOfAllTypes) {
  const Outer o = with({"flag=true", "name=two words = one", "range=3,4.5", "words=b,c", "inner.count=7",
                        "inner.limit_mm=2.5", "maybe.count=1", "list[0].count=9"});
  EXPECT_TRUE(o.flag);
  EXPECT_EQ(o.name, "two words = one");
  EXPECT_EQ(o.range, (std::array<float, 2>{3, 4.5f}));
  EXPECT_EQ(o.words, (std::vector<std::string>{"b", "c"}));
  EXPECT_EQ(o.inner.count, 7);
  EXPECT_EQ(o.inner.limit_mm, 2.5);
  ASSERT_TRUE(o.maybe);
  EXPECT_EQ(o.maybe->count, 1);
  EXPECT_EQ(o.list[0].count, 9);
}

TEST(ConfigKeys, OverridesAsJson) {
  EXPECT_EQ(with({R"(name="quoted")"}).name, "quoted");
  EXPECT_EQ(with({"name=12"}).name, "12");
  EXPECT_EQ(with({"name="}).name, "");
  EXPECT_EQ(with({R"(words=["a,b", "c"])"}).words, (std::vector<std::string>{"a,b", "c"}));
  EXPECT_TRUE(with({"words="}).words.empty());
  EXPECT_EQ(with({R"(inner={"count": 5})"}).inner.count, 5);
  EXPECT_EQ(with({R"(list=[{"count": 1}, {"count": 2}])"}).list.size(), 2u);
  EXPECT_FALSE(with({"maybe.count=1", "maybe=null"}).maybe);
  EXPECT_EQ(with({"range[1]=8"}).range[1], 8);
  EXPECT_EQ(with({"inner.count=1", "inner.count=2"}).inner.count, 2) << "the last one counts";
}

TEST(ConfigKeys, WrongOverridesSayWhatWouldBeRight) {
  EXPECT_EQ(error_of({"inner.cuont=1"}),
            "--set inner.cuont=1: unknown key \"inner.cuont\"; did you mean \"inner.count\"?");
  EXPECT_EQ(error_of({"cuont=1"}),
            "--set cuont=1: unknown key \"cuont\"; did you mean \"inner.count\" or \"maybe.count\" or "
            "\"list[].count\"?");
  EXPECT_EQ(error_of({"inner.count.x=1"}),
            "--set inner.count.x=1: unknown key \"inner.count.x\"; did you mean \"inner.count\"?");
  EXPECT_EQ(error_of({"inner.count=many"}),
            "--set inner.count=many: key \"inner.count\": expected a whole number, got string \"many\"");
  EXPECT_EQ(error_of({"inner.count=1.5"}),
            "--set inner.count=1.5: key \"inner.count\": expected a whole number, got number 1.5");
  EXPECT_EQ(error_of({"flag=yes"}), "--set flag=yes: key \"flag\": expected true or false, got string \"yes\"");
  EXPECT_EQ(error_of({"range=1"}), "--set range=1: key \"range\": expected an array of 2, got array [1]");
  EXPECT_EQ(error_of({"range=1,x"}), "--set range=1,x: key \"range[1]\": expected a number, got string \"x\"");
  EXPECT_EQ(error_of({"inner.count=-1"}), "--set inner.count=-1: inner: count -1: must be 0 or more");
  EXPECT_EQ(error_of({"list[1].count=1"}),
            "--set list[1].count=1: \"list[1].count\": there is no item 1, the list has 1 (the first is 0)");
  EXPECT_EQ(error_of({"list[one].count=1"}),
            "--set list[one].count=1: \"[one]\" is no item of a list; write [0] for the first");
  EXPECT_EQ(error_of({"flag"}), "--set flag: expected KEY=VALUE, like vfh.k_nn=9");
  EXPECT_EQ(error_of({"=1"}), "--set =1: expected KEY=VALUE, like vfh.k_nn=9");
  EXPECT_EQ(error_of({"inner..count=1"}),
            "--set inner..count=1: a name is missing; keys are written like a.b or a[0].b");
}

template <typename T>
void expect_commented_reads_back(const T& config) {
  const std::string text = commented_json(config);
  EXPECT_EQ(to_json(from_json<T>(Json::parse(text, nullptr, true, true))), to_json(config));
  for (const auto& key : keys_of<T>()) {
    const std::string name = key.path.substr(key.path.rfind('.') + 1);
    EXPECT_NE(text.find(name), std::string::npos) << key.path << " is not in\n" << text;
  }
}

TEST(ConfigKeys, CommentedJsonReadsBack) {
  Outer changed = with({"maybe.limit_mm=3", "name=a \"b\" // c"});
  expect_commented_reads_back(Outer{});
  expect_commented_reads_back(changed);
  expect_commented_reads_back(GlobalPipelineConfig{});
  expect_commented_reads_back(DatasetPreparationConfig{});
  expect_commented_reads_back(SceneDatasetOptions{});
}

/// Each key of the real configurations can be set to its own default.
template <typename T>
void expect_all_keys_can_be_set() {
  for (const auto& key : keys_of<T>()) {
    if (key.section || key.optional || key.path.find("[]") != std::string::npos) continue;
    T config{};
    EXPECT_NO_THROW(apply_overrides(config, {key.path + "=" + json_line(key.standard)})) << key.path;
    EXPECT_EQ(to_json(config).dump(), to_json(T{}).dump()) << key.path;
  }
}

TEST(ConfigKeys, AllOfThePipelineCanBeSet) { expect_all_keys_can_be_set<GlobalPipelineConfig>(); }
TEST(ConfigKeys, AllOfTheScenesCanBeSet) { expect_all_keys_can_be_set<SceneDatasetOptions>(); }

TEST(ConfigKeys, EveryKeyHasAHelpText) {
  for (const auto& keys : {keys_of<GlobalPipelineConfig>(), keys_of<DatasetPreparationConfig>(),
                           keys_of<SceneDatasetOptions>(), keys_of<ExperimentSpec>()})
    for (const auto& key : keys) EXPECT_GE(key.help.size(), 5u) << key.path;
}

}  // namespace
}  // namespace partpose::apps
