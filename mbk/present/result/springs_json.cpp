#include "mbk/present/result/springs_json.h"

#include "mbk/base/core/units.h"
#include "mbk/model/impedance/ellipse.h"
#include "mbk/present/result/described.h"
#include "mbk/present/result/schemas.h"

namespace mbk {

using document::Fields;

void describe(Fields<SpringLine>& fields) {
  using From = const SpringLine&;
  fields.type("SpringLine");
  fields.add("stiffness", &SpringLine::stiffness, "[N/m]");
  fields.add("stiffness_standard_error", &SpringLine::stiffness_error, "[N/m]");
  fields.add("rest", &SpringLine::rest, "length at which the line crosses zero force [m]");
  fields.add("rest_standard_error", &SpringLine::rest_error, "[m]");
  fields.add("r_squared", &SpringLine::r_squared);
  fields.add("RMSE", &SpringLine::rmse, "[N]");
  fields.add(
      "tension", [](From line) { return std::pair(line.tension_from, line.tension_to); }, "smallest and largest [N]");
  fields.add("samples", &SpringLine::samples);
}

void describe(Fields<HookFit>& fields) {
  fields.type("HookFit", "Hooks that yield at small force.");
  fields.add("stiffness", &HookFit::stiffness, "[N/m]");
  fields.add("stiffness_standard_error", &HookFit::stiffness_error, "[N/m]");
  fields.add("rest", &HookFit::rest, "[m]");
  fields.add("deflection", &HookFit::deflection, "[m]");
  fields.add("deflection_standard_error", &HookFit::deflection_error, "[m]");
  fields.add("force", &HookFit::force, "[N]");
  fields.add("RMSE", &HookFit::rmse, "[N]");
}

void describe(Fields<SpringConstant>& fields) {
  fields.type("SpringConstant");
  fields.add("inputs", &SpringConstant::sources);
  fields.add("straight", &SpringConstant::straight, "the result: line through the straight part");
  fields.add("whole", &SpringConstant::whole, "line through all samples");
  fields.add("bias_of_whole", &SpringConstant::bias_of_whole, "relative");
  fields.add("rule", &SpringConstant::rule, "how the straight part was chosen");
  fields.add("hac_lag_s", &SpringConstant::hac_lag_s, "[m]: correlation time of the residual in the standard errors");
  fields.add("hooks", &SpringConstant::hooks);
  fields.add("notes", &SpringConstant::notes);
}

void describe(Fields<Linearisation>& fields) {
  fields.type("Linearisation", "Linearity within a circle around the equilibrium.");
  fields.add("radius", &Linearisation::radius, "[m]");
  fields.add("largest_error", &Linearisation::largest_error, "[N]");
  fields.add("largest_force", &Linearisation::largest_force, "[N]");
  fields.add("relative_error", &Linearisation::relative_error);
  fields.add("smallest_extension", &Linearisation::smallest_extension, "[m]; below 0: a spring goes slack");
}

void describe(Fields<GridField>& fields) {
  fields.type("GridField", "Published procedure: differences of forces on a grid.");
  fields.add("step", &GridField::step, "[m]");
  fields.add("equilibrium", &GridField::equilibrium, "[m]");
  fields.add("residual_force", &GridField::residual, "[N]");
  fields.add("K", &GridField::K, "[N/m]");
  fields.add("at_border", &GridField::at_border);
}

/// Without its springs.
void describe(Fields<SpringField>& fields) {
  fields.add("equilibrium", &SpringField::equilibrium, "x₀ [m]");
  fields.add("K", &SpringField::K, "[N/m]");
  fields.group("principal", [](Fields<SpringField>& principal) {
    principal.add(
        "stiffness",
        [](const SpringField& field) {
          const impedance::Ellipse ellipse = impedance::ellipse(field.K);
          return std::pair(ellipse.lambda_max, ellipse.lambda_min);
        },
        "larger and smaller [N/m]");
    principal.add(
        "orientation_deg", [](const SpringField& field) { return kDegrees * impedance::ellipse(field.K).orientation; },
        "[°]");
  });
  fields.add("residual_force", &SpringField::residual, "at x₀ [N]");
  fields.add("moment", &SpringField::moment, "of the springs on the disc [N·m]");
  fields.add(
      "disc_rotation_deg", [](const SpringField& field) { return kDegrees * field.disc_rotation; }, "[°]");
  fields.add("linearisation", &SpringField::linearisation);
}

void describe(Fields<Spring>& fields) {
  fields.add("stiffness", &Spring::stiffness, "[N/m]");
  fields.add("rest_length", &Spring::rest_length, "[m]");
  fields.add("anchor", &Spring::anchor, "on the frame, base frame [m]");
  fields.add("hole", &Spring::hole, "on the disc, from the hand [m]");
}

namespace result {
namespace {

struct SpringInArray {
  Spring spring;
  double length, tension;
  std::optional<int> eye;
};

void describe(Fields<SpringInArray>& fields) {
  fields.type("Spring");
  fields.with(&SpringInArray::spring);
  fields.add("length", &SpringInArray::length, "[m]");
  fields.add("tension", &SpringInArray::tension, "[N]");
  fields.add("eye", &SpringInArray::eye, "number of its screw eye, from 1; absent if the springs were given");
}

struct SpringArray {
  const SpringField& field;
  const std::vector<int>* eyes = nullptr;
};

std::vector<SpringInArray> springs_of(const SpringArray& array) {
  std::vector<SpringInArray> springs;
  for (std::size_t i = 0; i < array.field.springs.size(); ++i) {
    springs.push_back({array.field.springs[i], array.field.lengths[i], array.field.tensions[i],
                       array.eyes != nullptr ? std::optional((*array.eyes)[i]) : std::nullopt});
  }
  return springs;
}

void describe(Fields<SpringArray>& fields) {
  fields.with([](const SpringArray& array) -> const SpringField& { return array.field; });
  fields.add("springs", springs_of);
  fields.add("grid", [](const SpringArray& array) { return array.field.grid; });
}

struct FieldDocument {
  const SpringField& field;
};

void describe(Fields<FieldDocument>& fields) {
  fields.type("SpringField", "Stiffness and equilibrium of a spring array.");
  fields.header("mbk.springs/1");
  fields.constant("what", "field");
  fields.with([](const FieldDocument& document) { return SpringArray{document.field}; });
}

struct DesignDocument {
  const SpringDesign& design;
};

void describe(Fields<DesignDocument>& fields) {
  using From = const DesignDocument&;
  fields.type("SpringDesign", "Springs for a target stiffness.");
  fields.header("mbk.springs/1");
  fields.constant("what", "find");
  fields.group("target", [](Fields<DesignDocument>& target) {
    target.add(
        "K", [](From document) { return document.design.target_K; }, "[N/m]");
    target.add(
        "equilibrium", [](From document) { return document.design.target_equilibrium; }, "[m]");
  });
  fields.with([](From document) { return SpringArray{document.design.field, &document.design.eyes}; });
  fields.add(
      "payload", [](From document) { return document.design.payload; }, "[kg]");
  fields.add_if([](From document) { return document.design.payload.has_value(); }, "natural_frequencies_hz",
                [](From document) { return document.design.natural_frequency; }, "low and high [Hz]");
}

struct ConstantsDocument {
  const std::vector<SpringConstant>& constants;
};

void describe(Fields<ConstantsDocument>& fields) {
  fields.type("SpringConstants", "Spring constants from slow stretches.");
  fields.header("mbk.springs/1");
  fields.constant("what", "calibrate");
  fields.add("constants", [](const ConstantsDocument& document) { return document.constants; });
}

}  // namespace

std::string to_json(const SpringField& field) {
  return document::document(FieldDocument{field});
}

std::string to_json(const SpringDesign& design) {
  return document::document(DesignDocument{design});
}

std::string to_json(const std::vector<SpringConstant>& constants) {
  return document::document(ConstantsDocument{constants});
}

void add_springs_schema(document::Schemas& schemas) {
  schemas["springs"] = document::schema_of_one<FieldDocument, DesignDocument, ConstantsDocument>(
      "Springs", "Output of `mbk springs field|find|calibrate --json`; `what` names which of the three.");
}

}  // namespace result
}  // namespace mbk
