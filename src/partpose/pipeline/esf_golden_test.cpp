// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
// ESF against 30 runs of PCL 1.13 on the same points: tests/golden/README.md says how the numbers were made.
#include "partpose/descriptor/esf.hpp"
#include "partpose/io/json.hpp"
#include "partpose/io/pcd.hpp"

#include <gtest/gtest.h>

namespace partpose {
namespace {

const std::filesystem::path golden_folder = PARTPOSE_SOURCE_DIR "/tests/golden";

const Json& golden() {
  static const Json json = read_json_file(golden_folder / "golden_esf.json");
  return json;
}

double l1(const std::vector<double>& a, const std::vector<double>& b, int begin = 0, int end = esf_bins) {
  double sum = 0;
  for (int i = begin; i < end; ++i) sum += std::abs(a[i] - b[i]);
  return sum;
}

class EsfGolden : public ::testing::TestWithParam<int> {
 protected:
  const Json& entry() const { return golden()["clouds"][GetParam()]; }
  std::vector<double> ours(int seed) const {
    const auto cloud = read_pcd(golden_folder / "inputs" / entry()["file"].get<std::string>());
    const auto histogram = esf(cloud, {.seed = seed});
    return {histogram.begin(), histogram.end()};
  }
};

INSTANTIATE_TEST_SUITE_P(Pcl, EsfGolden, ::testing::Range(0, static_cast<int>(golden()["clouds"].size())),
                         [](const auto& info) {
                           const std::string file = golden()["clouds"][info.param]["file"];
                           return file.substr(0, file.find('.'));
                         });

TEST_P(EsfGolden, IsAsNearToPclsMeanAsPclsOwnRuns) {
  const auto mean = entry()["esf_mean"].get<std::vector<double>>();
  for (const int seed : {1, 2, 3, 4, 5})
    EXPECT_LE(l1(ours(seed), mean), entry()["l1_to_mean_largest"].get<double>()) << "seed " << seed;
}

}  // namespace
}  // namespace partpose
