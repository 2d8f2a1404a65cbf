// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "described.hpp"
#include "rooms.hpp"

#include "partpose/core/mesh.hpp"
#include "partpose/core/parallel.hpp"
#include "partpose/core/point_cloud.hpp"
#include "partpose/geometry/convex_hull.hpp"
#include "partpose/geometry/distance_grid.hpp"
#include "partpose/geometry/icosphere.hpp"
#include "partpose/geometry/kd_tree.hpp"
#include "partpose/geometry/mesh_inspection.hpp"
#include "partpose/geometry/normals.hpp"
#include "partpose/geometry/plane.hpp"
#include "partpose/geometry/surface_distance.hpp"
#include "partpose/geometry/symmetries.hpp"
#include "partpose/geometry/symmetry_search.hpp"
#include "partpose/geometry/voxel_grid.hpp"

#include <memory>

namespace partpose::python {

std::string what_array_it_is(const AnyArray& array) {
  const auto type = array.dtype();
  const char* kind = "numbers";
  switch (static_cast<nb::dlpack::dtype_code>(type.code)) {
    case nb::dlpack::dtype_code::Int:
      kind = "int";
      break;
    case nb::dlpack::dtype_code::UInt:
      kind = "uint";
      break;
    case nb::dlpack::dtype_code::Float:
      kind = "float";
      break;
    case nb::dlpack::dtype_code::Complex:
      kind = "complex";
      break;
    case nb::dlpack::dtype_code::Bool:
      kind = "bool";
      break;
    default:
      break;
  }
  std::string shape;
  for (std::size_t i = 0; i < array.ndim(); ++i) shape += (i ? ", " : "") + std::to_string(array.shape(i));
  return fmt::format("{}{} of shape ({})", kind, static_cast<int>(type.bits), shape);
}

namespace {

bool is_contiguous(const AnyArray& array) {
  std::int64_t expected = 1;
  for (std::size_t i = array.ndim(); i-- > 0;) {
    if (array.shape(i) > 1 && array.stride(i) != expected) return false;
    expected *= static_cast<std::int64_t>(array.shape(i));
  }
  return true;
}

/// Calls visit(row, column, value) for all elements of a matrix (a vector: one column) of any layout.
template <typename Scalar, typename Visit>
void for_each(const AnyArray& array, const Visit& visit) {
  const auto* data = static_cast<const Scalar*>(array.data());
  const std::size_t columns = array.ndim() > 1 ? array.shape(1) : 1;
  const std::int64_t column_stride = array.ndim() > 1 ? array.stride(1) : 0;
  for (std::size_t r = 0; r < array.shape(0); ++r)
    for (std::size_t c = 0; c < columns; ++c)
      visit(r, c, data[static_cast<std::int64_t>(r) * array.stride(0) + static_cast<std::int64_t>(c) * column_stride]);
}

PointCloud make_cloud(const Points& points, const std::optional<Points>& normals,
                      const std::optional<Floats>& curvatures, int width, int height) {
  PointCloud cloud;
  cloud.points = points.copy();
  if (normals) cloud.normals = normals->copy();
  if (curvatures) cloud.curvatures.assign(curvatures->span().begin(), curvatures->span().end());
  if (normals && cloud.normals.size() != cloud.size())
    throw Error("normals: {} are given for {} points", cloud.normals.size(), cloud.size());
  if (curvatures && cloud.curvatures.size() != cloud.size())
    throw Error("curvatures: {} are given for {} points", cloud.curvatures.size(), cloud.size());
  if (width < 0 || height < 0 || (height > 1 && static_cast<std::size_t>(width) * height != cloud.size()))
    throw Error("width x height: {} x {} is not the number of points, {}", width, height, cloud.size());
  cloud.width = height ? width : static_cast<int>(cloud.size());
  cloud.height = height ? height : 1;
  return cloud;
}

TriangleMesh make_mesh(const Points& vertices, const AnyArray& triangles) {
  TriangleMesh mesh;
  mesh.vertices = vertices.copy();
  if (triangles.ndim() != 2 || triangles.shape(1) != 3)
    throw Error("triangles: an M x 3 array of whole numbers is expected, got {}", what_array_it_is(triangles));
  mesh.triangles.resize(triangles.shape(0));
  const auto set = [&](std::size_t row, std::size_t column, auto index) {
    if (index < 0 || static_cast<std::uint64_t>(index) >= mesh.vertices.size())
      throw Error("triangles[{}, {}]: there is no vertex {}, there are {}", row, column, index, mesh.vertices.size());
    mesh.triangles[row][column] = static_cast<int>(index);
  };
  if (triangles.dtype() == nb::dtype<std::int32_t>())
    for_each<std::int32_t>(triangles, set);
  else if (triangles.dtype() == nb::dtype<std::int64_t>())
    for_each<std::int64_t>(triangles, set);
  else if (triangles.dtype() == nb::dtype<std::uint32_t>())
    for_each<std::uint32_t>(triangles, set);
  else
    throw Error("triangles: int32, int64 or uint32 is expected, got {}", what_array_it_is(triangles));
  return mesh;
}

/// `span` of the points as they are, for functions that divide by nothing and expect finite input.
std::span<const Eigen::Vector3f> finite(const Points& points) {
  for (std::size_t i = 0; i < points.span().size(); ++i)
    if (!points.span()[i].allFinite())
      throw Error("points[{}]: is not finite; leave missing points out (partpose.core.without_missing)", i);
  return points.span();
}

void bind_core_room(nb::module_& m) {
  nb::exception<Error>(m, "Error", PyExc_ValueError).attr("__doc__") =
      "Bad input or a wrong argument. The message says where, what is wrong and what would be right. Nothing "
      "recognized "
      "is never an Error.";

  nb::class_<Intrinsics> intrinsics(m, "Intrinsics",
                                    "Pinhole camera without distortion, in px. Pixel centres are at integer "
                                    "coordinates; camera frame: x right, y down, z forward.");
  intrinsics
      .def(
          "__init__",
          [](Intrinsics* self, int width, int height, double fx, double fy, double cx, double cy) {
            const Intrinsics camera{width, height, fx, fy, cx, cy};
            camera.check();
            new (self) Intrinsics(camera);
          },
          "width"_a, "height"_a, "fx"_a, "fy"_a, "cx"_a, "cy"_a)
      .def_static("from_field_of_view", &Intrinsics::from_field_of_view, "width"_a, "height"_a, "horizontal_fov_deg"_a,
                  "vertical_fov_deg"_a, "Image edges at +-fov/2, the principal point in the image's centre.")
      .def_ro("width", &Intrinsics::width, "Of the image, px.")
      .def_ro("height", &Intrinsics::height, "Of the image, px.")
      .def_ro("fx", &Intrinsics::fx, "Focal length in x, px.")
      .def_ro("fy", &Intrinsics::fy, "Focal length in y, px.")
      .def_ro("cx", &Intrinsics::cx, "Principal point in x, px.")
      .def_ro("cy", &Intrinsics::cy, "Principal point in y, px.")
      .def("unproject", &Intrinsics::unproject, "u"_a, "v"_a, "z_mm"_a,
           "Point in the camera frame (mm) at a pixel and a depth (mm).")
      .def("project", &Intrinsics::project, "point_mm"_a, "Pixel coordinates of a point with z > 0.")
      .def(
          "__eq__",
          [](const Intrinsics& a, const Intrinsics& b) {
            return a.width == b.width && a.height == b.height && a.fx == b.fx && a.fy == b.fy && a.cx == b.cx &&
                   a.cy == b.cy;
          },
          nb::is_operator(), nb::sig("def __eq__(self, other: object, /) -> bool"))
      .def(
          "__reduce__",
          [](nb::handle self) {
            const auto& c = nb::cast<const Intrinsics&>(self);
            return nb::make_tuple(self.type(), nb::make_tuple(c.width, c.height, c.fx, c.fy, c.cx, c.cy));
          },
          nb::sig("def __reduce__(self) -> tuple[typing.Any, ...]"));
  intrinsics.attr("__hash__") = nb::none();
  bind_repr(intrinsics, {"width", "height", "fx", "fy", "cx", "cy"});

  nb::class_<PointCloud> cloud(m, "PointCloud",
                               "Points in millimetres, optionally with unit normals and curvatures. Immutable; the "
                               "arrays are read-only views of it. An organized cloud has width x height points, row by "
                               "row, missing ones NaN.");
  cloud
      .def(
          "__init__",
          [](PointCloud* self, const Points& points, const std::optional<Points>& normals,
             const std::optional<Floats>& curvatures, int width,
             int height) { new (self) PointCloud(make_cloud(points, normals, curvatures, width, height)); },
          "points"_a, "normals"_a = nb::none(), "curvatures"_a = nb::none(), "width"_a = 0, "height"_a = 0)
      .def_prop_ro(
          "points", [](nb::handle self) { return view_of(nb::cast<const PointCloud&>(self).points, self); },
          nb::sig("def points(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float32], dict(shape=(None, 3))]"),
          "N x 3, mm.")
      .def_prop_ro(
          "normals", [](nb::handle self) { return view_of(nb::cast<const PointCloud&>(self).normals, self); },
          nb::sig("def normals(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float32], dict(shape=(None, 3))]"),
          "No rows when there are none.")
      .def_prop_ro(
          "curvatures", [](nb::handle self) { return view_of(nb::cast<const PointCloud&>(self).curvatures, self); },
          nb::sig("def curvatures(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float32], dict(shape=(None,))]"),
          "Empty when there are none.")
      .def_ro("width", &PointCloud::width, "Of an organized cloud; otherwise the number of points.")
      .def_ro("height", &PointCloud::height, "Of an organized cloud; otherwise 1.")
      .def("__len__", &PointCloud::size)
      .def("has_normals", &PointCloud::has_normals, "Whether each point has a normal.")
      .def("has_curvatures", &PointCloud::has_curvatures, "Whether each point has a curvature.")
      .def("is_organized", &PointCloud::is_organized, "Whether the points are those of an image, row by row.");
  bind_repr(cloud, {"points", "normals", "curvatures", "width", "height"});
  m.def(
      "select",
      [](const PointCloud& of, const std::vector<int>& indices) {
        for (const int i : indices)
          if (i < 0 || static_cast<std::size_t>(i) >= of.size())
            throw Error("indices: there is no point {}, there are {}", i, of.size());
        return select(of, indices);
      },
      "cloud"_a, "indices"_a, "The points at these indices, in that order.");
  m.def(
      "every_nth",
      [](const PointCloud& of, std::size_t step) {
        if (step == 0) throw Error("step: must be 1 or more");
        return every_nth(of, step);
      },
      "cloud"_a, "step"_a, "Points 0, step, 2 step, ...");
  m.def("without_missing", &without_missing, "cloud"_a, "Without points (or normals) that are not finite.");
  m.def("before_camera", &before_camera, "cloud"_a, "The finite points that a camera at the origin can see.");
  m.def("transformed", &transformed, "cloud"_a, "target_from_cloud"_a, "Points and normals moved.");
  m.def("centroid", &centroid, "cloud"_a, "The mean of the points, in mm. Zero for an empty cloud.");
  m.def(
      "append",
      [](PointCloud a, const PointCloud& b) {
        append(a, b);
        return a;
      },
      "cloud"_a, "other"_a, "A new cloud: the points of `other` behind those of `cloud`.");

  nb::class_<DepthImage> depth(m, "DepthImage", "Depth along the optical axis (z) in mm; 0 means no value. Immutable.");
  depth
      .def(
          "__init__",
          [](DepthImage* self, const DepthPixels& pixels, double scale) { new (self) DepthImage(pixels.image(scale)); },
          "pixels"_a, "depth_scale_mm"_a = 1.0, "uint16 or float pixels in units of `depth_scale_mm` mm.")
      .def_ro("width", &DepthImage::width, "px.")
      .def_ro("height", &DepthImage::height, "px.")
      .def_prop_ro(
          "z_mm",
          [](nb::handle self) {
            const auto& image = nb::cast<const DepthImage&>(self);
            return ImageView(image.z_mm.data(), {std::size_t(image.height), std::size_t(image.width)}, self);
          },
          nb::sig("def z_mm(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float32], dict(shape=(None, None))]"),
          "Height x width, a view.");
  bind_repr(depth, {"width", "height"});
  m.def(
      "to_point_cloud",
      [](const DepthImage& image, const Intrinsics& camera, bool organized) {
        if (image.width != camera.width || image.height != camera.height)
          throw Error("depth image of {} x {} px with a camera of {} x {} px", image.width, image.height, camera.width,
                      camera.height);
        return to_point_cloud(image, camera, organized);
      },
      "depth"_a, "intrinsics"_a, "organized"_a = false, "One point per pixel; missing ones are NaN when `organized`.");
  m.def("to_depth_image", &to_depth_image, "cloud"_a, "intrinsics"_a,
        "Each point into its nearest pixel, the nearest point wins.");
  m.def("intrinsics_covering", &intrinsics_covering, "cloud"_a, "pixel_size_rad"_a, "margin_px"_a = 2,
        "widest_px"_a = 2000, "The camera at the origin whose image just covers a cloud.");

  nb::class_<TriangleMesh> mesh(m, "TriangleMesh",
                                "Triangles in millimetres, counter-clockwise seen from outside. Immutable.");
  mesh.def(
          "__init__",
          [](TriangleMesh* self, const Points& vertices, const AnyArray& triangles) {
            new (self) TriangleMesh(make_mesh(vertices, triangles));
          },
          "vertices"_a, "triangles"_a,
          nb::sig(
              "def __init__(self, vertices: typing.Annotated[numpy.typing.NDArray[numpy.floating[typing.Any]], "
              "dict(shape=(None, 3))], triangles: typing.Annotated[numpy.typing.NDArray[numpy.integer[typing.Any]], "
              "dict(shape=(None, 3))]) -> None"))
      .def_prop_ro(
          "vertices", [](nb::handle self) { return view_of(nb::cast<const TriangleMesh&>(self).vertices, self); },
          nb::sig("def vertices(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float32], dict(shape=(None, 3))]"),
          "N x 3, mm.")
      .def_prop_ro(
          "triangles",
          [](nb::handle self) {
            const auto& triangles = nb::cast<const TriangleMesh&>(self).triangles;
            return nb::ndarray<nb::numpy, const int, nb::shape<-1, 3>>(
                triangles.empty() ? nullptr : triangles[0].data(), {triangles.size(), 3}, self);
          },
          nb::sig("def triangles(self) -> typing.Annotated[numpy.typing.NDArray[numpy.int32], dict(shape=(None, 3))]"),
          "M x 3 indices of vertices.")
      .def(
          "face_normal",
          [](const TriangleMesh& of, std::size_t t) {
            if (t >= of.triangles.size()) throw Error("there is no triangle {}, there are {}", t, of.triangles.size());
            return of.face_normal(t);
          },
          "t"_a, "Unit normal by the winding; zero for a degenerate triangle.");
  bind_repr(mesh, {"vertices", "triangles"});
  m.def(
      "bounding_box",
      [](const TriangleMesh& of) {
        const auto box = bounding_box(of);
        return std::pair(Eigen::Vector3d(box.min()), Eigen::Vector3d(box.max()));
      },
      "mesh"_a, "Lower and upper corner, in mm.");
  m.def("with_merged_vertices", &with_merged_vertices, "mesh"_a, "Vertices with equal coordinates made one.");
  m.def("bounding_box_diagonal", &bounding_box_diagonal, "mesh"_a, "In mm.");
  m.def("diameter", &diameter, "mesh"_a, "The largest distance of two vertices, in mm.",
        nb::call_guard<nb::gil_scoped_release>());

  m.def("rotation_error_deg", &rotation_error_deg, "a"_a, "b"_a, "Angle between two rotations (reference, eq. 2.2).");
  m.def("translation_error_mm", &translation_error_mm, "a"_a, "b"_a, "Distance between two origins (eq. 2.3).");
  m.def("rotation_from_vector", &rotation_from_vector, "omega_rad"_a, "The rotation by |omega| rad about omega.");
  m.def("is_rigid", &is_rigid, "matrix"_a, "tolerance"_a = 1e-4, "Whether a 4 x 4 matrix is a rigid motion.");
  m.def(
      "nearest_rigid",
      [](const Eigen::Matrix4d& matrix) {
        if (!matrix.allFinite()) throw Error("matrix: is not finite");
        return nearest_rigid(matrix);
      },
      "matrix"_a, "The nearest proper rotation with the same translation.");

  struct Threads {
    int threads;
    std::unique_ptr<ThreadLimit> limit;
  };
  nb::class_<Threads>(m, "ThreadLimit", "with ThreadLimit(2): the library uses at most so many threads (0: all).")
      .def(
          "__init__",
          [](Threads* self, int threads) {
            if (threads < 0) throw Error("threads: must be 0 or more, got {}", threads);
            new (self) Threads{threads, nullptr};
          },
          "threads"_a)
      .def(
          "__enter__",
          [](Threads& self) -> Threads& {
            self.limit = std::make_unique<ThreadLimit>(self.threads);
            return self;
          },
          nb::rv_policy::reference)
      .def(
          "__exit__", [](Threads& self, nb::args) { self.limit.reset(); },
          nb::sig("def __exit__(self, *args: object) -> None"));
}

void bind_inspection(nb::module_& m) {
  const auto released = nb::call_guard<nb::gil_scoped_release>();
  bind_described<MeshInspection>(m, "MeshInspection", "What a person should know before trusting a mesh.")
      .def("sound", &MeshInspection::sound, "Nothing that repair or a person should look at; size aside.");
  m.def("inspect_mesh", &inspect_mesh, "mesh"_a, released, "Size, gaps, shells, degenerate and flipped triangles.");
  m.def("guess_unit", &guess_unit, "diagonal_mm"_a,
        "In which unit a part of this diagonal (its number taken as mm) more likely is: \"metre\", \"inch\", "
        "\"micrometre\", else empty.");
  m.def("mm_per_unit", &mm_per_unit, "unit"_a, "One of guess_unit's in mm; 1 for any other text.");
  nb::class_<MeshRepair> repair(m, "MeshRepair", "A repaired mesh, and what was done.");
  repair
      .def_prop_ro(
          "mesh", [](const MeshRepair& self) { return &self.mesh; }, nb::rv_policy::reference_internal, "Repaired.")
      .def_ro("weld_distance_mm", &MeshRepair::weld_distance_mm, "Vertices nearer than this were made one.")
      .def_ro("welded_vertices", &MeshRepair::welded_vertices, "That lay so near another one.")
      .def_ro("removed_degenerate", &MeshRepair::removed_degenerate, "Triangles without area.")
      .def_ro("removed_duplicates", &MeshRepair::removed_duplicates, "Triangles that were there twice.")
      .def_ro("turned_triangles", &MeshRepair::turned_triangles, "Triangles that faced inwards.")
      .def("changed_anything", &MeshRepair::changed_anything, "Whether anything was done.");
  bind_repr(repair, {"mesh", "welded_vertices", "removed_degenerate", "removed_duplicates", "turned_triangles"});
  m.def("repair_mesh", &repair_mesh, "mesh"_a, "weld_distance_mm"_a = nb::none(), released,
        "Welds vertices, removes triangles that say nothing, turns the surface outwards. The shape stays.");
}

void bind_geometry_room(nb::module_& m) {
  const auto released = nb::call_guard<nb::gil_scoped_release>();
  m.def("voxel_grid", &voxel_grid, "cloud"_a, "voxel_mm"_a, released, "One point per occupied cell: their centroid.");
  m.def(
      "estimate_normals",
      [](PointCloud cloud, float radius_mm, const Eigen::Vector3f& viewpoint_mm) {
        estimate_normals(cloud, radius_mm, viewpoint_mm);
        return cloud;
      },
      "cloud"_a, "radius_mm"_a, "viewpoint_mm"_a = Eigen::Vector3f(0, 0, 0), released,
      "A new cloud with normals and curvatures. Points must be finite.");
  m.def(
      "icosphere_directions",
      [](int subdivide, bool use_vertices) { return rows_of(icosphere_directions(subdivide, use_vertices)); },
      "subdivide"_a, "use_vertices"_a, "Unit directions: vertices (12, 42, 162, ...) or face centres (20, 80, ...).");

  nb::class_<Plane> plane(m, "Plane", "{ p : normal . p + offset_mm = 0 }, turned towards the camera.");
  plane.def_ro("normal", &Plane::normal, "Unit normal.")
      .def_ro("offset_mm", &Plane::offset_mm, "Of the equation above.");
  plane.def("signed_distance_mm", &Plane::signed_distance_mm, "point_mm"_a, "Positive on the camera's side.");
  bind_repr(plane, {"normal", "offset_mm"});
  nb::class_<PlaneFit> fit(m, "PlaneFit", "A plane and the points on it.");
  fit.def_ro("plane", &PlaneFit::plane, "The plane found.")
      .def_ro("rms_mm", &PlaneFit::rms_mm, "Of the inliers' distances.");
  fit.def_prop_ro(
      "inliers", [](const PlaneFit& self) { return array_of(self.inliers); }, nb::rv_policy::move,
      "Indices of points.");
  bind_repr(fit, {"plane", "inliers", "rms_mm"});
  m.def(
      "fit_plane",
      [](const PointCloud& cloud, float distance_threshold_mm, int max_hypotheses, std::uint64_t seed) {
        return fit_plane(cloud, {distance_threshold_mm, max_hypotheses, seed});
      },
      "cloud"_a, "distance_threshold_mm"_a = PlaneOptions{}.distance_threshold_mm,
      "max_hypotheses"_a = PlaneOptions{}.max_hypotheses, "seed"_a = PlaneOptions{}.seed, released,
      "The dominant plane by RANSAC; None when there is none.");

  nb::class_<KdTree>(m, "KdTree", "Nearest neighbours among points that do not change.")
      .def(
          "__init__", [](KdTree* self, const Points& points) { new (self) KdTree(finite(points)); }, "points_mm"_a)
      .def(
          "nearest",
          [](const KdTree& self, const Points& queries) {
            std::vector<int> index(queries.span().size());
            std::vector<float> squared(index.size());
            {
              nb::gil_scoped_release release;
              parallel_for(
                  index.size(),
                  [&](std::size_t i) {
                    const auto found = self.nearest(queries.span()[i]);
                    index[i] = found.index;
                    squared[i] = found.squared_distance;
                  },
                  256);
            }
            return std::pair(array_of(std::move(index)), array_of(std::move(squared)));
          },
          "queries_mm"_a, "Indices (-1: none) and squared distances (mm^2) of the nearest points.")
      .def(
          "nearest_k",
          [](const KdTree& self, const Eigen::Vector3f& query, int k) {
            if (k < 1) throw Error("k: must be 1 or more, got {}", k);
            std::vector<int> index;
            std::vector<float> squared;
            for (const auto& found : self.nearest_k(query, k)) {
              index.push_back(found.index);
              squared.push_back(found.squared_distance);
            }
            return std::pair(array_of(std::move(index)), array_of(std::move(squared)));
          },
          "query_mm"_a, "k"_a, "The k nearest, nearest first; fewer when there are fewer.");

  nb::class_<SurfaceDistance>(m, "SurfaceDistance", "The nearest place on a mesh's triangles, exact.")
      .def(nb::init<const TriangleMesh&>(), "mesh"_a)
      .def(
          "nearest",
          [](const SurfaceDistance& self, const Eigen::Vector3d& query) {
            const auto found = self.nearest(query);
            return std::tuple(found.distance_mm, found.point_mm, found.triangle);
          },
          "query_mm"_a, "Distance (mm), place on the surface, triangle.");
  m.def(
      "even_surface_samples",
      [](const TriangleMesh& mesh, int count) {
        if (count < 0) throw Error("count: must be 0 or more, got {}", count);
        return rows_of(even_surface_samples(mesh, count));
      },
      "mesh"_a, "count"_a, "Points spread evenly over a mesh's surface.");

  nb::class_<ConvexHull> hull(m, "ConvexHull", "A convex hull as triangles, counter-clockwise seen from outside.");
  hull.def_prop_ro(
          "vertices", [](const ConvexHull& self) { return rows_of(self.vertices); }, nb::rv_policy::move, "N x 3, mm.")
      .def_prop_ro(
          "original", [](const ConvexHull& self) { return array_of(self.original); }, nb::rv_policy::move,
          "Which of the given points each vertex is.")
      .def_prop_ro(
          "triangles",
          [](const ConvexHull& self) {
            std::vector<Eigen::Vector3i> rows;
            for (const auto& t : self.triangles) rows.emplace_back(t[0], t[1], t[2]);
            return rows_of(std::move(rows));
          },
          nb::rv_policy::move, "M x 3 indices of vertices.")
      .def_ro("flat", &ConvexHull::flat, "All points lie on a plane, a line or a point: there are no triangles.")
      .def("volume_mm3", &ConvexHull::volume_mm3, "The enclosed volume.")
      .def("centroid", &ConvexHull::centroid, "Of the enclosed volume.");
  bind_repr(hull, {"vertices", "triangles", "flat"});
  m.def(
      "convex_hull", [](const Points& points) { return convex_hull(points.span()); }, "points_mm"_a,
      "Quickhull (Barber, Dobkin and Huhdanpaa 1996) with exact predicates.");

  nb::class_<Symmetries> symmetries(m, "Symmetries",
                                    "The rigid motions of a part, model frame (mm), that map its shape onto itself.");
  symmetries
      .def(
          "__init__",
          [](Symmetries* self, std::vector<Eigen::Isometry3d> discrete,
             const std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>>& continuous) {
            Symmetries made{std::move(discrete), {}};
            for (const auto& [axis, offset] : continuous) made.continuous.push_back({axis, offset});
            new (self) Symmetries(std::move(made));
          },
          "discrete"_a = nb::list(), "continuous"_a = nb::list())
      .def_ro("discrete", &Symmetries::discrete, "model_from_model, without the identity.")
      .def_prop_ro(
          "continuous",
          [](const Symmetries& self) {
            std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> axes;
            for (const auto& c : self.continuous) axes.emplace_back(c.axis, c.offset_mm);
            return axes;
          },
          "Axes (direction, a point on it in mm) about which it may be turned by any angle.")
      .def("empty", &Symmetries::empty, "Whether there are none.");
  bind_repr(symmetries, {"discrete", "continuous"});
  m.def("symmetry_transformations", &symmetry_transformations, "symmetries"_a, "max_step"_a = 0.01,
        "A finite list of model_from_model, the identity first, as the BOP toolkit enumerates them.");
  nb::class_<MeasuredSymmetries> measured(m, "MeasuredSymmetries", "Symmetries and how exact each is.");
  measured.def_ro("symmetries", &MeasuredSymmetries::symmetries, "The symmetries themselves.")
      .def_ro("discrete_deviation_mm", &MeasuredSymmetries::discrete_deviation_mm, "Of each of symmetries.discrete.")
      .def_ro("continuous_deviation_mm", &MeasuredSymmetries::continuous_deviation_mm,
              "Of each of symmetries.continuous.")
      .def("largest_deviation_mm", &MeasuredSymmetries::largest_deviation_mm, "The largest of all.");
  bind_repr(measured, {"symmetries", "discrete_deviation_mm", "continuous_deviation_mm"});
  nb::class_<SymmetrySearch> search(m, "SymmetrySearch", "What search_symmetries found.");
  search.def_ro("found", &SymmetrySearch::found, "Within the tolerance.")
      .def_ro("near", &SymmetrySearch::near, "But for a detail.")
      .def_ro("tolerance_mm", &SymmetrySearch::tolerance_mm, "Within which a symmetry counts as found.")
      .def_ro("diameter_mm", &SymmetrySearch::diameter_mm, "The largest distance of two vertices.");
  bind_repr(search, {"found", "near", "tolerance_mm", "diameter_mm"});
  m.def("search_symmetries", &search_symmetries, "mesh"_a, "tolerance_mm"_a = nb::none(), released,
        "The rotations that put a part's surface back onto itself within a tolerance (None: by its size).");
  m.def("find_symmetries", &find_symmetries, "mesh"_a, "tolerance_mm"_a, released, "Those within the tolerance.");
  m.def("default_symmetry_tolerance_mm", &default_symmetry_tolerance_mm, "diameter_mm"_a,
        "What search_symmetries takes by a part's size.");

  nb::class_<DistanceGrid>(m, "DistanceGrid", "Distance to the nearest of some points, tabulated.")
      .def(
          "__init__",
          [](DistanceGrid* self, const Points& points, float margin_mm, int cells) {
            if (points.span().empty()) throw Error("points: there are none");
            if (!(margin_mm >= 0) || cells < 1 || cells > 512)
              throw Error("margin_mm must be 0 or more and cells_along_longest 1 to 512, got {} and {}", margin_mm,
                          cells);
            new (self) DistanceGrid(finite(points), margin_mm, cells);
          },
          "points_mm"_a, "margin_mm"_a, "cells_along_longest"_a = 48)
      .def("at", &DistanceGrid::at, "p"_a, "In mm, right to about half a cell.")
      .def("cell_mm", &DistanceGrid::cell_mm, "Edge of a cell.");
}

}  // namespace

Points::Points(AnyArray array) : array_(std::move(array)) {
  if (array_.ndim() != 2 || array_.shape(1) != 3)
    throw Error("points: an N x 3 array of float32 or float64 is expected, got {}{}", what_array_it_is(array_),
                array_.ndim() == 2 ? "; a depth image needs its intrinsics" : "");
  const std::size_t count = array_.shape(0);
  if (array_.dtype() == nb::dtype<float>() && is_contiguous(array_)) {
    view_ = {static_cast<const Eigen::Vector3f*>(array_.data()), count};
    return;
  }
  copy_.resize(count);
  const auto set = [&](std::size_t row, std::size_t column, auto value) {
    copy_[row][static_cast<int>(column)] = static_cast<float>(value);
  };
  if (array_.dtype() == nb::dtype<float>())
    for_each<float>(array_, set);
  else if (array_.dtype() == nb::dtype<double>())
    for_each<double>(array_, set);
  else
    throw Error("points: float32 or float64 in mm is expected, got {}", what_array_it_is(array_));
  view_ = copy_;
}

Floats::Floats(AnyArray array) : array_(std::move(array)) {
  if (array_.ndim() != 1)
    throw Error("values: a vector of float32 or float64 is expected, got {}", what_array_it_is(array_));
  if (array_.dtype() == nb::dtype<float>() && is_contiguous(array_)) {
    view_ = {static_cast<const float*>(array_.data()), array_.shape(0)};
    return;
  }
  copy_.resize(array_.shape(0));
  const auto set = [&](std::size_t row, std::size_t, auto value) { copy_[row] = static_cast<float>(value); };
  if (array_.dtype() == nb::dtype<float>())
    for_each<float>(array_, set);
  else if (array_.dtype() == nb::dtype<double>())
    for_each<double>(array_, set);
  else
    throw Error("values: float32 or float64 is expected, got {}", what_array_it_is(array_));
  view_ = copy_;
}

DepthImage DepthPixels::image(double depth_scale_mm) const {
  if (!(depth_scale_mm > 0) || !std::isfinite(depth_scale_mm))
    throw Error("depth_scale_mm: must be positive, got {}", depth_scale_mm);
  if (array.ndim() != 2 || array.shape(0) > 65536 || array.shape(1) > 65536)
    throw Error("depth: a height x width array of uint16, float32 or float64 is expected, got {}",
                what_array_it_is(array));
  DepthImage image(static_cast<int>(array.shape(1)), static_cast<int>(array.shape(0)));
  const auto set = [&](std::size_t v, std::size_t u, auto value) {
    const double z_mm = static_cast<double>(value) * depth_scale_mm;
    if (z_mm < 0) throw Error("depth[{}, {}]: is negative ({}); 0 means no value", v, u, z_mm);
    image.z_mm[v * array.shape(1) + u] = std::isfinite(z_mm) ? static_cast<float>(z_mm) : 0.f;
  };
  if (array.dtype() == nb::dtype<std::uint16_t>())
    for_each<std::uint16_t>(array, set);
  else if (array.dtype() == nb::dtype<float>())
    for_each<float>(array, set);
  else if (array.dtype() == nb::dtype<double>())
    for_each<double>(array, set);
  else
    throw Error("depth: uint16, float32 or float64 is expected, got {}", what_array_it_is(array));
  return image;
}

Eigen::Isometry3d checked_pose(const Eigen::Matrix4d& matrix) {
  if (!is_rigid(matrix))
    throw Error("pose: the 4 x 4 matrix is no rigid motion (a rotation, a translation in mm, last row 0 0 0 1)");
  Eigen::Isometry3d pose;
  pose.matrix() = matrix;
  return pose;
}

PointsView view_of(const std::vector<Eigen::Vector3f>& points, nb::handle owner) {
  return {points.empty() ? nullptr : points.data()->data(), {points.size(), std::size_t{3}}, owner};
}
FloatsView view_of(std::span<const float> values, nb::handle owner) { return {values.data(), {values.size()}, owner}; }

void bind_core(nb::module_& parent) {
  auto core = room(parent, "core", "Point clouds, meshes, depth images, cameras, poses.");
  bind_core_room(core);
  auto geometry = room(parent, "geometry", "Neighbours, voxel grid, normals, planes, hulls, symmetries.");
  bind_geometry_room(geometry);
  bind_inspection(geometry);
}

}  // namespace partpose::python
