// What is said in plain words: warnings, terms, directions.

/** For each warning a title that needs no training, and what it means for whoever reads the numbers. */
export type PlainWarnings = Record<string, { title: string; meaning: string }>;

export const plainWarnings: PlainWarnings = {
  "force-sign-reversed": {
    title: "The force was recorded with the opposite sign",
    meaning: "Everything comes out negative, which no limb can be. The recording itself is probably fine.",
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
    title: "The motion was too simple to tell inertia, damping and stiffness apart",
    meaning: "Each of the three could stand in for another.",
  },
  "held-back-fit-poor": {
    title: "The model does worse on the part of the recording that was held back",
    meaning: "The limb probably changed during the trial, or there is too little data.",
  },
  "fit-poor": {
    title: "Much of the force is not explained",
    meaning: "The limb may have acted by will or by reflex. Do not read the numbers as those of a relaxed limb.",
  },
  "no-held-back-data": {
    title: "The fit was judged on the data that made it",
    meaning: "It looks better than it would on new data.",
  },
  "clock-jitter": {
    title: "The clock of the recording was not steady",
    meaning: "The samples were taken as evenly spaced all the same.",
  },
  resampled: {
    title: "The recording was put on an even clock first",
    meaning: "Between the samples there are straight lines, which nobody measured.",
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
    title: "What the model leaves over is not noise without memory",
    meaning: "The ± intervals take it as that, and are narrower than they should be.",
  },
  "input-explains-residual": {
    title: "The model misses a part of what the input does",
    meaning: "Something of the output follows the input and is not in the model: a faster or slower part, or a delay.",
  },
  "pole-outside-band": {
    title: "The model says something about frequencies that were not tried",
    meaning: "The input hardly moved the system there, so that this part is a guess by the form of the model.",
  },
  "uneven-clock": {
    title: "The samples are unevenly spaced",
    meaning: "The model allows for it; the tests of what is left over do not.",
  },
};

/** Those that speak of a limb, said of any system. */
export const transferFunctionWarnings: PlainWarnings = {
  ...plainWarnings,
  "held-back-fit-poor": {
    title: "The model does badly on the part of the recording that was held back",
    meaning: "The system probably changed, or the model is too small or too large.",
  },
  "fit-poor": {
    title: "Much of the output is not explained",
    meaning: "The model is too small, the system is not linear, or the rest is noise.",
  },
};

/** Terms of a report on a transfer function. */
export const transferFunctionGlossary: [string, string][] = [
  ["Transfer function", "How a linear system turns an input into an output, as a fraction of two polynomials of s, the derivative with respect to time. Discrete models have q⁻¹, the last sample, instead."],
  ["Pole", "A root of the denominator: a way in which the system moves by itself. A pair is an oscillation, with a frequency and a damping; a single one is a decay."],
  ["Zero", "A root of the numerator: what the system does not let through."],
  ["Damping ζ", "Of an oscillation: 0 goes on for ever, 1 just does not swing any more."],
  ["Gain", "Output over input: at frequency zero, what a constant input ends in."],
  ["Bode plot", "Magnitude and phase of output over input, at each frequency."],
  ["Nyquist plot", "The same as one curve: at each frequency, magnitude and phase are length and angle of an arrow from the origin."],
  ["± and brackets", "95 % intervals: of a hundred such intervals, about 95 hold the true value. They know of noise and of its memory, but of no error in the form of the model."],
  ["R²", "The share of the output's variation that the simulated model explains; 1 is everything."],
  ["RMSE", "Root mean square error: the typical size of what the model does not explain, in the unit of the output."],
  ["YIC", "Young's criterion: low where the model fits well with coefficients that are well determined. Too many poles make it rise."],
  ["AIC, BIC", "Criteria that weigh the fit against the number of coefficients; lower is better."],
  ["Held-back data", "A part of the recording that had no share in making the model, on which it is then tested."],
  ["Excited band", "The frequencies that hold 96 % of the input's power. The model holds within it; beyond, it rests on its form."],
  ["Residual", "Measured minus simulated output."],
  ["Admittance, impedance", "Motion over force, and force over motion: each the inverse of the other."],
];

