// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/report/report.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/parallel.hpp"
#include "partpose/io/camera_json.hpp"
#include "partpose/io/file.hpp"
#include "partpose/io/ply.hpp"
#include "partpose/io/png.hpp"
#include "partpose/io/stl.hpp"
#include "partpose/preprocess/preprocess.hpp"
#include "partpose/preprocess/segmentation.hpp"
#include "partpose/report/output_folder.hpp"
#include "partpose/report/packet.hpp"
#include "partpose/report/page.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>
#include <set>

namespace partpose {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_mesh_triangles = 12'000;  // that the page draws quickly
constexpr double depth_unit_mm = 0.25;

double rounded(double value, double steps_per_unit) { return std::round(value * steps_per_unit) / steps_per_unit; }

/// Rotation row by row and translation: r00 r01 r02 tx r10 ...
Json rows_of(const Eigen::Isometry3d& pose) {
  Json rows = Json::array();
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) rows.push_back(rounded(pose.matrix()(r, c), c < 3 ? 1e6 : 1e3));
  return rows;
}

template <typename T>
void set_if(Json& object, const char* key, const std::optional<T>& value) {
  if (!value) return;
  if constexpr (std::is_floating_point_v<T>)
    object[key] = rounded(*value, 1e4);
  else
    object[key] = *value;
}

/// Texts or files that several frames share, each kept once.
class Shared {
 public:
  int index_of(const std::string& key) {
    const auto [it, is_new] = index_.try_emplace(key, static_cast<int>(keys_.size()));
    if (is_new) keys_.push_back(key);
    return it->second;
  }
  const std::vector<std::string>& keys() const { return keys_; }

 private:
  std::map<std::string, int> index_;
  std::vector<std::string> keys_;
};

/// How much of a frame is shown.
struct Detail {
  std::size_t points = 1'000'000'000;  ///< of each cloud; by itself all there are
  std::size_t pixels = 1'000'000'000;

  Detail coarser() const {
    return {std::max<std::size_t>(points * 7 / 10, 200), std::max<std::size_t>(pixels * 7 / 10, 1000)};
  }
  bool coarsest() const { return points <= 200 && pixels <= 1000; }
};

/// What a frame measured, as it was saved.
struct Measured {
  PointCloud input, preprocessed_only, with_normals, result;
  std::vector<PointCloud> candidates;  ///< of those without a mesh
  DepthImage depth;
  Intrinsics camera;
  bool depth_of_cloud = false;
};

bool is_less(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
}

/// The points of `all` that are not in `kept`.
PointCloud without(const PointCloud& all, const PointCloud& kept) {
  std::vector<Eigen::Vector3f> sorted = kept.points;
  std::sort(sorted.begin(), sorted.end(), is_less);
  PointCloud out;
  for (const auto& p : all.points)
    if (!std::binary_search(sorted.begin(), sorted.end(), p, is_less)) out.points.push_back(p);
  return out;
}

class ReportWriter {
 public:
  ReportWriter(OutputFolder saved, const ReportOptions& options, const Progress& progress)
      : saved_(std::move(saved)), options_(options), progress_(progress) {}

  std::string page() {
    const auto& frames = saved_.frames;
    for (const auto& frame : frames) share(frame);
    std::string data;
    const auto add_block = [&](const std::string& id, std::string_view bytes) {
      data += fmt::format("<script type=\"text/plain\" id=\"{}\">", id) + std::string(bytes) + "</script>\n";
    };
    Json mesh_list = Json::array();
    for (std::size_t i = 0; i < meshes_.keys().size(); ++i) {
      mesh_list.push_back(Json::object());
      add_block(fmt::format("mesh{}", i), packed_mesh(meshes_.keys()[i], mesh_list.back()));
    }
    const std::size_t fixed = report_page().size() + data.size() + 700 * frames.size() + 100'000;
    const std::size_t left = options_.most_bytes > fixed ? options_.most_bytes - fixed : 0;
    // All there is; where that is too much each frame gets an equal share.
    std::vector<std::string> packed = packed_frames(std::numeric_limits<std::size_t>::max(), left);
    if (packed.empty()) packed = packed_frames(left / frames.size(), std::numeric_limits<std::size_t>::max());
    for (std::size_t i = 0; i < packed.size(); ++i) add_block(fmt::format("frame{}", i), packed[i]);
    Json index = index_of_frames();
    index["meshes"] = std::move(mesh_list);
    add_block("index", base64(deflated(json_line(index))));

    std::string out(report_page());
    const std::size_t at = out.find(report_data_mark);
    if (at == std::string::npos) throw Error("the report's page was built without a place for the data");
    out.replace(at, report_data_mark.size(), data);
    return out;
  }

