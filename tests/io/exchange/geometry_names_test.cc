// SPDX-License-Identifier: MIT
// Names of curves and surfaces through every format.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <IGESControl_Controller.hxx>
#include <IGESControl_Reader.hxx>
#include <IGESData_IGESEntity.hxx>
#include <IGESData_IGESModel.hxx>
#include <STEPControl_Controller.hxx>
#include <STEPControl_Reader.hxx>
#include <StepBasic_Product.hxx>
#include <StepData_StepModel.hxx>
#include <StepShape_AdvancedFace.hxx>
#include <TCollection_HAsciiString.hxx>

#include <stdexcept>
#include <string>
#include <vector>

#include "batten/geometry/make_surface.h"
#include "batten/io/geometry_file.h"
#include "batten/io/read_error.h"
#include "io/exchange/geometry_names.h"
#include "random_geometry.h"
#include "random_trims.h"
#include "temporary_folder.h"

namespace batten::internal::geometry_names_test {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::ElementsAreArray;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr unsigned kSeed = 77;

class GeometryNamesTest : public testing::Test {
 protected:
  // A free surface, a trimmed one, an analytic one, a free curve, a plane curve.
  GeometryFile Sample(const std::string& path, std::vector<std::string> names) {
    return {path,
            {random_.Surface(3, 2, true, true),
             RandomTrims(kSeed).Trimmed(random_.Surface(2, 2, true, false), 2),
             MakeCylinder(Frame(), 2, {0, 5}),
             random_.Curve<3>(3, true, true),
             random_.Curve<2>(2, true, false)},
            std::move(names)};
  }

  TemporaryFolder folder_;
  RandomGeometry random_{kSeed};
};

TEST_F(GeometryNamesTest, EveryFormatGivesBackTheNamesItWasGiven) {
  const std::vector<std::string> names = {"wing, upper",
                                          "it's 50% \"trimmed\"",
                                          "Schr\xC3\xA4ge \xE2\x88\xA0 \xF0\x9D\x84\x9E",
                                          "a\\b",
                                          std::string(300, 'x') + " end"};
  for (const char* name : {"a.json", "a.step", "a.igs"}) {
    SCOPED_TRACE(name);
    WriteGeometry(Sample(folder_.File(name), names));
    EXPECT_THAT(ReadGeometryContents(folder_.File(name)).names, ElementsAreArray(names));
  }
  WriteGeometry(Sample(folder_.File("b.step"), names), {.step_schema = "ap242"});
  EXPECT_THAT(ReadGeometryContents(folder_.File("b.step")).names, ElementsAreArray(names));
}

// As other writers escape them: every quote doubled; and with comments where they may stand.
TEST_F(GeometryNamesTest, QuotesInStepAreReadWhateverFollowsThem) {
  WriteGeometry({folder_.File("plain.step"), {random_.Surface(2, 2, false, false)}, {"NAME"}});
  const std::string text = folder_.Text("plain.step"), plain = "PRODUCT('NAME','NAME',";
  const size_t at = text.find(plain);
  ASSERT_NE(at, text.npos);
  for (const std::string& name : std::vector<std::string>{
           "a',b", "a')b", "a' ,b", "it's", "'", "''x", "x''", "'('", "a';", "a'\"b", "a' = #1"}) {
    SCOPED_TRACE(name);
    std::string doubled;
    for (const char c : name) doubled += c == '\'' ? "''" : std::string(1, c);
    for (const char* comment : {"", " /* it's, a ')' */ ", "\t", " \r\n\t "}) {
      std::string changed = text;
      std::string product("PRODUCT(");
      product.append(comment).append("'1'").append(comment).append(",'").append(doubled);
      product.append("'").append(comment).append(",");
      changed.replace(at, plain.size(), product);
      // The face has the name too, and its own counts first.
      for (size_t k; (k = changed.find("'NAME'")) != changed.npos;) changed.erase(k + 1, 4);
      EXPECT_THAT(ReadGeometryContents(folder_.With("quoted.step", changed)).names,
                  ElementsAre(name));
    }
  }
}

TEST_F(GeometryNamesTest, WhatHasNoNameComesBackWithoutOne) {
  for (const char* name : {"a.json", "a.step", "a.igs"}) {
    SCOPED_TRACE(name);
    WriteGeometry(Sample(folder_.File(name), {}));
    EXPECT_THAT(ReadGeometryContents(folder_.File(name)).names, ElementsAre("", "", "", "", ""));
    WriteGeometry(Sample(folder_.File(name), {"", "", "only", "", ""}));
    EXPECT_THAT(ReadGeometryContents(folder_.File(name)).names,
                ElementsAre("", "", "only", "", ""));
  }
  EXPECT_THROW(WriteGeometry(Sample(folder_.File("c.json"), {"one"})), std::invalid_argument);
}

TEST_F(GeometryNamesTest, AnotherReaderFindsProductsAndFacesByTheirNames) {
  WriteGeometry(Sample(folder_.File("a.step"), {"hull", "deck", "mast", "sheer", "plan"}));
  STEPControl_Controller::Init();
  STEPControl_Reader reader;
  ASSERT_EQ(reader.ReadFile(folder_.File("a.step").c_str()), IFSelect_RetDone);
  std::vector<std::string> products, faces;
  const Handle(StepData_StepModel) model = reader.StepModel();
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const auto product = Handle(StepBasic_Product)::DownCast(model->Value(i));
    if (!product.IsNull()) products.push_back(product->Name()->ToCString());
    const auto face = Handle(StepShape_AdvancedFace)::DownCast(model->Value(i));
    if (!face.IsNull()) faces.push_back(face->Name()->ToCString());
  }
  EXPECT_THAT(products, ElementsAre("hull", "deck", "mast", "sheer", "plan"));
  EXPECT_THAT(faces, ElementsAre("hull", "deck", "mast"));
}

