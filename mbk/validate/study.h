#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/validation_table.h"
#include "mbk/validate/rows.h"

namespace mbk::validation {

/// Has work(i), i = 0 … count − 1, done in other processes, and says what each gave, as bytes (each_run.h).
using Elsewhere =
    std::function<Result<std::vector<std::string>>(int count, const std::function<Result<std::string>(int)>& work)>;

/// How large a study is made.
struct StudyOptions {
  int runs = 1;  ///< seeds; what a run is stands at each study
  std::uint64_t seed = 1;
  unsigned threads = 0;                                 ///< 0: as many as there are cores
  std::function<void(int done, int of)> progress = {};  ///< called after each trial, never two at a time
  Elsewhere elsewhere = {};                             ///< absent: all is done in this process
};

/// A method against known truth, by its name on the command line.
struct Study {
  std::string_view name;
  std::string_view what;                ///< one line for the help
  std::span<const JudgedShare> shares;  ///< that decide how many runs it needs
  int usual_runs;                       ///< where the shares need fewer
  Result<ValidationTable> (*perform)(const StudyOptions&);
};

/// With fewer runs some row cannot be met, whatever comes out: of a share it follows from its interval, and a mean or a
/// spread takes two.
[[nodiscard]] int min_runs(const Study& study);

/// So many by default: with them every share that is as it should be is met with 99.9 %.
[[nodiscard]] int default_runs(const Study& study);

/// All of them.
[[nodiscard]] std::span<const Study> studies();

/// How often do the nominal 95 % intervals of M, B, K and x₀ hold the truth? A run is one recording of a prescribed
/// motion with coloured force noise of 0.3 N (coverage.h).
/// @fails  runs < 1; as the laboratory and the measurement. The same for the others.
[[nodiscard]] Result<ValidationTable> coverage_study(const StudyOptions& options);

/// Three axes: how often the 95 % intervals of the 30 numbers and of the ellipsoids hold the truth, and how often a
/// recording that is not what it should be is told: a force sensor turned about any axis, an axis that hardly moved, an
/// active arm, too little excitation. A run is one prescribed motion of each.
[[nodiscard]] Result<ValidationTable> spatial_study(const StudyOptions& options);

/// Bias, spread and coverage of M, B, K and x₀ of a relaxed arm in the closed loop, with sinusoidal and with
/// underdamped perturbations: the ready scenarios, measured by the default pipeline. A run is one seed of each.
/// Expected is a bias below 5 % of the largest element of the matrix, and below 2 mm for x₀.
[[nodiscard]] Result<ValidationTable> recovery_study(const StudyOptions& options);

/// How often do the 95 % intervals of M, B and K hold the truth while the trial still runs, as the console shows them?
/// The ready scenario of a relaxed arm passes the whole session, whose ticks come in blocks as the recorder hands them
/// on; the live estimate is taken 10, 15, 20 and 40 s after the perturbation began. A run is one seed. Expected is 90 %
/// on average over the twelve numbers at each time; each of them is judged too.
[[nodiscard]] Result<ValidationTable> live_estimate_study(const StudyOptions& options);

/// Stiffness and mass of the rigs of Dyck (2013), tables 3.1 and 5.1, as they are identified against what they are
/// (fig. 3.8, table 5.4 and fig. 5.4 in form), for linear rigs and for arrays of real springs. A run is one seed of
/// each of their trials.
[[nodiscard]] Result<ValidationTable> springs_study(const StudyOptions& options);

/// Does the simulated participant behave as people did (Dyck 2013, figs 4.3–4.5, tables 4.1–4.3 in form)? The ready
/// scenarios, three arms, seed after seed: does the energy that the limb absorbed rise, and how much of the force does
/// a fitted M, B, K explain (published procedure)? The same arm and controller face 2 N and 8 N pulses, which differ in
/// `amplitude_N` alone; between them the energy crosses zero at an amplitude that is found by interpolation and drawn.
/// A run is one seed of every arm and condition.
[[nodiscard]] Result<ValidationTable> participant_study(const StudyOptions& options);

/// Verdicts on passivity compared with the truth: relaxed arms under several perturbations, and rigid arms that respond
/// to 2 N pulses and generate energy. A run is one trial of each. Expected: never "active" of a relaxed arm, by the
/// model or, where it absorbed energy, by the energy; always by the energy of the others.
[[nodiscard]] Result<ValidationTable> passivity_study(const StudyOptions& options);

/// Where M, B and K do not hold: conditions of limb, grip, sensors and clock, each by its mechanism in the laboratory,
/// beside conditions in which they hold. Is it said, how often do the intervals hold the truth, and how far is what was
/// found from it? A run is one trial of each. Expected: a warning nearly always where one recording can show what is
/// wrong, and hardly ever where nothing is.
/// @param only  conditions by name; empty: all of them
/// @fails  usage: a name that no condition has
[[nodiscard]] Result<ValidationTable> misspecification_study(const StudyOptions& options,
                                                             std::span<const std::string> only = {});

/// Trials without the voluntary controller in each run of closed_loop_study, each measured by itself.
inline constexpr int kTrialsWithoutController = 16;

/// Where the limb acts back on its own motion: does least squares call a passive arm active, do instrumental variables
/// not, and what does the energy say (Dyck 2013, table 4.3)? A run is three pooled trials of a rigid arm under a 6 N
/// multisine and three under 2 N pulses, and kTrialsWithoutController of the same arm with the voluntary controller
/// off.
[[nodiscard]] Result<ValidationTable> closed_loop_study(const StudyOptions& options);

/// The dynamics of the robot of Dyck (2013), table A.1, with Coulomb friction, identified from its free motion by
/// measurement::identify_robot as it is by default: bias and coverage of every coefficient, held-out torque, the
/// printed Coriolis sign against the right one, and what it does to leave Coulomb friction out. A run is one free
/// motion with its own phases and noise. Expected: inertias within 0.5 % and a VAF of 99 % nearly always, and that the
/// printed sign leaves at least twice as much torque.
[[nodiscard]] Result<ValidationTable> robot_study(const StudyOptions& options);

/// Force, stiffness and mass of the rigs of Dyck (2013), table 5.1, without a force sensor (tables 5.4 and 5.5 and
/// fig. 5.4 in form): against the truth and the sensor, with the robot's friction in the model and left out, by the
/// momentum observer, and with elastic drives. A run is one identified robot and one seed of each rig. Expected: a
/// force within 0.05 N (RMSE) for every rig, stiffness and mass within a quarter of the errors in table 5.4.
[[nodiscard]] Result<ValidationTable> virtual_sensor_study(const StudyOptions& options);

/// The system of Rao & Garnier (2002), four poles and a zero on the right, by identify_transfer_function as it is by
/// default under white noise of a tenth of the output's variance: bias and coverage of every coefficient, and whether
/// the order is found. A run is one input and one noise. Expected: a bias below 1 %, the order in 90 % of the runs.
[[nodiscard]] Result<ValidationTable> transfer_function_study(const StudyOptions& options);

/// Frequency responses without a model (measure/explore) of a simulated arm in two axes, at a robot that is stiff and
/// at one that yields, so that the arm's own noise moves the hand: how often the 95 % regions and intervals hold the
/// truth by periods and realisations, by one pair of realisations, and by local polynomials; whether a linear arm is
/// called nonlinear, and an arm that hardens by 2·10⁵ N/m³ is. A run is one set of trials of each. Expected: coverage
/// of 92 to 98 %; at the stiff robot a variance over realisations of a linear arm within 10 % of that of noise.
[[nodiscard]] Result<ValidationTable> frequency_response_study(const StudyOptions& options);

/// Stiffness from ramps and holds (measure/explore) of the ready scenario relaxed_ramp_and_hold, with shorter holds and
/// pauses: bias and coverage of each entry of K, of the antisymmetric part and of the ellipse, and whether a window in
/// which the hand still moves is refused. A run is one recording of 80 ramps. Expected: a median error of K of 5 % of
/// its norm at most, a bias below 1 % of the largest entry, coverage of 92 to 98 %.
[[nodiscard]] Result<ValidationTable> ramp_and_hold_study(const StudyOptions& options);

/// Stretches at five constant velocities, five times each (measure/explore/stretch.h), of a simulated relaxed elbow and
/// of one with a stretch reflex: coverage of the slope over speed and of the angle of catch, and how often a healthy
/// limb is called velocity-dependent. A run is one limb of each kind. Expected: coverage of 92 to 98 %, at most 5 %.
[[nodiscard]] Result<ValidationTable> stretch_study(const StudyOptions& options);

/// Stiffness of a hand that reaches, displaced by 8 mm relative to a prediction of its own way (measure/explore), of
/// simulated reaches that differ in duration, length, bend and target (simulated_reaches.h): bias and coverage of each
/// entry of K with the prediction from the reach's own past, and for comparison with the mean of the undisturbed
/// reaches subtracted. A run is 40 undisturbed reaches and 80 displaced ones. Expected: coverage of 92 to 98 %, a bias
/// below 2 % of the largest entry, a median error of 10 % of the norm of K at most.
[[nodiscard]] Result<ValidationTable> servo_displacement_study(const StudyOptions& options);

/// Does a linear time-invariant model hold for a rigid arm along one axis (Dyck 2013, §4.4.2: table 4.4 and fig. 4.7 in
/// form)? The ready scenario one_axis_random_binary, ±2 N: output-error models of 4 poles and 3 zeros from place to
/// force, judged on the last 10 s of each trial and on the other trials; beside it the same arm with its controller
/// off, and relaxed, for several switching times of the force. A run is five trials of each. Expected: a
/// median VAF of at least 90 % for the other two, and at every switching time less for the rigid arm, with at least
/// three times as much unexplained as without its controller.
[[nodiscard]] Result<ValidationTable> one_dimensional_study(const StudyOptions& options);

/// Impulse responses and reflexes of limbs whose force is known in closed form (simulated_limbs.h), by
/// explore::impulse_response and explore::parallel_cascade: how often the intervals of M, B, K, of the reflex's gain
/// and its second-order response hold the truth, how often M-B-K is said not to be enough of a limb that is no more,
/// and how often a limb without a reflex is credited with one: M-B-K alone, with a slow linear response beside it, with
/// a hardening spring. A run is one record of each limb.
[[nodiscard]] Result<ValidationTable> reflex_study(const StudyOptions& options);

/// M, B and K over time (explore::time_course) of a relaxed arm in the closed loop: how often an arm is called changing
/// whose stiffness is constant, also while the zero of the force drifts, and whose stiffness triples, doubles slowly or
/// swings; and how far its course is off. A run is one trial of each. Expected: hardly ever, nearly always, and of the
/// stiffness that triples a course within 15 %.
[[nodiscard]] Result<ValidationTable> change_study(const StudyOptions& options);

/// M, B and K from the first 120 ms after the onsets of pulses (explore::after_onset), of a rigid arm that 1, 10 and 40
/// pooled trials of 8 N moved, and 10 of 2 N: how far they are from the truth, and whether a matrix that is called
/// identifiable is. A run is 40 trials of 8 N and 10 of 2 N. Expected: of M within 25 % of the norm and of K within 45
/// % wherever it is called identifiable, and that ten trials of 8 N tell M.
[[nodiscard]] Result<ValidationTable> after_onset_study(const StudyOptions& options);

/// EMG responses after a perturbation (measure/explore/emg_responses.h), of noise between 20 and 450 Hz whose amplitude
/// doubles 25 to 45 ms after the onset, for 10, 20 and 40 trials: error and coverage of the latency, coverage of the
/// ratios in the three windows, and how often a response is found where there is none. A run is one recording of each
/// with a response and one without. Expected: latencies within 3 ms, coverage of 92 to 98 %, hardly ever a response
/// where there is none.
[[nodiscard]] Result<ValidationTable> emg_study(const StudyOptions& options);

/// How often do the intervals of intraclass correlations, standard errors of measurement, limits of agreement and
/// effect sizes (study/reliability) hold the truth, and how often are groups called different that are alike? A run is
/// one study of 20 people in three sessions of each kind, drawn from known variances: balanced, with trials and
/// sessions missing, with known variances of each value. Expected: coverage of 92 to 98 %, a mean MDC within 5 %, 3.5
/// to 6.5 % of false positives at 5 %.
[[nodiscard]] Result<ValidationTable> reliability_study(const StudyOptions& options);

/// Does a study say of its recordings what is true of the people in it? A run is a study of 20 people in three sessions
/// with a simulated recording in each, measured and summed up as `mbk study` does. Expected: a mean ICC(A,1) within 0.1
/// and a mean MDC within 10 % of what the same people's true stiffness and the errors of their measurements come to.
[[nodiscard]] Result<ValidationTable> recorded_reliability_study(const StudyOptions& options);

/// Do teleoperators behave in time as Llewellyn's and the modified criterion say? A run is a random design of each of
/// the four architectures, half of them with delay, with random terminations where it is stable, and by the
/// terminations that teleop::worst_terminations constructs where it is not; each with a passive operator, with one who
/// has an excess of passivity and with one who has a shortage. The controllers are sampled at 1 kHz. Expected: nothing
/// that is stable, as designed and with sampling, grows; everything that is constructed grows, at its frequency.
/// Besides, the passivity controller at a virtual wall.
[[nodiscard]] Result<ValidationTable> teleoperation_study(const StudyOptions& options);

/// Whatever breaks, are the motors off in time? Each kind of fault (fault_kinds.h) comes into a trial of positions and
/// one of forces at a moment drawn by lot, through the robot, another thread or the clock, and passes the whole
/// session. Expected in every run: motors off within the documented ticks, for a right reason, no command beyond the
/// cap of the handle force by the true angles, a recording that holds every command to the bit; and not one trip in ten
/// times as many trials without a fault, over the ready scenarios. A run is one moment of each kind in both trials.
[[nodiscard]] Result<ValidationTable> faults_study(const StudyOptions& options);

}  // namespace mbk::validation
