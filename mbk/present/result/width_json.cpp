#include "mbk/present/result/width_json.h"

#include "mbk/present/result/result_document.h"
#include "mbk/present/result/schemas.h"

namespace mbk {

using document::Fields;

namespace {

struct Ratio {
  WidthRatio ratio;
  bool directed = true;  ///< by an angle: false with one axis or three
};

void describe(Fields<Ratio>& fields) {
  fields.add("ratio", document::through(&Ratio::ratio, &WidthRatio::ratio));
  fields.add("interval95", document::through(&Ratio::ratio, &WidthRatio::ratio95));
  fields
      .add_number(
          "direction_deg", [](const Ratio& one) { return kDegrees * one.ratio.direction; },
          "counter-clockwise from x [°]")
      .only_if(&Ratio::directed);
  fields
      .add("direction", document::through(&Ratio::ratio, &WidthRatio::along),
           "three axes: unit vector, base frame; its largest component is positive")
      .only_if([](const Ratio& one) { return one.ratio.along.size() > 0; });
}

}  // namespace

void describe(Fields<WidthFinding>& fields) {
  fields.type("Width");
  fields.add("distance", &WidthFinding::distance, "largest |ln ratio| over the directions");
  fields.add("interval95", &WidthFinding::distance95);
  fields.add("distinguishable", &WidthFinding::distinguishable, "the difference is significant (95 %)");
  fields.add("surely_positive", &WidthFinding::surely_positive, "both matrices are significantly positive");
  fields.add("second_to_first", [](const WidthFinding& width) {
    std::vector<Ratio> ratios;
    for (const WidthRatio& ratio : width.ratios) ratios.push_back({ratio, width.ratios.size() == 2});
    return ratios;
  });
}

namespace result {

void describe(Fields<Comparison>& fields) {
  fields.type("Comparison", "Output of `mbk compare --json` for two results.");
  fields.header("mbk.compare/1");
  fields.add("first", &Comparison::first);
  fields.add("second", &Comparison::second);
  const auto width = [](std::size_t k) { return [k](const Comparison& of) { return of.widths.of[k]; }; };
  const auto describe_widths = [width](Fields<Comparison>& part) {
    for (std::size_t k = 0; k < kMatrixNames.size(); ++k) part.add_or_null(kMatrixNames[k], width(k));
  };
  fields.group("width", describe_widths, "Width between the matrices; null if there is none.");
  const auto describe_refused = [](Fields<Comparison>& part) {
    for (std::size_t k = 0; k < kMatrixNames.size(); ++k) {
      part.add_if([k](const Comparison& of) { return !of.widths.of[k]; }, kMatrixNames[k],
                  [k](const Comparison& of) { return of.widths.refused[k]; });
    }
  };
  fields.group("refused", describe_refused, "Why there is no width.");
}

void describe(Fields<document::List<Comparison>>& fields) {
  describe_list(fields, "Comparisons", "mbk.comparisons/1",
                "Output of `mbk compare --json` for more than two results: each further one compared with the first.");
}

std::string to_json(std::span<const Comparison> all) {
  return document::one_or_list(all);
}

void add_comparison_schemas(document::Schemas& schemas) {
  schemas["compare"] = document::schema_of<Comparison>();
  schemas["comparisons"] = document::schema_of<document::List<Comparison>>();
}

}  // namespace result
}  // namespace mbk
