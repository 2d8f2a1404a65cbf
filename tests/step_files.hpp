// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
// STEP files for tests, written by OpenCASCADE; only in builds that have it.
#pragma once
#ifdef PARTPOSE_HAS_OCCT

#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRep_Builder.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <STEPCAFControl_Controller.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopoDS_Compound.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <gp_Ax2.hxx>
#include <gp_Pln.hxx>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace partpose::step_files {

inline TopoDS_Shape block(double x, double y, double z) { return BRepPrimAPI_MakeBox(x, y, z).Shape(); }

/// About z, from z = `from` on.
inline TopoDS_Shape cylinder(double x, double y, double from, double radius, double height) {
  return BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(x, y, from), gp::DZ()), radius, height).Shape();
}

/// 40 x 30 x 20 mm, one corner at the origin, with a bore of 10 mm diameter along z through (15, 12).
inline TopoDS_Shape bored_block() { return BRepAlgoAPI_Cut(block(40, 30, 20), cylinder(15, 12, -5, 5, 30)).Shape(); }

inline TopoDS_Shape face(double size) { return BRepBuilderAPI_MakeFace(gp_Pln(), 0, size, 0, size).Shape(); }

inline TopoDS_Shape at(const TopoDS_Shape& shape, double x, double y, double z) {
  gp_Trsf move;
  move.SetTranslation(gp_Vec(x, y, z));
  return shape.Moved(TopLoc_Location(move));
}

/// A product, and the places where an assembly holds it.
struct Product {
  std::string name;
  TopoDS_Shape shape;
  std::vector<gp_XYZ> places = {gp_XYZ(0, 0, 0)};
};

/// One product is written as it is, several as an assembly of them. `unit` is OpenCASCADE's: MM, INCH, M, ...
inline void write(const std::filesystem::path& path, const std::vector<Product>& products, const char* unit = "MM") {
  Message::DefaultMessenger()->ChangePrinters().Clear();
  STEPCAFControl_Controller::Init();
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");
  Interface_Static::SetCVal("write.step.unit", unit);
  Handle(TDocStd_Document) document = new TDocStd_Document("test");
  const Handle(XCAFDoc_ShapeTool) shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  if (products.size() == 1) {
    TDataStd_Name::Set(shapes->AddShape(products[0].shape, false), products[0].name.c_str());
  } else {
    const TDF_Label assembly = shapes->NewShape();
    TDataStd_Name::Set(assembly, "assembly");
    for (const auto& product : products) {
      const TDF_Label label = shapes->AddShape(product.shape, false);
      TDataStd_Name::Set(label, product.name.c_str());
      for (const auto& place : product.places) {
        gp_Trsf move;
        move.SetTranslation(gp_Vec(place));
        shapes->AddComponent(assembly, label, TopLoc_Location(move));
      }
    }
    shapes->UpdateAssemblies();
  }
  STEPCAFControl_Writer writer;
  writer.SetNameMode(true);
  if (!writer.Transfer(document, STEPControl_AsIs) || writer.Write(path.c_str()) != IFSelect_RetDone)
    throw std::runtime_error("cannot write " + path.string());
}

}  // namespace partpose::step_files

#endif
