// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/step.hpp"

#include "partpose/core/error.hpp"
#include "partpose/io/file.hpp"
#include "partpose/io/isolated_reader.hpp"

#ifdef PARTPOSE_HAS_OCCT
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <IFSelect_ReturnStatus.hxx>
#include <IMeshTools_Parameters.hxx>
#include <Interface_Static.hxx>
#include <Poly_Triangulation.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <STEPControl_Reader.hxx>
#include <Standard_Failure.hxx>
#include <TColStd_SequenceOfAsciiString.hxx>
#include <TDF_LabelMap.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#endif

#include <numbers>
#include <string_view>

namespace partpose {

namespace fs = std::filesystem;

#ifndef PARTPOSE_HAS_OCCT

bool reads_step() { return false; }

std::vector<NamedMesh> read_step(const fs::path& path, const MeshReadOptions&) {
  throw Error(
      "{}: this build of partpose reads no STEP (PARTPOSE_WITH_OCCT: OpenCASCADE was not found); export it as STL",
      path.string());
}

#else

bool reads_step() { return true; }

namespace {

void check_envelope(const fs::path& path) {
  const std::string bytes = read_file(path);
  const std::string_view begin = "ISO-10303-21", end = "END-ISO-10303-21";
  const std::size_t first = bytes.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  if (first == std::string::npos || bytes.compare(first, begin.size(), begin) != 0)
    throw Error("{}: byte 0: not a STEP file, which begins with '{};'", path.string(), begin);
  if (bytes.rfind(end) == std::string::npos)
    throw Error("{}: byte {}: the file ends here without '{};': truncated", path.string(), bytes.size(), end);
}

/// A product that is no assembly, where it stands first.
struct Body {
  std::string name;
  TopoDS_Shape shape;
};

std::string name_of(const TDF_Label& label) {
  Handle(TDataStd_Name) name;
  if (!label.FindAttribute(TDataStd_Name::GetID(), name)) return {};
  std::string text(static_cast<std::size_t>(name->Get().LengthOfCString()) + 1, '\0');
  Standard_PCharacter to = text.data();
  name->Get().ToUTF8CString(to);
  text.resize(text.find('\0'));
  return text;
}

/// Goes through the product structure; `every` lists a product as often as it is used.
void collect(const TDF_Label& label, const TopLoc_Location& location, bool every, TDF_LabelMap& known,
             std::vector<Body>& bodies) {
  if (XCAFDoc_ShapeTool::IsReference(label)) {
    TDF_Label product;
    if (XCAFDoc_ShapeTool::GetReferredShape(label, product))
      collect(product, location * XCAFDoc_ShapeTool::GetLocation(label), every, known, bodies);
    return;
  }
  if (XCAFDoc_ShapeTool::IsAssembly(label)) {
    TDF_LabelSequence components;
    XCAFDoc_ShapeTool::GetComponents(label, components);
    for (const auto& component : components) collect(component, location, every, known, bodies);
    return;
  }
  if (!known.Add(label) && !every) return;
  bodies.push_back({name_of(label), XCAFDoc_ShapeTool::GetShape(label).Moved(location)});
}

std::vector<TopoDS_Shape> solids_of(const TopoDS_Shape& shape) {
  std::vector<TopoDS_Shape> solids;
  for (TopExp_Explorer solid(shape, TopAbs_SOLID); solid.More(); solid.Next()) solids.push_back(solid.Current());
  return solids;
}

void add_triangles(TriangleMesh& mesh, const TopoDS_Shape& solid) {
  for (TopExp_Explorer faces(solid, TopAbs_FACE); faces.More(); faces.Next()) {
    TopLoc_Location location;
    const TopoDS_Face face = TopoDS::Face(faces.Current());
    const Handle(Poly_Triangulation) facets = BRep_Tool::Triangulation(face, location);
    if (facets.IsNull()) continue;
    const gp_Trsf place = location.Transformation();
    const bool inside_out = (face.Orientation() == TopAbs_REVERSED) != place.IsNegative();
    const int first = static_cast<int>(mesh.vertices.size()) - 1;  // OpenCASCADE counts from 1
    for (int i = 1; i <= facets->NbNodes(); ++i) {
      const gp_Pnt p = facets->Node(i).Transformed(place);
      mesh.vertices.push_back(Eigen::Vector3d(p.X(), p.Y(), p.Z()).cast<float>());
    }
    for (int i = 1; i <= facets->NbTriangles(); ++i) {
      int a = 0, b = 0, c = 0;
      facets->Triangle(i).Get(a, b, c);
      if (inside_out) std::swap(b, c);
      mesh.triangles.push_back({first + a, first + b, first + c});
    }
  }
}

TriangleMesh mesh_of(const std::vector<TopoDS_Shape>& solids, const MeshReadOptions& options) {
  IMeshTools_Parameters parameters;
  parameters.Deflection = options.chord_tolerance_mm;
  parameters.Angle = options.angle_tolerance_deg * std::numbers::pi / 180;
  parameters.InParallel = false;  // the same triangles in the same order, always
  TriangleMesh mesh;
  for (const auto& solid : solids) {
    const BRepMesh_IncrementalMesh mesher(solid, parameters);
    add_triangles(mesh, solid);
  }
  mesh = with_merged_vertices(mesh);
  std::erase_if(mesh.triangles, [](const auto& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
  return mesh;
}

std::vector<NamedMesh> read_here(const fs::path& path, const MeshReadOptions& options) {
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");
  STEPCAFControl_Reader reader;
  reader.SetColorMode(false);
  reader.SetLayerMode(false);
  reader.SetNameMode(true);
  if (reader.ReadFile(path.c_str()) != IFSelect_RetDone)
    throw Error("{}: is not readable as STEP: its entities are damaged", path.string());
  TColStd_SequenceOfAsciiString lengths, angles, solid_angles;
  reader.ChangeReader().FileUnits(lengths, angles, solid_angles);
  Handle(TDocStd_Document) document = new TDocStd_Document("partpose");
  if (!reader.Transfer(document))
    throw Error("{}: holds no solid, and no other shape: export the part as a closed body", path.string());

  const Handle(XCAFDoc_ShapeTool) shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  TDF_LabelSequence roots;
  shapes->GetFreeShapes(roots);
  std::vector<Body> bodies;
  TDF_LabelMap known;
  for (const auto& root : roots) collect(root, TopLoc_Location(), options.split == "whole", known, bodies);

  const std::string unit = lengths.Length() == 1 ? lengths.First().ToCString() : "";
  std::vector<NamedMesh> parts;
  std::vector<TopoDS_Shape> all;
  int faces = 0;
  for (const auto& body : bodies) {
    TopTools_IndexedMapOfShape map;
    TopExp::MapShapes(body.shape, TopAbs_FACE, map);
    faces += map.Extent();
    const auto solids = solids_of(body.shape);
    all.insert(all.end(), solids.begin(), solids.end());
    if (options.split == "solid")
      for (const auto& solid : solids) parts.push_back({body.name, mesh_of({solid}, options), path, unit});
    if (options.split == "product" && !solids.empty())
      parts.push_back({body.name, mesh_of(solids, options), path, unit});
  }
  if (all.empty())
    throw Error("{}: holds no solid{}: export the part as a closed body", path.string(),
                faces > 0 ? fmt::format(" but {} loose faces", faces) : "");
  if (options.split == "whole") parts.push_back({"", mesh_of(all, options), path, unit});
  return parts;
}

}  // namespace

std::vector<NamedMesh> read_step(const fs::path& path, const MeshReadOptions& options) {
  options.check();
  check_envelope(path);
  return read_isolated(path, "OpenCASCADE", [&] {
    try {
      return read_here(path, options);
    } catch (const Standard_Failure& failure) {
      throw Error("{}: OpenCASCADE cannot make solids of it: {}", path.string(), failure.GetMessageString());
    }
  });
}

#endif

}  // namespace partpose
