// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/descriptor/esf.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/random.hpp"
#include "partpose/descriptor/order_free.hpp"

#include <array>
#include <numbers>
#include <tuple>

namespace partpose {

namespace {

constexpr int grid_size = 64;
constexpr int half_grid = grid_size / 2;

/// The parts of the histogram, in PCL's order.
enum Part : int { a3_in, a3_out, a3_mixed, d3_in, d3_out, d3_mixed, d2_in, d2_out, d2_mixed, d2_ratio, parts };

/// PCL's weights. The angles are counted in voxels of the opposite side, 1/32 each.
constexpr std::array<float, parts> part_weight = {0.5f / 32, 0.5f / 32, 0.5f / 32, 0.5f, 0.5f,
                                                  1.0f,      0.5f,      2.0f,      2.0f, 1.0f};

/// Where a side or a triangle lies.
enum Place { inside, outside, mixed };

struct Voxel {
  int x, y, z;
};

/// Points about their centroid, scaled so that the farthest is half_grid away, with their voxels.
/// In the order of the distance from the centroid: the order in the cloud does not matter, doubled points stand side by
/// side, and a turned cloud keeps its order but for rounding. So clouds that look alike are sampled alike.
struct ScaledPoints {
  std::vector<Eigen::Vector3f> points;
  std::vector<Voxel> voxels;
};

/// PCL's rounding: a border belongs to the voxel nearer to the centre.
int voxel_of(float coordinate) {
  const float voxel = coordinate < 0 ? std::floor(coordinate) : std::ceil(coordinate) - 1;
  return std::clamp(static_cast<int>(voxel) + half_grid, 0, grid_size - 1);
}

ScaledPoints scale(const std::vector<Eigen::Vector3f>& points) {
  const Eigen::Vector3d centre = order_free_centroid(points);
  double largest = 0;
  for (const auto& p : points) largest = std::max(largest, (p.cast<double>() - centre).norm());
  ScaledPoints scaled;
  if (!(largest > 0)) return scaled;

  std::vector<Eigen::Vector3f> unsorted;
  std::vector<std::uint64_t> keys;  // squared distance (the bits of a float >= 0 sort like the float), index
  unsorted.reserve(points.size());
  keys.reserve(points.size());
  for (const auto& p : points) {
    unsorted.push_back(((p.cast<double>() - centre) * (half_grid / largest)).cast<float>());
    keys.push_back(std::uint64_t{std::bit_cast<std::uint32_t>(unsorted.back().squaredNorm())} << 32 | keys.size());
  }
  std::sort(keys.begin(), keys.end());
  const auto point_of = [&](std::uint64_t key) -> const Eigen::Vector3f& {
    return unsorted[static_cast<std::uint32_t>(key)];
  };
  for (auto begin = keys.begin(); begin != keys.end();) {
    const auto end = std::find_if(begin, keys.end(), [&](auto key) { return key >> 32 != *begin >> 32; });
    std::sort(begin, end, [&](auto a, auto b) {
      const auto &p = point_of(a), &q = point_of(b);
      return std::tuple(p.x(), p.y(), p.z()) < std::tuple(q.x(), q.y(), q.z());
    });
    begin = end;
  }
  scaled.points.reserve(points.size());
  scaled.voxels.reserve(points.size());
  for (const auto key : keys) {
    const auto& p = scaled.points.emplace_back(point_of(key));
    scaled.voxels.push_back({voxel_of(p.x()), voxel_of(p.y()), voxel_of(p.z())});
  }
  return scaled;
}

/// 2^32 / i, rounded up: x * reciprocal[i] >> 32 is x / i for x below 2^22.
constexpr std::array<std::uint64_t, grid_size> reciprocal = [] {
  std::array<std::uint64_t, grid_size> inverse{};
  for (std::uint64_t i = 1; i < grid_size; ++i) inverse[i] = (std::uint64_t{1} << 32) / i + 1;
  return inverse;
}();

/// 64 x 64 x 64 bits, z along the bits of a word, filled wherever a point is at most one voxel away along each axis.
class VoxelGrid {
 public:
  explicit VoxelGrid(const std::vector<Voxel>& voxels) {
    std::array<std::uint64_t, grid_size * grid_size> along_z{}, along_yz{};
    for (const auto& v : voxels) along_z[word_of(v.x, v.y)] |= std::uint64_t{1} << v.z;
    for (auto& word : along_z) word |= word << 1 | word >> 1;
    for (int x = 0; x < grid_size; ++x)
      for (int y = 0; y < grid_size; ++y)
        for (int near = std::max(y - 1, 0); near <= std::min(y + 1, grid_size - 1); ++near)
          along_yz[word_of(x, y)] |= along_z[word_of(x, near)];
    for (int x = 0; x < grid_size; ++x)
      for (int near = std::max(x - 1, 0); near <= std::min(x + 1, grid_size - 1); ++near)
        for (int y = 0; y < grid_size; ++y) words_[word_of(x, y)] |= along_yz[word_of(near, y)];
  }

