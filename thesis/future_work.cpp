// Section 6.3: which of it mbk does, with a worked example each, and what is open.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "mbk/base/numeric/statistics.h"
#include "mbk/measure/analyse/analyse_joint_domain.h"
#include "mbk/measure/analyse/analyse_width.h"
#include "mbk/measure/analyse/posture.h"
#include "mbk/measure/measurement/measure.h"
#include "mbk/model/impedance/ellipse.h"
#include "mbk/model/impedance/passivity_index.h"
#include "mbk/simulate/laboratory/scenario.h"
#include "mbk/simulate/participant/arm.h"
#include "mbk/teleop/judge.h"
#include "mbk/validate/simulated_trials.h"
#include "thesis/drawing.h"
#include "thesis/exhibits.h"

namespace mbk::thesis {
namespace {

ReproducedTable table_of(const Exhibit& exhibit, std::string rows, std::vector<ReproducedColumn> columns) {
  ReproducedTable table;
  table.id = exhibit.id;
  table.provenance = Provenance::simulated;
  table.what_rows_are = std::move(rows);
  table.columns = std::move(columns);
  return table;
}

/// The position–position design of examples/teleop/position_position.toml.
constexpr const char* kDesign = R"(
[architecture]
kind = "position-position"
[master]
mass_kg = 0.5
damping_N_s_per_m = 1
controller_damping_N_s_per_m = 10
controller_stiffness_N_per_m = 100
[slave]
mass_kg = 0.8
damping_N_s_per_m = 1
controller_damping_N_s_per_m = 20
controller_stiffness_N_per_m = 200
)";

/// The slave's stiffnesses that are stable with an operator of that shortage a.
Result<ReproducedCell> admissible_stiffness(double a) {
  const auto design = MBK_TRY(teleop::parse_design(kDesign, "position_position.toml"));
  teleop::Question question;
  question.operator_shortage = OperatorShortage{a, "measured", {}};
  const auto sweep = MBK_TRY(teleop::parse_sweep("slave.k=0:5000"));
  question.sweep = sweep;
  const auto finding = MBK_TRY(teleop::judge(design, question));
  std::string text;
  for (const AdmissibleInterval& interval : finding.admissible->intervals) {
    text += fmt::format("{}{:.1f} to {:.1f}", text.empty() ? "" : ", ", interval.low.value, interval.high.value);
  }
  return words(text.empty() ? "none" : text);
}

Result<void> teleoperation(Workbench& bench, Draft& exhibit) {
  exhibit.related = {"table-3.6", "table-4.5", "question-4"};
  exhibit.commands = {fmt::format(
      "mbk simulate relaxed_sinusoidal --seed {} --out p1.h5 && mbk measure p1.h5 --handle-mass {} --json --out "
      "p1.json && mbk teleop examples/teleop/position_position.toml --parameter slave.k=0:5000 --operator "
      "p1.json",
      bench.seed(1, 1), kHandleMass)};
  const auto relaxed = MBK_TRY(first_of(bench, Task::relaxed_sinusoidal));
  const auto rigid = MBK_TRY(first_of(bench, Task::rigid_underdamped));
  const auto& models = relaxed->pooled.passivity->models;
  if (models.empty() || !models.front().excess) return bad_data("the relaxed arm has no excess of passivity");
  ReproducedTable table =
      table_of(exhibit, "operator", {{"excess of passivity", "N·s/m", 2}, {"stable k_s, 0 to 5000 N/m", "N/m", 1}});
  for (const auto& [name, excess] :
       {std::pair{"passive, nothing else known", 0.0},
        std::pair{"P1 relaxed: lower end of the 95 % interval", models.front().excess->corrected95.first},
        std::pair{"P1 rigid under pulses: upper end of the shortage",
                  -rigid->pooled.passivity->trial->energy.shortage_largest95.second}}) {
    auto stable = MBK_TRY(admissible_stiffness(-excess));
    table.rows.push_back({name, {cell(excess), std::move(stable)}});
  }
  exhibit.tables = {std::move(table)};
  return {};
}

Result<void> cns_model(Workbench& bench, Draft& exhibit) {
  exhibit.related = {"table-4.4", "table-4.1"};
  exhibit.commands = {"mbk validate one-dimensional", "mbk validate participant"};
  const auto grasps = MBK_TRY(bench.one_axis_grasps());
  Vector vaf(std::ssize(*grasps));
  for (Index k = 0; k < vaf.size(); ++k) vaf[k] = (*grasps)[static_cast<std::size_t>(k)].vaf;
  std::ranges::sort(vaf);
  ReproducedTable table = table_of(exhibit, "of the trials", {{"VAF", "%", 1}});
  table.rows = {{"lowest", {cell(vaf[0])}},
                {"median", {cell(numeric::quantile(vaf, 0.5))}},
                {"highest", {cell(vaf[vaf.size() - 1])}}};
  exhibit.tables = {std::move(table)};
  return {};
}

/// E [J] that the limb absorbs between two times of a recording.
double absorbed(const Recording& recording, double from_s, double to_s) {
  const Part part = part_of(recording, from_s, to_s);
  const auto segment = [&](const char* channel) -> Vector {
    return recording.find(channel)->values.segment(part.begin, part.size);
  };
  double energy = 0.0;
  for (const auto& [force, place] : {std::pair{"force_x", "hand_x"}, std::pair{"force_y", "hand_y"}}) {
    const Vector f = segment(force), x = segment(place);
    const Index n = part.size - 1;
    energy -= 0.5 * (f.head(n) + f.tail(n)).dot(x.tail(n) - x.head(n));
  }
  return energy;
}

Result<void> reaction_time(Workbench& bench, Draft& exhibit) {
  constexpr double kReaction = 0.15;  // [s]
  exhibit.related = {"figure-4.5", "figure-4.3"};
  exhibit.commands = {fmt::format(
      "mbk simulate rigid_underdamped_2N --seed {} --out p1.h5 && mbk passivity p1.h5 --handle-mass {} --json",
      bench.seed(1, 1), kHandleMass)};
  const auto results = MBK_TRY(bench.results(Task::rigid_underdamped));
  ReproducedTable table = table_of(exhibit, "participant", {{"first 150 ms", "mJ", 1}, {"from then on", "mJ", 1}});
  table.spread_is = "standard deviation over the pulses";
  for (const TaskResult& result : *results) {
    std::vector<double> before, after;
    for (const EnergyPart& pulse : result.trials.front().energy.parts) {
      before.push_back(1e3 * absorbed(result.first, pulse.from_s, pulse.from_s + kReaction));
      after.push_back(1e3 * absorbed(result.first, pulse.from_s + kReaction, pulse.to_s));
    }
    table.rows.push_back({person(result.participant),
                          {cell(before, Spread::standard_deviation), cell(after, Spread::standard_deviation)}});
  }
  exhibit.tables = {std::move(table)};
  return {};
}

Result<void> joint_domain(Workbench& bench, Draft& exhibit) {
  exhibit.related = {"table-3.2"};
  exhibit.commands = {fmt::format(
      "mbk simulate relaxed_sinusoidal --seed {} --out p1.h5 && mbk measure p1.h5 --handle-mass {} --domain joint",
      bench.seed(1, 1), kHandleMass)};
  const auto relaxed = MBK_TRY(first_of(bench, Task::relaxed_sinusoidal));
  const Identification& identification = relaxed->pooled.identification;
  const Preparation& window = identification.preparations.front();
  const auto posture = analyse::posture(relaxed->first, window.from_s, window.to_s);
  if (!posture) return bad_data("the recording does not say how the arm stood");
  const auto joints = MBK_TRY(analyse::analyse_joint_domain(identification, *posture));
  const auto limb = MBK_TRY(participant::participant_limb(1));
  ReproducedTable table =
      table_of(exhibit, "element", {{"measured", "", 3}, {"standard error", "", 3}, {"given to the arm", "", 3}});
  struct Quantity {
    const char *name, *unit;
    const Matrix *value, *error;
    const Eigen::Matrix2d* given;
  };
  for (const Quantity& quantity : {Quantity{"M_q", "kg·m²", &joints.M, &joints.M_error, &limb.joints.inertia},
                                   Quantity{"B_q", "N·m·s/rad", &joints.B, &joints.B_error, &limb.joints.damping},
                                   Quantity{"K_q", "N·m/rad", &joints.K, &joints.K_error, &limb.joints.stiffness}}) {
    for (const auto& [i, j] : {std::pair{0, 0}, std::pair{0, 1}, std::pair{1, 1}}) {
      table.rows.push_back(
          {fmt::format("{} {}{} [{}]", quantity.name, i + 1, j + 1, quantity.unit),
           {cell((*quantity.value)(i, j)), cell((*quantity.error)(i, j)), cell((*quantity.given)(i, j))}});
    }
  }
  exhibit.tables = {std::move(table)};
  return {};
}

/// A ready scenario, measured as mbk does by default.
struct Measured {
  laboratory::Performance performance;
  Measurement result;
};

Result<Measured> measured(laboratory::Scenario scenario) {
  auto performance = MBK_TRY(laboratory::simulate(scenario));
  measurement::Options options;
  options.identify.handle_mass = kHandleMass;
  auto found = MBK_TRY(measurement::measure({&performance.recording, 1}, options));
  return Measured{std::move(performance), std::move(found)};
}

Result<void> force_task(Workbench& bench, Draft& exhibit) {
  exhibit.related = {"table-3.2"};
  exhibit.commands = {"mbk simulate force_task --out force.h5 && mbk measure force.h5 --handle-mass 0.194"};
  auto scenarios = MBK_TRY(validation::ready("force_task"));
  ReproducedTable table = table_of(exhibit, "task",
                                   {{"λ_min K", "N/m", 0},
                                    {"λ_max K", "N/m", 0},
                                    {"λ_min B", "N·s/m", 1},
                                    {"λ_max B", "N·s/m", 1},
                                    {"VAF x", "%", 1},
                                    {"VAF y", "%", 1},
                                    {"RMS force", "N", 2},
                                    {"energy absorbed", "J", 2}});
  for (const bool task : {true, false}) {
    laboratory::Scenario scenario = scenarios.front();
    scenario.seed = bench.seed(1, 1);
    auto& arm = std::get<participant::ArmOptions>(std::get<laboratory::PlanarTrial>(scenario.trial).load);
    if (!task) arm.controller.force_gain = 0.0;
    const auto found = MBK_TRY(measured(scenario));
    const Identification& identification = found.result.identification;
    const impedance::Ellipse K = impedance::ellipse(identification.model.K),
                             B = impedance::ellipse(identification.model.B);
    const Recording& recording = found.performance.recording;
    const Vector squares =
        recording.find("force_x")->values.cwiseAbs2() + recording.find("force_y")->values.cwiseAbs2();
    table.rows.push_back({task ? "force to be kept at zero" : "relaxed",
                          {cell(K.lambda_min), cell(K.lambda_max), cell(B.lambda_min), cell(B.lambda_max),
                           cell(identification.fit.vaf[0]), cell(identification.fit.vaf[1]),
                           cell(std::sqrt(squares.mean())), cell(found.performance.energy_absorbed)}});
  }
  exhibit.tables = {std::move(table)};
  return {};
}

Result<void> pathologies(Workbench& bench, Draft& exhibit) {
  exhibit.related = {"future-work-7"};
  exhibit.commands = {"mbk simulate abnormal_tone --out tone.h5 && mbk measure tone.h5 --handle-mass 0.194"};
  auto scenarios = MBK_TRY(validation::ready("abnormal_tone"));
  scenarios.front().seed = bench.seed(1, 1);
  const auto& robot =
      std::get<participant::ToneRobot::Options>(std::get<laboratory::PlanarTrial>(scenarios.front().trial).load);
  const auto found = MBK_TRY(measured(scenarios.front()));
  const Identification& identification = found.result.identification;
  ReproducedTable table =
      table_of(exhibit, "element", {{"programmed", "", 1}, {"measured", "", 1}, {"standard error", "", 1}});
  struct Quantity {
    const char *name, *unit;
    Matrix programmed;
    const Matrix *value, *error;
  };
  for (const Quantity& quantity :
       {Quantity{"M", "kg", robot.inertia * Matrix::Identity(2, 2), &identification.model.M,
                 &identification.standard_error.M},
        Quantity{"B", "N·s/m", robot.damping, &identification.model.B, &identification.standard_error.B},
        Quantity{"K", "N/m", robot.stiffness, &identification.model.K, &identification.standard_error.K}}) {
    for (const auto& [i, j, name] : {std::tuple{0, 0, "xx"}, std::tuple{0, 1, "xy"}, std::tuple{1, 1, "yy"}}) {
      table.rows.push_back(
          {fmt::format("{} {} [{}]", quantity.name, name, quantity.unit),
           {cell(quantity.programmed(i, j)), cell((*quantity.value)(i, j)), cell((*quantity.error)(i, j))}});
    }
  }
  table.rows.push_back(
      {"VAF x, y [%]",
       {words("–"), words(fmt::format("{:.1f}, {:.1f}", identification.fit.vaf[0], identification.fit.vaf[1])),
        words("–")}});
  exhibit.tables = {std::move(table)};
  return {};
}

Result<void> impedance_width(Workbench& bench, Draft& exhibit) {
  exhibit.related = {"table-4.3", "future-work-6"};
  exhibit.commands = {fmt::format(
      "mbk simulate relaxed_sinusoidal --seed {0} --out relaxed.h5 && mbk simulate rigid_sinusoidal_6N --seed {0} "
      "--out rigid.h5 && mbk compare relaxed.h5 rigid.h5 --method iv --handle-mass {1}",
      bench.seed(1, 1), kHandleMass)};
  const auto relaxed = MBK_TRY(first_of(bench, Task::relaxed_sinusoidal));
  const auto rigid = MBK_TRY(first_of(bench, Task::rigid_sinusoidal));
  const auto widths =
      MBK_TRY(analyse::analyse_width(relaxed->pooled.identification, rigid->by(Method::instrumental_variables)));
  ReproducedTable table = table_of(exhibit, "matrix",
                                   {{"width", "", 2},
                                    {"95 %, low", "", 2},
                                    {"95 %, high", "", 2},
                                    {"rigid over relaxed, least", "times", 1},
                                    {"rigid over relaxed, most", "times", 1}});
  for (std::size_t k = 0; k < widths.of.size(); ++k) {
    ReproducedRow row{kMatrixNames[k], std::vector<ReproducedCell>(5)};
    if (const auto& width = widths.of[k]) {
      row.cells = {cell(width->distance), cell(width->distance95.first), cell(width->distance95.second),
                   cell(width->ratios.front().ratio), cell(width->ratios.back().ratio)};
    } else {
      row.cells[0] = words(widths.refused[k]);
    }
    table.rows.push_back(std::move(row));
  }
  exhibit.tables = {std::move(table)};
  return {};
}

constexpr auto kFuture = Exhibit::Kind::future_work;
constexpr std::array kFutureWork = {Maker{kFuture, 6, "future-work-1", Provenance::simulated, teleoperation},
                                    Maker{kFuture, 6, "future-work-2", Provenance::simulated, cns_model},
                                    Maker{kFuture, 6, "future-work-3", Provenance::simulated, reaction_time},
                                    Maker{kFuture, 6, "future-work-4", Provenance::simulated, joint_domain},
                                    Maker{kFuture, 6, "future-work-5", Provenance::simulated, force_task},
                                    Maker{kFuture, 6, "future-work-6", Provenance::simulated, pathologies},
                                    Maker{kFuture, 6, "future-work-7", Provenance::simulated, impedance_width}};

}  // namespace

std::span<const Maker> future_work() {
  return kFutureWork;
}

}  // namespace mbk::thesis