  ReportSummary summary() const { return {static_cast<int>(saved_.frames.size()), 0, thinned_, saved_.problems}; }

 private:
  void problem(const std::string& words) {
    const std::scoped_lock lock(mutex_);
    auto& all = saved_.problems;
    if (std::find(all.begin(), all.end(), words) == all.end()) all.push_back(words);
  }

  /// Each frame in `most_for_one` bytes; empty as soon as they need more than `most` together.
  std::vector<std::string> packed_frames(std::size_t most_for_one, std::size_t most) {
    const auto& frames = saved_.frames;
    std::vector<std::string> packed(frames.size());
    std::size_t done = 0;
    std::atomic<std::size_t> bytes = 0;
    parallel_for(frames.size(), [&](std::size_t i) {
      if (bytes > most) return;
      packed[i] = packed_frame(frames[i], most_for_one);
      bytes += packed[i].size();
      const std::scoped_lock lock(mutex_);
      if (progress_) progress_("packing frames", ++done, frames.size());
    });
    return bytes > most ? std::vector<std::string>{} : packed;
  }

  /// Reads a file that a frame has; nothing when there is none, or it is broken.
  template <typename Read>
  auto read_if(const fs::path& path, const Read& read) -> decltype(read(path)) {
    if (path.empty()) return {};
    try {
      return read(path);
    } catch (const Error& error) {
      problem(error.what());
      return {};
    }
  }

  void share(const SavedFrame& frame) {
    const auto share_mesh = [this](const auto& of) {
      if (!of.mesh.empty()) mesh_of_part_[of.model_name] = meshes_.index_of(of.mesh.string());
    };
    for (const auto& candidate : frame.candidates) share_mesh(candidate);
    for (const auto& detection : frame.detections) share_mesh(detection);
    if (!frame.config.empty())
      config_of_[frame.config.string()] =
          configs_.index_of(read_if(frame.config, [](const fs::path& path) { return read_file(path); }));
  }

  std::string packed_mesh(const fs::path& path, Json& about) {
    const TriangleMesh mesh = read_if(path, [](const fs::path& p) { return read_stl(p); });
    const TriangleMesh shown = simplified(mesh, most_mesh_triangles);
    about = {{"file", path.filename().string()},
             {"triangles", shown.triangles.size()},
             {"of", mesh.triangles.size()},
             {"diagonal_mm", mesh.vertices.empty() ? 0.0 : rounded(bounding_box_diagonal(mesh), 10)}};
    Packet packet;
    packet.header["mesh"] = packet.add(shown);
    return base64(deflated(packet.bytes()));
  }

  Measured measure(const SavedFrame& frame) {
    const auto cloud = [this](const fs::path& path) {
      return read_if(path, [](const fs::path& p) { return without_missing(read_ply(p)); });
    };
    Measured m;
    m.input = cloud(frame.input);
    for (auto& p : m.input.points) p *= static_cast<float>(frame.input_unit_mm);
    m.with_normals = cloud(frame.with_normals);  // every stage but the first shows them
    m.preprocessed_only = without(cloud(frame.preprocessed), m.with_normals);
    if (frame.candidates.empty() || frame.candidates[0].mesh.empty()) m.result = cloud(frame.result_cloud);
    for (const auto& candidate : frame.candidates)
      m.candidates.push_back(candidate.mesh.empty() ? cloud(candidate.cloud) : PointCloud{});
    if (!frame.depth.empty() && !frame.depth_camera.empty()) {
      const auto camera = read_if(frame.depth_camera, [](const fs::path& p) { return read_camera(p); });
      if (camera.intrinsics.width > 0)
        m.depth = read_if(frame.depth, [&](const fs::path& p) { return read_depth_png(p, camera.depth_scale_mm); });
      if (m.depth.width == camera.intrinsics.width && m.depth.height == camera.intrinsics.height)
        m.camera = camera.intrinsics;
      else
        m.depth = {};
    }
    if (m.depth.z_mm.empty()) {
      const PointCloud seen = before_camera(m.input.empty() ? m.with_normals : m.input);
      if (const auto camera = intrinsics_of(seen, 10)) {
        m.camera = *camera;
        m.depth = to_depth_image(seen, *camera);
        m.depth_of_cloud = true;
      }
    }
    return m;
  }

