// Texts of the report: terms, verdicts, and warnings of a transfer function.
import type { Trial } from "@mbk/shared/result";
import { type PlainWarnings, plainWarnings } from "@mbk/shared/warnings";

export { methodNames } from "@mbk/shared/result";

/** Texts of warnings for any system instead of a limb. */
export const transferFunctionWarnings: PlainWarnings = {
  ...plainWarnings,
  "held-out-fit-poor": {
    title: "The model fits the held-out (validation) data poorly",
    meaning: "The system probably changed, or the model order is too low or too high.",
  },
  "fit-poor": {
    title: "Much of the output is not explained",
    meaning: "The model order is too low, the system is not linear, or the remainder is noise.",
  },
};

/** Terms of a report on a transfer function. */
export const transferFunctionGlossary: [string, string][] = [
  ["Transfer function", "How a linear system turns an input into an output, as a ratio of two polynomials in s (the time derivative). Discrete models use q⁻¹ (one sample of delay) instead."],
  ["Pole", "A root of the denominator: a free motion of the system. A complex pair is an oscillation with a frequency and a damping ratio; a real pole is an exponential decay."],
  ["Zero", "A root of the numerator: an input that the system blocks."],
  ["Damping ζ", "Damping ratio of an oscillation: 0 never decays, 1 no longer oscillates (critical damping)."],
  ["Gain", "Output over input; at frequency zero, the final output per constant input."],
  ["Bode plot", "Magnitude and phase of output over input, at each frequency."],
  ["Nyquist plot", "The same as one curve in the complex plane: at each frequency, magnitude and phase are length and angle of the vector from the origin."],
  ["± and brackets", "95 % intervals: of a hundred such intervals, about 95 contain the true value. They account for noise and its correlation, but not for errors in the form of the model."],
  ["R²", "The share of the variance of the output that the simulated model explains; 1 is a perfect fit."],
  ["RMSE", "Root-mean-square error: the typical size of the residual, in the unit of the output."],
  ["YIC", "Young's information criterion: low if the model fits well and its coefficients are well determined. Too many poles raise it."],
  ["AIC, BIC", "Criteria that weigh the fit against the number of coefficients; lower is better."],
  ["Held-out data", "Validation data: a part of the recording that was not used for fitting, on which the model is then tested."],
  ["Excited band", "The frequencies that contain 96 % of the power of the input. The model is valid within this band; beyond it, it is extrapolated."],
  ["Residual", "Measured minus simulated output."],
  ["Admittance, impedance", "Motion over force, and force over motion: each the inverse of the other."],
];

/** Terms of a report on an exploration without a parametric model. */
export const explorationGlossary: [string, string][] = [
  ["Dynamic stiffness", "Force per displacement at each frequency, D = −F/X. For a limb with inertia, damping and stiffness it is K − M ω² + j ω B."],
  ["Bode plot", "Magnitude and phase of output over input, at each frequency."],
  ["Nyquist plot", "The same as one curve in the complex plane: at each frequency, magnitude and phase are length and angle of the vector from the origin."],
  ["Coherence", "At each frequency, the share of the output that follows the inputs linearly, from 0 (none) to 1 (all)."],
  ["Partial coherence", "The same for one input, after removing from both signals what the other inputs explain."],
  ["Realisation", "A perturbation with the same frequencies but different phases. Nonlinear distortion changes with the phases; a linear response does not."],
  ["Even, odd distortion", "Response of a nonlinear limb at frequencies that the perturbation does not excite: even if pushing and pulling differ, odd if the response depends on amplitude."],
  ["Impulse response", "The force before and after a short displacement at lag 0. Negative lags show force that precedes the motion."],
  ["Memory", "The longest lag, in both directions, at which motion still explains the force."],
  ["Reflex", "Force in response to stretch in one direction, after a delay that rules out passive mechanics."],
  ["Gain of the reflex", "Force for a steady stretch velocity of 1 m/s (1 rad/s); positive resists the stretch."],
  ["VAF", "Variance accounted for: the share of the variance of the force that is explained, in per cent."],
  ["± and brackets", "95 % intervals: of a hundred such intervals, about 95 contain the true value."],
  ["Held-out data", "Validation data: a part of the recording that was not used for fitting."],
];

/** A verdict on passivity: a sign and a word, so that nothing depends on colour. The statement gives its subject. */
export const verdictWords = {
  passive: { kind: "good", sign: "✓", word: "passive" },
  active: { kind: "bad", sign: "✕", word: "active" },
  undecided: { kind: "care", sign: "?", word: "undecided" },
  none: { kind: "care", sign: "–", word: "none" },
} as const;

export const meanings = {
  K: "pushes back like a spring",
  B: "resists velocity, as honey does",
  M: "resists acceleration: how heavy it feels",
} as const;