TEST_F(GeometryNamesTest, AnotherReaderFindsIgesEntitiesByTheirNames) {
  WriteGeometry(Sample(folder_.File("a.igs"), {"hull plating", "deck", "mast", "sheer", "plan"}));
  IGESControl_Controller::Init();
  IGESControl_Reader reader;
  ASSERT_EQ(reader.ReadFile(folder_.File("a.igs").c_str()), IFSelect_RetDone);
  std::vector<std::string> names, labels;
  const Handle(IGESData_IGESModel) model = reader.IGESModel();
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const auto entity = model->Entity(i);
    if (!entity->HasName() || entity->TypeNumber() == 406) continue;
    names.push_back(entity->NameValue()->ToCString());
    labels.push_back(entity->ShortLabel()->ToCString());
  }
  EXPECT_THAT(names, Contains("hull plating"));
  EXPECT_THAT(labels, Contains("hull pla"));
}

// Text is ASCII in STEP, on one line however long, and no name can break out of its quotes.
TEST_F(GeometryNamesTest, StepTextIsAscii) {
  WriteGeometry(Sample(folder_.File("a.step"),
                       {"\xC3\xA9t\xC3\xA9", "');ENDSEC;", "#1=", "/* */", std::string(200, 'n')}));
  const std::string text = folder_.Text("a.step");
  for (const char c : text) ASSERT_LT(static_cast<unsigned char>(c), 0x80);
  EXPECT_THAT(text, HasSubstr("\\X2\\00E9\\X0\\t\\X2\\00E9\\X0\\"));
  EXPECT_THAT(
      ReadGeometryContents(folder_.File("a.step")).names,
      ElementsAre("\xC3\xA9t\xC3\xA9", "');ENDSEC;", "#1=", "/* */", std::string(200, 'n')));
}

// What a program calls the solid, its product or the surface is the name of faces without one.
TEST_F(GeometryNamesTest, FacesWithoutANameHaveThatOfWhatTheyArePartOf) {
  WriteGeometry(Sample(folder_.File("a.step"), {"hull", "", "", "", ""}));
  std::string text = folder_.Text("a.step");
  const std::string face = "ADVANCED_FACE('hull'";
  ASSERT_NE(text.find(face), text.npos);
  text.replace(text.find(face), face.size(), "ADVANCED_FACE(''");
  EXPECT_EQ(ReadGeometryContents(folder_.With("b.step", text)).names[0], "hull");
  const std::string surface = "B_SPLINE_SURFACE_WITH_KNOTS(";
  const size_t item = text.find("REPRESENTATION_ITEM('')", text.find(surface));
  ASSERT_NE(item, text.npos);
  text.replace(item, 23, "REPRESENTATION_ITEM('loft')");
  EXPECT_EQ(ReadGeometryContents(folder_.With("c.step", text)).names[0], "loft");
}

TEST(CleanNameTest, MakesOneLineOfUtf8OfAnything) {
  EXPECT_EQ(CleanName("  two words\t\n"), "two words");
  EXPECT_EQ(CleanName("a\nb"), "a b");
  EXPECT_EQ(CleanName("gr\xFC\xDF"), "gr\xC3\xBC\xC3\x9F");  // Latin-1
  EXPECT_EQ(CleanName("gr\xC3\xBC\xC3\x9F"), "gr\xC3\xBC\xC3\x9F");
  EXPECT_EQ(CleanName(std::string("\0\x01", 2)), "");
  std::string long_name;
  for (int i = 0; i < 600; ++i) long_name += "\xC3\xBC";
  EXPECT_EQ(CleanName(long_name), long_name.substr(0, 1000));
  EXPECT_EQ(CleanName("x" + long_name), "x" + long_name.substr(0, 998));
}

}  // namespace batten::internal::geometry_names_test