  std::string packed_frame(const SavedFrame& frame, std::size_t most_bytes) {
    const Measured measured = measure(frame);
    const auto cost = [&](const Detail& d) {  // in letters of base64, from what is typical
      const double points = std::min(measured.with_normals.size(), d.points) * 5.0 +
                            std::min(measured.preprocessed_only.size(), d.points) * 4.0 +
                            (measured.depth_of_cloud ? std::min(measured.input.size(), d.points) * 4.0 : 0.0);
      return 4.0 / 3.0 * (points + 1.2 * std::min(measured.depth.z_mm.size(), d.pixels) + 3000);
    };
    Detail detail;
    while (!detail.coarsest() && cost(detail) > 1.4 * static_cast<double>(most_bytes)) detail = detail.coarser();
    while (true) {
      bool thinned = false;
      std::string packed = base64(deflated(packet_of(frame, measured, detail, thinned).bytes()));
      if (packed.size() <= most_bytes || detail.coarsest()) {
        const std::scoped_lock lock(mutex_);
        thinned_ = thinned_ || thinned;
        return packed;
      }
      detail = detail.coarser();
    }
  }

  Packet packet_of(const SavedFrame& frame, const Measured& measured, const Detail& detail, bool& thinned) const {
    Packet packet;
    Json& h = packet.header;
    const ReportStages& stages = options_.stages;
    const auto add_cloud = [&](const char* key, const PointCloud& cloud, std::size_t most) {
      if (cloud.empty()) return;
      h["clouds"][key] = packet.add(cloud, most);
      thinned = thinned || cloud.size() > most;
    };
    h["clouds"] = Json::object();
    // The points of a depth image are made from it, on the page.
    if (stages.input && measured.depth_of_cloud) add_cloud("input", measured.input, detail.points);
    if (stages.preprocessed) add_cloud("preprocessed_only", measured.preprocessed_only, detail.points);
    add_cloud("with_normals", measured.with_normals, detail.points);
    add_cloud("result", measured.result, detail.points / 10);
    add_depth(packet, measured, detail, thinned);

    h["candidates"] = Json::array();
    const bool all = stages.candidates || stages.coarse || stages.fine;
    for (std::size_t i = 0; i < frame.candidates.size(); ++i) {
      const auto& c = frame.candidates[i];
      if (!all && !(frame.candidate_id && c.id == *frame.candidate_id)) continue;
      Json json{
          {"id", c.id}, {"model_name", c.model_name}, {"view_id", c.view_id}, {"verdict", c.verdict}, {"place", i + 1}};
      if (stages.coarse) json["coarse"] = rows_of(c.coarse);
      json["fine"] = rows_of(c.camera_from_model);
      set_if(json, "score", c.score);
      set_if(json, "icp_fitness", c.icp_fitness);
      set_if(json, "icp_converged", c.icp_converged);
      set_if(json, "match_distance", c.match_distance);
      set_if(json, "points", c.points);
      set_if(json, "points_refinement", c.points_refinement);
      set_if(json, "visible_model_points", c.visible_model_points);
      set_if(json, "unexplained_model_points", c.unexplained_model_points);
      set_if(json, "scene_points", c.scene_points);
      set_if(json, "explained_scene_points", c.explained_scene_points);
      if (!c.mesh.empty()) json["mesh"] = mesh_of_part_.at(c.model_name);
      if (!measured.candidates[i].empty()) json["cloud"] = packet.add(measured.candidates[i], detail.points / 40 + 100);
      h["candidates"].push_back(std::move(json));
    }
    h["candidates_of"] = frame.candidates.size();
    h["accepted"] = -1;
    for (std::size_t i = 0; i < h["candidates"].size(); ++i)
      if (frame.candidate_id && *frame.candidate_id >= 0 && h["candidates"][i]["id"] == *frame.candidate_id)
        h["accepted"] = i;
    h["detections"] = Json::array();
    for (const auto& d : frame.detections) {
      Json json{{"model_name", d.model_name}, {"pose", rows_of(d.camera_from_model)}};
      set_if(json, "score", d.score);
      set_if(json, "confidence", d.confidence);
      if (!d.mesh.empty()) json["mesh"] = mesh_of_part_.at(d.model_name);
      h["detections"].push_back(std::move(json));
    }
    if (frame.camera_from_model) h["result_pose"] = rows_of(*frame.camera_from_model);
    if (const auto it = mesh_of_part_.find(frame.model_name); it != mesh_of_part_.end()) h["result_mesh"] = it->second;
    if (frame.truth && frame.truth->camera_from_model) {
      h["truth_pose"] = rows_of(*frame.truth->camera_from_model);
      if (const auto it = mesh_of_part_.find(frame.truth->model_name); it != mesh_of_part_.end())
        h["truth_mesh"] = it->second;
    }
    h["steps"] = Json::array();
    for (const auto& step : frame.steps) {
      Json json{{"tag", step.tag}, {"ms", rounded(step.ms, 1e3)}};
      set_if(json, "points_in", step.points_in);
      set_if(json, "points_out", step.points_out);
      h["steps"].push_back(std::move(json));
    }
    if (!frame.config.empty()) h["config"] = config_of_.at(frame.config.string());
    h["scene"] = frame.scene;
    h["folder"] = frame.folder.empty() ? "" : fs::relative(frame.folder, fs::weakly_canonical(saved_.folder)).string();
    h["has_extras"] = frame.has_extras;
    return packet;
  }

