// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/descriptor/esf.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/random.hpp"
#include "partpose/descriptor/order_free.hpp"
#include "partpose/geometry/point_grid.hpp"

#include <array>
#include <numbers>
#include <tuple>

#ifdef __AVX2__
#include <immintrin.h>
#endif

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
enum Place : int { inside, outside, mixed };

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
  std::vector<std::uint64_t> keys;  // squared distance: the bits of a float >= 0 sort like the float
  unsorted.reserve(points.size());
  keys.reserve(points.size());
  for (const auto& p : points) {
    unsorted.push_back(((p.cast<double>() - centre) * (half_grid / largest)).cast<float>());
    keys.push_back(std::bit_cast<std::uint32_t>(unsorted.back().squaredNorm()));
  }
  std::vector<int> order = order_by_key(keys);
  for (auto begin = order.begin(); begin != order.end();) {
    const auto end = std::find_if(begin, order.end(), [&](int i) { return keys[i] != keys[*begin]; });
    if (end - begin > 1)
      std::sort(begin, end, [&](int a, int b) {
        const auto &p = unsorted[a], &q = unsorted[b];
        return std::tuple(p.x(), p.y(), p.z()) < std::tuple(q.x(), q.y(), q.z());
      });
    begin = end;
  }
  scaled.points.reserve(points.size());
  scaled.voxels.reserve(points.size());
  for (const int i : order) {
    const auto& p = scaled.points.emplace_back(unsorted[i]);
    scaled.voxels.push_back({voxel_of(p.x()), voxel_of(p.y()), voxel_of(p.z())});
  }
  return scaled;
}

/// Triangles side by side, as vector code wants them. Side i joins corner i and corner i + 1; angle i is opposite.
struct Triangles {
  static constexpr int capacity = 256;
  template <typename T>
  using PerTriangle = std::array<T, capacity>;
  std::array<PerTriangle<std::uint32_t>, 3> corner;  ///< number of the point
  std::array<PerTriangle<float>, 3> side, angle_share;
  PerTriangle<float> area_squared;
  std::array<PerTriangle<int>, 3> length, filled;  ///< of the sides, in voxels
};

/// 64 x 64 x 64 bits, set wherever a point is at most one voxel away along each axis.
/// Three copies, one for lines along each axis: a line steps from row to row of 128 words, a row is u + 64 (v / 32),
/// and the bits of a word are v % 32, where u and v are the two other axes.
class VoxelGrid {
 public:
  explicit VoxelGrid(const std::vector<Voxel>& voxels) {
    const auto around = [](int i) { return std::pair(std::max(i - 1, 0), std::min(i + 1, grid_size - 1)); };
    std::array<std::uint64_t, grid_size * grid_size> along_z{}, along_yz{}, filled{};
    for (const auto& v : voxels) along_z[v.x * grid_size + v.y] |= std::uint64_t{1} << v.z;
    for (auto& word : along_z) word |= word << 1 | word >> 1;
    for (int x = 0; x < grid_size; ++x)
      for (int y = 0; y < grid_size; ++y)
        for (auto [near, last] = around(y); near <= last; ++near)
          along_yz[x * grid_size + y] |= along_z[x * grid_size + near];
    for (int x = 0; x < grid_size; ++x)
      for (auto [near, last] = around(x); near <= last; ++near)
        for (int y = 0; y < grid_size; ++y) filled[x * grid_size + y] |= along_yz[near * grid_size + y];

    for (int x = 0; x < grid_size; ++x)
      for (int y = 0; y < grid_size; ++y) {
        const std::uint64_t along = filled[x * grid_size + y];
        for (const int upper : {0, 1}) {
          const auto word = static_cast<std::uint32_t>(along >> 32 * upper);
          words_[grid_words + x * row_size + y + 64 * upper] = word;
          words_[2 * grid_words + y * row_size + x + 64 * upper] = word;
        }
        for (std::uint64_t rest = along; rest != 0; rest &= rest - 1)
          words_[3 * grid_words + std::countr_zero(rest) * row_size + x + 64 * (y / 32)] |= std::uint32_t{1} << y % 32;
      }
  }

