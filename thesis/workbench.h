#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <typeindex>
#include <typeinfo>
#include <utility>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/model/impedance/model.h"
#include "mbk/model/trial/energy.h"
#include "mbk/model/trial/identification.h"
#include "mbk/model/trial/recording.h"
#include "mbk/present/result/json.h"
#include "mbk/simulate/laboratory/scenario.h"
#include "mbk/validate/one_dimensional_trial.h"
#include "thesis/source.h"

namespace mbk::thesis {

/// What a participant was asked to do, and by what the hand was perturbed.
enum class Task { relaxed_sinusoidal, relaxed_underdamped, rigid_underdamped, rigid_sinusoidal };

/// The ready scenario of a task (laboratory/ready_scenarios.h).
[[nodiscard]] const char* scenario_of(Task task);

/// "relaxed, sinusoidal"
[[nodiscard]] const char* text(Task task);

/// Which of the six simulated participants did it: as many as in the source.
[[nodiscard]] std::vector<int> participants_of(Task task);

inline constexpr int kTrials = 4;             ///< of each participant and task (Dyck 2013, §3.4.2, §4.1)
inline constexpr double kHandleMass = 0.194;  ///< Λ, the wrist support [kg] (§3.5.2)

/// One trial by the published procedure, sample for sample.
struct TaskTrial {
  Identification identification;
  Energy energy;
  bool passive_by_model = false;  ///< theorem 3.2 as it was applied: estimates, symmetric parts only
};

/// All trials of one participant at one task.
struct TaskResult {
  int participant = 1;
  impedance::Model truth;  ///< of the limb, mean over the trials
  std::vector<TaskTrial> trials;
  Recording first;     ///< of these
  Measurement pooled;  ///< all of them in one fit, by mbk's own procedure

  /// Of the pooled trials: the model that a method found, or the only one there is.
  [[nodiscard]] const Identification& by(Method method) const;
  /// The passivity of that model; nullptr where it was not judged.
  [[nodiscard]] const ModelPassivity* passivity_by(Method method) const;
};

/// One trial of a rigid grasp along one axis (§4.4.2).
struct OneAxisGrasp {
  double vaf = 0.0;  ///< of the last part [%]
  validation::one_dimensional::ValidationOutput output;
  Recording recording;
};

/// Shortest time for which the force along one axis keeps its sign [s]. The source does not give it.
inline constexpr double kSwitchingTime = 4.0;

struct WorkbenchOptions {
  std::uint64_t seed = 1;
  unsigned threads = 0;  ///< 0: as many as there are cores; the numbers do not depend on it
};

/// What several exhibits rest on: the numbers that are given, and simulated trials, which are made when they are first
/// asked for. Not for several threads.
class Workbench {
 public:
  Workbench(Given given, WorkbenchOptions options) : given_(std::move(given)), options_(options) {}

  [[nodiscard]] const Given& given() const { return given_; }
  [[nodiscard]] const WorkbenchOptions& options() const { return options_; }

  /// The seed of a trial (1, 2, …) of a participant, the same for every task.
  [[nodiscard]] std::uint64_t seed(int participant, int trial) const;

  /// Everyone's trials of a task. They stay where they are.
  /// @fails  as simulate and measure
  [[nodiscard]] Result<const std::vector<TaskResult>*> results(Task task);

  /// What `make` gives, made when a T is first asked for. It stays where it is.
  /// @fails  as `make`
  template <class T>
  [[nodiscard]] Result<const T*> once(Result<T> (*make)(Workbench&)) {
    std::shared_ptr<const void>& kept = kept_[typeid(T)];
    if (kept == nullptr) {
      auto made = MBK_TRY(make(*this));
      kept = std::make_shared<const T>(std::move(made));
    }
    return static_cast<const T*>(kept.get());
  }

  /// The five trials of the ready scenario one_axis_random_binary. They stay where they are.
  /// @fails  as simulate and one_dimensional::attempted
  [[nodiscard]] Result<const std::vector<OneAxisGrasp>*> one_axis_grasps();

 private:
  Given given_;
  WorkbenchOptions options_;
  std::map<Task, std::vector<TaskResult>> results_;
  std::map<std::type_index, std::shared_ptr<const void>> kept_;
};

/// The scenario of a task as a participant does it.
/// @param participant  1 … 6
/// @fails  as participant::participant_limb
[[nodiscard]] Result<laboratory::Scenario> task_scenario(Task task, int participant, std::uint64_t seed);

}  // namespace mbk::thesis
