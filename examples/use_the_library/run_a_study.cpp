// An experiment of two trials on the simulated robot: planned, performed behind the safety gate, recorded and measured;
// a poor measurement is repeated once.   usage: run_a_study FOLDER
#include <cstdio>
#include <filesystem>
#include <string>

#include "mbk/experiment/session/conduct.h"
#include "mbk/simulate/laboratory/simulation.h"

namespace {

/// The contents of an experiment file for `mbk run`. The keys of the second trial override the rest.
constexpr const char* kExperiment = R"(
[person]
number = 7                      # a number, never a name
[robot]
home_mm = [300, -50]
handle_mass_kg = 0.194
[control]
kind = "position"
[perturbation]
kind = "multisine"
peak_deg = 2
period_s = 5
harmonics = [1, 3, 5, 7, 9, 11, 13]
duration_s = 20
moving_in_s = 2
[participant]                   # with [device] in its place, your own robot and a real person
kind = "arm"
number = 1
shoulder_mm = [300, -570]
[[trial]]
name = "left"
[[trial]]
name = "right"
[trial.robot]
home_mm = [330, -50]
)";

int report(const mbk::Error& error) {
  std::fprintf(stderr, "%s\n", error.line().c_str());
  return 1;
}

/// Receives the results and decides what comes next.
class Conductor : public mbk::session::Operator {
 public:
  mbk::Result<void> judged(const mbk::session::Performed& performed) override {
    const mbk::session::TrialOutcome& outcome = performed.outcome;
    std::printf("%s: %llu ticks, motors %s\n", outcome.recording.filename().c_str(),
                static_cast<unsigned long long>(outcome.times.ticks),
                std::string(mbk::word_of(outcome.motors.state)).c_str());
    if (performed.measured && *performed.measured) {
      const mbk::Matrix& K = (*performed.measured)->identification.model.K;
      std::printf("  K %.1f %.1f %.1f %.1f N/m\n", K(0, 0), K(0, 1), K(1, 0), K(1, 1));
    }
    return {};
  }

  mbk::session::Next next(mbk::session::Session& session, const mbk::session::Performed& performed) override {
    if (performed.poor() && repeated_ != performed.attempt.index) {
      repeated_ = performed.attempt.index;
      return mbk::session::Next::repeat;
    }
    return Operator::next(session, performed);  // ends after a stop, otherwise continues
  }

 private:
  std::size_t repeated_ = static_cast<std::size_t>(-1);
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: run_a_study FOLDER\n");
    return 2;
  }
  const auto trials = mbk::protocol::read_experiment(kExperiment, "two_places.toml", mbk::laboratory::read_simulation);
  if (!trials) return report(trials.error());

  // Each trial is planned once; a plan that exceeds a limit of the gate is refused here, before anything moves.
  const std::filesystem::path folder = argv[1];
  const auto experiment = mbk::session::plan_experiment(*trials, folder / "p07.h5", "two_places.toml");
  if (!experiment) return report(experiment.error());
  for (const mbk::session::Plan& plan : experiment->plans) {
    const auto rehearsal = mbk::session::rehearse(plan);
    if (!rehearsal) return report(rehearsal.error());
    std::printf("%s: %.1f s, at most %.1f of %.0f N at the handle\n", plan.trial.name.c_str(), rehearsal->duration,
                rehearsal->handle_force, plan.limits.handle_force);
  }

  mbk::session::Session session({.virtual_clock = true});  // without it, in real time
  Conductor conductor;
  const mbk::session::Conclusion conclusion = mbk::session::conduct(*experiment, session, conductor);
  if (conclusion.failure) return report(*conclusion.failure);
  std::printf("%s\n", conclusion.completed ? "completed" : "ended early");
  return conclusion.completed ? 0 : 1;
}