const glossary: [string, string][] = [
  ["Impedance", "The relation between motion and force, here described by M, B and K. M ẍ + B ẋ + K (x − x₀) = −F, with F the force that the limb exerts on the machine."],
  ["Inertia M", "Force per acceleration. One number for each pair of directions: xy is the force along x caused by acceleration along y."],
  ["Damping B", "Force per velocity."],
  ["Stiffness K", "Force per displacement from the equilibrium."],
  ["Equilibrium x₀", "The position at which the limb would rest without force."],
  ["± and brackets", "95 % intervals: of a hundred such intervals, about 95 contain the true value. They account for noise and its correlation, but not for errors in the model itself."],
  ["VAF", "Variance accounted for: the share of the variance of the force that the model explains, in per cent. 100 % is a perfect fit; 0 % is no better than a constant."],
  ["RMSE", "Root-mean-square error: the typical size of the residual, in the unit of the force."],
  ["Held-out data", "Validation data: a part of the recording that was not used for fitting, on which the model is then tested."],
  ["Residual", "Measured minus predicted force. If it is white noise, nothing is left to explain."],
  ["Autocorrelation", "Correlation of the residual with itself at a later time. White noise stays within the shaded band."],
  ["Coherence", "At each frequency, the share of the force that a linear relation with the motion could explain at most, from 0 (none) to 1 (all)."],
  ["Excited band", "The range of frequencies in which the robot moved the limb and which the filters pass. The model is valid within this band only."],
  ["Ellipse", "Move the hand once around a unit circle: the force traces the ellipse. Its major axis is the direction of the largest stiffness, damping or inertia."],
  ["Shape", "Major axis over minor axis of an ellipse: 1 is a circle."],
  ["Orientation", "Angle of the major axis from x, counter-clockwise. An axis has no arrow, so 10° and 190° are the same. Check how x and y of your robot point."],
  ["Antisymmetry (z_mean)", "How far a matrix is from symmetric, relative to its size. Springs have symmetric stiffness. An interval that begins at 0 means: no detectable antisymmetry."],
  ["Passive", "Of a trial: the limb absorbed energy in it. Of a model: it absorbs energy in any motion within the band. Neither statement guarantees that a robot coupled to this person is stable; people can change their impedance within a moment."],
  ["Passivity index", "At each frequency, the smallest damping of the model over all directions of motion: half the smallest eigenvalue of Z + Zᴴ. Positive means passive."],
  ["Excess, shortage of passivity", "The damping that could be removed (excess) or would have to be added (shortage) for the limb to be just passive."],
  ["Symmetric, antisymmetric part", "A matrix is the sum of both. Springs and masses are symmetric; an antisymmetric (rotational) stiffness gives a force perpendicular to the displacement, which no spring does."],
  ["Least squares", "The M, B, K with the smallest residual force. Voluntary or reflex force of the limb is wrongly attributed to mechanics."],
  ["Instrumental variables", "M, B, K from the part of motion and force that follows the known perturbation. Spontaneous activity of the limb does not follow it and cancels out."],
  ["First-stage F", "How well the known perturbation predicts a signal that the model needs. The instruments are strong if it exceeds 104.7."],
  ["Bootstrap", "The estimation is repeated many times on randomly drawn blocks of the recording; the spread of the results shows their uncertainty."],
  ["Reference circle", "Equal stiffness, damping or inertia in all directions, with the value written on it."],
];

/** Terms that only a plane has. */
const planar = new Set(["Ellipse", "Shape", "Orientation", "Antisymmetry (z_mean)"]);

const spatial: [string, string][] = [
  ["Ellipsoid", "Move the hand over a unit sphere: the force of the symmetric part traces the ellipsoid. Its longest axis is the direction of the largest stiffness, damping or inertia. There is none if a principal value may be zero or negative."],
  ["Principal value, direction", "Eigenvalue of the symmetric part, and the direction in which motion and that force are parallel. Nearly equal values have no direction of their own."],
  ["95 % cone", "The cone around a direction that contains the true one with 95 % confidence. Its half-angle is measured from its axis; at 90° every direction is possible."],
  ["Shape of an ellipsoid", "Largest over smallest principal value: 1 is a sphere."],
  ["Antisymmetric vector z", "The antisymmetric part of a matrix turns a motion u into the force z × u. Springs and masses have none."],
];

/** The terms of a page on these trials. */
export function glossaryOf(trials: Trial[]): [string, string][] {
  const axes = new Set(trials.map(({ result }) => result.axes));
  if (!axes.has(3)) return glossary;
  return [...glossary.filter(([term]) => axes.has(2) || !planar.has(term)), ...spatial];
}