  /// The voxels of a line, from the voxel `from` on and without the voxel `to` (the first one counts if both are the
  /// same).
  struct Line {
    int length = 1;
    int filled = 0;
  };

  /// Bresenham's line in 3D. After k steps along the longest axis (l voxels), an axis of m voxels has moved by k m / l,
  /// rounded, halves towards `from`. All three are walked at once as fixed-point fields of one integer; the steps are
  /// rounded up, which adds up to less than the 1 / (2 l) that lies between the roundings.
  Line trace(const Voxel& from, const Voxel& to) const {
    constexpr int fraction_bits = 15, field_bits = fraction_bits + 6;
    constexpr std::int64_t one = 1 << fraction_bits;
    const std::array<int, 3> delta = {to.x - from.x, to.y - from.y, to.z - from.z};
    const int longest = std::max({std::abs(delta[0]), std::abs(delta[1]), std::abs(delta[2]), 1});
    const std::uint64_t inverse = reciprocal[longest];
    const std::int64_t half_way_up = one / 2 - static_cast<std::int64_t>((one / 2) * inverse >> 32);
    std::int64_t position = 0, step = 0;
    const std::array<int, 3> start = {from.x, from.y, from.z};
    for (int axis = 0; axis < 3; ++axis) {
      const bool up = delta[axis] >= 0;
      const std::uint64_t way = static_cast<std::uint64_t>(std::abs(delta[axis])) << fraction_bits;
      const auto slope = static_cast<std::int64_t>((up ? way + longest - 1 : way) * inverse >> 32);
      position = (position << field_bits) + start[axis] * one + (up ? half_way_up : one / 2);
      step = step * (std::int64_t{1} << field_bits) + (up ? slope : -slope);
    }
    Line line{longest, 0};
    auto at = static_cast<std::uint64_t>(position);
    for (int k = 0; k < longest; ++k) {
      const std::uint64_t word =
          words_[(at >> (fraction_bits + 2 * field_bits - 6) & 0xFC0) | (at >> (fraction_bits + field_bits) & 0x3F)];
      line.filled += static_cast<int>(word >> (at >> fraction_bits & 0x3F) & 1);
      at += static_cast<std::uint64_t>(step);
    }
    return line;
  }

 private:
  static int word_of(int x, int y) { return x * grid_size + y; }

