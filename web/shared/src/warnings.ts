// Titles and meanings of warnings.
import type { WarningCode } from "./documents";

/** For each warning: a title, and its consequence for the numbers. */
export type PlainWarnings = Record<WarningCode, { title: string; meaning: string }>;

export const plainWarnings: PlainWarnings = {
  "force-sign-reversed": {
    title: "The force was probably recorded with the opposite sign",
    meaning: "Inertia, damping and stiffness are all negative, which is impossible for a limb. The recording itself is probably fine.",
  },
  "implausible-scale": {
    title: "Motion, force or model have a size that no limb has",
    meaning: "A channel was probably read in the wrong unit, such as millimetres as metres. The numbers are not those of this limb.",
  },
  "axes-scaled-differently": {
    title: "One axis seems to have another unit or gain than the other",
    meaning: "The coupling from x to y differs greatly from that from y to x, which is impossible for a limb. The numbers are not those of this limb.",
  },
  "axes-mismatched": {
    title: "Force and motion do not belong to the same axes",
    meaning: "An axis was probably flipped or two columns were swapped: as given, the model is impossible for a limb; with another order or sign it is plausible.",
  },
  "inertia-not-symmetric": {
    title: "The inertia matrix is not symmetric",
    meaning: "The inertia of every limb is symmetric. The force sensor is probably rotated relative to the position axes, or one axis has a wrong gain. All numbers are biased.",
  },
  "same-column": {
    title: "Two channels are one column",
    meaning: "The same data were used for two quantities. The numbers are not those of this limb.",
  },
  "other-column": {
    title: "A channel was read from a column with another name",
    meaning: "Check that the channels were mapped to the columns that the file describes.",
  },
  "consistent-fit-poor": {
    title: "A physically consistent robot explains the torques much less well",
    meaning: "A torque was probably recorded with the opposite sign or in another unit, or part of the robot is missing from its description.",
  },
  "low-coherence": {
    title: "Little of the force follows the motion",
    meaning: "At these frequencies the response is mostly noise, or the limb is not linear.",
  },
  "few-realisations": {
    title: "Few realisations of the perturbation",
    meaning: "The uncertainty of the response is itself poorly known, so the intervals are wide.",
  },
  "nonlinear-distortion": {
    title: "The limb is not linear",
    meaning: "The response holds for a perturbation of this size and kind only.",
  },
  "elastic-drive": {
    title: "The drive of a joint is elastic",
    meaning: "Motor and link of the robot twist relative to each other, as if joined by a spring. This biases the estimated inertia and friction of the robot.",
  },
  "robot-changed": {
    title: "The robot has changed since it was identified",
    meaning: "The force was computed from a model of the robot, and the recording contradicts that model: friction, load or torque has changed. The change is included in the damping, inertia and stiffness shown.",
  },
  "backlash": {
    title: "The drive of a joint has backlash",
    meaning: "When the torque of the joint reverses, the motor briefly moves without the link. This biases the estimated inertia and friction of the robot.",
  },
  "excluded-trial": {
    title: "The operator excluded this trial",
    meaning: "The person who made the recording excluded it from the analysis. The recording contains the reason.",
  },
  "excluded-window": {
    title: "A part that the operator excluded was measured too",
    meaning: "The published procedure always uses its whole window. Default mode omits the excluded part.",
  },
  "handle-mass-too-large": {
    title: "The subtracted handle mass exceeds the measured inertia",
    meaning: "The remaining inertia is impossible for a limb.",
  },
  "missing-dynamics": {
    title: "Part of the force is not explained by inertia, damping and stiffness",
    meaning: "Force and position may not be synchronised, the grip may have yielded, or the limb responded after a delay. The numbers are biased.",
  },
  "nonlinear-stiffness": {
    title: "The stiffness depends on the size of the motion",
    meaning: "The stiffness holds for motion of this size only.",
  },
  "dry-friction": {
    title: "There is dry (Coulomb) friction",
    meaning: "Part of it is attributed to damping and stiffness, which are therefore biased.",
  },
  "stiffness-changes": {
    title: "The stiffness of the limb changed during the recording",
    meaning: "The numbers are averages over different states.",
  },
  "damping-changes": {
    title: "The damping of the limb changed during the recording",
    meaning: "The numbers are averages over different states.",
  },
  "memory": {
    title: "The force relaxes after a displacement",
    meaning: "Part of the force lags behind the position by up to seconds, so the stiffness depends on how fast the limb is moved.",
  },
  "even-nonlinearity": {
    title: "The limb responds differently in opposite directions",
    meaning: "Stiffness, damping or a reflex is stronger in one direction. The numbers are averages of both directions, and the equilibrium is biased.",
  },
  "lack-of-fit": {
    title: "The model does not fit at the frequencies of the perturbation",
    meaning: "The difference repeats in every period, so it is not noise. Inertia, damping and stiffness do not describe the limb at each frequency.",
  },
  "contact-lost": {
    title: "The force suddenly vanished while the motion continued",
    meaning: "The hand probably left the handle, or the force sensor failed. The model describes neither the arm nor the empty handle.",
  },
  "force-drifts": {
    title: "The force drifted during the recording",
    meaning: "The equilibrium position of the hand or the zero of the force sensor shifted. The equilibrium shown is an average.",
  },
  "tremor": {
    title: "Tremor was detected",
    meaning: "The force contains a rhythm that the perturbation did not cause. It biases the least-squares results.",
  },
  "inertia-not-positive": {
    title: "The inertia is impossible",
    meaning: "In some direction the inertia is zero or negative. The numbers are not those of a limb.",
  },
  "damping-not-positive": {
    title: "The damping is negative in some direction",
    meaning: "The limb appears to feed energy into the robot. It may have acted voluntarily or by reflex, or force and position are not synchronised.",
  },
  "stiffness-not-positive": {
    title: "The stiffness is impossible for a limb at rest",
    meaning: "In some direction the limb would push itself away from its equilibrium. The numbers are not those of a passive limb.",
  },
  "band-too-narrow": {
    title: "The motion was too slow, or the filter too strong, to identify the inertia",
    meaning: "The stiffness may be correct although the inertia is not.",
  },
  "motion-on-one-line": {
    title: "The hand moved along one line only",
    meaning: "Nothing can be concluded about the direction in which it hardly moved.",
  },
  "motion-too-small": {
    title: "The hand hardly moved",
    meaning: "The motion is close to the resolution of the position sensor, so the numbers are coarse.",
  },
  "poorly-conditioned": {
    title: "The motion was too simple to identify inertia, damping and stiffness separately",
    meaning: "Inertia, damping and stiffness cannot be distinguished reliably.",
  },
  "held-out-fit-poor": {
    title: "The model fits the held-out (validation) data less well",
    meaning: "The limb probably changed during the trial, or there is too little data.",
  },
  "fit-poor": {
    title: "Much of the force is not explained",
    meaning: "The limb may have acted voluntarily or by reflex. Do not interpret the numbers as those of a relaxed limb.",
  },
  "no-held-out-data": {
    title: "The fit was evaluated on the data used for fitting",
    meaning: "It looks better than it would on new data.",
  },
  "clock-jitter": {
    title: "The clock of the recording was not steady",
    meaning: "The samples were interpolated linearly to a uniform clock, or treated as uniform if the motion shows that they were; the message says which.",
  },
  resampled: {
    title: "The recording was resampled to a uniform clock",
    meaning: "Values between the samples are linearly interpolated, not measured.",
  },
  "held-signal": {
    title: "A channel was updated more slowly than it was recorded",
    meaning: "Each value repeats until the next measurement. The channel was interpolated between its measurements; the message gives the update rate.",
  },
  "missing-samples": {
    title: "Samples of a channel are missing",
    meaning: "Repeated or constant values fill the gaps. They were replaced by interpolation, or left empty if the gap is long.",
  },
  clipping: {
    title: "A sensor was saturated",
    meaning: "Parts of the signal are cut off, which distorts the numbers.",
  },
  "too-little-data": {
    title: "The recording is short",
    meaning: "The ± intervals cannot be trusted.",
  },
  "decimation-changes-model": {
    title: "The result depends on the sample rate",
    meaning: "The signals contain fast components that do not come from the limb.",
  },
  "torque-unit": {
    title: "The torques are probably in another unit",
    meaning: "With the units as read, the robot would be a thousand times too heavy or too light.",
  },
  "residual-not-white": {
    title: "The residual is not white noise",
    meaning: "The ± intervals assume that it is, and are too narrow.",
  },
  "input-explains-residual": {
    title: "The model misses part of the response to the input",
    meaning: "Part of the output follows the input but is not in the model: faster or slower dynamics, or a delay.",
  },
  "pole-outside-band": {
    title: "The model has a pole outside the excited band",
    meaning: "The input hardly excited the system there, so this part of the model is extrapolated.",
  },
  "delay-at-limit": {
    title: "The delay may be longer",
    meaning: "The longest delay that was tried fits best, so neither the delay nor the model is reliable.",
  },
  "uneven-clock": {
    title: "The samples are unevenly spaced",
    meaning: "The model allows for it; the tests of the residual do not.",
  },
  "closed-loop-bias": {
    title: "Least squares is biased here",
    meaning: "Limb and robot move each other. Instrumental variables, which use only the motion caused by the known perturbation, give a different model.",
  },
  "no-reference": {
    title: "The reference (the robot's command) was not recorded",
    meaning: "If the limb itself moved the robot, these numbers are biased, and this recording cannot show it. The measured energy remains valid.",
  },
  "unmodelled-response": {
    title: "The limb responded to the perturbation",
    meaning: "The response was voluntary or a reflex. Part of it looks like mechanics and is included in the numbers.",
  },
  "weak-instruments": {
    title: "The perturbation moved the limb too little for this method",
    meaning: "The ± intervals of instrumental variables are not valid.",
  },
  "invalid-instruments": {
    title: "Instrumental variables are not valid here",
    meaning: "The limb responded to each pulse, and the method attributes that response to mechanics.",
  },
  "mixed-conditions": {
    title: "Different conditions were measured as one",
    meaning: "The recordings are of different people, conditions or postures; a common model may describe none of them.",
  },
};
