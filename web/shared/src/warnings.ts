// Warnings in plain words.
import type { WarningCode } from "./documents";

/** For each warning a title that needs no training, and what it means for whoever reads the numbers. */
export type PlainWarnings = Record<WarningCode, { title: string; meaning: string }>;

export const plainWarnings: PlainWarnings = {
  "force-sign-reversed": {
    title: "The force was recorded with the opposite sign",
    meaning: "Everything comes out negative, which no limb can be. The recording itself is probably fine.",
  },
  "implausible-scale": {
    title: "Motion, force or model have a size that no limb has",
    meaning: "A channel was probably read in the wrong unit, such as millimetres as metres. The numbers are not those of this limb.",
  },
  "axes-scaled-differently": {
    title: "One axis seems to have another unit or gain than the other",
    meaning: "The two directions answer each other very unequally, which no limb does. The numbers are not those of this limb.",
  },
  "axes-mismatched": {
    title: "Force and motion do not belong to the same axes",
    meaning: "An axis was probably flipped or two columns swapped: with another order or sign the model is that of a limb, as given it is not.",
  },
  "inertia-not-symmetric": {
    title: "The inertia is not symmetric, as that of every limb is",
    meaning: "The force is probably turned against the position, or one of its axes has a wrong gain. All numbers are biased.",
  },
  "same-column": {
    title: "Two channels are one column",
    meaning: "The same data stand for two quantities. The numbers are not those of this limb.",
  },
  "other-column": {
    title: "A channel was read from a column with another name",
    meaning: "Check that the columns were named as the file means them.",
  },
  "consistent-fit-poor": {
    title: "No robot that can exist explains the torques as well",
    meaning: "A torque was probably recorded with the opposite sign or in another unit, or part of the robot is missing from its description.",
  },
  "low-coherence": {
    title: "Little of the force follows the motion",
    meaning: "At these frequencies the response is mostly noise, or the limb is not linear.",
  },
  "few-realisations": {
    title: "Few realisations of the perturbation",
    meaning: "How sure the response is, is itself not well known: the intervals are wide.",
  },
  "nonlinear-distortion": {
    title: "The limb is not linear",
    meaning: "The response holds for a perturbation of this size and kind only.",
  },
  "elastic-drive": {
    title: "The drive of a joint bends",
    meaning: "Motor and link of the robot turn against each other as on a spring. Its inertia and friction are biased by that.",
  },
  "robot-changed": {
    title: "The robot is not as it was identified",
    meaning: "The force was computed from a model of the robot, and the recording contradicts that model: its friction, load or torque has changed since. What changed is part of the damping, inertia and stiffness shown.",
  },
  "backlash": {
    title: "The drive of a joint has play",
    meaning: "Wherever the torque of the joint turns round, the motor moves for a moment without the link. Inertia and friction of the robot are biased by that.",
  },
  "excluded-trial": {
    title: "The operator excluded this trial",
    meaning: "Whoever made the recording did not want it to count. The reason stands in it.",
  },
  "excluded-window": {
    title: "A part that the operator excluded was measured too",
    meaning: "The published procedure takes its own window whole. Default mode leaves the excluded part out.",
  },
  "handle-mass-too-large": {
    title: "More handle mass was subtracted than was measured",
    meaning: "The inertia that is left is not that of a limb.",
  },
  "missing-dynamics": {
    title: "The force does something that inertia, damping and stiffness do not",
    meaning: "Force and position may not have been recorded at the same time, the grip may have yielded, or the limb responded after a delay. The numbers are biased.",
  },
  "nonlinear-stiffness": {
    title: "The limb is not equally stiff in small and large motion",
    meaning: "The stiffness holds for motion of this size only.",
  },
  "dry-friction": {
    title: "There is friction that does not depend on speed",
    meaning: "Part of it stands in the damping and the stiffness, which are biased.",
  },
  "stiffness-changes": {
    title: "The limb became stiffer or softer during the recording",
    meaning: "The numbers are means over states that differ.",
  },
  "damping-changes": {
    title: "The damping of the limb changed during the recording",
    meaning: "The numbers are means over states that differ.",
  },
  "memory": {
    title: "The force relaxes after a displacement",
    meaning: "Part of the force lags behind the position by up to seconds, so the stiffness depends on how fast the limb is moved.",
  },
  "even-nonlinearity": {
    title: "The limb does not respond alike in opposite directions",
    meaning: "Stiffness, damping or a reflex act more in one direction. The numbers are means of both, and the equilibrium is biased.",
  },
  "lack-of-fit": {
    title: "Inertia, damping and stiffness do not fit at the frequencies of the perturbation",
    meaning: "The difference is the same in every period, so it is not noise. The numbers do not hold at each frequency.",
  },
  "force-drifts": {
    title: "The force drifted from beginning to end",
    meaning: "The hand's place of rest moved, or the zero of the force sensor did. The equilibrium is a mean.",
  },
  "tremor": {
    title: "The limb trembled",
    meaning: "A rhythm of its own stands in the force and biases the numbers of least squares.",
  },
  "inertia-not-positive": {
    title: "The inertia is impossible",
    meaning: "In some direction the limb would have no mass or less than none. The numbers are not those of a limb.",
  },
  "damping-not-positive": {
    title: "The damping is negative in some direction",
    meaning: "The limb seems to feed energy into the robot. It may have acted or responded by reflex, or force and position were not recorded at the same time.",
  },
  "stiffness-not-positive": {
    title: "The stiffness is impossible for a limb at rest",
    meaning: "In some direction the limb would push itself away from where it rests. The numbers are not those of a passive limb.",
  },
  "band-too-narrow": {
    title: "The motion was too slow, or the filter too strong, to see the inertia",
    meaning: "Stiffness may be right while the inertia is not.",
  },
  "motion-on-one-line": {
    title: "The hand moved along one line only",
    meaning: "Nothing can be said about the direction in which it hardly moved.",
  },
  "motion-too-small": {
    title: "The hand hardly moved",
    meaning: "The motion is close to the smallest step that the sensor can tell, so the numbers are coarse.",
  },
  "poorly-conditioned": {
    title: "The motion was too simple to identify inertia, damping and stiffness separately",
    meaning: "Each of the three could stand in for another.",
  },
  "held-out-fit-poor": {
    title: "The model does worse on the part of the recording that was held out",
    meaning: "The limb probably changed during the trial, or there is too little data.",
  },
  "fit-poor": {
    title: "Much of the force is not explained",
    meaning: "The limb may have acted by will or by reflex. Do not read the numbers as those of a relaxed limb.",
  },
  "no-held-out-data": {
    title: "The fit was judged on the data that made it",
    meaning: "It looks better than it would on new data.",
  },
  "clock-jitter": {
    title: "The clock of the recording was not steady",
    meaning: "The samples were put on an even clock by straight lines between them, or taken as even where the motion shows that they were; the message says which.",
  },
  resampled: {
    title: "The recording was put on an even clock first",
    meaning: "Between the samples there are straight lines, which nobody measured.",
  },
  "held-signal": {
    title: "A channel was recorded more often than it was measured",
    meaning: "Each value repeats until the next one. The channel was interpolated between its own samples; the message says how often it was measured.",
  },
  "missing-samples": {
    title: "Samples of a channel are missing",
    meaning: "Repeated or constant values stand where nothing was measured. They were interpolated from their neighbours, or left empty where the gap is long.",
  },
  clipping: {
    title: "A sensor was at its limit",
    meaning: "Parts of the signal are cut off, and the numbers suffer from it.",
  },
  "too-little-data": {
    title: "The recording is short",
    meaning: "The ± intervals cannot be trusted.",
  },
  "decimation-changes-model": {
    title: "The result depends on the sample rate",
    meaning: "There is something fast in the signals that does not belong to the limb.",
  },
  "torque-unit": {
    title: "The torques are probably in another unit",
    meaning: "As they are read, the robot would be a thousand times too heavy or too light.",
  },
  "residual-not-white": {
    title: "The residual is not white noise",
    meaning: "The ± intervals take it as that, and are narrower than they should be.",
  },
  "input-explains-residual": {
    title: "The model misses a part of what the input does",
    meaning: "Something of the output follows the input and is not in the model: a faster or slower part, or a delay.",
  },
  "pole-outside-band": {
    title: "The model says something about frequencies to which it was not fitted",
    meaning: "The input hardly moved the system there, so that this part is a guess by the form of the model.",
  },
  "delay-at-limit": {
    title: "The delay may be longer",
    meaning: "Of all delays that were tried the longest fits best, so that neither it nor the model is found.",
  },
  "uneven-clock": {
    title: "The samples are unevenly spaced",
    meaning: "The model allows for it; the tests of the residual do not.",
  },
  "closed-loop-bias": {
    title: "Least squares is biased here",
    meaning: "The limb and the robot move each other. What follows the known perturbation alone gives another model: that of instrumental variables.",
  },
  "no-reference": {
    title: "What the robot was told to do was not recorded",
    meaning: "If the limb itself moved the robot, these numbers are biased, and nothing shows it. The energy that was measured holds all the same.",
  },
  "unmodelled-response": {
    title: "The limb responded to the perturbation",
    meaning: "By will or by reflex. A part of that response looks like mechanics and stands in the numbers.",
  },
  "weak-instruments": {
    title: "The perturbation moved the limb too little for this method",
    meaning: "The ± intervals of instrumental variables do not hold.",
  },
  "invalid-instruments": {
    title: "This method does not hold here",
    meaning: "The limb responded to each pulse, and instrumental variables take that for mechanics.",
  },
  "mixed-conditions": {
    title: "Different conditions were measured as one",
    meaning: "The recordings are of different people, conditions or postures; one model for all of them may be that of none.",
  },
};