  std::array<std::uint64_t, grid_size * grid_size> words_{};
};

/// PCL's limits. The ends of a side are inside by themselves: up to seven filled voxels still count as outside.
Place place_of(const VoxelGrid::Line& side) {
  if (side.filled >= side.length - 1) return inside;
  return side.filled <= 7 ? outside : mixed;
}

Place place_of(const std::array<VoxelGrid::Line, 3>& sides) {
  const int length = sides[0].length + sides[1].length + sides[2].length;
  const int filled = sides[0].filled + sides[1].filled + sides[2].filled;
  if (filled <= 21) return outside;
  return length - filled < 4 ? inside : mixed;
}

int bin_of(float share) { return static_cast<int>(share * (esf_part_bins - 1) + 0.5f); }

/// acos of 0 to 1 in right angles, within 2e-8 rad (Abramowitz and Stegun 1964, 4.4.46): no call, so that loops over it
/// become vector code.
inline float acos_share(float cosine) {
  const float polynomial =
      1.5707963050f +
      cosine *
          (-0.2145988016f +
           cosine *
               (0.0889789874f +
                cosine * (-0.0501743046f +
                          cosine * (0.0308918810f +
                                    cosine * (-0.0170881256f + cosine * (0.0066700901f + cosine * -0.0012624911f))))));
  return std::sqrt(1 - cosine) * polynomial * static_cast<float>(2 / std::numbers::pi);
}

/// Triangles side by side, as vector code wants them. Side i joins corner i and corner i + 1; angle i is opposite.
struct Triangles {
  static constexpr int capacity = 256;
  std::array<std::array<std::uint32_t, capacity>, 3> corner;
  std::array<std::array<float, capacity>, 3> side, angle_share;
  std::array<float, capacity> area_squared;
};

void measure(const std::vector<Eigen::Vector3f>& points, Triangles& t) {
  std::array<std::array<float, Triangles::capacity>, 9> p;
  for (int i = 0; i < Triangles::capacity; ++i)
    for (int c = 0; c < 3; ++c) {
      const auto& point = points[t.corner[c][i]];
      for (int axis = 0; axis < 3; ++axis) p[3 * c + axis][i] = point[axis];
    }
#pragma omp simd
  for (int i = 0; i < Triangles::capacity; ++i) {
    const float ux = p[3][i] - p[0][i], uy = p[4][i] - p[1][i], uz = p[5][i] - p[2][i];  // corner 0 to 1
    const float vx = p[6][i] - p[3][i], vy = p[7][i] - p[4][i], vz = p[8][i] - p[5][i];  // corner 1 to 2
    const float wx = p[0][i] - p[6][i], wy = p[1][i] - p[7][i], wz = p[2][i] - p[8][i];  // corner 2 to 0
    const float nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
    t.area_squared[i] = 0.25f * (nx * nx + ny * ny + nz * nz);
    const float u = std::sqrt(ux * ux + uy * uy + uz * uz), v = std::sqrt(vx * vx + vy * vy + vz * vz),
                w = std::sqrt(wx * wx + wy * wy + wz * wz);
    t.side[0][i] = u;
    t.side[1][i] = v;
    t.side[2][i] = w;
    // Points that coincide divide by zero: such a triangle has no area and is not used.
    t.angle_share[0][i] = acos_share(std::min(std::abs(vx * wx + vy * wy + vz * wz) / (v * w), 1.0f));
    t.angle_share[1][i] = acos_share(std::min(std::abs(wx * ux + wy * uy + wz * uz) / (w * u), 1.0f));
    t.angle_share[2][i] = acos_share(std::min(std::abs(ux * vx + uy * vy + uz * vz) / (u * v), 1.0f));
  }
}

class Esf final : public GlobalDescriptor {
 public:
  explicit Esf(const EsfOptions& options) : options_(options) {}
  int bins() const override { return esf_bins; }
  std::vector<Description> describe(const PointCloud& cloud) const override {
    auto histogram = esf(cloud, options_);
    if (std::all_of(histogram.begin(), histogram.end(), [](float value) { return value == 0; })) return {};
    const auto points = finite_points(cloud);
    return {{.histogram = std::move(histogram),
             .centroid_mm = order_free_centroid(points),
             .support = static_cast<int>(points.size())}};
  }

