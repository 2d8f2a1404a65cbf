// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "described.hpp"
#include "rooms.hpp"

#include "partpose/io/camera_json.hpp"
#include "partpose/io/cloud.hpp"
#include "partpose/io/mesh_files.hpp"
#include "partpose/io/model_files.hpp"
#include "partpose/io/off.hpp"
#include "partpose/io/pcd.hpp"
#include "partpose/io/ply.hpp"
#include "partpose/io/png.hpp"
#include "partpose/io/scene.hpp"
#include "partpose/io/stl.hpp"

namespace partpose::python {

namespace {

using Pixels = nb::ndarray<nb::numpy, std::uint8_t, nb::shape<-1, -1, 3>>;

}  // namespace

void bind_io(nb::module_& parent) {
  auto m = room(parent, "io", "STL, PCD, PLY, 16-bit depth PNG and camera files. Lengths in mm.");
  const auto released = nb::call_guard<nb::gil_scoped_release>();

  m.def("read_stl", &read_stl, "path"_a, released, "A binary or ASCII STL file in mm, equal vertices merged.");
  m.def(
      "parse_stl",
      [](nb::bytes content, const std::string& name) {
        return parse_stl(std::string_view(content.c_str(), content.size()), name);
      },
      "content"_a, "name"_a, "The same from the content of a file; `name` is what errors call it.");
  m.def("write_stl", &write_stl, "path"_a, "mesh"_a, released, "Binary, in mm.");
  m.def("read_ply_mesh", &read_ply_mesh, "path"_a, released, "The mesh of a PLY file in mm.");
  m.def("write_ply_mesh", &write_ply_mesh, "path"_a, "mesh"_a, released, "ASCII PLY in mm with vertex normals.");
  m.def("read_ply", &read_ply, "path"_a, released, "The vertices of a PLY file in mm.");
  m.def(
      "write_ply", [](const std::filesystem::path& path, const PointCloud& cloud) { write_ply(path, cloud); }, "path"_a,
      "cloud"_a, released, "Binary PLY in mm.");
  m.def("read_pcd", &read_pcd, "path"_a, released, "A PCD file in mm.");
  nb::enum_<PcdEncoding>(m, "PcdEncoding", "How a PCD file stores its points.")
      .value("ascii", PcdEncoding::ascii)
      .value("binary", PcdEncoding::binary)
      .value("binary_compressed", PcdEncoding::binary_compressed);
  m.def("write_pcd", &write_pcd, "path"_a, "cloud"_a, "encoding"_a = PcdEncoding::binary_compressed, released,
        "PCD 0.7 in mm.");
  m.def("read_cloud", &read_cloud, "path"_a, released, "A point cloud file in mm, by its extension.");
  m.def("read_off", &read_off, "path"_a, released, "The mesh of an OFF file in mm.");
  m.def("content_hash", &content_hash, "mesh"_a, "Tells whether a mesh changed.");

  bind_described<MeshReadOptions>(m, "MeshReadOptions", "How CAD files are made triangles, and what a part is.");
  nb::class_<NamedMesh> named(m, "NamedMesh", "A part: its mesh in mm, in the file's own frame.");
  named
      .def(
          "__init__",
          [](NamedMesh* self, std::string name, const TriangleMesh& mesh, const std::filesystem::path& file,
             std::string unit) {
            new (self) NamedMesh{std::move(name), mesh, file, std::move(unit)};
          },
          "name"_a, "mesh"_a, "file"_a = std::filesystem::path(), "unit"_a = "")
      .def_ro("name", &NamedMesh::name, "The file's without its ending; of several parts in a file, the part's own.")
      .def_prop_ro(
          "mesh", [](const NamedMesh& self) { return &self.mesh; }, nb::rv_policy::reference_internal, "In mm.")
      .def_ro("file", &NamedMesh::file, "Where it was read.")
      .def_ro("unit", &NamedMesh::unit, "As the file states it; empty when it does not.");
  bind_repr(named, {"name", "mesh", "file", "unit"});
  m.def(
      "read_meshes",
      [](const std::vector<std::filesystem::path>& paths, const MeshReadOptions& options,
         const std::optional<nb::callable>& broken) {
        options.check();
        BrokenMeshFile told;
        if (broken)
          told = [&](const std::filesystem::path& file, const std::string& message) {
            nb::gil_scoped_acquire gil;
            (*broken)(file, message);
          };
        nb::gil_scoped_release release;
        return read_meshes(paths, options, told);
      },
      "paths"_a, "options"_a = MeshReadOptions{}, "broken"_a = nb::none(),
      nb::sig("def read_meshes(paths: collections.abc.Sequence[str | os.PathLike], options: MeshReadOptions = ..., "
              "broken: collections.abc.Callable[[pathlib.Path, str], object] | None = None) -> list[NamedMesh]"),
      "The parts of files or folders. With `broken`, files that cannot be read are told there and left out.");
  m.def("read_mesh_file", &read_mesh_file, "file"_a, "options"_a = MeshReadOptions{}, released,
        "The parts of one file, of any of mesh_file_endings().");
  m.def("mesh_file_endings", &mesh_file_endings, "The endings of the files that read_meshes knows.");
  m.def("reads_step", &reads_step, "Whether this build reads STEP (by OpenCASCADE).");
  m.def("reads_assimp_formats", &reads_assimp_formats, "Whether this build reads OBJ, 3MF and glTF (by Assimp).");
  m.def("model_files", &model_files, "file_or_folder"_a, "The file itself, or a folder's model files by name.");

  m.def("read_depth_png", &read_depth_png, "path"_a, "depth_scale_mm"_a, released, "A 16-bit greyscale PNG.");
  m.def("is_picture_png", &is_picture_png, "path"_a,
        "Whether a file is a PNG of another kind than depth images: 8-bit or in colours. By its header alone.");
  m.def("write_depth_png", &write_depth_png, "path"_a, "depth"_a, "depth_scale_mm"_a, released,
        "Depth rounded to the nearest unit of depth_scale_mm mm.");
  m.def(
      "read_png",
      [](const std::filesystem::path& path) {
        auto* image = new ColourImage(read_png(path));
        const nb::capsule owner(image, [](void* p) noexcept { delete static_cast<ColourImage*>(p); });
        return Pixels(image->pixels.data()->data(), {std::size_t(image->height), std::size_t(image->width), 3}, owner);
      },
      "path"_a, "An 8-bit PNG as height x width x 3.");
  m.def(
      "write_png",
      [](const std::filesystem::path& path,
         nb::ndarray<const std::uint8_t, nb::shape<-1, -1, 3>, nb::c_contig, nb::device::cpu> pixels) {
        ColourImage image{static_cast<int>(pixels.shape(1)), static_cast<int>(pixels.shape(0)), {}};
        image.pixels.resize(pixels.shape(0) * pixels.shape(1));
        if (!image.pixels.empty()) std::memcpy(image.pixels.data(), pixels.data(), pixels.nbytes());
        write_png(path, image);
      },
      "path"_a, "pixels"_a, "Height x width x 3, 8-bit RGB.");

  bind_described<CameraFile>(m, "CameraFile", "What a camera JSON says.")
      .def_prop_ro(
          "intrinsics", [](const CameraFile& self) { return self.intrinsics; }, "Without the scale.");
  m.def("read_camera", &read_camera, "path"_a, "A camera JSON.");
  m.def("write_camera", &write_camera, "path"_a, "camera"_a, "A camera JSON.");
  m.def("camera_file_of", &camera_file_of, "depth_image"_a,
        "The camera of NAME.png: NAME.camera.json beside it, or else camera.json in its folder.");

  nb::class_<Scene> scene(m, "Scene", "What a camera measured: a depth image with its camera, or a cloud.");
  scene
      .def(
          "__init__",
          [](Scene* self, const PointCloud& cloud) {
            new (self) Scene{{}, cloud, std::nullopt, std::nullopt};
          },
          "cloud"_a)
      .def(
          "__init__",
          [](Scene* self, const DepthImage& depth, const Intrinsics& camera) {
            if (depth.width != camera.width || depth.height != camera.height)
              throw Error("depth image of {} x {} px with a camera of {} x {} px", depth.width, depth.height,
                          camera.width, camera.height);
            new (self) Scene{{}, to_point_cloud(depth, camera), depth, camera};
          },
          "depth"_a, "intrinsics"_a)
      .def_ro("path", &Scene::path, "The file it was read from; empty for data in memory.")
      .def_ro("cloud", &Scene::cloud, "The points; of a depth image, those of its pixels.")
      .def_prop_ro(
          "depth", [](const Scene& self) { return self.depth ? &*self.depth : nullptr; },
          nb::sig("def depth(self) -> partpose.core.DepthImage | None"), nb::rv_policy::reference_internal,
          "None for a cloud.")
      .def_ro("intrinsics", &Scene::intrinsics, "Of a depth image; None otherwise.");
  bind_repr(scene, {"path", "cloud", "depth", "intrinsics"});
  m.def(
      "read_scene",
      [](const std::filesystem::path& path, double unit_mm, const std::optional<std::filesystem::path>& camera_file) {
        return read_scene(path, unit_mm, camera_file.value_or(std::filesystem::path()));
      },
      "path"_a, "unit_mm"_a = 1.0, "camera_file"_a = nb::none(), released,
      "A 16-bit depth PNG with its camera JSON, or a PCD or PLY cloud.");
}

}  // namespace partpose::python
