// What is said in plain words: terms, verdicts, and warnings of any system.
import { type PlainWarnings, plainWarnings } from "@mbk/shared/warnings";

export { methodNames } from "@mbk/shared/result";

/** Those that speak of a limb, said of any system. */
export const transferFunctionWarnings: PlainWarnings = {
  ...plainWarnings,
  "held-out-fit-poor": {
    title: "The model does badly on the part of the recording that was held out",
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
  ["Pole", "A root of the denominator: a way in which the system moves freely. A pair is an oscillation, with a frequency and a damping; a single one is a decay."],
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
  ["Held-out data", "Validation data: a part of the recording that was not used for fitting, on which the model is then tested."],
  ["Excited band", "The frequencies that hold 96 % of the input's power. The model holds within it; beyond, it rests on its form."],
  ["Residual", "Measured minus simulated output."],
  ["Admittance, impedance", "Motion over force, and force over motion: each the inverse of the other."],
];

/** Terms of a report on what recordings say without a model. */
export const explorationGlossary: [string, string][] = [
  ["Dynamic stiffness", "Force per displacement at each frequency, D = −F/X. Where inertia, damping and stiffness hold it is K − M ω² + j ω B."],
  ["Bode plot", "Magnitude and phase of output over input, at each frequency."],
  ["Nyquist plot", "The same as one curve: at each frequency, magnitude and phase are length and angle of an arrow from the origin."],
  ["Coherence", "At each frequency, the share of the output that follows the inputs linearly: from 0, nothing, to 1, everything."],
  ["Partial coherence", "The same for one input alone, once what the others explain is taken from both."],
  ["Realisation", "A perturbation of the same lines with other phases. Nonlinear distortion changes with the phases, a linear response does not."],
  ["Even, odd distortion", "What a limb that is not linear adds at frequencies that the perturbation leaves empty: even where pushing and pulling differ, odd where size matters."],
  ["Impulse response", "What a short displacement now does to the force before and after it; to the left of 0 stands what the force did before the motion."],
  ["Memory", "How far back and ahead motion tells of the force."],
  ["Reflex", "Force that answers stretch in one direction, later than the limb itself can."],
  ["Gain of the reflex", "Force for a steady stretch of 1 m/s (1 rad/s); positive resists the stretch."],
  ["VAF", "Variance accounted for: the share of the force's variation that is explained, in per cent."],
  ["± and brackets", "95 % intervals: of a hundred such intervals, about 95 hold the true value."],
  ["Held-out data", "Validation data: a part of the recording that was not used for fitting."],
];

/** A verdict on passivity: a sign and a word, so that nothing hangs on colour. What it is about, the statement says. */
export const verdictWords = {
  passive: { kind: "good", sign: "✓", word: "passive" },
  active: { kind: "bad", sign: "✕", word: "active" },
  undecided: { kind: "care", sign: "?", word: "undecided" },
  none: { kind: "care", sign: "–", word: "none" },
} as const;

export const meanings = {
  K: "how hard the limb pushes back when it is held away from its resting place, as a spring does",
  B: "how hard it resists being moved fast, as if through honey",
  M: "how hard it resists being speeded up: how heavy it feels",
} as const;

export const glossary: [string, string][] = [
  ["Impedance", "The relation between motion and force: here M, B and K together. M ẍ + B ẋ + K (x − x₀) = −F, with F the force that the limb exerts on the machine."],
  ["Inertia M", "Force per acceleration. One number for each pair of directions: xy is the force along x that comes from acceleration along y."],
  ["Damping B", "Force per velocity."],
  ["Stiffness K", "Force per displacement from the equilibrium."],
  ["Equilibrium x₀", "Where the limb would come to rest without force."],
  ["± and brackets", "95 % intervals: of a hundred such intervals, about 95 hold the true value. They know of noise and of its slow changes, but of no error in the model itself."],
  ["VAF", "Variance accounted for: the share of the force's variation that the model explains, in per cent. 100 % is everything; 0 % is no better than a constant."],
  ["RMSE", "Root mean square error: the typical size of what the model does not explain, in the unit of the force."],
  ["Held-out data", "Validation data: a part of the recording that was not used for fitting, on which the model is then tested."],
  ["Residual", "Measured minus predicted force. If it is noise without memory, nothing is left to explain."],
  ["Autocorrelation", "How much the residual resembles itself some time later. White noise stays within the shaded band."],
  ["Coherence", "At each frequency, how much of the force a linear relation with the motion could explain at best: from 0, nothing, to 1, everything."],
  ["Excited band", "The range of frequencies in which the robot moved the limb, as far as the filters let it through. The model holds within it, and not beyond."],
  ["Ellipse", "Move the hand once around a unit circle: the force traces the ellipse. Its long axis is the direction of the largest stiffness, damping or inertia."],
  ["Shape", "Long axis over short axis of an ellipse: 1 is a circle."],
  ["Orientation", "Angle of the long axis from x, counter-clockwise. An axis has no arrow, so 10° and 190° are the same."],
  ["Antisymmetry (z_mean)", "How far a matrix is from symmetric, relative to its size. Springs alone make symmetric stiffness; an interval that begins at 0 shows no antisymmetry."],
  ["Passive", "Of a trial: the limb absorbed energy in it. Of a model: it absorbs energy in any motion within the band. Neither is a promise that a machine is stable with a person, who may do something else the next moment."],
  ["Passivity index", "At each frequency, the least damping of the model in any direction of motion: half the smallest eigenvalue of Z + Zᴴ. Positive is passive."],
  ["Excess, shortage of passivity", "How much damping could be taken away, or would have to be added, for the limb to be just passive."],
  ["Symmetric, antisymmetric part", "A matrix is the sum of both. Springs and masses are symmetric; an antisymmetric stiffness makes a force across the displacement that no spring makes."],
  ["Least squares", "The M, B, K that leave the least force unexplained. Where the limb acts on its own account, that is taken for mechanics too."],
  ["Instrumental variables", "M, B, K from what follows the known perturbation alone. What the limb does of itself does not follow it, and so drops out."],
  ["First-stage F", "How well the known perturbation predicts a signal that the model needs. Below 10 it predicts too little to rely on."],
  ["Bootstrap", "The measurement repeated many times on randomly drawn parts of the recording: its spread shows its uncertainty."],
  ["Reference circle", "The ellipse of something equally stiff (damped, heavy) in all directions, of the value that is written on it."],
];