 private:
  EsfOptions options_;
};

}  // namespace

void EsfOptions::check() const {
  check_neighbours(k_nn);
  if (samples < 1 || samples > 10'000'000) throw Error("samples {}: must be 1 to 10000000", samples);
  if (seed < 0) throw Error("seed {}: must be 0 or more", seed);
}

std::unique_ptr<GlobalDescriptor> make_descriptor(const EsfOptions& options) { return std::make_unique<Esf>(options); }

std::vector<float> esf(const PointCloud& cloud, const EsfOptions& options) {
  std::vector<float> histogram(esf_bins, 0.0f);
  const ScaledPoints shape = scale(finite_points(cloud));
  const auto count = static_cast<std::uint64_t>(shape.points.size());
  if (count < 3) return histogram;
  const VoxelGrid grid(shape.voxels);

  // Counted in whole numbers. The bins of lengths and areas wait for the largest one.
  std::array<std::array<std::int64_t, esf_part_bins>, parts> bins{};
  struct Measured {
    float value;
    Place place;
  };
  std::vector<Measured> lengths, areas;
  lengths.reserve(3 * static_cast<std::size_t>(options.samples));
  areas.reserve(options.samples);
  Random random(static_cast<std::uint64_t>(options.seed));
  Triangles t;
  constexpr int most_tries = 20;  // a share of triangles below 1 in 20: points on a line, nearly
  const std::int64_t blocks = (std::int64_t{options.samples} * most_tries) / Triangles::capacity + 1;
  for (std::int64_t block = 0; block < blocks && areas.size() < options.samples; ++block) {
    for (int i = 0; i < Triangles::capacity; ++i) {
      const std::uint64_t first = random.next(), second = random.next();
      t.corner[0][i] = static_cast<std::uint32_t>((first >> 32) * count >> 32);
      t.corner[1][i] = static_cast<std::uint32_t>((first & 0xFFFFFFFF) * count >> 32);
      t.corner[2][i] = static_cast<std::uint32_t>((second >> 32) * count >> 32);
    }
    measure(shape.points, t);
    for (int i = 0; i < Triangles::capacity && areas.size() < options.samples; ++i) {
      constexpr float smallest_area_squared = 0.001f;  // PCL's; voxels to the fourth power
      if (!(t.area_squared[i] > smallest_area_squared)) continue;
      std::array<VoxelGrid::Line, 3> sides;
      for (int s = 0; s < 3; ++s) {
        sides[s] = grid.trace(shape.voxels[t.corner[s][i]], shape.voxels[t.corner[(s + 1) % 3][i]]);
        const Place place = place_of(sides[s]);
        lengths.push_back({t.side[s][i], place});
        if (place == mixed)
          ++bins[d2_ratio][bin_of(static_cast<float>(sides[s].filled) / static_cast<float>(sides[s].length))];
      }
      const Place place = place_of(sides);
      // Angle i is at the corner that side i does not touch.
      for (int s = 0; s < 3; ++s) bins[int{a3_in} + place][bin_of(t.angle_share[s][i])] += sides[s].length;
      areas.push_back({std::sqrt(std::sqrt(t.area_squared[i])), place});
    }
  }
  const auto add = [&](const std::vector<Measured>& values, Part first_part) {
    float largest = 0;
    for (const auto& v : values) largest = std::max(largest, v.value);
    for (const auto& v : values) ++bins[int{first_part} + v.place][bin_of(v.value / largest)];
  };
  add(areas, d3_in);
  add(lengths, d2_in);

  double sum = 0;
  for (int part = 0; part < parts; ++part)
    for (const auto bin : bins[part]) sum += static_cast<double>(bin) * part_weight[part];
  if (sum == 0) return histogram;
  for (int part = 0; part < parts; ++part)
    for (int bin = 0; bin < esf_part_bins; ++bin)
      histogram[part * esf_part_bins + bin] =
          static_cast<float>(static_cast<double>(bins[part][bin]) * part_weight[part] / sum);
  return histogram;
}

}  // namespace partpose