/** The verdict of passivity: a sign and a word, so that nothing hangs on colour, and what it means. */
export const verdictWords = {
  passive: { kind: "good", sign: "✓", word: "Passive", meaning: "Beyond reasonable doubt the limb takes energy up and gives back no more than it took. No passive machine can be made unstable by it." },
  active: { kind: "bad", sign: "✕", word: "Active", meaning: "Beyond reasonable doubt the limb gave more energy than it took. A machine that counts on a passive limb may become unstable." },
  undecided: { kind: "care", sign: "?", word: "Undecided", meaning: "The data allow both: the limb may be passive or active." },
} as const;

export const meanings = {
  K: "how hard the limb pushes back when it is held away from its resting place, as a spring does",
  B: "how hard it resists being moved fast, as if through honey",
  M: "how hard it resists being speeded up: how heavy it feels",
} as const;

/** The direction of an axis that has no arrow, from its angle against x. */
export function direction(degrees: number): string {
  const angle = ((degrees % 180) + 180) % 180;
  if (angle < 22.5 || angle >= 157.5) return "nearly along x";
  if (angle < 67.5) return "between +x and +y";
  if (angle < 112.5) return "nearly along y";
  return "between −x and +y";
}

/** Smallest angle between two axes without arrows [°]. */
export function angleBetween(first: number, second: number): number {
  const difference = (((first - second) % 180) + 180) % 180;
  return Math.min(difference, 180 - difference);
}

export const glossary: [string, string][] = [
  ["Impedance", "The relation between motion and force: here M, B and K together. M ẍ + B ẋ + K (x − x₀) = −F, with F the force that the limb exerts on the machine."],
  ["Inertia M", "Force per acceleration. One number for each pair of directions: xy is the force along x that comes from acceleration along y."],
  ["Damping B", "Force per velocity."],
  ["Stiffness K", "Force per displacement from the equilibrium."],
  ["Equilibrium x₀", "Where the limb would come to rest without force."],
  ["± and brackets", "95 % intervals: of a hundred such intervals, about 95 hold the true value. They know of noise and of its slow changes, but of no error in the model itself."],
  ["VAF", "Variance accounted for: the share of the force's variation that the model explains, in per cent. 100 % is everything; 0 % is no better than a constant."],
  ["RMSE", "Root mean square error: the typical size of what the model does not explain, in the unit of the force."],
  ["Held-back data", "A part of the recording that had no share in making the model, on which it is then tested."],
  ["Residual", "Measured minus predicted force. If it is noise without memory, nothing is left to explain."],
  ["Autocorrelation", "How much the residual resembles itself some time later. White noise stays within the shaded band."],
  ["Coherence", "At each frequency, how much of the force a linear relation with the motion could explain at best: from 0, nothing, to 1, everything."],
  ["Excited band", "The range of frequencies in which the robot moved the limb, as far as the filters let it through. The model holds within it, and not beyond."],
  ["Ellipse", "Move the hand once around a unit circle: the force traces the ellipse. Its long axis is the direction of the largest stiffness, damping or inertia."],
  ["Shape", "Long axis over short axis of an ellipse: 1 is a circle."],
  ["Orientation", "Angle of the long axis from x, counter-clockwise. An axis has no arrow, so 10° and 190° are the same."],
  ["Antisymmetry (z_mean)", "How far a matrix is from symmetric, relative to its size. Springs alone make symmetric stiffness; an interval that begins at 0 shows no antisymmetry."],
  ["Passive", "A limb that gives back no more energy than it took. Passive limb and passive machine together are always stable."],
  ["Passivity index", "At each frequency, the least damping of the model in any direction of motion: half the smallest eigenvalue of Z + Zᴴ. Positive is passive."],
  ["Excess, shortage of passivity", "How much damping could be taken away, or would have to be added, for the limb to be just passive."],
  ["Symmetric, antisymmetric part", "A matrix is the sum of both. Springs and masses are symmetric; an antisymmetric stiffness makes a force across the displacement that no spring makes."],
  ["Least squares", "The M, B, K that leave the least force unexplained. Where the limb acts on its own account, that is taken for mechanics too."],
  ["Instrumental variables", "M, B, K from what follows the known perturbation alone. What the limb does of itself does not follow it, and so drops out."],
  ["First-stage F", "How well the known perturbation predicts a signal that the model needs. Below 10 it predicts too little to rely on."],
  ["Bootstrap", "The measurement made again many times from parts of itself, drawn by chance: how much it varies shows how sure it is."],
  ["Reference circle", "The ellipse of something equally stiff (damped, heavy) in all directions, of the value that is written on it."],
];
