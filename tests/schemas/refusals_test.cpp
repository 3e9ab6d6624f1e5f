// A schema refuses a document that lacks a field, has one more, or has another type in one.
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "mbk/measure/measurement/measure.h"
#include "mbk/present/result/json.h"
#include "mbk/simulate/laboratory/prescribed_motion.h"
#include "tests/support/schemas.h"

namespace mbk {
namespace {

using Json = nlohmann::json;
using schemas::fits;
using schemas::fits_its_schema;

/// A result with everything that a measurement has by itself.
const Json& result_document() {
  static const Json kDocument = [] {
    Recording recording = laboratory::record_prescribed_motion({}, Hertz{1000.0}).value();
    recording.sources = {{"log.mat", "MAT level 5", "abc"}};
    return schemas::parsed(result::to_json(measurement::measure({&recording, 1}, {}).value()));
  }();
  return kDocument;
}

/// The place of every object and of every value in it.
void find_places(const Json& json, const Json::json_pointer& at, std::vector<Json::json_pointer>& objects,
                 std::vector<Json::json_pointer>& members) {
  if (json.is_object()) objects.push_back(at);
  for (const auto& [key, value] : json.items()) {
    const auto place = json.is_array() ? at / std::stoul(key) : at / key;
    if (json.is_object()) members.push_back(place);
    if (value.is_structured()) find_places(value, place, objects, members);
  }
}

struct Places {
  std::vector<Json::json_pointer> objects, members;
};

Places places_of(const Json& document) {
  Places places;
  find_places(document, Json::json_pointer(), places.objects, places.members);
  return places;
}

TEST(ASchema, RefusesAFieldMoreInAnyObject) {
  const Places places = places_of(result_document());
  EXPECT_GT(places.objects.size(), 20U);
  for (const auto& place : places.objects) {
    Json document = result_document();
    document[place]["of_my_own"] = 1;
    EXPECT_FALSE(fits_its_schema(document.dump())) << place;
  }
}

TEST(ASchema, RefusesAFieldOfAnotherType) {
  const Places places = places_of(result_document());
  EXPECT_GT(places.members.size(), 100U);
  for (const auto& place : places.members) {
    Json document = result_document();
    document[place] = Json{{"no", "such thing"}};
    EXPECT_FALSE(fits_its_schema(document.dump())) << place;
  }
}

TEST(ASchema, RefusesADocumentWithoutAFieldThatEveryOneHas) {
  const std::map<std::string, std::vector<std::string>> of = {
      {"",
       {"schema", "software", "inputs", "method", "axes", "structure", "model", "standard_error", "fit", "alternatives",
        "disagreement", "warnings", "usable", "covariance", "estimation", "excitation", "preparation"}},
      {"/model", {"M", "B", "K", "x0"}},
      {"/fit", {"VAF", "RMSE", "validated_on", "VAF_in_sample"}},
      {"/inputs/0", {"file", "sha256", "format", "duration_s", "rate_hz"}},
      {"/passivity", {"prediction", "band_hz"}},
      {"/passivity/trial", {"verdict", "absorbed_J", "interval95", "statement", "reason"}},
      {"/passivity/prediction", {"verdict", "symmetric", "antisymmetric", "extrapolated", "statement"}},
      {"/ellipses/stiffness", {"area", "shape", "orientation_deg", "eigenvalues", "symmetric_part", "interval95"}}};
  for (const auto& [place, names] : of) {
    for (const std::string& name : names) {
      Json document = result_document();
      ASSERT_EQ(document.at(Json::json_pointer(place)).erase(name), 1U) << place << ' ' << name;
      EXPECT_FALSE(fits_its_schema(document.dump())) << place << ' ' << name;
    }
  }
}

TEST(ASchema, RefusesAnotherWordThanThoseItKnows) {
  for (const char* place : {"/schema", "/method", "/structure", "/fit/validated_on", "/passivity/trial/verdict",
                            "/passivity/prediction/verdict"}) {
    Json document = result_document();
    document.at(Json::json_pointer(place)) = "of my own";
    EXPECT_FALSE(fits_its_schema(document.dump())) << place;
  }
}

TEST(ASchema, TakesNullWhereANumberMayBeUndefinedAndNowhereElse) {
  Json document = result_document();
  document["model"]["K"][0][1] = nullptr;
  EXPECT_TRUE(fits_its_schema(document.dump()));
  for (const char* place : {"/model/K/0", "/model", "/usable", "/passivity/models/0/band_hz/0", "/inputs/0/file"}) {
    Json wrong = document;
    wrong.at(Json::json_pointer(place)) = nullptr;
    EXPECT_FALSE(fits_its_schema(wrong.dump())) << place;
  }
}

TEST(ASchema, RefusesAnIntervalThatHasNotTwoEnds) {
  for (const Json& interval : {Json{1.0}, Json{1.0, 2.0, 3.0}, Json::array()}) {
    Json document = result_document();
    document["ellipses"]["inertia"]["interval95"]["area"] = interval;
    EXPECT_FALSE(fits_its_schema(document.dump())) << interval;
  }
}

TEST(ASchema, OfAListRefusesAWrongOneInIt) {
  Json list = {{"schema", "mbk.results/1"}, {"software", "mbk"}, {"results", {result_document(), result_document()}}};
  EXPECT_TRUE(fits_its_schema(list.dump()));
  list["results"][1].erase("model");
  EXPECT_FALSE(fits_its_schema(list.dump()));
}

TEST(ASchema, OfOneOfSeveralKindsRefusesAMixture) {
  const Json you = {{"type", "you"}, {"control", "here"}, {"may_control", true}, {"dropped_frames", 0}};
  EXPECT_TRUE(fits(you.dump(), "console"));
  Json refused = you;
  refused["type"] = "refused";
  EXPECT_FALSE(fits(refused.dump(), "console"));
}

TEST(ASchema, IsAskedForByAnyDocument) {
  EXPECT_FALSE(fits_its_schema(R"({"model": 1})"));
  EXPECT_FALSE(fits_its_schema("[]"));
  EXPECT_FALSE(fits_its_schema("no JSON"));
  EXPECT_THROW(std::ignore = fits_its_schema(R"({"schema": "mbk.nothing/1"})"), std::runtime_error);
}

}  // namespace
}  // namespace mbk