  /// Length and filled voxels of the triangles' sides, each from the voxel of its first corner on and without the voxel
  /// of its second (one voxel if both are the same).
  ///
  /// Bresenham's line in 3D. After k steps along its longest axis (l voxels), an axis of m voxels has moved by k m / l,
  /// rounded, halves towards the start. Here u and v are fixed-point numbers with 26 bits behind the point whose sum is
  /// cut: they start at 1/2, or at 1/2 - 1/(2 l) for growing numbers. All is rounded up by less than 2^-22, which adds
  /// up to far less than the 1/(2 l) between the values that occur.
  void trace(Triangles& t, const std::vector<Voxel>& voxels) const {
    constexpr int count = 3 * Triangles::capacity;
    std::array<std::array<int, count>, 3> from, to;
    for (int s = 0; s < 3; ++s)
      for (int i = 0; i < Triangles::capacity; ++i) {
        const Voxel &a = voxels[t.corner[s][i]], &b = voxels[t.corner[(s + 1) % 3][i]];
        const int line = s * Triangles::capacity + i;
        from[0][line] = a.x, from[1][line] = a.y, from[2][line] = a.z;
        to[0][line] = b.x, to[1][line] = b.y, to[2][line] = b.z;
      }

    std::array<int, count> length, row, row_step, u, u_step, v, v_step;
#pragma omp simd
    for (int i = 0; i < count; ++i) {
      const int dx = to[0][i] - from[0][i], dy = to[1][i] - from[1][i], dz = to[2][i] - from[2][i];
      const int ax = std::abs(dx), ay = std::abs(dy), az = std::abs(dz);
      const bool along_x = ax >= ay && ax >= az, along_y = !along_x && ay >= az;
      length[i] = std::max(std::max(ax, ay), std::max(az, 1));
      const int way = along_x ? dx : along_y ? dy : dz;
      row[i] = along_x   ? from[0][i] * row_size + grid_words
               : along_y ? from[1][i] * row_size + 2 * grid_words
                         : from[2][i] * row_size + 3 * grid_words;
      row_step[i] = way < 0 ? -row_size : row_size;
      constexpr float one = 1 << fraction_bits;
      constexpr int rounded_up = 8;
      const float inverse = 1 / static_cast<float>(length[i]);
      const int half = (1 << (fraction_bits - 1)) + rounded_up;
      const int less_than_half = half - static_cast<int>(0.5f * one * inverse);
      const int du = along_x ? dy : dx, dv = along_x || along_y ? dz : dy;
      u_step[i] = static_cast<int>(static_cast<float>(du) * inverse * one) + rounded_up;
      v_step[i] = static_cast<int>(static_cast<float>(dv) * inverse * one) + rounded_up;
      u[i] = static_cast<int>(static_cast<unsigned>(along_x ? from[1][i] : from[0][i]) << fraction_bits) +
             (du < 0 ? half : less_than_half);
      v[i] = static_cast<int>(static_cast<unsigned>(along_x || along_y ? from[2][i] : from[1][i]) << fraction_bits) +
             (dv < 0 ? half : less_than_half);
    }

    // Eight lines at a time, of nearly equal length.
    std::array<int, grid_size + 1> begin_of_length{};
    for (const int l : length) ++begin_of_length[l + 1];
    for (int l = 1; l <= grid_size; ++l) begin_of_length[l] += begin_of_length[l - 1];
    std::array<int, count> order;
    for (int i = 0; i < count; ++i) order[begin_of_length[length[i]]++] = i;
    constexpr int lanes = 8;
    for (int begin = 0; begin < count; begin += lanes) {
      const std::uint32_t* words = words_.data();
      std::array<int, lanes> at, at_step, steps, found;
      std::array<std::uint32_t, lanes> pu, pu_step, pv, pv_step;
      for (int lane = 0; lane < lanes; ++lane) {
        const int i = order[begin + lane];
        at[lane] = row[i], at_step[lane] = row_step[i], steps[lane] = length[i];
        pu[lane] = u[i], pu_step[lane] = u_step[i], pv[lane] = v[i], pv_step[lane] = v_step[i];
      }
      const int longest = steps[lanes - 1];
#ifdef __AVX2__
      const auto load = [](const auto& lane) {
        return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(lane.data()));
      };
      __m256i row_at = load(at), u_at = load(pu), v_at = load(pv), sum = _mm256_setzero_si256();
      const __m256i row_by = load(at_step), u_by = load(pu_step), v_by = load(pv_step), last = load(steps);
      const __m256i one = _mm256_set1_epi32(1), upper = _mm256_set1_epi32(64), bit = _mm256_set1_epi32(31);
      for (int k = 0; k < longest; ++k) {
        const __m256i index = _mm256_add_epi32(_mm256_add_epi32(row_at, _mm256_srli_epi32(u_at, fraction_bits)),
                                               _mm256_and_si256(_mm256_srli_epi32(v_at, 25), upper));
        const __m256i word = _mm256_i32gather_epi32(reinterpret_cast<const int*>(words), index, 4);
        const __m256i value = _mm256_srlv_epi32(word, _mm256_and_si256(_mm256_srli_epi32(v_at, fraction_bits), bit));
        const __m256i counts = _mm256_and_si256(_mm256_cmpgt_epi32(last, _mm256_set1_epi32(k)), one);
        sum = _mm256_add_epi32(sum, _mm256_and_si256(value, counts));
        row_at = _mm256_add_epi32(row_at, row_by);
        u_at = _mm256_add_epi32(u_at, u_by);
        v_at = _mm256_add_epi32(v_at, v_by);
      }
      _mm256_storeu_si256(reinterpret_cast<__m256i*>(found.data()), sum);
#else
      for (int lane = 0; lane < lanes; ++lane) {
        int row_at = at[lane], sum = 0;
        std::uint32_t u_at = pu[lane], v_at = pv[lane];
        for (int k = 0; k < steps[lane]; ++k) {
          const auto index = static_cast<unsigned>(row_at) + (u_at >> fraction_bits) + (v_at >> 25 & 64);
          sum += static_cast<int>(words[index] >> (v_at >> fraction_bits & 31) & 1);
          row_at += at_step[lane];
          u_at += pu_step[lane];
          v_at += pv_step[lane];
        }
        found[lane] = sum;
      }
#endif
      for (int lane = 0; lane < lanes; ++lane) {
        const int i = order[begin + lane];
        t.length[i / Triangles::capacity][i % Triangles::capacity] = steps[lane];
        t.filled[i / Triangles::capacity][i % Triangles::capacity] = found[lane];
      }
    }
  }

 private:
  static constexpr int fraction_bits = 26, row_size = 2 * grid_size, grid_words = grid_size * row_size;
  /// With room before and behind: a line that waits for longer ones in its group may run on, by less than a grid.
  std::vector<std::uint32_t> words_ = std::vector<std::uint32_t>(5 * grid_words);
};