  static void add_depth(Packet& packet, const Measured& measured, const Detail& detail, bool& thinned) {
    if (measured.depth.z_mm.empty()) return;
    int u = 0, v = 0, width = measured.depth.width, height = measured.depth.height;
    const PointCloud seen = before_camera(measured.with_normals);
    if (measured.depth.z_mm.size() > 4 * detail.pixels && !seen.empty()) {
      // Around the object, as half of a frame would be coarser than that is worth.
      Eigen::AlignedBox2d box;
      for (const auto& p : seen.points) box.extend(measured.camera.project(p.cast<double>()));
      const Eigen::Vector2d margin = Eigen::Vector2d::Constant(10 + 0.35 * box.sizes().maxCoeff());
      const Eigen::Vector2i first = (box.min() - margin).cast<int>(), last = (box.max() + margin).cast<int>();
      u = std::clamp(first.x(), 0, width - 1);
      v = std::clamp(first.y(), 0, height - 1);
      width = std::clamp(last.x() - u + 1, 1, width - u);
      height = std::clamp(last.y() - v + 1, 1, height - v);
    }
    int factor = 1;
    while (static_cast<std::size_t>(width / factor) * (height / factor) > detail.pixels) ++factor;
    const ReducedDepth shown = reduced(measured.depth, measured.camera, u, v, width, height, factor);
    const float farthest_mm = *std::max_element(shown.depth.z_mm.begin(), shown.depth.z_mm.end());
    Json json = packet.add(shown.depth, std::max(depth_unit_mm, farthest_mm / 65000.0));
    json["camera"] = {shown.camera.fx, shown.camera.fy, shown.camera.cx, shown.camera.cy};
    json["factor"] = factor;
    json["crop"] = {u, v, width, height};
    json["of_width"] = measured.depth.width;
    json["of_height"] = measured.depth.height;
    json["of_cloud"] = measured.depth_of_cloud;
    packet.header["depth"] = std::move(json);
    thinned = thinned || factor > 1 || width < measured.depth.width || height < measured.depth.height;
  }

  Json index_of_frames() const {
    Json index;
    const fs::path canonical = fs::weakly_canonical(saved_.folder);
    index["title"] = options_.title.empty() ? canonical.filename().string() : options_.title;
    index["limit_deg"] = options_.limit_deg;
    index["limit_mm"] = options_.limit_mm;
    index["thinned"] = thinned_;
    index["experiment"] = saved_.experiment;
    const ReportStages& s = options_.stages;
    index["stages"] = {
        {"input", s.input}, {"preprocessed", s.preprocessed}, {"normals", s.normals},      {"coarse", s.coarse},
        {"fine", s.fine},   {"verdict", s.verdict},           {"candidates", s.candidates}};
    index["configs"] = configs_.keys();
    std::vector<std::string> problems = saved_.problems;  // noted by several threads
    std::sort(problems.begin(), problems.end());
    index["problems"] = problems;
    Shared steps;
    for (const auto& frame : saved_.frames)
      for (const auto& step : frame.steps) steps.index_of(step.tag);
    index["steps"] = steps.keys();
    index["frames"] = Json::array();
    for (const auto& frame : saved_.frames) {
      Json json{{"name", frame.name}, {"verdict", name_of(frame.verdict)}, {"result", frame.model_name}};
      for (const auto& [key, value] : {std::pair{"run", &frame.run},
                                       {"protocol", &frame.protocol},
                                       {"descriptor", &frame.descriptor},
                                       {"reason", &frame.reason}})
        if (!value->empty()) json[key] = *value;
      if (frame.truth)
        json["truth"] =
            frame.truth->left_out ? fmt::format("{} (left out)", frame.truth->model_name) : frame.truth->model_name;
      if (frame.truth && frame.truth->left_out) json["left_out"] = true;
      set_if(json, "best_score", frame.best_score);
      set_if(json, "best_is_right", frame.best_is_right);
      set_if(json, "time_ms", frame.time_ms);
      if (!frame.figures.empty()) {
        json["figures"] = Json::object();
        for (const auto& [key, value] : frame.figures) json["figures"][key] = rounded(value, 1e4);
      }
      if (!frame.flags.empty()) json["flags"] = frame.flags;
      if (!frame.steps.empty()) {
        json["steps"] = Json::array();
        for (const auto& tag : steps.keys()) {
          const auto it =
              std::find_if(frame.steps.begin(), frame.steps.end(), [&](const auto& st) { return st.tag == tag; });
          json["steps"].push_back(it == frame.steps.end() ? Json() : Json(rounded(it->ms, 1e2)));
        }
      }
      index["frames"].push_back(std::move(json));
    }
    return index;
  }

  OutputFolder saved_;
  const ReportOptions& options_;
  const Progress& progress_;
  Shared meshes_, configs_;
  std::map<std::string, int> mesh_of_part_;
  std::map<std::string, int> config_of_;
  bool thinned_ = false;
  std::mutex mutex_;
};

}  // namespace

ReportStages stages_of(const VisualizeOptions& visualize) {
  return {visualize.preprocess,
          visualize.preprocess,
          visualize.normal_estimation,
          visualize.coarse_alignment,
          visualize.pose_refinement,
          visualize.result || visualize.result_with_candidates,
          visualize.result_with_candidates};
}

void ReportOptions::check() const {
  if (!(limit_deg >= 0)) throw Error("limit_deg {}: must be 0 or more", limit_deg);
  if (!(limit_mm >= 0)) throw Error("limit_mm {}: must be 0 or more", limit_mm);
}

ReportSummary write_report(const fs::path& folder, const fs::path& file, const ReportOptions& options,
                           const Progress& progress) {
  options.check();
  ReportWriter writer(read_output_folder(folder, progress), options, progress);
  const std::string page = writer.page();
  write_file_atomically(file, page);
  ReportSummary summary = writer.summary();
  summary.bytes = page.size();
  return summary;
}

}  // namespace partpose