/// PCL's limits. The ends of a side are inside by themselves: up to seven filled voxels still count as outside.
int place_of_side(int length, int filled) { return filled >= length - 1 ? inside : filled <= 7 ? outside : mixed; }

int place_of_triangle(int length, int filled) { return filled <= 21 ? outside : length - filled < 4 ? inside : mixed; }

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

/// The largest side and root of an area.
struct Extent {
  float side = 0, root_of_area = 0;
};

/// Lengths and areas are binned relative to the largest one drawn, which is a chance of the draw and shifts all bins.
/// So the mean of the largest ones of five draws stands for it: the draw that is binned, and four more, of which only
/// those triangles are made that have two corners or more among the outer half of the points: half of them, with the
/// largest ones among them.
Extent mean_extent(const Extent& of_the_draw, const ScaledPoints& shape, int samples, Random& random) {
  constexpr int draws = 4;
  const std::uint64_t count = shape.points.size();
  Extent sum = of_the_draw;
  for (int draw = 0; draw < draws; ++draw) {
    float longest_squared = 0, largest_area_squared = 0;
    for (int left = samples / 2 + 1; left > 0; left -= Triangles::capacity) {
      const int block = std::min(left, Triangles::capacity);
      std::array<Triangles::PerTriangle<float>, 6> sides;  // from the first corner to the two others
      for (int i = 0; i < block; ++i) {
        const std::uint64_t bits = random.next();
        constexpr std::uint64_t half = 1 << 20;  // of 2^21; of the points, which stand in the order of their radius
        const std::uint64_t third = (bits >> 1 & (half - 1)) + (bits >> 21 & 3 ? 0 : half);
        const auto& a = shape.points[(half + (bits >> 24 & (half - 1))) * count >> 21];
        const auto& b = shape.points[(half + (bits >> 44)) * count >> 21];
        const auto& c = shape.points[third * count >> 21];
        for (int axis = 0; axis < 3; ++axis) {
          sides[axis][i] = b[axis] - a[axis];
          sides[3 + axis][i] = c[axis] - a[axis];
        }
      }
#pragma omp simd reduction(max : longest_squared, largest_area_squared)
      for (int i = 0; i < block; ++i) {
        const float ux = sides[0][i], uy = sides[1][i], uz = sides[2][i];
        const float vx = sides[3][i], vy = sides[4][i], vz = sides[5][i];
        const float wx = vx - ux, wy = vy - uy, wz = vz - uz;
        const float nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
        const float longer = std::max(ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz);
        longest_squared = std::max(longest_squared, std::max(longer, wx * wx + wy * wy + wz * wz));
        largest_area_squared = std::max(largest_area_squared, 0.25f * (nx * nx + ny * ny + nz * nz));
      }
    }
    sum.side += std::sqrt(longest_squared);
    sum.root_of_area += std::sqrt(std::sqrt(largest_area_squared));
  }
  return {sum.side / (draws + 1), sum.root_of_area / (draws + 1)};
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
  std::array<std::array<std::uint32_t, esf_part_bins>, parts> bins{};
  struct Measured {
    std::vector<float> values;
    std::vector<std::uint8_t> places;
    explicit Measured(std::size_t count) : values(count), places(count) {}
  };
  const auto samples = static_cast<std::size_t>(options.samples);
  Measured lengths(3 * samples), areas(samples);
  std::size_t drawn = 0;
  Random random(static_cast<std::uint64_t>(options.seed));
  Triangles t;
  constexpr int most_tries = 20;  // a share of triangles below 1 in 20: points on a line, nearly
  const std::int64_t blocks = (std::int64_t{options.samples} * most_tries) / Triangles::capacity + 1;
  for (std::int64_t block = 0; block < blocks && drawn < samples; ++block) {
    for (int i = 0; i < Triangles::capacity; ++i) {
      const std::uint64_t first = random.next(), second = random.next();
      t.corner[0][i] = static_cast<std::uint32_t>((first >> 32) * count >> 32);
      t.corner[1][i] = static_cast<std::uint32_t>((first & 0xFFFFFFFF) * count >> 32);
      t.corner[2][i] = static_cast<std::uint32_t>((second >> 32) * count >> 32);
    }
    measure(shape.points, t);
    grid.trace(t, shape.voxels);
    for (int i = 0; i < Triangles::capacity && drawn < samples; ++i) {
      constexpr float smallest_area_squared = 0.001f;  // PCL's; voxels to the fourth power
      if (!(t.area_squared[i] > smallest_area_squared)) continue;
      const int place = place_of_triangle(t.length[0][i] + t.length[1][i] + t.length[2][i],
                                          t.filled[0][i] + t.filled[1][i] + t.filled[2][i]);
      for (int s = 0; s < 3; ++s) {
        const int length = t.length[s][i], filled = t.filled[s][i];
        const int place_of_this = place_of_side(length, filled);
        lengths.values[3 * drawn + s] = t.side[s][i];
        lengths.places[3 * drawn + s] = static_cast<std::uint8_t>(place_of_this);
        bins[d2_ratio][bin_of(static_cast<float>(filled) / static_cast<float>(length))] +=
            place_of_this == mixed ? 1 : 0;
        bins[int{a3_in} + place][bin_of(t.angle_share[s][i])] += static_cast<std::uint32_t>(length);
      }
      areas.values[drawn] = std::sqrt(std::sqrt(t.area_squared[i]));
      areas.places[drawn] = static_cast<std::uint8_t>(place);
      ++drawn;
    }
  }
  if (drawn == 0) return histogram;
  const auto largest_of = [](const Measured& measured, std::size_t n) {
    float largest = 0;
#pragma omp simd reduction(max : largest)
    for (std::size_t i = 0; i < n; ++i) largest = std::max(largest, measured.values[i]);
    return largest;
  };
  const Extent of_the_draw{largest_of(lengths, 3 * drawn), largest_of(areas, drawn)};
  const Extent extent = options.steady_extent ? mean_extent(of_the_draw, shape, options.samples, random) : of_the_draw;
  const auto add = [&](const Measured& measured, std::size_t n, float largest, Part first_part) {
    const float scale = 1 / largest;
    for (std::size_t i = 0; i < n; ++i)
      ++bins[int{first_part} + measured.places[i]][bin_of(std::min(measured.values[i] * scale, 1.0f))];
  };
  add(areas, drawn, extent.root_of_area, d3_in);
  add(lengths, 3 * drawn, extent.side, d2_in);

  double sum = 0;
  for (int part = 0; part < parts; ++part)
    for (const auto bin : bins[part]) sum += static_cast<double>(bin) * part_weight[part];
  for (int part = 0; part < parts; ++part)
    for (int bin = 0; bin < esf_part_bins; ++bin)
      histogram[part * esf_part_bins + bin] =
          static_cast<float>(static_cast<double>(bins[part][bin]) * part_weight[part] / sum);
  return histogram;
}

}  // namespace partpose
